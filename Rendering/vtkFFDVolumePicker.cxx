// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDVolumePicker.h"

#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDProbeView.h"
#include "vtkFFDViewFromRenderer.h"

#include "FFDAxisMap.h"
#include "FFDClipToBox.h"
#include "FFDSampling.h"
#include "Optics/FFDDifferences.h"
#include "Optics/FFDOpticalFunctions.h"
#include "Reference/FFDSurfaceSearch.h"

#include "vtkImageData.h"
#include "vtkLODProp3D.h"
#include "vtkObjectFactory.h"
#include "vtkPiecewiseFunction.h"
#include "vtkRectilinearGrid.h"
#include "vtkTransform.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

vtkStandardNewMacro(vtkFFDVolumePicker);

namespace
{

/// Which of the 27 cropping regions a point is in.
class CroppingRegions
{
public:
  explicit CroppingRegions(const ffd::Cropping& crop)
    : Crop(crop)
  {
  }

  bool IsOn() const { return this->Crop.Space != ffd::Cropping::Spaces::None; }
  bool IsAtRest() const { return this->Crop.Space == ffd::Cropping::Spaces::Rest; }

  /// In the coordinates of the planes.
  const glm::dvec3& Position(const ffd::SurfacePoint& point) const
  {
    return this->IsAtRest() ? point.Index : point.Deformed;
  }

  bool Hides(const ffd::SurfacePoint& point) const
  {
    return this->IsOn() && !this->Crop.Shows(this->Position(point));
  }

  /// 0, 1 or 2 along each axis.
  glm::ivec3 Region(const ffd::SurfacePoint& point) const
  {
    const glm::dvec3& p = this->Position(point);
    glm::ivec3 region(0);
    for (int a = 0; a < 3; ++a)
    {
      region[a] = (p[a] >= this->Crop.Low[a] ? 1 : 0) + (p[a] >= this->Crop.High[a] ? 1 : 0);
    }
    return region;
  }

  /// Number of the plane between two points, xmin, xmax, ymin, ...; -1: none.
  int FindPlane(const ffd::SurfacePoint& a, const ffd::SurfacePoint& b) const
  {
    if (this->IsOn())
    {
      const glm::ivec3 first = this->Region(a);
      const glm::ivec3 second = this->Region(b);
      for (int axis = 0; axis < 3; ++axis)
      {
        if (first[axis] != second[axis])
        {
          return 2 * axis + (std::max(first[axis], second[axis]) == 2 ? 1 : 0);
        }
      }
    }
    return -1;
  }

private:
  const ffd::Cropping& Crop;
};

/// A function as the mapper asks for it: beyond its range constant, or as it says itself.
struct Lookup
{
  vtkPiecewiseFunction* Function = nullptr;
  bool Native = false;

  explicit operator bool() const { return this->Function != nullptr; }
  double operator()(double x) const
  {
    const double* range = this->Function->GetRange();
    if (this->Native && this->Function->GetSize() > 0 && (x <= range[0] || x >= range[1]))
    {
      // Without clamping the value at the first point is 0, too; since VTK 9.2 that at the last.
      double node[4] = { 0.0, 0.0, 0.0, 0.0 };
      this->Function->GetNodeValue(x <= range[0] ? 0 : this->Function->GetSize() - 1, node);
      return node[1];
    }
    return this->Function->GetValue(x);
  }
};

/// Finds the opacity at a rest position, component by component, as the picture shows it.
class Visibility
{
public:
  Visibility(const vtkFFDProbeView& view, vtkVolumeProperty* property,
    vtkFFDInverseRayVolumeMapper* mapper, bool gradientOpacity)
    : View(view)
  {
    constexpr int native = vtkFFDInverseRayVolumeMapper::NATIVE;
    const bool nativeOpacity = mapper->GetScalarOpacityRangeType() == native;
    const bool nativeGradient = mapper->GetGradientOpacityRangeType() == native;
    const ffd::VolumeView& volume = view.Volume;
    const bool independent = property->GetIndependentComponents() != 0;
    this->Nearest = property->GetInterpolationType() == VTK_NEAREST_INTERPOLATION;
    this->Fetch = ffd::SelectSampleFunctions(
      volume.Type, this->Nearest ? ffd::Interpolation::Nearest : ffd::Interpolation::Linear);
    this->FetchNearest = ffd::SelectSampleFunctions(volume.Type, ffd::Interpolation::Nearest);
    this->FetchMask =
      ffd::SelectSampleFunctions(view.Mask.Volume.Type, ffd::Interpolation::Nearest);
    const int last = std::min(volume.Components, VTK_MAX_VRCOMP) - 1;
    // The luminance of red, green and blue gives the opacity, else the last component.
    const bool luminance = !independent && last == 2;
    for (int c = independent || luminance ? 0 : last; c <= (luminance ? 0 : last); ++c)
    {
      Channel channel;
      channel.Component = c;
      channel.Volume = ffd::GetComponent(volume, c);
      const int ofProperty = independent ? c : 0;
      if (independent && last > 0 && !(property->GetComponentWeight(c) > 0.0))
      {
        continue; // not in the picture
      }
      channel.Opacity = { property->GetScalarOpacity(ofProperty), nativeOpacity };
      if (gradientOpacity && property->HasGradientOpacity(ofProperty))
      {
        channel.Gradient = { property->GetGradientOpacity(ofProperty), nativeGradient };
      }
      for (int term = 0; term < (luminance ? 3 : 1); ++term)
      {
        const double weight = luminance ? ffd::LuminanceWeights[term] : 1.0;
        channel.Terms.push_back({ ffd::GetComponent(volume, c + term), weight });
      }
      this->Channels.push_back(channel);
    }
    if (view.Mask.Volume.Scalars && view.Mask.Labels)
    {
      for (const int label : property->GetLabelMapLabels())
      {
        vtkPiecewiseFunction* opacity = property->GetLabelScalarOpacity(label);
        // Functions of labels are looked up for all scalars.
        this->Labels[label] = { opacity ? Lookup{ opacity }
                                        : Lookup{ property->GetScalarOpacity(), nativeOpacity },
          { gradientOpacity ? property->GetLabelGradientOpacity(label) : nullptr } };
      }
    }
  }

  struct Channel
  {
    int Component = 0;
    ffd::VolumeView Volume;
    /// The value that is looked up: a weighted sum of components.
    std::vector<std::pair<ffd::VolumeView, double>> Terms;
    Lookup Opacity;
    Lookup Gradient;
  };

  /// Whole numbers at voxels.
  glm::dvec3 ToVoxel(const glm::dvec3& index) const
  {
    return this->View.Volume.Axes ? this->View.Volume.Axes->ToVoxel(index) : index;
  }

  double Value(const Channel& channel, const glm::dvec3& index) const
  {
    return ValueOf(this->Fetch, channel, this->ToVoxel(index));
  }

  /// By data coordinates, at rest, as the picture is shaded.
  glm::dvec3 Gradient(const Channel& channel, const glm::dvec3& index) const
  {
    return glm::transpose(channel.Volume.DataToIndex) *
      ffd::FindDifferences(channel.Volume, this->ToVoxel(index), this->Nearest, this->View.Hidden,
        [&](const glm::dvec3& at, bool nearest) {
          return ValueOf(nearest ? this->FetchNearest : this->Fetch, channel, at);
        });
  }

  /// The nearest voxel of the mask; 0 outside of it.
  double MaskAt(const glm::dvec3& index) const
  {
    const ffd::MaskView& mask = this->View.Mask;
    glm::dvec3 at = this->ToVoxel(index);
    if (!mask.SameGrid)
    {
      const ffd::VolumeView& volume = this->View.Volume;
      at = mask.Volume.ToIndex(volume.FirstVoxel + volume.IndexToData * index);
      const glm::dvec3 beyond =
        glm::max(-0.5 - at, at - (glm::dvec3(mask.Volume.Dimensions) - 0.5));
      if (beyond.x > 0.0 || beyond.y > 0.0 || beyond.z > 0.0)
      {
        return 0.0;
      }
    }
    return this->FetchMask.Value(mask.Volume, at);
  }

  /// Blanked, or outside of a binary mask.
  bool IsHidden(const glm::dvec3& index) const
  {
    const ffd::VolumeView& volume = this->View.Volume;
    if (this->View.Hidden)
    {
      const glm::dvec3 cell = glm::floor(this->ToVoxel(index) + volume.Margin);
      const glm::ivec3 last = this->View.Hidden->GetCells() - 1;
      if (this->View.Hidden->Has(glm::clamp(glm::ivec3(cell), glm::ivec3(0), last)))
      {
        return true;
      }
    }
    const ffd::MaskView& mask = this->View.Mask;
    return mask.Volume.Scalars && !mask.Labels && !(this->MaskAt(index) > 0.0);
  }

  /// As the mapper classifies: `value` through both functions.
  double Opacity(const Channel& channel, const Lookup& opacity, const Lookup& gradient,
    double value, const glm::dvec3& index) const
  {
    const double plain = opacity(value);
    return gradient && plain > 0.0 ? plain * gradient(glm::length(this->Gradient(channel, index)))
                                   : plain;
  }

  /// The first channel whose opacity exceeds `isovalue` there; null: none.
  const Channel* Find(const glm::dvec3& index, double isovalue) const
  {
    for (const Channel& channel : this->Channels)
    {
      const double value = this->Value(channel, index);
      double opacity = 0.0;
      if (value == value)
      {
        opacity = this->Opacity(channel, channel.Opacity, channel.Gradient, value, index);
        const auto label = this->Labels.empty()
          ? this->Labels.end()
          : this->Labels.find(static_cast<int>(this->MaskAt(index) + 0.5));
        if (label != this->Labels.end())
        {
          const double factor = this->View.Mask.BlendFactor;
          opacity = (1.0 - factor) * opacity +
            factor *
              this->Opacity(channel, label->second.first, label->second.second, value, index);
        }
      }
      if (opacity > isovalue)
      {
        return this->IsHidden(index) ? nullptr : &channel;
      }
    }
    return nullptr;
  }

  /// Null: no component is in the picture.
  const Channel* GetFirst() const
  {
    return this->Channels.empty() ? nullptr : &this->Channels.front();
  }

private:
  static double ValueOf(
    const ffd::SampleFunctions& fetch, const Channel& channel, const glm::dvec3& voxel)
  {
    double sum = 0.0;
    for (const auto& term : channel.Terms)
    {
      sum += term.second * fetch.Value(term.first, voxel);
    }
    return sum;
  }

  const vtkFFDProbeView& View;
  std::vector<Channel> Channels;
  /// Functions of each label that has any: scalar opacity, and gradient opacity or null.
  std::map<int, std::pair<Lookup, Lookup>> Labels;
  bool Nearest;
  ffd::SampleFunctions Fetch;        // as in the picture
  ffd::SampleFunctions FetchNearest; // of gradients beside hidden cells
  ffd::SampleFunctions FetchMask;
};

/// Outward normal at rest of the face of the volume through which a ray comes in; zero: of none.
glm::dvec3 FindFaceNormal(const ffd::VolumeView& volume, const glm::dvec3& outside)
{
  const glm::dvec3 lower = volume.LowerIndex();
  const glm::dvec3 upper = volume.UpperIndex();
  glm::dvec3 normal(0.0);
  for (int a = 0; a < 3; ++a)
  {
    if (outside[a] < lower[a] || outside[a] > upper[a])
    {
      glm::dvec3 axis(0.0);
      axis[a] = outside[a] < lower[a] ? -1.0 : 1.0;
      normal = glm::transpose(volume.DataToIndex) * axis;
    }
  }
  return normal;
}

} // namespace

//------------------------------------------------------------------------------
void vtkFFDVolumePicker::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "RestPosition: (" << this->RestPosition[0] << ", " << this->RestPosition[1]
     << ", " << this->RestPosition[2] << ")\n";
  os << indent << "ScalarValue: " << this->ScalarValue << "\n";
  os << indent << "Component: " << this->Component << "\n";
}

//------------------------------------------------------------------------------
void vtkFFDVolumePicker::ResetPickInfo()
{
  this->Superclass::ResetPickInfo();
  std::fill_n(this->RestPosition, 3, 0.0);
  this->ScalarValue = 0.0;
  this->Component = -1;
}

//------------------------------------------------------------------------------
double vtkFFDVolumePicker::IntersectWithLine(const double p1[3], const double p2[3], double tol,
  vtkAssemblyPath* path, vtkProp3D* prop, vtkAbstractMapper3D* mapper)
{
  const double before = this->GlobalTMin;
  const double t = this->Superclass::IntersectWithLine(p1, p2, tol, path, prop, mapper);
  if (t < before)
  {
    const bool planePicked = this->PickClippingPlanes && this->ClippingPlaneId >= 0;
    auto* deformed = vtkFFDInverseRayVolumeMapper::SafeDownCast(mapper);
    if (planePicked || !deformed)
    {
      // Nothing of what an earlier, farther volume has left.
      this->ScalarValue = 0.0;
      this->Component = -1;
      std::copy_n(this->MapperPosition, 3, this->RestPosition);
    }
    if (planePicked && deformed)
    {
      deformed->GetRestPosition(this->MapperPosition, this->RestPosition);
    }
  }
  return t;
}

//------------------------------------------------------------------------------
double vtkFFDVolumePicker::IntersectVolumeWithLine(const double p1[3], const double p2[3],
  double t1, double t2, vtkProp3D* prop, vtkAbstractVolumeMapper* mapper)
{
  auto* deformed = vtkFFDInverseRayVolumeMapper::SafeDownCast(mapper);
  if (!deformed)
  {
    return this->Superclass::IntersectVolumeWithLine(p1, p2, t1, t2, prop, mapper);
  }
  vtkVolumeProperty* property = nullptr;
  if (auto* volume = vtkVolume::SafeDownCast(prop))
  {
    property = volume->GetProperty();
  }
  else if (auto* levels = vtkLODProp3D::SafeDownCast(prop))
  {
    levels->GetLODProperty(levels->GetPickLODID(), &property);
  }
  return property ? this->IntersectDeformed(p1, p2, t1, t2, property, deformed) : VTK_DOUBLE_MAX;
}

//------------------------------------------------------------------------------
double vtkFFDVolumePicker::IntersectDeformed(const double p1[3], const double p2[3], double t1,
  double t2, vtkVolumeProperty* property, vtkFFDInverseRayVolumeMapper* mapper)
{
  vtkFFDProbeView view;
  if (!mapper->MakeProbeView(view))
  {
    return VTK_DOUBLE_MAX;
  }
  const glm::dvec3 origin(p1[0], p1[1], p1[2]);
  const glm::dvec3 direction = glm::dvec3(p2[0], p2[1], p2[2]) - origin;
  if (!std::isfinite(glm::dot(origin, origin)) || !std::isfinite(glm::dot(direction, direction)) ||
    !ffd::ClipToBox(origin, direction, view.Deformed, t1, t2))
  {
    return VTK_DOUBLE_MAX;
  }
  const ffd::SurfaceSearch search(view.Volume, view.Map, origin, direction, view.OneToOne);
  const CroppingRegions cropping(view.Crop);
  const Visibility visibility(view, property, mapper, this->UseVolumeGradientOpacity != 0);
  if (!visibility.GetFirst())
  {
    return VTK_DOUBLE_MAX;
  }

  // From one stretch of the ray that is inside of the volume and not cropped to the next.
  const auto isShown = [&](const ffd::SurfacePoint& p) {
    return search.IsInside(p.Index) && !cropping.Hides(p);
  };
  const glm::dvec3 lower = view.Volume.LowerIndex();
  const glm::dvec3 upper = view.Volume.UpperIndex();
  const auto label = [&](const ffd::SurfacePoint& p) {
    const glm::ivec3 region = cropping.IsOn() ? cropping.Region(p) : glm::ivec3(0);
    int number = 0;
    for (int a = 0; a < 3; ++a)
    {
      number = 5 * number + (p.Index[a] < lower[a] ? 3 : p.Index[a] > upper[a] ? 4 : region[a]);
    }
    return number;
  };
  const auto isHitOrHidden = [&](const ffd::SurfacePoint& p) {
    return !isShown(p) || visibility.Find(p.Index, this->VolumeOpacityIsovalue);
  };
  ffd::SurfacePoint hit;
  int plane = -1;
  glm::dvec3 faceNormal(0.0);                   // at rest
  const Visibility::Channel* channel = nullptr; // that is hit; of a cropping plane none
  double from = t1;
  while (!channel)
  {
    ffd::SurfacePoint before;
    if (!search.FindFirst(from, t2, isShown, label, hit, before))
    {
      return VTK_DOUBLE_MAX;
    }
    const bool cameIn = before.T < hit.T;
    const ffd::SurfacePoint entry = hit;
    faceNormal = glm::dvec3(0.0);
    if (cameIn)
    {
      faceNormal = FindFaceNormal(view.Volume, before.Index);
      const bool throughFace = glm::dot(faceNormal, faceNormal) > 0.0;
      plane = throughFace ? -1 : cropping.FindPlane(before, hit);
      if (plane >= 0)
      {
        const int axis = plane / 2;
        faceNormal[axis] =
          cropping.Position(before)[axis] < cropping.Position(hit)[axis] ? -1.0 : 1.0;
        if (cropping.IsAtRest())
        {
          faceNormal = glm::transpose(view.Volume.DataToIndex) * faceNormal;
        }
      }
    }
    if (this->PickCroppingPlanes && cropping.IsOn())
    {
      break;
    }
    if (!search.FindFirst(entry.T, t2, isHitOrHidden, label, hit, before))
    {
      return VTK_DOUBLE_MAX;
    }
    channel = isShown(hit) ? visibility.Find(hit.Index, this->VolumeOpacityIsovalue) : nullptr;
    if (hit.T > entry.T)
    {
      faceNormal = glm::dvec3(0.0);
    }
    from = hit.T;
  }
  if (!(hit.T < this->GlobalTMin))
  {
    return hit.T;
  }

  this->ResetPickInfo();
  this->Mapper = mapper;
  this->DataSet = vtkDataSet::SafeDownCast(mapper->GetDataSetInput());
  this->CroppingPlaneId = plane;
  int extent[6] = { 0, 0, 0, 0, 0, 0 };
  if (auto* image = vtkImageData::SafeDownCast(this->DataSet))
  {
    image->GetExtent(extent);
  }
  else if (auto* grid = vtkRectilinearGrid::SafeDownCast(this->DataSet))
  {
    grid->GetExtent(extent);
  }
  // Scalars of cells are counted from the centers of these.
  const glm::dvec3 structured = visibility.ToVoxel(glm::clamp(hit.Index, lower, upper)) +
    view.Volume.Margin + glm::dvec3(extent[0], extent[2], extent[4]);
  this->SetImageDataPickInfo(&structured.x, extent);
  std::copy_n(&hit.Deformed.x, 3, this->MapperPosition);
  std::copy_n(&hit.Rest.x, 3, this->RestPosition);
  const Visibility::Channel& of = channel ? *channel : *visibility.GetFirst();
  this->Component = of.Component;
  this->ScalarValue = visibility.Value(of, glm::clamp(hit.Index, lower, upper));

  glm::dvec3 normal = faceNormal;
  const bool ofDeformedPlane = plane >= 0 && !cropping.IsAtRest();
  if (!(glm::dot(faceNormal, faceNormal) > 0.0) || !ofDeformedPlane)
  {
    const glm::dvec3 rest =
      glm::dot(faceNormal, faceNormal) > 0.0 ? faceNormal : -visibility.Gradient(of, hit.Index);
    normal = glm::transpose(search.EvaluateJacobian(hit)) * rest;
  }
  const double size = glm::dot(normal, normal);
  if (!(size > 0.0) || !std::isfinite(size))
  {
    // Back along the ray in the world, where normals are transformed by the inverse transpose.
    const glm::dmat3 toWorld = glm::dmat3(ffd::ToMatrix(this->Transform->GetMatrix()));
    normal = -(glm::transpose(toWorld) * (toWorld * direction));
  }
  normal = glm::normalize(normal);
  std::copy_n(&normal.x, 3, this->MapperNormal);
  return hit.T;
}
