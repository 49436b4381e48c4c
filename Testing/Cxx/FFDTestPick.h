// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What the tests of vtkFFDVolumePicker share: a scene to pick in, and the comparison with
// vtkVolumePicker pixel by pixel.
#ifndef FFDTestPick_h
#define FFDTestPick_h

#include "FFDTestVolume.h"

#include "vtkFFDVolumePicker.h"
#include "vtkFixedPointVolumeRayCastMapper.h"
#include "vtkMath.h"
#include "vtkVolumePicker.h"

namespace ffdTest
{

constexpr int PickSize = 60;

/// A scene in a window that is never opened: pickers only ask for its size.
struct PickScene
{
  PickScene()
  {
    this->Window->SetOffScreenRendering(1);
    this->Window->SetSize(PickSize, PickSize);
    this->Window->AddRenderer(this->Renderer);
    this->Property->SetScalarOpacity(this->Opacity);
    this->Property->SetColor(this->Color);
    this->Property->SetInterpolationTypeToLinear();
    this->Color->AddRGBPoint(0.0, 1.0, 1.0, 1.0);
    this->Volume->SetMapper(this->Mapper);
    this->Volume->SetProperty(this->Property);
    this->Theirs->SetMapper(this->TheirMapper);
    this->Theirs->SetProperty(this->Property);
    this->Renderer->AddVolume(this->Volume);
    this->Errors->Watch(this->Mapper);
  }

  void SetImage(vtkImageData* image)
  {
    this->Image = image;
    this->Mapper->SetInputData(image);
    this->TheirMapper->SetInputData(image);
    double center[3];
    image->GetCenter(center);
    vtkCamera* camera = this->Renderer->GetActiveCamera();
    camera->SetFocalPoint(center);
    camera->SetPosition(center[0] + 1.1 * image->GetLength(), center[1] + 0.7 * image->GetLength(),
      center[2] + 1.4 * image->GetLength());
    camera->SetViewUp(0.0, 1.0, 0.1);
    camera->SetViewAngle(28.0);
    camera->SetClippingRange(0.5 * image->GetLength(), 4.0 * image->GetLength());
  }

  /// Only one of the two volumes is in the scene.
  void Show(vtkVolume* volume)
  {
    this->Renderer->RemoveAllViewProps();
    this->Renderer->AddVolume(volume);
  }

  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkRenderWindow> Window;
  vtkSmartPointer<vtkImageData> Image;
  vtkNew<vtkFFDInverseRayVolumeMapper> Mapper;
  vtkNew<vtkFixedPointVolumeRayCastMapper> TheirMapper;
  vtkNew<vtkPiecewiseFunction> Opacity;
  vtkNew<vtkColorTransferFunction> Color;
  vtkNew<vtkVolumeProperty> Property;
  vtkNew<vtkVolume> Volume;
  vtkNew<vtkVolume> Theirs;
  vtkNew<vtkFFDVolumePicker> Picker;
  vtkNew<vtkVolumePicker> TheirPicker;
  vtkNew<FFDErrorLog> Errors;
};

/// A linear function of the position: trilinear interpolation is exact.
inline vtkSmartPointer<vtkImageData> MakeRamp(bool oblique)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetExtent(-3, 16, 2, 19, 5, 28);
  image->SetSpacing(1.0, 1.5, 0.75);
  image->SetOrigin(4.0, -7.0, 1.0);
  image->AllocateScalars(VTK_DOUBLE, 1);
  for (int k = 5; k <= 28; ++k)
  {
    for (int j = 2; j <= 19; ++j)
    {
      for (int i = -3; i <= 16; ++i)
      {
        *static_cast<double*>(image->GetScalarPointer(i, j, k)) =
          200.0 - 5.0 * i - 3.0 * j - 4.0 * k;
      }
    }
  }
  if (oblique)
  {
    const double c = std::cos(0.4);
    const double s = std::sin(0.4);
    image->SetDirectionMatrix(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
  }
  return image;
}

/// The ray that vtkPicker casts through a display position: its points on the near and far planes.
inline void GetPickRay(vtkRenderer* renderer, double x, double y, double ends[2][3])
{
  for (int e = 0; e < 2; ++e)
  {
    renderer->SetDisplayPoint(x, y, e);
    renderer->DisplayToWorld();
    double w[4];
    renderer->GetWorldPoint(w);
    for (int a = 0; a < 3; ++a)
    {
      ends[e][a] = w[a] / w[3];
    }
  }
}

/// Whether the cell that was picked is one at a face of the volume or at a cropping plane.
inline bool LeavesWithinACell(PickScene& scene, vtkFFDVolumePicker* picker)
{
  int extent[6];
  scene.Image->GetExtent(extent);
  const double* planes = scene.Mapper->GetCroppingRegionPlanes();
  bool last = false;
  for (int a = 0; a < 3; ++a)
  {
    const int cell = picker->GetCellIJK()[a];
    last = last || cell == extent[2 * a] || cell + 1 == extent[2 * a + 1];
    for (int side = 0; side < 2 && scene.Mapper->GetCropping(); ++side)
    {
      const double spacing = scene.Image->GetSpacing()[a];
      last = last || std::abs(picker->GetRestPosition()[a] - planes[2 * a + side]) < spacing;
    }
  }
  return last;
}

/// Pick every fourth pixel with both; how often both hit, or -1 if they differ by more.
inline int CompareWithVTK(
  PickScene& scene, vtkVolume* ours, vtkVolume* theirs, double tolerance, double normalTolerance)
{
  int hits = 0;
  for (int y = 1; y < PickSize; y += 4)
  {
    for (int x = 1; x < PickSize; x += 4)
    {
      scene.Show(ours);
      const int mine = scene.Picker->Pick(x, y, 0.0, scene.Renderer);
      scene.Show(theirs);
      const int other = scene.TheirPicker->Pick(x, y, 0.0, scene.Renderer);
      vtkFFDVolumePicker* a = scene.Picker;
      vtkVolumePicker* b = scene.TheirPicker;
      const bool later = mine && other &&
        FFDDistance(scene.Renderer->GetActiveCamera()->GetPosition(), b->GetPickPosition()) >
          FFDDistance(scene.Renderer->GetActiveCamera()->GetPosition(), a->GetPickPosition()) + 0.1;
      if (mine && (!other || later) && LeavesWithinACell(scene, a))
      {
        // vtkVolumePicker goes from one cell boundary to the next and not into the last cell.
        continue;
      }
      const double apart = FFDDistance(a->GetPickPosition(), b->GetPickPosition());
      double turned = FFDDistance(a->GetPickNormal(), b->GetPickNormal());
      double eye[3];
      scene.Renderer->GetActiveCamera()->GetPosition(eye);
      vtkMath::Subtract(eye, a->GetPickPosition(), eye);
      if (a->GetCroppingPlaneId() >= 0 && vtkMath::Dot(a->GetPickNormal(), eye) > 0.0 &&
        vtkMath::Dot(b->GetPickNormal(), eye) < 0.0)
      {
        // The normal of a cropping plane that is entered from the middle region: vtkVolumePicker's
        // points into what is seen, ours out of it.
        turned = std::abs(turned - 2.0);
      }
      // Whole indices may round to either side where the position is half way between.
      const bool sameIds = a->GetPointId() == b->GetPointId() && a->GetCellId() == b->GetCellId();
      double p[3];
      bool onEdge = false;
      for (int c = 0; c < 3; ++c)
      {
        p[c] = 2.0 * a->GetPCoords()[c];
        onEdge = onEdge || std::abs(p[c] - std::round(p[c])) < 1e-4;
      }
      if (mine != other || !(apart <= tolerance) || !(turned <= normalTolerance) ||
        (!sameIds && !onEdge && tolerance < 1e-3) ||
        a->GetClippingPlaneId() != b->GetClippingPlaneId() ||
        a->GetCroppingPlaneId() != b->GetCroppingPlaneId())
      {
        std::cerr << "pixel " << x << ", " << y << ": hit " << mine << " / " << other << ", apart "
                  << apart << ", normals " << turned << ", point " << a->GetPointId() << " / "
                  << b->GetPointId() << ", cell " << a->GetCellId() << " / " << b->GetCellId()
                  << ", clipping plane " << a->GetClippingPlaneId() << " / "
                  << b->GetClippingPlaneId() << ", cropping plane " << a->GetCroppingPlaneId()
                  << " / " << b->GetCroppingPlaneId() << ", normals of the mapper "
                  << a->GetMapperNormal()[0] << " " << a->GetMapperNormal()[1] << " "
                  << a->GetMapperNormal()[2] << " / " << b->GetMapperNormal()[0] << " "
                  << b->GetMapperNormal()[1] << " " << b->GetMapperNormal()[2] << ", rest "
                  << a->GetRestPosition()[0] << " " << a->GetRestPosition()[1] << " "
                  << a->GetRestPosition()[2] << "\n";
        return -1;
      }
      hits += mine;
    }
  }
  return hits;
}

} // namespace ffdTest

#endif
