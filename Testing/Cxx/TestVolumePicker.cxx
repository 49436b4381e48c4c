// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// vtkFFDVolumePicker: without deformation against vtkVolumePicker, with an affine one against
// vtkVolumePicker on a volume with that user matrix, with any one against the definition of the
// pick, a march along the ray, and the depth image of the mapper.
#include "FFDTestPick.h"

#include "vtkCellPicker.h"
#include "vtkLODProp3D.h"
#include "vtkMatrix3x3.h"
#include "vtkMatrix4x4.h"
#include "vtkPlane.h"
#include "vtkPropCollection.h"
#include "vtkTransform.h"

#include <algorithm>
#include <limits>

namespace
{

using namespace ffdTest;

constexpr int Size = PickSize;

/// Without deformation: positions, ids, normals, planes are those of vtkVolumePicker.
int TestIdentity()
{
  PickScene scene;
  scene.SetImage(MakeRamp(false));
  // Without a kink: vtkVolumePicker interpolates opacities from one cell boundary to the next.
  scene.Opacity->AddPoint(-200.0, 0.0);
  scene.Opacity->AddPoint(200.0, 0.8);
  scene.Volume->SetPosition(2.0, -1.0, 3.0);
  scene.Volume->SetScale(1.0, 1.2, 0.9);
  scene.Volume->RotateWXYZ(25.0, 0.3, 1.0, -0.4);
  scene.Theirs->SetPosition(scene.Volume->GetPosition());
  scene.Theirs->SetScale(scene.Volume->GetScale());
  scene.Theirs->RotateWXYZ(25.0, 0.3, 1.0, -0.4);
  double before = 0.0;
  for (const double isovalue : { 0.48, 0.54, 0.6 })
  {
    scene.Picker->SetVolumeOpacityIsovalue(isovalue);
    scene.TheirPicker->SetVolumeOpacityIsovalue(isovalue);
    const int hits = CompareWithVTK(scene, scene.Volume, scene.Theirs, 1e-4, 1e-5);
    FFD_CHECK(hits > 15);
    scene.Show(scene.Volume);
    FFD_CHECK(scene.Picker->Pick(31.0, 30.0, 0.0, scene.Renderer) == 1);
    double eye[3];
    scene.Renderer->GetActiveCamera()->GetPosition(eye);
    const double distance = FFDDistance(eye, scene.Picker->GetPickPosition());
    FFD_CHECK(distance > before + 1.0); // the isovalue is not ignored
    before = distance;
  }
  scene.Renderer->GetActiveCamera()->ParallelProjectionOn();
  scene.Renderer->GetActiveCamera()->SetParallelScale(15.0);
  FFD_CHECK(CompareWithVTK(scene, scene.Volume, scene.Theirs, 1e-4, 1e-5) > 15);
  scene.Renderer->GetActiveCamera()->ParallelProjectionOff();

  // Clipping planes, in world coordinates; and picked themselves.
  scene.Picker->SetVolumeOpacityIsovalue(0.47);
  scene.TheirPicker->SetVolumeOpacityIsovalue(0.47);
  const int whole = CompareWithVTK(scene, scene.Volume, scene.Theirs, 1e-4, 1e-5);
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(scene.Volume->GetCenter());
  plane->SetNormal(-1.0, -0.6, -0.5);
  scene.Mapper->AddClippingPlane(plane);
  scene.TheirMapper->AddClippingPlane(plane);
  const int clipped = CompareWithVTK(scene, scene.Volume, scene.Theirs, 1e-4, 1e-5);
  FFD_CHECK(clipped > 5 && clipped < whole);
  scene.Picker->PickClippingPlanesOn();
  scene.TheirPicker->PickClippingPlanesOn();
  FFD_CHECK(CompareWithVTK(scene, scene.Volume, scene.Theirs, 1e-4, 1e-5) > clipped);
  scene.Picker->PickClippingPlanesOff();
  scene.TheirPicker->PickClippingPlanesOff();
  scene.Mapper->RemoveAllClippingPlanes();
  scene.TheirMapper->RemoveAllClippingPlanes();

  // Cropping regions, several patterns.
  const double* b = scene.Image->GetBounds();
  for (vtkVolumeMapper* mapper : { static_cast<vtkVolumeMapper*>(scene.Mapper),
         static_cast<vtkVolumeMapper*>(scene.TheirMapper) })
  {
    mapper->CroppingOn();
    mapper->SetCroppingRegionPlanes(b[0] + 0.3 * (b[1] - b[0]), b[0] + 0.73 * (b[1] - b[0]),
      b[2] + 0.2 * (b[3] - b[2]), b[2] + 0.64 * (b[3] - b[2]), b[4] + 0.33 * (b[5] - b[4]),
      b[4] + 0.71 * (b[5] - b[4]));
  }
  for (const int flags : { 0x0002000, 0x2ebfeba, 0x7ffdfff, 0x5140145 })
  {
    scene.Mapper->SetCroppingRegionFlags(flags);
    scene.TheirMapper->SetCroppingRegionFlags(flags);
    for (const int planes : { 0, 1 })
    {
      scene.Picker->SetPickCroppingPlanes(planes);
      scene.TheirPicker->SetPickCroppingPlanes(planes);
      FFD_CHECK(CompareWithVTK(scene, scene.Volume, scene.Theirs, 1e-4, 1e-5) > 10);
    }
  }
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

/// An affine lattice moves the volume as the same user matrix does.
int TestAffine(bool oblique)
{
  PickScene scene;
  scene.SetImage(MakeRamp(oblique));
  // Without a kink: vtkVolumePicker interpolates opacities from one cell boundary to the next.
  scene.Opacity->AddPoint(-200.0, 0.0);
  scene.Opacity->AddPoint(200.0, 0.8);
  scene.Picker->SetVolumeOpacityIsovalue(0.47);
  scene.TheirPicker->SetVolumeOpacityIsovalue(0.47);
  vtkNew<vtkTransform> affine;
  affine->Translate(3.0, 2.0, -4.0);
  affine->RotateWXYZ(20.0, 1.0, 2.0, 0.5);
  affine->Scale(1.1, 0.8, 1.2);
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(5, 6, 7);
  lattice->FitToBounds(scene.Image->GetBounds(), 0.6);
  int n[3];
  lattice->GetDimensions(n);
  for (int k = 0; k < n[2]; ++k)
  {
    for (int j = 0; j < n[1]; ++j)
    {
      for (int i = 0; i < n[0]; ++i)
      {
        double p[3];
        lattice->GetRestPoint(i, j, k, p);
        affine->TransformPoint(p, p);
        lattice->SetControlPoint(i, j, k, p);
      }
    }
  }
  scene.Mapper->SetDeformation(lattice);
  vtkSmartPointer<vtkImageData> upright = scene.Image;
  if (oblique)
  {
    // vtkVolumePicker knows nothing of directions: give it the matrix instead.
    upright = MakeRamp(false);
    scene.TheirMapper->SetInputData(upright);
    vtkNew<vtkMatrix4x4> matrix;
    double origin[3];
    upright->GetOrigin(origin);
    for (int r = 0; r < 3; ++r)
    {
      double sum = origin[r];
      for (int c = 0; c < 3; ++c)
      {
        const double d = scene.Image->GetDirectionMatrix()->GetElement(r, c);
        matrix->SetElement(r, c, d);
        sum -= d * origin[c];
      }
      matrix->SetElement(r, 3, sum);
    }
    affine->Concatenate(matrix);
  }
  scene.Theirs->SetUserMatrix(affine->GetMatrix());
  const int hits = CompareWithVTK(scene, scene.Volume, scene.Theirs, 1e-4, 1e-5);
  FFD_CHECK(hits > 40);
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

/// Any deformation: what a pick says is true of the point, and of none before it on the ray.
int TestDeformed(int inverseMode)
{
  PickScene scene;
  scene.SetImage(FFDMakeBall(24, VTK_FLOAT));
  scene.Opacity->AddPoint(40.0, 0.0);
  scene.Opacity->AddPoint(200.0, 0.8);
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(6, 6, 6);
  lattice->FitToBounds(scene.Image->GetBounds());
  FFDRandom random(5);
  random.Shape(lattice, 0.22);
  scene.Mapper->SetDeformation(lattice);
  scene.Mapper->SetInverseMode(inverseMode);
  scene.Mapper->SetSampleDistance(0.25);
  scene.Picker->SetVolumeOpacityIsovalue(0.1);
  const double threshold = 40.0 + 160.0 * 0.1 / 0.8;
  int moved = 0;
  int hits = 0;
  for (int y = 0; y < Size; y += 4)
  {
    for (int x = 0; x < Size; x += 4)
    {
      const int hit = scene.Picker->Pick(x + 0.5, y + 0.5, 0.0, scene.Renderer);
      vtkFFDVolumePicker* p = scene.Picker;
      double ends[2][3];
      GetPickRay(scene.Renderer, x + 0.5, y + 0.5, ends);
      const double length = FFDDistance(ends[0], ends[1]);
      const double until = hit ? FFDDistance(ends[0], p->GetPickPosition()) : length;
      // The volume and what it can be deformed to lie within 30 of its middle.
      const double middle[3] = { 11.5, 11.5, 11.5 };
      const double start = FFDDistance(ends[0], middle) - 30.0;
      for (double t = std::max(0.0, start); t < std::min(until - 0.02, start + 60.0); t += 0.25)
      {
        double at[3];
        double rest[3];
        for (int a = 0; a < 3; ++a)
        {
          at[a] = ends[0][a] + t / length * (ends[1][a] - ends[0][a]);
        }
        FFD_CHECK(scene.Mapper->GetRestPosition(at, rest) == 1);
        double pcoords[3];
        int ijk[3];
        if (scene.Image->ComputeStructuredCoordinates(rest, ijk, pcoords))
        {
          double value = 0.0;
          for (int corner = 0; corner < 8; ++corner)
          {
            const int d[3] = { corner & 1, corner >> 1 & 1, corner >> 2 & 1 };
            double weight = 1.0;
            int c[3];
            for (int a = 0; a < 3; ++a)
            {
              weight *= d[a] ? pcoords[a] : 1.0 - pcoords[a];
              c[a] = std::min(ijk[a] + d[a], 23);
            }
            value += weight * scene.Image->GetScalarComponentAsDouble(c[0], c[1], c[2], 0);
          }
          FFD_CHECK(value < threshold + 1.0);
        }
      }
      if (!hit)
      {
        FFD_CHECK(p->GetPointId() == -1 && p->GetComponent() == -1);
        continue;
      }
      ++hits;
      double t[3];
      if (inverseMode == vtkFFDInverseRayVolumeMapper::PULL_BACK)
      {
        lattice->TransformPoint(p->GetMapperPosition(), t);
        FFD_CHECK(FFDDistance(t, p->GetRestPosition()) < 1e-7);
      }
      else if (inverseMode == vtkFFDInverseRayVolumeMapper::EXACT)
      {
        lattice->TransformPoint(p->GetRestPosition(), t);
        FFD_CHECK(FFDDistance(t, p->GetMapperPosition()) < 1e-7);
      }
      double rest[3];
      FFD_CHECK(scene.Mapper->GetRestPosition(p->GetMapperPosition(), rest) == 1);
      FFD_CHECK(FFDDistance(rest, p->GetRestPosition()) < 1e-7);
      FFD_CHECK_NEAR(p->GetScalarValue(), threshold, 1e-4);
      FFD_CHECK(p->GetComponent() == 0 && p->GetDataSet() == scene.Image.Get() &&
        p->GetMapper() == scene.Mapper.Get() && p->GetViewProp() == scene.Volume.Get());
      for (int a = 0; a < 3; ++a)
      {
        FFD_CHECK_NEAR(p->GetCellIJK()[a] + p->GetPCoords()[a], p->GetRestPosition()[a], 1e-9);
        FFD_CHECK(p->GetPointIJK()[a] == static_cast<int>(p->GetRestPosition()[a] + 0.5));
      }
      FFD_CHECK(p->GetPointId() ==
        p->GetPointIJK()[0] + 24 * (p->GetPointIJK()[1] + 24 * p->GetPointIJK()[2]));
      FFD_CHECK(
        p->GetCellId() == p->GetCellIJK()[0] + 23 * (p->GetCellIJK()[1] + 23 * p->GetCellIJK()[2]));
      moved += FFDDistance(p->GetRestPosition(), p->GetMapperPosition()) > 0.3 ? 1 : 0;

      // The normal: gradient of the deformed scalars, by differences of the pull-back.
      double gradient[3];
      for (int a = 0; a < 3; ++a)
      {
        double shifted[2][3];
        for (int e = 0; e < 2; ++e)
        {
          double at[3];
          std::copy_n(p->GetMapperPosition(), 3, at);
          at[a] += e ? 1e-3 : -1e-3;
          FFD_CHECK(scene.Mapper->GetRestPosition(at, shifted[e]) == 1);
        }
        gradient[a] = 0.0;
        for (int c = 0; c < 3; ++c)
        {
          // Central differences of one voxel, as the mapper shades.
          double values[2];
          for (int e = 0; e < 2; ++e)
          {
            double at[3];
            std::copy_n(p->GetRestPosition(), 3, at);
            at[c] += e ? 1.0 : -1.0;
            int ijk[3];
            double pcoords[3];
            values[e] = 0.0;
            if (scene.Image->ComputeStructuredCoordinates(at, ijk, pcoords))
            {
              for (int corner = 0; corner < 8; ++corner)
              {
                double weight = 1.0;
                int v[3];
                for (int b = 0; b < 3; ++b)
                {
                  const int d = corner >> b & 1;
                  weight *= d ? pcoords[b] : 1.0 - pcoords[b];
                  v[b] = std::min(ijk[b] + d, 23);
                }
                values[e] += weight * scene.Image->GetScalarComponentAsDouble(v[0], v[1], v[2], 0);
              }
            }
          }
          gradient[a] += 0.5 * (values[1] - values[0]) * (shifted[1][c] - shifted[0][c]) / 2e-3;
        }
      }
      vtkMath::Normalize(gradient);
      const double* r = p->GetRestPosition();
      const bool deep =
        r[0] > 1.0 && r[1] > 1.0 && r[2] > 1.0 && r[0] < 22.0 && r[1] < 22.0 && r[2] < 22.0;
      FFD_CHECK(!deep || vtkMath::Dot(gradient, p->GetMapperNormal()) < -1.0 + 1e-5);
    }
  }
  std::cout << "deformed: " << hits << " hits, " << moved << " moved\n";
  FFD_CHECK(hits > 25 && 4 * moved > hits);
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

/// With isovalue 0 a pick is where the picture begins: at most a sample before its depth.
int TestDepths()
{
  PickScene scene;
  for (const int type : { VTK_FLOAT, VTK_UNSIGNED_CHAR })
  {
    scene.SetImage(FFDMakeBall(24, type));
    scene.Opacity->RemoveAllPoints();
    scene.Opacity->AddPoint(60.0, 0.0);
    scene.Opacity->AddPoint(60.5, 0.5);
    vtkNew<vtkFFDLattice> lattice;
    lattice->SetDimensions(6, 6, 6);
    lattice->FitToBounds(scene.Image->GetBounds());
    FFDRandom random(9);
    random.Shape(lattice, 0.2);
    scene.Mapper->SetDeformation(lattice);
    scene.Mapper->SetSampleDistance(0.05);
    scene.Mapper->SetPositionTolerance(0.005);
    vtkNew<vtkImageData> colors;
    vtkNew<vtkImageData> depths;
    FFD_CHECK(
      scene.Mapper->RenderToImage(scene.Renderer, scene.Volume, Size, Size, colors, depths) == 1);
    scene.Picker->SetVolumeOpacityIsovalue(0.0);
    int both = 0;
    int oneOnly = 0;
    int apart = 0;
    for (int y = 0; y < Size; ++y)
    {
      for (int x = 0; x < Size; ++x)
      {
        // Pixel centers: vtkPicker's display coordinates count from the corner of the window.
        const int hit = scene.Picker->Pick(x + 0.5, y + 0.5, 0.0, scene.Renderer);
        const double depth = depths->GetScalarComponentAsDouble(x, y, 0, 0);
        if (hit != (depth < 1.0 ? 1 : 0))
        {
          ++oneOnly;
          continue;
        }
        if (!hit)
        {
          continue;
        }
        ++both;
        scene.Renderer->SetDisplayPoint(x + 0.5, y + 0.5, depth);
        scene.Renderer->DisplayToWorld();
        double w[4];
        scene.Renderer->GetWorldPoint(w);
        const double at[3] = { w[0] / w[3], w[1] / w[3], w[2] / w[3] };
        double eye[3];
        scene.Renderer->GetActiveCamera()->GetPosition(eye);
        const double behind =
          FFDDistance(eye, at) - FFDDistance(eye, scene.Picker->GetPickPosition());
        // Half a sample for the depth's own rounding, a sample, and the position tolerance on a
        // surface that is seen at an angle.
        apart += behind < -0.08 || behind > 0.15 ? 1 : 0;
      }
    }
    std::cout << "depths: " << both << " pixels with both, " << oneOnly << " with one, " << apart
              << " apart\n";
    FFD_CHECK(both > 300 && oneOnly <= both / 100 && apart <= both / 100);
  }
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

/// The rest of the scene is picked as ever; the nearest wins.
int TestScene()
{
  PickScene scene;
  scene.SetImage(FFDMakeBall(24, VTK_FLOAT));
  scene.Opacity->AddPoint(30.0, 0.0);
  scene.Opacity->AddPoint(200.0, 0.9);
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetDimensions(5, 5, 5);
  lattice->FitToBounds(scene.Image->GetBounds());
  lattice->SetDisplacement(2, 2, 2, 4.0, 0.0, 0.0);
  scene.Mapper->SetDeformation(lattice);
  vtkNew<vtkConeSource> cone;
  cone->SetRadius(5.0);
  cone->SetHeight(8.0);
  vtkNew<vtkPolyDataMapper> coneMapper;
  coneMapper->SetInputConnection(cone->GetOutputPort());
  vtkNew<vtkActor> actor;
  actor->SetMapper(coneMapper);
  scene.Renderer->AddActor(actor);
  vtkFFDVolumePicker* picker = scene.Picker;
  FFD_CHECK(picker->Pick(30.0, 30.0, 0.0, scene.Renderer) == 1);
  FFD_CHECK(picker->GetViewProp() == scene.Volume.Get() && picker->GetScalarValue() > 0.0);
  double front[3];
  picker->GetPickPosition(front);

  double eye[3];
  scene.Renderer->GetActiveCamera()->GetPosition(eye);
  for (const double towards : { 0.3, -0.9 })
  {
    // In front of the picked point, then behind the volume.
    actor->SetPosition(front[0] + towards * (eye[0] - front[0]),
      front[1] + towards * (eye[1] - front[1]), front[2] + towards * (eye[2] - front[2]));
    vtkNew<vtkCellPicker> plain;
    plain->PickFromListOn();
    plain->AddPickList(actor);
    FFD_CHECK(plain->Pick(30.0, 30.0, 0.0, scene.Renderer) == 1);
    for (const bool actorFirst : { false, true })
    {
      scene.Renderer->RemoveAllViewProps();
      scene.Renderer->AddViewProp(actorFirst ? static_cast<vtkProp*>(actor) : scene.Volume);
      scene.Renderer->AddViewProp(actorFirst ? static_cast<vtkProp*>(scene.Volume) : actor);
      FFD_CHECK(picker->Pick(30.0, 30.0, 0.0, scene.Renderer) == 1);
      if (towards > 0.0)
      {
        FFD_CHECK(picker->GetViewProp() == actor.Get() && picker->GetComponent() == -1 &&
          picker->GetScalarValue() == 0.0 && picker->GetCellId() == plain->GetCellId());
        FFD_CHECK(FFDDistance(picker->GetPickPosition(), plain->GetPickPosition()) < 1e-9);
        FFD_CHECK(FFDDistance(picker->GetRestPosition(), picker->GetMapperPosition()) == 0.0);
      }
      else
      {
        FFD_CHECK(picker->GetViewProp() == scene.Volume.Get() && picker->GetComponent() == 0);
        FFD_CHECK(FFDDistance(picker->GetPickPosition(), front) < 1e-9);
      }
    }
  }

  // The list, props that are not pickable, and nothing at all.
  picker->PickFromListOn();
  picker->AddPickList(actor);
  FFD_CHECK(
    picker->Pick(30.0, 30.0, 0.0, scene.Renderer) == 1 && picker->GetProp3D() == actor.Get());
  picker->PickFromListOff();
  scene.Volume->PickableOff();
  FFD_CHECK(
    picker->Pick(30.0, 30.0, 0.0, scene.Renderer) == 1 && picker->GetProp3D() == actor.Get());
  scene.Volume->PickableOn();
  scene.Renderer->RemoveViewProp(actor);
  FFD_CHECK(picker->Pick(1.0, 1.0, 0.0, scene.Renderer) == 0 && picker->GetPointId() == -1 &&
    picker->GetComponent() == -1);

  // A volume of another mapper is picked as by vtkVolumePicker.
  scene.Show(scene.Theirs);
  FFD_CHECK(picker->Pick(30.0, 30.0, 0.0, scene.Renderer) == 1);
  FFD_CHECK(scene.TheirPicker->Pick(30.0, 30.0, 0.0, scene.Renderer) == 1);
  FFD_CHECK(picker->GetPointId() == scene.TheirPicker->GetPointId() &&
    FFDDistance(picker->GetPickPosition(), scene.TheirPicker->GetPickPosition()) == 0.0);
  FFD_CHECK(picker->GetComponent() == -1);

  // A level of detail.
  vtkNew<vtkLODProp3D> levels;
  levels->AddLOD(scene.Mapper, scene.Property, 0.0);
  scene.Renderer->RemoveAllViewProps();
  scene.Renderer->AddViewProp(levels);
  FFD_CHECK(picker->Pick(30.0, 30.0, 0.0, scene.Renderer) == 1 &&
    picker->GetProp3D() == levels.Get() && FFDDistance(picker->GetPickPosition(), front) < 1e-9);
  FFD_CHECK(scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

/// What else of the mapper and the property matters, and input that cannot be picked.
int TestOptions()
{
  PickScene scene;
  scene.SetImage(FFDMakeBall(24, VTK_FLOAT));
  scene.Opacity->AddPoint(30.0, 0.0);
  scene.Opacity->AddPoint(200.0, 0.9);
  vtkFFDVolumePicker* picker = scene.Picker;
  const auto pick = [&] { return picker->Pick(30.0, 30.0, 0.0, scene.Renderer); };
  FFD_CHECK(pick() == 1);
  double linear[3];
  picker->GetPickPosition(linear);

  // Nearest: the value is that of a voxel, the surface a face between two.
  scene.Property->SetInterpolationTypeToNearest();
  FFD_CHECK(pick() == 1 && FFDDistance(picker->GetPickPosition(), linear) > 1e-3);
  FFD_CHECK(picker->GetScalarValue() ==
    scene.Image->GetPointData()->GetScalars()->GetTuple1(picker->GetPointId()));
  scene.Property->SetInterpolationTypeToLinear();

  // A box that cuts deformed space.
  scene.Mapper->SetClipBox(-100.0, 100.0, -100.0, 100.0, -100.0, 9.0);
  FFD_CHECK(pick() == 1 && picker->GetMapperPosition()[2] <= 9.0 + 1e-9 && linear[2] > 9.5);
  scene.Mapper->RemoveClipBox();

  // Gradient opacity only if it is asked for.
  vtkNew<vtkPiecewiseFunction> nothing;
  nothing->AddPoint(0.0, 0.0);
  nothing->AddPoint(1000.0, 0.0);
  scene.Property->SetGradientOpacity(nothing);
  FFD_CHECK(pick() == 1);
  picker->UseVolumeGradientOpacityOn();
  FFD_CHECK(pick() == 0);
  scene.Property->DisableGradientOpacityOn();
  FFD_CHECK(pick() == 1);

  // No opacity function with points: nothing to pick. Not a number: transparent.
  scene.Opacity->RemoveAllPoints();
  FFD_CHECK(pick() == 0);
  scene.Opacity->AddPoint(30.0, 0.0);
  scene.Opacity->AddPoint(200.0, 0.9);
  vtkNew<vtkImageData> bad;
  bad->DeepCopy(scene.Image);
  for (vtkIdType i = 0; i < bad->GetNumberOfPoints(); ++i)
  {
    bad->GetPointData()->GetScalars()->SetTuple1(i, std::numeric_limits<double>::quiet_NaN());
  }
  scene.Mapper->SetInputData(bad);
  FFD_CHECK(pick() == 0 && scene.Errors->Count == 0);
  double rest[3];
  const double nan[3] = { std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0 };
  FFD_CHECK(scene.Mapper->GetRestPosition(nan, rest) == 0);
  FFD_CHECK(scene.Errors->Had("not finite"));

  // A flat image is no volume: nothing is picked.
  vtkNew<vtkImageData> flat;
  flat->SetDimensions(10, 10, 1);
  flat->AllocateScalars(VTK_FLOAT, 1);
  scene.Mapper->SetInputData(flat);
  FFD_CHECK(pick() == 0);
  scene.Errors->Count = 0;
  scene.Errors->Message.clear();
  const double origin[3] = { 0.0, 0.0, 0.0 };
  FFD_CHECK(scene.Mapper->GetRestPosition(origin, rest) == 0);
  FFD_CHECK(scene.Errors->Had("at least 2 along each axis"));
  return EXIT_SUCCESS;
}

} // namespace

int TestVolumePicker(int, char*[])
{
  FFD_CHECK(TestIdentity() == EXIT_SUCCESS);
  FFD_CHECK(TestAffine(false) == EXIT_SUCCESS);
  FFD_CHECK(TestAffine(true) == EXIT_SUCCESS);
  for (const int mode : { vtkFFDInverseRayVolumeMapper::FIRST_ORDER,
         vtkFFDInverseRayVolumeMapper::EXACT, vtkFFDInverseRayVolumeMapper::PULL_BACK })
  {
    FFD_CHECK(TestDeformed(mode) == EXIT_SUCCESS);
  }
  FFD_CHECK(TestDepths() == EXIT_SUCCESS);
  FFD_CHECK(TestScene() == EXIT_SUCCESS);
  FFD_CHECK(TestOptions() == EXIT_SUCCESS);
  return EXIT_SUCCESS;
}
