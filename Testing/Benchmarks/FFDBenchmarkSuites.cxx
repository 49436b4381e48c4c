// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDBenchmarkSuites.h"

#include "FFDBenchmarkBlend.h"
#include "FFDBenchmarkResample.h"
#include "FFDBenchmarkScene.h"
#include "FFDBenchmarkWidget.h"
#include "FFDGatherLoop.h"

#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDLattice.h"
#include "vtkFFDRayStatistics.h"

#include "vtkBSplineTransform.h"
#include "vtkDataArray.h"
#include "vtkGridTransform.h"
#include "vtkImageData.h"
#include "vtkImageReslice.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkSMPThreadLocal.h"
#include "vtkSMPTools.h"
#include "vtkTransformToGrid.h"
#include "vtkVolume.h"
#include "vtkVolumeMapper.h"
#include "vtkVolumeProperty.h"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>

namespace ffdBenchmark
{

namespace
{

using ImagePointer = vtkSmartPointer<vtkImageData>;

/// The control point that is dragged, and how far.
constexpr int Dragged = 4;
constexpr double DragStep = 1.0;

/// Steps of the displacement grid of the faster resample route, voxels.
constexpr double GridStep = 8.0;

/// Rows that are timed so few times at most are those that take long.
constexpr std::size_t SlowRounds = 3;

//------------------------------------------------------------------------------
/// Note the difference, and refuse the row when it is too large.
void Judge(Row* row, const Stage& stage, vtkUnsignedCharArray* picture, const char* oracle,
  vtkUnsignedCharArray* expected, const Tolerance& tolerance)
{
  const Difference difference = Compare(picture, expected, stage.GetSize(), tolerance.Block);
  row->Counters["image_mean_difference"] = difference.Mean;
  row->Counters["image_outliers_percent"] = 100.0 * difference.Outliers;
  row->Counters["covered_percent"] = 100.0 * difference.Covered;
  char text[256];
  if (difference.Covered == 0.0)
  {
    std::snprintf(text, sizeof(text), "the picture and that of %s are empty", oracle);
    row->Refusal = text;
  }
  else if (difference.Mean > tolerance.Mean || difference.Outliers > tolerance.Outliers)
  {
    std::snprintf(text, sizeof(text),
      "the picture differs from %s: mean %.2f of 255 (allowed %.2f), outliers %.2f %% (%.2f %%)",
      oracle, difference.Mean, tolerance.Mean, 100.0 * difference.Outliers,
      100.0 * tolerance.Outliers);
    row->Refusal = text;
  }
}

//------------------------------------------------------------------------------
double GetAuxiliaryPercent(vtkFFDInverseRayVolumeMapper* mapper, vtkImageData* image)
{
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  return 100.0 * static_cast<double>(mapper->GetAuxiliaryMemorySize()) /
    (static_cast<double>(scalars->GetNumberOfValues()) * scalars->GetDataTypeSize());
}

//------------------------------------------------------------------------------
/// A frame, what it took noted in the row; returns its picture.
vtkSmartPointer<vtkUnsignedCharArray> DrawAndCount(Stage& stage,
  vtkFFDInverseRayVolumeMapper* mapper, vtkVolume* volume, vtkImageData* image, Row& row)
{
  mapper->CollectStatisticsOn();
  const auto picture = stage.DrawAndCapture(volume);
  vtkFFDRayStatistics* statistics = mapper->GetStatistics();
  row.Counters["rays"] = static_cast<double>(statistics->GetNumberOfRays());
  row.Counters["segments_per_ray"] = statistics->GetSegmentsPerRay();
  row.Counters["segment_length"] = statistics->GetAverageSegmentLength();
  row.Counters["samples_per_ray"] = statistics->GetSamplesPerRay();
  row.Counters["visible_per_ray"] = statistics->GetVisibleSamplesPerRay();
  row.Counters["lookups_per_ray"] = statistics->GetDistanceLookupsPerRay();
  row.Counters["evaluations_per_ray"] = statistics->GetEvaluationsPerRay();
  row.Counters["unconverged"] = static_cast<double>(statistics->GetNumberOfUnconvergedPoints());
  row.Counters["auxiliary_percent"] = GetAuxiliaryPercent(mapper, image);
  mapper->CollectStatisticsOff();
  if (row.Rounds > SlowRounds)
  {
    // The setting makes the mapper look at its deformation again. What is slow does not notice.
    stage.Draw(volume);
  }
  return picture;
}

//------------------------------------------------------------------------------
// Frames

struct FrameSettings
{
  std::string VolumeName;
  Opacity Setting = Opacity::Opaque;
  int Size = 512;
  Deformation Shape;
};

struct FrameScene
{
  FrameScene(const FrameSettings& settings, ImagePointer image)
    : Image(image)
    , View(settings.Size, image)
    , Property(MakeProperty(settings.Setting))
  {
    Deform(this->Still, image, { Shape::Identity, 0.0 });
    Deform(this->Deformed, image, settings.Shape);
  }

  ImagePointer Image;
  vtkNew<vtkFFDLattice> Still;
  vtkNew<vtkFFDLattice> Deformed;
  Stage View;
  vtkSmartPointer<vtkVolumeProperty> Property;
};

struct NamedVariant
{
  const char* Name;
  Variant How;
  const Tolerance& Allowed;
};

constexpr NamedVariant FrameVariants[] = {
  { "exact", Variant::Exact, OracleTolerance },
  { "firstorder", Variant::FirstOrder, OracleTolerance },
  { "paper", Variant::Paper, PaperTolerance },
  { "unoptimized", Variant::Unoptimized, OracleTolerance },
};

//------------------------------------------------------------------------------
std::shared_ptr<void> PrepareFrames(
  Group& group, const FrameSettings& settings, const std::string& folder)
{
  auto scene = std::make_shared<FrameScene>(settings, ReadVolume(folder, settings.VolumeName));
  Stage* stage = &scene->View;
  const auto drawing = [stage](
                         vtkVolume* volume) { return [stage, volume] { stage->Draw(volume); }; };

  Row* fixedPoint = group.FindRow("fixedpoint");
  Row* identity = group.FindRow("identity");
  if (fixedPoint)
  {
    auto mapper = MakeFixedPointMapper();
    mapper->SetInputData(scene->Image);
    vtkVolume* volume = stage->AddVolume(mapper, scene->Property);
    fixedPoint->Run = drawing(volume);
  }
  if (identity)
  {
    auto oracle = MakeOracle(scene->Image, scene->Still, Variant::Exact);
    const auto expected = stage->DrawAndCapture(stage->AddVolume(oracle, scene->Property));
    auto mapper = MakeMapper(scene->Image, scene->Still, Variant::Exact);
    vtkVolume* volume = stage->AddVolume(mapper, scene->Property);
    const auto picture = DrawAndCount(*stage, mapper, volume, scene->Image, *identity);
    Judge(identity, *stage, picture, "the reference kernels", expected, OracleTolerance);
    identity->Run = drawing(volume);
  }
  for (const NamedVariant& variant : FrameVariants)
  {
    Row* row = group.FindRow(variant.Name);
    if (!row)
    {
      continue;
    }
    auto oracle = MakeOracle(scene->Image, scene->Deformed, variant.How);
    vtkVolume* oracleVolume = stage->AddVolume(oracle, scene->Property);
    const auto expected = stage->DrawAndCapture(oracleVolume);
    auto mapper = MakeMapper(scene->Image, scene->Deformed, variant.How);
    vtkVolume* volume = stage->AddVolume(mapper, scene->Property);
    const auto picture = DrawAndCount(*stage, mapper, volume, scene->Image, *row);
    Judge(row, *stage, picture, "the reference kernels", expected, variant.Allowed);
    row->Run = drawing(volume);
  }
  return scene;
}

//------------------------------------------------------------------------------
// Drags

/// The usual way: the volume is resampled through a transform, and then rendered. Both transforms
/// are read as vtkImageReslice reads them, from output to input: no inverse is ever computed.
class ResampleRoute
{
public:
  ResampleRoute(vtkImageData* image, vtkFFDLattice* lattice, const double bounds[6], bool grid)
    : ThroughGrid(grid)
  {
    this->Coefficients->DeepCopy(lattice->GetCoefficientData());
    this->Spline->SetCoefficientData(this->Coefficients);
    this->Spline->SetBorderMode(lattice->GetBorderMode());
    double origin[3];
    int extent[6] = { 0, 0, 0, 0, 0, 0 };
    int gridExtent[6] = { 0, 0, 0, 0, 0, 0 };
    for (int a = 0; a < 3; ++a)
    {
      origin[a] = std::floor(bounds[2 * a]);
      extent[2 * a + 1] = static_cast<int>(std::ceil(bounds[2 * a + 1] - origin[a]));
      gridExtent[2 * a + 1] = static_cast<int>(std::ceil(extent[2 * a + 1] / GridStep));
    }
    this->Reslice->SetInputData(image);
    this->Reslice->SetInterpolationModeToLinear();
    this->Reslice->SetOutputOrigin(origin);
    this->Reslice->SetOutputSpacing(1.0, 1.0, 1.0);
    this->Reslice->SetOutputExtent(extent);
    if (grid)
    {
      this->ToGrid->SetInput(this->Spline);
      this->ToGrid->SetGridOrigin(origin);
      this->ToGrid->SetGridSpacing(GridStep, GridStep, GridStep);
      this->ToGrid->SetGridExtent(gridExtent);
      this->ToGrid->SetGridScalarTypeToFloat();
      this->Grid->SetDisplacementGridConnection(this->ToGrid->GetOutputPort());
      this->Grid->SetInterpolationModeToLinear();
      this->Reslice->SetResliceTransform(this->Grid);
    }
    else
    {
      this->Reslice->SetResliceTransform(this->Spline);
    }
    this->Mapper->SetInputConnection(this->Reslice->GetOutputPort());
    this->Voxels = 1.0;
    for (int a = 0; a < 3; ++a)
    {
      this->Voxels *= extent[2 * a + 1] + 1;
    }
  }

  void SetDisplacement(vtkIdType point, double x)
  {
    this->Coefficients->GetPointData()->GetScalars()->SetComponent(point, 0, x);
    this->Coefficients->GetPointData()->GetScalars()->Modified();
    this->Coefficients->Modified();
    this->Spline->Modified();
    if (this->ThroughGrid)
    {
      // vtkGridTransform does not see that the source of its grid is out of date.
      this->ToGrid->Update();
      this->Grid->Modified();
    }
  }

  vtkVolumeMapper* GetMapper() { return this->Mapper; }
  double GetNumberOfVoxels() const { return this->Voxels; }

private:
  bool ThroughGrid;
  double Voxels = 0.0;
  vtkNew<vtkImageData> Coefficients;
  vtkNew<vtkBSplineTransform> Spline;
  vtkNew<vtkTransformToGrid> ToGrid;
  vtkNew<vtkGridTransform> Grid;
  vtkNew<vtkImageReslice> Reslice;
  vtkSmartPointer<vtkVolumeMapper> Mapper = MakeFixedPointMapper();
};

struct DragScene
{
  DragScene(ImagePointer image, int side)
    : Image(image)
    , View(512, image)
    , Property(MakeProperty(Opacity::Opaque))
  {
    Deform(this->Lattice, image, { Shape::Smooth, 45.0 / 256.0 * side });
    double displacement[3];
    this->Lattice->GetDisplacement(Dragged, Dragged, Dragged, displacement);
    this->Displacement = displacement[0];
  }

  /// The next position of the dragged point: to and fro.
  double Move(int& step) const { return this->Displacement + (++step % 2 == 0 ? 0.0 : DragStep); }

  ImagePointer Image;
  vtkNew<vtkFFDLattice> Lattice;
  Stage View;
  vtkSmartPointer<vtkVolumeProperty> Property;
  double Displacement = 0.0;
  std::vector<std::unique_ptr<ResampleRoute>> Routes;
};

constexpr NamedVariant DragVariants[] = {
  { "exact", Variant::Exact, OracleTolerance },
  { "firstorder", Variant::FirstOrder, OracleTolerance },
  { "pullback", Variant::PullBack, OracleTolerance },
};

//------------------------------------------------------------------------------
std::shared_ptr<void> PrepareDrags(Group& group, int side, const std::string& folder)
{
  auto scene =
    std::make_shared<DragScene>(ResampleToCube(ReadVolume(folder, "engine"), side), side);
  DragScene* s = scene.get();
  for (const NamedVariant& variant : DragVariants)
  {
    Row* row = group.FindRow(variant.Name);
    if (!row)
    {
      continue;
    }
    auto oracle = MakeOracle(s->Image, s->Lattice, variant.How);
    const auto expected = s->View.DrawAndCapture(s->View.AddVolume(oracle, s->Property));
    auto lattice = vtkSmartPointer<vtkFFDLattice>::New();
    lattice->DeepCopy(s->Lattice);
    auto mapper = MakeMapper(s->Image, lattice, variant.How);
    vtkVolume* volume = s->View.AddVolume(mapper, s->Property);
    const auto picture = DrawAndCount(s->View, mapper, volume, s->Image, *row);
    Judge(row, s->View, picture, "the reference kernels", expected, variant.Allowed);
    row->Run = [s, volume, lattice, step = 0]() mutable {
      double d[3];
      lattice->GetDisplacement(Dragged, Dragged, Dragged, d);
      lattice->SetDisplacement(Dragged, Dragged, Dragged, s->Move(step), d[1], d[2]);
      s->View.Draw(volume);
    };
  }
  // The resample routes show what ours shows in PULL_BACK mode.
  auto pullBack = MakeMapper(s->Image, s->Lattice, Variant::PullBack);
  const auto expected = s->View.DrawAndCapture(s->View.AddVolume(pullBack, s->Property));
  double bounds[6];
  pullBack->GetBounds(bounds);
  const vtkIdType point = (Dragged * 8 + Dragged) * 8 + Dragged;
  for (const char* name : { "bspline", "grid" })
  {
    Row* row = group.FindRow(name);
    if (!row)
    {
      continue;
    }
    s->Routes.push_back(std::make_unique<ResampleRoute>(
      s->Image, s->Lattice, bounds, std::strcmp(name, "grid") == 0));
    ResampleRoute* route = s->Routes.back().get();
    vtkVolume* volume = s->View.AddVolume(route->GetMapper(), s->Property);
    Judge(row, s->View, s->View.DrawAndCapture(volume), "ours in PULL_BACK mode", expected,
      ResampleTolerance);
    row->Counters["resampled_voxels"] = route->GetNumberOfVoxels();
    row->Run = [s, volume, route, point, step = 0]() mutable {
      route->SetDisplacement(point, s->Move(step));
      s->View.Draw(volume);
    };
  }
  return scene;
}

//------------------------------------------------------------------------------
// Edits: what they add to a frame is seen best in a tiny one.

std::shared_ptr<void> PrepareEdits(Group& group, int side, const std::string& folder)
{
  struct Scene : DragScene
  {
    using DragScene::DragScene;
    vtkNew<vtkImageData> Picture;
  };
  auto scene = std::make_shared<Scene>(ResampleToCube(ReadVolume(folder, "engine"), side), side);
  Scene* s = scene.get();
  for (Row& row : group.GetRows())
  {
    auto lattice = vtkSmartPointer<vtkFFDLattice>::New();
    lattice->DeepCopy(s->Lattice);
    auto mapper = MakeMapper(s->Image, lattice, Variant::Exact);
    auto property = MakeProperty(Opacity::Opaque);
    vtkVolume* volume = s->View.AddVolume(mapper, property);
    s->View.Draw(volume);
    row.Counters["auxiliary_percent"] = GetAuxiliaryPercent(mapper, s->Image);
    const auto draw = [s, mapper, volume] {
      mapper->RenderToImage(s->View.GetRenderer(), volume, 16, 16, s->Picture);
    };
    auto editLattice = [s, lattice, step = 0]() mutable {
      double d[3];
      lattice->GetDisplacement(Dragged, Dragged, Dragged, d);
      lattice->SetDisplacement(Dragged, Dragged, Dragged, s->Move(step), d[1], d[2]);
    };
    if (row.Name == "tiny_frame")
    {
      row.Run = draw;
    }
    else if (row.Name == "transfer_edit")
    {
      row.Run = [draw, property, step = 0]() mutable {
        double node[4];
        vtkPiecewiseFunction* opacity = property->GetScalarOpacity();
        opacity->GetNodeValue(1, node);
        node[1] = ++step % 2 == 0 ? 0.9 : 0.89;
        opacity->SetNodeValue(1, node);
        draw();
      };
    }
    else if (row.Name == "lattice_edit")
    {
      row.Run = [draw, editLattice]() mutable {
        editLattice();
        draw();
      };
    }
    else if (row.Name == "bounds")
    {
      row.Run = [mapper, editLattice]() mutable {
        editLattice();
        mapper->GetBounds();
      };
    }
  }
  return scene;
}

//------------------------------------------------------------------------------
// The limit: samples a second, of a bare loop and of ours when it takes every sample.

std::shared_ptr<void> PrepareLimit(Group& group, const std::string& folder)
{
  struct Scene
  {
    explicit Scene(ImagePointer image)
      : Image(image)
      , View(512, image)
    {
    }
    ImagePointer Image;
    std::vector<std::uint8_t> Voxels;
    GatherVolume Gather;
    float Checksum = 0.0f;
    Stage View;
    vtkNew<vtkImageData> Picture;
  };
  auto scene = std::make_shared<Scene>(ReadVolume(folder, "engine"));
  Scene* s = scene.get();
  for (Row& row : group.GetRows())
  {
    if (row.Name == "gather")
    {
      const auto* voxels = static_cast<const std::uint8_t*>(s->Image->GetScalarPointer());
      const auto count = static_cast<std::size_t>(s->Image->GetNumberOfPoints());
      s->Voxels.assign(voxels, voxels + count);
      s->Voxels.resize(count + 3);
      s->Gather.Voxels = s->Voxels.data();
      s->Image->GetDimensions(s->Gather.Dimensions);
      const int rows = GetNumberOfGatherRows(s->Gather);
      std::size_t samples = 0;
      for (int i = 0; i < rows; ++i)
      {
        samples += GatherRow(s->Gather, i, s->Checksum);
      }
      row.Counters["samples"] = static_cast<double>(samples);
      row.Run = [s, rows] {
        vtkSMPThreadLocal<float> sums;
        vtkSMPTools::For(0, rows, 1, [s, &sums](vtkIdType first, vtkIdType last) {
          for (vtkIdType i = first; i < last; ++i)
          {
            GatherRow(s->Gather, static_cast<int>(i), sums.Local());
          }
        });
        for (float sum : sums)
        {
          s->Checksum += sum;
        }
      };
      continue;
    }
    auto lattice = vtkSmartPointer<vtkFFDLattice>::New();
    const bool deformed = row.Name.find("smooth") != std::string::npos;
    Deform(lattice, s->Image, { deformed ? Shape::Smooth : Shape::Identity, 45.0 });
    auto property = MakeProperty(Opacity::Semi);
    property->SetShade(row.Name.find("unshaded") == std::string::npos);
    auto mapper = MakeMapper(s->Image, lattice, Variant::Unoptimized);
    vtkVolume* volume = s->View.AddVolume(mapper, property);
    DrawAndCount(s->View, mapper, volume, s->Image, row);
    row.Counters["samples"] = row.Counters["rays"] * row.Counters["samples_per_ray"];
    row.Run = [s, mapper, volume] {
      mapper->RenderToImage(s->View.GetRenderer(), volume, 512, 512, s->Picture);
    };
  }
  return scene;
}

} // namespace

//------------------------------------------------------------------------------
std::vector<std::unique_ptr<Group>> MakeGroups(const Options& options)
{
  const std::string folder = options.DataFolder;
  const auto rounds = [&options](std::size_t ownQuick, std::size_t ownFull) {
    return options.Rounds > 0 ? static_cast<std::size_t>(options.Rounds)
                              : (options.Quick ? ownQuick : ownFull);
  };
  // Pixels along a side of the picture; the reference kernels, which judge it, take long.
  const int size = options.Quick ? 128 : 512;
  std::vector<std::unique_ptr<Group>> groups;
  const auto add = [&groups](const std::string& name, Group::Preparation prepare,
                     const std::vector<std::pair<std::string, std::size_t>>& rows) {
    auto group = std::make_unique<Group>(name, std::move(prepare));
    for (const auto& row : rows)
    {
      group->AddRow(row.first, row.second);
    }
    if (!group->GetRows().empty())
    {
      groups.push_back(std::move(group));
    }
  };
  const auto addFrames = [&](const FrameSettings& settings, bool slowOnes) {
    const std::string name = "Frame/" + settings.VolumeName + "/" +
      std::string(GetName(settings.Setting)) + "/" + std::to_string(settings.Size) + "/" +
      GetName(settings.Shape);
    std::vector<std::pair<std::string, std::size_t>> rows = { { "fixedpoint", rounds(5, 11) },
      { "identity", rounds(5, 11) }, { "exact", rounds(5, 11) }, { "firstorder", rounds(5, 11) } };
    if (slowOnes)
    {
      // The reference kernels, or every sample taken.
      rows.emplace_back("paper", rounds(1, SlowRounds));
      rows.emplace_back("unoptimized", rounds(1, SlowRounds));
    }
    add(
      name, [settings, folder](Group& group) { return PrepareFrames(group, settings, folder); },
      rows);
  };

  if (options.Quick)
  {
    addFrames({ "engine", Opacity::Opaque, size, { Shape::Smooth, 45.0 } }, true);
    addFrames({ "engine", Opacity::Semi, size, { Shape::Smooth, 45.0 } }, false);
    addFrames({ "cthead", Opacity::Opaque, size, { Shape::Random, 15.0 } }, false);
  }
  else
  {
    for (const char* volume : { "engine", "cthead" })
    {
      for (Opacity opacity : { Opacity::Semi, Opacity::Opaque, Opacity::Sparse })
      {
        for (int side : { 512, 1024 })
        {
          addFrames({ volume, opacity, side, { Shape::Identity, 0.0 } }, true);
          for (Shape shape : { Shape::Smooth, Shape::Random })
          {
            for (double magnitude : { 15.0, 30.0, 45.0 })
            {
              addFrames({ volume, opacity, side, { shape, magnitude } }, true);
            }
          }
        }
      }
    }
  }
  const std::vector<int> sides =
    options.Quick ? std::vector<int>{ 128 } : std::vector<int>{ 128, 256, 512 };
  for (int side : sides)
  {
    const std::size_t slow = rounds(2, side < 512 ? 5 : 2);
    add("Drag/" + std::to_string(side),
      [side, folder](Group& group) { return PrepareDrags(group, side, folder); },
      { { "exact", rounds(5, 11) }, { "firstorder", rounds(5, 11) }, { "pullback", rounds(5, 11) },
        { "bspline", slow }, { "grid", slow } });
    const std::size_t quick = rounds(11, 25);
    add("Edit/" + std::to_string(side),
      [side, folder](Group& group) { return PrepareEdits(group, side, folder); },
      { { "tiny_frame", quick }, { "transfer_edit", quick }, { "lattice_edit", quick },
        { "bounds", quick } });
  }
  for (int side : options.Quick ? std::vector<int>{ 64 } : std::vector<int>{ 128, 256 })
  {
    for (const bool cubic : { false, true })
    {
      add("Resample/" + std::to_string(side) + (cubic ? "/cubic" : "/linear"),
        [side, cubic, folder](Group& group) { return PrepareResample(group, side, cubic, folder); },
        { { "reslice", rounds(3, 7) }, { "pullback", rounds(3, 7) },
          { "reslice_inverse", rounds(1, SlowRounds) }, { "exact", rounds(3, 7) },
          { "firstorder", rounds(3, 7) } });
    }
  }
  add("Limit", [folder](Group& group) { return PrepareLimit(group, folder); },
    { { "gather", rounds(5, 11) }, { "unshaded_identity", rounds(3, 11) },
      { "unshaded_smooth45", rounds(3, 11) }, { "shaded_identity", rounds(3, 11) },
      { "shaded_smooth45", rounds(3, 11) } });
  const std::pair<BlendRows, const char*> blends[] = { { BlendRows::Mip, "Blend/mip" },
    { BlendRows::Isosurface, "Blend/isosurface" },
    { BlendRows::TwoComponents, "Composite/two_components" },
    { BlendRows::GradientOpacity, "Composite/gradient_opacity" } };
  for (const auto& [blend, name] : blends)
  {
    std::vector<std::pair<std::string, std::size_t>> rows = { { "gpu", rounds(2, 5) },
      { "identity", rounds(5, 11) }, { "exact", rounds(5, 11) },
      { "reference", rounds(1, SlowRounds) } };
    if (blend != BlendRows::Isosurface)
    {
      rows.insert(rows.begin(), { "fixedpoint", rounds(5, 11) });
    }
    const BlendRows which = blend;
    add(
      name,
      [which, size, folder](Group& group) { return PrepareBlend(group, which, size, folder); },
      rows);
  }
  AddWidgetGroups(options, groups);
  return groups;
}

} // namespace ffdBenchmark
