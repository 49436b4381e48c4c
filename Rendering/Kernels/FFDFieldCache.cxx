// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDFieldCache.h"

#include "FFDPullBack.h"

#include <glm/common.hpp>

#include <algorithm>
#include <atomic>

namespace ffd
{
namespace
{

/// A frame has at most three grids of boxes.
constexpr std::size_t LargestNumberOfImages = 3;

bool HasFewControlPoints(const BSplineField& field)
{
  return field.GetCoefficients().size() <= FieldCache::FewControlPoints;
}

} // namespace

//------------------------------------------------------------------------------
std::uint64_t FieldCache::MakeNumber()
{
  static std::atomic<std::uint64_t> last{ 0 };
  return ++last;
}

//------------------------------------------------------------------------------
PacketField FieldCache::FindPacketField(
  const BSplineField& field, const Box& rest, const glm::ivec3& cells)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  if (!this->SecondDerivative)
  {
    this->SecondDerivative = PacketField::FindSecondDerivative(field);
  }
  if (HasFewControlPoints(field))
  {
    return PacketField(field, rest, cells, *this->SecondDerivative);
  }
  if (!this->Packets.Coefficients || this->Cells != cells || !(this->Rest == rest))
  {
    this->Packets = PacketField(field, rest, cells, *this->SecondDerivative);
    this->Rest = rest;
    this->Cells = cells;
  }
  return this->Packets;
}

//------------------------------------------------------------------------------
glm::ivec3 FieldCache::FindProvenCells(const BSplineField& field, const glm::ivec3& wanted)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  if (wanted == this->Wanted)
  {
    return this->Proven;
  }
  this->Wanted = wanted;
  this->Proven = glm::ivec3(0);
  // Where it is not one to one soon, it need not be looked for farther away; more cells gain
  // little.
  for (const int most : { 3, 8 })
  {
    const glm::ivec3 cells = glm::min(wanted, glm::ivec3(most));
    const BSplineField extended = ExtendLinearly(field, cells);
    PullBackBounds bounds;
    bounds.Update(PullBack(&extended, PullBackKind::Exact, 1.0));
    if (!bounds.IsProvenInvertible())
    {
      break;
    }
    this->Proven = cells;
  }
  return this->Proven;
}

//------------------------------------------------------------------------------
std::shared_ptr<const BoxImages> FieldCache::FindBoxImages(
  const BoxGrid& boxes, const BSplineField& field, double sign)
{
  if (HasFewControlPoints(field))
  {
    return std::make_shared<const BoxImages>(boxes, &field, sign);
  }
  const std::lock_guard<std::mutex> lock(this->Mutex);
  const auto known = std::find_if(this->Images.begin(), this->Images.end(),
    [&](const auto& each) { return each->GetBoxes() == boxes && each->GetSign() == sign; });
  if (known != this->Images.end())
  {
    std::rotate(known, known + 1, this->Images.end());
    return this->Images.back();
  }
  auto made = std::make_shared<const BoxImages>(boxes, &field, sign);
  if (this->Images.size() == LargestNumberOfImages)
  {
    this->Images.erase(this->Images.begin());
  }
  this->Images.push_back(made);
  return made;
}

//------------------------------------------------------------------------------
ThirdDerivatives FieldCache::FindThirdDerivatives(const BSplineField& field)
{
  if (HasFewControlPoints(field))
  {
    return BoundThirdDerivatives(field);
  }
  const std::lock_guard<std::mutex> lock(this->Mutex);
  if (!this->Third)
  {
    this->Third = BoundThirdDerivatives(field);
  }
  return *this->Third;
}

//------------------------------------------------------------------------------
std::size_t FieldCache::GetMemorySize() const
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  std::size_t size = this->Packets.GetMemorySize();
  for (const auto& each : this->Images)
  {
    size += each->GetMemorySize();
  }
  return size;
}

} // namespace ffd
