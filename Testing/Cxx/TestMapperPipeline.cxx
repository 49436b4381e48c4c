// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The mapper in a pipeline: what is made again after which change, inputs that change in place,
// arrays that come and go, windows that come and go, aborted frames, copies, memory.
#include "FFDTestVolume.h"

#include "vtkCallbackCommand.h"
#include "vtkFFDDeformVolume.h"
#include "vtkFFDEditLattice.h"
#include "vtkFFDLatticeSource.h"
#include "vtkFixedPointVolumeRayCastMapper.h"
#include "vtkPlane.h"
#include "vtkPlaneCollection.h"
#include "vtkTransform.h"
#include "vtkTrivialProducer.h"

#include "vtksys/SystemInformation.hxx"

#include <algorithm>
#include <array>
#include <functional>

namespace
{

using Mapper = vtkFFDInverseRayVolumeMapper;
using Counts = std::array<vtkTypeInt64, Mapper::NUMBER_OF_CACHED_PARTS>;

Counts CountBuilds(Mapper* mapper)
{
  Counts counts;
  for (int part = 0; part < Mapper::NUMBER_OF_CACHED_PARTS; ++part)
  {
    counts[static_cast<std::size_t>(part)] = mapper->GetNumberOfBuilds(part);
  }
  return counts;
}

/// Render once, change something, render twice: the parts of `expected` are made once more, the
/// others not, and the second frame makes nothing.
bool MakesAnew(FFDTestScene& scene, const char* what, const Counts& expected,
  const std::function<void()>& change)
{
  scene.Show();
  const Counts before = CountBuilds(scene.Mapper);
  change();
  scene.Show();
  const Counts after = CountBuilds(scene.Mapper);
  scene.Show();
  const Counts again = CountBuilds(scene.Mapper);
  bool ok = true;
  for (std::size_t part = 0; part < expected.size(); ++part)
  {
    if (after[part] - before[part] != expected[part] || again[part] != after[part])
    {
      std::cerr << what << ": part " << part << " was made " << after[part] - before[part]
                << " times instead of " << expected[part] << ", then " << again[part] - after[part]
                << " times\n";
      ok = false;
    }
  }
  return ok;
}

// Blocks, field, bounds, table, distances.
const Counts Nothing = { 0, 0, 0, 0, 0 };
const Counts Voxels = { 1, 0, 0, 1, 1 };
const Counts Deformation = { 0, 1, 1, 0, 0 };
const Counts Bounds = { 0, 0, 1, 0, 0 };
const Counts Table = { 0, 0, 0, 1, 0 };
const Counts Visibility = { 0, 0, 0, 1, 1 };

/// Mappers find the bounds of one deformation of one volume once, whatever objects hold them.
int TestSharedBounds()
{
  FFDTestScene scene;
  scene.Show();
  const auto count = [](Mapper* mapper) {
    return mapper->GetNumberOfBuilds(Mapper::DEFORMATION_BOUNDS);
  };
  const vtkTypeInt64 before = count(scene.Mapper);
  vtkNew<vtkImageData> image;
  image->ShallowCopy(scene.Image);
  vtkNew<vtkFFDLattice> lattice;
  lattice->DeepCopy(scene.Lattice);
  vtkNew<Mapper> other;
  other->SetInputData(image);
  other->SetDeformation(lattice);
  const auto haveSame = [&] {
    std::array<double, 6> bounds[2];
    scene.Mapper->GetBounds(bounds[0].data());
    other->GetBounds(bounds[1].data());
    return bounds[0] == bounds[1];
  };
  FFD_CHECK(haveSame() && count(other) == 0);
  lattice->SetDisplacement(1, 1, 2, 9, 1, 1);
  FFD_CHECK(!haveSame() && count(other) == 1);
  // An edit of both: the first that is asked finds them.
  scene.Lattice->SetDisplacement(1, 1, 2, 9, 1, 1);
  FFD_CHECK(haveSame() && count(other) == 1 && count(scene.Mapper) == before);
  other->SetInverseModeToFirstOrder();
  FFD_CHECK(!haveSame() && count(other) == 2);
  other->SetInverseModeToExact();
  other->SetInverseTolerance(0.02);
  FFD_CHECK(!haveSame() && count(other) == 3);
  other->SetInverseTolerance(scene.Mapper->GetInverseTolerance());
  FFD_CHECK(haveSame() && count(other) == 3);
  image->SetSpacing(1.5, 1.0, 1.0);
  FFD_CHECK(!haveSame() && count(other) == 4);
  return EXIT_SUCCESS;
}

int TestBuilds()
{
  FFDTestScene scene;
  Mapper* m = scene.Mapper;
  FFD_CHECK(m->GetNumberOfBuilds(-1) == -1);
  FFD_CHECK(m->GetNumberOfBuilds(Mapper::NUMBER_OF_CACHED_PARTS) == -1);
  FFD_CHECK((CountBuilds(m) == Counts{ 0, 0, 0, 0, 0 }));
  scene.Show();
  FFD_CHECK((CountBuilds(m) == Counts{ 1, 1, 1, 1, 1 }));

  FFD_CHECK(MakesAnew(scene, "nothing", Nothing, [] {}));
  FFD_CHECK(
    MakesAnew(scene, "camera", Nothing, [&] { scene.Renderer->GetActiveCamera()->Azimuth(10.0); }));
  FFD_CHECK(MakesAnew(scene, "volume matrix", Nothing, [&] { scene.Volume->RotateY(10.0); }));
  FFD_CHECK(MakesAnew(scene, "window size", Nothing, [&] {
    scene.Window->SetSize(100, 90);
    scene.Window->Render();
    scene.Window->SetSize(80, 80);
  }));
  FFD_CHECK(MakesAnew(scene, "options of the mapper", Nothing, [&] {
    m->SetSampleDistance(0.7);
    m->SetImageSampleDistance(1.5);
    m->SetEarlyRayTerminationThreshold(0.1);
    m->SetNumberOfThreads(1);
    m->SetOpacityLengthToMaterial();
    m->SetMinimumSegmentLength(0.7);
    m->SetMaximumSegmentLength(6.0);
    m->SetPositionTolerance(0.2);
    m->SetSegmentationToGreedyAngle();
    m->CollectStatisticsOn();
    m->IntermixIntersectingGeometryOff();
    m->SetClipBox(0.0, 20.0, 0.0, 20.0, 0.0, 20.0);
    m->Modified();
  }));
  FFD_CHECK(MakesAnew(scene, "options of the mapper", Nothing, [&] {
    m->RemoveClipBox();
    m->SetSegmentationToErrorBound();
    m->LockSampleDistanceToInputSpacingOn();
    m->ReferenceKernelsOn();
  }));
  m->ReferenceKernelsOff();
  FFD_CHECK(MakesAnew(scene, "shading", Table, [&] {
    scene.Property->ShadeOn();
    scene.Property->SetAmbient(0.3);
    scene.Property->SetSpecularPower(20.0);
  }));
  FFD_CHECK(MakesAnew(scene, "lights", Nothing, [&] { scene.Renderer->TwoSidedLightingOff(); }));

  FFD_CHECK(MakesAnew(scene, "inverse mode", Bounds, [&] { m->SetInverseModeToFirstOrder(); }));
  FFD_CHECK(MakesAnew(scene, "inverse tolerance", Bounds, [&] { m->SetInverseTolerance(0.02); }));
  m->SetInverseModeToExact();
  FFD_CHECK(MakesAnew(scene, "control point", Deformation,
    [&] { scene.Lattice->SetDisplacement(1, 1, 2, 1, 1, 1); }));
  vtkNew<vtkFFDLattice> other;
  other->DeepCopy(scene.Lattice);
  FFD_CHECK(MakesAnew(scene, "equal deformation", Nothing, [&] { m->SetDeformation(other); }));
  FFD_CHECK(MakesAnew(scene, "no deformation", Deformation, [&] { m->SetDeformation(nullptr); }));
  m->SetDeformation(scene.Lattice);

  FFD_CHECK(
    MakesAnew(scene, "colors", Table, [&] { scene.Color->AddRGBPoint(100.0, 0.0, 1.0, 0.0); }));
  FFD_CHECK(MakesAnew(
    scene, "unit distance", Table, [&] { scene.Property->SetScalarOpacityUnitDistance(1.7); }));
  FFD_CHECK(MakesAnew(
    scene, "more of what is visible", Table, [&] { scene.Opacity->AddPoint(200.0, 0.5); }));
  FFD_CHECK(
    MakesAnew(scene, "what is visible", Visibility, [&] { scene.Opacity->AddPoint(60.0, 0.0); }));
  vtkNew<vtkPiecewiseFunction> function;
  function->AddPoint(100.0, 0.0);
  function->AddPoint(200.0, 0.5);
  scene.Property->SetScalarOpacity(function);
  scene.Show();
  // An older function in the place of a newer one.
  FFD_CHECK(MakesAnew(scene, "another function", Visibility,
    [&] { scene.Property->SetScalarOpacity(scene.Opacity); }));
  vtkNew<vtkVolumeProperty> same;
  same->DeepCopy(scene.Property);
  FFD_CHECK(MakesAnew(scene, "another property", Table, [&] { scene.Volume->SetProperty(same); }));
  scene.Volume->SetProperty(scene.Property);

  FFD_CHECK(MakesAnew(scene, "leaping off", Nothing, [&] { m->SetSpaceLeapingToOff(); }));
  FFD_CHECK(MakesAnew(scene, "leaping on", Nothing, [&] { m->SetSpaceLeapingToLipschitz(); }));

  vtkDataArray* scalars = scene.Image->GetPointData()->GetScalars();
  FFD_CHECK(MakesAnew(scene, "scalars", Voxels, [&] {
    scalars->SetTuple1(4000, 180.0);
    scalars->Modified();
  }));
  // Usual where voxels are written through a pointer, or a numpy array.
  FFD_CHECK(MakesAnew(scene, "image", Voxels, [&] { scene.Image->Modified(); }));
  FFD_CHECK(MakesAnew(scene, "field data", Nothing, [&] {
    vtkNew<vtkFloatArray> array;
    array->SetName("note");
    scene.Image->GetFieldData()->AddArray(array);
  }));

  // Lattices that travel with the image.
  m->SetDeformation(nullptr);
  FFD_CHECK(MakesAnew(
    scene, "attached lattice", Deformation, [&] { scene.Lattice->AttachTo(scene.Image); }));
  FFD_CHECK(MakesAnew(scene, "attached lattice, moved", Deformation, [&] {
    scene.Lattice->SetDisplacement(2, 3, 1, 2.0, -2.0, 0.0);
    scene.Lattice->AttachTo(scene.Image);
  }));
  FFD_CHECK(MakesAnew(scene, "attached lattice, the same again", Nothing,
    [&] { scene.Lattice->AttachTo(scene.Image); }));
  vtkFFDLattice::DetachFrom(scene.Image);

  vtkNew<vtkTrivialProducer> producer;
  producer->SetOutput(scene.Image);
  vtkNew<vtkFFDDeformVolume> deform;
  deform->SetInputConnection(producer->GetOutputPort());
  deform->SetLattice(scene.Lattice);
  vtkNew<vtkFFDEditLattice> chained;
  chained->SetInputConnection(deform->GetOutputPort());
  chained->SetShape(vtkFFDLatticeSource::TWIST);
  m->SetInputConnection(chained->GetOutputPort());
  scene.Show();
  // Each edit runs both filters; the voxels stay the same.
  FFD_CHECK(MakesAnew(scene, "filter, control point", Deformation,
    [&] { scene.Lattice->SetDisplacement(2, 3, 1, 1.0, -2.0, 0.0); }));
  FFD_CHECK(MakesAnew(scene, "filter, strength", Deformation, [&] { chained->SetStrength(0.3); }));
  FFD_CHECK(MakesAnew(scene, "filter, no change", Nothing, [&] { deform->Modified(); }));
  FFD_CHECK(MakesAnew(scene, "filter, voxels", Voxels, [&] {
    scalars->SetTuple1(4000, 150.0);
    scene.Image->Modified();
  }));
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

/// Pictures follow changes of the voxels, of the geometry and of the arrays.
int TestInputChanges()
{
  FFDTestScene scene;
  vtkDataArray* scalars = scene.Image->GetPointData()->GetScalars();
  const std::vector<unsigned char> first = scene.Show();
  vtkNew<vtkImageData> copy;
  copy->DeepCopy(scene.Image);

  // In place through a pointer; scalars far above the former range, so stale blocks would show.
  auto* voxels = static_cast<float*>(scalars->GetVoidPointer(0));
  for (int k = 2; k < 8; ++k)
  {
    for (int j = 2; j < 8; ++j)
    {
      std::fill_n(voxels + 2 + 24 * (j + 24 * k), 6, 400.0f);
    }
  }
  scene.Image->Modified();
  const std::vector<unsigned char> changed = scene.Show();
  FFD_CHECK(FFDLargestDifference(first, changed) > 20);
  vtkNew<vtkImageData> fresh;
  fresh->DeepCopy(scene.Image);
  scene.Mapper->SetInputData(fresh);
  FFD_CHECK(FFDLargestDifference(changed, scene.Show()) == 0);
  // Older data in the place of newer.
  scene.Mapper->SetInputData(copy);
  FFD_CHECK(FFDLargestDifference(first, scene.Show()) == 0);
  // Spacing, of the same voxels.
  copy->SetSpacing(1.2, 1.0, 0.9);
  const std::vector<unsigned char> stretched = scene.Show();
  FFD_CHECK(FFDLargestDifference(first, stretched) > 20);
  copy->SetSpacing(1.0, 1.0, 1.0);
  FFD_CHECK(FFDLargestDifference(first, scene.Show()) == 0);

  // Two arrays by name and by number; one is taken away, and comes back.
  vtkNew<vtkFloatArray> second;
  second->SetName("second");
  second->SetNumberOfTuples(copy->GetNumberOfPoints());
  for (vtkIdType i = 0; i < second->GetNumberOfTuples(); ++i)
  {
    second->SetValue(i,
      static_cast<float>(
        copy->GetPointData()->GetScalars()->GetTuple1(copy->GetNumberOfPoints() - 1 - i)));
  }
  copy->GetPointData()->AddArray(second);
  FFD_CHECK(FFDLargestDifference(first, scene.Show()) == 0);
  scene.Mapper->SetScalarModeToUsePointFieldData();
  scene.Mapper->SelectScalarArray("second");
  const std::vector<unsigned char> reversed = scene.Show();
  FFD_CHECK(FFDLargestDifference(first, reversed) > 20);
  scene.Mapper->SelectScalarArray(0);
  FFD_CHECK(FFDLargestDifference(first, scene.Show()) == 0);
  scene.Mapper->SelectScalarArray(1);
  FFD_CHECK(FFDLargestDifference(reversed, scene.Show()) == 0);
  scene.Mapper->SelectScalarArray("second");
  FFD_CHECK(scene.Errors->Count == 0);
  copy->GetPointData()->RemoveArray("second");
  scene.Show();
  FFD_CHECK(scene.Errors->Count > 0);
  scene.Errors->Count = 0;
  scene.Errors->Message.clear();
  copy->GetPointData()->AddArray(second);
  FFD_CHECK(FFDLargestDifference(reversed, scene.Show()) == 0);
  scene.Mapper->SetScalarModeToDefault();
  FFD_CHECK(FFDLargestDifference(first, scene.Show()) == 0);

  // Another size and type in the same image object.
  copy->ShallowCopy(FFDMakeBall(17, VTK_SHORT));
  copy->SetSpacing(1.4, 1.4, 1.4);
  const std::vector<unsigned char> smaller = scene.Show();
  FFD_CHECK(FFDLargestDifference(first, smaller) > 10 && scene.Errors->Count == 0);
  vtkNew<vtkImageData> alone;
  alone->DeepCopy(copy);
  scene.Mapper->SetInputData(alone);
  FFD_CHECK(FFDLargestDifference(smaller, scene.Show()) == 0);
  return EXIT_SUCCESS;
}

/// GetMTime() says when a picture may have become another one, and only then.
int TestTimes()
{
  FFDTestScene scene;
  scene.Show();
  vtkMTimeType last = scene.Mapper->GetMTime();
  scene.Show();
  scene.Render();
  scene.Mapper->GetBounds();
  scene.Mapper->GetAuxiliaryMemorySize();
  FFD_CHECK(scene.Mapper->GetMTime() == last);
  scene.Mapper->SetSampleDistance(2.0);
  FFD_CHECK(scene.Mapper->GetMTime() > last);
  last = scene.Mapper->GetMTime();
  scene.Mapper->SetSampleDistance(2.0);
  scene.Mapper->SetInverseMode(scene.Mapper->GetInverseMode());
  scene.Mapper->SetDeformation(scene.Lattice);
  double box[6];
  scene.Mapper->GetClipBox(box);
  scene.Mapper->RemoveClipBox();
  scene.Mapper->SetWholeBounds(scene.Mapper->GetWholeBounds());
  FFD_CHECK(scene.Mapper->GetMTime() == last);
  scene.Lattice->SetDisplacement(1, 1, 1, 1.0, 0.0, 0.0);
  FFD_CHECK(scene.Mapper->GetMTime() > last);
  last = scene.Mapper->GetMTime();
  // A plane that moves is noticed, too.
  vtkNew<vtkPlane> plane;
  scene.Mapper->AddClippingPlane(plane);
  FFD_CHECK(scene.Mapper->GetMTime() > last);
  last = scene.Mapper->GetMTime();
  plane->SetOrigin(1.0, 2.0, 3.0);
  FFD_CHECK(scene.Mapper->GetMTime() > last);
  // The volume draws itself anew: vtkVolume asks the mapper.
  last = scene.Volume->GetRedrawMTime();
  scene.Lattice->SetDisplacement(1, 1, 1, 0.0, 0.0, 0.0);
  FFD_CHECK(scene.Volume->GetRedrawMTime() > last);
  last = scene.Volume->GetRedrawMTime();
  scene.Image->Modified();
  FFD_CHECK(scene.Volume->GetRedrawMTime() > last);
  return EXIT_SUCCESS;
}

void AbortAtOnce(vtkObject* caller, unsigned long, void*, void*)
{
  vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1);
}

/// An aborted frame shows the last picture of the view, or nothing of the volume where there is
/// none, and costs no next one.
int TestAbort()
{
  FFDTestScene scene;
  scene.Mapper->SetDeformation(nullptr);
  const std::vector<unsigned char> whole = scene.Show();
  scene.Volume->VisibilityOff();
  const std::vector<unsigned char> empty = scene.Show();
  scene.Volume->VisibilityOn();
  FFD_CHECK(FFDLargestDifference(whole, empty) > 20 && FFDCountGreen(empty) > 50);
  const double time = scene.Mapper->GetTimeToDraw();
  vtkNew<vtkCallbackCommand> command;
  command->SetCallback(AbortAtOnce);
  const unsigned long tag =
    scene.Mapper->AddObserver(vtkCommand::VolumeMapperRenderProgressEvent, command);
  FFD_CHECK(FFDLargestDifference(scene.Show(), whole) == 0);
  scene.Renderer->GetActiveCamera()->Azimuth(10.0);
  const std::vector<unsigned char> aborted = scene.Show();
  scene.Volume->VisibilityOff();
  FFD_CHECK(FFDLargestDifference(scene.Show(), aborted) == 0);
  scene.Volume->VisibilityOn();
  scene.Renderer->GetActiveCamera()->Azimuth(-10.0);
  FFD_CHECK(scene.Mapper->GetTimeToDraw() == time || scene.Mapper->GetTimeToDraw() > 0.0);
  scene.Mapper->RemoveObserver(tag);
  FFD_CHECK(FFDLargestDifference(scene.Show(), whole) == 0);

  // A picture that is not for the window takes its last one away from nobody.
  scene.Mapper->SetDeformation(scene.Lattice);
  const std::vector<unsigned char> last = scene.Show();
  FFD_CHECK(FFDLargestDifference(last, whole) > 20);
  vtkNew<vtkImageData> image;
  FFD_CHECK(scene.Mapper->RenderToImage(scene.Renderer, scene.Volume, 20, 20, image));
  scene.Mapper->SetDeformation(nullptr);
  scene.Mapper->AddObserver(vtkCommand::VolumeMapperRenderProgressEvent, command);
  FFD_CHECK(FFDLargestDifference(scene.Show(), last) == 0);
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

/// Windows that go while the mapper is in none of their renderers, and windows that are finalized.
int TestWindows()
{
  FFDTestScene scene;
  scene.Renderer->RemoveActor(scene.ConeActor);
  const std::vector<unsigned char> first = scene.Show();
  for (int turn = 0; turn < 3; ++turn)
  {
    // The volume gives its mapper away before the window is deleted.
    scene.Volume->SetMapper(nullptr);
    scene.Window->RemoveRenderer(scene.Renderer);
    scene.Window = nullptr;
    scene.Volume->SetMapper(scene.Mapper);
    FFD_CHECK(FFDLargestDifference(scene.Show(), first) == 0);
    scene.Volume->SetMapper(nullptr);
    scene.Window->Finalize();
    scene.Volume->SetMapper(scene.Mapper);
    FFD_CHECK(FFDLargestDifference(scene.Show(), first) == 0);
    // And with the mapper in place.
    scene.Window->Finalize();
    FFD_CHECK(FFDLargestDifference(scene.Show(), first) == 0);
  }
  // On screen instead of off screen, and back.
  scene.Window->SetOffScreenRendering(0);
  scene.Show();
  scene.Window->SetOffScreenRendering(1);
  FFD_CHECK(FFDLargestDifference(scene.Show(), first) == 0);
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

/// ShallowCopy() renders the same picture; of another mapper it takes what both have.
int TestShallowCopy()
{
  FFDTestScene scene;
  scene.Mapper->SetSampleDistance(1.3);
  scene.Mapper->SetInverseModeToFirstOrder();
  scene.Mapper->SetClipBox(2.0, 20.0, 1.0, 21.0, 0.0, 19.0);
  const std::vector<unsigned char> first = scene.Show();
  vtkNew<vtkFFDInverseRayVolumeMapper> copy;
  copy->ShallowCopy(scene.Mapper);
  FFD_CHECK(copy->GetDeformation() == scene.Lattice.Get() && copy->GetInput() == scene.Image.Get());
  scene.Volume->SetMapper(copy);
  FFD_CHECK(FFDLargestDifference(scene.Show(), first) == 0);
  copy->RemoveClipBox();
  FFD_CHECK(FFDLargestDifference(scene.Show(), first) > 0);
  // Of itself: nothing happens.
  const vtkMTimeType time = copy->GetMTime();
  copy->ShallowCopy(copy);
  vtkNew<FFDErrorLog> errors;
  errors->Watch(copy);
  copy->ShallowCopy(nullptr);
  FFD_CHECK(errors->Had("no mapper"));
  FFD_CHECK(copy->GetMTime() == time && copy->GetInput() == scene.Image.Get());

  vtkNew<vtkFixedPointVolumeRayCastMapper> fixed;
  fixed->SetInputData(scene.Image);
  fixed->CroppingOn();
  fixed->SetCroppingRegionPlanes(1.0, 2.0, 3.0, 4.0, 5.0, 6.0);
  fixed->SetCroppingRegionFlagsToFence();
  fixed->SetBlendModeToMaximumIntensity();
  fixed->SetAverageIPScalarRange(3.0, 30.0);
  fixed->SetScalarModeToUsePointFieldData();
  fixed->SelectScalarArray("ball");
  vtkNew<vtkPlane> plane;
  fixed->AddClippingPlane(plane);
  vtkNew<vtkFFDInverseRayVolumeMapper> taken;
  taken->ShallowCopy(fixed);
  FFD_CHECK(taken->GetInput() == scene.Image.Get() && taken->GetCropping() == 1);
  FFD_CHECK(taken->GetCroppingRegionPlanes()[5] == 6.0 &&
    taken->GetCroppingRegionFlags() == fixed->GetCroppingRegionFlags());
  FFD_CHECK(
    taken->GetBlendMode() == fixed->GetBlendMode() && taken->GetAverageIPScalarRange()[1] == 30.0);
  FFD_CHECK(taken->GetClippingPlanes() && taken->GetClippingPlanes()->GetNumberOfItems() == 1);
  FFD_CHECK(std::string(taken->GetArrayName()) == "ball" &&
    taken->GetScalarMode() == VTK_SCALAR_MODE_USE_POINT_FIELD_DATA);
  return EXIT_SUCCESS;
}

/// What a frame holds is given back with the graphics resources; nothing grows with frames.
int TestMemory()
{
  FFDTestScene scene;
  vtksys::SystemInformation system;
  const auto used = [&] { return static_cast<double>(system.GetProcMemoryUsed()) / 1024.0; };
  vtkNew<vtkImageData> colors;
  // A picture without a window: only the mapper's own image, 4 bytes a pixel.
  constexpr int Large = 3000;
  FFD_CHECK(scene.Mapper->RenderToImage(scene.Renderer, scene.Volume, Large, Large, colors) == 1);
  colors->Initialize();
  const double with = used();
  scene.Mapper->ReleaseGraphicsResources(nullptr);
  const double without = used();
  std::cout << "memory: " << with << " MiB with an image of " << Large << " x " << Large << ", "
            << without << " MiB after ReleaseGraphicsResources()\n";
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) // which keep what is freed
  constexpr double image = 4.0 * Large * Large / 1048576.0;
  FFD_CHECK(with - without > 0.9 * image && with - without < 2.0 * image);
#endif
  // The caches stay: they are of the inputs, not of the window.
  const Counts before = CountBuilds(scene.Mapper);
  const std::vector<unsigned char> first = scene.Show();
  FFD_CHECK(CountBuilds(scene.Mapper) == before);
  const vtkTypeInt64 auxiliary = scene.Mapper->GetAuxiliaryMemorySize();
  scene.Show();
  const double start = used();
  for (int i = 0; i < 40; ++i)
  {
    scene.Window->SetSize(80 + i % 3, 80);
    scene.Lattice->SetDisplacement(1, 1, 1, 0.1 * (i % 4), 0.0, 0.0);
    scene.Window->Render();
    scene.Mapper->ReleaseGraphicsResources(scene.Window);
  }
  scene.Lattice->SetDisplacement(1, 1, 1, 0.0, 0.0, 0.0);
  scene.Window->SetSize(80, 80);
  FFD_CHECK(FFDLargestDifference(scene.Show(), first) == 0);
  std::cout << "memory: " << used() - start << " MiB more after 40 frames\n";
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  FFD_CHECK(used() - start < 20.0);
#endif
  FFD_CHECK(scene.Mapper->GetAuxiliaryMemorySize() == auxiliary);
  return EXIT_SUCCESS;
}

/// What is held besides a volume of bytes of 256 x 256 x 128 voxels with a lattice of 8^3 control
/// points: at most a twentieth of it, the control points once.
int TestAuxiliaryMemory()
{
  FFDTestScene scene;
  vtkNew<vtkImageData> image;
  image->SetDimensions(256, 256, 128);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  auto* voxels = static_cast<unsigned char*>(image->GetScalarPointer());
  const vtkIdType count = image->GetNumberOfPoints();
  for (vtkIdType i = 0; i < count; ++i)
  {
    voxels[i] = static_cast<unsigned char>(i * i % 199);
  }
  scene.Mapper->SetInputData(image);
  scene.Lattice->SetDimensions(8, 8, 8);
  scene.Lattice->FitToBounds(image->GetBounds(), 0.0);
  scene.Lattice->SetDisplacement(3, 4, 3, 20.0, 10.0, 5.0);
  const auto size = [&scene] {
    scene.Render();
    return static_cast<double>(scene.Mapper->GetAuxiliaryMemorySize());
  };
  const double bent = size();
  scene.Mapper->SetDeformation(nullptr);
  const double straight = size();
  std::cout << "memory: " << 100.0 * bent / static_cast<double>(count) << " % of the volume, "
            << bent - straight << " bytes of them for the deformation\n";
  FFD_CHECK(bent <= 0.05 * static_cast<double>(count));
  // With the border 14^3 control points, and a number for each cell.
  const double points = 14.0 * 14.0 * 14.0 * 3.0 * sizeof(double);
  FFD_CHECK(bent > straight && bent - straight < 1.5 * points);
  // Extremes are looked for by more than what is visible.
  scene.Mapper->SetBlendModeToMaximumIntensity();
  const double extremes = size();
  std::cout << "memory: " << 100.0 * extremes / static_cast<double>(count) << " % for maxima\n";
  FFD_CHECK(extremes > straight && extremes <= 0.05 * static_cast<double>(count));
  scene.Mapper->SetBlendModeToComposite();
  // An edit moves the bounds on to other control points: none of those before stay.
  scene.Mapper->SetDeformation(scene.Lattice);
  scene.Lattice->SetDisplacement(3, 4, 3, 21.0, 10.0, 5.0);
  FFD_CHECK(size() == bent);
  // The last picture has the same ones.
  scene.Mapper->SetAutoAdjustSampleDistances(false);
  scene.Show();
  scene.Window->SetDesiredUpdateRate(1000.0);
  scene.Show();
  scene.Lattice->SetDisplacement(3, 4, 3, 22.0, 10.0, 5.0);
  scene.Show();
  const double coherent = static_cast<double>(scene.Mapper->GetAuxiliaryMemorySize());
  std::cout << "memory: " << coherent - bent << " bytes of the last picture\n";
  FFD_CHECK(coherent > bent && coherent - bent < 0.9 * points);
  return EXIT_SUCCESS;
}

} // namespace

int TestMapperPipeline(int, char*[])
{
  FFD_CHECK(TestBuilds() == EXIT_SUCCESS);
  FFD_CHECK(TestSharedBounds() == EXIT_SUCCESS);
  FFD_CHECK(TestInputChanges() == EXIT_SUCCESS);
  FFD_CHECK(TestTimes() == EXIT_SUCCESS);
  FFD_CHECK(TestAbort() == EXIT_SUCCESS);
  FFD_CHECK(TestWindows() == EXIT_SUCCESS);
  FFD_CHECK(TestShallowCopy() == EXIT_SUCCESS);
  FFD_CHECK(TestMemory() == EXIT_SUCCESS);
  FFD_CHECK(TestAuxiliaryMemory() == EXIT_SUCCESS);
  return EXIT_SUCCESS;
}
