// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDLatticeScene.h"

#include "vtkActor.h"
#include "vtkActor2D.h"
#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkGlyph3DMapper.h"
#include "vtkIdTypeArray.h"
#include "vtkLabeledDataMapper.h"
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
#include "vtkShaderProperty.h"
#include "vtkSphereSource.h"
#include "vtkStringArray.h"
#include "vtkTextProperty.h"
#include "vtkUniforms.h"
#include "vtkUnsignedCharArray.h"
#include "vtkViewport.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

namespace
{

/// GL_DEPTH_TEST: the loaders of OpenGL have other names in other versions of VTK.
constexpr unsigned int GlDepthTest = 0x0B71;
/// GL_SCISSOR_TEST
constexpr unsigned int GlScissorTest = 0x0C11;

/// Pixels. OpenGL has larger points almost everywhere, but promises none.
constexpr double LargestSprite = 60.0;

/// Balls are the smaller the more there are, so that they do not cover what they are to shape; as
/// meshes, which are for large ones, they are as fine as their number allows: of 120, 24 or 8
/// triangles.
struct GlyphLevel
{
  std::size_t AtMost;
  double Size;
  int Theta;
  int Phi;
};
constexpr GlyphLevel GlyphLevels[] = { { 150, 1.0, 10, 8 }, { 400, 0.9, 6, 4 },
  { SIZE_MAX, 0.75, 4, 3 } };

const GlyphLevel& GetLevel(std::size_t count)
{
  const GlyphLevel* level = GlyphLevels;
  while (count > level->AtMost)
  {
    ++level;
  }
  return *level;
}

/// Size of dimmed points, however many there are.
constexpr double HiddenSize = 0.75;

/// Place in the fragment shader of vtkPolyDataMapper where depth is set, before lighting.
constexpr const char* DepthTag = "//VTK::Depth::Impl";
/// Place at the end of its vertex shader.
constexpr const char* VertexTag = "//VTK::CustomEnd::Impl";

/// Pixels by which lines may differ from those through all their points.
constexpr double LineTolerance = 0.1;

/// The ends of a polyline, and of the points from start to before end those that are needed to stay
/// within a tolerance of the rest (Douglas and Peucker 1973).
std::vector<std::size_t> FindPointsToDraw(
  const std::vector<glm::vec3>& points, std::size_t start, std::size_t end, double tolerance)
{
  std::vector<std::size_t> drawn = { start };
  std::vector<std::size_t> ends = { end - 1 }; // of pieces that begin at the last drawn point
  while (!ends.empty())
  {
    const std::size_t first = drawn.back();
    const std::size_t last = ends.back();
    const glm::dvec3 origin(points[first]);
    const glm::dvec3 along = glm::dvec3(points[last]) - origin;
    const double length2 = glm::dot(along, along);
    double farthest2 = tolerance * tolerance;
    std::size_t at = last;
    for (std::size_t p = first + 1; p < last; ++p)
    {
      const glm::dvec3 from = glm::dvec3(points[p]) - origin;
      const double t = length2 > 0.0 ? glm::clamp(glm::dot(from, along) / length2, 0.0, 1.0) : 0.0;
      const glm::dvec3 off = from - t * along;
      const double distance2 = glm::dot(off, off);
      // Also true of what is no number, which is left as it is.
      if (!(distance2 <= farthest2))
      {
        farthest2 = distance2;
        at = p;
      }
    }
    if (at == last)
    {
      ends.pop_back();
      if (last > first)
      {
        drawn.push_back(last);
      }
    }
    else
    {
      ends.push_back(at);
    }
  }
  return drawn;
}

/// The code at the end of vtkPolyDataMapper's fragment shader that discards empty fragments. Lines
/// have none; without it their depth is tested before they are colored. Nothing is replaced where a
/// version of VTK has other code.
constexpr const char* EmptyFragments =
  "  if (gl_FragData[0].a <= 0.0)\n    {\n    discard;\n    }\n";

/// The fragments of a disc.
constexpr const char* DiscShader =
  "vec2 place = vec2(2.0 * gl_PointCoord.x - 1.0, 1.0 - 2.0 * gl_PointCoord.y);\n"
  "  float square = dot(place, place);\n"
  "  if (square > 1.0) { discard; }\n";

/// Lit as a ball, as those of vtkProperty::RenderPointsAsSpheres, but as deep as its front all
/// over: fragments with a depth of their own are not skipped where something is in front of them.
constexpr const char* BallShader = "  vec3 normalVCVSOutput = vec3(place, sqrt(1.0 - square));\n";
constexpr const char* BallVertexShader = "gl_Position.z += ballFront;\n  //VTK::CustomEnd::Impl\n";
constexpr const char* BallFront = "ballFront";

} // namespace

//------------------------------------------------------------------------------
vtkFFDLatticeScene::Layer::Layer()
{
  this->Front->PickableOff();
  this->Hidden->PickableOff();
  this->Hidden->ForceTranslucentOn();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::Layer::SetMappers(vtkMapper* front, vtkMapper* hidden)
{
  this->Front->SetMapper(front);
  this->Hidden->SetMapper(hidden);
}

//------------------------------------------------------------------------------
bool vtkFFDLatticeScene::Layer::Style::operator==(const Style& other) const
{
  return this->Property == other.Property && this->Warning == other.Warning &&
    this->HiddenOpacity == other.HiddenOpacity && this->Diameter == other.Diameter &&
    this->HiddenDiameter == other.HiddenDiameter;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::Layer::SetStyle(
  vtkProperty* property, vtkProperty* warning, double hiddenOpacity)
{
  const Style style = { property->GetMTime(), warning ? warning->GetMTime() : 0, hiddenOpacity,
    this->Diameter, this->HiddenDiameter };
  if (style == this->Made)
  {
    return;
  }
  this->Made = style;
  vtkProperty* front = this->Front->GetProperty();
  front->DeepCopy(property);
  if (warning)
  {
    front->SetColor(warning->GetColor());
  }
  double dimmed = front->GetOpacity() * hiddenOpacity;
  const bool sprites = this->Diameter > 0.0;
  if (sprites)
  {
    front->SetPointSize(static_cast<float>(this->Diameter));
    front->RenderPointsAsSpheresOn();
    // Balls cover more than lines do: as dim as those of vtkGlyph3DMapper, which draws the near and
    // the far side of each with the square of the opacity.
    const double side = hiddenOpacity * hiddenOpacity;
    dimmed = front->GetOpacity() * (1.0 - (1.0 - side) * (1.0 - side));
  }
  vtkProperty* hidden = this->Hidden->GetProperty();
  hidden->DeepCopy(front);
  hidden->SetOpacity(dimmed);
  hidden->LightingOff();
  if (sprites)
  {
    hidden->SetPointSize(static_cast<float>(this->HiddenDiameter));
    hidden->RenderPointsAsSpheresOff();
    vtkShaderProperty* disc = this->Hidden->GetShaderProperty();
    disc->ClearAllShaderReplacements();
    disc->AddFragmentShaderReplacement(DepthTag, true, DiscShader, false);
    vtkShaderProperty* ball = this->Front->GetShaderProperty();
    ball->ClearAllShaderReplacements();
    // Translucent ones may be peeled, which needs the depth of each fragment: VTK's own shader.
    if (front->GetOpacity() == 1.0)
    {
      ball->AddVertexShaderReplacement(VertexTag, true, BallVertexShader, false);
      ball->AddFragmentShaderReplacement(
        DepthTag, true, std::string(DiscShader) + BallShader, false);
      // Until there is a view to scale them for.
      ball->GetVertexCustomUniforms()->SetUniformf(BallFront, 0.0f);
    }
  }
}

//------------------------------------------------------------------------------
vtkFFDLatticeScene::PolyLines::PolyLines()
{
  this->SetMappers(this->Mapper[0], this->Mapper[1]);
  for (vtkActor* actor : { this->Front.Get(), this->Hidden.Get() })
  {
    actor->GetShaderProperty()->AddFragmentShaderReplacement(EmptyFragments, true, "", false);
  }
  for (vtkNew<vtkPolyDataMapper>& mapper : this->Mapper)
  {
    mapper->SetInputData(this->Data);
    mapper->StaticOn(); // the data come from no pipeline
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::PolyLines::Set(const Lines& lines)
{
  std::vector<glm::vec3> points(lines.Points.begin(), lines.Points.end());
  const bool cells = lines.Ends != this->Ends;
  if (!cells && points == this->Points)
  {
    return;
  }
  if (cells)
  {
    this->Drawn.assign(lines.Ends.size(), {});
  }
  else
  {
    std::size_t start = 0;
    for (std::size_t line = 0; line < lines.Ends.size(); ++line)
    {
      const std::size_t end = lines.Ends[line];
      if (!std::equal(points.begin() + static_cast<std::ptrdiff_t>(start),
            points.begin() + static_cast<std::ptrdiff_t>(end),
            this->Points.begin() + static_cast<std::ptrdiff_t>(start)))
      {
        this->Drawn[line].clear();
      }
      start = end;
    }
  }
  this->Points.swap(points);
  this->Ends = lines.Ends;
  this->Low = glm::dvec3(std::numeric_limits<double>::infinity());
  this->High = -this->Low;
  vtkNew<vtkFloatArray> array;
  array->SetNumberOfComponents(3);
  array->SetNumberOfTuples(static_cast<vtkIdType>(this->Points.size()));
  float* to = array->GetPointer(0);
  for (const glm::vec3& p : this->Points)
  {
    to = std::copy_n(&p.x, 3, to);
    this->Low = glm::min(this->Low, glm::dvec3(p));
    this->High = glm::max(this->High, glm::dvec3(p));
  }
  vtkNew<vtkPoints> data;
  data->SetData(array);
  this->Data->SetPoints(data);
  this->Draw();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::PolyLines::Simplify(const vtkFFDProjection& projection)
{
  double pixel = std::numeric_limits<double>::infinity();
  for (int corner = 0; corner < 8; ++corner)
  {
    // 0 where it is behind the camera.
    pixel = std::min(pixel,
      projection.GetPixelSize({ corner & 1 ? this->High.x : this->Low.x,
        corner & 2 ? this->High.y : this->Low.y, corner & 4 ? this->High.z : this->Low.z }));
  }
  const double allowed = std::isfinite(pixel) ? LineTolerance * pixel : 0.0;
  // Another one only if it must be, or if much is to be gained.
  if (this->Tolerance > allowed || this->Tolerance < 0.25 * allowed)
  {
    this->Tolerance = 0.7 * allowed;
    this->Drawn.assign(this->Ends.size(), {});
  }
  bool changed = false;
  std::size_t start = 0;
  for (std::size_t line = 0; line < this->Ends.size(); ++line)
  {
    const std::size_t end = this->Ends[line];
    if (this->Drawn[line].empty() && end > start)
    {
      this->Drawn[line] = FindPointsToDraw(this->Points, start, end, this->Tolerance);
      changed = true;
    }
    start = end;
  }
  if (changed)
  {
    this->Draw();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::PolyLines::Draw()
{
  std::vector<vtkIdType> offsets = { 0 };
  std::vector<vtkIdType> points;
  std::size_t start = 0;
  for (std::size_t line = 0; line < this->Ends.size(); ++line)
  {
    if (this->Drawn[line].empty())
    {
      for (std::size_t p = start; p < this->Ends[line]; ++p)
      {
        points.push_back(static_cast<vtkIdType>(p));
      }
    }
    for (std::size_t p : this->Drawn[line])
    {
      points.push_back(static_cast<vtkIdType>(p));
    }
    offsets.push_back(static_cast<vtkIdType>(points.size()));
    start = this->Ends[line];
  }
  // Index buffers are made anew when the cells are.
  if (offsets == this->CellOffsets && points == this->CellPoints)
  {
    return;
  }
  const auto toArray = [](const std::vector<vtkIdType>& values) {
    vtkNew<vtkIdTypeArray> array;
    array->SetNumberOfValues(static_cast<vtkIdType>(values.size()));
    std::copy(values.begin(), values.end(), array->GetPointer(0));
    return array;
  };
  vtkNew<vtkCellArray> cells;
  cells->SetData(toArray(offsets), toArray(points));
  this->Data->SetLines(cells);
  this->CellOffsets.swap(offsets);
  this->CellPoints.swap(points);
}

//------------------------------------------------------------------------------
vtkFFDLatticeScene::Sprites::Sprites()
{
  this->SetMappers(this->Mapper[0], this->Mapper[1]);
  for (vtkNew<vtkPolyDataMapper>& mapper : this->Mapper)
  {
    mapper->SetInputData(this->Data);
    mapper->StaticOn(); // the data come from no pipeline
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::Sprites::Set(
  const std::vector<float>& positions, const std::vector<unsigned char>& colors)
{
  const auto count = static_cast<vtkIdType>(positions.size() / 3);
  if (positions.size() != this->Positions.size())
  {
    vtkNew<vtkIdTypeArray> cell;
    cell->SetNumberOfValues(count);
    std::iota(cell->GetPointer(0), cell->GetPointer(0) + count, 0);
    vtkNew<vtkCellArray> vertices;
    vertices->InsertNextCell(count, cell->GetPointer(0));
    this->Data->SetVerts(vertices);
  }
  if (positions != this->Positions)
  {
    this->Positions = positions;
    vtkNew<vtkFloatArray> array;
    array->SetNumberOfComponents(3);
    array->SetNumberOfTuples(count);
    std::copy(positions.begin(), positions.end(), array->GetPointer(0));
    vtkNew<vtkPoints> points;
    points->SetData(array);
    this->Data->SetPoints(points);
  }
  if (colors != this->Colors)
  {
    this->Colors = colors;
    vtkNew<vtkUnsignedCharArray> array;
    array->SetNumberOfComponents(3);
    array->SetNumberOfTuples(count);
    std::copy(colors.begin(), colors.end(), array->GetPointer(0));
    this->Data->GetPointData()->SetScalars(array);
  }
}

//------------------------------------------------------------------------------
vtkFFDLatticeScene::Meshes::Meshes()
{
  this->Sphere->SetRadius(0.5);
  this->CoarseSphere->SetRadius(0.5);
  this->CoarseSphere->SetThetaResolution(4);
  this->CoarseSphere->SetPhiResolution(3);
  this->Points->SetDataTypeToFloat();
  this->Data->SetPoints(this->Points);
  this->Sizes->SetName("Size");
  this->Colors->SetName("Color");
  this->Colors->SetNumberOfComponents(3);
  this->Data->GetPointData()->AddArray(this->Sizes);
  this->Data->GetPointData()->SetScalars(this->Colors);
  this->SetMappers(this->Mapper[0], this->Mapper[1]);
  for (int pass = 0; pass < 2; ++pass)
  {
    vtkGlyph3DMapper* mapper = this->Mapper[pass];
    mapper->SetInputData(this->Data);
    mapper->SetSourceConnection((pass == 0 ? this->Sphere : this->CoarseSphere)->GetOutputPort());
    mapper->SetScaleArray("Size");
    mapper->SetScaleModeToScaleByMagnitude();
    mapper->OrientOff();
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::Meshes::Set(const std::vector<Glyph>& glyphs)
{
  if (glyphs.empty() && this->Diameters.empty())
  {
    return;
  }
  const vtkIdType count = static_cast<vtkIdType>(glyphs.size());
  const GlyphLevel& level = GetLevel(glyphs.size());
  this->Sphere->SetThetaResolution(level.Theta);
  this->Sphere->SetPhiResolution(level.Phi);
  this->Points->SetNumberOfPoints(count);
  this->Colors->SetNumberOfTuples(count);
  if (count != this->Sizes->GetNumberOfTuples())
  {
    // Until there is a view that tells how large they are.
    this->Sizes->SetNumberOfTuples(count);
    this->Sizes->FillValue(0.0);
  }
  this->Diameters.resize(glyphs.size());
  for (vtkIdType g = 0; g < count; ++g)
  {
    const Glyph& glyph = glyphs[static_cast<std::size_t>(g)];
    this->Points->SetPoint(g, &glyph.Position.x);
    this->Colors->SetTypedTuple(g, glyph.Rgb.data());
    this->Diameters[static_cast<std::size_t>(g)] = glyph.Diameter;
  }
  this->Points->Modified();
  this->Colors->Modified();
  this->Data->Modified();
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::Meshes::Scale(const vtkFFDProjection& projection)
{
  if (this->Diameters.empty())
  {
    return;
  }
  const vtkIdType count = this->Points->GetNumberOfPoints();
  for (vtkIdType g = 0; g < count; ++g)
  {
    double p[3];
    this->Points->GetPoint(g, p);
    this->Sizes->SetValue(g,
      this->Diameters[static_cast<std::size_t>(g)] * projection.GetPixelSize({ p[0], p[1], p[2] }));
  }
  this->Sizes->Modified();
  this->Data->Modified();
}

//------------------------------------------------------------------------------
vtkFFDLatticeScene::vtkFFDLatticeScene()
{
  this->HandleMapper->SetInputData(this->HandleData);
  this->HandleMapper->StaticOn();
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
  struct Set
  {
    double Diameter;
    std::vector<float> Positions;
    std::vector<unsigned char> Colors;
  };
  std::vector<Set> sets;
  std::vector<Glyph> large;
  const GlyphLevel& level = GetLevel(glyphs.size());
  for (const Glyph& glyph : glyphs)
  {
    if (glyph.Diameter > LargestSprite)
    {
      large.push_back(glyph);
      continue;
    }
    const double diameter = level.Size * glyph.Diameter;
    auto set = std::find_if(sets.begin(), sets.end(),
      [diameter](const Set& other) { return other.Diameter == diameter; });
    if (set == sets.end())
    {
      set = sets.insert(sets.end(), Set{ diameter, {}, {} });
    }
    for (int a = 0; a < 3; ++a)
    {
      set->Positions.push_back(static_cast<float>(glyph.Position[a]));
    }
    set->Colors.insert(set->Colors.end(), glyph.Rgb.begin(), glyph.Rgb.end());
  }
  this->LargeGlyphs.Set(large);
  // Each in the place of those of its size, so that only those are made anew that changed.
  const auto find = [this](double diameter) {
    return std::find_if(this->SpriteSets.begin(), this->SpriteSets.end(),
      [diameter](const std::unique_ptr<Sprites>& one) { return one->Diameter == diameter; });
  };
  for (std::unique_ptr<Sprites>& old : this->SpriteSets)
  {
    if (std::none_of(sets.begin(), sets.end(),
          [&old](const Set& set) { return set.Diameter == old->Diameter; }))
    {
      old->Diameter = 0.0;
    }
  }
  for (const Set& set : sets)
  {
    auto place = find(set.Diameter);
    if (place == this->SpriteSets.end())
    {
      place = find(0.0);
    }
    if (place == this->SpriteSets.end())
    {
      place = this->SpriteSets.insert(place, std::make_unique<Sprites>());
    }
    (*place)->Diameter = set.Diameter;
    (*place)->HiddenDiameter = HiddenSize / level.Size * set.Diameter;
    (*place)->Set(set.Positions, set.Colors);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::ScaleGlyphs(const vtkFFDProjection& projection)
{
  this->LargeGlyphs.Scale(projection);
  for (const std::unique_ptr<Sprites>& sprites : this->SpriteSets)
  {
    sprites->Front->GetShaderProperty()->GetVertexCustomUniforms()->SetUniformf(
      BallFront, static_cast<float>(projection.GetPointShift(0.5 * sprites->Diameter)));
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::SetLines(const Lines& lines) { this->LatticePolyLines.Set(lines); }

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::SimplifyLines(const vtkFFDProjection& projection)
{
  this->LatticePolyLines.Simplify(projection);
  this->OutlinePolyLines.Simplify(projection);
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::SetOutline(const Lines& lines) { this->OutlinePolyLines.Set(lines); }

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::SetHandle(const std::vector<Shape>& shapes)
{
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> lines;
  vtkNew<vtkCellArray> triangles;
  // Colors belong to points: colors of cells would be a texture, which is slow to make.
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetNumberOfComponents(4);
  for (const Shape& shape : shapes)
  {
    const unsigned char rgba[4] = { shape.Rgb[0], shape.Rgb[1], shape.Rgb[2], shape.Alpha };
    const auto insert = [&](const glm::dvec3& p) {
      colors->InsertNextTypedTuple(rgba);
      return points->InsertNextPoint(&p.x);
    };
    if (!shape.Line.empty())
    {
      lines->InsertNextCell(static_cast<int>(shape.Line.size()));
      for (const glm::dvec3& p : shape.Line)
      {
        lines->InsertCellPoint(insert(p));
      }
    }
    for (std::size_t t = 0; t + 2 < shape.Triangles.size(); t += 3)
    {
      triangles->InsertNextCell(3);
      for (std::size_t c = 0; c < 3; ++c)
      {
        triangles->InsertCellPoint(insert(shape.Triangles[t + c]));
      }
    }
  }
  this->HandleData->SetPoints(points);
  this->HandleData->SetLines(lines);
  this->HandleData->SetPolys(triangles);
  this->HandleData->GetPointData()->SetScalars(colors);
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
  this->HiddenOpacity = look.HiddenOpacity;
  this->LargeGlyphs.Shown = look.ShowPoints && !this->LargeGlyphs.Diameters.empty();
  this->LargeGlyphs.SetStyle(look.Points, nullptr, look.HiddenOpacity);
  for (std::unique_ptr<Sprites>& sprites : this->SpriteSets)
  {
    sprites->Shown = look.ShowPoints && sprites->Diameter > 0.0;
    if (sprites->Shown)
    {
      sprites->SetStyle(look.Points, nullptr, look.HiddenOpacity);
    }
  }
  this->LatticePolyLines.Shown = look.ShowLines;
  this->LatticePolyLines.SetStyle(look.Lines, look.Warning, look.HiddenOpacity);
  this->OutlinePolyLines.Shown = look.ShowOutline;
  this->OutlinePolyLines.SetStyle(look.Outline, look.Warning, look.HiddenOpacity);
  this->HandleShown = look.ShowHandle;
  if (look.Handle->GetMTime() > this->HandleStyleTime)
  {
    this->HandleActor->GetProperty()->DeepCopy(look.Handle);
    this->HandleStyleTime.Modified();
  }
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
std::vector<vtkFFDLatticeScene::Layer*> vtkFFDLatticeScene::GetShown()
{
  std::vector<Layer*> shown;
  for (const std::unique_ptr<Sprites>& sprites : this->SpriteSets)
  {
    shown.push_back(sprites.get());
  }
  shown.push_back(&this->LargeGlyphs);
  shown.push_back(&this->LatticePolyLines);
  shown.push_back(&this->OutlinePolyLines);
  shown.erase(
    std::remove_if(shown.begin(), shown.end(), [](const Layer* layer) { return !layer->Shown; }),
    shown.end());
  return shown;
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::GetActors(vtkPropCollection* actors)
{
  for (Layer* layer : this->GetShown())
  {
    actors->AddItem(layer->Front);
  }
}

//------------------------------------------------------------------------------
void vtkFFDLatticeScene::ReleaseGraphicsResources(vtkWindow* window)
{
  for (Layer* layer :
    { static_cast<Layer*>(&this->LargeGlyphs), static_cast<Layer*>(&this->LatticePolyLines),
      static_cast<Layer*>(&this->OutlinePolyLines) })
  {
    layer->Front->ReleaseGraphicsResources(window);
    layer->Hidden->ReleaseGraphicsResources(window);
  }
  for (const std::unique_ptr<Sprites>& sprites : this->SpriteSets)
  {
    sprites->Front->ReleaseGraphicsResources(window);
    sprites->Hidden->ReleaseGraphicsResources(window);
  }
  this->HandleActor->ReleaseGraphicsResources(window);
  this->BandActor->ReleaseGraphicsResources(window);
  this->LabelActor->ReleaseGraphicsResources(window);
}

//------------------------------------------------------------------------------
int vtkFFDLatticeScene::RenderOpaqueGeometry(vtkViewport* viewport)
{
  int rendered = 0;
  if (this->LabelActor->GetVisibility())
  {
    // The labels are made here, and drawn with the overlay.
    rendered += this->LabelActor->RenderOpaqueGeometry(viewport);
  }
  if (this->LargeGlyphs.Shown)
  {
    // A renderer asks its actors for their bounds, and by that a glyph mapper updates its source.
    // These actors belong to no renderer.
    for (vtkNew<vtkGlyph3DMapper>& mapper : this->LargeGlyphs.Mapper)
    {
      mapper->Update();
    }
  }
  for (Layer* layer : this->GetShown())
  {
    rendered += layer->Front->RenderOpaqueGeometry(viewport);
  }
  return rendered;
}

//------------------------------------------------------------------------------
int vtkFFDLatticeScene::RenderTranslucentPolygonalGeometry(
  vtkViewport* viewport, vtkInformation* passKeys)
{
  int rendered = 0;
  for (Layer* layer : this->GetShown())
  {
    layer->Front->SetPropertyKeys(passKeys);
    rendered += layer->Front->RenderTranslucentPolygonalGeometry(viewport);
  }
  return rendered;
}

//------------------------------------------------------------------------------
bool vtkFFDLatticeScene::HasTranslucentPolygonalGeometry()
{
  const std::vector<Layer*> shown = this->GetShown();
  return std::any_of(shown.begin(), shown.end(),
    [](Layer* layer) { return layer->Front->HasTranslucentPolygonalGeometry() != 0; });
}

//------------------------------------------------------------------------------
int vtkFFDLatticeScene::RenderOverlay(vtkViewport* viewport, const vtkFFDPixelBox& part)
{
  int rendered = 0;
  auto* window = vtkOpenGLRenderWindow::SafeDownCast(viewport->GetVTKWindow());
  if (window)
  {
    vtkOpenGLState* state = window->GetState();
    vtkOpenGLState::ScopedglEnableDisable keepDepthTest(state, GlDepthTest);
    state->vtkglDisable(GlDepthTest);
    if (this->HiddenOpacity > 0.0 && !part.IsEmpty())
    {
      vtkOpenGLState::ScopedglEnableDisable keepScissorTest(state, GlScissorTest);
      vtkOpenGLState::ScopedglScissor keepScissor(state);
      state->vtkglEnable(GlScissorTest);
      state->vtkglScissor(
        part.Low.x, part.Low.y, part.High.x - part.Low.x, part.High.y - part.Low.y);
      std::vector<Layer*> shown = this->GetShown();
      std::reverse(shown.begin(), shown.end());
      for (Layer* layer : shown)
      {
        rendered += layer->Hidden->RenderTranslucentPolygonalGeometry(viewport);
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
