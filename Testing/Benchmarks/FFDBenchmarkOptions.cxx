// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDBenchmarkOptions.h"

#include "FFDBenchmarkScene.h"
#include "FFDBenchmarkSuites.h"

#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDLattice.h"

#include "vtkCellData.h"
#include "vtkColorTransferFunction.h"
#include "vtkContourValues.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkImageCast.h"
#include "vtkImageData.h"
#include "vtkLight.h"
#include "vtkLightCollection.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPlane.h"
#include "vtkPointData.h"
#include "vtkRectilinearGrid.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <limits>
#include <map>

namespace ffdBenchmark
{

namespace
{

constexpr double NoLimit = std::numeric_limits<double>::quiet_NaN();

/// Pixels of the pictures that are compared with those of the reference kernels, which take long.
constexpr int JudgedSize = 96;

/// Positions within their tolerance decide which voxel is nearest, and where a ray meets a surface
/// that it grazes: few pixels, which may differ much. Closer positions than those of the frames
/// that are timed leave the differences to the options.
constexpr Tolerance JudgedTolerance{ 1, 0.5, 0.005 };
constexpr double JudgedPositionTolerance = 0.02;

/// What is visible in the opaque setting begins here.
constexpr double Surface = 80.0;

using ImagePointer = vtkSmartPointer<vtkImageData>;
using PropertyPointer = vtkSmartPointer<vtkVolumeProperty>;

//------------------------------------------------------------------------------
/// A component of `components` is the volume, its mirror image, the volume upside down, and both.
ImagePointer MakeComponents(vtkImageData* image, int components)
{
  auto result = ImagePointer::New();
  result->CopyStructure(image);
  result->AllocateScalars(VTK_UNSIGNED_CHAR, components);
  int dims[3];
  image->GetDimensions(dims);
  const auto* in = static_cast<const unsigned char*>(image->GetScalarPointer());
  auto* out = static_cast<unsigned char*>(result->GetScalarPointer());
  const vtkIdType row = dims[0];
  const vtkIdType slice = row * dims[1];
  for (vtkIdType k = 0; k < dims[2]; ++k)
  {
    for (vtkIdType j = 0; j < dims[1]; ++j)
    {
      for (vtkIdType i = 0; i < dims[0]; ++i)
      {
        for (int c = 0; c < components; ++c)
        {
          const vtkIdType x = c % 2 == 0 ? i : dims[0] - 1 - i;
          const vtkIdType y = c < 2 ? j : dims[1] - 1 - j;
          *out++ = in[slice * k + row * y + x];
        }
      }
    }
  }
  return result;
}

/// Points whose index along x is below `end` of all have the label 1, or 255 of a binary mask.
ImagePointer MakeMask(vtkImageData* image, double end, unsigned char label)
{
  auto mask = ImagePointer::New();
  mask->CopyStructure(image);
  mask->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  int dims[3];
  image->GetDimensions(dims);
  auto* out = static_cast<unsigned char*>(mask->GetScalarPointer());
  const vtkIdType count = image->GetNumberOfPoints();
  for (vtkIdType p = 0; p < count; ++p)
  {
    out[p] = static_cast<double>(p % dims[0]) < end * dims[0] ? label : 0;
  }
  return mask;
}

/// The scalars of the points belong to cells.
ImagePointer MakeCells(vtkImageData* image)
{
  auto cells = ImagePointer::New();
  int dims[3];
  image->GetDimensions(dims);
  cells->SetDimensions(dims[0] + 1, dims[1] + 1, dims[2] + 1);
  cells->SetSpacing(image->GetSpacing());
  double origin[3];
  for (int a = 0; a < 3; ++a)
  {
    origin[a] = image->GetOrigin()[a] - 0.5 * image->GetSpacing()[a];
  }
  cells->SetOrigin(origin);
  cells->GetCellData()->SetScalars(image->GetPointData()->GetScalars());
  return cells;
}

/// The scalars of the points on a grid of the same bounds, whose steps are 0.5 to 1.5 of the
/// others.
vtkSmartPointer<vtkRectilinearGrid> MakeGrid(vtkImageData* image)
{
  auto grid = vtkSmartPointer<vtkRectilinearGrid>::New();
  int dims[3];
  image->GetDimensions(dims);
  grid->SetDimensions(dims);
  vtkNew<vtkDoubleArray> coordinates[3];
  for (int a = 0; a < 3; ++a)
  {
    const double part = 2.0 * vtkMath::Pi() / (dims[a] - 1);
    for (int i = 0; i < dims[a]; ++i)
    {
      coordinates[a]->InsertNextValue(
        image->GetOrigin()[a] + image->GetSpacing()[a] * (i + 0.5 / part * std::sin(part * i)));
    }
  }
  grid->SetXCoordinates(coordinates[0]);
  grid->SetYCoordinates(coordinates[1]);
  grid->SetZCoordinates(coordinates[2]);
  grid->GetPointData()->SetScalars(image->GetPointData()->GetScalars());
  return grid;
}

/// The cells whose index along x is at least `begin` of all are hidden.
ImagePointer Blank(vtkImageData* image, double begin)
{
  auto blanked = ImagePointer::New();
  blanked->ShallowCopy(image);
  int dims[3];
  image->GetDimensions(dims);
  vtkUnsignedCharArray* const ghosts = blanked->AllocateCellGhostArray();
  const vtkIdType row = dims[0] - 1;
  for (vtkIdType cell = 0; cell < blanked->GetNumberOfCells(); ++cell)
  {
    const bool hidden = static_cast<double>(cell % row) >= begin * static_cast<double>(row);
    ghosts->SetValue(cell, hidden ? vtkDataSetAttributes::HIDDENCELL : 0);
  }
  return blanked;
}

ImagePointer Cast(vtkImageData* image, int type)
{
  vtkNew<vtkImageCast> cast;
  cast->SetInputData(image);
  cast->SetOutputScalarType(type);
  cast->Update();
  return cast->GetOutput();
}

/// 255 - v for each value v: its least values are the largest of the volume.
ImagePointer Invert(vtkImageData* image)
{
  auto result = ImagePointer::New();
  result->DeepCopy(image);
  auto* values = static_cast<unsigned char*>(result->GetScalarPointer());
  const vtkIdType count = image->GetNumberOfPoints();
  std::transform(values, values + count, values,
    [](unsigned char v) { return static_cast<unsigned char>(255 - v); });
  return result;
}

/// Opacity over value and gradient: that of the value where the gradient is not small.
ImagePointer MakeFunction2D()
{
  auto function = ImagePointer::New();
  function->SetDimensions(256, 64, 1);
  function->SetSpacing(1.0, 2.0, 1.0);
  function->AllocateScalars(VTK_FLOAT, 4);
  auto* rgba = static_cast<float*>(function->GetScalarPointer());
  for (int y = 0; y < 64; ++y)
  {
    for (int x = 0; x < 256; ++x)
    {
      const double opacity = 0.9 * std::min(1.0, std::max(0.0, (x - 70.0) / 20.0));
      *rgba++ = 1.0f;
      *rgba++ = static_cast<float>(0.5 + 0.5 * x / 255.0);
      *rgba++ = static_cast<float>(x / 255.0);
      *rgba++ = static_cast<float>(opacity * std::min(1.0, 0.2 + y / 8.0));
    }
  }
  return function;
}

//------------------------------------------------------------------------------
/// A row's scene: what the options change.
struct OptionScene
{
  ImagePointer Image;
  PropertyPointer Property;
  vtkSmartPointer<vtkFFDInverseRayVolumeMapper> Mapper;
  vtkSmartPointer<vtkFFDInverseRayVolumeMapper> Oracle;
};

/// Of independent components.
void SetComponents(vtkVolumeProperty* property, int components)
{
  for (int c = 1; c < components; ++c)
  {
    vtkNew<vtkColorTransferFunction> color;
    color->AddRGBPoint(0.0, 0.3 * c, 0.2, 0.9);
    color->AddRGBPoint(255.0, 1.0, 1.0, 1.0);
    property->SetColor(c, color);
    property->SetScalarOpacity(c, property->GetScalarOpacity(0));
    property->ShadeOn(c);
    property->SetAmbient(c, property->GetAmbient(0));
    property->SetDiffuse(c, property->GetDiffuse(0));
    property->SetSpecular(c, property->GetSpecular(0));
    property->SetSpecularPower(c, property->GetSpecularPower(0));
  }
}

using Change = void (*)(OptionScene&, vtkFFDInverseRayVolumeMapper*);

const std::map<std::string, Change>& GetChanges();

/// Makes several changes.
void Apply(std::initializer_list<const char*> changes, OptionScene& scene,
  vtkFFDInverseRayVolumeMapper* mapper)
{
  for (const char* change : changes)
  {
    GetChanges().at(change)(scene, mapper);
  }
}

/// What an option changes of a scene; called for its mapper and for the oracle.
const std::map<std::string, Change>& GetChanges()
{
  using Mapper = vtkFFDInverseRayVolumeMapper;
  static const std::map<std::string, Change> changes = {
    { "plain", [](OptionScene&, Mapper*) {} },
    { "unshaded", [](OptionScene& s, Mapper*) { s.Property->ShadeOff(); } },
    { "every sample",
      [](OptionScene& s, Mapper* mapper) {
        s.Property = MakeProperty(Opacity::Semi);
        s.Property->ShadeOff();
        mapper->SetSpaceLeapingToOff();
        mapper->SetEarlyRayTerminationThreshold(0.0);
      } },
    { "components 2",
      [](OptionScene& s, Mapper* mapper) {
        mapper->SetInputData(MakeComponents(s.Image, 2));
        SetComponents(s.Property, 2);
      } },
    { "components 2, 16 bit",
      [](OptionScene& s, Mapper* mapper) {
        mapper->SetInputData(Cast(MakeComponents(s.Image, 2), VTK_UNSIGNED_SHORT));
        SetComponents(s.Property, 2);
      } },
    { "components 2, double",
      [](OptionScene& s, Mapper* mapper) {
        mapper->SetInputData(Cast(MakeComponents(s.Image, 2), VTK_DOUBLE));
        SetComponents(s.Property, 2);
      } },
    { "components 3",
      [](OptionScene& s, Mapper* mapper) {
        mapper->SetInputData(MakeComponents(s.Image, 3));
        SetComponents(s.Property, 3);
      } },
    { "components 4",
      [](OptionScene& s, Mapper* mapper) {
        mapper->SetInputData(MakeComponents(s.Image, 4));
        SetComponents(s.Property, 4);
      } },
    { "dependent 2",
      [](OptionScene& s, Mapper* mapper) {
        mapper->SetInputData(MakeComponents(s.Image, 2));
        s.Property->IndependentComponentsOff();
      } },
    { "dependent 2, float",
      [](OptionScene& s, Mapper* mapper) {
        mapper->SetInputData(Cast(MakeComponents(s.Image, 2), VTK_FLOAT));
        s.Property->IndependentComponentsOff();
      } },
    { "dependent 2, double",
      [](OptionScene& s, Mapper* mapper) {
        mapper->SetInputData(Cast(MakeComponents(s.Image, 2), VTK_DOUBLE));
        s.Property->IndependentComponentsOff();
      } },
    { "dependent RGBA",
      [](OptionScene& s, Mapper* mapper) {
        mapper->SetInputData(MakeComponents(s.Image, 4));
        s.Property->IndependentComponentsOff();
      } },
    { "binary mask",
      [](OptionScene& s, Mapper* mapper) {
        mapper->SetMaskTypeToBinary();
        mapper->SetMaskInput(MakeMask(s.Image, 0.5, 255));
      } },
    { "label map",
      [](OptionScene& s, Mapper* mapper) {
        vtkNew<vtkColorTransferFunction> color;
        color->AddRGBPoint(0.0, 0.1, 0.6, 0.2);
        color->AddRGBPoint(255.0, 0.6, 1.0, 0.7);
        s.Property->SetLabelColor(1, color);
        s.Property->SetLabelScalarOpacity(1, s.Property->GetScalarOpacity());
        mapper->SetMaskTypeToLabelMap();
        mapper->SetMaskBlendFactor(1.0f);
        mapper->SetMaskInput(MakeMask(s.Image, 0.5, 1));
      } },
    { "label map blended",
      [](OptionScene& s, Mapper* mapper) {
        vtkNew<vtkColorTransferFunction> color;
        color->AddRGBPoint(0.0, 0.1, 0.6, 0.2);
        color->AddRGBPoint(255.0, 0.6, 1.0, 0.7);
        s.Property->SetLabelColor(1, color);
        s.Property->SetLabelScalarOpacity(1, s.Property->GetScalarOpacity());
        mapper->SetMaskTypeToLabelMap();
        mapper->SetMaskBlendFactor(0.5f);
        mapper->SetMaskInput(MakeMask(s.Image, 0.5, 1));
      } },
    { "2-D function",
      [](OptionScene& s, Mapper*) {
        s.Property->SetTransferFunctionMode(vtkVolumeProperty::TF_2D);
        s.Property->SetTransferFunction2D(MakeFunction2D());
      } },
    { "gradient opacity",
      [](OptionScene& s, Mapper*) {
        vtkNew<vtkPiecewiseFunction> gradients;
        gradients->AddPoint(5.0, 0.0);
        gradients->AddPoint(40.0, 1.0);
        s.Property->SetGradientOpacity(gradients);
      } },
    { "normals of opacity",
      [](OptionScene&, Mapper* mapper) { mapper->ComputeNormalFromOpacityOn(); } },
    { "nearest", [](OptionScene& s, Mapper*) { s.Property->SetInterpolationTypeToNearest(); } },
    { "cell scalars",
      [](OptionScene& s, Mapper* mapper) { mapper->SetInputData(MakeCells(s.Image)); } },
    { "rectilinear grid",
      [](OptionScene& s, Mapper* mapper) { mapper->SetInputData(MakeGrid(s.Image)); } },
    { "blanking",
      [](OptionScene& s, Mapper* mapper) { mapper->SetInputData(Blank(s.Image, 0.5)); } },
    { "16 bit",
      [](OptionScene& s, Mapper* mapper) {
        mapper->SetInputData(Cast(s.Image, VTK_UNSIGNED_SHORT));
      } },
    { "float",
      [](OptionScene& s, Mapper* mapper) { mapper->SetInputData(Cast(s.Image, VTK_FLOAT)); } },
    { "double",
      [](OptionScene& s, Mapper* mapper) { mapper->SetInputData(Cast(s.Image, VTK_DOUBLE)); } },
    { "32 bit",
      [](OptionScene& s, Mapper* mapper) { mapper->SetInputData(Cast(s.Image, VTK_INT)); } },
    { "cropping",
      [](OptionScene& s, Mapper* mapper) {
        double bounds[6];
        s.Image->GetBounds(bounds);
        mapper->CroppingOn();
        mapper->SetCroppingRegionPlanes(
          bounds[0], 0.6 * bounds[1] + 0.4 * bounds[0], bounds[2], bounds[3], bounds[4], bounds[5]);
        mapper->SetCroppingRegionFlagsToSubVolume();
      } },
    { "clipping plane",
      [](OptionScene& s, Mapper* mapper) {
        vtkNew<vtkPlane> plane;
        plane->SetOrigin(s.Image->GetCenter());
        plane->SetNormal(-1.0, 0.3, 0.2);
        mapper->AddClippingPlane(plane);
      } },
    { "clipped voxels",
      [](OptionScene& s, Mapper* mapper) {
        Apply({ "clipping plane" }, s, mapper);
        s.Property->UseClippedVoxelIntensityOn();
      } },
    { "clipped voxels, blanking",
      [](OptionScene& s, Mapper* mapper) {
        Apply({ "blanking", "clipped voxels" }, s, mapper);
      } },
    { "clipped voxels, rectilinear grid",
      [](OptionScene& s, Mapper* mapper) {
        Apply({ "rectilinear grid", "clipped voxels" }, s, mapper);
      } },
    { "normals of opacity, components 2, blanking",
      [](OptionScene& s, Mapper* mapper) {
        Apply({ "normals of opacity, components 2" }, s, mapper);
        mapper->SetInputData(Blank(MakeComponents(s.Image, 2), 0.5));
      } },
    { "2-D function of an array",
      [](OptionScene& s, Mapper* mapper) {
        Apply({ "2-D function" }, s, mapper);
        auto image = ImagePointer::New();
        image->ShallowCopy(s.Image);
        vtkSmartPointer<vtkDataArray> array;
        array.TakeReference(s.Image->GetPointData()->GetScalars()->NewInstance());
        array->DeepCopy(s.Image->GetPointData()->GetScalars());
        array->SetName("second axis");
        image->GetPointData()->AddArray(array);
        mapper->SetInputData(image);
        mapper->SetTransfer2DYAxisArray("second axis");
      } },
    { "2-D function, label map",
      [](OptionScene& s, Mapper* mapper) {
        Apply({ "2-D function", "label map" }, s, mapper);
      } },
    { "2-D function, components 2",
      [](OptionScene& s, Mapper* mapper) {
        Apply({ "components 2", "2-D function" }, s, mapper);
        s.Property->SetTransferFunction2D(1, MakeFunction2D());
      } },
    { "normals of opacity, components 2",
      [](OptionScene& s, Mapper* mapper) {
        Apply({ "components 2", "normals of opacity" }, s, mapper);
      } },
    { "normals of opacity, dependent RGBA",
      [](OptionScene& s, Mapper* mapper) {
        Apply({ "dependent RGBA", "normals of opacity" }, s, mapper);
      } },
    { "label map, dependent 2",
      [](OptionScene& s, Mapper* mapper) {
        Apply({ "dependent 2", "label map" }, s, mapper);
      } },
    { "isosurface, normals of opacity",
      [](OptionScene& s, Mapper* mapper) {
        Apply({ "isosurface", "normals of opacity" }, s, mapper);
      } },
    { "maximum, 2-D function",
      [](OptionScene& s, Mapper* mapper) {
        Apply({ "maximum", "2-D function" }, s, mapper);
      } },
    { "average, 2-D function",
      [](OptionScene& s, Mapper* mapper) {
        Apply({ "average", "2-D function" }, s, mapper);
      } },
    { "jitter", [](OptionScene&, Mapper* mapper) { mapper->UseJitteringOn(); } },
    { "sharp highlights", [](OptionScene& s, Mapper*) { s.Property->SetSpecularPower(40.0); } },
    { "pre-integrated",
      [](OptionScene&, Mapper* mapper) { mapper->SetClassificationToPreIntegrated(); } },
    { "isosurface",
      [](OptionScene& s, Mapper* mapper) {
        s.Property->GetIsoSurfaceValues()->SetValue(0, Surface);
        mapper->SetBlendModeToIsoSurface();
      } },
    { "isosurface, opaque",
      [](OptionScene& s, Mapper* mapper) {
        s.Property->GetIsoSurfaceValues()->SetValue(0, Surface);
        s.Property->GetScalarOpacity()->RemoveAllPoints();
        s.Property->GetScalarOpacity()->AddPoint(Surface, 1.0);
        mapper->SetBlendModeToIsoSurface();
      } },
    { "maximum", [](OptionScene&, Mapper* mapper) { mapper->SetBlendModeToMaximumIntensity(); } },
    { "maximum, components 2",
      [](OptionScene& s, Mapper* mapper) {
        mapper->SetInputData(MakeComponents(s.Image, 2));
        SetComponents(s.Property, 2);
        mapper->SetBlendModeToMaximumIntensity();
      } },
    { "minimum",
      [](OptionScene& s, Mapper* mapper) {
        mapper->SetInputData(Invert(s.Image));
        s.Property = MakeProperty(Opacity::Opaque);
        s.Property->GetScalarOpacity()->RemoveAllPoints();
        s.Property->GetScalarOpacity()->AddPoint(165.0, 0.9);
        s.Property->GetScalarOpacity()->AddPoint(185.0, 0.0);
        mapper->SetBlendModeToMinimumIntensity();
      } },
    { "average",
      [](OptionScene& s, Mapper* mapper) {
        s.Property = MakeProperty(Opacity::Semi);
        mapper->SetBlendModeToAverageIntensity();
      } },
    { "additive",
      [](OptionScene& s, Mapper* mapper) {
        s.Property = MakeProperty(Opacity::Semi);
        mapper->SetBlendModeToAdditive();
      } },
    { "slice",
      [](OptionScene& s, Mapper* mapper) {
        vtkNew<vtkPlane> plane;
        plane->SetOrigin(s.Image->GetCenter());
        plane->SetNormal(0.2, 0.3, 1.0);
        s.Property->SetSliceFunction(plane);
        mapper->SetBlendMode(vtkVolumeMapper::SLICE_BLEND);
      } },
  };
  return changes;
}

struct Kept
{
  explicit Kept(vtkImageData* image)
    : View(512, image)
    , Judged(JudgedSize, image)
  {
  }
  Stage View;
  Stage Judged;
  vtkNew<vtkFFDLattice> Lattice;
  std::vector<OptionScene> Scenes;
};

//------------------------------------------------------------------------------
/// Seven more lights beside the headlight, which draws half as bright.
void SetLights(vtkRenderer* renderer, bool several)
{
  while (renderer->GetLights()->GetNumberOfItems() > 1)
  {
    renderer->RemoveLight(vtkLight::SafeDownCast(renderer->GetLights()->GetItemAsObject(1)));
  }
  for (int n = 0; several && n < 7; ++n)
  {
    vtkNew<vtkLight> light;
    light->SetLightTypeToSceneLight();
    light->SetPosition(1000.0 * std::cos(0.9 * n), 1000.0 * std::sin(0.9 * n), -700.0);
    light->SetIntensity(0.1);
    renderer->AddLight(light);
  }
}

} // namespace

//------------------------------------------------------------------------------
const std::vector<FrameOption>& GetFrameOptions()
{
  static const std::vector<FrameOption> options = {
    { "plain", "plain", NoLimit },
    { "unshaded", "plain", NoLimit },
    { "every sample", "plain", NoLimit },
    { "components 2", "plain", 2.4 },
    { "components 3", "plain", 3.6 },
    { "components 4", "plain", 4.8 },
    { "dependent 2", "plain", 1.5 },
    { "dependent RGBA", "plain", 1.5 },
    { "binary mask", "plain", 1.5 },
    { "label map", "plain", 1.5 },
    { "label map blended", "plain", 1.5 },
    { "2-D function", "plain", 1.5 },
    { "2-D function of an array", "2-D function", 1.5 },
    { "2-D function, label map", "2-D function", 1.5 },
    { "2-D function, components 2", "components 2", 1.5 },
    { "label map, dependent 2", "dependent 2", 1.5 },
    { "gradient opacity", "plain", 1.5 },
    { "normals of opacity", "plain", 1.5 },
    { "normals of opacity, components 2", "components 2", 1.5 },
    { "normals of opacity, dependent RGBA", "dependent RGBA", 1.5 },
    { "nearest", "plain", 1.5 },
    { "cell scalars", "plain", 1.5 },
    { "rectilinear grid", "plain", 1.5 },
    { "blanking", "plain", 1.5 },
    { "16 bit", "plain", 1.4 },
    { "float", "plain", 1.4 },
    { "double", "plain", 1.5 },
    { "32 bit", "plain", 1.5 },
    { "components 2, 16 bit", "16 bit", 2.4 },
    { "components 2, double", "double", 2.4 },
    { "dependent 2, float", "float", 1.5 },
    { "dependent 2, double", "double", 1.5 },
    { "cropping", "plain", 1.4 },
    { "clipping plane", "plain", 1.4 },
    { "clipped voxels", "clipping plane", 1.5 },
    { "clipped voxels, blanking", "clipped voxels", 1.5 },
    { "clipped voxels, rectilinear grid", "clipped voxels", 1.5 },
    { "normals of opacity, components 2, blanking", "normals of opacity, components 2", 1.5 },
    { "jitter", "plain", 1.4 },
    { "pre-integrated", "plain", 1.3 },
    { "8 lights", "plain", 1.4 },
    { "sharp highlights", "plain", 1.1 },
    { "isosurface", "plain", 1.5 },
    { "isosurface, opaque", "plain", 1.5 },
    { "isosurface, normals of opacity", "isosurface", 1.5 },
    { "maximum", "plain", 1.5 },
    { "maximum, components 2", "maximum", 2.4 },
    { "maximum, 2-D function", "maximum", 1.5 },
    { "minimum", "plain", 1.5 },
    { "average", "every sample", 1.3 },
    { "average, 2-D function", "average", 1.5 },
    { "additive", "every sample", 1.3 },
    { "slice", "plain", 1.5 },
  };
  return options;
}

//------------------------------------------------------------------------------
std::shared_ptr<void> PrepareOptions(
  Group& group, const std::string& folder, const std::string& volumeName, bool deformed)
{
  const ImagePointer image = ReadVolume(folder, volumeName);
  auto kept = std::make_shared<Kept>(image);
  double bounds[6];
  image->GetBounds(bounds);
  const double bend = 45.0 / 255.0 * (bounds[1] - bounds[0]);
  Deform(kept->Lattice, image,
    deformed ? Deformation{ Shape::Smooth, bend } : Deformation{ Shape::Identity, 0.0 });
  vtkFFDLattice* lattice = deformed ? kept->Lattice.Get() : nullptr;
  for (Row& row : group.GetRows())
  {
    const bool lights = row.Name == "8 lights";
    const Change change = GetChanges().at(lights ? "plain" : row.Name);
    OptionScene scene{ image, MakeProperty(Opacity::Opaque), nullptr, nullptr };
    scene.Mapper = MakeMapper(image, lattice, Variant::Exact);
    scene.Oracle = MakeOracle(image, lattice, Variant::Exact);
    change(scene, scene.Oracle);
    change(scene, scene.Mapper);
    Kept* k = kept.get();
    const double tolerance = scene.Mapper->GetPositionTolerance();
    scene.Mapper->SetPositionTolerance(JudgedPositionTolerance);
    SetLights(k->Judged.GetRenderer(), lights);
    const auto expected =
      k->Judged.DrawAndCapture(k->Judged.AddVolume(scene.Oracle, scene.Property));
    const auto picture =
      k->Judged.DrawAndCapture(k->Judged.AddVolume(scene.Mapper, scene.Property));
    const Difference difference = Compare(picture, expected, JudgedSize, JudgedTolerance.Block);
    scene.Mapper->SetPositionTolerance(tolerance);
    row.Counters["image_mean_difference"] = difference.Mean;
    row.Counters["covered_percent"] = 100.0 * difference.Covered;
    if (difference.Covered < 0.02 || difference.Mean > JudgedTolerance.Mean ||
      difference.Outliers > JudgedTolerance.Outliers)
    {
      char text[200];
      std::snprintf(text, sizeof(text),
        "the picture differs from the reference kernels: mean %.2f of 255, outliers %.2f %%, "
        "covered %.1f %%",
        difference.Mean, 100.0 * difference.Outliers, 100.0 * difference.Covered);
      row.Refusal = text;
    }
    vtkVolume* volume = k->View.AddVolume(scene.Mapper, scene.Property);
    row.Before = [k, lights] { SetLights(k->View.GetRenderer(), lights); };
    row.Run = [k, volume] { k->View.Draw(volume); };
    row.Before();
    row.Run();
    k->Scenes.push_back(scene);
  }
  return kept;
}

} // namespace ffdBenchmark
