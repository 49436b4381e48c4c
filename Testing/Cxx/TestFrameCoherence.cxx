// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Frames that cast only what an edit has changed against frames that cast everything.
#include "FFDTestVolume.h"

#include "vtkCallbackCommand.h"
#include "vtkContourValues.h"
#include "vtkLight.h"
#include "vtkLightCollection.h"
#include "vtkPlane.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <new>
#include <string>
#include <utility>

namespace
{

constexpr int Size = 160; // ten tiles of 16 rays a side

/// Whole frames of a drag have tiles elsewhere than frames of their own: differences of rounding.
constexpr int OtherTiles = 3;

/// A scene that moves, with a lattice of many control points.
struct MovingScene : FFDTestScene
{
  explicit MovingScene(bool coherent, int size = Size)
  {
    this->Lattice->SetDimensions(9, 9, 9);
    this->Lattice->FitToBounds(this->Image->GetBounds(), 0.0);
    this->Lattice->Reset();
    this->Lattice->SetDisplacement(4, 4, 4, 1.5, 1.0, 0.5);
    this->Mapper->AutoAdjustSampleDistancesOff();
    this->Mapper->SetFrameCoherence(coherent);
    this->ConeActor->VisibilityOff();
    this->Show(size);
    this->Window->SetDesiredUpdateRate(1000.0);
  }

  void Move(int i, int j, int k, double x, double y, double z)
  {
    double d[3];
    this->Lattice->GetDisplacement(i, j, k, d);
    this->Lattice->SetDisplacement(i, j, k, d[0] + x, d[1] + y, d[2] + z);
  }
};

struct Difference
{
  int Largest = 0;
  double Mean = 0.0;
};

Difference Compare(const std::vector<unsigned char>& a, const std::vector<unsigned char>& b)
{
  Difference difference;
  difference.Largest = FFDLargestDifference(a, b);
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
  {
    difference.Mean += std::abs(static_cast<int>(a[i]) - b[i]);
  }
  difference.Mean /= static_cast<double>(std::max<std::size_t>(1, a.size()));
  return difference;
}

/// The same done to a scene that shows tiles again and to one that does not.
class Pair
{
public:
  explicit Pair(int size = Size)
    : Coherent(true, size)
    , Whole(false, size)
    , Side(size)
  {
  }

  MovingScene Coherent;
  MovingScene Whole;
  const int Side;

  void Do(const std::function<void(MovingScene&)>& action)
  {
    action(this->Coherent);
    action(this->Whole);
  }

  /// The next frame of both; what was reused.
  double Next(Difference& difference)
  {
    const std::vector<unsigned char> coherent = this->Coherent.Show(this->Side);
    const std::vector<unsigned char> whole = this->Whole.Show(this->Side);
    difference = Compare(coherent, whole);
    if (this->Whole.Mapper->GetReusedFraction() != 0.0)
    {
      std::cerr << "FrameCoherence is off, but tiles are shown again\n";
      difference.Largest = 256;
    }
    return this->Coherent.Mapper->GetReusedFraction();
  }
  double Next()
  {
    Difference difference;
    return this->Next(difference);
  }
};

/// Edits of random control points, `amount` voxels at most; `between` is done before each frame.
bool Drag(const char* name, Pair& pair, double amount, double leastReused, int largest, double mean,
  const std::function<void(MovingScene&, int)>& between = {})
{
  FFDRandom random(7);
  pair.Next();
  double reused = 0.0;
  Difference worst;
  constexpr int frames = 8;
  for (int frame = 0; frame < frames; ++frame)
  {
    const int i = static_cast<int>(random.Number(2.0, 7.0));
    const int j = static_cast<int>(random.Number(2.0, 7.0));
    const int k = static_cast<int>(random.Number(2.0, 7.0));
    const double x = random.Number(-amount, amount);
    const double y = random.Number(-amount, amount);
    const double z = random.Number(-amount, amount);
    pair.Do([&](MovingScene& scene) {
      scene.Move(i, j, k, x, y, z);
      if (between)
      {
        between(scene, frame);
      }
    });
    Difference difference;
    reused += pair.Next(difference) / frames;
    worst.Largest = std::max(worst.Largest, difference.Largest);
    worst.Mean = std::max(worst.Mean, difference.Mean);
  }
  const bool ok = reused >= leastReused && reused < 1.0 && worst.Largest <= largest &&
    worst.Mean <= mean && pair.Coherent.Errors->Count == 0;
  std::cout << name << ": " << reused << " of the tiles reused, largest difference "
            << worst.Largest << ", mean " << worst.Mean << (ok ? "\n" : ": NOT as it must be\n");
  return ok;
}

bool TestDrags()
{
  bool ok = true;
  {
    Pair pair;
    ok &= Drag("edits", pair, 0.5, 0.4, 6, 0.05);
  }
  {
    Pair pair;
    pair.Do([](MovingScene& s) { s.Mapper->SetFrameCoherenceTolerance(0.0); });
    ok &= Drag("tolerance 0", pair, 0.5, 0.3, 2, 0.02);
  }
  for (int mode = 0; mode < 3; ++mode)
  {
    Pair pair;
    pair.Do([&](MovingScene& s) { s.Mapper->SetInverseMode(mode); });
    ok &= Drag(pair.Coherent.Mapper->GetInverseModeAsString(), pair, 0.5, 0.4, 6, 0.05);
  }
  for (int mode : { vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND,
         vtkVolumeMapper::MINIMUM_INTENSITY_BLEND, vtkVolumeMapper::AVERAGE_INTENSITY_BLEND,
         vtkVolumeMapper::ADDITIVE_BLEND, vtkVolumeMapper::ISOSURFACE_BLEND })
  {
    Pair pair;
    pair.Do([&](MovingScene& s) {
      s.Property->GetIsoSurfaceValues()->SetValue(0, 100.0);
      s.Mapper->SetBlendMode(mode);
    });
    ok &= Drag(("blend mode " + std::to_string(mode)).c_str(), pair, 0.5, 0.4,
      mode == vtkVolumeMapper::ISOSURFACE_BLEND ? 64 : 6, 0.02); // edges of surfaces are hard
  }
  {
    // Tiles on fractions of pixels, as an adapted distance may be.
    Pair pair;
    pair.Do([](MovingScene& s) { s.Mapper->SetImageSampleDistance(1.3); });
    ok &= Drag("image sample distance 1.3", pair, 0.5, 0.2, 6, 0.05);
  }
  {
    Pair pair;
    pair.Do([](MovingScene& s) { s.Mapper->SetImageSampleDistance(0.5); });
    ok &= Drag("image sample distance 0.5", pair, 0.5, 0.3, 6, 0.05);
  }
  {
    Pair pair;
    pair.Do([](MovingScene& s) {
      s.Mapper->SetFinalColorWindow(0.6);
      s.Mapper->SetFinalColorLevel(0.4);
    });
    ok &= Drag("final colors", pair, 0.5, 0.4, 10, 0.08);
  }
  {
    Pair pair;
    pair.Do([](MovingScene& s) { s.Mapper->ReferenceKernelsOn(); });
    ok &= Drag("reference kernels", pair, 0.5, 0.4, 6, 0.05);
  }
  {
    // The volume grows and shrinks in the picture, which grows and shrinks with it.
    Pair pair;
    ok &= Drag("growing", pair, 0.2, 0.1, 6, 0.05, [](MovingScene& s, int frame) {
      const double by = frame % 6 < 3 ? 1.5 : -1.5;
      s.Move(frame % 2 ? 8 : 0, 4, 4, frame % 2 ? by : -by, 0.0, 0.0);
      s.Move(4, 8, 4, 0.0, by, 0.0);
    });
  }
  {
    // The lower left corner of the picture, at (75, 67) first, moves to (61, 52) and back, and so
    // by a group of tiles to the left and by one down.
    Pair pair(480);
    pair.Do([](MovingScene& s) { s.Renderer->GetActiveCamera()->Zoom(0.79); });
    ok &=
      Drag("growing by groups of tiles", pair, 0.02, 0.4, 6, 0.05, [](MovingScene& s, int frame) {
        const double by = frame % 4 < 2 ? -2.0 : 2.0;
        s.Move(1, 1, 4, by, by, 0.0);
      });
  }
  {
    // Something opaque moves through the volume.
    Pair pair;
    pair.Do([](MovingScene& s) { s.ConeActor->VisibilityOn(); });
    ok &= Drag("geometry", pair, 0.5, 0.3, 6, 0.05,
      [](MovingScene& s, int frame) { s.Cone->SetCenter(-4.0 + 2.0 * frame, 10.0, 14.0); });
  }
  return ok;
}

/// Whatever else changes makes the next picture as a whole, edited or not.
bool TestOtherChanges()
{
  bool ok = true;
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(10.0, 0.0, 0.0);
  plane->SetNormal(1.0, 0.1, 0.0);
  const std::vector<std::pair<const char*, std::function<void(MovingScene&)>>> changes = {
    { "camera", [](MovingScene& s) { s.Renderer->GetActiveCamera()->Azimuth(20.0); } },
    { "clipping range",
      [](MovingScene& s) { s.Renderer->GetActiveCamera()->SetClippingRange(60.0, 120.0); } },
    { "light",
      [](MovingScene& s) {
        vtkNew<vtkLight> light;
        light->SetPosition(1.0, 5.0, 3.0);
        s.Property->ShadeOn();
        s.Renderer->AddLight(light);
      } },
    { "material",
      [](MovingScene& s) {
        s.Property->ShadeOn();
        s.Property->SetAmbient(0.5);
      } },
    { "opacity", [](MovingScene& s) { s.Opacity->AddPoint(120.0, 0.9); } },
    { "voxels",
      [](MovingScene& s) {
        vtkDataArray* scalars = s.Image->GetPointData()->GetScalars();
        for (vtkIdType i = 0; i < scalars->GetNumberOfTuples(); ++i)
        {
          scalars->SetComponent(i, 0, 0.7 * scalars->GetComponent(i, 0));
        }
        scalars->Modified();
      } },
    { "matrix", [](MovingScene& s) { s.Volume->SetPosition(2.0, 0.0, 0.0); } },
    { "option", [](MovingScene& s) { s.Mapper->SetFinalColorWindow(0.5); } },
    { "clipping plane", [&](MovingScene& s) { s.Mapper->AddClippingPlane(plane); } },
    { "another deformation",
      [](MovingScene& s) {
        s.Lattice->SetDimensions(7, 7, 7);
        s.Lattice->FitToBounds(s.Image->GetBounds(), 0.0);
        s.Lattice->SetDisplacement(3, 3, 3, 0.0, 7.0, 0.0);
      } },
    { "kernels",
      [](MovingScene& s) { s.Mapper->SetReferenceKernels(!s.Mapper->GetReferenceKernels()); } },
    { "RenderToImage", [](MovingScene& s) { s.Render(); } },
    { "nothing", [](MovingScene&) {} },
  };
  for (const auto& change : changes)
  {
    const bool both =
      std::string(change.first) == "camera" || std::string(change.first) == "nothing";
    for (bool edited : { true, false })
    {
      if (!edited && !both)
      {
        continue;
      }
      const auto edit = [](MovingScene& s) { s.Move(3, 4, 5, 0.2, 0.0, 0.1); };
      Pair pair;
      pair.Next();
      pair.Do(edit);
      const double before = pair.Next();
      const std::vector<unsigned char> picture = pair.Whole.Show(Size);
      pair.Do(change.second);
      if (edited)
      {
        pair.Do(edit);
      }
      Difference difference;
      const double after = pair.Next(difference);
      // What is left of the last picture would show.
      const bool shows = std::string(change.first) != "nothing" &&
        std::string(change.first) != "RenderToImage" && std::string(change.first) != "kernels";
      const int changed = FFDLargestDifference(picture, pair.Whole.Show(Size));
      const bool shownAgain = edited && !shows && std::string(change.first) != "kernels";
      if (!(before > 0.2) || (after > 0.0) != shownAgain || difference.Largest > OtherTiles ||
        (shows && changed < 10))
      {
        std::cerr << change.first << (edited ? ", edited: " : ": ") << before << " reused before, "
                  << after << " after it, difference " << difference.Largest << ", changed by "
                  << changed << "\n";
        ok = false;
      }
    }
  }
  return ok;
}

int TestStillPictures()
{
  Pair pair;
  const auto edit = [](MovingScene& s) { s.Move(4, 3, 4, 0.4, 0.3, 0.0); };
  Difference difference;
  pair.Next();
  pair.Do(edit);
  FFD_CHECK(pair.Next() > 0.2);
  // The end of a drag, with an edit or without: as if nothing had been drawn before.
  for (bool edited : { false, true })
  {
    pair.Do([](MovingScene& s) { s.Window->SetDesiredUpdateRate(1e-4); });
    if (edited)
    {
      pair.Do(edit);
    }
    FFD_CHECK(pair.Next(difference) == 0.0 && difference.Largest == 0);
    pair.Do([](MovingScene& s) { s.Window->SetDesiredUpdateRate(1000.0); });
    pair.Do(edit);
    FFD_CHECK(pair.Next(difference) == 0.0 && difference.Largest <= OtherTiles);
    pair.Do(edit);
    FFD_CHECK(pair.Next() > 0.2);
  }
  // Still pictures that are kept leave those of moving frames as they are.
  pair.Do([](MovingScene& s) { s.Window->SetDesiredUpdateRate(1e-4); });
  pair.Coherent.Mapper->StillFrameCoherenceOn();
  pair.Do(edit);
  FFD_CHECK(pair.Next(difference) == 0.0 && difference.Largest == 0);
  pair.Do([](MovingScene& s) { s.Window->SetDesiredUpdateRate(1000.0); });
  for (int frame = 0; frame < 3; ++frame)
  {
    pair.Do(edit);
    FFD_CHECK((pair.Next(difference) > 0.2) == (frame > 0) && difference.Largest <= OtherTiles);
  }
  pair.Do([](MovingScene& s) { s.Window->SetDesiredUpdateRate(1e-4); });
  FFD_CHECK(pair.Next(difference) == 0.0 && difference.Largest == 0);
  FFD_CHECK(pair.Next(difference) == 1.0 && difference.Largest == 0);
  pair.Do([](MovingScene& s) { s.Window->SetDesiredUpdateRate(1000.0); });
  pair.Do(edit);
  FFD_CHECK(pair.Next(difference) > 0.2 && difference.Largest <= OtherTiles);
  pair.Coherent.Mapper->StillFrameCoherenceOff();
  // An edit of nothing.
  pair.Do([](MovingScene& s) { s.Lattice->Modified(); });
  FFD_CHECK(pair.Next(difference) == 0.0 && difference.Largest <= OtherTiles);
  // Counts are those of whole pictures.
  pair.Do([](MovingScene& s) { s.Mapper->CollectStatisticsOn(); });
  pair.Next();
  pair.Do(edit);
  FFD_CHECK(pair.Next(difference) == 0.0 && difference.Largest == 0);
  FFD_CHECK(pair.Coherent.Mapper->GetStatistics()->GetNumberOfRays() ==
    pair.Whole.Mapper->GetStatistics()->GetNumberOfRays());
  pair.Do([](MovingScene& s) { s.Mapper->CollectStatisticsOff(); });
  // What folds has no single inverse: whole pictures.
  pair.Do([](MovingScene& s) { s.Move(4, 4, 4, 30.0, 0.0, 0.0); });
  pair.Next();
  pair.Do(edit);
  FFD_CHECK(pair.Next(difference) == 0.0 && difference.Mean < 0.1); // rays there jump with tiles
  // Another size of the window.
  pair.Do([](MovingScene& s) { s.Move(4, 4, 4, -30.0, 0.0, 0.0); });
  pair.Next();
  pair.Do([](MovingScene& s) { s.Window->SetSize(Size - 16, Size); });
  pair.Do(edit);
  pair.Coherent.Window->Render();
  FFD_CHECK(pair.Coherent.Mapper->GetReusedFraction() == 0.0);
  // Nothing is kept in a window that has given its resources back.
  pair.Coherent.Window->Finalize();
  pair.Do([](MovingScene& s) { s.Window->SetSize(Size, Size); });
  pair.Do(edit);
  FFD_CHECK(pair.Next(difference) == 0.0 && difference.Largest <= OtherTiles);
  FFD_CHECK(pair.Coherent.Errors->Count == 0);
  return EXIT_SUCCESS;
}

/// A frame that was given up leaves nothing that could be shown again.
int TestAbort()
{
  Pair pair;
  const auto edit = [](MovingScene& s) { s.Move(4, 3, 4, 0.4, 0.3, 0.0); };
  pair.Next();
  vtkNew<vtkCallbackCommand> abort;
  abort->SetCallback([](vtkObject* caller, unsigned long, void*, void*) {
    vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1);
  });
  pair.Do(edit);
  const unsigned long tag =
    pair.Coherent.Mapper->AddObserver(vtkCommand::VolumeMapperRenderProgressEvent, abort);
  pair.Coherent.Show(Size);
  pair.Coherent.Mapper->RemoveObserver(tag);
  pair.Do(edit);
  Difference difference;
  FFD_CHECK(pair.Next(difference) == 0.0 && difference.Largest <= OtherTiles);
  pair.Do(edit);
  FFD_CHECK(pair.Next() > 0.2);
  return EXIT_SUCCESS;
}

/// Still pictures are shown again where nothing has changed, bit by bit as those that are cast
/// anew.
bool TestStillFrameCoherence()
{
  struct Change
  {
    const char* Name;
    std::function<void(MovingScene&)> Do;
    bool Reuses; ///< some of the picture
  };
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(4.0, 0.0, 0.0);
  plane->SetNormal(1.0, 0.1, 0.0);
  vtkNew<vtkImageData> mask;
  mask->SetDimensions(24, 24, 24);
  mask->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  mask->GetPointData()->GetScalars()->Fill(255.0);
  const auto nothing = [](MovingScene&) {};
  const std::vector<Change> changes = {
    { "nothing", nothing, true },
    { "geometry appears", [](MovingScene& s) { s.ConeActor->VisibilityOn(); }, true },
    { "geometry moves", [](MovingScene& s) { s.Cone->SetCenter(2.0, 14.0, 12.0); }, true },
    { "the color of geometry",
      [](MovingScene& s) { s.ConeActor->GetProperty()->SetColor(0.0, 1.0, 0.0); }, true },
    { "geometry disappears", [](MovingScene& s) { s.ConeActor->VisibilityOff(); }, true },
    { "an edit", [](MovingScene& s) { s.Move(4, 3, 4, 0.4, 0.3, 0.0); }, false },
    { "an edit of nothing", [](MovingScene& s) { s.Lattice->Modified(); }, true },
    { "a plane", [&](MovingScene& s) { s.Mapper->AddClippingPlane(plane); }, false },
    { "the plane moves", [&](MovingScene&) { plane->SetOrigin(8.0, 0.0, 0.0); }, false },
    { "no plane", [](MovingScene& s) { s.Mapper->RemoveAllClippingPlanes(); }, false },
    { "a mask",
      [&](MovingScene& s) {
        s.Mapper->SetMaskTypeToBinary();
        s.Mapper->SetMaskInput(mask);
      },
      false },
    { "values of the mask",
      [&](MovingScene&) {
        std::fill_n(static_cast<unsigned char*>(mask->GetScalarPointer()), 24 * 24 * 12, '\0');
        mask->Modified();
      },
      false },
    { "the function's points", [](MovingScene& s) { s.Opacity->AddPoint(120.0, 0.9); }, false },
    { "the material", [](MovingScene& s) { s.Property->ShadeOn(); }, false },
    { "the light",
      [](MovingScene& s) {
        vtkNew<vtkLight> light;
        light->SetPosition(1.0, 5.0, 3.0);
        s.Renderer->AddLight(light);
      },
      false },
    { "the light moves",
      [](MovingScene& s) {
        vtkLightCollection* lights = s.Renderer->GetLights();
        vtkLight::SafeDownCast(lights->GetItemAsObject(lights->GetNumberOfItems() - 1))
          ->SetPosition(20.0, -50.0, 3.0);
      },
      false },
    { "the camera", [](MovingScene& s) { s.Renderer->GetActiveCamera()->Azimuth(20.0); }, false },
    { "a voxel",
      [](MovingScene& s) {
        s.Image->GetPointData()->GetScalars()->SetComponent(12 + 24 * (12 + 24 * 20), 0, 255.0);
        s.Image->GetPointData()->GetScalars()->Modified();
      },
      false },
    { "the place", [](MovingScene& s) { s.Volume->SetPosition(2.0, 0.0, 0.0); }, false },
    { "cropping", [](MovingScene& s) { s.Mapper->CroppingOn(); }, false },
    { "the size of pixels", [](MovingScene& s) { s.Mapper->SetImageSampleDistance(2.0); }, false },
    { "pixels that geometry splits",
      [](MovingScene& s) {
        s.ConeActor->VisibilityOn();
        s.Cone->SetCenter(2.0, 15.0, 12.0);
      },
      false },
    { "other pixels that geometry splits",
      [](MovingScene& s) { s.Cone->SetCenter(2.0, 18.0, 12.0); }, true },
    { "the last color", [](MovingScene& s) { s.Mapper->SetFinalColorWindow(0.5); }, false },
    { "a fold", [](MovingScene& s) { s.Move(4, 4, 4, 30.0, 0.0, 0.0); }, false },
    { "nothing, folded", nothing, true },
    { "maxima", [](MovingScene& s) { s.Mapper->SetBlendModeToMaximumIntensity(); }, false },
    { "geometry before maxima", [](MovingScene& s) { s.Cone->SetCenter(4.0, 10.0, 20.0); }, true },
    { "an image in between", [](MovingScene& s) { s.Render(); }, true },
    { "a frame while the scene moves",
      [](MovingScene& s) {
        s.Window->SetDesiredUpdateRate(1000.0);
        s.Window->Render();
        s.Window->SetDesiredUpdateRate(1e-4);
      },
      true },
    { "counts", [](MovingScene& s) { s.Mapper->CollectStatisticsOn(); }, false },
    { "no counts", [](MovingScene& s) { s.Mapper->CollectStatisticsOff(); }, false },
  };
  Pair pair(400);
  pair.Do([](MovingScene& s) { s.Window->SetDesiredUpdateRate(1e-4); });
  pair.Coherent.Mapper->StillFrameCoherenceOn();
  pair.Next();
  bool ok = true;
  for (const Change& change : changes)
  {
    pair.Do(change.Do);
    Difference difference;
    const double reused = pair.Next(difference);
    std::cout << change.Name << ": " << reused << " of the still picture reused\n";
    if ((reused > 0.0) != change.Reuses || difference.Largest != 0)
    {
      std::cerr << change.Name << ": " << reused << " of the still picture reused, difference "
                << difference.Largest << "\n";
      ok = false;
    }
    // What must come next is known of each.
    ok = ok && pair.Next(difference) == (change.Name == std::string("counts") ? 0.0 : 1.0) &&
      difference.Largest == 0;
  }
  return ok && pair.Coherent.Errors->Count == 0;
}

/// A still frame that was given up shows the last picture, and is not gone on from.
int TestStillAbort()
{
  MovingScene scene(true);
  scene.Window->SetDesiredUpdateRate(1e-4);
  scene.Mapper->StillFrameCoherenceOn();
  const std::vector<unsigned char> picture = scene.Show(Size);
  const double time = scene.Mapper->GetExpectedStillTime();
  const double timeToDraw = scene.Mapper->GetTimeToDraw();
  FFD_CHECK(scene.Show(Size) == picture && scene.Mapper->GetReusedFraction() == 1.0);
  FFD_CHECK(scene.Mapper->GetExpectedStillTime() >= time);
  FFD_CHECK(scene.Mapper->GetTimeToDraw() >= timeToDraw);
  vtkNew<vtkCallbackCommand> abort;
  abort->SetCallback([](vtkObject* caller, unsigned long, void*, void*) {
    vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1);
  });
  scene.Move(4, 3, 4, 3.0, 3.0, 0.0);
  const unsigned long tag =
    scene.Mapper->AddObserver(vtkCommand::VolumeMapperRenderProgressEvent, abort);
  FFD_CHECK(scene.Show(Size) == picture);
  scene.Mapper->RemoveObserver(tag);
  const std::vector<unsigned char> edited = scene.Show(Size);
  FFD_CHECK(scene.Mapper->GetReusedFraction() == 0.0);
  FFD_CHECK(FFDLargestDifference(edited, picture) > 4);
  // The same where the last picture is another one than the last still one.
  scene.Window->SetDesiredUpdateRate(1000.0);
  scene.Move(4, 3, 4, -3.0, -3.0, 0.0);
  const std::vector<unsigned char> moving = scene.Show(Size);
  FFD_CHECK(FFDLargestDifference(moving, edited) > 4);
  scene.Window->SetDesiredUpdateRate(1e-4);
  const unsigned long again =
    scene.Mapper->AddObserver(vtkCommand::VolumeMapperRenderProgressEvent, abort);
  FFD_CHECK(scene.Show(Size) == moving);
  // And where that has made way for the next one meanwhile.
  scene.Mapper->RemoveObserver(again);
  scene.Window->SetDesiredUpdateRate(1000.0);
  scene.Move(4, 3, 4, 0.5, 0.0, 0.0);
  const std::vector<unsigned char> moved = scene.Show(Size);
  FFD_CHECK(FFDLargestDifference(moved, moving) > 0);
  scene.Move(4, 3, 4, 0.5, 0.0, 0.0);
  const unsigned long last =
    scene.Mapper->AddObserver(vtkCommand::VolumeMapperRenderProgressEvent, abort);
  FFD_CHECK(scene.Show(Size) == moving);
  scene.Mapper->RemoveObserver(last);
  // Default, copies.
  vtkNew<vtkFFDInverseRayVolumeMapper> copy;
  FFD_CHECK(!copy->GetStillFrameCoherence());
  copy->ShallowCopy(scene.Mapper);
  FFD_CHECK(copy->GetStillFrameCoherence());
  return EXIT_SUCCESS;
}

/// After a frame that ended by an exception, as of an allocation, nothing of its picture is shown
/// again.
int TestException(bool still)
{
  MovingScene scene(true);
  if (still)
  {
    scene.Window->SetDesiredUpdateRate(1e-4);
    scene.Mapper->StillFrameCoherenceOn();
  }
  scene.Show(Size);
  vtkNew<vtkCallbackCommand> fail;
  fail->SetCallback([](vtkObject*, unsigned long, void*, void*) { throw std::bad_alloc(); });
  scene.Move(4, 3, 4, 3.0, 3.0, 0.0);
  const unsigned long tag =
    scene.Mapper->AddObserver(vtkCommand::VolumeMapperRenderProgressEvent, fail);
  scene.Show(Size);
  FFD_CHECK(scene.Errors->Count == 1);
  scene.Mapper->RemoveObserver(tag);
  // VTK keeps a command that throws.
  while (fail->GetReferenceCount() > 1)
  {
    fail->UnRegister(nullptr);
  }
  const std::vector<unsigned char> picture = scene.Show(Size);
  FFD_CHECK(scene.Mapper->GetReusedFraction() == 0.0);
  scene.Mapper->FrameCoherenceOff();
  scene.Mapper->StillFrameCoherenceOff();
  FFD_CHECK(FFDLargestDifference(picture, scene.Show(Size)) <= (still ? 0 : OtherTiles));
  return EXIT_SUCCESS;
}

/// What is behind something opaque may move as it likes.
int TestReach()
{
  double reused[2];
  for (int opaque = 0; opaque < 2; ++opaque)
  {
    MovingScene scene(true);
    scene.Mapper->SetFrameCoherenceTolerance(0.0);
    if (opaque)
    {
      scene.Opacity->RemoveAllPoints();
      scene.Opacity->AddPoint(0.0, 1.0);
    }
    // Face to face, so that the edit, far behind, is hidden by what is in front of it.
    vtkCamera* camera = scene.Renderer->GetActiveCamera();
    camera->SetFocalPoint(11.5, 11.5, 11.5);
    camera->SetPosition(11.5, 11.5, 80.0);
    scene.Show(Size);
    scene.Show(Size);
    scene.Move(4, 4, 2, 1.0, 0.0, 0.0);
    scene.Show(Size);
    reused[opaque] = scene.Mapper->GetReusedFraction();
  }
  std::cout << "an edit on the far side: " << reused[0] << " reused, behind opaque voxels "
            << reused[1] << "\n";
  FFD_CHECK(reused[0] < 0.95);
  // All of it, but for tiles that had to stop for a report, on a slow machine: of those not all of
  // the reach is known.
  FFD_CHECK(reused[1] > reused[0] + 0.1);
  return EXIT_SUCCESS;
}

int TestOptions()
{
  MovingScene scene(true);
  vtkFFDInverseRayVolumeMapper* m = scene.Mapper;
  FFD_CHECK(m->GetFrameCoherence() == 1 && m->GetFrameCoherenceTolerance() == 0.25);
  const auto reusedWith = [&](double tolerance) {
    m->SetFrameCoherenceTolerance(tolerance);
    scene.Show(Size);
    scene.Move(4, 4, 4, 0.3, 0.0, 0.0);
    scene.Show(Size);
    return m->GetReusedFraction();
  };
  const double none = reusedWith(0.0);
  const double some = reusedWith(0.1);
  FFD_CHECK(none < some && some < 1.0);
  FFD_CHECK(reusedWith(1000.0) == 1.0);
  for (double bad :
    { -0.1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity() })
  {
    m->SetFrameCoherenceTolerance(bad);
    FFD_CHECK(scene.Errors->Had("FrameCoherenceTolerance must be a number that is not negative"));
    FFD_CHECK(m->GetFrameCoherenceTolerance() == 1000.0);
  }
  vtkNew<vtkFFDInverseRayVolumeMapper> copy;
  m->FrameCoherenceOff();
  copy->ShallowCopy(m);
  FFD_CHECK(copy->GetFrameCoherence() == 0 && copy->GetFrameCoherenceTolerance() == 1000.0);
  return EXIT_SUCCESS;
}

/// While the scene moves the image sample distance stays as it is if it is about right: else
/// nothing could be shown again.
int TestAdaptedDistance()
{
  MovingScene scene(true);
  scene.Mapper->AutoAdjustSampleDistancesOn();
  scene.Mapper->SetMinimumImageSampleDistance(1.0);
  scene.Mapper->SetMaximumImageSampleDistance(3.0);
  scene.Window->SetDesiredUpdateRate(1e9);
  int reused = 0;
  for (int i = 0; i < 6; ++i)
  {
    scene.Move(4, 4, 4, 0.1, 0.0, 0.0);
    scene.Show(Size);
    reused += scene.Mapper->GetReusedFraction() > 0.0 ? 1 : 0;
  }
  FFD_CHECK(reused >= 4);
  return EXIT_SUCCESS;
}

} // namespace

int TestFrameCoherence(int, char*[])
{
  bool ok = TestDrags();
  ok &= TestOtherChanges();
  FFD_CHECK(ok);
  FFD_CHECK(TestStillPictures() == EXIT_SUCCESS);
  FFD_CHECK(TestAbort() == EXIT_SUCCESS);
  FFD_CHECK(TestStillFrameCoherence());
  FFD_CHECK(TestStillAbort() == EXIT_SUCCESS);
  FFD_CHECK(TestException(true) == EXIT_SUCCESS);
  FFD_CHECK(TestException(false) == EXIT_SUCCESS);
  FFD_CHECK(TestReach() == EXIT_SUCCESS);
  FFD_CHECK(TestOptions() == EXIT_SUCCESS);
  FFD_CHECK(TestAdaptedDistance() == EXIT_SUCCESS);
  return EXIT_SUCCESS;
}
