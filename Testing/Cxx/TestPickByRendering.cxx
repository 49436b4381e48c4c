// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// vtkHardwareSelector and the pickers that use it find the deformed volume where it is visible, and
// the points and cells whose material is shown there.
#include "FFDTestVolume.h"

#include "vtkDataObject.h"
#include "vtkHardwareSelector.h"
#include "vtkProp3DCollection.h"
#include "vtkPropPicker.h"
#include "vtkRenderedAreaPicker.h"

namespace
{

constexpr int Size = 80;

/// Selects in the whole window; keeps the buffers.
vtkSmartPointer<vtkHardwareSelector> Select(FFDTestScene& scene, int field)
{
  auto selector = vtkSmartPointer<vtkHardwareSelector>::New();
  selector->SetRenderer(scene.Renderer);
  selector->SetFieldAssociation(field);
  selector->SetArea(0, 0, Size - 1, Size - 1);
  selector->CaptureBuffers();
  return selector;
}

vtkHardwareSelector::PixelInformation At(vtkHardwareSelector* selector, int x, int y)
{
  const unsigned int position[2] = { static_cast<unsigned int>(x), static_cast<unsigned int>(y) };
  return selector->GetPixelInformation(position);
}

/// How far, in pixels, a point or the center of a cell of the input is shown from a pixel.
double FindDistance(FFDTestScene& scene, vtkIdType id, bool cell, int x, int y)
{
  double bounds[6];
  scene.Image->GetCellBounds(0, bounds);
  double rest[3];
  if (cell)
  {
    scene.Image->GetCellBounds(id, bounds);
    for (int a = 0; a < 3; ++a)
    {
      rest[a] = 0.5 * (bounds[2 * a] + bounds[2 * a + 1]);
    }
  }
  else
  {
    scene.Image->GetPoint(id, rest);
  }
  double deformed[4] = { 0.0, 0.0, 0.0, 1.0 };
  scene.Lattice->TransformPoint(rest, deformed);
  scene.Renderer->SetWorldPoint(deformed);
  scene.Renderer->WorldToDisplay();
  const double* display = scene.Renderer->GetDisplayPoint();
  return std::hypot(display[0] - x - 0.5, display[1] - y - 0.5);
}

/// The volume is found exactly where its opacity is above 3 / 255.
int TestSelector(FFDTestScene& scene)
{
  scene.ConeActor->VisibilityOff();
  const std::vector<unsigned char> before = scene.Show(Size);
  const std::vector<unsigned char> rgba = scene.Render(Size);
  for (const int field :
    { vtkDataObject::FIELD_ASSOCIATION_CELLS, vtkDataObject::FIELD_ASSOCIATION_POINTS })
  {
    const bool cells = field == vtkDataObject::FIELD_ASSOCIATION_CELLS;
    const vtkSmartPointer<vtkHardwareSelector> selector = Select(scene, field);
    const vtkIdType count =
      cells ? scene.Image->GetNumberOfCells() : scene.Image->GetNumberOfPoints();
    int found = 0;
    double sum = 0.0;
    for (int y = 0; y < Size; ++y)
    {
      for (int x = 0; x < Size; ++x)
      {
        const int alpha = rgba[static_cast<std::size_t>(4 * (y * Size + x) + 3)];
        const vtkHardwareSelector::PixelInformation pixel = At(selector, x, y);
        if (alpha >= 2 && alpha <= 4) // rounded
        {
          continue;
        }
        FFD_CHECK(pixel.Valid == (alpha > 3));
        if (pixel.Valid)
        {
          FFD_CHECK(pixel.Prop == scene.Volume.Get());
          FFD_CHECK(pixel.AttributeID >= 0 && pixel.AttributeID < count);
          // Half the diagonal of a voxel is about two pixels, which the deformation stretches.
          const double distance = FindDistance(scene, pixel.AttributeID, cells, x, y);
          FFD_CHECK(distance < 3.0);
          sum += distance;
          ++found;
        }
      }
    }
    FFD_CHECK(sum / found < 1.5);
    FFD_CHECK(found > 500 && found < Size * Size / 2);
  }
  FFD_CHECK(FFDLargestDifference(before, scene.Show(Size)) == 0);
  scene.ConeActor->VisibilityOn();
  return EXIT_SUCCESS;
}

/// A cone before the volume hides it, one behind it is hidden, from pickers, too.
int TestHidden(FFDTestScene& scene)
{
  scene.Opacity->AddPoint(60.0, 0.9);
  scene.Renderer->ResetCameraClippingRange();
  double display[3];
  scene.Renderer->SetWorldPoint(11.0, 11.0, 13.0, 1.0);
  scene.Renderer->WorldToDisplay();
  scene.Renderer->GetDisplayPoint(display);
  for (const bool before : { true, false })
  {
    // On the line of sight.
    double eye[3];
    scene.Renderer->GetActiveCamera()->GetPosition(eye);
    const double t = before ? 0.5 : -0.5;
    scene.Cone->SetCenter(
      11.0 + t * (eye[0] - 11.0), 11.0 + t * (eye[1] - 11.0), 13.0 + t * (eye[2] - 13.0));
    scene.Renderer->ResetCameraClippingRange();
    scene.Show(Size);
    vtkProp* const expected =
      before ? static_cast<vtkProp*>(scene.ConeActor) : static_cast<vtkProp*>(scene.Volume);
    vtkNew<vtkPropPicker> picker;
    FFD_CHECK(picker->PickProp(display[0], display[1], scene.Renderer) == 1);
    FFD_CHECK(picker->GetViewProp() == expected);
    vtkNew<vtkRenderedAreaPicker> area;
    FFD_CHECK(area->AreaPick(0.0, 0.0, Size - 1.0, Size - 1.0, scene.Renderer) == 1);
    FFD_CHECK(area->GetProp3Ds()->IsItemPresent(scene.Volume) != 0);
  }
  vtkNew<vtkPropPicker> picker;
  FFD_CHECK(picker->PickProp(1.0, Size - 2.0, scene.Renderer) == 0);
  scene.Volume->PickableOff();
  FFD_CHECK(
    picker->PickProp(display[0], display[1], scene.Renderer) == 1); // the cone, through the volume
  scene.Volume->PickableOn();
  return EXIT_SUCCESS;
}

} // namespace

int TestPickByRendering(int, char*[])
{
  FFDTestScene scene;
  FFD_CHECK(TestSelector(scene) == EXIT_SUCCESS);
  FFD_CHECK(TestHidden(scene) == EXIT_SUCCESS);
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}
