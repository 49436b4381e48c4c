// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The scenes of VTK's own tests of ray-cast volume mappers (Rendering/Volume/Testing), on the data of
// Testing/Data. Each is rendered four times:
// - without deformation it is that of VTK's mapper in the same process, within the tolerances of the
//   scene, and no less with a lattice of zeros;
// - without the feature that the scene is about it is another picture, in ours as in VTK's;
// - deformed it is that of the volume resampled by vtkFFDResampleVolume at half the spacing,
//   rendered by VTK's mapper, as far as resampling allows (decibels), and not that of the
//   undeformed volume.
//
// A scene is an entry of the list in Scenes() and a line in CMakeLists.txt. Without "--scene NAME"
// the test checks that the two name the same scenes.
#include "FFDTestScenes.h"

#include "vtkActor.h"
#include "vtkFFDResampleVolume.h"
#include "vtkImageCast.h"
#include "vtkLightCollection.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkSphereSource.h"

#include <map>
#include <set>

namespace
{

using Deformation = vtkSmartPointer<vtkBSplineTransform>;

/// What a scene is made of. Everything is done to all three mappers.
class Stage : public ffdTest::Scene
{
public:
  Stage(int argc, char* argv[])
    : Argc(argc)
    , Argv(argv)
  {
  }

  /// Test data as floats: neither classification nor resampling rounds. With a layer of `least`
  /// around it, because VTK's mappers differ in the samples on the faces of a volume.
  vtkSmartPointer<vtkImageData> Read(const std::string& name, int shrink, double least)
  {
    vtkNew<vtkImageCast> cast;
    cast->SetInputData(
      ffdTest::Padded(ffdTest::ReadVolume(this->Argc, this->Argv, name, shrink), least));
    cast->SetOutputScalarTypeToFloat();
    cast->Update();
    return cast->GetOutput();
  }

  void Show(vtkImageData* image, const ffdTest::Transfer& points, double unit, double background)
  {
    this->Image = image;
    this->Background = background;
    this->SetInput(image);
    ffdTest::SetTransfer(this->Property, points, unit);
    this->Voxel = *std::min_element(image->GetSpacing(), image->GetSpacing() + 3);
    this->SetSampleDistance(0.5 * this->Voxel);
  }

  /// Usual subjects.
  void ShowEngine()
  {
    this->Show(this->Read("engine", 2, 0.0), ffdTest::SemiTransparentEngine(), 2.0, 0.0);
  }
  void ShowSolidEngine()
  {
    this->Show(this->Read("engine", 2, 0.0), ffdTest::SolidEngine(), 2.0, 0.0);
  }
  void ShowHead()
  {
    this->Show(this->Read("headsq", 1, 0.0), ffdTest::HeadsqSkin(), 2.0, 0.0);
  }

  void ShowSoftHead()
  {
    this->Show(this->Read("headsq", 1, 0.0), ffdTest::HeadsqSoft(), 2.0, 0.0);
  }

  void Look(const ffdTest::View& view) { this->Camera = view; }

  int Argc;
  char** Argv;
  vtkSmartPointer<vtkImageData> Image;
  double Background = 0.0; // a transparent scalar
  double Voxel = 1.0;
  ffdTest::View Camera{ 30.0, 25.0, 1.0, false, false };
  vtkNew<vtkActor> Actor;
  std::vector<vtkSmartPointer<vtkObject>> Kept;
};

enum class Reference
{
  Fixed,
  Gpu
};

struct SceneTest
{
  std::string Name;
  std::string Origin; // the test of VTK
  Reference With;
  std::function<void(Stage&)> SetUp; // all but the feature
  std::function<void(Stage&, bool)> Feature;
  double Mean; // from VTK's mapper, 1/255
  double P99;
  double Decibels;     // deformed, from the resampled volume; 0: not compared
  double Difference = 2.0; // that the feature makes, mean, at least
};

ffdTest::Picture RenderReference(Stage& stage, const SceneTest& test)
{
  return test.With == Reference::Fixed ? stage.RenderFixedRays() : stage.Render(stage.Gpu);
}

//------------------------------------------------------------------------------
void AddSphere(Stage& stage)
{
  const double* b = stage.Image->GetBounds();
  vtkNew<vtkSphereSource> sphere;
  sphere->SetCenter(b[0] + 0.4 * (b[1] - b[0]), b[2] + 0.45 * (b[3] - b[2]),
    b[4] + 0.6 * (b[5] - b[4]));
  sphere->SetRadius(0.22 * (b[1] - b[0]));
  sphere->SetThetaResolution(40);
  sphere->SetPhiResolution(40);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(sphere->GetOutputPort());
  stage.Actor->SetMapper(mapper);
  stage.Actor->GetProperty()->SetColor(0.2, 0.9, 0.3);
  stage.Actor->GetProperty()->LightingOff();
  stage.Renderer->AddActor(stage.Actor);
}

void SetPositionalLights(Stage& stage, bool on)
{
  // At the camera, with an attenuation that does not depend on the distance: VTK 9.1's GPU mapper,
  // the only one of VTK's that knows positional lights, takes direction and distance of a light from
  // where the ray enters the volume.
  stage.Renderer->RemoveAllLights();
  vtkNew<vtkLight> light;
  light->SetLightTypeToSceneLight();
  light->SetPositional(on ? 1 : 0);
  light->SetPosition(stage.Renderer->GetActiveCamera()->GetPosition());
  light->SetFocalPoint(stage.Renderer->GetActiveCamera()->GetFocalPoint());
  light->SetConeAngle(5.0);
  light->SetExponent(20.0);
  light->SetAttenuationValues(1.5, 0.0, 0.0);
  light->SetDiffuseColor(1.0, 0.6, 0.3);
  light->SetSpecularColor(0.4, 0.6, 1.0);
  stage.Renderer->AddLight(light);
  // The GPU mapper writes its shaders anew when the property changes, not when lights do.
  stage.Property->Modified();
}

//------------------------------------------------------------------------------
std::vector<SceneTest> Scenes()
{
  const ffdTest::View oblique = { 30.0, 25.0, 1.0, false, false };
  const ffdTest::View parallel = { 30.0, 25.0, 1.0, true, false };
  std::vector<SceneTest> scenes;

  scenes.push_back({ "Perspective", "TestGPURayCastPerspectiveParallel", Reference::Fixed,
    [](Stage& s) { s.ShowEngine(); },
    [=](Stage& s, bool on) { s.Look(on ? oblique : parallel); }, 1.0, 2.0, 36.0 });
  scenes.push_back({ "Parallel", "TestGPURayCastPerspectiveParallel", Reference::Fixed,
    [](Stage& s) { s.ShowEngine(); },
    [=](Stage& s, bool on) { s.Look(on ? parallel : oblique); }, 1.0, 2.0, 36.0 });
  scenes.push_back({ "CameraInside", "TestGPURayCastCameraInside", Reference::Gpu,
    [](Stage& s) { s.ShowSoftHead(); },
    [=](Stage& s, bool on) {
      s.Look(on ? ffdTest::View{ 75.0, 10.0, 1.0, false, true } : oblique);
    },
    2.0, 5.0, 35.0 });
  scenes.push_back({ "CameraInsideNonUniformScale",
    "TestGPURayCastCameraInsideNonUniformScaleTransform", Reference::Gpu,
    [](Stage& s) {
      s.ShowSoftHead();
      s.Look({ 75.0, 10.0, 1.0, false, true });
    },
    [](Stage& s, bool on) {
      if (on)
      {
        s.Volume->SetScale(1.0, 0.7, 1.2);
      }
      else
      {
        s.Volume->SetScale(1.0, 1.0, 1.0);
      }
    },
    4.0, 16.0, 30.0 });
  scenes.push_back({ "SmallSpacing", "TestGPURayCastCameraInsideSmallSpacing", Reference::Gpu,
    [](Stage& s) {
      vtkSmartPointer<vtkImageData> head = s.Read("headsq", 1, 0.0);
      head->SetSpacing(0.0032, 0.0032, 0.0015);
      s.Show(head, ffdTest::HeadsqSkin(), 0.002, 0.0);
    },
    // The opacity of a voxel must not depend on the unit that its edges are given in.
    [](Stage& s, bool on) { s.Property->SetScalarOpacityUnitDistance(on ? 0.002 : 2.0); }, 1.0, 4.0,
    36.0 });
  scenes.push_back({ "OrientedVolume", "TestGPURayCastOrientedVolume", Reference::Fixed,
    [](Stage& s) { s.ShowSolidEngine(); },
    [](Stage& s, bool on) {
      s.Volume->SetOrientation(0.0, 0.0, 0.0);
      if (on)
      {
        s.Volume->RotateWXYZ(50.0, 1.0, 0.4, 0.8);
      }
    },
    1.0, 2.0, 28.0 });
  scenes.push_back({ "LightComponents", "TestFixedPointRayCastLightComponents", Reference::Gpu,
    [](Stage& s) {
      s.ShowSolidEngine();
      s.SetShading(0.1, 0.7, 0.2, 10.0);
    },
    [](Stage& s, bool on) {
      s.SetShading(on ? 0.3 : 0.1, on ? 0.3 : 0.7, on ? 0.9 : 0.2, on ? 40.0 : 10.0);
    },
    2.5, 16.0, 29.0 });
  scenes.push_back({ "PositionalLights", "TestGPURayCastPositionalLights", Reference::Gpu,
    [](Stage& s) {
      s.ShowSolidEngine();
      // Without highlights: the half vector of VTK's GPU mapper is wrong for positional lights.
      s.SetShading(0.1, 0.8, 0.0, 20.0);
    },
    SetPositionalLights, 3.0, 25.0, 22.0 });
  scenes.push_back({ "LargeColourFunction", "TestGPURayCastLargeColorTransferFunction",
    Reference::Gpu,
    [](Stage& s) {
      s.ShowHead();
    },
    [](Stage& s, bool on) {
      // Thousands of points, a few scalars apart; without: its first and last.
      vtkNew<vtkColorTransferFunction> colour;
      const int points = on ? 1500 : 2;
      for (int i = 0; i < points; ++i)
      {
        const double x = static_cast<double>(i) / (points - 1);
        colour->AddRGBPoint(400.0 + 2000.0 * x, 0.5 + 0.5 * std::sin(20.0 * x),
          0.5 + 0.5 * std::cos(12.0 * x), 1.0 - x);
      }
      s.Property->SetColor(colour);
    },
    2.0, 10.0, 30.0 });
  scenes.push_back({ "MixedGeometry", "TestGPURayCastVolumePolyData", Reference::Gpu,
    [](Stage& s) {
      s.ShowEngine();
      AddSphere(s);
    },
    [](Stage& s, bool on) { s.Actor->SetVisibility(on ? 1 : 0); }, 1.0, 6.0, 35.0 });
  scenes.push_back({ "ImageSampleDistance", "TestGPURayCastImageSampleXY", Reference::Gpu,
    [](Stage& s) { s.ShowEngine(); },
    [](Stage& s, bool on) {
      s.Ours->SetImageSampleDistance(on ? 6.0 : 1.0);
      s.Gpu->SetImageSampleDistance(on ? 6.0f : 1.0f);
    },
    // The grids of rays are not the same: what is compared is the coarseness.
    8.0, 35.0, 28.0, 5.0 });
  return scenes;
}

//------------------------------------------------------------------------------
void SavePicture(const ffdTest::Picture& picture, const std::string& file)
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(picture.Width, picture.Height, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  std::copy(picture.Rgb.begin(), picture.Rgb.end(),
    static_cast<unsigned char*>(image->GetScalarPointer()));
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName(file.c_str());
  writer->Write();
}

int Run(const SceneTest& test, int argc, char* argv[])
{
  ffdTest::Checks checks;
  Stage stage(argc, argv);
  const std::string folder = ffdTest::FindArgument(argc, argv, "-T");
  test.SetUp(stage);
  const auto look = [&] {
    double bounds[6];
    stage.Volume->SetMapper(stage.Fixed);
    std::copy_n(stage.Volume->GetBounds(), 6, bounds);
    stage.SetCamera(stage.Camera, bounds);
  };

  look(); // lights may stand at the camera
  test.Feature(stage, false);
  look();
  const ffdTest::Picture without = stage.Render(stage.Ours);
  const ffdTest::Picture theirsWithout = RenderReference(stage, test);
  test.Feature(stage, true);
  look();
  const ffdTest::Picture with = stage.Render(stage.Ours);
  const ffdTest::Picture theirs = RenderReference(stage, test);
  SavePicture(with, folder + "/Scene." + test.Name + ".ours.png");
  SavePicture(theirs, folder + "/Scene." + test.Name + ".vtk.png");

  const ffdTest::Distance apart = stage.Compare(with, theirs);
  std::ostringstream figures;
  figures << apart << " (mean at most " << test.Mean << ", p99 " << test.P99 << ")";
  checks.Expect(apart.Pixels > 3000 && apart.Mean <= test.Mean && apart.P99 <= test.P99,
    test.Name + " against VTK's mapper", figures.str());
  checks.ExpectAtLeast(test.Name + ", what the feature changes, ours",
    stage.Compare(with, without).Mean, test.Difference);
  checks.ExpectAtLeast(test.Name + ", what the feature changes, VTK's",
    stage.Compare(theirs, theirsWithout).Mean, test.Difference);

  double bounds[6];
  stage.Image->GetBounds(bounds);
  stage.Ours->SetDeformation(ffdTest::MakeTransform(bounds, 6,
    [](const ffdTest::Vec3&, const ffdTest::Vec3&) { return ffdTest::Vec3{ 0.0, 0.0, 0.0 }; }));
  const ffdTest::Distance zeros = stage.Compare(stage.Render(stage.Ours), with);
  checks.Expect(zeros.Mean <= 0.02 && zeros.P99 <= 1.0, test.Name + ", a lattice of zeros",
    ffdTest::ToString(zeros) + " (mean at most 0.02, p99 1)");

  const double size =
    std::min({ bounds[1] - bounds[0], bounds[3] - bounds[2], bounds[5] - bounds[4] });
  const Deformation bend =
    ffdTest::MakeTransform(bounds, 8, ffdTest::BendAndWaves(0.18 * size));
  stage.Ours->SetDeformation(bend);
  const ffdTest::Picture deformed = stage.Render(stage.Ours);
  SavePicture(deformed, folder + "/Scene." + test.Name + ".deformed.png");
  checks.ExpectAtLeast(test.Name + ", what the deformation changes",
    stage.Compare(deformed, with).Mean, 3.0);
  test.Feature(stage, false);
  look();
  const ffdTest::Picture deformedWithout = stage.Render(stage.Ours);
  test.Feature(stage, true);
  look();
  checks.ExpectAtLeast(test.Name + ", what the feature changes, deformed",
    stage.Compare(deformed, deformedWithout).Mean, test.Difference);
  if (test.Decibels > 0.0)
  {
    double spacing[3];
    stage.Image->GetSpacing(spacing);
    vtkNew<vtkFFDResampleVolume> resample;
    resample->SetInputData(stage.Image);
    resample->SetDeformation(bend);
    resample->SetOutputSpacing(0.5 * spacing[0], 0.5 * spacing[1], 0.5 * spacing[2]);
    resample->SetBackgroundLevel(stage.Background);
    resample->Update();
    stage.Fixed->SetInputData(resample->GetOutput());
    stage.Gpu->SetInputData(resample->GetOutput());
    const ffdTest::Picture resampled = RenderReference(stage, test);
    SavePicture(resampled, folder + "/Scene." + test.Name + ".resampled.png");
    const ffdTest::Distance distance = stage.Compare(deformed, resampled);
    std::ostringstream text;
    text << distance << " (at least " << test.Decibels << " dB)";
    checks.Expect(distance.Pixels > 3000 && distance.Psnr >= test.Decibels,
      test.Name + ", deformed against the resampled volume", text.str());
  }
  return checks.Result();
}

} // namespace

int TestVTKScenes(int argc, char* argv[])
{
  const std::string name = ffdTest::FindArgument(argc, argv, "--scene");
  std::set<std::string> here;
  for (const SceneTest& test : Scenes())
  {
    if (test.Name == name)
    {
      return Run(test, argc, argv);
    }
    if (!here.insert(test.Name).second)
    {
      std::cerr << "There are two scenes " << test.Name << ".\n";
      return EXIT_FAILURE;
    }
  }
  if (!name.empty())
  {
    std::cerr << "There is no scene " << name << ".\n";
    return EXIT_FAILURE;
  }
  std::set<std::string> registered;
  bool listed = false;
  for (int i = 1; i < argc; ++i)
  {
    const std::string argument = argv[i];
    listed = argument == "--registered" || (listed && argument[0] != '-');
    if (listed && argument[0] != '-')
    {
      registered.insert(argument);
    }
  }
  for (const std::string& each : here)
  {
    if (registered.count(each) == 0)
    {
      std::cerr << "The scene " << each << " is not in CMakeLists.txt.\n";
    }
  }
  return here == registered ? EXIT_SUCCESS : EXIT_FAILURE;
}
