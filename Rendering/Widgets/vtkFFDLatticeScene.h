// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this library: not installed.
#ifndef vtkFFDLatticeScene_h
#define vtkFFDLatticeScene_h

#include "vtkNew.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <string>
#include <vector>

class vtkActor;
class vtkActor2D;
class vtkCellArray;
class vtkDoubleArray;
class vtkGlyph3DMapper;
class vtkLabeledDataMapper;
class vtkPoints;
class vtkPolyData;
class vtkPolyDataMapper;
class vtkPolyDataMapper2D;
class vtkPropCollection;
class vtkProperty;
class vtkProperty2D;
class vtkRenderer;
class vtkSphereSource;
class vtkTextProperty;
class vtkUnsignedCharArray;
class vtkViewport;
class vtkWindow;

/// How the world is seen: projections of many points at once, in pixels of the window.
struct vtkFFDProjection
{
  glm::dmat4 WorldToClip{ 1.0 };
  glm::dvec2 Origin{ 0.0 }; ///< lower left pixel of the viewport
  glm::dvec2 Size{ 1.0 };
  double PixelPerDepth = 0.0; ///< world units of a pixel at clip coordinate w = 1

  vtkFFDProjection() = default;
  explicit vtkFFDProjection(vtkRenderer* renderer);

  /// Display x, y and the depth (-1 near to 1 far); false behind the camera.
  bool ToDisplay(const glm::dvec3& world, glm::dvec3& display) const;
  /// World units of a pixel at a point; 0 behind the camera.
  double GetPixelSize(const glm::dvec3& world) const;
};

/**
 * What the representation draws, in world coordinates: the actors and their geometry. Nothing here
 * knows of lattices. Everything is drawn as usual with the opaque (or translucent) geometry, and
 * once more, dimmed and through everything, with the overlay.
 */
class vtkFFDLatticeScene
{
public:
  using Colour = std::array<unsigned char, 3>;

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
    Colour Rgb;
  };

  /// Lines and triangles of one colour, of the handle.
  struct Shape
  {
    std::vector<glm::dvec3> Line;
    std::vector<glm::dvec3> Triangles;
    Colour Rgb;
  };

  struct Label
  {
    glm::dvec3 Position;
    std::string Text;
  };

  void SetGlyphs(const std::vector<Glyph>& glyphs);
  /// Keep the glyphs' size on screen.
  void ScaleGlyphs(const vtkFFDProjection& projection);
  void SetLines(const Lines& lines);
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
  int RenderTranslucentPolygonalGeometry(vtkViewport* viewport);
  int RenderOverlay(vtkViewport* viewport);
  bool HasTranslucentPolygonalGeometry();

private:
  vtkFFDLatticeScene(const vtkFFDLatticeScene&) = delete;
  void operator=(const vtkFFDLatticeScene&) = delete;

  enum Parts
  {
    Points,
    LatticeLines,
    Outline,
    NumberOfParts
  };

  struct PolyLines
  {
    vtkNew<vtkPolyData> Data;
    vtkNew<vtkPoints> Points;
    std::vector<std::size_t> Ends;
    PolyLines();
    void Set(const Lines& lines);
  };

  bool Shown[NumberOfParts] = { true, true, true };
  bool HandleShown = false;
  double HiddenOpacity = 0.25;

  vtkNew<vtkActor> Front[NumberOfParts];
  vtkNew<vtkActor> Hidden[NumberOfParts];

  vtkNew<vtkSphereSource> Sphere;
  vtkNew<vtkSphereSource> CoarseSphere;
  vtkNew<vtkPolyData> GlyphData;
  vtkNew<vtkPoints> GlyphPoints;
  vtkNew<vtkDoubleArray> GlyphSizes;
  vtkNew<vtkUnsignedCharArray> GlyphColours;
  std::vector<double> Diameters;
  vtkNew<vtkGlyph3DMapper> GlyphMapper[2];

  PolyLines LatticePolyLines;
  PolyLines OutlinePolyLines;
  vtkNew<vtkPolyDataMapper> LineMapper[2];
  vtkNew<vtkPolyDataMapper> OutlineMapper[2];

  vtkNew<vtkPolyData> HandleData;
  vtkNew<vtkPolyDataMapper> HandleMapper;
  vtkNew<vtkActor> HandleActor;

  vtkNew<vtkPolyData> BandData;
  vtkNew<vtkPoints> BandPoints;
  vtkNew<vtkPolyDataMapper2D> BandMapper;
  vtkNew<vtkActor2D> BandActor;

  vtkNew<vtkPolyData> LabelData;
  vtkNew<vtkLabeledDataMapper> LabelMapper;
  vtkNew<vtkActor2D> LabelActor;
};

#endif
