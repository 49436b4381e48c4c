// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDFieldCache.h"

#include <algorithm>

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
PacketField FieldCache::FindPacketField(const BSplineField& field, const Box& rest, int cells)
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
