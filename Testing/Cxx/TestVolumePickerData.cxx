// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// vtkFFDVolumePicker on all kinds of data: several components, scalars of cells, rectilinear grids,
// masks, blanked points and cells, several volumes. Without deformation against vtkVolumePicker
// where that knows the data; deformed against the closed form of what is visible, along the ray.
#include "FFDTestPick.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkHardwareSelector.h"
#include "vtkPropPicker.h"
#include "vtkRectilinearGrid.h"
#include "vtkSelection.h"

#include <algorithm>
#include <functional>

namespace
{

using namespace ffdTest;

constexpr int Dims[3] = { 20, 18, 16 };
constexpr double Middle[3] = { 9.5, 8.5, 7.5 };
/// Scalars at the surface: the opacity functions of this test exceed 0.5 above them.
constexpr double Level = 100.0;
constexpr double SecondLevel = 50.0;

/// Functions of the position that fall towards the camera; interpolation reproduces them.
double First(const double* p) { return 200.0 - 5.0 * p[0] - 3.0 * p[1] - 4.0 * p[2]; }
double Second(const double* p) { return 120.0 + 2.0 * p[0] - 9.0 * p[1] - 1.0 * p[2]; }
/// Voxels beyond the surface, about; negative: in front of it.
double DepthOfFirst(const double* p, double level = Level) { return (First(p) - level) / 7.1; }
double DepthOfSecond(const double* p) { return (Second(p) - SecondLevel) / 9.3; }

/// How deep inside of a box; negative outside.
double DepthInBox(const double* p, const double low[3], const double high[3])
{
  double depth = VTK_DOUBLE_MAX;
  for (int a = 0; a < 3; ++a)
  {
    depth = std::min({ depth, p[a] - low[a], high[a] - p[a] });
  }
  return depth;
}
double DepthInVolume(const double* p)
{
  const double low[3] = { 0.0, 0.0, 0.0 };
  const double high[3] = { Dims[0] - 1.0, Dims[1] - 1.0, Dims[2] - 1.0 };
  return DepthInBox(p, low, high);
}

vtkSmartPointer<vtkImageData> MakeFields(int components)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(Dims);
  image->AllocateScalars(VTK_DOUBLE, components);
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    double p[3];
    image->GetPoint(i, p);
    for (int c = 0; c < components; ++c)
    {
      image->GetPointData()->GetScalars()->SetComponent(i, c, c == 1 ? Second(p) : First(p));
    }
  }
  return image;
}

/// Opacity 0.5 at `level`; without a kink near it.
vtkSmartPointer<vtkPiecewiseFunction> MakeOpacity(double level)
{
  auto opacity = vtkSmartPointer<vtkPiecewiseFunction>::New();
  opacity->AddPoint(level - 400.0, 0.0);
  opacity->AddPoint(level + 400.0, 1.0);
  return opacity;
}

void SetUp(PickScene& scene)
{
  for (int c = 0; c < 4; ++c)
  {
    scene.Property->SetScalarOpacity(c, MakeOpacity(c == 1 ? SecondLevel : Level));
  }
  scene.Picker->SetVolumeOpacityIsovalue(0.5);
  scene.TheirPicker->SetVolumeOpacityIsovalue(0.5);
}

vtkSmartPointer<vtkFFDLattice> MakeLattice(const double bounds[6], int seed)
{
  auto lattice = vtkSmartPointer<vtkFFDLattice>::New();
  lattice->SetDimensions(6, 6, 6);
  lattice->FitToBounds(bounds);
  FFDRandom random(seed);
  random.Shape(lattice, 0.2);
  return lattice;
}

using Depth = std::function<double(const double* rest)>;
using Check = std::function<bool(vtkFFDVolumePicker*)>;

/// Deform and pick: nothing is visible along the ray before the hit, `depth` is zero there, and
/// `check` holds. How often the volume was hit.
int PickDeformed(PickScene& scene, const std::string& name, const Depth& depth, const Check& check,
  int fewest = 25)
{
  const auto lattice = MakeLattice(scene.Image->GetBounds(), 5);
  scene.Mapper->SetDeformation(lattice);
  scene.Mapper->SetInverseModeToExact();
  scene.Show(scene.Volume);
  int hits = 0;
  int moved = 0;
  for (int y = 1; y < PickSize; y += 5)
  {
    for (int x = 1; x < PickSize; x += 5)
    {
      vtkFFDVolumePicker* p = scene.Picker;
      const int hit = p->Pick(x, y, 0.0, scene.Renderer);
      double ends[2][3];
      GetPickRay(scene.Renderer, x, y, ends);
      const double length = FFDDistance(ends[0], ends[1]);
      const double start = std::max(0.0, FFDDistance(ends[0], Middle) - 26.0);
      const double until = hit ? FFDDistance(ends[0], p->GetPickPosition()) : start + 52.0;
      for (double t = start; t < until - 0.02; t += 0.25)
      {
        double at[3];
        double rest[3];
        for (int a = 0; a < 3; ++a)
        {
          at[a] = ends[0][a] + t / length * (ends[1][a] - ends[0][a]);
        }
        FFD_CHECK(scene.Mapper->GetRestPosition(at, rest) == 1);
        const double before = depth(rest);
        if (!(before < 0.3))
        {
          std::cerr << name << ", pixel " << x << ", " << y << ": visible " << until - t
                    << " before what was picked, " << before << " deep\n";
          return -1;
        }
      }
      if (!hit)
      {
        continue;
      }
      ++hits;
      moved += FFDDistance(p->GetRestPosition(), p->GetMapperPosition()) > 0.3 ? 1 : 0;
      const double at = depth(p->GetRestPosition());
      if (!(std::abs(at) < 1e-4) || !check(p))
      {
        std::cerr << name << ", pixel " << x << ", " << y << ": depth " << at << " at "
                  << p->GetRestPosition()[0] << " " << p->GetRestPosition()[1] << " "
                  << p->GetRestPosition()[2] << ", component " << p->GetComponent() << ", value "
                  << p->GetScalarValue() << ", point " << p->GetPointId() << ", cell "
                  << p->GetCellId() << "\n";
        return -1;
      }
    }
  }
  std::cout << name << ": " << hits << " hits, " << moved << " moved\n";
  FFD_CHECK(hits >= fewest && 4 * moved > hits && scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

bool Near(double a, double b) { return std::abs(a - b) < 1e-6; }

int TestComponents()
{
  PickScene scene;
  SetUp(scene);
  scene.SetImage(MakeFields(2));
  const Depth both = [](const double* p) {
    return std::min(DepthInVolume(p), std::max(DepthOfFirst(p), DepthOfSecond(p)));
  };
  int met[2] = { 0, 0 };
  FFD_CHECK(PickDeformed(scene, "independent components", both, [&](vtkFFDVolumePicker* p) {
    const int c = p->GetComponent();
    const double* r = p->GetRestPosition();
    ++met[c == 1 ? 1 : 0];
    const double own = c == 1 ? DepthOfSecond(r) : DepthOfFirst(r);
    return (c == 0 || c == 1) && own > -1e-4 &&
      Near(p->GetScalarValue(), c == 1 ? Second(r) : First(r));
  }) == EXIT_SUCCESS);
  FFD_CHECK(met[0] > 5 && met[1] > 5);

  // One that has no weight is not in the picture.
  scene.Property->SetComponentWeight(0, 0.0);
  FFD_CHECK(PickDeformed(
              scene, "a component without weight",
              [](const double* p) { return std::min(DepthInVolume(p), DepthOfSecond(p)); },
              [](vtkFFDVolumePicker* p) {
                return p->GetComponent() == 1 &&
                  Near(p->GetScalarValue(), Second(p->GetRestPosition()));
              }) == EXIT_SUCCESS);
  scene.Property->SetComponentWeight(1, 0.0);
  FFD_CHECK(scene.Picker->Pick(30.0, 30.0, 0.0, scene.Renderer) == 0);
  scene.Property->SetComponentWeight(0, 1.0);
  scene.Property->SetComponentWeight(1, 1.0);

  // Dependent: the last component gives the opacity, by the first function.
  scene.Property->IndependentComponentsOff();
  scene.Property->SetScalarOpacity(0, MakeOpacity(SecondLevel));
  FFD_CHECK(PickDeformed(
              scene, "two dependent components",
              [](const double* p) { return std::min(DepthInVolume(p), DepthOfSecond(p)); },
              [](vtkFFDVolumePicker* p) {
                return p->GetComponent() == 1 &&
                  Near(p->GetScalarValue(), Second(p->GetRestPosition()));
              }) == EXIT_SUCCESS);
  // Of three the luminance: 0.413 of the first field, 0.587 of the second.
  const double luminance = 0.413 * Level + 0.587 * SecondLevel;
  scene.Property->SetScalarOpacity(0, MakeOpacity(luminance));
  scene.SetImage(MakeFields(3));
  const auto mixed = [](const double* p) { return 0.413 * First(p) + 0.587 * Second(p); };
  FFD_CHECK(
    PickDeformed(
      scene, "three dependent components",
      [&](const double* p) { return std::min(DepthInVolume(p), (mixed(p) - luminance) / 6.95); },
      [&](vtkFFDVolumePicker* p) {
        return p->GetComponent() == 0 && Near(p->GetScalarValue(), mixed(p->GetRestPosition()));
      }) == EXIT_SUCCESS);
  scene.Property->SetScalarOpacity(0, MakeOpacity(Level));
  scene.SetImage(MakeFields(4));
  FFD_CHECK(PickDeformed(
              scene, "four dependent components",
              [](const double* p) { return std::min(DepthInVolume(p), DepthOfFirst(p)); },
              [](vtkFFDVolumePicker* p) {
                return p->GetComponent() == 3 &&
                  Near(p->GetScalarValue(), First(p->GetRestPosition()));
              }) == EXIT_SUCCESS);
  return EXIT_SUCCESS;
}

/// As vtkVolumePicker, where the components that are looked at are the same.
int TestComponentsAgainstVTK()
{
  for (const bool independent : { true, false })
  {
    PickScene scene;
    SetUp(scene);
    scene.SetImage(MakeFields(2));
    scene.Property->SetIndependentComponents(independent ? 1 : 0);
    scene.Property->SetScalarOpacity(0, MakeOpacity(independent ? Level : SecondLevel));
    const int hits = CompareWithVTK(scene, scene.Volume, scene.Theirs, 1e-4, 1e-5);
    std::cout << (independent ? "independent" : "dependent") << " against VTK: " << hits
              << " hits\n";
    FFD_CHECK(hits > 15 && scene.Errors->Count == 0);
  }
  return EXIT_SUCCESS;
}

int TestCellScalars()
{
  PickScene scene;
  SetUp(scene);
  const auto image = MakeFields(1);
  vtkNew<vtkDoubleArray> cells;
  cells->SetName("cells");
  for (vtkIdType i = 0; i < image->GetNumberOfCells(); ++i)
  {
    const double center[3] = { 0.5 + static_cast<double>(i % (Dims[0] - 1)),
      0.5 + static_cast<double>(i / (Dims[0] - 1) % (Dims[1] - 1)),
      0.5 + static_cast<double>(i / ((Dims[0] - 1) * (Dims[1] - 1))) };
    cells->InsertNextValue(First(center) + 20.0);
  }
  image->GetCellData()->SetScalars(cells);
  scene.SetImage(image);
  scene.Mapper->SetScalarModeToUseCellData();
  const auto value = [](const double* p) {
    double q[3];
    for (int a = 0; a < 3; ++a)
    {
      q[a] = std::min(std::max(p[a], 0.5), Dims[a] - 1.5);
    }
    return First(q) + 20.0;
  };
  const Check ids = [](vtkFFDVolumePicker* p) {
    vtkIdType cell = 0;
    for (int a = 2; a >= 0; --a)
    {
      const double r = p->GetRestPosition()[a];
      if (r - 1e-6 > p->GetCellIJK()[a] + 1 || r + 1e-6 < p->GetCellIJK()[a])
      {
        return false;
      }
      cell = p->GetCellIJK()[a] + (Dims[a] - 1) * cell;
    }
    return p->GetCellId() == cell;
  };
  FFD_CHECK(PickDeformed(
              scene, "scalars of cells",
              [&](const double* p) { return std::min(DepthInVolume(p), (value(p) - Level) / 7.1); },
              [&](vtkFFDVolumePicker* p) {
                return ids(p) && Near(p->GetScalarValue(), value(p->GetRestPosition()));
              }) == EXIT_SUCCESS);

  // Nearest: cells are seen, and the value is that of the cell. The depth is that of the boxes of
  // the cells that are visible: no closed form, so only what is picked is looked at.
  scene.Property->SetInterpolationTypeToNearest();
  int hits = 0;
  for (int y = 1; y < PickSize; y += 5)
  {
    for (int x = 1; x < PickSize; x += 5)
    {
      if (scene.Picker->Pick(x, y, 0.0, scene.Renderer))
      {
        ++hits;
        FFD_CHECK(ids(scene.Picker) && scene.Picker->GetScalarValue() > Level);
        // On a face between two cells either may be named.
        double pcoords[3];
        scene.Picker->GetPCoords(pcoords);
        const bool onFace =
          std::any_of(pcoords, pcoords + 3, [](double c) { return std::min(c, 1.0 - c) < 1e-6; });
        FFD_CHECK(
          onFace || scene.Picker->GetScalarValue() == cells->GetValue(scene.Picker->GetCellId()));
      }
    }
  }
  FFD_CHECK(hits > 25);
  return EXIT_SUCCESS;
}

int TestRectilinearGrid()
{
  PickScene scene;
  SetUp(scene);
  scene.SetImage(MakeFields(1));
  vtkNew<vtkRectilinearGrid> grid;
  const int n[3] = { 14, 22, 16 };
  grid->SetDimensions(n);
  vtkNew<vtkDoubleArray> coordinates[3];
  for (int a = 0; a < 3; ++a)
  {
    for (int i = 0; i < n[a]; ++i)
    {
      // A quarter to the third of the steps at the wide end.
      coordinates[a]->InsertNextValue((Dims[a] - 1) * std::pow(i / (n[a] - 1.0), 1.3));
    }
  }
  grid->SetXCoordinates(coordinates[0]);
  grid->SetYCoordinates(coordinates[1]);
  grid->SetZCoordinates(coordinates[2]);
  vtkNew<vtkDoubleArray> values;
  values->SetName("values");
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i)
  {
    double p[3];
    grid->GetPoint(i, p);
    values->InsertNextValue(First(p));
  }
  grid->GetPointData()->SetScalars(values);
  scene.Mapper->SetInputData(grid);

  // At rest it is the image of the same function, which vtkVolumePicker knows.
  int hits = 0;
  for (int y = 1; y < PickSize; y += 4)
  {
    for (int x = 1; x < PickSize; x += 4)
    {
      scene.Show(scene.Volume);
      const int mine = scene.Picker->Pick(x, y, 0.0, scene.Renderer);
      scene.Show(scene.Theirs);
      if (mine && scene.TheirPicker->Pick(x, y, 0.0, scene.Renderer) &&
        DepthInVolume(scene.TheirPicker->GetMapperPosition()) > 1.1)
      {
        ++hits;
        FFD_CHECK(FFDDistance(
                    scene.Picker->GetPickPosition(), scene.TheirPicker->GetPickPosition()) < 1e-4);
        FFD_CHECK(
          FFDDistance(scene.Picker->GetPickNormal(), scene.TheirPicker->GetPickNormal()) < 0.05);
      }
    }
  }
  std::cout << "rectilinear grid against VTK: " << hits << " hits\n";
  FFD_CHECK(hits > 15);

  return PickDeformed(
    scene, "rectilinear grid",
    [](const double* p) { return std::min(DepthInVolume(p), DepthOfFirst(p)); },
    [&](vtkFFDVolumePicker* p) {
      const double* r = p->GetRestPosition();
      vtkIdType point = 0;
      for (int a = 2; a >= 0; --a)
      {
        const int i = p->GetCellIJK()[a];
        if (i < 0 || i + 1 >= n[a])
        {
          return false;
        }
        const double low = coordinates[a]->GetValue(i);
        const double high = coordinates[a]->GetValue(i + 1);
        const double there = low + p->GetPCoords()[a] * (high - low);
        const int nearest = p->GetPCoords()[a] < 0.5 ? i : i + 1;
        if (!Near(there, r[a]) || p->GetPointIJK()[a] != nearest)
        {
          return false;
        }
        point = nearest + n[a] * point;
      }
      return p->GetPointId() == point && p->GetDataSet() == grid.Get() &&
        Near(p->GetScalarValue(), First(r));
    });
}

int TestMasks()
{
  PickScene scene;
  SetUp(scene);
  scene.SetImage(MakeFields(1));
  const Check value = [](vtkFFDVolumePicker* p) {
    return Near(p->GetScalarValue(), First(p->GetRestPosition())) && p->GetComponent() == 0;
  };
  // Voxels of the mask reach half way to the next.
  vtkNew<vtkImageData> mask;
  mask->SetDimensions(Dims);
  mask->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  const auto fill = [&](const std::function<int(int, int, int)>& label) {
    for (vtkIdType i = 0; i < mask->GetNumberOfPoints(); ++i)
    {
      mask->GetPointData()->GetScalars()->SetTuple1(i,
        label(static_cast<int>(i % Dims[0]), static_cast<int>(i / Dims[0] % Dims[1]),
          static_cast<int>(i / (Dims[0] * Dims[1]))));
    }
    mask->GetPointData()->GetScalars()->Modified();
    mask->Modified();
  };
  fill([](int i, int j, int) { return i < 9 && j < 8 ? 255 : 0; });
  scene.Mapper->SetMaskInput(mask);
  scene.Mapper->SetMaskTypeToBinary();
  FFD_CHECK(PickDeformed(
              scene, "binary mask",
              [](const double* p) {
                return std::min({ DepthInVolume(p), DepthOfFirst(p), 8.5 - p[0], 7.5 - p[1] });
              },
              value, 20) == EXIT_SUCCESS);

  // With a place of its own: nothing beyond it.
  vtkNew<vtkImageData> elsewhere;
  elsewhere->SetDimensions(4, 5, 3);
  elsewhere->SetOrigin(2.0, 3.0, 1.0);
  elsewhere->SetSpacing(3.0, 2.0, 4.0);
  elsewhere->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  elsewhere->GetPointData()->GetScalars()->Fill(1.0);
  scene.Mapper->SetMaskInput(elsewhere);
  FFD_CHECK(PickDeformed(
              scene, "binary mask of another grid",
              [](const double* p) {
                const double low[3] = { 0.5, 2.0, -1.0 };
                const double high[3] = { 12.5, 12.0, 11.0 };
                return std::min({ DepthInVolume(p), DepthOfFirst(p), DepthInBox(p, low, high) });
              },
              value, 20) == EXIT_SUCCESS);

  // Labels: 1 lies deeper, 2 is not seen at all, 3 has only a color.
  const double deeper = 130.0;
  fill([](int i, int j, int) { return j < 6 ? (i < 10 ? 1 : 2) : i < 8 ? 3 : 0; });
  scene.Mapper->SetMaskInput(mask);
  scene.Mapper->SetMaskTypeToLabelMap();
  vtkNew<vtkPiecewiseFunction> nothing;
  nothing->AddPoint(0.0, 0.0);
  scene.Property->SetLabelScalarOpacity(1, MakeOpacity(deeper));
  scene.Property->SetLabelScalarOpacity(2, nothing);
  scene.Property->SetLabelColor(3, scene.Color);
  const auto labeled = [&](double level) {
    return [level](const double* p) {
      const double inOne = std::min({ 9.5 - p[0], 5.5 - p[1], DepthOfFirst(p, level) });
      const double inOthers = std::min(p[1] - 5.5, DepthOfFirst(p));
      return std::min(DepthInVolume(p), std::max(inOne, inOthers));
    };
  };
  FFD_CHECK(PickDeformed(scene, "label map", labeled(deeper), value) == EXIT_SUCCESS);

  // Half of the look of a label, half of that without: the surface is half way, and 2 reaches 0.5
  // nowhere, for its half is at most 0.5 * 0.625.
  scene.Mapper->SetMaskBlendFactor(0.5f);
  FFD_CHECK(PickDeformed(scene, "label map, blended", labeled(0.5 * (Level + deeper)), value) ==
    EXIT_SUCCESS);

  // Gradient opacity of a label: 0.8 at the gradient that there is, so that the opacity of 0.5 is
  // reached where the scalar opacity is 0.625.
  scene.Mapper->SetMaskBlendFactor(1.0f);
  vtkNew<vtkPiecewiseFunction> byGradient;
  byGradient->AddPoint(0.0, 0.8);
  byGradient->AddPoint(100.0, 0.8);
  scene.Property->SetLabelScalarOpacity(1, MakeOpacity(deeper - 100.0));
  scene.Property->SetLabelGradientOpacity(1, byGradient);
  scene.Picker->UseVolumeGradientOpacityOn();
  FFD_CHECK(
    PickDeformed(scene, "label map with gradient opacity", labeled(deeper), value) == EXIT_SUCCESS);
  scene.Picker->UseVolumeGradientOpacityOff();
  FFD_CHECK(PickDeformed(scene, "label map, gradient opacity not used", labeled(deeper - 100.0),
              value) == EXIT_SUCCESS);
  scene.Mapper->SetMaskInput(nullptr);
  return PickDeformed(
    scene, "no mask", [](const double* p) { return std::min(DepthInVolume(p), DepthOfFirst(p)); },
    value);
}

int TestBlanking()
{
  const Check any = [](vtkFFDVolumePicker*) { return true; };
  for (const bool ofPoints : { true, false })
  {
    PickScene scene;
    SetUp(scene);
    const auto image = MakeFields(1);
    // Points 4 to 13 or cells 4 to 12 along x, from 3 on along y, all along z.
    if (ofPoints)
    {
      vtkUnsignedCharArray* ghosts = image->AllocatePointGhostArray();
      for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
      {
        const vtkIdType x = i % Dims[0];
        const vtkIdType y = i / Dims[0] % Dims[1];
        ghosts->SetValue(i, x >= 4 && x <= 13 && y >= 3 ? vtkDataSetAttributes::HIDDENPOINT : 0);
      }
    }
    else
    {
      vtkUnsignedCharArray* ghosts = image->AllocateCellGhostArray();
      for (vtkIdType i = 0; i < image->GetNumberOfCells(); ++i)
      {
        const vtkIdType x = i % (Dims[0] - 1);
        const vtkIdType y = i / (Dims[0] - 1) % (Dims[1] - 1);
        ghosts->SetValue(i, x >= 4 && x <= 12 && y >= 3 ? vtkDataSetAttributes::HIDDENCELL : 0);
      }
    }
    scene.SetImage(image);
    // A blanked point empties the cells around it.
    const double margin = ofPoints ? 1.0 : 0.0;
    FFD_CHECK(PickDeformed(
                scene, ofPoints ? "blanked points" : "blanked cells",
                [margin](const double* p) {
                  const double outside =
                    std::max({ 4.0 - margin - p[0], p[0] - 13.0 - margin, 3.0 - margin - p[1] });
                  return std::min({ DepthInVolume(p), DepthOfFirst(p), outside });
                },
                any, 15) == EXIT_SUCCESS);
  }
  return EXIT_SUCCESS;
}

/// Two volumes that overlap, each with its own lattice: the nearer surface wins, in either order.
int TestSeveralVolumes()
{
  PickScene scene;
  SetUp(scene);
  scene.SetImage(MakeFields(1));
  const auto lattice = MakeLattice(scene.Image->GetBounds(), 5);
  scene.Mapper->SetDeformation(lattice);
  vtkNew<vtkFFDInverseRayVolumeMapper> mapper;
  mapper->SetInputData(FFDMakeBall(16, VTK_FLOAT));
  const auto otherLattice = MakeLattice(mapper->GetInput()->GetBounds(), 8);
  mapper->SetDeformation(otherLattice);
  scene.Errors->Watch(mapper);
  vtkNew<vtkVolumeProperty> property;
  property->SetScalarOpacity(MakeOpacity(60.0));
  property->SetInterpolationTypeToLinear();
  vtkNew<vtkVolume> other;
  other->SetMapper(mapper);
  other->SetProperty(property);
  other->SetPosition(4.0, 1.0, 2.0);
  other->RotateZ(20.0);
  double eye[3];
  scene.Renderer->GetActiveCamera()->GetPosition(eye);
  int won[2] = { 0, 0 };
  for (int y = 1; y < PickSize; y += 4)
  {
    for (int x = 1; x < PickSize; x += 4)
    {
      vtkVolume* volumes[2] = { scene.Volume, other };
      double position[2][3];
      double rest[2][3];
      double far[2] = { VTK_DOUBLE_MAX, VTK_DOUBLE_MAX };
      vtkIdType point[2] = { -1, -1 };
      for (int v = 0; v < 2; ++v)
      {
        scene.Show(volumes[v]);
        if (scene.Picker->Pick(x, y, 0.0, scene.Renderer))
        {
          scene.Picker->GetPickPosition(position[v]);
          scene.Picker->GetRestPosition(rest[v]);
          point[v] = scene.Picker->GetPointId();
          far[v] = FFDDistance(eye, position[v]);
        }
      }
      const int nearer = far[1] < far[0] ? 1 : 0;
      for (const int first : { 0, 1 })
      {
        scene.Show(volumes[first]);
        scene.Renderer->AddVolume(volumes[1 - first]);
        const int hit = scene.Picker->Pick(x, y, 0.0, scene.Renderer);
        FFD_CHECK(hit == (far[nearer] < VTK_DOUBLE_MAX ? 1 : 0));
        if (hit)
        {
          FFD_CHECK(scene.Picker->GetViewProp() == volumes[nearer] &&
            scene.Picker->GetPointId() == point[nearer] &&
            FFDDistance(scene.Picker->GetPickPosition(), position[nearer]) < 1e-6 &&
            FFDDistance(scene.Picker->GetRestPosition(), rest[nearer]) < 1e-6);
          ++won[nearer];
        }
      }
    }
  }
  std::cout << "several volumes: " << won[0] << " and " << won[1] << " picks\n";
  FFD_CHECK(won[0] > 10 && won[1] > 10 && scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

/// Pickers that draw the scene into a buffer of identifiers: nothing of the volume is in it, and
/// what is behind it is found; the picture afterwards is that of before.
int TestSelectionByRendering()
{
  FFDTestScene scene;
  const std::vector<unsigned char> before = scene.Show();
  vtkNew<vtkPropPicker> prop;
  scene.Renderer->SetWorldPoint(-8.0, -8.0, 8.0, 1.0);
  scene.Renderer->WorldToDisplay();
  double cone[3];
  scene.Renderer->GetDisplayPoint(cone);
  FFD_CHECK(prop->PickProp(cone[0], cone[1], scene.Renderer) == 1 &&
    prop->GetViewProp() == scene.ConeActor.Get());
  prop->PickProp(40.0, 40.0, scene.Renderer); // the middle of the volume
  vtkNew<vtkHardwareSelector> selector;
  selector->SetRenderer(scene.Renderer);
  selector->SetArea(0, 0, 79, 79);
  selector->SetFieldAssociation(vtkDataObject::FIELD_ASSOCIATION_CELLS);
  vtkSmartPointer<vtkSelection> selection;
  selection.TakeReference(selector->Select());
  FFD_CHECK(selection && selection->GetNumberOfNodes() >= 1);
  FFD_CHECK(FFDLargestDifference(before, scene.Show()) == 0 && scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

} // namespace

int TestVolumePickerData(int, char*[])
{
  FFD_CHECK(TestComponentsAgainstVTK() == EXIT_SUCCESS);
  FFD_CHECK(TestComponents() == EXIT_SUCCESS);
  FFD_CHECK(TestCellScalars() == EXIT_SUCCESS);
  FFD_CHECK(TestRectilinearGrid() == EXIT_SUCCESS);
  FFD_CHECK(TestMasks() == EXIT_SUCCESS);
  FFD_CHECK(TestBlanking() == EXIT_SUCCESS);
  FFD_CHECK(TestSeveralVolumes() == EXIT_SUCCESS);
  FFD_CHECK(TestSelectionByRendering() == EXIT_SUCCESS);
  return EXIT_SUCCESS;
}
