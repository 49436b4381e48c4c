// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDRayIntegrator.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace ffd
{
namespace
{

constexpr double Infinity = std::numeric_limits<double>::infinity();

/// Normals of samples on a segment.
class SegmentNormals : public NormalSource
{
public:
  SegmentNormals(
    const ViewRay& ray, const CameraView& camera, const SampledSegment& segment, double s)
    : NormalSource(ray, camera, segment.T0 + s * segment.Dt)
    , Segment(segment)
    , S(s)
  {
  }
  glm::dvec3 ToDeformed(const glm::dvec3& byIndex) const override
  {
    return this->Segment.GradientToDeformed(this->S, byIndex);
  }

private:
  const SampledSegment& Segment;
  double S;
};

} // namespace

//------------------------------------------------------------------------------
bool CanClassifyIntervals(
  const CastScene& scene, const CastSettings& settings, const SampleClassifier& classifier)
{
  return scene.Blend.Mode == BlendMode::Composite &&
    settings.Segments == Segmentation::ErrorBound && classifier.IsOneFunction();
}

//------------------------------------------------------------------------------
void RayIntegrator::Begin(const IntegrationFrame& frame, const ViewRay& ray, double from, double to)
{
  *this = RayIntegrator();
  this->Frame = &frame;
  this->Ray = ray;
  this->From = from;
  this->To = to;
  this->LastEnd = -Infinity;
}

//------------------------------------------------------------------------------
RayIntegrator::Outcome RayIntegrator::AddSample(
  const SampledSegment& segment, double s, double interval)
{
  switch (this->Frame->Scene->Blend.Mode)
  {
    case BlendMode::Maximum:
    case BlendMode::Minimum:
      return this->TakeExtreme(segment, s);
    case BlendMode::Average:
    case BlendMode::Additive:
      return this->AddUp(segment, s, interval);
    case BlendMode::Isosurface:
      return this->CrossIsosurfaces(segment, s, interval);
    case BlendMode::Slice:
      return this->AddSlice(glm::clamp(segment.Curve.At(s), this->Frame->Scene->Volume.LowerIndex(),
                              this->Frame->Scene->Volume.UpperIndex()),
        segment.T0 + s * segment.Dt);
    default:
      return this->Frame->Intervals.IsEmpty() ? this->Composite(segment, s, interval)
                                              : this->CompositeInterval(segment, s, interval);
  }
}

//------------------------------------------------------------------------------
RayIntegrator::Result RayIntegrator::End() const
{
  switch (this->Frame->Scene->Blend.Mode)
  {
    case BlendMode::Maximum:
    case BlendMode::Minimum:
      return this->EndExtreme();
    case BlendMode::Average:
    case BlendMode::Additive:
      return this->EndSum();
    default:
      return { this->Color, this->Transmittance, this->FirstVisible };
  }
}

//------------------------------------------------------------------------------
RayIntegrator::Outcome RayIntegrator::Composite(
  const SampledSegment& segment, double s, double interval)
{
  const IntegrationFrame& frame = *this->Frame;
  // Packets round otherwise when they find out whether it is inside.
  const glm::dvec3 q = glm::clamp(
    segment.Curve.At(s), frame.Scene->Volume.LowerIndex(), frame.Scene->Volume.UpperIndex());
  if (frame.Classifier->IsHidden(q))
  {
    return { false, false, 0.0f };
  }
  double values[SampleClassifier::LargestNumberOfComponents];
  frame.Classifier->Values(q, values);
  const SampleClassifier::Appearance sample = frame.Classifier->Classify(
    q, values, SegmentNormals(this->Ray, frame.Scene->Camera, segment, s));
  if (!(sample.Extinction > 0.0f))
  {
    return { false, false, 0.0f };
  }
  const double length = this->LengthOf(segment, s, interval);
  const float transmittance = frame.Transmittance(sample.Extinction * static_cast<float>(length));
  Outcome outcome = this->AddColor(sample.Color, transmittance, segment.T0 + s * segment.Dt);
  outcome.Extinction = sample.Extinction;
  return outcome;
}

//------------------------------------------------------------------------------
/**
 * The interval that ends at s, from the sample before or from where the ray enters the volume. Its
 * values run linearly from there to one between, and from there on; that one is where the light
 * comes from, if the values ran linearly between the two ends, so it is where steep functions are
 * crossed, and where normals are taken (Lum, Wilson, Ma 2004).
 */
RayIntegrator::Outcome RayIntegrator::CompositeInterval(
  const SampledSegment& segment, double s, double interval)
{
  const IntegrationFrame& frame = *this->Frame;
  const IntervalTable& table = frame.Intervals;
  const double t = segment.T0 + s * segment.Dt;
  const double before = t - interval * segment.Dt;
  const double back = this->ClampedScalarAt(segment.Curve, s);
  double first = s - (t - std::max(before, this->From)) / segment.Dt;
  double front = this->LastScalar;
  if (!(std::abs(before - this->LastEnd) < 1e-3 * interval * segment.Dt))
  {
    first =
      this->IsInside(segment.Curve.At(first)) ? first : this->FindFace(segment.Curve, s, first);
    front = this->IsCropped(segment, first) ? back : this->ClampedScalarAt(segment.Curve, first);
  }
  this->LastEnd = t;
  this->LastScalar = back;
  if (!table.MayShow(front, back))
  {
    return { false, false, 0.0f };
  }
  const double length = this->LengthOf(segment, s, s - first);
  const ClassifiedInterval guess = table.Classify(front, back, length);
  const double at = guess.OpticalDepth > 0.0 ? guess.Place : 0.5;
  const double middle = first + at * (s - first);
  const glm::dvec3 q = glm::clamp(
    segment.Curve.At(middle), frame.Scene->Volume.LowerIndex(), frame.Scene->Volume.UpperIndex());
  const ClassifiedInterval classified =
    table.Classify(front, this->ClampedScalarAt(segment.Curve, middle), back, at, length);
  if (!(classified.OpticalDepth > 0.0))
  {
    return { false, false, 0.0f };
  }
  const glm::vec3 color =
    frame.Classifier->Light(0, q, glm::vec3(frame.Classifier->ClassifyValue(0, classified.Value)),
      SegmentNormals(this->Ray, frame.Scene->Camera, segment, middle));
  Outcome outcome =
    this->AddColor(color, frame.Transmittance(static_cast<float>(classified.OpticalDepth)),
      segment.T0 + (first + classified.Place * (s - first)) * segment.Dt);
  outcome.Extinction = static_cast<float>(classified.OpticalDepth / length);
  return outcome;
}

//------------------------------------------------------------------------------
RayIntegrator::Outcome RayIntegrator::AddColor(
  const glm::vec3& color, float transmittance, double t)
{
  this->FirstVisible = std::min(this->FirstVisible, t);
  this->Color += (this->Transmittance * (1.0f - transmittance)) * color;
  this->Transmittance *= transmittance;
  return { true, this->Transmittance < this->Frame->Settings->TerminationTransmittance, 0.0f };
}

//------------------------------------------------------------------------------
/// Length by which a sample counts, data units.
double RayIntegrator::LengthOf(const SampledSegment& segment, double s, double interval) const
{
  return this->Frame->Settings->Opacity == OpacityLength::Deformed
    ? interval * segment.Dt
    : interval * glm::length(this->Frame->IndexToData * segment.Curve.Velocity(s));
}

//------------------------------------------------------------------------------
/// Values of all components at s; false where the volume is hidden.
bool RayIntegrator::FindValues(const SampledSegment& segment, double s, double* values) const
{
  const IntegrationFrame& frame = *this->Frame;
  const glm::dvec3 q = glm::clamp(
    segment.Curve.At(s), frame.Scene->Volume.LowerIndex(), frame.Scene->Volume.UpperIndex());
  if (frame.Classifier->IsHidden(q))
  {
    return false;
  }
  frame.Classifier->Values(q, values);
  return true;
}

//------------------------------------------------------------------------------
RayIntegrator::Outcome RayIntegrator::TakeExtreme(const SampledSegment& segment, double s)
{
  const IntegrationFrame& frame = *this->Frame;
  const Blending& blend = frame.Scene->Blend;
  double values[SampleClassifier::LargestNumberOfComponents];
  if (!this->FindValues(segment, s, values))
  {
    return { false, false, 0.0f };
  }
  const SampleClassifier& classifier = *frame.Classifier;
  const bool maximum = blend.Mode == BlendMode::Maximum;
  bool visible = false;
  bool done = true;
  for (int c = 0; c < classifier.GetNumberOfChannels(); ++c)
  {
    // Values that are not a number do not count.
    const double density = classifier.FindDensity(c, values);
    double extreme = classifier.FindDensity(c, this->Values);
    const bool better = !std::isnan(density) &&
      (!(this->Lengths[c] > 0.0) || (maximum ? density > extreme : density < extreme));
    if (better)
    {
      extreme = density;
      if (classifier.IsDependent())
      {
        std::copy_n(values, classifier.GetNumberOfComponents(), this->Values);
      }
      else
      {
        this->Values[c] = values[c];
      }
      this->Lengths[c] = 1.0;
      this->Places[c] = segment.T0 + s * segment.Dt;
      visible = true;
    }
    // Nothing is beyond the ends of the range.
    done = done && this->Lengths[c] > 0.0 &&
      (maximum ? extreme >= blend.High[c] : extreme <= blend.Low[c]);
  }
  return { visible, done, 0.0f };
}

//------------------------------------------------------------------------------
RayIntegrator::Result RayIntegrator::EndExtreme() const
{
  const IntegrationFrame& frame = *this->Frame;
  glm::vec3 color(0.0f);
  float opacity = 0.0f;
  double place = Infinity;
  for (int c = 0; c < frame.Classifier->GetNumberOfChannels(); ++c)
  {
    if (this->Lengths[c] > 0.0)
    {
      const glm::vec4 classified = frame.Classifier->ClassifyValues(c, this->Values);
      const float alpha = classified.a * static_cast<float>(frame.Scene->Blend.Weight[c]);
      place = alpha > 0.0f && opacity == 0.0f ? this->Places[c] : place;
      color += alpha * glm::vec3(classified);
      opacity += alpha;
    }
  }
  opacity = std::min(opacity, 1.0f);
  return { glm::min(color, glm::vec3(opacity)), 1.0f - opacity, place };
}

//------------------------------------------------------------------------------
RayIntegrator::Outcome RayIntegrator::AddUp(
  const SampledSegment& segment, double s, double interval)
{
  const IntegrationFrame& frame = *this->Frame;
  const Blending& blend = frame.Scene->Blend;
  double values[SampleClassifier::LargestNumberOfComponents];
  if (!this->FindValues(segment, s, values))
  {
    return { false, false, 0.0f };
  }
  const bool average = blend.Mode == BlendMode::Average;
  const double length = this->LengthOf(segment, s, interval);
  bool visible = false;
  for (int c = 0; c < frame.Classifier->GetNumberOfChannels(); ++c)
  {
    // In this order values that are not a number do not count.
    const double intensity = frame.Classifier->FindIntensity(c, values);
    if (!(intensity == intensity) || std::isnan(frame.Classifier->FindDensity(c, values)) ||
      (average && !(intensity >= blend.AverageMin && intensity <= blend.AverageMax)))
    {
      continue;
    }
    const double opacity = static_cast<double>(frame.Classifier->ClassifyValues(c, values).a);
    const double relative = (intensity - blend.Low[c]) / (blend.High[c] - blend.Low[c]);
    this->Values[c] += opacity * relative * length;
    this->Lengths[c] += length;
    visible = true;
  }
  if (visible)
  {
    this->Any = true;
    this->FirstVisible = std::min(this->FirstVisible, segment.T0 + s * segment.Dt);
  }
  return { visible, false, 0.0f };
}

//------------------------------------------------------------------------------
RayIntegrator::Result RayIntegrator::EndSum() const
{
  const IntegrationFrame& frame = *this->Frame;
  const Blending& blend = frame.Scene->Blend;
  if (!this->Any)
  {
    return { glm::vec3(0.0f), 1.0f, Infinity };
  }
  double sum = 0.0;
  for (int c = 0; c < frame.Classifier->GetNumberOfChannels(); ++c)
  {
    const double over = blend.Mode == BlendMode::Average ? this->Lengths[c] : blend.UnitDistance[c];
    sum += over > 0.0 ? blend.Weight[c] * this->Values[c] / over : 0.0;
  }
  return { glm::vec3(static_cast<float>(std::clamp(sum, 0.0, 1.0))), 0.0f, this->FirstVisible };
}

//------------------------------------------------------------------------------
bool RayIntegrator::IsInside(const glm::dvec3& q) const
{
  const glm::dvec3 lower = this->Frame->Scene->Volume.LowerIndex();
  const glm::dvec3 upper = this->Frame->Scene->Volume.UpperIndex();
  return q.x >= lower.x && q.y >= lower.y && q.z >= lower.z && q.x <= upper.x && q.y <= upper.y &&
    q.z <= upper.z;
}

//------------------------------------------------------------------------------
double RayIntegrator::ScalarAt(const glm::dvec3& q) const
{
  double values[SampleClassifier::LargestNumberOfComponents];
  this->Frame->Classifier->Values(q, values);
  return this->Frame->Classifier->FindIntensity(this->Frame->Scene->Blend.IsoComponent, values);
}

//------------------------------------------------------------------------------
/// The last position inside of the volume on the way out of it.
double RayIntegrator::FindFace(const CurveSegment& curve, double inside, double outside) const
{
  for (int i = 0; i < 24; ++i)
  {
    const double middle = 0.5 * (inside + outside);
    (this->IsInside(curve.At(middle)) ? inside : outside) = middle;
  }
  return inside;
}

//------------------------------------------------------------------------------
/// Finds s where the scalar is `value` between a and b, by the Illinois method: the value at one
/// end counts half once that end has stayed.
double RayIntegrator::FindCrossing(
  const SampledSegment& segment, Value a, Value b, double value) const
{
  double fa = a.Scalar - value;
  double fb = b.Scalar - value;
  if (fa == 0.0 || fb == 0.0)
  {
    return fa == 0.0 ? a.S : b.S;
  }
  const double close = 1e-6 * std::abs(b.S - a.S);
  const glm::dvec3 lower = this->Frame->Scene->Volume.LowerIndex();
  const glm::dvec3 upper = this->Frame->Scene->Volume.UpperIndex();
  int stayed = 0;
  for (int i = 0; i < 50 && std::abs(b.S - a.S) > close; ++i)
  {
    double s = (fa * b.S - fb * a.S) / (fa - fb);
    if (!(s > a.S && s < b.S))
    {
      s = 0.5 * (a.S + b.S);
    }
    const double f = this->ScalarAt(glm::clamp(segment.Curve.At(s), lower, upper)) - value;
    if (f == 0.0)
    {
      return s;
    }
    if ((f < 0.0) == (fb < 0.0))
    {
      b.S = s;
      fb = f;
      fa *= stayed == -1 ? 0.5 : 1.0;
      stayed = -1;
    }
    else
    {
      a.S = s;
      fa = f;
      fb *= stayed == 1 ? 0.5 : 1.0;
      stayed = 1;
    }
  }
  // Behind the crossing: between the nearest voxels of both sides it would be left to rounding
  // whose gradient is taken.
  return b.S;
}

//------------------------------------------------------------------------------
/// Whether the ray is seen there and nothing is cropped.
bool RayIntegrator::IsShown(const SampledSegment& segment, double s) const
{
  const double t = segment.T0 + s * segment.Dt;
  return t >= this->From && t < this->To && !this->IsCropped(segment, s);
}

//------------------------------------------------------------------------------
bool RayIntegrator::IsCropped(const SampledSegment& segment, double s) const
{
  const Cropping& crop = this->Frame->Scene->Crop;
  switch (crop.Space)
  {
    case Cropping::Spaces::Rest:
      return !crop.Shows(segment.Curve.At(s));
    case Cropping::Spaces::Deformed:
      return !crop.Shows(this->Ray.Origin + (segment.T0 + s * segment.Dt) * this->Ray.Direction);
    default:
      return false;
  }
}

//------------------------------------------------------------------------------
/// The value of the only component, beyond the faces of the volume that at the next face.
double RayIntegrator::ClampedScalarAt(const CurveSegment& curve, double s) const
{
  const VolumeView& volume = this->Frame->Scene->Volume;
  double values[SampleClassifier::LargestNumberOfComponents];
  this->Frame->Classifier->Values(
    glm::clamp(curve.At(s), volume.LowerIndex(), volume.UpperIndex()), values);
  return values[0];
}

//------------------------------------------------------------------------------
RayIntegrator::Outcome RayIntegrator::CrossIsosurfaces(
  const SampledSegment& segment, double s, double interval)
{
  const IntegrationFrame& frame = *this->Frame;
  const std::vector<IsoValue>& isos = frame.Scene->Blend.IsoValues;
  Value a{ s, 0.0 };
  Value b{ std::min(s + interval, 1.0), 0.0 };
  const bool insideA = this->IsInside(segment.Curve.At(a.S));
  const bool insideB = this->IsInside(segment.Curve.At(b.S));
  if (!insideA && !insideB)
  {
    return { false, false, 0.0f };
  }
  if (insideA)
  {
    // Intervals that follow each other share a value: no surface slips through between them.
    const double t = segment.T0 + a.S * segment.Dt;
    a.Scalar = std::abs(t - this->LastEnd) < 1e-3 * interval * segment.Dt
      ? this->LastScalar
      : this->ScalarAt(segment.Curve.At(a.S));
  }
  else
  {
    a.S = this->FindFace(segment.Curve, b.S, a.S);
    a.Scalar = this->ScalarAt(segment.Curve.At(a.S));
  }
  if (!insideB)
  {
    b.S = this->FindFace(segment.Curve, a.S, b.S);
  }
  b.Scalar = this->ScalarAt(segment.Curve.At(b.S));
  this->LastEnd = insideB ? segment.T0 + b.S * segment.Dt : -Infinity;
  this->LastScalar = b.Scalar;

  // Values ascend, so do the crossings, or they descend. One at an end belongs to the interval
  // where the scalar passes it. Comparisons with what is not a number find none.
  Outcome outcome{ false, false, 0.0f };
  if (!(a.Scalar < b.Scalar) && !(a.Scalar > b.Scalar))
  {
    return outcome;
  }
  const bool up = a.Scalar < b.Scalar;
  const double low = std::min(a.Scalar, b.Scalar);
  const double high = std::max(a.Scalar, b.Scalar);
  const auto below = [](const IsoValue& iso, double value) { return iso.Value <= value; };
  const auto first = std::lower_bound(isos.begin(), isos.end(), low, below);
  const auto last = std::lower_bound(first, isos.end(), high, below);
  const std::size_t count = static_cast<std::size_t>(last - first);
  for (std::size_t i = 0; i < count && !outcome.Done; ++i)
  {
    const IsoValue& iso = up ? first[static_cast<std::ptrdiff_t>(i)]
                             : first[static_cast<std::ptrdiff_t>(count - 1 - i)];
    if (!(iso.Opacity > 0.0f))
    {
      continue;
    }
    const double at = this->FindCrossing(segment, a, b, iso.Value);
    const glm::dvec3 q = glm::clamp(
      segment.Curve.At(at), frame.Scene->Volume.LowerIndex(), frame.Scene->Volume.UpperIndex());
    if (this->IsShown(segment, at) && !frame.Classifier->IsHidden(q))
    {
      const glm::vec3 color = frame.Classifier->Light(frame.Scene->Blend.IsoComponent, q, iso.Color,
        SegmentNormals(this->Ray, frame.Scene->Camera, segment, at));
      outcome = this->AddColor(color, 1.0f - iso.Opacity, segment.T0 + at * segment.Dt);
    }
  }
  return outcome;
}

//------------------------------------------------------------------------------
RayIntegrator::Outcome RayIntegrator::AddSlice(const glm::dvec3& q, double t)
{
  const IntegrationFrame& frame = *this->Frame;
  if (frame.Classifier->IsHidden(q))
  {
    return { false, true, 0.0f };
  }
  double values[SampleClassifier::LargestNumberOfComponents];
  frame.Classifier->Values(q, values);
  glm::vec3 color(0.0f);
  float opacity = 0.0f;
  for (int c = 0; c < frame.Classifier->GetNumberOfChannels(); ++c)
  {
    const glm::vec4 classified = std::isnan(frame.Classifier->FindDensity(c, values))
      ? glm::vec4(0.0f)
      : frame.Classifier->ClassifyValues(c, values);
    const float alpha = classified.a * static_cast<float>(frame.Scene->Blend.Weight[c]);
    color += alpha * glm::vec3(classified);
    opacity += alpha;
  }
  opacity = std::min(opacity, 1.0f);
  if (!(opacity > 0.0f))
  {
    return { false, true, 0.0f };
  }
  this->Color = glm::min(color, glm::vec3(opacity));
  this->Transmittance = 1.0f - opacity;
  this->FirstVisible = t;
  return { true, true, 0.0f };
}

} // namespace ffd
