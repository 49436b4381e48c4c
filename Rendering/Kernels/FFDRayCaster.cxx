// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDRayCaster.h"

#include "FFDCurveSegment.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

namespace ffd
{
namespace
{

constexpr double Infinity = std::numeric_limits<double>::infinity();

/// Kept between a leap and the faces of the empty box, index units: rounding errors.
constexpr double LeapGuard = 1e-3;

bool IsInside(const VolumeView& volume, const glm::dvec3& q)
{
  const double lower = -volume.Margin;
  const glm::dvec3 upper = volume.UpperIndex();
  // False for positions that are not a number, too.
  return q.x >= lower && q.y >= lower && q.z >= lower && q.x <= upper.x && q.y <= upper.y &&
    q.z <= upper.z;
}

bool Contains(const EmptyBox& box, const glm::dvec3& q)
{
  return q.x >= box.Min.x && q.y >= box.Min.y && q.z >= box.Min.z && q.x <= box.Max.x &&
    q.y <= box.Max.y && q.z <= box.Max.z;
}

/// How many further steps of `ds` from position s of the segment stay inside the box for certain.
int CountStepsInside(
  const CurveSegment& segment, double s, double ds, int stepsLeft, const EmptyBox& box)
{
  const glm::dvec3 q = segment.At(s);
  const glm::dvec3 v0 = segment.Velocity(s);
  // The velocity is linear in s, so the ends of what is left of the segment bound it.
  const glm::dvec3 v1 = segment.Velocity(s + stepsLeft * ds);
  double steps = stepsLeft;
  for (int a = 0; a < 3; ++a)
  {
    const double up = std::max(v0[a], v1[a]) * ds;
    const double down = -std::min(v0[a], v1[a]) * ds;
    if (up > 0.0)
    {
      steps = std::min(steps, (box.Max[a] - q[a] - LeapGuard) / up);
    }
    if (down > 0.0)
    {
      steps = std::min(steps, (q[a] - box.Min[a] - LeapGuard) / down);
    }
  }
  return steps > 0.0 ? static_cast<int>(steps) : 0;
}

/// Narrow [from, to] to the part of a ray where dot(plane, (P, 1)) >= 0.
void ClipToPlane(const glm::dvec4& plane, const ViewRay& ray, double& from, double& to)
{
  const double slope = glm::dot(glm::dvec3(plane), ray.Direction);
  const double start = glm::dot(plane, glm::dvec4(ray.Origin, 1.0));
  if (slope > 0.0)
  {
    from = std::max(from, -start / slope);
  }
  else if (slope < 0.0)
  {
    to = std::min(to, -start / slope);
  }
  else if (!(start >= 0.0))
  {
    to = from;
  }
}

/// Narrow [from, to] to the part of a line inside a box; false when nothing is left.
bool ClipToBox(
  const glm::dvec3& origin, const glm::dvec3& direction, const Box& box, double& from, double& to)
{
  for (int a = 0; a < 3; ++a)
  {
    if (direction[a] == 0.0)
    {
      if (origin[a] < box.Min[a] || origin[a] > box.Max[a])
      {
        return false;
      }
      continue;
    }
    const double t0 = (box.Min[a] - origin[a]) / direction[a];
    const double t1 = (box.Max[a] - origin[a]) / direction[a];
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
  }
  return from < to;
}

} // namespace

//------------------------------------------------------------------------------
struct RayCaster::Ray
{
  ViewRay Viewing;
  glm::dvec3 Origin;    // data coordinates
  glm::dvec3 Direction; // per data unit of the viewing ray
  double From = 0.0;
  double To = 0.0;
  double Jitter = 0.0; // of its samples, as parts of intervals
  double Phase = 0.0;  // the same, from multiples of the sample distance
  int X = 0;
  int Y = 0;
};

//------------------------------------------------------------------------------
struct RayCaster::Pixel
{
  RayIntegrator Integrator;
  bool Done = false;          // early ray termination
  TracedRay* Trace = nullptr; // where to note what is done, or null

  Pixel(const IntegrationFrame& frame, const Ray& ray)
  {
    this->Integrator.Begin(frame, ray.Viewing, ray.From, ray.To);
  }

  /// A segment from `from` to `to`; what is sampled afterwards lies on it.
  void NoteSegment(const CurveSegment& curve, double from, double to, bool passed)
  {
    if (this->Trace)
    {
      const std::size_t at = this->Trace->Samples.size();
      this->Trace->Segments.push_back({ curve, from, to, passed, at, at });
    }
  }
  void NoteSample(const glm::dvec3& q, double t, double interval, bool leap, float extinction)
  {
    if (this->Trace)
    {
      this->Trace->Samples.push_back({ q, t, interval, leap, extinction });
      this->Trace->Segments.back().EndSample = this->Trace->Samples.size();
    }
  }
};

//------------------------------------------------------------------------------
/// A segment whose J_Phi is given by `jacobianAt(s)`, called for what is shaded only.
template <class JacobianAt>
class RayCaster::JacobianSegment : public SampledSegment
{
public:
  JacobianSegment(const RayCaster& caster, const CurveSegment& curve, double t0, double dt,
    const JacobianAt& jacobianAt)
    : SampledSegment(curve, t0, dt)
    , Caster(caster)
    , At(jacobianAt)
  {
  }
  glm::dvec3 GradientToDeformed(double s, const glm::dvec3& byIndex) const override
  {
    // Scalars on the ray are f(Phi(P)), so their gradient in deformed space is J_Phi^T grad f.
    const glm::dvec3 rest = this->Caster.GradientToRest * byIndex;
    return glm::transpose(this->At(s)) * rest;
  }

private:
  const RayCaster& Caster;
  const JacobianAt& At;
};

//------------------------------------------------------------------------------
/// Takes the samples of one segment of a deformed ray: all that comes after the segmentation,
/// shared by both of them.
class RayCaster::Sampler
{
public:
  Sampler(const RayCaster& caster, const Ray& ray, Pixel& pixel, CastStatistics& statistics)
    : Caster(caster)
    , ViewingRay(ray)
    , Out(pixel)
    , Statistics(statistics)
    , Upper(caster.Scene.Volume.UpperIndex())
  {
  }

  /// Integrate one segment.
  void Integrate(const SampledSegment& segment, const SampleSchedule& schedule)
  {
    const CastScene& scene = this->Caster.Scene;
    const bool leap = this->Caster.Settings.Leaping != SpaceLeaping::Off;
    const bool lipschitz = this->Caster.Settings.Leaping == SpaceLeaping::Lipschitz;
    const bool intervals = scene.Blend.UsesIntervals();
    for (int i = 0; i < schedule.Count; ++i)
    {
      const double s = schedule.Position(i);
      const glm::dvec3 q = segment.Curve.At(s);
      const bool inside = IsInside(scene.Volume, q);
      // Leaps of the paper end with the segment; ours know what was found before it.
      const bool known = lipschitz && Contains(this->LastEmptyBox, q);
      if (known ||
        (leap &&
          scene.Distances->FindEmptyBox(q, this->Upper, this->LastEmptyBox, scene.Volume.Margin)))
      {
        if (inside && !known)
        {
          ++this->Statistics.DistanceLookups;
          this->Out.NoteSample(
            q, segment.T0 + s * segment.Dt, schedule.Interval(i) * segment.Dt, true, 0.0f);
        }
        if (!intervals)
        {
          i += CountStepsInside(
            segment.Curve, s, schedule.Step, schedule.Count - 1 - i, this->LastEmptyBox);
          continue;
        }
        // An interval is empty if its end is in the box, too.
        const int empty =
          CountStepsInside(segment.Curve, s, schedule.Step, schedule.Count - i, this->LastEmptyBox);
        if (empty > 0)
        {
          i += empty - 1;
          continue;
        }
      }
      if (!intervals && (!inside || !this->IsShown(q, segment.T0 + s * segment.Dt)))
      {
        continue;
      }
      ++this->Statistics.Samples;
      const RayIntegrator::Outcome outcome =
        this->Out.Integrator.AddSample(segment, s, schedule.Interval(i));
      this->Out.NoteSample(q, segment.T0 + s * segment.Dt, schedule.Interval(i) * segment.Dt, false,
        outcome.Extinction);
      this->Statistics.VisibleSamples += outcome.Visible ? 1 : 0;
      if (outcome.Done)
      {
        this->Out.Done = true;
        return;
      }
    }
  }

  const EmptyBox& GetLastEmptyBox() const { return this->LastEmptyBox; }
  void SetLastEmptyBox(const EmptyBox& box) { this->LastEmptyBox = box; }
  void ForgetEmptyBox() { this->LastEmptyBox = NoBox(); }

private:
  static EmptyBox NoBox() { return { glm::dvec3(Infinity), glm::dvec3(-Infinity) }; }

  /// Whether a sample is not cropped.
  bool IsShown(const glm::dvec3& q, double t) const
  {
    const Cropping& crop = this->Caster.Scene.Crop;
    switch (crop.Space)
    {
      case Cropping::Spaces::Rest:
        return crop.Shows(q);
      case Cropping::Spaces::Deformed:
        return crop.Shows(this->ViewingRay.Origin + t * this->ViewingRay.Direction);
      default:
        return true;
    }
  }

  const RayCaster& Caster;
  const Ray& ViewingRay;
  Pixel& Out;
  CastStatistics& Statistics;
  glm::dvec3 Upper;
  EmptyBox LastEmptyBox = NoBox();
};

//------------------------------------------------------------------------------
void CastStatistics::Add(const CastStatistics& other)
{
  this->Rays += other.Rays;
  this->Segments += other.Segments;
  this->SegmentLength += other.SegmentLength;
  this->Samples += other.Samples;
  this->VisibleSamples += other.VisibleSamples;
  this->DistanceLookups += other.DistanceLookups;
  this->Evaluations += other.Evaluations;
  this->Unconverged += other.Unconverged;
}

//------------------------------------------------------------------------------
RayCaster::RayCaster(const CastScene& scene, const CastSettings& settings)
  : Scene(scene)
  , Settings(settings)
  , GradientToRest(glm::transpose(scene.Volume.DataToIndex))
  , RestBox(FindRestBox(scene.Volume, scene.WholeAtRest))
  , Visible(scene.Blend.Mode == BlendMode::Slice || !scene.Distances ||
      settings.Leaping == SpaceLeaping::Off ||
      // The paper's method counts what it does in empty space, too.
      (settings.Segments == Segmentation::GreedyAngle &&
        settings.Leaping == SpaceLeaping::Segment) ||
      scene.Distances->IsAnythingVisible())
{
  if (!this->Scene.Classifier)
  {
    this->OwnClassifier.reset(
      new SampleClassifier(this->Scene.Volume, this->Scene.VolumeInterpolation, *this->Scene.Table,
        this->Scene.Material, this->Settings.Shade));
    this->Scene.Classifier = this->OwnClassifier.get();
  }
  this->Frame.Classifier = this->Scene.Classifier;
  this->Frame.Scene = &this->Scene;
  this->Frame.Settings = &this->Settings;
  this->Frame.IndexToData = scene.Volume.IndexToData;
  if (this->Visible && PacketCaster::Supports(scene, settings))
  {
    this->Packets.reset(new PacketCaster(this->Scene, this->Settings, this->Frame));
  }
  else if (settings.Segments == Segmentation::ErrorBound && !scene.Map->IsIdentity() &&
    InvertsTheField(scene.Map->GetKind()) && !scene.Limits.OneToOne)
  {
    this->Inverse.reset(new OrientedInverse(
      *scene.Map->GetField(), scene.Map->GetTolerance(), scene.Volume, this->RestBox));
  }
}

//------------------------------------------------------------------------------
/// Phi(p), data coordinates, for the reference kernels. `start`, if not null: about that.
glm::dvec3 RayCaster::PullBackAlone(
  const glm::dvec3& p, const glm::dvec3* start, CastStatistics& statistics) const
{
  const PullBack& map = *this->Scene.Map;
  const bool mirrored = map.GetKind() == PullBackKind::FirstOrderOfInverse;
  const auto mirror = [&](const glm::dvec3& q) { return mirrored ? 2.0 * p - q : q; };
  PullBackStatus status;
  glm::dvec3 q;
  if (this->Inverse)
  {
    status.Converged = this->Inverse->Solve(p, start ? mirror(*start) : p, q, status.Evaluations);
    q = mirror(q);
  }
  else if (start && InvertsTheField(map.GetKind()) && !map.IsIdentity() &&
    SolveInverse(*map.GetField(), p, mirror(*start), map.GetTolerance(), q, status.Evaluations))
  {
    q = mirror(q);
  }
  else
  {
    const int before = status.Evaluations;
    q = map.Evaluate(p, status);
    status.Evaluations += before;
  }
  statistics.Evaluations += status.Evaluations;
  statistics.Unconverged += status.Converged ? 0 : 1;
  return q;
}

//------------------------------------------------------------------------------
CastStatistics RayCaster::GetStatistics(const Scratch& scratch)
{
  CastStatistics sum = scratch.Statistics;
  sum.Add(scratch.Packets.Statistics);
  return sum;
}

//------------------------------------------------------------------------------
RayCaster::~RayCaster() = default;

//------------------------------------------------------------------------------
int RayCaster::GetTilesPerRow(const CastImage& image) const
{
  return (image.Width + TileSize - 1) / TileSize;
}

//------------------------------------------------------------------------------
int RayCaster::GetNumberOfTiles(const CastImage& image) const
{
  return this->GetTilesPerRow(image) * ((image.Height + TileSize - 1) / TileSize);
}

//------------------------------------------------------------------------------
bool RayCaster::SetUpRay(int x, int y, Ray& ray) const
{
  const CameraView& camera = this->Scene.Camera;
  ray.X = x;
  ray.Y = y;
  ray.Viewing = camera.MakeRay(x + 0.5, y + 0.5);
  ray.Origin = ray.Viewing.Origin;
  ray.Direction = ray.Viewing.Direction;
  ray.From = 0.0;
  ray.To = ray.Viewing.Far;
  if (this->Scene.Depths)
  {
    const std::size_t at = static_cast<std::size_t>(y) * camera.ImageSize.x + x;
    const double depth = this->Scene.Depths[at];
    if (depth < 1.0)
    {
      ray.To = std::min(ray.To, camera.DepthToT(ray.Viewing, x + 0.5, y + 0.5, depth));
    }
  }
  for (const glm::dvec4& plane : this->Scene.ClippingPlanes)
  {
    ClipToPlane(plane, ray.Viewing, ray.From, ray.To);
  }
  if (!this->Scene.Blend.UsesIntervals())
  {
    ray.Jitter =
      this->Settings.Jitter ? FindJitter(x + camera.PixelOrigin.x, y + camera.PixelOrigin.y) : 0.0;
    const VolumeView& volume = this->Scene.Volume;
    ray.Phase = FindPhase(volume.ToIndex(ray.Origin), volume.DataToIndex * ray.Direction,
      this->RestBox, this->Settings.SampleDistance, ray.Jitter);
  }
  return ClipToBox(ray.Origin, ray.Direction, this->Scene.DeformedBounds, ray.From, ray.To);
}

//------------------------------------------------------------------------------
int RayCaster::SetUpTile(int x0, int y0, int x1, int y1, Ray* rays) const
{
  int count = 0;
  for (int y = y0; y <= y1; ++y)
  {
    for (int x = x0; x <= x1; ++x)
    {
      Ray& ray = rays[count];
      if (this->SetUpRay(x, y, ray))
      {
        ++count;
      }
    }
  }
  return count;
}

//------------------------------------------------------------------------------
namespace
{

/// The curve of a pixel in a segment: the terms of its nodes, bicubic.
CurveSegment FindCurve(const TileSegment& segment, int x, int y, const glm::dvec3& shift)
{
  const auto weigh = [&segment](int pixel, int first, double weights[NodesPerSide]) {
    const double at = (pixel - first) * (NodesPerSide - 1.0) / (segment.Side - 1);
    for (int i = 0; i < NodesPerSide; ++i)
    {
      weights[i] = 1.0;
      for (int j = 0; j < NodesPerSide; ++j)
      {
        weights[i] *= i == j ? 1.0 : (at - j) / (i - j);
      }
    }
  };
  double across[NodesPerSide];
  double up[NodesPerSide];
  weigh(x, segment.X, across);
  weigh(y, segment.Y, up);
  CurveSegment curve;
  for (int node = 0; node < TileNodes; ++node)
  {
    const double weight = across[node % NodesPerSide] * up[node / NodesPerSide];
    for (int k = 0; k < TileLayers; ++k)
    {
      for (int c = 0; c < 3; ++c)
      {
        const NodeVectors& terms = segment.Terms[static_cast<std::size_t>(k)];
        curve.Terms[k][c] +=
          weight * terms[static_cast<std::size_t>(c)][static_cast<std::size_t>(node)];
      }
    }
  }
  curve.Terms[0] -= shift;
  return curve;
}

/// The part of a curve from s = a to b, as one from 0 to 1.
CurveSegment Restrict(const CurveSegment& curve, double a, double b)
{
  CurveSegment part = curve;
  // Horner's scheme, once for each derivative at a.
  for (int k = 0; k < CurveSegment::NumberOfTerms; ++k)
  {
    for (int i = CurveSegment::NumberOfTerms - 2; i >= k; --i)
    {
      part.Terms[i] += a * part.Terms[i + 1];
    }
  }
  double power = 1.0;
  for (glm::dvec3& term : part.Terms)
  {
    term *= power;
    power *= b - a;
  }
  return part;
}

/// The segments that a pixel of the tile was cast in, front to back: those that were looked at.
void CollectSegments(
  const TileSegment& segment, int x, int y, std::vector<const TileSegment*>& segments)
{
  if (segment.Known == TileSegment::State::Halved)
  {
    CollectSegments(*segment.Children[0], x, y, segments);
    CollectSegments(*segment.Children[1], x, y, segments);
  }
  else if (segment.Known == TileSegment::State::Quartered)
  {
    for (const TileSegment* child : segment.Children)
    {
      if (x >= child->X && x < child->X + child->Side && y >= child->Y &&
        y < child->Y + child->Side)
      {
        CollectSegments(*child, x, y, segments);
      }
    }
  }
  else if (segment.Known != TileSegment::State::Unknown)
  {
    segments.push_back(&segment);
  }
}

} // namespace

//------------------------------------------------------------------------------
/// Renders the subtile of the tile that the pixel is in, and looks at what that has left.
void RayCaster::TracePackets(
  const Ray& ray, const CastImage& image, Scratch& scratch, Pixel& pixel, TracedRay& traced) const
{
  const int x = ray.X % TileSize;
  const int y = ray.Y % TileSize;
  const std::size_t rows = static_cast<std::size_t>(std::min(ray.Y - y + TileSize, image.Height));
  // Only pixels of the subtile are touched.
  const std::unique_ptr<float[]> colors(
    new float[4 * rows * static_cast<std::size_t>(image.Width)]);
  CastImage picture;
  picture.Width = image.Width;
  picture.Height = image.Height;
  picture.Colors = colors.get();
  std::vector<SampledPosition> positions;
  scratch.Packets.Positions = &positions;
  this->Packets->RenderTile(ray.X - x, ray.Y - y, 1u << (x / SubtileSize + 2 * (y / SubtileSize)),
    picture, scratch.Packets, 0, NoDeadline);
  scratch.Packets.Positions = nullptr;
  positions.erase(std::remove_if(positions.begin(), positions.end(),
                    [&ray](const SampledPosition& at) { return at.X != ray.X || at.Y != ray.Y; }),
    positions.end());

  std::vector<const TileSegment*> segments;
  for (const TileSegment* top : scratch.Packets.Roots)
  {
    CollectSegments(*top, x, y, segments);
  }
  const VolumeView& volume = this->Scene.Volume;
  const glm::dvec3 shift = this->Scene.WholeAtRest
    ? -glm::round(volume.ToIndex(this->Scene.WholeAtRest->Min))
    : glm::dvec3(0.0);
  std::size_t next = 0;
  for (const TileSegment* segment : segments)
  {
    const double from = std::max<double>(segment->T0, ray.From);
    const double to = std::min<double>(static_cast<double>(segment->T0) + segment->Dt, ray.To);
    if (!(from < to))
    {
      continue;
    }
    const CurveSegment curve = Restrict(FindCurve(*segment, x, y, shift),
      (from - segment->T0) / segment->Dt, (to - segment->T0) / segment->Dt);
    pixel.NoteSegment(curve, from, to, segment->Known == TileSegment::State::Empty);
    const auto jacobianAt = [&](double s) {
      return this->Scene.Map->FindJacobian(ray.Origin + (from + s * (to - from)) * ray.Direction,
        volume.IndexToData * curve.At(s) + volume.FirstVoxel);
    };
    const JacobianSegment<decltype(jacobianAt)> sampled(*this, curve, from, to - from, jacobianAt);
    for (; next < positions.size() && positions[next].T < to; ++next)
    {
      const SampledPosition& at = positions[next];
      const double s = std::clamp((at.T - from) / (to - from), 0.0, 1.0);
      const double distance = this->Settings.SampleDistance;
      const RayIntegrator::Outcome outcome =
        pixel.Integrator.AddSample(sampled, s, distance / (to - from));
      pixel.NoteSample(glm::dvec3(at.Index[0], at.Index[1], at.Index[2]) - shift, at.T, distance,
        false, outcome.Extinction);
    }
  }
  const float* color = colors.get() + 4 * (static_cast<std::size_t>(ray.Y) * image.Width + ray.X);
  traced.Color = glm::vec4(color[0], color[1], color[2], color[3]);
  traced.Terminated = 1.0f - traced.Color.a < this->Settings.TerminationTransmittance;
}

//------------------------------------------------------------------------------
void RayCaster::TraceRay(
  int x, int y, const CastImage& image, Scratch& scratch, TracedRay& traced) const
{
  traced = TracedRay();
  Ray ray;
  traced.Hit = this->SetUpRay(x, y, ray);
  traced.Viewing = ray.Viewing;
  if (!traced.Hit)
  {
    return;
  }
  traced.From = ray.From;
  traced.To = ray.To;
  Pixel pixel(this->Frame, ray);
  pixel.Trace = &traced;
  if (this->Packets)
  {
    this->TracePackets(ray, image, scratch, pixel, traced);
    return;
  }
  if (this->Scene.Blend.Mode == BlendMode::Slice)
  {
    this->CastSlice(ray, pixel, scratch.Statistics);
  }
  else if (this->Settings.Segments == Segmentation::GreedyAngle)
  {
    this->CastPolyline(ray, pixel, scratch.Statistics);
  }
  else
  {
    this->CastSamples(ray, pixel, scratch.Statistics);
  }
  traced.Terminated = pixel.Done;
  const RayIntegrator::Result result = pixel.Integrator.End();
  traced.Color = glm::vec4(result.Color, 1.0f - result.Transmittance);
}

//------------------------------------------------------------------------------
int RayCaster::RenderTile(int tile, const CastImage& image, Scratch& scratch, unsigned int subtiles,
  int first, Deadline deadline) const
{
  const int x0 = tile % this->GetTilesPerRow(image) * TileSize;
  const int y0 = tile / this->GetTilesPerRow(image) * TileSize;
  if (this->Packets)
  {
    return this->Packets->RenderTile(x0, y0, subtiles, image, scratch.Packets, first, deadline);
  }
  const int x1 = std::min(x0 + TileSize, image.Width) - 1;
  const int y1 = std::min(y0 + TileSize, image.Height) - 1;
  const auto isWanted = [&](int x, int y) {
    const int subtile = (x - x0) / SubtileSize + 2 * ((y - y0) / SubtileSize);
    return (subtiles >> subtile & 1u) != 0;
  };
  for (int y = y0; y <= y1 && first == 0; ++y)
  {
    for (int x = x0; x <= x1; x += SubtileSize)
    {
      if (!isWanted(x, y))
      {
        continue;
      }
      const std::size_t at = static_cast<std::size_t>(y) * image.Width + x;
      const int width = std::min(SubtileSize, x1 - x + 1);
      std::fill_n(image.Colors + 4 * at, 4 * width, 0.0f);
      if (image.Depths)
      {
        std::fill_n(image.Depths + at, width, 1.0f);
      }
      if (image.Reaches)
      {
        const int perRow = (image.Width + SubtileSize - 1) / SubtileSize;
        image.Reaches[y / SubtileSize * perRow + x / SubtileSize] =
          std::numeric_limits<float>::infinity();
      }
    }
  }
  if (!this->Visible)
  {
    return 0;
  }
  std::array<Ray, TileSize * TileSize> rays;
  const int count = this->SetUpTile(x0, y0, x1, y1, rays.data());
  const bool slice = this->Scene.Blend.Mode == BlendMode::Slice;
  const bool greedy = this->Settings.Segments == Segmentation::GreedyAngle;
  for (int i = first; i < count; ++i)
  {
    Ray& ray = rays[i];
    if (!isWanted(ray.X, ray.Y))
    {
      continue;
    }
    ++scratch.Statistics.Rays;
    Pixel pixel(this->Frame, ray);
    if (slice)
    {
      this->CastSlice(ray, pixel, scratch.Statistics);
    }
    else if (greedy)
    {
      this->CastPolyline(ray, pixel, scratch.Statistics);
    }
    else
    {
      this->CastSamples(ray, pixel, scratch.Statistics);
    }
    const std::size_t at = static_cast<std::size_t>(ray.Y) * image.Width + ray.X;
    const RayIntegrator::Result result = pixel.Integrator.End();
    float* color = image.Colors + 4 * at;
    color[0] = result.Color.r;
    color[1] = result.Color.g;
    color[2] = result.Color.b;
    color[3] = 1.0f - result.Transmittance;
    if (image.Depths && result.FirstVisible < Infinity)
    {
      image.Depths[at] = static_cast<float>(this->Scene.Camera.ToDepth(
        ray.Viewing.Origin + result.FirstVisible * ray.Viewing.Direction));
    }
    if (deadline != NoDeadline && std::chrono::steady_clock::now() >= deadline)
    {
      return i + 1;
    }
  }
  return 0;
}

//------------------------------------------------------------------------------
void RayCaster::CastSlice(const Ray& ray, Pixel& pixel, CastStatistics& statistics) const
{
  const glm::dvec3& normal = this->Scene.Blend.SliceNormal;
  const double slope = glm::dot(normal, ray.Viewing.Direction);
  const double t = glm::dot(normal, this->Scene.Blend.SliceOrigin - ray.Viewing.Origin) / slope;
  // False where the ray runs along the plane, too.
  if (!(t >= ray.From && t < ray.To))
  {
    return;
  }
  const glm::dvec3 p = ray.Origin + t * ray.Direction;
  const glm::dvec3 q = this->Scene.Volume.ToIndex(this->PullBackAlone(p, nullptr, statistics));
  const Cropping& crop = this->Scene.Crop;
  pixel.NoteSegment(CurveSegment::Line(q, q), t, t, false);
  if (!IsInside(this->Scene.Volume, q) ||
    (crop.Space == Cropping::Spaces::Rest && !crop.Shows(q)) ||
    (crop.Space == Cropping::Spaces::Deformed && !crop.Shows(p)))
  {
    return;
  }
  ++statistics.Samples;
  const RayIntegrator::Outcome outcome = pixel.Integrator.AddSlice(q, t);
  statistics.VisibleSamples += outcome.Visible ? 1 : 0;
  pixel.NoteSample(q, t, 0.0, false, outcome.Extinction);
}

//------------------------------------------------------------------------------
void RayCaster::CastPolyline(Ray& ray, Pixel& pixel, CastStatistics& statistics) const
{
  const VolumeView& volume = this->Scene.Volume;
  PolylineWalker walker(*this->Scene.Map, this->Settings.Polyline, ray.Origin, ray.Direction,
    ray.From, ray.To, this->Settings.Shade);
  Sampler sampler(*this, ray, pixel, statistics);
  PolylineVertex start = walker.GetVertex();
  glm::dvec3 startIndex = volume.ToIndex(start.Rest);
  while (!pixel.Done && walker.Next())
  {
    const PolylineVertex end = walker.GetVertex();
    const glm::dvec3 endIndex = volume.ToIndex(end.Rest);
    const double dt = end.T - start.T;
    ++statistics.Segments;
    statistics.SegmentLength += dt / this->Scene.VoxelSize;
    // An empty box found on an earlier segment holds this one whole if it holds both ends.
    const bool empty = this->Settings.Leaping == SpaceLeaping::Lipschitz &&
      Contains(sampler.GetLastEmptyBox(), startIndex) &&
      Contains(sampler.GetLastEmptyBox(), endIndex);
    const CurveSegment segment = CurveSegment::Line(startIndex, endIndex);
    pixel.NoteSegment(segment, start.T, end.T, empty);
    if (!empty)
    {
      sampler.ForgetEmptyBox();
      const double length = glm::length(this->Frame.IndexToData * segment.Terms[1]);
      const auto jacobianAt = [&](
                                double s) { return start.Jacobian * (1.0 - s) + end.Jacobian * s; };
      sampler.Integrate(
        JacobianSegment<decltype(jacobianAt)>(*this, segment, start.T, dt, jacobianAt),
        ScheduleWithRemainder(length, this->Settings.SampleDistance, ray.Jitter));
    }
    start = end;
    startIndex = endIndex;
  }
  statistics.Evaluations += walker.GetEvaluations();
  statistics.Unconverged += walker.GetUnconverged();
}

//------------------------------------------------------------------------------
/**
 * The truth that ERROR_BOUND is measured by: every sample is pulled back by itself. Where T is
 * inverted, Newton's method goes on from the sample before; where that fails it starts anew.
 */
void RayCaster::CastSamples(Ray& ray, Pixel& pixel, CastStatistics& statistics) const
{
  const VolumeView& volume = this->Scene.Volume;
  const PullBack& map = *this->Scene.Map;
  const bool identity = map.IsIdentity();
  const bool intervals = this->Scene.Blend.UsesIntervals();
  const double distance = this->Settings.SampleDistance;
  Sampler sampler(*this, ray, pixel, statistics);

  const auto pointAt = [&](double t) { return ray.Origin + t * ray.Direction; };
  // Data coordinates. `start`: about where it leads to.
  const auto pullBack = [&](double t, const glm::dvec3* start) {
    return this->PullBackAlone(pointAt(t), start, statistics);
  };

  // A sample at the very start of the range belongs to it, rounding errors or not.
  constexpr double Slack = 1e-3;
  const double early = intervals ? 1.0 - Slack : Slack + ray.Phase;
  const double first = std::ceil(ray.From / distance - early);
  const double stop = std::ceil(ray.To / distance - Slack - ray.Phase);
  if (!(first < stop))
  {
    // Too short for a sample: a segment without one.
    ++statistics.Segments;
    statistics.SegmentLength += (ray.To - ray.From) / this->Scene.VoxelSize;
    pixel.NoteSegment(CurveSegment::Line(volume.ToIndex(pullBack(ray.From, nullptr)),
                        volume.ToIndex(pullBack(ray.To, nullptr))),
      ray.From, ray.To, false);
    return;
  }
  glm::dvec3 rest = pullBack((first + ray.Phase) * distance, nullptr);
  glm::dvec3 index = volume.ToIndex(rest);
  glm::dvec3 move(0.0);
  for (double n = first; n < stop && !pixel.Done; n += 1.0)
  {
    const double t = (n + ray.Phase) * distance;
    const glm::dvec3 guess = rest + move;
    const glm::dvec3 nextRest = pullBack(t + distance, &guess);
    const glm::dvec3 next = volume.ToIndex(nextRest);
    CurveSegment segment = CurveSegment::Line(index, next);
    if (intervals && !identity)
    {
      const glm::dvec3 halfway = rest + 0.5 * move;
      segment =
        CurveSegment::Parabola(index, volume.ToIndex(pullBack(t + 0.5 * distance, &halfway)), next);
    }
    ++statistics.Segments;
    statistics.SegmentLength += distance / this->Scene.VoxelSize;
    pixel.NoteSegment(segment, t, t + distance, false);
    const auto jacobianAt = [&](double s) {
      const glm::dvec3 q = volume.IndexToData * segment.At(s) + volume.FirstVoxel;
      return map.FindJacobian(pointAt(t + s * distance), q);
    };
    SampleSchedule schedule;
    schedule.Count = 1;
    schedule.Step = 1.0;
    schedule.LastInterval = 1.0;
    sampler.Integrate(
      JacobianSegment<decltype(jacobianAt)>(*this, segment, t, distance, jacobianAt), schedule);
    move = nextRest - rest;
    rest = nextRest;
    index = next;
  }
}

} // namespace ffd
