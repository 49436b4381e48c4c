// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this library: not installed.
#ifndef vtkFFDLatticeScene_h
#define vtkFFDLatticeScene_h

#include "vtkFFDProjection.h"

#include "vtkNew.h"
#include "vtkTimeStamp.h"
#include "vtkType.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

class vtkActor;
class vtkActor2D;
class vtkCellArray;
class vtkDoubleArray;
class vtkGlyph3DMapper;
class vtkInformation;
class vtkLabeledDataMapper;
class vtkMapper;
class vtkPoints;
class vtkPolyData;
class vtkPolyDataMapper;
class vtkPolyDataMapper2D;
class vtkPropCollection;
class vtkProperty;
class vtkProperty2D;
class vtkSphereSource;
class vtkTextProperty;
class vtkUnsignedCharArray;
class vtkViewport;
class vtkWindow;

/**
 * Draws the actors of the representation and their geometry, in world coordinates. Nothing here
 * knows of lattices. Everything is drawn as usual with the opaque (or translucent) geometry, and
 * once more, dimmed and through everything, with the overlay.
 *
 * A drag draws all of it with every step, perhaps by a software rasterizer, so that what did not
 * change is not touched: VTK makes buffers anew when a time stamp says so.
 */
class vtkFFDLatticeScene
{
public:
  using Color = std::array<unsigned char, 3>;

  vtkFFDLatticeScene();
  ~vtkFFDLatticeScene();

  /// A set of polylines of one look.
  struct Lines
  {
    std::vector<glm::dvec3> Points;
    std::vector<std::size_t> Ends; ///< one past the last point of each polyline
  };

  struct Glyph
  {
    glm::dvec3 Position;
    double Diameter; ///< pixels
    Color Rgb;
  };

  /// Lines and triangles of one color, of the handle.
  struct Shape
  {
    std::vector<glm::dvec3> Line;
    std::vector<glm::dvec3> Triangles;
    Color Rgb;
    unsigned char Alpha = 255;
  };

  struct Label
  {
    glm::dvec3 Position;
    std::string Text;
  };

  /// Balls: point sprites, or if they are too large for that, meshes.
  void SetGlyphs(const std::vector<Glyph>& glyphs);
  /// Keep the size on screen of those that are meshes.
  void ScaleGlyphs(const vtkFFDProjection& projection);
  void SetLines(const Lines& lines);
  /// Leave out points of lines that make no difference in this view. Those of SetLines() are all
  /// drawn until then.
  void SimplifyLines(const vtkFFDProjection& projection);
  void SetOutline(const Lines& lines);
  void SetHandle(const std::vector<Shape>& shapes);
  void SetRubberBand(const glm::dvec2& a, const glm::dvec2& b);
  void SetLabels(const std::vector<Label>& labels);

  struct Look
  {
    vtkProperty* Points;
    vtkProperty* Lines;
    vtkProperty* Outline;
    vtkProperty* Handle;
    vtkProperty* Warning; ///< null: none to be given
    double HiddenOpacity;
    bool ShowPoints;
    bool ShowLines;
    bool ShowOutline;
    bool ShowHandle;
    bool ShowRubberBand;
    bool ShowLabels;
  };
  void SetLook(const Look& look);

  vtkProperty2D* GetRubberBandProperty();
  vtkTextProperty* GetLabelTextProperty();

  void GetActors(vtkPropCollection* actors);
  void ReleaseGraphicsResources(vtkWindow* window);
  int RenderOpaqueGeometry(vtkViewport* viewport);
  /// The keys are those of the prop that this is part of: what depth peeling tells it.
  int RenderTranslucentPolygonalGeometry(vtkViewport* viewport, vtkInformation* passKeys);
  /// Draws the dimmed geometry in a part of the viewport.
  int RenderOverlay(vtkViewport* viewport, const vtkFFDPixelBox& part);
  bool HasTranslucentPolygonalGeometry();

private:
  vtkFFDLatticeScene(const vtkFFDLatticeScene&) = delete;
  void operator=(const vtkFFDLatticeScene&) = delete;

  /// Something that is drawn twice: as it is, and dimmed.
  struct Layer
  {
    vtkNew<vtkActor> Front;
    vtkNew<vtkActor> Hidden;
    bool Shown = true;
    double Diameter = 0.0; ///< pixels, of balls that are points; else 0
    double HiddenDiameter = 0.0;

    Layer();
    void SetMappers(vtkMapper* front, vtkMapper* hidden);
    void SetStyle(vtkProperty* property, vtkProperty* warning, double hiddenOpacity);

  private:
    /// Style that the properties of the actors were last made for.
    struct Style
    {
      vtkMTimeType Property = 0;
      vtkMTimeType Warning = 0;
      double HiddenOpacity = 0.0;
      double Diameter = 0.0;
      double HiddenDiameter = 0.0;
      bool operator==(const Style& other) const;
    };
    Style Made;
  };

  /// Polylines, of whose points only those are drawn that make a difference.
  struct PolyLines : Layer
  {
    vtkNew<vtkPolyData> Data;
    vtkNew<vtkPolyDataMapper> Mapper[2];
    std::vector<glm::vec3> Points;
    std::vector<std::size_t> Ends;
    std::vector<std::vector<std::size_t>> Drawn; ///< points of each line; empty: to be found
    double Tolerance = 0.0;                      ///< with which they were found
    glm::dvec3 Low{ 0.0 };                       ///< bounds
    glm::dvec3 High{ 0.0 };
    PolyLines();
    void Set(const Lines& lines);
    void Simplify(const vtkFFDProjection& projection);

  private:
    void Draw();
    std::vector<vtkIdType> CellOffsets; ///< as they are drawn
    std::vector<vtkIdType> CellPoints;
  };

  /// Balls of one size as points.
  struct Sprites : Layer
  {
    std::vector<float> Positions;
    std::vector<unsigned char> Colors;
    vtkNew<vtkPolyData> Data;
    vtkNew<vtkPolyDataMapper> Mapper[2];
    Sprites();
    void Set(const std::vector<float>& positions, const std::vector<unsigned char>& colors);
  };

  /// Balls of any size as meshes.
  struct Meshes : Layer
  {
    vtkNew<vtkSphereSource> Sphere;
    vtkNew<vtkSphereSource> CoarseSphere;
    vtkNew<vtkPolyData> Data;
    vtkNew<vtkPoints> Points;
    vtkNew<vtkDoubleArray> Sizes;
    vtkNew<vtkUnsignedCharArray> Colors;
    std::vector<double> Diameters;
    vtkNew<vtkGlyph3DMapper> Mapper[2];
    Meshes();
    void Set(const std::vector<Glyph>& glyphs);
    void Scale(const vtkFFDProjection& projection);
  };

  /// Layers that are shown, in the order in which they are drawn.
  std::vector<Layer*> GetShown();

  bool HandleShown = false;
  double HiddenOpacity = 0.25;

  std::vector<std::unique_ptr<Sprites>> SpriteSets; ///< one for each diameter
  Meshes LargeGlyphs;
  PolyLines LatticePolyLines;
  PolyLines OutlinePolyLines;

  vtkNew<vtkPolyData> HandleData;
  vtkNew<vtkPolyDataMapper> HandleMapper;
  vtkNew<vtkActor> HandleActor;
  vtkTimeStamp HandleStyleTime;

  vtkNew<vtkPolyData> BandData;
  vtkNew<vtkPoints> BandPoints;
  vtkNew<vtkPolyDataMapper2D> BandMapper;
  vtkNew<vtkActor2D> BandActor;

  vtkNew<vtkPolyData> LabelData;
  vtkNew<vtkLabeledDataMapper> LabelMapper;
  vtkNew<vtkActor2D> LabelActor;
};

#endif
