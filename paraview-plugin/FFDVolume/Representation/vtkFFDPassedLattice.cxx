// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDPassedLattice.h"

#include "vtkFFDLattice.h"
#include "vtkFFDShownGeometry.h"
#include "vtkFFDShownLattice.h"

#include "vtkAlgorithm.h"
#include "vtkCellDataToPointData.h"
#include "vtkCommand.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObject.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkVersion.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace
{

/// A data object, and the leaves of a composite one after it.
std::vector<vtkDataObject*> FindAll(vtkDataObject* data)
{
  std::vector<vtkDataObject*> all = { data };
  if (auto* parts = vtkCompositeDataSet::SafeDownCast(data))
  {
    vtkSmartPointer<vtkCompositeDataIterator> iterator;
    iterator.TakeReference(parts->NewIterator());
    for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
    {
      all.push_back(iterator->GetCurrentDataObject());
    }
  }
  return all;
}

/// The output gets the field data of a data object with a lattice, and keeps its own.
void PassFields(vtkDataObject* from, vtkDataObject* output)
{
  if (from && vtkFFDLattice::HasLattice(from) && !vtkFFDLattice::HasLattice(output))
  {
    vtkNew<vtkFieldData> fields;
    fields->PassData(from->GetFieldData());
    fields->PassData(output->GetFieldData());
    output->SetFieldData(fields);
  }
}

/// The first input of a filter; null where it has none.
vtkDataObject* GetInput(vtkAlgorithm* filter)
{
  return filter->GetNumberOfInputConnections(0) > 0 ? filter->GetInputDataObject(0, 0) : nullptr;
}

/// After a filter executed, its output has the lattice of its first input.
class Passing : public vtkCommand
{
public:
  static Passing* New() { return new Passing; }

  void Execute(vtkObject* caller, unsigned long, void*) override
  {
    auto* filter = vtkAlgorithm::SafeDownCast(caller);
    vtkDataObject* input = GetInput(filter);
    vtkDataObject* output = filter->GetOutputDataObject(0);
    if (!input || !output)
    {
      return;
    }
    const std::vector<vtkDataObject*> inputs = FindAll(input);
    const std::vector<vtkDataObject*> outputs = FindAll(output);
    if (inputs.size() == outputs.size())
    {
      for (std::size_t i = 0; i < inputs.size(); ++i)
      {
        PassFields(inputs[i], outputs[i]);
      }
    }
    else
    {
      // One part is made of all.
      PassFields(vtkFFDShownLattice::FindCarrier(input), output);
    }
    if (filter->IsA("vtkPOutlineFilter") && vtkFFDLattice::HasLattice(output))
    {
      vtkFFDShownGeometry::CutLines(vtkPolyData::SafeDownCast(output));
    }
  }
};

/**
 * The lattice between two with as many control points, a fraction of the way from the first. The
 * grid is between both, too: one that is cut to what a linear transform moves is another one in
 * each step. Null where there is none between them.
 */
vtkSmartPointer<vtkFFDLattice> Interpolate(
  vtkDataObject* first, vtkDataObject* second, double fraction)
{
  vtkNew<vtkFFDLattice> from;
  vtkNew<vtkFFDLattice> to;
  if (!from->ReadFrom(first) || !to->ReadFrom(second) ||
    !std::equal(from->GetDimensions(), from->GetDimensions() + 3, to->GetDimensions()) ||
    from->GetBorderMode() != to->GetBorderMode() || from->GetInverseFlag() != to->GetInverseFlag())
  {
    return nullptr;
  }
  double domain[6];
  for (int i = 0; i < 6; ++i)
  {
    domain[i] = (1.0 - fraction) * from->GetDomain()[i] + fraction * to->GetDomain()[i];
  }
  vtkNew<vtkDoubleArray> displacements;
  displacements->DeepCopy(from->GetDisplacements());
  const double* end = to->GetDisplacements()->GetPointer(0);
  double* between = displacements->GetPointer(0);
  for (vtkIdType i = 0; i < displacements->GetNumberOfValues(); ++i)
  {
    between[i] = (1.0 - fraction) * from->GetDisplacementScale() * between[i] +
      fraction * to->GetDisplacementScale() * end[i];
  }
  from->SetDomain(domain);
  from->SetDisplacementScale(1.0);
  from->SetDisplacements(displacements);
  return from;
}

/// After a filter interpolated between two steps in time, its output has the lattice between
/// theirs.
class Interpolation : public vtkCommand
{
public:
  static Interpolation* New() { return new Interpolation; }

  /// The input is the first step that the filter asks for when it starts, and the last one at the
  /// end. It asks for none that it remembers: so do we.
  void Execute(vtkObject* caller, unsigned long event, void*) override
  {
    auto* filter = vtkAlgorithm::SafeDownCast(caller);
    vtkDataObject* input = GetInput(filter);
    vtkDataObject* output = filter->GetOutputDataObject(0);
    if (event == vtkCommand::StartEvent)
    {
      this->Taken.clear();
    }
    if (input && input->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP()))
    {
      this->Take(input);
    }
    if (event == vtkCommand::EndEvent && input && output &&
      output->GetInformation()->Has(vtkDataObject::DATA_TIME_STEP()))
    {
      const double time = output->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP());
      const std::vector<double> needed = FindNeeded(filter->GetInputInformation(0, 0), time);
      this->Remember(needed);
      this->PassBetween(needed, time, output);
      // As many as the filter remembers.
      if (this->Steps.size() > 2)
      {
        this->Steps.erase(this->Steps.begin(), this->Steps.end() - 2);
      }
    }
  }

private:
  /// The field data of a step, of the whole and of its leaves.
  struct Step
  {
    double Time;
    std::vector<vtkSmartPointer<vtkDataObject>> Carriers;
  };

  static std::vector<Step>::iterator Find(std::vector<Step>& steps, double time)
  {
    return std::find_if(
      steps.begin(), steps.end(), [time](const Step& step) { return step.Time == time; });
  }

  /// The steps that the filter makes its output for a time of: one or two.
  static std::vector<double> FindNeeded(vtkInformation* input, double time)
  {
    const double* first = input->Get(vtkStreamingDemandDrivenPipeline::TIME_STEPS());
    const int count = input->Length(vtkStreamingDemandDrivenPipeline::TIME_STEPS());
    if (count == 0)
    {
      return {};
    }
    const double* last = first + count - 1;
    const double* next = std::lower_bound(first, last, time);
    if (next == first || time >= *last)
    {
      return { *next };
    }
    return { next[-1], *next };
  }

  void Take(vtkDataObject* input)
  {
    Step step{ input->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()), {} };
    for (vtkDataObject* each : FindAll(input))
    {
      step.Carriers.push_back(vtkSmartPointer<vtkDataObject>::New());
      step.Carriers.back()->GetFieldData()->PassData(each->GetFieldData());
    }
    this->Taken.push_back(step);
  }

  void Remember(const std::vector<double>& needed)
  {
    for (const double time : needed)
    {
      const auto taken = Find(this->Taken, time);
      const auto known = Find(this->Steps, time);
      if (taken != this->Taken.end() && known != this->Steps.end())
      {
        *known = *taken;
      }
      else if (taken != this->Taken.end())
      {
        this->Steps.push_back(*taken);
      }
    }
    this->Taken.clear();
  }

  void PassBetween(const std::vector<double>& needed, double time, vtkDataObject* output)
  {
    const std::vector<vtkDataObject*> outputs = FindAll(output);
    for (const double each : needed)
    {
      const auto step = Find(this->Steps, each);
      if (step == this->Steps.end() || step->Carriers.size() != outputs.size())
      {
        return;
      }
    }
    if (needed.empty())
    {
      return;
    }
    const Step& before = *Find(this->Steps, needed.front());
    const Step& after = *Find(this->Steps, needed.back());
    const double fraction =
      needed.size() > 1 ? (time - before.Time) / (after.Time - before.Time) : 0.0;
    for (std::size_t i = 0; i < outputs.size(); ++i)
    {
      vtkDataObject* const first = before.Carriers[i];
      vtkDataObject* const second = after.Carriers[i];
      const bool isBetween = fraction > 0.0 && fraction < 1.0 &&
        !vtkFFDLattice::HasLattice(outputs[i]) && vtkFFDLattice::HasLattice(first) &&
        vtkFFDLattice::HasLattice(second);
      PassFields(fraction < 0.5 ? first : second, outputs[i]);
      const vtkSmartPointer<vtkFFDLattice> lattice =
        isBetween ? Interpolate(first, second, fraction) : nullptr;
      if (lattice)
      {
        lattice->AttachTo(outputs[i]);
      }
    }
  }

  std::vector<Step> Taken; // while the filter executes
  std::vector<Step> Steps;
};

/// After a filter made one data set of several parts, it warns where one lattice moves them that
/// are shown by unlike ones: once, until they are alike again.
class Warning : public vtkCommand
{
public:
  static Warning* New() { return new Warning; }
  std::string Label;

  void Execute(vtkObject* caller, unsigned long, void*) override
  {
    const bool wasMixed = this->Mixed;
    this->Mixed = AreMixed(vtkAlgorithm::SafeDownCast(caller));
    if (this->Mixed && !wasMixed)
    {
      vtkWarningWithObjectMacro(
        caller, << "\"" << this->Label
                << "\" makes one data set of parts with different lattices, or of some with and "
                   "some without "
                   "one, and it has the lattice of the first part. Keep the parts apart by \"Group "
                   "Datasets\", or move each of them by \"FFD Deform Geometry\" before.");
    }
  }

private:
  static bool AreMixed(vtkAlgorithm* filter)
  {
    std::vector<vtkFFDShownLattice> shown;
    for (int i = 0; i < filter->GetNumberOfInputConnections(0); ++i)
    {
      vtkDataObject* const input = filter->GetInputDataObject(0, i);
      const std::vector<vtkDataObject*> all = FindAll(input);
      // That of the whole counts if no leaf has one.
      vtkDataObject* const whole =
        std::any_of(all.begin() + 1, all.end(), vtkFFDLattice::HasLattice) ? nullptr : input;
      for (vtkDataObject* each : all)
      {
        vtkDataSet* const part = vtkDataSet::SafeDownCast(each);
        if (part && part->GetNumberOfPoints() > 0)
        {
          shown.emplace_back(vtkFFDLattice::HasLattice(part) ? part : whole);
        }
      }
    }
    return std::any_of(shown.begin(), shown.end(),
      [&shown](const vtkFFDShownLattice& each) { return !each.IsLike(shown.front()); });
  }

  bool Mixed = false;
};

/**
 * Passes the lattice, as Passing. It has the name of its superclass, by which ParaView finds the
 * functions that properties call.
 */
class PassingCellDataToPointData : public vtkCellDataToPointData
{
public:
  static vtkObject* Create()
  {
    auto* created = new PassingCellDataToPointData;
    created->InitializeObjectBase();
    return created;
  }

protected:
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override
  {
    const int isDone = this->Superclass::RequestData(request, inputs, outputs);
    PassFields(vtkDataObject::GetData(inputs[0]), vtkDataObject::GetData(outputs));
    return isDone;
  }

private:
  using Superclass = vtkCellDataToPointData;
};

/**
 * Makes the filter "Cell Data to Point Data" pass lattices, also where nobody can be attached to
 * it: between any two filters the second of which asks for values of points, as contours do,
 * ParaView makes one for a moment where the first has values of cells.
 */
class PassingFactory : public vtkObjectFactory
{
public:
  static PassingFactory* New() { VTK_STANDARD_NEW_BODY(PassingFactory); }
  vtkTypeMacro(PassingFactory, vtkObjectFactory);
  const char* GetVTKSourceVersion() override { return VTK_SOURCE_VERSION; }
  const char* GetDescription() override { return "Lattices of FFDVolume"; }

protected:
  PassingFactory()
  {
    this->RegisterOverride("vtkCellDataToPointData", "vtkCellDataToPointData", "passes lattices on",
      1, &PassingCellDataToPointData::Create);
  }
};

/// In each process that loads the plugin.
[[maybe_unused]] const bool IsPassingRegistered = [] {
  vtkNew<PassingFactory> factory;
  vtkObjectFactory::RegisterFactory(factory);
  return true;
}();

} // namespace

//------------------------------------------------------------------------------
void ffdpassing::Follow(vtkAlgorithm* filter)
{
  // What they are called in the menu.
  constexpr std::pair<const char*, const char*> merging[] = { { "vtkAppendPolyData",
                                                                "Append Geometry" },
    { "vtkAppendDataSets", "Append Datasets" }, { "vtkMergeBlocks", "Merge Blocks" } };
  for (const auto& [name, label] : merging)
  {
    if (filter->IsA(name))
    {
      vtkNew<Warning> warning;
      warning->Label = label;
      filter->AddObserver(vtkCommand::EndEvent, warning);
      return;
    }
  }
  if (filter->IsA("vtkTemporalInterpolator"))
  {
    vtkNew<Interpolation> between;
    filter->AddObserver(vtkCommand::StartEvent, between);
    filter->AddObserver(vtkCommand::EndEvent, between);
    return;
  }
  vtkNew<Passing> passing;
  filter->AddObserver(vtkCommand::EndEvent, passing);
}
