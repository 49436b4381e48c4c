// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Longer than other files, because it is a list: one function for each scene of VTK's own volume
// tests.
// The scenes of VTK's own tests of ray-cast volume mappers (Rendering/Volume/Testing and
// Rendering/VolumeOpenGL2/Testing), on the data of Testing/Data. Each is rendered four times:
// - without deformation it is that of VTK's mapper in the same process, within the tolerances of
//   the scene, and no less with a lattice of zeros;
// - without the feature that the scene is about it is another picture, in ours as in VTK's;
// - deformed it is that of the volume resampled by vtkFFDResampleVolume at half the spacing,
//   rendered by VTK's mapper, as far as resampling allows (decibels), and not that of the
//   undeformed volume.
//
// A scene is an entry of the list in Scenes() and a line in CMakeLists.txt. Without "--scene NAME"
// the test checks that the two name the same scenes.
#include "FFDTestScenes.h"

#include "vtkActor.h"
#include "vtkCellData.h"
#include "vtkContourValues.h"
#include "vtkFFDResampleVolume.h"
#include "vtkFloatArray.h"
#include "vtkImageCast.h"
#include "vtkLightKit.h"
#include "vtkPlane.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRectilinearGrid.h"
#include "vtkSphereSource.h"

#include <algorithm>
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
  void ShowHead() { this->Show(this->Read("headsq", 1, 0.0), ffdTest::HeadsqSkin(), 2.0, 0.0); }

  void ShowSoftHead() { this->Show(this->Read("headsq", 1, 0.0), ffdTest::HeadsqSoft(), 2.0, 0.0); }

  /// Colors and opacities that suit one scalar a ray.
  void SetTransferOfMaximum()
  {
    ffdTest::SetTransfer(this->Property,
      { { 0, 0.0, 0.0, 0.0, 0.0 }, { 800, 0.2, 0.4, 0.8, 0.4 }, { 1500, 0.9, 0.7, 0.3, 0.8 },
        { 3000, 1.0, 1.0, 1.0, 1.0 } },
      2.0);
  }

  /// As many transparent voxels around an image as make it a cube.
  static vtkSmartPointer<vtkImageData> MakeCube(vtkImageData* image)
  {
    int dims[3];
    image->GetDimensions(dims);
    const int side = std::max({ dims[0], dims[1], dims[2] });
    int extent[6];
    for (int a = 0; a < 3; ++a)
    {
      extent[2 * a] = -((side - dims[a]) / 2);
      extent[2 * a + 1] = extent[2 * a] + side - 1;
    }
    vtkNew<vtkImageConstantPad> pad;
    pad->SetInputData(image);
    pad->SetOutputWholeExtent(extent);
    vtkNew<vtkImageChangeInformation> shift;
    shift->SetInputConnection(pad->GetOutputPort());
    shift->SetOutputExtentStart(0, 0, 0);
    shift->Update();
    return shift->GetOutput();
  }

  /// The same to each of the three mappers.
  void All(const std::function<void(vtkVolumeMapper*)>& change)
  {
    change(this->Ours);
    change(this->Fixed);
    change(this->Gpu);
  }

  /// Two functions of the head: its scalars, and a wave that rises along z.
  vtkSmartPointer<vtkImageData> MakeTwoComponents(bool bytes)
  {
    vtkSmartPointer<vtkImageData> head = this->Read("headsq", 1, 0.0);
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->CopyStructure(head);
    image->AllocateScalars(bytes ? VTK_UNSIGNED_CHAR : VTK_FLOAT, 2);
    int dims[3];
    image->GetDimensions(dims);
    for (int k = 0; k < dims[2]; ++k)
    {
      for (int j = 0; j < dims[1]; ++j)
      {
        for (int i = 0; i < dims[0]; ++i)
        {
          const double value = head->GetScalarComponentAsDouble(i, j, k, 0);
          const double wave = 127.0 + 100.0 * std::sin(0.12 * k + 0.07 * i);
          image->SetScalarComponentFromDouble(i, j, k, 0, bytes ? wave : value);
          image->SetScalarComponentFromDouble(
            i, j, k, 1, bytes ? std::min(255.0, std::max(0.0, value / 8.0)) : wave);
        }
      }
    }
    return image;
  }

  /// Bytes: three waves, and the head.
  vtkSmartPointer<vtkImageData> MakeFourComponents()
  {
    vtkSmartPointer<vtkImageData> head = this->Read("headsq", 1, 0.0);
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->CopyStructure(head);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 4);
    int dims[3];
    image->GetDimensions(dims);
    for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
    {
      const double at[3] = { static_cast<double>(i % dims[0]),
        static_cast<double>(i / dims[0] % dims[1]), static_cast<double>(i / (dims[0] * dims[1])) };
      for (int c = 0; c < 3; ++c)
      {
        image->GetPointData()->GetScalars()->SetComponent(
          i, c, std::floor(127.0 + 100.0 * std::sin(0.12 * at[c] + 0.07 * at[(c + 1) % 3])));
      }
      image->GetPointData()->GetScalars()->SetComponent(i, 3,
        std::floor(
          std::min(255.0, std::max(0.0, head->GetPointData()->GetScalars()->GetTuple1(i) / 8.0))));
    }
    return image;
  }

  void Look(const ffdTest::View& view) { this->Camera = view; }

  int Argc;
  char** Argv;
  vtkSmartPointer<vtkImageData> Image;
  vtkSmartPointer<vtkImageData> Source; // what is resampled: else Image
  double SourceFactor = 0.5;            // spacing of the resampled, in that of the source
  double Background = 0.0;              // a transparent scalar
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
  double Decibels;         // deformed, from the resampled volume; 0: not compared
  double Difference = 2.0; // that the feature makes, mean, at least
  /// What masks are at rest, by index coordinates, for a mask of the resampled volume.
  std::function<double(const double index[3])> Mask{};
  /// What else the resampled volume takes, whose voxels are half as long.
  std::function<void(Stage&)> Halve{};
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
  sphere->SetCenter(
    b[0] + 0.4 * (b[1] - b[0]), b[2] + 0.45 * (b[3] - b[2]), b[4] + 0.6 * (b[5] - b[4]));
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
  // the only one of VTK's that knows positional lights, takes direction and distance of a light
  // from where the ray enters the volume.
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
/// The image with ghosts where `hidden` says so.
vtkSmartPointer<vtkImageData> Blanked(
  vtkImageData* image, bool cells, const std::function<bool(const int index[3])>& hidden)
{
  auto blanked = vtkSmartPointer<vtkImageData>::New();
  blanked->ShallowCopy(image);
  vtkNew<vtkUnsignedCharArray> ghosts;
  ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
  ghosts->SetNumberOfTuples(cells ? blanked->GetNumberOfCells() : blanked->GetNumberOfPoints());
  int dims[3];
  blanked->GetDimensions(dims);
  for (int a = 0; cells && a < 3; ++a)
  {
    --dims[a];
  }
  for (vtkIdType i = 0; i < ghosts->GetNumberOfTuples(); ++i)
  {
    const int index[3] = { static_cast<int>(i % dims[0]), static_cast<int>(i / dims[0] % dims[1]),
      static_cast<int>(i / (dims[0] * dims[1])) };
    const int ghost = cells ? static_cast<int>(vtkDataSetAttributes::HIDDENCELL)
                            : static_cast<int>(vtkDataSetAttributes::HIDDENPOINT);
    ghosts->SetValue(i, static_cast<unsigned char>(hidden(index) ? ghost : 0));
  }
  if (cells)
  {
    blanked->GetCellData()->AddArray(ghosts);
  }
  else
  {
    blanked->GetPointData()->AddArray(ghosts);
  }
  return blanked;
}

/// Magnitudes of gradients are per voxel: of voxels half as long they are half of these.
void SetGradientOpacity(Stage& stage, double nothing, double all)
{
  vtkNew<vtkPiecewiseFunction> gradient;
  gradient->AddPoint(0.0, 0.0);
  gradient->AddPoint(nothing, 0.0);
  gradient->AddPoint(all, 1.0);
  stage.Property->SetGradientOpacity(gradient);
}

/// A mask of the image with these values, by columns and slices of voxels; or none.
void SetMask(Stage& stage, bool on, const std::function<double(int x, int z)>& value)
{
  auto mask = vtkSmartPointer<vtkImageData>::New();
  mask->CopyStructure(stage.Image);
  mask->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  int dims[3];
  mask->GetDimensions(dims);
  for (vtkIdType i = 0; i < mask->GetNumberOfPoints(); ++i)
  {
    const int x = static_cast<int>(i % dims[0]);
    const int z = static_cast<int>(i / (dims[0] * dims[1]));
    mask->GetPointData()->GetScalars()->SetTuple1(i, value(x, z));
  }
  stage.Ours->SetMaskInput(on ? mask.Get() : nullptr);
  stage.Gpu->SetMaskInput(on ? mask.Get() : nullptr);
  stage.Kept.push_back(mask);
}

/// Scalars of the image at points whose distances grow and shrink along each axis, in its bounds.
class UnevenGrid
{
public:
  explicit UnevenGrid(vtkImageData* image)
  {
    int dims[3];
    double origin[3];
    double spacing[3];
    image->GetDimensions(dims);
    image->GetOrigin(origin);
    image->GetSpacing(spacing);
    this->Grid->SetDimensions(dims);
    vtkNew<vtkDoubleArray> coordinates[3];
    for (int a = 0; a < 3; ++a)
    {
      for (int i = 0; i < dims[a]; ++i)
      {
        coordinates[a]->InsertNextValue(origin[a] + spacing[a] * Warp(i, dims[a] - 1));
      }
    }
    this->Grid->SetXCoordinates(coordinates[0]);
    this->Grid->SetYCoordinates(coordinates[1]);
    this->Grid->SetZCoordinates(coordinates[2]);
    this->Grid->GetPointData()->SetScalars(image->GetPointData()->GetScalars());

    // The same twice as fine on an even grid.
    this->Even->SetOrigin(origin);
    this->Even->SetSpacing(0.5 * spacing[0], 0.5 * spacing[1], 0.5 * spacing[2]);
    int fine[3];
    for (int a = 0; a < 3; ++a)
    {
      fine[a] = 2 * dims[a] - 1;
    }
    this->Even->SetDimensions(fine);
    this->Even->AllocateScalars(VTK_FLOAT, 1);
    auto* out = static_cast<float*>(this->Even->GetScalarPointer());
    std::vector<double> at[3];
    for (int a = 0; a < 3; ++a)
    {
      for (int i = 0; i < fine[a]; ++i)
      {
        at[a].push_back(Find(0.5 * i, dims[a] - 1));
      }
    }
    vtkDataArray* scalars = image->GetPointData()->GetScalars();
    for (int k = 0; k < fine[2]; ++k)
    {
      for (int j = 0; j < fine[1]; ++j)
      {
        for (int i = 0; i < fine[0]; ++i)
        {
          const double p[3] = { at[0][static_cast<std::size_t>(i)],
            at[1][static_cast<std::size_t>(j)], at[2][static_cast<std::size_t>(k)] };
          double value = 0.0;
          for (int corner = 0; corner < 8; ++corner)
          {
            double weight = 1.0;
            int v[3];
            for (int a = 0; a < 3; ++a)
            {
              const int cell = std::min(static_cast<int>(p[a]), dims[a] - 2);
              const bool upper = (corner >> a & 1) != 0;
              weight *= upper ? p[a] - cell : 1.0 - (p[a] - cell);
              v[a] = cell + (upper ? 1 : 0);
            }
            value += weight * scalars->GetTuple1((v[2] * dims[1] + v[1]) * dims[0] + v[0]);
          }
          *out++ = static_cast<float>(value);
        }
      }
    }
  }
  vtkNew<vtkRectilinearGrid> Grid;
  vtkNew<vtkImageData> Even;

private:
  static double Warp(int i, int last)
  {
    const double x = static_cast<double>(i) / last;
    return last * (x + 0.05 * std::sin(2.0 * vtkMath::Pi() * x));
  }
  /// The index, with its fraction, of a position.
  static double Find(double position, int last)
  {
    int i = 0;
    while (i < last - 1 && Warp(i + 1, last) <= position)
    {
      ++i;
    }
    const double low = Warp(i, last);
    return std::min<double>(last, i + std::max(0.0, (position - low) / (Warp(i + 1, last) - low)));
  }
};

//------------------------------------------------------------------------------
std::vector<SceneTest> Scenes()
{
  const ffdTest::View oblique = { 30.0, 25.0, 1.0, false, false };
  const ffdTest::View parallel = { 30.0, 25.0, 1.0, true, false };
  std::vector<SceneTest> scenes;

  scenes.push_back({ "Perspective", "TestGPURayCastPerspectiveParallel", Reference::Gpu,
    [](Stage& s) { s.ShowEngine(); }, [=](Stage& s, bool on) { s.Look(on ? oblique : parallel); },
    1.0, 2.0, 36.0 });
  scenes.push_back({ "Parallel", "TestGPURayCastPerspectiveParallel", Reference::Gpu,
    [](Stage& s) { s.ShowEngine(); }, [=](Stage& s, bool on) { s.Look(on ? parallel : oblique); },
    1.0, 2.0, 36.0 });
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
    2.0, 5.0, 30.0 });
  scenes.push_back({ "SmallSpacing", "TestGPURayCastCameraInsideSmallSpacing", Reference::Gpu,
    [](Stage& s) {
      vtkSmartPointer<vtkImageData> head = s.Read("headsq", 1, 0.0);
      head->SetSpacing(0.0032, 0.0032, 0.0015);
      s.Show(head, ffdTest::HeadsqSkin(), 0.002, 0.0);
    },
    // The opacity of a voxel must not depend on the unit that its edges are given in.
    [](Stage& s, bool on) { s.Property->SetScalarOpacityUnitDistance(on ? 0.002 : 2.0); }, 1.0, 4.0,
    36.0 });
  scenes.push_back({ "OrientedVolume", "TestGPURayCastOrientedVolume", Reference::Gpu,
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
      s.SetShadingAsGpuMapper(0.1, 0.7, 0.2, 10.0);
    },
    [](Stage& s, bool on) {
      s.SetShadingAsGpuMapper(on ? 0.3 : 0.1, on ? 0.3 : 0.7, on ? 0.9 : 0.2, on ? 40.0 : 10.0);
    },
    2.5, 16.0, 29.0 });
  scenes.push_back({ "PositionalLights", "TestGPURayCastPositionalLights", Reference::Gpu,
    [](Stage& s) {
      // In a cube: VTK's GPU mapper divides gradients by the spacing and then takes them through a
      // matrix from texture coordinates, so for all lights but a single headlight its normals are
      // wrong by the proportions of the volume (mean 8.9 on the engine itself).
      s.Show(s.MakeCube(s.Read("engine", 2, 0.0)), ffdTest::SolidEngine(), 2.0, 0.0);
      // Without highlights: the half vector of VTK's GPU mapper is wrong for positional lights.
      s.SetShadingAsGpuMapper(0.1, 0.8, 0.0, 20.0);
    },
    SetPositionalLights, 2.0, 12.0, 25.0 });
  scenes.push_back({ "LargeColorFunction", "TestGPURayCastLargeColorTransferFunction",
    Reference::Gpu, [](Stage& s) { s.ShowHead(); },
    [](Stage& s, bool on) {
      // Thousands of points, a few scalars apart; without: its first and last.
      vtkNew<vtkColorTransferFunction> color;
      const int points = on ? 1500 : 2;
      for (int i = 0; i < points; ++i)
      {
        const double x = static_cast<double>(i) / (points - 1);
        color->AddRGBPoint(400.0 + 2000.0 * x, 0.5 + 0.5 * std::sin(20.0 * x),
          0.5 + 0.5 * std::cos(12.0 * x), 1.0 - x);
      }
      s.Property->SetColor(color);
    },
    2.0, 10.0, 30.0 });
  scenes.push_back({ "MixedGeometry", "TestGPURayCastVolumePolyData", Reference::Gpu,
    [](Stage& s) {
      s.ShowEngine();
      AddSphere(s);
    },
    [](Stage& s, bool on) { s.Actor->SetVisibility(on ? 1 : 0); }, 1.0, 6.0, 35.0 });
  scenes.push_back({ "ImageSampleDistance", "TestGPURayCastImageSampleXY", Reference::Gpu,
    [](Stage& s) {
      s.ShowEngine();
      s.Window->SetSize(200, 200); // the distance is one in pixels
    },
    [](Stage& s, bool on) {
      s.Ours->SetImageSampleDistance(on ? 6.0 : 1.0);
      s.Gpu->SetImageSampleDistance(on ? 6.0f : 1.0f);
    },
    // The grids of rays are not the same: what is compared is the coarseness.
    8.0, 35.0, 28.0, 5.0 });

  // Blend modes: what a composited picture would be is the picture without.
  const auto blend = [&](const std::string& name, const std::string& origin, int mode,
                       Reference with, double mean, double p99, double decibels) {
    scenes.push_back({ name, origin, with,
      [mode](Stage& s) {
        s.ShowHead();
        if (mode == vtkVolumeMapper::MINIMUM_INTENSITY_BLEND)
        {
          // The least along every ray through the head would be the air: turn it around.
          vtkDataArray* scalars = s.Image->GetPointData()->GetScalars();
          for (vtkIdType i = 0; i < scalars->GetNumberOfTuples(); ++i)
          {
            scalars->SetTuple1(i, std::max(0.0, 3000.0 - scalars->GetTuple1(i)));
          }
        }
        s.SetTransferOfMaximum();
        if (mode == vtkVolumeMapper::MINIMUM_INTENSITY_BLEND)
        {
          // What is around the resampled volume is the most, and transparent.
          s.Background = 3000.0;
          s.Property->GetScalarOpacity()->AddPoint(2900.0, 1.0);
          s.Property->GetScalarOpacity()->AddPoint(3000.0, 0.0);
        }
        if (mode == vtkVolumeMapper::ADDITIVE_BLEND)
        {
          // Rays through the box of the volume cover the background, and a resampled box is larger.
          s.Renderer->SetBackground(0.0, 0.0, 0.0);
        }
      },
      [mode](Stage& s, bool on) {
        s.All([&](vtkVolumeMapper* m) {
          m->SetBlendMode(on ? mode : static_cast<int>(vtkVolumeMapper::COMPOSITE_BLEND));
          m->SetAverageIPScalarRange(200.0, 3000.0);
        });
      },
      mean, p99, decibels });
  };
  blend("MaximumIntensity", "TestGPURayCastDataTypesMIP", vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND,
    Reference::Gpu, 1.0, 2.0, 33.0);
  blend("MinimumIntensity", "TestGPURayCastDataTypesMinIP",
    vtkVolumeMapper::MINIMUM_INTENSITY_BLEND, Reference::Gpu, 1.6, 12.0, 31.0);
  blend("AverageIntensity", "TestGPURayCastAverageIP", vtkVolumeMapper::AVERAGE_INTENSITY_BLEND,
    Reference::Gpu, 0.5, 4.0, 33.0);
  blend("Additive", "TestGPURayCastAdditive", vtkVolumeMapper::ADDITIVE_BLEND, Reference::Gpu, 0.5,
    4.0, 40.0);
  scenes.push_back({ "IsoSurface", "TestGPURayCastIsosurface", Reference::Gpu,
    [](Stage& s) {
      s.ShowHead();
      s.SetShadingAsGpuMapper(0.1, 0.7, 0.2, 10.0);
      s.Property->GetIsoSurfaceValues()->SetValue(0, 700.0);
    },
    [](Stage& s, bool on) {
      s.All([&](vtkVolumeMapper* m) {
        m->SetBlendMode(on ? vtkVolumeMapper::ISOSURFACE_BLEND : vtkVolumeMapper::COMPOSITE_BLEND);
      });
    },
    3.0, 22.0, 29.0 });

  // Cropping of deformed space: that of the resampled volume.
  const auto crop = [&](const std::string& name, int flags) {
    scenes.push_back({ name, "TestGPURayCastCropping", Reference::Fixed,
      [flags](Stage& s) {
        s.ShowEngine();
        s.SetSampleDistance(0.4 * s.Image->GetSpacing()[0]); // samples lie elsewhere
        const double* b = s.Image->GetBounds();
        s.Ours->SetCroppingSpaceToDeformed();
        s.All([&](vtkVolumeMapper* m) {
          m->SetCroppingRegionPlanes(b[0] + 0.3 * (b[1] - b[0]), b[0] + 0.7 * (b[1] - b[0]),
            b[2] + 0.25 * (b[3] - b[2]), b[2] + 0.6 * (b[3] - b[2]), b[4] + 0.3 * (b[5] - b[4]),
            b[4] + 0.8 * (b[5] - b[4]));
          m->SetCroppingRegionFlags(flags);
        });
      },
      [](Stage& s, bool on) { s.All([&](vtkVolumeMapper* m) { m->SetCropping(on ? 1 : 0); }); },
      1.0, 5.0, 30.0 });
  };
  crop("CroppingSubVolume", VTK_CROP_SUBVOLUME);
  crop("CroppingFence", VTK_CROP_FENCE);
  crop("CroppingInvertedCross", VTK_CROP_INVERTED_CROSS);
  scenes.push_back({ "Clipping", "TestGPURayCastClipping", Reference::Fixed,
    [](Stage& s) {
      s.ShowEngine();
      s.SetSampleDistance(0.4 * s.Image->GetSpacing()[0]); // samples lie elsewhere
    },
    [](Stage& s, bool on) {
      const double* b = s.Image->GetBounds();
      s.All([&](vtkVolumeMapper* m) {
        m->RemoveAllClippingPlanes();
        for (int i = 0; on && i < 2; ++i)
        {
          vtkNew<vtkPlane> plane;
          plane->SetOrigin(0.5 * (b[0] + b[1]), 0.5 * (b[2] + b[3]), 0.6 * (b[4] + b[5]));
          plane->SetNormal(i ? -0.7 : 0.3, i ? 0.2 : 1.0, i ? -0.3 : -0.4);
          m->AddClippingPlane(plane);
        }
      });
    },
    1.0, 3.0, 36.0 });
  scenes.push_back({ "FinalColorWindowLevel", "TestFinalColorWindowLevel", Reference::Gpu,
    [](Stage& s) { s.ShowEngine(); },
    [](Stage& s, bool on) {
      s.Ours->SetFinalColorWindow(on ? 0.5 : 1.0);
      s.Ours->SetFinalColorLevel(on ? 0.65 : 0.5);
      s.Gpu->SetFinalColorWindow(on ? 0.5f : 1.0f);
      s.Gpu->SetFinalColorLevel(on ? 0.65f : 0.5f);
    },
    1.5, 8.0, 34.0 });

  // Functions.
  scenes.push_back({ "GradientOpacity", "TestGPURayCastGradientOpacity", Reference::Gpu,
    [](Stage& s) { s.ShowHead(); },
    [](Stage& s, bool on) {
      vtkNew<vtkPiecewiseFunction> gradient;
      gradient->AddPoint(0.0, on ? 0.0 : 1.0);
      gradient->AddPoint(50.0, on ? 0.0 : 1.0);
      gradient->AddPoint(250.0, 1.0);
      s.Property->SetGradientOpacity(gradient);
      s.Property->SetDisableGradientOpacity(on ? 0 : 1);
    },
    // Deformed: ours are the gradients of the volume at rest.
    1.0, 4.0, 36.0 });
  scenes.back().Halve = [](Stage& s) { SetGradientOpacity(s, 25.0, 125.0); };
  // VTK's mappers differ with weights w: from opacities a that of a sample is sum((a w)^2) / sum(a
  // w) in the fixed-point one, sum(a^2) / sum(a w) in the GPU mapper, which is the more opaque the
  // less the weights are. TestComponents measures that in a uniform volume. Ours does as the first.
  scenes.push_back(
    { "TwoComponentsIndependent", "TestGPURayCastTwoComponentsIndependent", Reference::Fixed,
      [](Stage& s) {
        s.Show(s.MakeTwoComponents(false), ffdTest::HeadsqSkin(), 2.0, 0.0);
        vtkNew<vtkColorTransferFunction> color;
        color->AddRGBPoint(0.0, 0.0, 0.0, 1.0);
        color->AddRGBPoint(227.0, 1.0, 0.2, 0.0);
        vtkNew<vtkPiecewiseFunction> opacity;
        opacity->AddPoint(20.0, 0.0);
        opacity->AddPoint(227.0, 0.7);
        s.Property->SetColor(1, color);
        s.Property->SetScalarOpacity(1, opacity);
        s.Property->SetScalarOpacityUnitDistance(1, 2.0);
        s.Property->IndependentComponentsOn();
      },
      [](Stage& s, bool on) {
        s.Property->SetComponentWeight(0, on ? 0.5 : 1.0);
        s.Property->SetComponentWeight(1, on ? 0.5 : 0.0);
      },
      4.0, 30.0, 24.0 });
  scenes.push_back(
    { "TwoComponentsDependent", "TestGPURayCastTwoComponentsDependent", Reference::Gpu,
      [](Stage& s) {
        s.Show(s.MakeTwoComponents(true),
          { { 0, 0.0, 0.0, 1.0, 0.0 }, { 80, 0.0, 0.0, 1.0, 0.0 }, { 130, 0.2, 1.0, 0.3, 0.6 },
            { 227, 1.0, 0.2, 0.0, 0.9 } },
          2.0, 0.0);
        s.Property->IndependentComponentsOff();
        // The GPU mapper takes the opacity function of component 0 with the unit distance of the
        // last one: see TestComponents.
        s.Property->SetScalarOpacityUnitDistance(1, 2.0);
      },
      [](Stage& s, bool on) {
        // Without: one color.
        vtkNew<vtkColorTransferFunction> color;
        color->AddRGBPoint(0.0, on ? 0.0 : 0.5, on ? 0.0 : 0.5, on ? 1.0 : 0.5);
        color->AddRGBPoint(227.0, on ? 1.0 : 0.5, on ? 0.2 : 0.5, on ? 0.0 : 0.5);
        s.Property->SetColor(color);
      },
      1.0, 5.0, 39.0 });

  // What hides voxels. The mask is one of the material: it moves with it, not with the resampled.
  scenes.push_back({ "BinaryMask", "TestGPURayCastCompositeBinaryMask", Reference::Gpu,
    [](Stage& s) { s.ShowHead(); },
    [](Stage& s, bool on) {
      SetMask(s, on, [](int x, int z) { return x > 30 || z > 60 ? 255.0 : 0.0; });
      s.Ours->SetMaskTypeToBinary();
      s.Gpu->SetMaskTypeToBinary();
    },
    1.0, 8.0, 36.0 });
  scenes.back().Mask = [](const double p[3]) { return p[0] > 30.5 || p[2] > 60.5 ? 255.0 : 0.0; };
  scenes.push_back(
    { "GradientOpacityBinaryMask", "TestGPURayCastCompositeBinaryMask1", Reference::Gpu,
      [](Stage& s) {
        s.ShowHead();
        SetGradientOpacity(s, 50.0, 250.0);
      },
      scenes.back().Feature, 1.0, 8.0, 34.0 });
  scenes.back().Halve = [](Stage& s) { SetGradientOpacity(s, 25.0, 125.0); };
  scenes.back().Mask = scenes[scenes.size() - 2].Mask;
  scenes.push_back({ "CellData", "TestGPURayCastCellData", Reference::Gpu,
    [](Stage& s) {
      vtkSmartPointer<vtkImageData> head = s.Read("headsq", 1, 0.0);
      int dims[3];
      head->GetDimensions(dims);
      auto cells = vtkSmartPointer<vtkImageData>::New();
      cells->SetDimensions(dims[0] + 1, dims[1] + 1, dims[2] + 1);
      cells->SetSpacing(head->GetSpacing());
      vtkNew<vtkFloatArray> shifted;
      shifted->DeepCopy(head->GetPointData()->GetScalars());
      shifted->SetName("cells");
      cells->GetCellData()->SetScalars(shifted);
      // Another picture without: the points have the scalars of half the head.
      cells->AllocateScalars(VTK_FLOAT, 1);
      for (vtkIdType i = 0; i < cells->GetNumberOfPoints(); ++i)
      {
        const int x = static_cast<int>(i % (dims[0] + 1));
        cells->GetPointData()->GetScalars()->SetTuple1(i, x > 20 && x < 50 ? 900.0 : 0.0);
      }
      cells->GetPointData()->GetScalars()->SetName("points");
      s.Show(cells, ffdTest::HeadsqSkin(), 2.0, 0.0);
      // Points in the middles of the cells.
      s.Source = vtkSmartPointer<vtkImageData>::New();
      s.Source->ShallowCopy(head);
      const double* spacing = head->GetSpacing();
      s.Source->SetOrigin(0.5 * spacing[0], 0.5 * spacing[1], 0.5 * spacing[2]);
    },
    [](Stage& s, bool on) {
      s.All([&](vtkVolumeMapper* m) {
        if (on)
        {
          m->SetScalarModeToUseCellData();
        }
        else
        {
          m->SetScalarModeToUsePointData();
        }
      });
      s.Property->Modified();
    },
    1.0, 4.0, 40.0 });
  scenes.push_back({ "PointBlanking", "TestGPURayCastVolumeGhostArrays", Reference::Gpu,
    [](Stage& s) { s.ShowHead(); },
    [](Stage& s, bool on) {
      s.SetInput(on
          ? Blanked(s.Image, false, [](const int i[3]) { return i[0] <= 30 || i[2] >= 60; })
          : s.Image);
      s.Property->Modified();
    },
    1.0, 12.0, 30.0 });
  // Cells with a blanked point are empty.
  scenes.back().Mask = [](const double p[3]) { return p[0] > 31.0 && p[2] < 59.0 ? 255.0 : 0.0; };
  scenes.push_back({ "CellBlanking", "TestGPURayCastVolumeUniformGridBlanking", Reference::Gpu,
    [](Stage& s) { s.ShowHead(); },
    // The GPU mapper hides the cell before a blanked one, too: those that begin the volume are
    // blanked.
    [](Stage& s, bool on) {
      s.SetInput(on
          ? Blanked(s.Image, true, [](const int i[3]) { return i[0] <= 30 || i[1] <= 20; })
          : s.Image);
      s.Property->Modified();
    },
    1.2, 20.0, 29.0 });
  scenes.back().Mask = [](const double p[3]) { return p[0] > 31.0 && p[1] > 21.0 ? 255.0 : 0.0; };
  scenes.push_back({ "RectilinearGrid", "TestGPURayCastMapperRectilinearGrid", Reference::Gpu,
    [](Stage& s) { s.ShowHead(); },
    [](Stage& s, bool on) {
      s.SetInput(s.Image);
      s.Source = nullptr;
      if (on)
      {
        UnevenGrid uneven(s.Image);
        s.Ours->SetInputData(uneven.Grid);
        // As voxels of equal steps: the shader of the GPU mapper fetches those of rectilinear grids
        // half a voxel off, even where all steps are equal, and it does not survive an image
        // before.
        s.Gpu->SetInputData(uneven.Even);
        s.Source = uneven.Even;
        s.SourceFactor = 1.0;
      }
      s.Property->Modified();
    },
    2.0, 20.0, 32.0 });
  scenes.push_back({ "Jitter", "TestGPURayCastJittering", Reference::Gpu,
    [](Stage& s) {
      s.ShowHead();
      s.SetSampleDistance(2.0 * s.Voxel);
    },
    // The noise is not the same: what is compared is how much there is.
    [](Stage& s, bool on) {
      s.Ours->SetUseJittering(on);
      s.Gpu->SetUseJittering(on ? 1 : 0);
      s.Property->Modified();
    },
    6.0, 35.0, 31.0 });
  scenes.push_back(
    { "FourComponentsIndependent", "TestGPURayCastFourComponentsComposite", Reference::Fixed,
      [](Stage& s) {
        s.Show(s.MakeFourComponents(), { { 60, 0.2, 0.2, 1, 0.0 }, { 227, 0.2, 0.6, 1, 0.1 } }, 2.0,
          0.0);
        for (int c = 1; c < 4; ++c)
        {
          vtkNew<vtkColorTransferFunction> color;
          color->AddRGBPoint(60.0, c == 1 ? 1.0 : 0.2, c == 2 ? 1.0 : 0.2, c == 3 ? 1.0 : 0.0);
          color->AddRGBPoint(255.0, 1.0, c == 3 ? 0.9 : 0.4, c == 3 ? 0.8 : 0.1);
          vtkNew<vtkPiecewiseFunction> opacity;
          opacity->AddPoint(60.0 + 20.0 * c, 0.0);
          opacity->AddPoint(255.0, c == 3 ? 0.6 : 0.1);
          s.Property->SetColor(c, color);
          s.Property->SetScalarOpacity(c, opacity);
          s.Property->SetScalarOpacityUnitDistance(c, 2.0);
        }
        s.Property->IndependentComponentsOn();
      },
      [](Stage& s, bool on) {
        for (int c = 0; c < 4; ++c)
        {
          s.Property->SetComponentWeight(c, on ? (c == 3 ? 1.0 : 0.4) : (c == 0 ? 1.0 : 0.1));
        }
      },
      2.0, 8.0, 38.0 });
  scenes.push_back({ "LabelMap", "TestGPURayCastCompositeMask", Reference::Gpu,
    [](Stage& s) {
      s.ShowHead();
      // As long as samples: the GPU mapper takes the opacities of labels as they are, whatever the
      // unit distance (vtkOpenGLVolumeMaskTransferFunction2D); with 2 it is 14.4 apart.
      s.Property->SetScalarOpacityUnitDistance(s.Ours->GetSampleDistance());
      for (const int label : { 1, 2 })
      {
        vtkNew<vtkColorTransferFunction> color;
        color->AddRGBPoint(500.0, label == 1 ? 1.0 : 0.1, 0.3, label == 1 ? 0.0 : 1.0);
        color->AddRGBPoint(1400.0, label == 1 ? 1.0 : 0.2, 0.9, label == 1 ? 0.2 : 1.0);
        vtkNew<vtkPiecewiseFunction> opacity;
        opacity->AddPoint(label == 1 ? 500.0 : 900.0, 0.0);
        opacity->AddPoint(1400.0, 0.4);
        s.Property->SetLabelColor(label, color);
        s.Property->SetLabelScalarOpacity(label, opacity);
      }
    },
    [](Stage& s, bool on) {
      SetMask(s, on, [](int x, int z) { return x < 28 ? 1.0 : z > 50 ? 2.0 : 0.0; });
      s.Ours->SetMaskTypeToLabelMap();
      s.Gpu->SetMaskTypeToLabelMap();
      s.Property->Modified();
    },
    1.5, 10.0, 32.0 });
  scenes.back().Mask = [](const double p[3]) {
    return p[0] < 27.5 ? 1.0 : p[2] > 50.5 ? 2.0 : 0.0;
  };
  scenes.push_back({ "Slice", "TestGPURayCastSlicePlane", Reference::Gpu,
    [](Stage& s) {
      s.ShowHead();
      s.SetTransferOfMaximum();
      const double* b = s.Image->GetBounds();
      vtkNew<vtkPlane> plane;
      plane->SetOrigin(0.5 * (b[0] + b[1]), 0.5 * (b[2] + b[3]), 0.5 * (b[4] + b[5]));
      plane->SetNormal(0.3, -1.0, 0.4);
      s.Property->SetSliceFunction(plane);
    },
    [](Stage& s, bool on) {
      s.All([&](vtkVolumeMapper* m) {
        m->SetBlendMode(on ? vtkVolumeMapper::SLICE_BLEND : vtkVolumeMapper::COMPOSITE_BLEND);
      });
    },
    // The slices of the GPU mapper are half a voxel off: see TestSlice.
    6.0, 60.0, 32.0 });
  scenes.push_back({ "DirectionMatrix", "none", Reference::Gpu, [](Stage& s) { s.ShowEngine(); },
    [](Stage& s, bool on) {
      const double c = on ? std::cos(0.6) : 1.0;
      const double d = on ? std::sin(0.6) : 0.0;
      s.Image->SetDirectionMatrix(c, -d, 0.0, d, c, 0.0, 0.0, 0.0, 1.0);
    },
    1.0, 5.0, 0.0 });
  scenes.push_back({ "TransferFunction2D", "TestGPURayCastTransfer2D", Reference::Gpu,
    [](Stage& s) {
      s.ShowHead();
      // VTK's GPU mapper does not correct these functions for the sample distance.
      s.Property->SetScalarOpacityUnitDistance(s.Ours->GetSampleDistance());
      vtkNew<vtkImageData> plane;
      plane->SetDimensions(64, 64, 1);
      plane->AllocateScalars(VTK_FLOAT, 4);
      for (int j = 0; j < 64; ++j)
      {
        for (int i = 0; i < 64; ++i)
        {
          const double x = i / 63.0;
          const double y = j / 63.0;
          const double texel[4] = { 0.2 + 0.8 * x, 0.9 - 0.6 * y, y,
            0.3 * std::max(0.0, x - 0.15) * (0.2 + y) };
          for (int k = 0; k < 4; ++k)
          {
            plane->SetScalarComponentFromDouble(i, j, 0, k, texel[k]);
          }
        }
      }
      s.Property->SetTransferFunction2D(plane);
    },
    [](Stage& s, bool on) {
      s.Property->SetTransferFunctionMode(on ? vtkVolumeProperty::TF_2D : vtkVolumeProperty::TF_1D);
    },
    1.5, 4.0, 0.0 });
  scenes.push_back({ "LightKit", "TestGPURayCastVolumeLightKit", Reference::Gpu,
    [](Stage& s) {
      // A cube, without highlights: see PositionalLights.
      s.Show(s.MakeCube(s.Read("engine", 2, 0.0)), ffdTest::SolidEngine(), 2.0, 0.0);
      s.SetShadingAsGpuMapper(0.1, 0.8, 0.0, 20.0);
    },
    [](Stage& s, bool on) {
      s.Renderer->RemoveAllLights();
      if (on)
      {
        vtkNew<vtkLightKit> kit;
        kit->AddLightsToRenderer(s.Renderer);
        s.Kept.push_back(kit.Get());
      }
      else
      {
        s.Renderer->AddLight(s.Headlight);
      }
      s.Property->Modified();
    },
    4.0, 15.0, 29.0 });
  scenes.push_back(
    { "FourComponentsDependent", "TestGPURayCastFourComponentsDependentGradient", Reference::Gpu,
      [](Stage& s) {
        s.Show(s.MakeFourComponents(), { { 60, 1, 1, 1, 0.0 }, { 175, 1, 1, 1, 0.5 } }, 2.0, 0.0);
        s.Property->IndependentComponentsOff();
        // The GPU mapper takes that of the last component: see TestComponents.
        s.Property->SetScalarOpacityUnitDistance(3, 2.0);
      },
      [](Stage& s, bool on) {
        // Without: hardly anything is opaque.
        vtkNew<vtkPiecewiseFunction> opacity;
        opacity->AddPoint(60.0, 0.0);
        opacity->AddPoint(175.0, on ? 0.5 : 0.005);
        s.Property->SetScalarOpacity(opacity);
      },
      1.0, 5.0, 43.0 });
  return scenes;
}

//------------------------------------------------------------------------------
void SavePicture(const ffdTest::Picture& picture, const std::string& file)
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(picture.Width, picture.Height, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  std::copy(
    picture.Rgb.begin(), picture.Rgb.end(), static_cast<unsigned char*>(image->GetScalarPointer()));
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName(file.c_str());
  writer->Write();
}

/// Index coordinates of the points of an image as three components.
vtkSmartPointer<vtkImageData> MakeIndices(vtkImageData* image)
{
  auto indices = vtkSmartPointer<vtkImageData>::New();
  indices->CopyStructure(image);
  indices->AllocateScalars(VTK_FLOAT, 3);
  int dims[3];
  image->GetDimensions(dims);
  auto* out = static_cast<float*>(indices->GetScalarPointer());
  for (int k = 0; k < dims[2]; ++k)
  {
    for (int j = 0; j < dims[1]; ++j)
    {
      for (int i = 0; i < dims[0]; ++i)
      {
        *out++ = static_cast<float>(i);
        *out++ = static_cast<float>(j);
        *out++ = static_cast<float>(k);
      }
    }
  }
  return indices;
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
  checks.Expect(apart.Pixels > 1500 && apart.Mean <= test.Mean && apart.P99 <= test.P99,
    test.Name + " against VTK's mapper", figures.str());
  checks.ExpectAtLeast(test.Name + ", what the feature changes, ours",
    stage.Compare(with, without).Mean, test.Difference);
  checks.ExpectAtLeast(test.Name + ", what the feature changes, VTK's",
    stage.Compare(theirs, theirsWithout).Mean, test.Difference);

  double bounds[6];
  stage.Image->GetBounds(bounds);
  stage.Ours->SetDeformation(
    ffdTest::MakeTransform(bounds, 6, [](const ffdTest::Vec3&, const ffdTest::Vec3&) {
      return ffdTest::Vec3{ 0.0, 0.0, 0.0 };
    }));
  const ffdTest::Distance zeros = stage.Compare(stage.Render(stage.Ours), with);
  checks.Expect(zeros.Mean <= 0.02 && zeros.P99 <= 1.0, test.Name + ", a lattice of zeros",
    ffdTest::ToString(zeros) + " (mean at most 0.02, p99 1)");

  const double size =
    std::min({ bounds[1] - bounds[0], bounds[3] - bounds[2], bounds[5] - bounds[4] });
  const Deformation bend = ffdTest::MakeTransform(bounds, 8, ffdTest::BendAndWaves(0.18 * size));
  stage.Ours->SetDeformation(bend);
  const ffdTest::Picture deformed = stage.Render(stage.Ours);
  SavePicture(deformed, folder + "/Scene." + test.Name + ".deformed.png");
  checks.ExpectAtLeast(
    test.Name + ", what the deformation changes", stage.Compare(deformed, with).Mean, 3.0);
  test.Feature(stage, false);
  look();
  const ffdTest::Picture deformedWithout = stage.Render(stage.Ours);
  test.Feature(stage, true);
  look();
  checks.ExpectAtLeast(test.Name + ", what the feature changes, deformed",
    stage.Compare(deformed, deformedWithout).Mean, test.Difference);
  if (test.Decibels > 0.0)
  {
    vtkImageData* source = stage.Source ? stage.Source.Get() : stage.Image.Get();
    double spacing[3];
    source->GetSpacing(spacing);
    for (double& s : spacing)
    {
      s *= stage.SourceFactor;
    }
    vtkNew<vtkFFDResampleVolume> resample;
    resample->SetInputData(source);
    resample->SetDeformation(bend);
    resample->SetOutputSpacing(spacing);
    resample->SetBackgroundLevel(stage.Background);
    resample->Update();
    // With an extent from 0: VTK's mappers count cropping planes from there.
    double origin[6];
    resample->GetOutput()->GetBounds(origin);
    vtkNew<vtkImageChangeInformation> start;
    start->SetInputConnection(resample->GetOutputPort());
    start->SetOutputExtentStart(0, 0, 0);
    start->SetOutputOrigin(origin[0], origin[2], origin[4]);
    start->Update();
    stage.Fixed->SetInputData(start->GetOutput());
    stage.Gpu->SetInputData(start->GetOutput());
    stage.Gpu->SetScalarModeToDefault();
    if (test.Halve)
    {
      test.Halve(stage);
    }
    stage.Property->Modified();
    if (test.Mask)
    {
      // What was at rest where a voxel is now decides.
      vtkNew<vtkImageData> mask;
      mask->CopyStructure(start->GetOutput());
      mask->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
      resample->SetInputData(MakeIndices(source));
      resample->Update();
      vtkDataArray* indices = resample->GetOutput()->GetPointData()->GetScalars();
      for (vtkIdType i = 0; i < mask->GetNumberOfPoints(); ++i)
      {
        double index[3];
        indices->GetTuple(i, index);
        mask->GetPointData()->GetScalars()->SetTuple1(i, test.Mask(index));
      }
      stage.Gpu->SetMaskInput(mask);
      stage.Gpu->SetMaskType(stage.Ours->GetMaskInput()
          ? stage.Ours->GetMaskType()
          : vtkGPUVolumeRayCastMapper::BinaryMaskType);
      stage.Kept.push_back(mask.Get());
    }
    const ffdTest::Picture resampled = RenderReference(stage, test);
    SavePicture(resampled, folder + "/Scene." + test.Name + ".resampled.png");
    const ffdTest::Distance distance = stage.Compare(deformed, resampled);
    std::ostringstream text;
    text << distance << " (at least " << test.Decibels << " dB)";
    checks.Expect(distance.Pixels > 1500 && distance.Psnr >= test.Decibels,
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
