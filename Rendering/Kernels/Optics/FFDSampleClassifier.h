// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDSampleClassifier_h
#define FFDSampleClassifier_h

#include "FFDCameraView.h"
#include "FFDCellMask.h"
#include "FFDExport.h"
#include "FFDLabelBlocks.h"
#include "FFDOpticalFunctions.h"
#include "FFDSampling.h"
#include "FFDShading.h"
#include "FFDTransferTable.h"
#include "FFDVolumeView.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <memory>
#include <vector>

namespace ffd
{

/// The place of a sample in deformed space, from which its normals and its lighting are found, on
/// demand.
class NormalSource
{
public:
  NormalSource(const ViewRay& ray, const CameraView& camera, double t)
    : Ray(ray)
    , Camera(camera)
    , T(t)
  {
  }
  virtual ~NormalSource() = default;

  /// The gradient by data coordinates of a field on the deformed volume, from that by index
  /// coordinates of the field at rest: J_Phi^T grad f.
  virtual glm::dvec3 ToDeformed(const glm::dvec3& byIndex) const = 0;

  glm::dvec3 GetPosition() const { return this->Ray.Origin + this->T * this->Ray.Direction; }

  /// Unit vector of data coordinates.
  glm::dvec3 GetToEye() const { return this->Camera.ToEye(this->Ray, this->GetPosition()); }

private:
  const ViewRay& Ray;
  const CameraView& Camera;
  double T;
};

/// A volume of labels, or of what is inside (more than 0), on a grid of its own.
struct MaskView
{
  VolumeView Volume;   ///< Scalars is null: no mask
  bool Labels = false; ///< a label map, else a binary mask
  float BlendFactor =
    1.0f; ///< weight of a label's color and opacity; the rest is that of the scalars
  /// Voxel for voxel the grid of the scalars; else a place of its own, by Volume.
  bool SameGrid = true;
  const LabelBlocks* Blocks = nullptr; ///< of Volume, or null
};

/// The inputs of SampleClassifier. What is pointed to outlives
/// it.
struct ClassifierInputs
{
  VolumeView Volume;
  Interpolation VolumeInterpolation = Interpolation::Linear;
  const OpticalFunctions* Functions = nullptr;
  const Shading* Material = nullptr; ///< for its lights: surfaces are those of Functions
  MaskView Mask;
  const CellMask* Hidden = nullptr; ///< cells where there is nothing, or null
  /// Second axis of TransferPlane: scalars on the same grid; none: magnitude of the gradient.
  VolumeView SecondAxis;
  bool NormalFromOpacity = false; ///< normals are those of the opacity, not of the scalars
  /// Where dot(plane, (P, 1)) < 0, P in deformed space, gradients count ClippedIntensity as the
  /// value of the voxels.
  std::vector<glm::dvec4> ClippingPlanes;
  double ClippedIntensity = 0.0;
  /// Length, data units, of the intervals for which opacities multiply and add up as in VTK: its
  /// sample distance.
  double ReferenceLength = 1.0;
};

/**
 * Finds color, opacity and lighting of samples of the volume at rest. Immutable, one for a frame,
 * used by any number of threads. Positions are index coordinates inside of the volume.
 *
 * Conventions are those of VTK's volume mappers. Opacities of an interval of the reference length
 * are weighted and multiplied by the gradient opacity; several independent components add up to
 * the opacity sum(a^2) / sum(a) and the premultiplied color sum(a c). Magnitudes of gradients are
 * those of FindDifferences(), in scalar units per mean edge of a voxel, of
 * the volume at rest: tissue looks the same wherever the deformation takes it. Normals are those
 * of the deformed volume.
 */
class FFD_RENDERING_EXPORT SampleClassifier
{
public:
  static constexpr int LargestNumberOfComponents = 4;

  explicit SampleClassifier(const ClassifierInputs& inputs);

  /// One component with its table; `shade`: whether colors are lit. What is referred to must
  /// outlive the classifier.
  SampleClassifier(const VolumeView& volume, Interpolation interpolation,
    const TransferTable& table, const Shading& material, bool shade);

  /// Whether gradients are looked at that count GetClippedIntensity() as the value of voxels behind
  /// clipping planes.
  bool ClipsGradients() const { return this->ClippedGradients; }
  double GetClippedIntensity() const { return this->In.ClippedIntensity; }

  /// Whether the normals of what is shaded are those of the opacity, not of the scalars.
  bool HasNormalsOfOpacity() const { return this->NormalsOfOpacity; }

  /// Whether looks depend on nothing but the value of one component, interpolated between voxels,
  /// and nothing is hidden: then that of an interval between samples can be told.
  bool IsOneFunction() const;

  const MaskView& GetMask() const { return this->In.Mask; }
  const CellMask* GetHidden() const { return this->In.Hidden; }
  const VolumeView& GetSecondAxis() const { return this->In.SecondAxis; }
  const OpticalFunctions& GetFunctions() const { return *this->In.Functions; }

  /// Takes index coordinates of the volume to those of a mask on a grid of its own.
  const glm::dmat3& GetToMask() const { return this->ToMask; }
  const glm::dvec3& GetMaskOffset() const { return this->MaskOffset; }

  /// That of the first component, and what takes gradients by index coordinates to its magnitudes.
  const GradientOpacity& GetGradientOpacity() const
  {
    return this->In.Functions->Components[0].Gradients;
  }
  const glm::dvec3& GetMagnitudeScale() const { return this->MagnitudeScale; }
  double GetReferenceLength() const { return this->In.ReferenceLength; }

  int GetNumberOfComponents() const { return this->In.Volume.Components; }

  /// Whether there is nothing at `q`, whatever the scalars: blanked, or outside of a binary mask.
  bool IsHidden(const glm::dvec3& q) const { return this->MayHide && this->FindHidden(q); }

  /// Interpolated value of each component; scalars of cells beside hidden ones are not
  /// interpolated.
  void Values(const glm::dvec3& q, double* values) const;

  /// A classified sample.
  struct Appearance
  {
    glm::vec3 Color;
    float Extinction; ///< per data unit; 0: transparent
  };

  /// The sample at `q`, whose values are `values`, lit if the material is shaded.
  Appearance Classify(const glm::dvec3& q, const double* values, const NormalSource& normals) const;

  /// Number of channels of blend modes other than compositing: the independent components, or one
  /// for all dependent ones.
  int GetNumberOfChannels() const { return this->IsDependent() ? 1 : this->In.Volume.Components; }
  bool IsDependent() const { return this->In.Functions->Kind != ComponentKind::Independent; }

  /// Of all values at a sample, what is looked up for the opacity of a channel. Of three colors
  /// the luminance.
  double FindDensity(int channel, const double* values) const
  {
    return this->DensityOf(channel, values);
  }

  /// The intensity of a channel, of all values at a sample: its value, the first of dependent ones,
  /// or of three colors the luminance.
  double FindIntensity(int channel, const double* values) const;

  /// Color (not premultiplied, not lit) and opacity of a value of an independent component, over
  /// the opacity unit distance. Gradients count as large: gradient opacities are not applied. Of
  /// dependent components the opacity of a density, without a color.
  glm::vec4 ClassifyValue(int component, double value) const;

  /// The same of a channel where the values are `values`.
  glm::vec4 ClassifyValues(int channel, const double* values) const;

  /// A color at `q` lit by the material of a channel, with the normal of its intensity; the color
  /// itself where nothing is shaded.
  glm::vec3 Light(
    int channel, const glm::dvec3& q, const glm::vec3& color, const NormalSource& normals) const;

private:
  class Point;
  struct Emission;

  const ComponentOptics& OpticsOf(int component) const;
  double DensityOf(int component, const double* values) const;
  glm::vec3 DirectColor(const double* values) const;
  bool HasDirectColors() const;
  bool FindHidden(const glm::dvec3& q) const;
  glm::dvec3 ToVoxel(const glm::dvec3& q) const;
  glm::dvec3 ToIndex(const glm::dvec3& voxel) const;
  double MaskAt(const glm::dvec3& q) const;
  class ClippedSpace;
  glm::dvec3 FindGradient(
    int component, const glm::dvec3& q, bool ofIntensity, const NormalSource& normals) const;
  glm::dvec3 FindOpacityGradient(
    int component, const glm::dvec3& q, const NormalSource& normals) const;
  template <class Field>
  glm::dvec3 Difference(const glm::dvec3& voxel, const Field& field) const;
  double FindMagnitude(const glm::dvec3& gradient) const;
  Emission FindEmission(
    int component, const glm::dvec3& q, const double* values, Point& point) const;
  Emission FindLabelEmission(const LabelOptics& label, const double* values, Point& point) const;
  glm::vec3 LitColor(
    int component, const glm::vec3& color, Point& point, const NormalSource& normals) const;
  Appearance ToAppearance(const Emission& emission) const;
  Appearance ClassifyIndependent(
    const glm::dvec3& q, const double* values, const NormalSource& normals) const;

  ClassifierInputs In;
  std::unique_ptr<OpticalFunctions> OwnFunctions;
  VolumeView ComponentViews[LargestNumberOfComponents];
  SampleFunctions Fetch;
  SampleFunctions FetchNearest; // beside hidden cells
  SampleFunctions FetchMask;
  SampleFunctions FetchSecondAxis;
  glm::dvec3 MagnitudeScale{ 1.0 };
  glm::dmat3 ToMask{ 1.0 }; // index coordinates to those of the mask
  glm::dvec3 MaskOffset{ 0.0 };
  bool ClippedGradients = false;
  bool NormalsOfOpacity = false;
  bool MayHide = false;
};

} // namespace ffd

#endif
