// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDDeformVolume.h"

#include "vtkFFDContentTime.h"
#include "vtkFFDGuard.h"
#include "vtkFFDLattice.h"
#include "vtkFFDPipeline.h"

#include "vtkAlgorithmOutput.h"
#include "vtkBoundingBox.h"
#include "vtkCardinalSpline.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

vtkStandardNewMacro(vtkFFDDeformVolume);
vtkFFDGuardedProcessRequestMacro(vtkFFDDeformVolume);

namespace
{

constexpr const char* InterpolationNames[] = { "STEP", "LINEAR", "SPLINE" };

/// Why two lattices cannot be interpolated, or an empty string.
std::string FindMismatch(vtkFFDLattice* a, vtkFFDLattice* b)
{
  int dimensions[2][3];
  a->GetDimensions(dimensions[0]);
  b->GetDimensions(dimensions[1]);
  if (!std::equal(dimensions[0], dimensions[0] + 3, dimensions[1]))
  {
    return "their dimensions differ; see vtkFFDLattice::SetDimensions()";
  }
  if (b->GetDisplacements()->GetNumberOfComponents() != 3 ||
    b->GetDisplacements()->GetNumberOfTuples() != b->GetNumberOfControlPoints())
  {
    return "the array of displacements was given another size; see vtkFFDLattice::Reset()";
  }
  double domain[2][6];
  a->GetDomain(domain[0]);
  b->GetDomain(domain[1]);
  for (int i = 0; i < 6; ++i)
  {
    const double extent = domain[0][i | 1] - domain[0][i & ~1];
    if (!(std::abs(domain[0][i] - domain[1][i]) <= 1e-9 * extent))
    {
      return "their domains differ; see vtkFFDLattice::SetDomain()";
    }
  }
  if (a->GetBorderMode() != b->GetBorderMode())
  {
    return "their border modes differ; see vtkFFDLattice::SetBorderMode()";
  }
  if (a->GetInverseFlag() != b->GetInverseFlag())
  {
    return "one of them is inverted; see vtkFFDLattice::Inverse()";
  }
  return std::string();
}

/// The coefficients of the keyframes in the value at `time`: value = sum of weight * keyframe.
std::vector<double> FindWeights(const std::vector<double>& times, double time, int interpolation)
{
  const std::size_t count = times.size();
  std::vector<double> weights(count, 0.0);
  if (time <= times.front() || count == 1)
  {
    weights.front() = 1.0;
    return weights;
  }
  if (time >= times.back())
  {
    weights.back() = 1.0;
    return weights;
  }
  const std::size_t next =
    static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), time) - times.begin());
  const double t = (time - times[next - 1]) / (times[next] - times[next - 1]);
  if (interpolation == vtkFFDDeformVolume::STEP)
  {
    weights[next - 1] = 1.0;
  }
  else if (interpolation == vtkFFDDeformVolume::LINEAR)
  {
    weights[next - 1] = 1.0 - t;
    weights[next] = t;
  }
  else
  {
    // A spline is linear in its values: one that is 1 at a keyframe and 0 at the others gives the
    // keyframe's weight, once for all control points.
    for (std::size_t i = 0; i < count; ++i)
    {
      vtkNew<vtkCardinalSpline> spline;
      // Natural ends: no curvature there.
      spline->SetLeftConstraint(2);
      spline->SetRightConstraint(2);
      for (std::size_t k = 0; k < count; ++k)
      {
        spline->AddPoint(times[k], k == i ? 1.0 : 0.0);
      }
      weights[i] = spline->Evaluate(time);
    }
  }
  return weights;
}

/// The map of a lattice whose displacements are linear in space: columns 0 to 2 the matrix, 3 the
/// offset. False for any other.
bool FindLinearMap(vtkFFDLattice* lattice, double map[3][4])
{
  int sizes[3];
  double origin[3];
  double spacing[3];
  lattice->GetDimensions(sizes);
  lattice->GetRestPoint(0, 0, 0, origin);
  lattice->GetSpacing(spacing);
  const double* d = lattice->GetDisplacements()->GetPointer(0);
  const int strides[3] = { 3, 3 * sizes[0], 3 * sizes[0] * sizes[1] };
  double slopes[3][3];
  double largest = 0.0;
  for (vtkIdType i = 0; i < 3 * lattice->GetNumberOfControlPoints(); ++i)
  {
    largest = std::max(largest, std::abs(d[i]));
  }
  for (int a = 0; a < 3; ++a)
  {
    for (int c = 0; c < 3; ++c)
    {
      slopes[c][a] = (d[(sizes[a] - 1) * strides[a] + c] - d[c]) / (sizes[a] - 1);
    }
  }
  for (int k = 0; k < sizes[2]; ++k)
  {
    for (int j = 0; j < sizes[1]; ++j)
    {
      for (int i = 0; i < sizes[0]; ++i)
      {
        for (int c = 0; c < 3; ++c)
        {
          const double linear = d[c] + i * slopes[c][0] + j * slopes[c][1] + k * slopes[c][2];
          if (!(std::abs(d[i * strides[0] + j * strides[1] + k * strides[2] + c] - linear) <=
                1e-9 * largest))
          {
            return false;
          }
        }
      }
    }
  }
  const double scale = lattice->GetDisplacementScale();
  for (int c = 0; c < 3; ++c)
  {
    map[c][3] = scale * d[c];
    for (int a = 0; a < 3; ++a)
    {
      const double slope = scale * slopes[c][a] / spacing[a];
      map[c][a] = (a == c ? 1.0 : 0.0) + slope;
      map[c][3] -= slope * origin[a];
    }
  }
  return true;
}

/// Whether x . (map x) > 0 for all x: the lattice, which goes on outside as at its border, is then
/// one to one there, too.
bool IsPositive(const double map[3][4])
{
  double s[3][3];
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      s[i][j] = 0.5 * (map[i][j] + map[j][i]);
    }
  }
  return s[0][0] > 0.0 && s[0][0] * s[1][1] - s[0][1] * s[1][0] > 0.0 &&
    vtkMath::Determinant3x3(s) > 0.0;
}

/**
 * Give a lattice that is linear, and far larger than what it has to move within `bounds`, the size
 * of that: what is proven of a lattice, as where it moves a volume to, is as fine as its cells.
 */
void CutLinearLattice(vtkFFDLattice* lattice, const double bounds[6], const double map[3][4])
{
  double matrix[3][3];
  for (int i = 0; i < 3; ++i)
  {
    std::copy_n(map[i], 3, matrix[i]);
  }
  const bool inverse = lattice->GetInverseFlag() != 0;
  if (inverse)
  {
    vtkMath::Invert3x3(matrix, matrix);
  }
  vtkBoundingBox box;
  for (int corner = 0; corner < 8; ++corner)
  {
    double p[3] = { bounds[corner & 1], bounds[2 + ((corner >> 1) & 1)],
      bounds[4 + (corner >> 2)] };
    if (inverse)
    {
      const double q[3] = { p[0] - map[0][3], p[1] - map[1][3], p[2] - map[2][3] };
      vtkMath::Multiply3x3(matrix, q, p);
    }
    box.AddPoint(p);
  }
  const double size = box.GetMaxLength();
  box.Inflate(0.5 * size);
  double domain[6];
  lattice->GetDomain(domain);
  constexpr double muchLarger = 8.0;
  if (!(std::max({ domain[1] - domain[0], domain[3] - domain[2], domain[5] - domain[4] }) >
        muchLarger * size) ||
    !vtkBoundingBox(domain).Contains(box))
  {
    return;
  }
  box.GetBounds(domain);
  constexpr int sizes = 11;
  lattice->SetDimensions(sizes, sizes, sizes);
  lattice->SetDomain(domain);
  lattice->SetBorderMode(VTK_BSPLINE_EDGE);
  lattice->SetDisplacementScale(1.0);
  for (int n = 0; n < sizes * sizes * sizes; ++n)
  {
    const int at[3] = { n % sizes, n / sizes % sizes, n / (sizes * sizes) };
    double p[3];
    double d[3];
    lattice->GetRestPoint(at[0], at[1], at[2], p);
    for (int c = 0; c < 3; ++c)
    {
      d[c] = map[c][0] * p[0] + map[c][1] * p[1] + map[c][2] * p[2] + map[c][3] - p[c];
    }
    lattice->SetDisplacement(at[0], at[1], at[2], d);
  }
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDDeformVolume::vtkFFDDeformVolume() { this->SetNumberOfInputPorts(2); }

//------------------------------------------------------------------------------
vtkFFDDeformVolume::~vtkFFDDeformVolume() = default;

//------------------------------------------------------------------------------
void vtkFFDDeformVolume::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Lattice: ";
  if (this->Lattice)
  {
    os << "\n";
    this->Lattice->PrintSelf(os, indent.GetNextIndent());
  }
  else
  {
    os << "(none)\n";
  }
  os << indent << "KeyframeInterpolation: " << this->GetKeyframeInterpolationAsString() << "\n";
  os << indent << "Keyframes: " << this->Keyframes.size() << "\n";
  for (const Keyframe& keyframe : this->Keyframes)
  {
    os << indent.GetNextIndent() << keyframe.Time << ": " << keyframe.Lattice << "\n";
  }
}

//------------------------------------------------------------------------------
void vtkFFDDeformVolume::AddKeyframe(double time, vtkFFDLattice* lattice)
{
  if (!lattice || !std::isfinite(time))
  {
    vtkErrorMacro("AddKeyframe: " << (lattice ? "the time is not finite" : "the lattice is null")
                                  << ". Give a finite time and a vtkFFDLattice.");
    return;
  }
  const auto at = std::lower_bound(this->Keyframes.begin(), this->Keyframes.end(), time,
    [](const Keyframe& keyframe, double t) { return keyframe.Time < t; });
  if (at != this->Keyframes.end() && at->Time == time)
  {
    if (at->Lattice == lattice)
    {
      return;
    }
    at->Lattice = lattice;
  }
  else
  {
    this->Keyframes.insert(at, Keyframe{ time, lattice });
  }
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDDeformVolume::RemoveKeyframe(double time)
{
  const auto at = std::find_if(this->Keyframes.begin(), this->Keyframes.end(),
    [time](const Keyframe& keyframe) { return keyframe.Time == time; });
  if (at == this->Keyframes.end())
  {
    vtkErrorMacro("RemoveKeyframe: there is none at time " << time << ".");
    return;
  }
  this->Keyframes.erase(at);
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDDeformVolume::RemoveAllKeyframes()
{
  if (!this->Keyframes.empty())
  {
    this->Keyframes.clear();
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkFFDDeformVolume::GetNumberOfKeyframes() { return static_cast<int>(this->Keyframes.size()); }

//------------------------------------------------------------------------------
double vtkFFDDeformVolume::GetKeyframeTime(int index)
{
  if (index < 0 || index >= this->GetNumberOfKeyframes())
  {
    vtkErrorMacro(
      "GetKeyframeTime: there is no keyframe " << index << " of " << this->Keyframes.size() << ".");
    return std::numeric_limits<double>::quiet_NaN();
  }
  return this->Keyframes[static_cast<std::size_t>(index)].Time;
}

//------------------------------------------------------------------------------
vtkFFDLattice* vtkFFDDeformVolume::GetKeyframeLattice(int index)
{
  if (index < 0 || index >= this->GetNumberOfKeyframes())
  {
    vtkErrorMacro("GetKeyframeLattice: there is no keyframe " << index << " of "
                                                              << this->Keyframes.size() << ".");
    return nullptr;
  }
  return this->Keyframes[static_cast<std::size_t>(index)].Lattice;
}

//------------------------------------------------------------------------------
const char* vtkFFDDeformVolume::GetKeyframeInterpolationAsString()
{
  return InterpolationNames[this->KeyframeInterpolation];
}

//------------------------------------------------------------------------------
int vtkFFDDeformVolume::InterpolateKeyframes(double time, vtkFFDLattice* lattice)
{
  if (!lattice || this->Keyframes.empty() || !std::isfinite(time))
  {
    vtkErrorMacro("InterpolateKeyframes: " << (!lattice ? "the lattice to fill is null"
                                                  : this->Keyframes.empty()
                                                  ? "there are no keyframes, call AddKeyframe()"
                                                  : "the time is not finite")
                                           << ".");
    return 0;
  }
  std::vector<double> times;
  for (const Keyframe& keyframe : this->Keyframes)
  {
    const std::string mismatch = FindMismatch(this->Keyframes.front().Lattice, keyframe.Lattice);
    if (!mismatch.empty())
    {
      vtkErrorMacro("The keyframes at times " << this->Keyframes.front().Time << " and "
                                              << keyframe.Time
                                              << " cannot be interpolated: " << mismatch << ".");
      return 0;
    }
    times.push_back(keyframe.Time);
  }
  const std::vector<double> weights = FindWeights(times, time, this->KeyframeInterpolation);
  return vtkFFDGuarded(this, "InterpolateKeyframes", 0, [&] {
    vtkNew<vtkDoubleArray> sum;
    sum->SetNumberOfComponents(3);
    sum->SetNumberOfTuples(this->Keyframes.front().Lattice->GetNumberOfControlPoints());
    sum->Fill(0.0);
    for (std::size_t i = 0; i < weights.size(); ++i)
    {
      if (weights[i] != 0.0)
      {
        vtkFFDLattice* keyframe = this->Keyframes[i].Lattice;
        const double factor = weights[i] * keyframe->GetDisplacementScale();
        const double* from = keyframe->GetDisplacements()->GetPointer(0);
        double* to = sum->GetPointer(0);
        for (vtkIdType k = 0; k < sum->GetNumberOfValues(); ++k)
        {
          to[k] += factor * from[k];
        }
      }
    }
    lattice->DeepCopy(this->Keyframes.front().Lattice);
    lattice->SetDisplacementScale(1.0);
    return lattice->SetDisplacements(sum);
  });
}

//------------------------------------------------------------------------------
void vtkFFDDeformVolume::SetLattice(vtkFFDLattice* lattice)
{
  if (this->Lattice != lattice)
  {
    this->Lattice = lattice;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkFFDLattice* vtkFFDDeformVolume::GetLattice() { return this->Lattice; }

//------------------------------------------------------------------------------
void vtkFFDDeformVolume::SetLatticeConnection(vtkAlgorithmOutput* connection)
{
  this->SetInputConnection(1, connection);
}

//------------------------------------------------------------------------------
void vtkFFDDeformVolume::SetLatticeData(vtkImageData* image)
{
  this->SetInputDataInternal(1, image);
}

//------------------------------------------------------------------------------
vtkMTimeType vtkFFDDeformVolume::GetMTime()
{
  vtkMTimeType time = this->Superclass::GetMTime();
  if (this->Lattice)
  {
    time = std::max(time, this->Lattice->GetMTime());
  }
  for (const Keyframe& keyframe : this->Keyframes)
  {
    time = std::max(time, keyframe.Lattice->GetMTime());
  }
  return time;
}

//------------------------------------------------------------------------------
int vtkFFDDeformVolume::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return this->Superclass::FillInputPortInformation(port, info);
}

//------------------------------------------------------------------------------
int vtkFFDDeformVolume::RequestInformation(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  if (!this->Superclass::RequestInformation(request, inputs, outputs))
  {
    return 0;
  }
  // The steps and the range of the input are those of the volume; the keyframes, or the lattices at
  // the second input, add theirs.
  std::vector<double> steps;
  for (const Keyframe& keyframe : this->Keyframes)
  {
    steps.push_back(keyframe.Time);
  }
  const bool reads = this->Keyframes.empty() && !this->Lattice;
  outputs->GetInformationObject(0)->CopyEntry(
    inputs[0]->GetInformationObject(0), vtkDataObject::DIRECTION());
  vtkFFDMergeTimes(steps,
    { inputs[0]->GetInformationObject(0), reads ? inputs[1]->GetInformationObject(0) : nullptr },
    outputs->GetInformationObject(0));
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDDeformVolume::RequestUpdateExtent(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  // The volume's extent and piece, which the default asks of every input, mean nothing to the
  // lattice: each of several processes needs the whole.
  vtkFFDRequestWhole(inputs[1]->GetInformationObject(0));
  return this->Superclass::RequestUpdateExtent(request, inputs, outputs);
}

//------------------------------------------------------------------------------
int vtkFFDDeformVolume::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkImageData* input = vtkImageData::GetData(inputs[0]);
  vtkImageData* output = vtkImageData::GetData(outputs);
  if (!input || !output)
  {
    vtkErrorMacro("There is no image to deform. Connect a vtkImageData to the first input.");
    return 0;
  }
  output->ShallowCopy(input);
  // Field data of our own, so that the lattice is not attached to the input, too.
  vtkNew<vtkFieldData> fields;
  if (input->GetFieldData())
  {
    fields->PassData(input->GetFieldData());
  }
  output->SetFieldData(fields);

  // Attaching changes the field data only.
  vtkFFDPassContentTime(input, output);

  vtkImageData* points = vtkImageData::GetData(inputs[1]);
  if (!this->Keyframes.empty())
  {
    // Without a request for a time: that of the first step.
    vtkInformation* info = outputs->GetInformationObject(0);
    const double time = info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP())
      ? info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP())
      : this->Keyframes.front().Time;
    output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
    vtkNew<vtkFFDLattice> lattice;
    return this->InterpolateKeyframes(time, lattice) ? lattice->AttachTo(output) : 1;
  }
  if (this->Lattice)
  {
    return this->Lattice->AttachTo(output);
  }
  if (points && vtkFFDLattice::HasLattice(points))
  {
    vtkNew<vtkFFDLattice> lattice;
    return lattice->ReadFrom(points) ? lattice->AttachTo(output) : 1;
  }
  if (points)
  {
    // An unusable image is reported by the lattice; what was attached stays.
    vtkNew<vtkFFDLattice> lattice;
    if (!lattice->FromImageData(points))
    {
      return 1;
    }
    double map[3][4];
    if (input->GetNumberOfPoints() > 0 && FindLinearMap(lattice, map))
    {
      if (!IsPositive(map))
      {
        vtkWarningMacro(
          "The lattice is linear, and turns by 90 degrees and more, or mirrors: that is "
          "no small deformation, and the volume can appear several times. Turn the "
          "volume itself instead, as by vtkProp3D::SetUserMatrix().");
      }
      double bounds[6];
      vtkNew<vtkImageData> whole;
      vtkFFDGetWholeGeometry(inputs[0]->GetInformationObject(0), input, whole);
      whole->GetBounds(bounds);
      CutLinearLattice(lattice, bounds, map);
    }
    return lattice->AttachTo(output);
  }
  if (!vtkFFDLattice::HasLattice(output))
  {
    vtkErrorMacro(
      "There is no lattice to attach, the image passes through undeformed. Call "
      "SetLattice() or AddKeyframe(), or connect an image of control points, or one with a "
      "lattice, to the second input.");
  }
  return 1;
}
