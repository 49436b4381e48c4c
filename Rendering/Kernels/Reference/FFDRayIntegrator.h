// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDRayIntegrator_h
#define FFDRayIntegrator_h

#include "FFDCastScene.h"
#include "FFDCurveSegment.h"
#include "FFDExport.h"
#include "Optics/FFDIntervalTable.h"
#include "Optics/FFDSampleClassifier.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <limits>

namespace ffd
{

/// Settings that all rays of a frame share.
struct IntegrationFrame
{
  const SampleClassifier* Classifier = nullptr;
  const CastScene* Scene = nullptr;
  const CastSettings* Settings = nullptr;
  glm::dmat3 IndexToData{ 1.0 }; ///< of the volume at rest: lengths of deformed rays
  TransmittanceTable Transmittance;
  IntervalTable Intervals; ///< empty: samples are classified by themselves
};

/// Whether Classification::Intervals is possible: composited by ERROR_BOUND, one function of the
/// interpolated scalar (SampleClassifier::IsOneFunction()).
FFD_RENDERING_EXPORT bool CanClassifyIntervals(
  const CastScene& scene, const CastSettings& settings, const SampleClassifier& classifier);

/**
 * A segment of a deformed ray: its parameter s stands for t = T0 + s * Dt on the viewing ray. Each
 * ray caster knows in its own way how gradients change along it.
 */
class SampledSegment
{
public:
  CurveSegment Curve; ///< index coordinates
  double T0 = 0.0;
  double Dt = 0.0;

  SampledSegment() = default;
  SampledSegment(const CurveSegment& curve, double t0, double dt)
    : Curve(curve)
    , T0(t0)
    , Dt(dt)
  {
  }
  virtual ~SampledSegment() = default;

  /// NormalSource::ToDeformed() at s.
  virtual glm::dvec3 GradientToDeformed(double s, const glm::dvec3& byIndex) const = 0;
};

/**
 * The state of one ray, and what its samples do to it: the blend modes. Both ray casters hand it
 * the samples that they take, in the order of the ray; the packets do so where their own vector
 * code does not apply.
 */
class FFD_RENDERING_EXPORT RayIntegrator
{
public:
  /// A new ray, of which [from, to) is seen (t). `frame` must outlive its samples.
  void Begin(const IntegrationFrame& frame, const ViewRay& ray, double from, double to);

  struct Outcome
  {
    bool Visible;     ///< the sample shows
    bool Done;        ///< nothing that comes after it would
    float Extinction; ///< of the sample, per data unit
  };

  /**
   * The sample at `s` of a segment, which stands for an interval of length `interval` of s that
   * starts there. It must be inside of the volume and not be cropped; but where the blend mode uses
   * intervals, these may be anywhere: they are looked at for what is. With
   * Classification::Intervals what counts is the interval from the sample before, or from where the
   * ray is first seen, to it.
   */
  Outcome AddSample(const SampledSegment& segment, double s, double interval);

  /// Adds the only sample of BlendMode::Slice: index coordinates and t, inside of the volume.
  Outcome AddSlice(const glm::dvec3& q, double t);

  struct Result
  {
    glm::vec3 Color; ///< premultiplied
    float Transmittance;
    double FirstVisible; ///< t of the first sample that shows; infinite without one
  };
  Result End() const;

private:
  static constexpr int Components = Blending::LargestNumberOfComponents;

  /// Values of the components at an end of an interval, and where.
  struct Value
  {
    double S;
    double Scalar;
  };

  Outcome Composite(const SampledSegment& segment, double s, double interval);
  Outcome CompositeInterval(const SampledSegment& segment, double s, double interval);
  Outcome TakeExtreme(const SampledSegment& segment, double s);
  Outcome AddUp(const SampledSegment& segment, double s, double interval);
  Outcome CrossIsosurfaces(const SampledSegment& segment, double s, double interval);
  Outcome AddColor(const glm::vec3& color, float transmittance, double t);
  bool IsInside(const glm::dvec3& q) const;
  double ScalarAt(const glm::dvec3& q) const;
  double FindCrossing(const SampledSegment& segment, Value a, Value b, double value) const;
  double FindFace(const CurveSegment& curve, double inside, double outside) const;
  bool IsShown(const SampledSegment& segment, double s) const;
  bool IsCropped(const SampledSegment& segment, double s) const;
  double ClampedScalarAt(const CurveSegment& curve, double s) const;
  bool FindValues(const SampledSegment& segment, double s, double* values) const;
  double LengthOf(const SampledSegment& segment, double s, double interval) const;
  Result EndExtreme() const;
  Result EndSum() const;

  const IntegrationFrame* Frame = nullptr;
  ViewRay Ray{};
  double From = 0.0;
  double To = 0.0;
  glm::vec3 Color{ 0.0f };
  float Transmittance = 1.0f;
  double FirstVisible = std::numeric_limits<double>::infinity();

  // The extreme value with Maximum and Minimum (with dependent components all values of its
  // sample), the sums of the channels with Average and Additive.
  double Values[Components] = {};
  double Lengths[Components] = {}; // of the channels: what has been added up
  bool Any = false;                // whether there was a sample
  double Places[Components] = {};  // t of the extremes of the channels

  // The end of the last interval: mostly the start of the next one.
  double LastEnd = 0.0;
  double LastScalar = 0.0;
};

} // namespace ffd

#endif
