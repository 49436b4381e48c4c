// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDFitLattice.h"

#include "vtkFFDGuard.h"
#include "vtkFFDLattice.h"
#include "vtkFFDLatticeData.h"
#include "vtkFFDOptions.h"
#include "vtkFFDParallelFor.h"
#include "vtkFFDPipeline.h"
#include "vtkFFDTransformSampler.h"

#include "FFDFunctionFit.h"
#include "FFDLattice.h"
#include "FFDLatticeFit.h"

#include "vtkAbstractTransform.h"
#include "vtkAlgorithmOutput.h"
#include "vtkBoundingBox.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMatrix3x3.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkFFDFitLattice);
vtkFFDProcessRequestInTimeMacro(vtkFFDFitLattice);

namespace
{

/// Margin that is added to the box of landmarks on each side, as a fraction of its longest edge.
constexpr double LandmarkMargin = 0.1;

/// A copy of the displacements, and three to work on.
constexpr double BytesPerSample = 96.0;

std::vector<glm::dvec3> CopyPoints(vtkPoints* points)
{
  std::vector<glm::dvec3> copy(static_cast<std::size_t>(points->GetNumberOfPoints()));
  for (std::size_t i = 0; i < copy.size(); ++i)
  {
    points->GetPoint(static_cast<vtkIdType>(i), &copy[i].x);
  }
  return copy;
}

/// Makes bounds the domain of a lattice, which has an extent along flat axes, too. False, and
/// bounds as they were, where no lattice can have that domain.
bool FindDomain(double bounds[6])
{
  ffd::Box box{ { bounds[0], bounds[2], bounds[4] }, { bounds[1], bounds[3], bounds[5] } };
  for (int a = 0; a < 3; ++a)
  {
    // False for what is not a number, too.
    if (!(box.Min[a] <= box.Max[a]) || !std::isfinite(box.Max[a] - box.Min[a]))
    {
      return false;
    }
  }
  if (!ffd::WidenFlatAxes(box) || ffd::Lattice().SetDomain(box) >= 0)
  {
    return false;
  }
  for (int a = 0; a < 3; ++a)
  {
    bounds[2 * a] = box.Min[a];
    bounds[2 * a + 1] = box.Max[a];
  }
  return true;
}

/// What may be given to be fitted; exactly one of landmarks, image and transform is to be.
struct FitInput
{
  vtkPoints* Source;
  vtkPoints* Target;
  vtkDataArray* Weights; ///< of the landmarks, or null
  vtkImageData* Field;
  vtkAbstractTransform* Transform;

  bool HasLandmarks() const { return this->Source || this->Target; }
  const char* GetName() const
  {
    return this->HasLandmarks() ? "landmarks" : this->Field ? "displacements" : "transform";
  }
};

std::string FindLandmarkProblem(const FitInput& input)
{
  if (!input.Source || !input.Target ||
    input.Source->GetNumberOfPoints() != input.Target->GetNumberOfPoints() ||
    input.Source->GetNumberOfPoints() < 1)
  {
    return "There are not as many source as target landmarks, or none. Set both";
  }
  if (!input.Weights)
  {
    return std::string();
  }
  const vtkIdType count = input.Weights->GetNumberOfTuples();
  if (input.Weights->GetNumberOfComponents() != 1 || count != input.Source->GetNumberOfPoints())
  {
    return "There is not one weight per pair of landmarks. Set as many";
  }
  for (vtkIdType i = 0; i < count; ++i)
  {
    const double weight = input.Weights->GetComponent(i, 0);
    if (!(weight > 0.0) || !std::isfinite(weight))
    {
      std::ostringstream text;
      text << "The weight of landmark " << i << " is " << weight << ". Give positive weights";
      return text.str();
    }
  }
  return std::string();
}

std::string FindFieldProblem(vtkImageData* field)
{
  vtkDataArray* const scalars = field->GetPointData()->GetScalars();
  if (!scalars || scalars->GetNumberOfComponents() != 3 || field->GetNumberOfPoints() < 1 ||
    scalars->GetNumberOfTuples() != field->GetNumberOfPoints())
  {
    return "The image at the input has no point scalars with 3 components, the displacements";
  }
  if (!field->GetDirectionMatrix()->IsIdentity())
  {
    return "The image of displacements has a direction matrix. Set a vtkGridTransform in its "
           "frame as Transform instead";
  }
  return std::string();
}

/// The box of the landmarks, which are there, with a margin.
void FindLandmarkBounds(const FitInput& input, double bounds[6])
{
  vtkBoundingBox box;
  for (vtkPoints* points : { input.Source, input.Target })
  {
    for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
    {
      double point[3];
      points->GetPoint(i, point);
      box.AddPoint(point);
    }
  }
  box.Inflate(LandmarkMargin * box.GetMaxLength());
  if (box.GetMaxLength() <= 0.0)
  {
    box.Inflate(0.5);
  }
  box.GetBounds(bounds);
}

/// What is wrong with the input or `bounds`, else empty: these are then the domain of the lattice,
/// of the input where they were none.
std::string FindFitProblem(const FitInput& input, double bounds[6])
{
  const bool landmarks = input.HasLandmarks();
  const int given = (input.Field ? 1 : 0) + (landmarks ? 1 : 0) + (input.Transform ? 1 : 0);
  if (given != 1)
  {
    return given == 0
      ? "There is nothing to fit. Set landmarks, a transform, or an image of displacements"
      : "There is more than one thing to fit. Set landmarks, a transform or an image, and null for "
        "the others";
  }
  const bool chosen = bounds[0] <= bounds[1];
  if (input.Transform && !chosen)
  {
    return "A transform has no bounds of its own. Call SetBounds() with those of the data";
  }
  const std::string problem = landmarks ? FindLandmarkProblem(input)
    : input.Field                       ? FindFieldProblem(input.Field)
                                        : std::string();
  if (!problem.empty())
  {
    return problem;
  }
  if (!chosen && landmarks)
  {
    FindLandmarkBounds(input, bounds);
  }
  else if (!chosen)
  {
    input.Field->GetBounds(bounds);
  }
  if (!FindDomain(bounds))
  {
    return chosen
      ? "The bounds are not usable. Call SetBounds() with minima below maxima, at least on one axis"
      : "The data to fit have no bounds that a lattice can have: they are a single point, too "
        "small or too large, or not finite. Call SetBounds()";
  }
  return std::string();
}

ffd::FitStatus FitLandmarks(
  const FitInput& input, double smoothness, const ffd::FitLimits& limits, ffd::FittedNet& fit)
{
  const std::vector<glm::dvec3> from = CopyPoints(input.Source);
  std::vector<glm::dvec3> displacements = CopyPoints(input.Target);
  std::vector<double> weights;
  for (std::size_t i = 0; i < from.size(); ++i)
  {
    displacements[i] -= from[i];
    if (input.Weights)
    {
      weights.push_back(input.Weights->GetComponent(static_cast<vtkIdType>(i), 0));
    }
  }
  return ffd::FitNetToPoints(from, displacements, weights, smoothness, limits, fit);
}

ffd::FitStatus FitTransform(
  vtkAbstractTransform* transform, const ffd::FitLimits& limits, ffd::FittedNet& fit)
{
  ffd::FunctionFit function(
    vtkFFDMakeTransformSampler(transform, limits.Parallel), fit.Lower, fit.Extent);
  const ffd::FitStatus status = function.Run(limits);
  fit = function.GetNet();
  return status;
}

ffd::FitStatus FitField(vtkImageData* field, const ffd::FitLimits& limits, ffd::FittedNet& fit)
{
  int extent[6];
  glm::dvec3 spacing;
  glm::dvec3 first;
  field->GetExtent(extent);
  field->GetSpacing(&spacing.x);
  field->GetOrigin(&first.x);
  glm::ivec3 count;
  for (int a = 0; a < 3; ++a)
  {
    count[a] = extent[2 * a + 1] - extent[2 * a] + 1;
    first[a] += extent[2 * a] * spacing[a];
  }
  vtkFFDRequireMemory(BytesPerSample * static_cast<double>(field->GetNumberOfPoints()),
    "The fit to " + std::to_string(field->GetNumberOfPoints()) + " displacements",
    "Use a coarser image.");
  const std::vector<glm::dvec3> displacements =
    vtkFFDCopyTuples(field->GetPointData()->GetScalars());
  return ffd::FitNetToGrid(count, first, spacing, displacements, limits, fit);
}

} // namespace

//------------------------------------------------------------------------------
vtkFFDFitLattice::vtkFFDFitLattice()
  : Smoothness(1e-6)
  , Bounds{ 1.0, -1.0, 1.0, -1.0, 1.0, -1.0 }
  , Tolerance(0.1)
  , MaximumCells(64)
  , MaximumError(-1.0)
  , RootMeanSquareError(-1.0)
{
}

//------------------------------------------------------------------------------
vtkFFDFitLattice::~vtkFFDFitLattice() = default;

//------------------------------------------------------------------------------
void vtkFFDFitLattice::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "SourceLandmarks: "
     << (this->SourceLandmarks ? this->SourceLandmarks->GetNumberOfPoints() : 0) << " points\n";
  os << indent << "TargetLandmarks: "
     << (this->TargetLandmarks ? this->TargetLandmarks->GetNumberOfPoints() : 0) << " points\n";
  os << indent << "LandmarkWeights: " << (this->LandmarkWeights ? "given" : "(none)") << "\n";
  os << indent << "Transform: " << (this->Transform ? this->Transform->GetClassName() : "(none)")
     << "\n";
  os << indent << "Smoothness: " << this->Smoothness << "\n";
  os << indent << "Bounds:";
  for (const double bound : this->Bounds)
  {
    os << " " << bound;
  }
  os << "\n" << indent << "Tolerance: " << this->Tolerance << "\n";
  os << indent << "MaximumCells: " << this->MaximumCells << "\n";
  os << indent << "MaximumError: " << this->MaximumError << "\n";
  os << indent << "RootMeanSquareError: " << this->RootMeanSquareError << "\n";
}

//------------------------------------------------------------------------------
void vtkFFDFitLattice::SetSourceLandmarks(vtkPoints* points)
{
  if (this->SourceLandmarks != points)
  {
    this->SourceLandmarks = points;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkPoints* vtkFFDFitLattice::GetSourceLandmarks() { return this->SourceLandmarks; }

//------------------------------------------------------------------------------
void vtkFFDFitLattice::SetTargetLandmarks(vtkPoints* points)
{
  if (this->TargetLandmarks != points)
  {
    this->TargetLandmarks = points;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkPoints* vtkFFDFitLattice::GetTargetLandmarks() { return this->TargetLandmarks; }

//------------------------------------------------------------------------------
void vtkFFDFitLattice::SetLandmarkWeights(vtkDataArray* weights)
{
  if (this->LandmarkWeights != weights)
  {
    this->LandmarkWeights = weights;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkDataArray* vtkFFDFitLattice::GetLandmarkWeights() { return this->LandmarkWeights; }

//------------------------------------------------------------------------------
void vtkFFDFitLattice::SetTransform(vtkAbstractTransform* transform)
{
  if (this->Transform != transform)
  {
    this->Transform = transform;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
vtkAbstractTransform* vtkFFDFitLattice::GetTransform() { return this->Transform; }

//------------------------------------------------------------------------------
void vtkFFDFitLattice::SetSmoothness(double smoothness)
{
  if (!(smoothness >= 0.0) || !std::isfinite(smoothness))
  {
    vtkErrorMacro("SetSmoothness: the smoothness is " << smoothness << ". Give 0 or more.");
    return;
  }
  if (this->Smoothness != smoothness)
  {
    this->Smoothness = smoothness;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkFFDFitLattice::SetTolerance(double tolerance)
{
  vtkFFDSetTolerance(this, "SetTolerance", this->Tolerance, tolerance);
}

//------------------------------------------------------------------------------
void vtkFFDFitLattice::SetBounds(const double bounds[6])
{
  vtkFFDSetBounds(this, "SetBounds", this->Bounds, bounds);
}

//------------------------------------------------------------------------------
void vtkFFDFitLattice::SetBounds(
  double xmin, double xmax, double ymin, double ymax, double zmin, double zmax)
{
  const double bounds[6] = { xmin, xmax, ymin, ymax, zmin, zmax };
  this->SetBounds(bounds);
}

//------------------------------------------------------------------------------
vtkFFDLattice* vtkFFDFitLattice::GetLattice()
{
  this->Update();
  return this->MaximumError >= 0.0 ? this->Lattice.GetPointer() : nullptr;
}

//------------------------------------------------------------------------------
vtkMTimeType vtkFFDFitLattice::GetMTime()
{
  vtkMTimeType time = this->Superclass::GetMTime();
  for (vtkObject* object : { static_cast<vtkObject*>(this->SourceLandmarks),
         static_cast<vtkObject*>(this->TargetLandmarks),
         static_cast<vtkObject*>(this->LandmarkWeights), static_cast<vtkObject*>(this->Transform) })
  {
    time = object ? std::max(time, object->GetMTime()) : time;
  }
  return time;
}

//------------------------------------------------------------------------------
int vtkFFDFitLattice::FillInputPortInformation(int port, vtkInformation* info)
{
  if (!this->Superclass::FillInputPortInformation(port, info))
  {
    return 0;
  }
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  // Blocks are refused by name: a lattice is fitted before the executive would hand them over.
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDFitLattice::RequestInformation(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  // The number of control points is a result of the fit, and filters downstream, a writer for
  // instance, need the true extent. So the fit is made here.
  vtkInformation* info = outputs->GetInformationObject(0);
  vtkFFDFollowTime(inputs[0]->GetInformationObject(0), info);
  vtkImageData* field = nullptr;
  if (this->GetNumberOfInputConnections(0) > 0)
  {
    vtkFFDUpdateWhole(this->GetInputConnection(0, 0), info);
    vtkDataObject* data = this->GetInputDataObject(0, 0);
    if (data && data->IsA("vtkCompositeDataSet"))
    {
      vtkErrorMacro("The input is a "
        << data->GetClassName()
        << ", and a lattice is fitted to one vtkImageData of "
           "displacements. Take one of its blocks (vtkExtractBlock).");
      return 0;
    }
    field = vtkImageData::SafeDownCast(data);
  }
  if (!(this->FitTime > this->GetMTime()) || (field && field->GetMTime() > this->FitTime))
  {
    this->MaximumError = -1.0;
    this->RootMeanSquareError = -1.0;
    // An executive does this before it asks for data, which is too late here.
    this->AbortExecute = 0;
    this->Fit(field);
    this->Aborted = this->AbortExecute != 0;
    this->FitTime.Modified();
  }
  if (this->MaximumError < 0.0)
  {
    constexpr int none[6] = { 0, -1, 0, -1, 0, -1 };
    info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), none, 6);
    info->Set(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), none, 6);
    this->GetOutputDataObject(0)->Initialize();
    return this->Aborted ? 1 : 0;
  }
  vtkFFDDescribeLatticeImage(this->Lattice, info);
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDFitLattice::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*)
{
  // All of the field, whatever part of the control points is asked for.
  vtkFFDRequestWhole(inputs[0]->GetInformationObject(0));
  return 1;
}

//------------------------------------------------------------------------------
int vtkFFDFitLattice::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  vtkImageData* output = vtkImageData::GetData(outputs);
  if (output && this->MaximumError < 0.0)
  {
    return 1; // the fit was aborted
  }
  return output ? this->Lattice->ToImageData(output) : 0;
}

//------------------------------------------------------------------------------
void vtkFFDFitLattice::Fit(vtkImageData* field)
{
  const FitInput input{ this->SourceLandmarks, this->TargetLandmarks, this->LandmarkWeights, field,
    this->Transform };
  double bounds[6];
  std::copy(this->Bounds, this->Bounds + 6, bounds);
  const std::string problem = FindFitProblem(input, bounds);
  if (!problem.empty())
  {
    vtkErrorMacro(<< problem << ".");
    return;
  }
  ffd::FitLimits limits;
  limits.Tolerance = this->Tolerance;
  limits.MaximumCells = this->MaximumCells;
  limits.Parallel = vtkFFDParallelFor();
  limits.Proceed = [this](double done) {
    this->UpdateProgress(done);
    return !this->GetAbortExecute();
  };
  ffd::FittedNet fit;
  fit.Lower = { bounds[0], bounds[2], bounds[4] };
  fit.Extent = { bounds[1] - bounds[0], bounds[3] - bounds[2], bounds[5] - bounds[4] };
  const ffd::FitStatus status = input.HasLandmarks()
    ? FitLandmarks(input, this->Smoothness, limits, fit)
    : field ? FitField(field, limits, fit)
            : FitTransform(this->Transform, limits, fit);
  if (status == ffd::FitStatus::Stopped)
  {
    vtkWarningMacro("The fit was aborted; there is no lattice.");
    return;
  }
  if (status == ffd::FitStatus::NotFinite)
  {
    vtkErrorMacro("The " << input.GetName()
                         << " to fit give values that are not finite within the bounds, or no "
                            "samples lie in them.");
    return;
  }
  vtkNew<vtkImageData> image;
  const glm::dvec3 origin = fit.GetOrigin();
  const glm::dvec3 spacing = fit.GetSpacing();
  image->SetDimensions(fit.Net.Nodes.x, fit.Net.Nodes.y, fit.Net.Nodes.z);
  image->SetOrigin(origin.x, origin.y, origin.z);
  image->SetSpacing(spacing.x, spacing.y, spacing.z);
  image->GetPointData()->SetScalars(vtkFFDMakeDisplacementArray(fit.Net.Values));
  if (!this->Lattice->FromImageData(image))
  {
    return;
  }
  this->MaximumError = fit.LargestError;
  this->RootMeanSquareError = fit.RootMeanSquareError;
  if (status == ffd::FitStatus::NotReached)
  {
    vtkWarningMacro("The largest error is " << fit.LargestError << " instead of the Tolerance of "
                                            << this->Tolerance
                                            << ". Allow more MaximumCells, or a lower Smoothness.");
  }
  this->UpdateProgress(1.0);
}
