// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDLatticeScene.h"

#include "vtkActor.h"
#include "vtkActor2D.h"
#include "vtkCamera.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkGlyph3DMapper.h"
#include "vtkLabeledDataMapper.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLState.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkPolyDataMapper2D.h"
#include "vtkPropCollection.h"
#include "vtkProperty.h"
#include "vtkProperty2D.h"
#include "vtkRenderer.h"
#include "vtkSphereSource.h"
#include "vtkStringArray.h"
#include "vtkTextProperty.h"
#include "vtkUnsignedCharArray.h"

#include <glm/vec4.hpp>

#include <cmath>
#include <cstdint>

namespace
{

/// GL_DEPTH_TEST: the loaders of OpenGL have other names in other versions of VTK.
constexpr unsigned int GlDepthTest = 0x0B71;

/// Glyphs are as fine as their number allows: with software rasterisers their triangles are what a
/// frame costs. 120 triangles each for a few, 24, and 8 for hundreds and for what is dimmed.
struct GlyphLevel
{
  std::size_t AtMost;
  int Theta;
  int Phi;
};
constexpr GlyphLevel GlyphLevels[] = { { 150, 10, 8 }, { 400, 6, 4 }, { SIZE_MAX, 4, 3 } };

} // namespace

//------------------------------------------------------------------------------
vtkFFDProjection::vtkFFDProjection(vtkRenderer* renderer)
{
  vtkCamera* camera = renderer->GetActiveCamera();
  const vtkMatrix4x4* matrix = camera->GetCompositeProjectionTransformMatrix(
    renderer->GetTiledAspectRatio(), -1.0, 1.0);
  for (int r = 0; r < 4; ++r)
  {
    for (int c = 0; c < 4; ++c)
    {
      this->WorldToClip[c][r] = matrix->GetElement(r, c);
    }
  }
  const int* origin = renderer->GetOrigin();
  const int* size = renderer->GetSize();
  this->Origin = { origin[0], origin[1] };
  this->Size = { std::max(1, size[0]), std::max(1, size[1]) };
  if (camera->GetParallelProjection())
  {
    this->PixelPerDepth = 2.0 * camera->GetParallelScale() / this->Size.y;
  }
  else
  {
    this->PixelPerDepth =
      2.0 * std::tan(0.5 * vtkMath::RadiansFromDegrees(camera->GetViewAngle())) /
      (camera->GetUseHorizontalViewAngle() ? this->Size.x : this->Size.y);
  }
}

//------------------------------------------------------------------------------
bool vtkFFDProjection::ToDisplay(const glm::dvec3& world, glm::dvec3& display) const
{
  const glm::dvec4 clip = this->WorldToClip * glm::dvec4(world, 1.0);
  if (!(clip.w > 0.0))
  {
    return false;
  }
  const glm::dvec3 view = glm::dvec3(clip) / clip.w;
  // As vtkViewport::ViewToDisplay().
  const glm::dvec2 pixel = this->Origin + 0.5 * (glm::dvec2(view) + 1.0) * this->Size;
  display = { pixel.x, pixel.y, view.z };
  return true;
}

//------------------------------------------------------------------------------
double vtkFFDProjection::GetPixelSize(const glm::dvec3& world) const
{
  const glm::dvec4 clip = this->WorldToClip * glm::dvec4(world, 1.0);
  return clip.w > 0.0 ? clip.w * this->PixelPerDepth : 0.0;
}

//------------------------------------------------------------------------------
vtkFFDLatticeScene::PolyLines::PolyLines()
{
  this->Points->SetDataTypeToFloat();
  this->Data->SetPoints(this->Points);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::PolyLines::Set(const Lines& lines)
{
  this->Points->SetNumberOfPoints(static_cast<vtkIdType>(lines.Points.size()));
  for (std::size_t p = 0; p < lines.Points.size(); ++p)
  {
    this->Points->SetPoint(static_cast<vtkIdType>(p), &lines.Points[p].x);
  }
  this->Points->Modified();
  if (lines.Ends != this->Ends)
  {
    this->Ends = lines.Ends;
    vtkNew<vtkCellArray> cells;
    std::size_t start = 0;
    for (std::size_t end : lines.Ends)
    {
      cells->InsertNextCell(static_cast<int>(end - start));
      for (; start < end; ++start)
      {
        cells->InsertCellPoint(static_cast<vtkIdType>(start));
      }
    }
    this->Data->SetLines(cells);
  }
  this->Data->Modified();
}

//------------------------------------------------------------------------------
vtkFFDLatticeScene::vtkFFDLatticeScene()
{
  this->Sphere->SetRadius(0.5);
  this->CoarseSphere->SetRadius(0.5);
  this->CoarseSphere->SetThetaResolution(4);
  this->CoarseSphere->SetPhiResolution(3);
  this->GlyphPoints->SetDataTypeToFloat();
  this->GlyphData->SetPoints(this->GlyphPoints);
  this->GlyphSizes->SetName("Size");
  this->GlyphColours->SetName("Colour");
  this->GlyphColours->SetNumberOfComponents(3);
  this->GlyphData->GetPointData()->AddArray(this->GlyphSizes);
  this->GlyphData->GetPointData()->SetScalars(this->GlyphColours);
  for (int pass = 0; pass < 2; ++pass)
  {
    vtkGlyph3DMapper* glyphs = this->GlyphMapper[pass];
    glyphs->SetInputData(this->GlyphData);
    glyphs->SetSourceConnection(
      (pass == 0 ? this->Sphere : this->CoarseSphere)->GetOutputPort());
    glyphs->SetScaleArray("Size");
    glyphs->SetScaleModeToScaleByMagnitude();
    glyphs->OrientOff();
    this->LineMapper[pass]->SetInputData(this->LatticePolyLines.Data);
    this->OutlineMapper[pass]->SetInputData(this->OutlinePolyLines.Data);
    vtkActor* const actors[NumberOfParts] = { pass ? this->Hidden[Points] : this->Front[Points],
      pass ? this->Hidden[LatticeLines] : this->Front[LatticeLines],
      pass ? this->Hidden[Outline] : this->Front[Outline] };
    actors[Points]->SetMapper(glyphs);
    actors[LatticeLines]->SetMapper(this->LineMapper[pass]);
    actors[Outline]->SetMapper(this->OutlineMapper[pass]);
    for (vtkActor* actor : actors)
    {
      actor->PickableOff();
      if (pass == 1)
      {
        actor->ForceTranslucentOn();
      }
    }
  }
  this->HandleMapper->SetInputData(this->HandleData);
  this->HandleMapper->SetScalarModeToUseCellData();
  this->HandleActor->SetMapper(this->HandleMapper);
  this->HandleActor->PickableOff();
  this->HandleActor->ForceTranslucentOn();

  this->BandPoints->SetNumberOfPoints(4);
  this->BandData->SetPoints(this->BandPoints);
  vtkNew<vtkCellArray> band;
  const vtkIdType corners[5] = { 0, 1, 2, 3, 0 };
  band->InsertNextCell(5, corners);
  this->BandData->SetLines(band);
  this->BandMapper->SetInputData(this->BandData);
  this->BandActor->SetMapper(this->BandMapper);
  this->BandActor->GetProperty()->SetColor(1.0, 1.0, 1.0);
  this->BandActor->GetProperty()->SetLineWidth(1.5f);
  this->BandActor->PickableOff();
  this->BandActor->VisibilityOff();

  this->LabelMapper->SetInputData(this->LabelData);
  this->LabelMapper->SetLabelModeToLabelFieldData();
  this->LabelMapper->SetFieldDataName("Label");
  this->LabelMapper->GetLabelTextProperty()->SetFontSize(12);
  this->LabelMapper->GetLabelTextProperty()->ItalicOff();
  this->LabelMapper->GetLabelTextProperty()->BoldOff();
  this->LabelMapper->GetLabelTextProperty()->ShadowOff();
  this->LabelActor->SetMapper(this->LabelMapper);
  this->LabelActor->PickableOff();
  this->LabelActor->VisibilityOff();
}

//------------------------------------------------------------------------------
vtkFFDLatticeScene::~vtkFFDLatticeScene() = default;

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::SetGlyphs(const std::vector<Glyph>& glyphs)
{
  const vtkIdType count = static_cast<vtkIdType>(glyphs.size());
  const GlyphLevel* level = GlyphLevels;
  while (glyphs.size() > level->AtMost)
  {
    ++level;
  }
  this->Sphere->SetThetaResolution(level->Theta);
  this->Sphere->SetPhiResolution(level->Phi);
  this->GlyphPoints->SetNumberOfPoints(count);
  this->GlyphColours->SetNumberOfTuples(count);
  this->Diameters.resize(glyphs.size());
  for (vtkIdType g = 0; g < count; ++g)
  {
    const Glyph& glyph = glyphs[static_cast<std::size_t>(g)];
    this->GlyphPoints->SetPoint(g, &glyph.Position.x);
    this->GlyphColours->SetTypedTuple(g, glyph.Rgb.data());
    this->Diameters[static_cast<std::size_t>(g)] = glyph.Diameter;
  }
  this->GlyphPoints->Modified();
  this->GlyphColours->Modified();
  this->GlyphData->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::ScaleGlyphs(const vtkFFDProjection& projection)
{
  const vtkIdType count = this->GlyphPoints->GetNumberOfPoints();
  this->GlyphSizes->SetNumberOfTuples(count);
  for (vtkIdType g = 0; g < count; ++g)
  {
    double p[3];
    this->GlyphPoints->GetPoint(g, p);
    this->GlyphSizes->SetValue(g,
      this->Diameters[static_cast<std::size_t>(g)] *
        projection.GetPixelSize({ p[0], p[1], p[2] }));
  }
  this->GlyphSizes->Modified();
  this->GlyphData->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::SetLines(const Lines& lines) { this->LatticePolyLines.Set(lines); }

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::SetOutline(const Lines& lines) { this->OutlinePolyLines.Set(lines); }

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::SetHandle(const std::vector<Shape>& shapes)
{
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> lines;
  vtkNew<vtkCellArray> triangles;
  vtkNew<vtkUnsignedCharArray> lineColours;
  lineColours->SetNumberOfComponents(3);
  vtkNew<vtkUnsignedCharArray> triangleColours;
  triangleColours->SetNumberOfComponents(3);
  for (const Shape& shape : shapes)
  {
    if (!shape.Line.empty())
    {
      lines->InsertNextCell(static_cast<int>(shape.Line.size()));
      for (const glm::dvec3& p : shape.Line)
      {
        lines->InsertCellPoint(points->InsertNextPoint(&p.x));
      }
      lineColours->InsertNextTypedTuple(shape.Rgb.data());
    }
    for (std::size_t t = 0; t + 2 < shape.Triangles.size(); t += 3)
    {
      triangles->InsertNextCell(3);
      for (std::size_t c = 0; c < 3; ++c)
      {
        triangles->InsertCellPoint(points->InsertNextPoint(&shape.Triangles[t + c].x));
      }
      triangleColours->InsertNextTypedTuple(shape.Rgb.data());
    }
  }
  // Cell data lists lines before polygons.
  for (vtkIdType t = 0; t < triangleColours->GetNumberOfTuples(); ++t)
  {
    unsigned char rgb[3];
    triangleColours->GetTypedTuple(t, rgb);
    lineColours->InsertNextTypedTuple(rgb);
  }
  this->HandleData->SetPoints(points);
  this->HandleData->SetLines(lines);
  this->HandleData->SetPolys(triangles);
  this->HandleData->GetCellData()->SetScalars(lineColours);
  this->HandleData->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::SetRubberBand(const glm::dvec2& a, const glm::dvec2& b)
{
  this->BandPoints->SetPoint(0, a.x, a.y, 0.0);
  this->BandPoints->SetPoint(1, b.x, a.y, 0.0);
  this->BandPoints->SetPoint(2, b.x, b.y, 0.0);
  this->BandPoints->SetPoint(3, a.x, b.y, 0.0);
  this->BandPoints->Modified();
  this->BandData->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::SetLabels(const std::vector<Label>& labels)
{
  vtkNew<vtkPoints> points;
  vtkNew<vtkStringArray> texts;
  texts->SetName("Label");
  vtkNew<vtkCellArray> vertices;
  for (const Label& label : labels)
  {
    const vtkIdType point = points->InsertNextPoint(&label.Position.x);
    vertices->InsertNextCell(1, &point);
    texts->InsertNextValue(label.Text);
  }
  this->LabelData->SetPoints(points);
  this->LabelData->SetVerts(vertices);
  this->LabelData->GetPointData()->AddArray(texts);
  this->LabelData->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::SetLook(const Look& look)
{
  vtkProperty* const properties[NumberOfParts] = { look.Points, look.Lines, look.Outline };
  const bool shown[NumberOfParts] = { look.ShowPoints, look.ShowLines, look.ShowOutline };
  this->HiddenOpacity = look.HiddenOpacity;
  for (int part = 0; part < NumberOfParts; ++part)
  {
    this->Shown[part] = shown[part];
    vtkProperty* front = this->Front[part]->GetProperty();
    front->DeepCopy(properties[part]);
    if (look.Warning && part != Points)
    {
      front->SetColor(look.Warning->GetColor());
    }
    vtkProperty* hidden = this->Hidden[part]->GetProperty();
    hidden->DeepCopy(front);
    hidden->SetOpacity(front->GetOpacity() * look.HiddenOpacity);
    hidden->LightingOff();
  }
  this->HandleShown = look.ShowHandle;
  this->HandleActor->GetProperty()->DeepCopy(look.Handle);
  this->BandActor->SetVisibility(look.ShowRubberBand);
  this->LabelActor->SetVisibility(look.ShowLabels && this->LabelData->GetNumberOfPoints() > 0);
}

//------------------------------------------------------------------------------
vtkProperty2D* vtkFFDLatticeScene::GetRubberBandProperty()
{
  return this->BandActor->GetProperty();
}

//------------------------------------------------------------------------------
vtkTextProperty* vtkFFDLatticeScene::GetLabelTextProperty()
{
  return this->LabelMapper->GetLabelTextProperty();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::GetActors(vtkPropCollection* actors)
{
  for (int part = 0; part < NumberOfParts; ++part)
  {
    if (this->Shown[part])
    {
      actors->AddItem(this->Front[part]);
    }
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::ReleaseGraphicsResources(vtkWindow* window)
{
  for (int part = 0; part < NumberOfParts; ++part)
  {
    this->Front[part]->ReleaseGraphicsResources(window);
    this->Hidden[part]->ReleaseGraphicsResources(window);
  }
  this->HandleActor->ReleaseGraphicsResources(window);
  this->BandActor->ReleaseGraphicsResources(window);
  this->LabelActor->ReleaseGraphicsResources(window);
}

//------------------------------------------------------------------------------
int vtkFFDLatticeScene::RenderOpaqueGeometry(vtkViewport* viewport)
{
  int rendered = 0;
  // A renderer asks its actors for their bounds, and by that a glyph mapper updates its source.
  // These actors belong to no renderer.
  for (vtkNew<vtkGlyph3DMapper>& glyphs : this->GlyphMapper)
  {
    glyphs->Update();
  }
  if (this->LabelActor->GetVisibility())
  {
    // The labels are made here, and drawn with the overlay.
    rendered += this->LabelActor->RenderOpaqueGeometry(viewport);
  }
  for (int part = 0; part < NumberOfParts; ++part)
  {
    if (this->Shown[part])
    {
      rendered += this->Front[part]->RenderOpaqueGeometry(viewport);
    }
  }
  return rendered;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeScene::RenderTranslucentPolygonalGeometry(vtkViewport* viewport)
{
  int rendered = 0;
  for (int part = 0; part < NumberOfParts; ++part)
  {
    if (this->Shown[part])
    {
      rendered += this->Front[part]->RenderTranslucentPolygonalGeometry(viewport);
    }
  }
  return rendered;
}

//------------------------------------------------------------------------------
bool vtkFFDLatticeScene::HasTranslucentPolygonalGeometry()
{
  bool has = false;
  for (int part = 0; part < NumberOfParts; ++part)
  {
    has = has || (this->Shown[part] && this->Front[part]->HasTranslucentPolygonalGeometry());
  }
  return has;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeScene::RenderOverlay(vtkViewport* viewport)
{
  int rendered = 0;
  auto* window = vtkOpenGLRenderWindow::SafeDownCast(viewport->GetVTKWindow());
  if (window)
  {
    vtkOpenGLState* state = window->GetState();
    vtkOpenGLState::ScopedglEnableDisable keepDepthTest(state, GlDepthTest);
    state->vtkglDisable(GlDepthTest);
    for (int part = NumberOfParts - 1; part >= 0; --part)
    {
      if (this->Shown[part] && this->HiddenOpacity > 0.0)
      {
        rendered += this->Hidden[part]->RenderTranslucentPolygonalGeometry(viewport);
      }
    }
    if (this->HandleShown)
    {
      rendered += this->HandleActor->RenderTranslucentPolygonalGeometry(viewport);
    }
  }
  for (vtkActor2D* actor : { this->BandActor.Get(), this->LabelActor.Get() })
  {
    if (actor->GetVisibility())
    {
      rendered += actor->RenderOverlay(viewport);
    }
  }
  return rendered;
}
