// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDBenchmarkTargets.h"

#include "FFDBenchmarkCores.h"
#include "FFDBenchmarkOptions.h"
#include "FFDBenchmarkScene.h"
#include "FFDBenchmarkSizes.h"

#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDLattice.h"
#include "vtkFFDLatticeSource.h"
#include "vtkFFDRayStatistics.h"

#include "vtkCamera.h"
#include "vtkGridTransform.h"
#include "vtkImageData.h"
#include "vtkImageShiftScale.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPiecewiseFunction.h"
#include "vtkRenderer.h"
#include "vtkRTAnalyticSource.h"
#include "vtkSmartPointer.h"
#include "vtkTransformToGrid.h"
#include "vtkVolume.h"
#include "vtkVolumeMapper.h"
#include "vtkVolumeProperty.h"

#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>

namespace ffdBenchmark
{

namespace
{

constexpr double NoNumber = std::numeric_limits<double>::quiet_NaN();

// What is asked for.
constexpr double ExactByFirstOrder = 1.25;
constexpr double BendByFixedPoint = 0.15; // an EXACT frame by an undeformed one
constexpr double EmptyFrameMilliseconds = 2.0;
constexpr double ResamplingByEdit = 60.0;
constexpr double DragByUndeformed = 1.2;
constexpr double KeptPercent = 85.0;
constexpr double Avx2ByAvx512 = 1.8;
constexpr double SpeedOfCopy = 0.5; // of what is made of voxels before the first frame
constexpr double ErrorByFineSamples = 1.0;
constexpr double SpeedUpByTwoThreads = 1.85;
constexpr double SpeedUpBySixteenThreads = 12.0;
constexpr double FoldByNeighbor = 3.0;
constexpr double ManyByFewControlPoints = 4.0;

/// Shapes that fold or press the volume flat, and weaker ones.
const std::pair<const char*, const char*> Folds[] = { { "bend2", "bend1" }, { "twist2", "twist1" },
  { "taper2", "taper1.5" } };

const char* const Shapes[] = { "bend45", "random15", "twist1", "bend1", "taper1", "bulge1" };

//------------------------------------------------------------------------------
/// Control points, 8^3, over the bounds of the image: of bend45 and random15 as in the other
/// groups, of the others those of vtkFFDLatticeSource at the strength that they end with.
vtkSmartPointer<vtkFFDLattice> MakeShape(vtkImageData* image, const std::string& shape)
{
  auto lattice = vtkSmartPointer<vtkFFDLattice>::New();
  if (shape == "bend45" || shape == "random15")
  {
    double bounds[6];
    image->GetBounds(bounds);
    // They are meant for a volume of 256 voxels.
    const double scale = (bounds[1] - bounds[0]) / 255.0;
    Deform(lattice, image,
      shape == "bend45" ? Deformation{ Shape::Smooth, 45.0 * scale }
                        : Deformation{ Shape::Random, 15.0 * scale });
    return lattice;
  }
  vtkNew<vtkFFDLatticeSource> source;
  source->SetBounds(image->GetBounds());
  source->SetDimensions(8, 8, 8);
  const std::size_t number = shape.find_first_of("0123456789");
  const std::string form = shape.substr(0, number);
  source->SetShape(form == "twist" ? vtkFFDLatticeSource::TWIST
      : form == "bend"             ? vtkFFDLatticeSource::BEND
      : form == "taper"            ? vtkFFDLatticeSource::TAPER
                                   : vtkFFDLatticeSource::BULGE);
  source->SetStrength(std::stod(shape.substr(number)));
  source->Update();
  lattice->DeepCopy(source->GetLattice());
  return lattice;
}

//------------------------------------------------------------------------------
struct Scene
{
  Scene(vtkSmartPointer<vtkImageData> image, int size, Opacity opacity)
    : Image(image)
    , View(size, image)
    , Property(MakeProperty(opacity))
  {
  }

  vtkVolume* Add(vtkVolumeMapper* mapper) { return this->View.AddVolume(mapper, this->Property); }

  vtkSmartPointer<vtkImageData> Image;
  Stage View;
  vtkSmartPointer<vtkVolumeProperty> Property;
};

/// Refuses the row if nothing is to be seen. Whether pictures are right is for the other groups.
void CheckPicture(Scene& scene, vtkVolume* volume, Row& row)
{
  const auto picture = scene.View.DrawAndCapture(volume);
  if (!(Compare(picture, picture, scene.View.GetSize(), 1).Covered > 0.0))
  {
    row.Refusal = "the picture is empty";
  }
}

//------------------------------------------------------------------------------
/// 129^3 bytes that are visible up to the faces.
vtkSmartPointer<vtkImageData> MakeCube()
{
  vtkNew<vtkRTAnalyticSource> source;
  source->SetWholeExtent(-64, 64, -64, 64, -64, 64);
  vtkNew<vtkImageShiftScale> bytes;
  bytes->SetInputConnection(source->GetOutputPort());
  bytes->SetShift(-40.0);
  bytes->SetOutputScalarTypeToUnsignedChar();
  bytes->ClampOverflowOn();
  bytes->Update();
  return bytes->GetOutput();
}

//------------------------------------------------------------------------------
std::shared_ptr<void> PrepareFrames(
  Group& group, const std::string& folder, const std::string& volumeName, Opacity opacity, int size)
{
  auto scene = std::make_shared<Scene>(ReadVolume(folder, volumeName), size, opacity);
  Scene* s = scene.get();
  for (Row& row : group.GetRows())
  {
    vtkVolume* volume = nullptr;
    if (row.Name == "fixedpoint")
    {
      auto mapper = MakeFixedPointMapper();
      mapper->SetInputData(s->Image);
      volume = s->Add(mapper);
    }
    else if (row.Name == "undeformed")
    {
      volume = s->Add(MakeMapper(s->Image, nullptr, Variant::Exact));
    }
    else if (row.Name == "empty")
    {
      auto property = MakeProperty(opacity);
      property->GetScalarOpacity()->RemoveAllPoints();
      property->GetScalarOpacity()->AddPoint(0.0, 0.0);
      volume = s->View.AddVolume(
        MakeMapper(s->Image, MakeShape(s->Image, "bend45"), Variant::Exact), property);
    }
    else if (row.Name != "bare")
    {
      const std::size_t dash = row.Name.find('_');
      volume = s->Add(MakeMapper(s->Image, MakeShape(s->Image, row.Name.substr(dash + 1)),
        row.Name.substr(0, dash) == "exact" ? Variant::Exact : Variant::FirstOrder));
    }
    if (row.Name != "bare" && row.Name != "empty")
    {
      CheckPicture(*s, volume, row);
    }
    row.Run = [s, volume] { s->View.Draw(volume); };
    row.Run();
  }
  return scene;
}

//------------------------------------------------------------------------------
/// Opaque frames of shapes that fold, or press the volume flat, and of weaker ones.
std::shared_ptr<void> PrepareFolds(
  Group& group, const std::string& folder, const std::string& volumeName)
{
  auto scene = std::make_shared<Scene>(
    volumeName == "cube" ? MakeCube() : ReadVolume(folder, volumeName), 512, Opacity::Opaque);
  Scene* s = scene.get();
  for (Row& row : group.GetRows())
  {
    vtkVolume* volume = s->Add(MakeMapper(s->Image, MakeShape(s->Image, row.Name), Variant::Exact));
    CheckPicture(*s, volume, row);
    row.Run = [s, volume] { s->View.Draw(volume); };
    row.Run();
  }
  return scene;
}

//------------------------------------------------------------------------------
/// Opaque frames of bend45 with lattices of as many control points along each axis as rows say, and
/// as displacements on the points of a grid, which ends where the volume does.
std::shared_ptr<void> PrepareLattices(Group& group, const std::string& folder)
{
  auto scene = std::make_shared<Scene>(ReadVolume(folder, "engine"), 512, Opacity::Opaque);
  Scene* s = scene.get();
  for (Row& row : group.GetRows())
  {
    const bool isGrid = row.Name == "grid";
    vtkNew<vtkFFDLattice> lattice;
    Deform(lattice, s->Image, { Shape::Smooth, 45.0 }, isGrid ? 64 : std::stoi(row.Name));
    auto mapper = MakeMapper(s->Image, lattice, Variant::Exact);
    if (isGrid)
    {
      vtkNew<vtkTransformToGrid> sampler;
      sampler->SetInput(lattice);
      double bounds[6];
      s->Image->GetBounds(bounds);
      sampler->SetGridExtent(0, 63, 0, 63, 0, 63);
      sampler->SetGridOrigin(bounds[0], bounds[2], bounds[4]);
      sampler->SetGridSpacing(
        (bounds[1] - bounds[0]) / 63, (bounds[3] - bounds[2]) / 63, (bounds[5] - bounds[4]) / 63);
      sampler->Update();
      vtkNew<vtkGridTransform> grid;
      grid->SetDisplacementGridData(sampler->GetOutput());
      mapper->SetDeformation(grid);
    }
    vtkVolume* volume = s->Add(mapper);
    CheckPicture(*s, volume, row);
    row.Run = [s, volume] { s->View.Draw(volume); };
    row.Run();
  }
  return scene;
}

//------------------------------------------------------------------------------
/// Lets kernels use the instruction sets of `targets` alone; 0: all that the machine has.
void UseTargets(std::int64_t targets)
{
  hwy::SetSupportedTargetsForTest(targets);
  hwy::GetChosenTarget().DeInit();
}

std::shared_ptr<void> PrepareVectors(Group& group, const std::string& folder, Opacity opacity)
{
  auto scene = std::make_shared<Scene>(ReadVolume(folder, "engine"), 512, opacity);
  Scene* s = scene.get();
  vtkVolume* volume = s->Add(MakeMapper(s->Image, MakeShape(s->Image, "bend45"), Variant::Exact));
  for (Row& row : group.GetRows())
  {
    CheckPicture(*s, volume, row);
    const std::int64_t targets = row.Name == "avx2" ? HWY_AVX2 : 0;
    row.Run = [s, volume, targets] {
      UseTargets(targets);
      s->View.Draw(volume);
      UseTargets(0);
    };
    row.Run();
  }
  return scene;
}

bool HasAvx512() { return (hwy::SupportedTargets() & HWY_AVX3) != 0; }

//------------------------------------------------------------------------------
/// Table 1 of the paper by counts, as Examples/paper_experiments makes it: samples without
/// optimization by samples and look-ups with it; what is left of that at 45 voxels.
std::shared_ptr<void> PreparePaper(Group& group, const std::string& folder)
{
  constexpr int size = 128;
  auto image = ReadVolume(folder, "engine");
  Stage stage(size, image);
  // All deformed shapes are in view: rays that are cut off would change the averages.
  double center[3];
  image->GetCenter(center);
  double bounds[6];
  image->GetBounds(bounds);
  double direction[3] = { -0.75, -0.55, -1.0 };
  vtkMath::Normalize(direction);
  const double distance = 3.0 * (bounds[1] - bounds[0]);
  vtkCamera* camera = stage.GetRenderer()->GetActiveCamera();
  camera->SetFocalPoint(center);
  camera->SetPosition(center[0] - distance * direction[0], center[1] - distance * direction[1],
    center[2] - distance * direction[2]);
  camera->SetClippingRange(0.2 * distance, 2.0 * distance);
  const auto count = [&](double magnitude, vtkVolumeProperty* property, bool optimized) {
    vtkNew<vtkFFDLattice> lattice;
    Deform(lattice, image, { Shape::Smooth, magnitude });
    auto mapper = MakeMapper(image, lattice, optimized ? Variant::Exact : Variant::Unoptimized);
    mapper->SetSampleDistance(0.5);
    mapper->CollectStatisticsOn();
    vtkVolume* volume = stage.AddVolume(mapper, property);
    vtkNew<vtkImageData> picture;
    mapper->RenderToImage(stage.GetRenderer(), volume, size, size, picture);
    vtkFFDRayStatistics* counts = mapper->GetStatistics();
    return counts->GetSamplesPerRay() + (optimized ? counts->GetDistanceLookupsPerRay() : 0.0);
  };
  for (Row& row : group.GetRows())
  {
    vtkNew<vtkPiecewiseFunction> alpha;
    const double start = row.Name == "sparse" ? 170.0 : 70.0;
    alpha->AddPoint(start, 0.0);
    if (row.Name != "semi")
    {
      alpha->AddPoint(start + (row.Name == "sparse" ? 20.0 : 10.0), 1.0);
    }
    alpha->AddPoint(255.0, row.Name == "semi" ? 0.43 : 1.0);
    auto property = MakeProperty(Opacity::Opaque);
    property->SetScalarOpacity(alpha);
    property->ShadeOff();
    const double still = count(0.0, property, false) / count(0.0, property, true);
    const double bent = count(45.0, property, false) / count(45.0, property, true);
    row.Counters["speed_up"] = bent;
    row.Counters["kept_percent"] = 100.0 * bent / still;
    row.Run = [] {};
  }
  return nullptr;
}

//------------------------------------------------------------------------------
bool StartsWith(const std::string& name, const char* start) { return name.rfind(start, 0) == 0; }

double Milliseconds(const Group& group, const std::string& name)
{
  const Row* row = group.FindRow(name);
  return row ? 1e3 * row->GetMedian() : NoNumber;
}

/// Of two rows, beyond an empty frame.
double RatioBeyondEmpty(const Group& group, const std::string& row, const std::string& by)
{
  const double empty = Milliseconds(group, "empty");
  return (Milliseconds(group, row) - empty) / (Milliseconds(group, by) - empty);
}

bool IsFrames(const Group& group)
{
  return StartsWith(group.GetName(), "Targets/") && group.FindRow("bare");
}

/// What users switch on.
constexpr const char* OptionsPrefix = "Options/";
constexpr const char* SizesPrefix = "Sizes/";
constexpr const char* ErrorsPrefix = "Errors/";
constexpr const char* CoresPrefix = "Cores/";
constexpr const char* FoldsPrefix = "Folds/";
constexpr const char* Lattices = "Lattices/engine";

double FindError(const Group& group, const char* name)
{
  const Row* const row = group.FindRow(name);
  return row && row->Counters.count("mean_error") != 0 ? row->Counters.at("mean_error") : NoNumber;
}

std::string NameOptionTarget(const Group& group, const FrameOption& option)
{
  return group.GetName() + " " + option.Name + " / " + option.By;
}

//------------------------------------------------------------------------------
/// Options by groups: how many times the frame without it.
void PrintOptions(const std::vector<std::unique_ptr<Group>>& groups)
{
  std::vector<const Group*> columns;
  for (const auto& group : groups)
  {
    if (group->IsMeasured() && StartsWith(group->GetName(), OptionsPrefix))
    {
      columns.push_back(group.get());
    }
  }
  if (columns.empty())
  {
    return;
  }
  std::printf("\nOptions, opaque, 512 x 512: times the frame of the row named last. ! is missed.\n"
              "\n%-34s",
    "");
  for (const Group* group : columns)
  {
    std::printf(" %18s", group->GetName().c_str() + std::strlen(OptionsPrefix));
  }
  std::printf("  at most\n");
  for (const FrameOption& option : GetFrameOptions())
  {
    std::printf("%-34s", option.Name);
    for (const Group* group : columns)
    {
      const double ratio = group->GetRatio(option.Name, option.By);
      std::printf(" %17.2f%c", ratio, ratio > option.Limit ? '!' : ' ');
    }
    if (std::isnan(option.Limit))
    {
      std::printf("        - %s\n", option.By);
    }
    else
    {
      std::printf(" %8.2f %s\n", option.Limit, option.By);
    }
  }
  for (const Group* group : columns)
  {
    std::printf("%s: plain %.2f ms\n", group->GetName().c_str(), Milliseconds(*group, "plain"));
  }
}

} // namespace

//------------------------------------------------------------------------------
bool Target::HasLimit() const { return !std::isnan(this->Limit); }

//------------------------------------------------------------------------------
bool Target::IsMet() const
{
  return this->AtMost ? this->Figure <= this->Limit : this->Figure >= this->Limit;
}

//------------------------------------------------------------------------------
std::vector<std::unique_ptr<Group>> MakeTargetGroups(const Options& options)
{
  const std::string folder = options.DataFolder;
  const std::size_t rounds =
    options.Rounds > 0 ? static_cast<std::size_t>(options.Rounds) : (options.Quick ? 1 : 11);
  std::vector<std::unique_ptr<Group>> groups;
  const auto add = [&](const std::string& name, Group::Preparation prepare,
                     const std::vector<std::string>& rows) {
    auto group = std::make_unique<Group>(name, std::move(prepare));
    for (const std::string& row : rows)
    {
      group->AddRow(row, rounds);
    }
    if (!group->GetRows().empty())
    {
      groups.push_back(std::move(group));
    }
  };
  std::vector<std::string> frames = { "bare", "empty", "fixedpoint", "undeformed" };
  for (const char* shape : Shapes)
  {
    frames.push_back(std::string("exact_") + shape);
    frames.push_back(std::string("firstorder_") + shape);
  }
  const auto opacities = options.Quick
    ? std::vector<Opacity>{ Opacity::Opaque }
    : std::vector<Opacity>{ Opacity::Semi, Opacity::Opaque, Opacity::Sparse };
  for (const char* volume : { "engine", "cthead", "hydrogen" })
  {
    for (const int size : { 512, 1024 })
    {
      for (const Opacity opacity : opacities)
      {
        if (!options.Quick || (std::string(volume) == "engine" && size == 512))
        {
          const std::string volumeName = volume;
          add(
            "Targets/" + volumeName + "/" + GetName(opacity) + "/" + std::to_string(size),
            [=](Group& group) { return PrepareFrames(group, folder, volumeName, opacity, size); },
            frames);
        }
      }
    }
  }
  if (HasAvx512())
  {
    for (const Opacity opacity : opacities)
    {
      add(std::string("Targets/vectors/") + GetName(opacity),
        [=](Group& group) { return PrepareVectors(group, folder, opacity); }, { "avx512", "avx2" });
    }
  }
  for (const std::string volume : { "engine", "cthead", "cube" })
  {
    if (!options.Quick || volume == "engine")
    {
      std::vector<std::string> rows;
      for (const auto& [fold, neighbor] : Folds)
      {
        rows.insert(rows.end(), { neighbor, fold });
      }
      add(
        FoldsPrefix + volume, [=](Group& group) { return PrepareFolds(group, folder, volume); },
        rows);
    }
  }
  add(
    Lattices, [=](Group& group) { return PrepareLattices(group, folder); },
    options.Quick ? std::vector<std::string>{ "8", "32", "grid" }
                  : std::vector<std::string>{ "8", "16", "32", "64", "128", "grid" });
  std::vector<std::string> frameOptions;
  for (const FrameOption& option : GetFrameOptions())
  {
    frameOptions.push_back(option.Name);
  }
  for (const char* volume : { "engine", "cthead" })
  {
    for (const bool deformed : { false, true })
    {
      if (!options.Quick || (std::string(volume) == "engine" && deformed))
      {
        const std::string volumeName = volume;
        add(
          std::string(OptionsPrefix) + volume + (deformed ? "/bend45" : "/undeformed"),
          [=](Group& group) { return PrepareOptions(group, folder, volumeName, deformed); },
          frameOptions);
      }
    }
  }
  for (const SizedVolume& volume : GetSizedVolumes())
  {
    if (!options.Quick || volume.Side == 128)
    {
      add(std::string(SizesPrefix) + volume.Name,
        [&volume](Group& group) { return PrepareSizes(group, volume); },
        { "copy", "first", "second", "undeformed", "bend45" });
    }
  }
  for (const char* volume : { "engine", "cthead" })
  {
    if (!options.Quick || std::string(volume) == "engine")
    {
      const std::string volumeName = volume;
      add(ErrorsPrefix + volumeName,
        [=](Group& group) { return PrepareErrors(group, folder, volumeName); },
        { "samples 1", "samples 0.25", "intervals 1" });
    }
  }
  for (const int size : { 512, 1024 })
  {
    for (const Opacity opacity : opacities)
    {
      const std::pair<const char*, Deformation> scenes[] = { { "undeformed", {} },
        { "bend45", { Shape::Smooth, 45.0 } }, { "edited", { Shape::Smooth, 45.0 } } };
      for (const auto& scene : scenes)
      {
        if (options.Quick && (size != 512 || scene.first != std::string("edited")))
        {
          continue;
        }
        const Deformation deformation = scene.second;
        const bool edited = scene.first == std::string("edited");
        add(
          std::string(CoresPrefix) + GetName(opacity) + "/" + std::to_string(size) + "/" +
            scene.first,
          [=](Group& group) {
            return PrepareCores(group, folder, opacity, size, deformation, edited);
          },
          GetThreadCounts());
      }
    }
  }
  add("Targets/paper", [=](Group& group) { return PreparePaper(group, folder); },
    { "semi", "opaque", "sparse" });
  for (auto& group : MakeGroups(options))
  {
    const std::string& name = group->GetName();
    if (name == (options.Quick ? "Drag/128" : "Drag/256") || name == "WidgetDrag/opaque")
    {
      groups.push_back(std::move(group));
    }
  }
  return groups;
}

//------------------------------------------------------------------------------
std::vector<Target> FindTargets(const std::vector<std::unique_ptr<Group>>& groups)
{
  std::vector<Target> targets;
  for (const auto& each : groups)
  {
    const Group& group = *each;
    const std::string& name = group.GetName();
    if (!group.IsMeasured())
    {
      continue;
    }
    if (IsFrames(group))
    {
      const std::string scene = name.substr(8);
      const bool large = name.find("/1024") != std::string::npos;
      targets.push_back({ scene + " empty frame beyond VTK's, ms",
        Milliseconds(group, "empty") - Milliseconds(group, "bare"),
        large ? NoNumber : EmptyFrameMilliseconds });
      targets.push_back({ scene + " undeformed, ms", Milliseconds(group, "undeformed"), NoNumber });
      for (const std::string shape : Shapes)
      {
        targets.push_back(
          { scene + " " + shape + " EXACT, ms", Milliseconds(group, "exact_" + shape), NoNumber });
        targets.push_back({ scene + " " + shape + " EXACT / FIRST_ORDER, beyond an empty frame",
          RatioBeyondEmpty(group, "exact_" + shape, "firstorder_" + shape), ExactByFirstOrder });
      }
      targets.push_back({ scene + " bend45 EXACT / fixedpoint undeformed",
        group.GetRatio("exact_bend45", "fixedpoint"), BendByFixedPoint });
    }
    else if (StartsWith(name, OptionsPrefix))
    {
      for (const FrameOption& option : GetFrameOptions())
      {
        if (!std::isnan(option.Limit))
        {
          targets.push_back({ NameOptionTarget(group, option),
            group.GetRatio(option.Name, option.By), option.Limit });
        }
      }
    }
    else if (StartsWith(name, SizesPrefix))
    {
      const double made = Milliseconds(group, "first") - Milliseconds(group, "second");
      // Small volumes are in the caches.
      const bool large = !StartsWith(name, "Sizes/128");
      targets.push_back({ name + " copy by what the first frame makes of the voxels",
        Milliseconds(group, "copy") / made, large ? SpeedOfCopy : NoNumber, false });
      for (const char* row : { "undeformed", "bend45" })
      {
        targets.push_back(
          { name + " frame of 512 x 512, " + row + ", in ms", Milliseconds(group, row), NoNumber });
      }
    }
    else if (StartsWith(name, ErrorsPrefix))
    {
      for (const Row& row : group.GetRows())
      {
        targets.push_back({ name + " mean error, " + row.Name + ", of 255",
          FindError(group, row.Name.c_str()), NoNumber });
      }
      targets.push_back({ name + " error of intervals 1 / samples 0.25",
        FindError(group, "intervals 1") / FindError(group, "samples 0.25"), ErrorByFineSamples });
      targets.push_back({ name + " time of intervals 1 / samples 1",
        group.GetRatio("intervals 1", "samples 1"), NoNumber });
    }
    else if (StartsWith(name, CoresPrefix))
    {
      for (const Row& row : group.GetRows())
      {
        if (row.Name != "1")
        {
          targets.push_back({ name + " " + row.Name + " threads: times as fast as one",
            group.GetRatio("1", row.Name),
            row.Name == "2"      ? SpeedUpByTwoThreads
              : row.Name == "16" ? SpeedUpBySixteenThreads
                                 : NoNumber,
            false });
        }
      }
    }
    else if (StartsWith(name, FoldsPrefix))
    {
      for (const auto& [fold, neighbor] : Folds)
      {
        targets.push_back(
          { name + " " + fold + " / " + neighbor, group.GetRatio(fold, neighbor), FoldByNeighbor });
      }
    }
    else if (name == Lattices)
    {
      for (const Row& row : group.GetRows())
      {
        if (row.Name != "8")
        {
          targets.push_back({ name + " EXACT, " +
              (row.Name == "grid" ? "a grid of 64^3" : row.Name + "^3 control points") + " / 8^3",
            group.GetRatio(row.Name, "8"), ManyByFewControlPoints });
        }
      }
    }
    else if (StartsWith(name, "Targets/vectors/"))
    {
      targets.push_back({ "engine/" + name.substr(16) + "/512 bend45 EXACT, AVX2 / AVX-512",
        group.GetRatio("avx2", "avx512"), Avx2ByAvx512 });
    }
    else if (name == "Targets/paper")
    {
      for (const Row& row : group.GetRows())
      {
        const auto kept = row.Counters.find("kept_percent");
        targets.push_back({ "paper's table, " + row.Name + ": kept at 45 voxels, %",
          kept == row.Counters.end() ? NoNumber : kept->second, KeptPercent, false });
      }
    }
    else if (StartsWith(name, "Drag/"))
    {
      // Not std::min() alone: either of them may have been left out.
      const double grid = group.GetRatio("grid", "exact");
      const double spline = group.GetRatio("bspline", "exact");
      targets.push_back({ name + " edit to picture, fastest resampling / EXACT",
        std::isnan(grid)       ? spline
          : std::isnan(spline) ? grid
                               : std::min(grid, spline),
        name == "Drag/256" ? ResamplingByEdit : NoNumber, false });
    }
    else if (name == "WidgetDrag/opaque")
    {
      targets.push_back({ name + " without frame coherence / undeformed, same lattice",
        group.GetRatio("whole", "undeformed_drag"), DragByUndeformed });
      targets.push_back({ name + " with frame coherence / undeformed, same lattice",
        group.GetRatio("full", "undeformed_drag"), NoNumber });
      targets.push_back({ name + " without frame coherence / undeformed, no lattice",
        group.GetRatio("whole", "undeformed"), NoNumber });
    }
  }
  return targets;
}

//------------------------------------------------------------------------------
void PrintTargetPage(
  const std::vector<std::unique_ptr<Group>>& groups, const std::vector<Target>& targets)
{
  std::printf(
    "\nTargets: medians of rows timed in turns. Frames in ms; in brackets EXACT by FIRST_ORDER "
    "beyond an empty frame\n(at most %.2f); \"empty\" is ours with nothing to see beyond "
    "VTK's own frame. ! is missed.\n\n%-22s %6s %6s %6s",
    ExactByFirstOrder, "", "empty", "fixed", "undef.");
  for (const char* shape : Shapes)
  {
    std::printf(" %14s", shape);
  }
  std::printf("\n");
  for (const auto& group : groups)
  {
    if (!group->IsMeasured() || !IsFrames(*group))
    {
      continue;
    }
    std::printf("%-22s %6.2f %6.1f %6.1f", group->GetName().substr(8).c_str(),
      Milliseconds(*group, "empty") - Milliseconds(*group, "bare"),
      Milliseconds(*group, "fixedpoint"), Milliseconds(*group, "undeformed"));
    for (const std::string shape : Shapes)
    {
      const double ratio = RatioBeyondEmpty(*group, "exact_" + shape, "firstorder_" + shape);
      std::printf(" %6.1f (%4.2f)%c", Milliseconds(*group, "exact_" + shape), ratio,
        ratio <= ExactByFirstOrder ? ' ' : '!');
    }
    std::printf("\n");
  }
  PrintOptions(groups);
  std::printf("\n");
  int met = 0;
  int missed = 0;
  int missing = 0;
  for (const Target& target : targets)
  {
    if (target.HasLimit())
    {
      ++(std::isnan(target.Figure) ? missing : target.IsMet() ? met : missed);
    }
    // Those are in the tables.
    if (target.Name.find("EXACT / FIRST_ORDER") != std::string::npos ||
      StartsWith(target.Name, OptionsPrefix) ||
      (!target.HasLimit() && target.Name.find(", ms") != std::string::npos))
    {
      continue;
    }
    if (!target.HasLimit())
    {
      std::printf("  %-62s %8.3f\n", target.Name.c_str(), target.Figure);
      continue;
    }
    std::printf("  %-62s %8.3f  %s %-6g %s\n", target.Name.c_str(), target.Figure,
      target.AtMost ? "<=" : ">=", target.Limit,
      std::isnan(target.Figure) ? "not measured"
        : target.IsMet()        ? "met"
                                : "MISSED");
  }
  if (!HasAvx512())
  {
    std::printf("  AVX2 by AVX-512: not measured, the machine has no AVX-512\n");
  }
  std::printf("\n%d targets met, %d missed, %d not measured\n", met, missed, missing);
  for (const auto& group : groups)
  {
    for (const Row& row : group->GetRows())
    {
      if (!row.Refusal.empty())
      {
        std::printf(
          "%s/%s refused: %s\n", group->GetName().c_str(), row.Name.c_str(), row.Refusal.c_str());
      }
    }
  }
}

//------------------------------------------------------------------------------
bool WriteTargets(const std::string& path, const std::vector<Target>& targets)
{
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (!file)
  {
    return false;
  }
  bool good = std::fputs("[", file) >= 0;
  const char* separator = "\n";
  for (const Target& target : targets)
  {
    // The names hold nothing that JSON would have to escape.
    good = std::fprintf(
             file, "%s  { \"name\": \"%s\", \"figure\": ", separator, target.Name.c_str()) > 0 &&
      good;
    good = (std::isfinite(target.Figure) ? std::fprintf(file, "%.6g", target.Figure)
                                         : std::fprintf(file, "null")) > 0 &&
      good;
    if (target.HasLimit())
    {
      good = std::fprintf(file, ", \"target\": %g, \"at_most\": %s, \"met\": %s", target.Limit,
               target.AtMost ? "true" : "false", target.IsMet() ? "true" : "false") > 0 &&
        good;
    }
    good = std::fputs(" }", file) >= 0 && good;
    separator = ",\n";
  }
  good = std::fputs("\n]\n", file) >= 0 && good;
  return std::fclose(file) == 0 && good;
}

} // namespace ffdBenchmark
