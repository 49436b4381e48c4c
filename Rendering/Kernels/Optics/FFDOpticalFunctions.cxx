// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDOpticalFunctions.h"

#include <numeric>

namespace ffd
{

//------------------------------------------------------------------------------
std::vector<int> FindOpacityComponents(ComponentKind kind, int count)
{
  switch (kind)
  {
    case ComponentKind::ColorOpacity:
      return { 1 };
    case ComponentKind::Rgb:
      return { 0, 1, 2 };
    case ComponentKind::Rgba:
      return { 3 };
    case ComponentKind::Independent:
    default:
      break;
  }
  std::vector<int> all(static_cast<std::size_t>(count));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

//------------------------------------------------------------------------------
double FindColorScale(ScalarType type)
{
  return type == ScalarType::UInt8 ? 1.0 / 255.0 : type == ScalarType::UInt16 ? 1.0 / 65535.0 : 1.0;
}

//------------------------------------------------------------------------------
bool OpticalFunctions::IsTransparent(
  const ComponentOptics& component, const MinMaxBlocks::Limits& limits) const
{
  bool transparent = component.Plane.IsEmpty()
    ? component.Table.IsTransparent(limits.Min, limits.Max)
    : component.Plane.IsTransparent(limits.Min, limits.Max);
  for (std::size_t i = 0; transparent && i < this->Labels.size(); ++i)
  {
    transparent = this->Labels[i].Table.IsTransparent(limits.Min, limits.Max);
  }
  return transparent;
}

//------------------------------------------------------------------------------
bool OpticalFunctions::IsTransparent(const MinMaxBlocks::Limits* limits) const
{
  if (this->Kind == ComponentKind::Independent)
  {
    for (std::size_t c = 0; c < this->Components.size(); ++c)
    {
      const ComponentOptics& component = this->Components[c];
      const bool counts = this->Components.size() == 1 || component.Weight > 0.0f;
      if (counts && !this->IsTransparent(component, limits[c]))
      {
        return false;
      }
    }
    return true;
  }
  if (this->Kind == ComponentKind::Rgb)
  {
    MinMaxBlocks::Limits luminance{ 0.0, 0.0 };
    for (int c = 0; c < 3; ++c)
    {
      if (limits[c].Min > limits[c].Max)
      {
        return true;
      }
      luminance.Min += LuminanceWeights[c] * limits[c].Min;
      luminance.Max += LuminanceWeights[c] * limits[c].Max;
    }
    return this->IsTransparent(this->Components[0], luminance);
  }
  return this->IsTransparent(this->Components[0], limits[0]);
}

//------------------------------------------------------------------------------
std::size_t OpticalFunctions::GetMemorySize() const
{
  std::size_t size = this->Colors.GetMemorySize();
  for (const ComponentOptics& component : this->Components)
  {
    size += component.Table.GetMemorySize() + component.Plane.GetMemorySize();
  }
  for (const LabelOptics& label : this->Labels)
  {
    size += label.Table.GetMemorySize();
  }
  return size;
}

//------------------------------------------------------------------------------
bool HaveSameVisibility(const OpticalFunctions& a, const OpticalFunctions& b)
{
  if (a.Kind != b.Kind || a.Components.size() != b.Components.size() || !a.Labels.empty() ||
    !b.Labels.empty() || a.ColorScale != b.ColorScale)
  {
    return false;
  }
  for (std::size_t i = 0; i < a.Components.size(); ++i)
  {
    const ComponentOptics& x = a.Components[i];
    const ComponentOptics& y = b.Components[i];
    if (!x.Plane.IsEmpty() || !y.Plane.IsEmpty() || !x.Table.HasSameVisibility(y.Table) ||
      (x.Weight > 0.0f) != (y.Weight > 0.0f))
    {
      return false;
    }
  }
  return true;
}

} // namespace ffd
