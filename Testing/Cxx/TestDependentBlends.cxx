// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Blend modes of dependent components, and masks on several components. Undeformed against those of
// VTK's mappers that draw them:
// - vtkFixedPointVolumeRayCastMapper takes the sample whose last component is the extreme one, and
//   has no other mode but compositing;
// - vtkGPUVolumeRayCastMapper does so with four components. Of two it looks at a fourth one, which
//   its texture does not have. Averages, sums and isosurfaces are those of the first component,
//   with the opacity of the last. Labels have no effect with dependent components, and with
//   independent ones its shader does not compile.
// Three components are compared with the one that their luminance is: VTK's mappers have none.
#include "FFDTestBlend.h"
#include "FFDTestOptics.h"

namespace
{

using Mapper = vtkVolumeMapper;

/// Up to the ends of bytes: the GPU mapper stretches the opacities of four components to those.
double Bytes(int component, const ffdTest::Vec3& p)
{
  return std::floor(std::min(255.0, 1.1 * ffdTest::FourFields(component, p)));
}

/// Of two the second has a smaller range, and hardly two samples that are equal.
ffdTest::Field FieldsOf(int components)
{
  return [components](int c, const ffdTest::Vec3& p) {
    return components == 2 && c == 1 ? 0.6 * ffdTest::FourFields(1, p) : Bytes(c, p);
  };
}

enum class Peer
{
  None,
  Fixed,
  Gpu
};

struct Mode
{
  std::string Name;
  int Blend;
  Peer OfTwo;
  Peer OfFour;
  bool Leaps;
  double Mean; // from VTK's mapper, 1/255
  double P99;
};

const std::vector<Mode>& Modes()
{
  static const std::vector<Mode> modes = {
    // Which of neighboring samples is the extreme one is a matter of rounding.
    { "maximum", Mapper::MAXIMUM_INTENSITY_BLEND, Peer::Fixed, Peer::Gpu, true, 2.0, 25.0 },
    { "minimum", Mapper::MINIMUM_INTENSITY_BLEND, Peer::Fixed, Peer::Gpu, true, 2.0, 25.0 },
    { "average", Mapper::AVERAGE_INTENSITY_BLEND, Peer::Gpu, Peer::Gpu, false, 1.0, 6.0 },
    { "additive", Mapper::ADDITIVE_BLEND, Peer::Gpu, Peer::Gpu, false, 1.0, 6.0 },
    { "isosurface", Mapper::ISOSURFACE_BLEND, Peer::Gpu, Peer::Gpu, false, 3.0, 30.0 },
    // The slices of the GPU mapper are half a voxel off: see TestSlice.
    { "slice", Mapper::SLICE_BLEND, Peer::Gpu, Peer::Gpu, false, 6.0, 20.0 },
  };
  return modes;
}

void SetMode(ffdTest::Scene& scene, const Mode& mode)
{
  ffdTest::ForAllMappers(scene, [&](vtkVolumeMapper* m) {
    m->SetBlendMode(mode.Blend);
    m->SetAverageIPScalarRange(20.0, 240.0);
  });
  // All of them: the GPU mapper takes that of the last component, ours and the fixed-point mapper
  // take that of the first.
  for (int c = 0; c < 4; ++c)
  {
    scene.Property->SetScalarOpacityUnitDistance(
      c, mode.Blend == Mapper::ADDITIVE_BLEND ? 20.0 : 1.0);
  }
  scene.Gpu->Modified();
  scene.Property->Modified();
}

void SetFunctions(vtkVolumeProperty* property)
{
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(0.0, 0.2, 0.3, 1.0);
  color->AddRGBPoint(120.0, 0.2, 1.0, 0.3);
  color->AddRGBPoint(255.0, 1.0, 0.3, 0.1);
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(0.0, 0.0);
  opacity->AddPoint(30.0, 0.0);
  opacity->AddPoint(255.0, 0.9);
  property->SetColor(color);
  property->SetScalarOpacity(opacity);
}

void CheckModes(int components, ffdTest::Checks& checks)
{
  ffdTest::Scene scene(120);
  const ffdTest::Field fields = FieldsOf(components);
  const auto image = ffdTest::MakeImage(32, VTK_UNSIGNED_CHAR, components, fields);
  // The least of what is turned around is where the most was. From 0 on: the fixed-point mapper
  // shifts the last component twice when it looks for blocks to leap over.
  double most = 0.0;
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    most = std::max(most, image->GetPointData()->GetScalars()->GetComponent(i, components - 1));
  }
  const auto turned = ffdTest::MakeImage(32, VTK_UNSIGNED_CHAR, components,
    [&](int c, const ffdTest::Vec3& p) { return std::max(0.0, most - std::floor(fields(c, p))); });
  scene.SetSampleDistance(0.5);
  scene.Property->IndependentComponentsOff();
  scene.Property->SetInterpolationTypeToLinear();
  scene.Property->GetIsoSurfaceValues()->SetValue(0, 90.0);
  scene.Property->GetIsoSurfaceValues()->SetValue(1, 180.0);
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(15.0, 14.0, 15.0);
  plane->SetNormal(0.3, -1.0, 0.4);
  scene.Property->SetSliceFunction(plane);
  double bounds[6];
  image->GetBounds(bounds);
  const vtkSmartPointer<vtkBSplineTransform> bend =
    ffdTest::MakeTransform(bounds, 7, ffdTest::BendAndWaves(4.0));
  for (const Mode& mode : Modes())
  {
    const std::string name = std::to_string(components) + " components, " + mode.Name;
    SetFunctions(scene.Property);
    if (mode.Blend == Mapper::MINIMUM_INTENSITY_BLEND)
    {
      vtkNew<vtkPiecewiseFunction> opacity;
      opacity->AddPoint(0.0, 0.9);
      opacity->AddPoint(0.85 * most, 0.0);
      scene.Property->SetScalarOpacity(opacity);
    }
    scene.SetInput(mode.Blend == Mapper::MINIMUM_INTENSITY_BLEND ? turned : image);
    // Sums are seen up to the faces of the volume, whose pixels are not the same: look into it.
    const double zoom = mode.Blend == Mapper::ADDITIVE_BLEND ? 2.0 : 1.0;
    scene.SetCamera({ 25.0, 20.0, zoom, true, false }, image->GetBounds());
    SetMode(scene, mode);
    const ffdTest::Picture ours = scene.Render(scene.Ours);
    const Peer peer = components == 2 ? mode.OfTwo : mode.OfFour;
    const ffdTest::Picture theirs =
      peer == Peer::Fixed ? scene.RenderFixedRays() : scene.Render(scene.Gpu);
    const ffdTest::Distance apart = scene.Compare(ours, theirs);
    std::ostringstream figures;
    figures << apart << " from the " << (peer == Peer::Fixed ? "fixed-point" : "GPU")
            << " mapper (mean at most " << mode.Mean << ", p99 " << mode.P99 << ")";
    checks.Expect(
      apart.Pixels > 900 && apart.Mean <= mode.Mean && apart.P99 <= mode.P99, name, figures.str());

    // Another component for opacity or for color is another picture.
    scene.Property->IndependentComponentsOn();
    checks.ExpectAtLeast(
      name + ", dependence matters", scene.Compare(ours, scene.Render(scene.Ours)).Mean, 5.0);
    scene.Property->IndependentComponentsOff();

    scene.Ours->SetDeformation(bend);
    ffdTest::CheckLeaping(scene, name + ", deformed", mode.Leaps, checks);
    const ffdTest::Picture deformed = scene.Render(scene.Ours);
    checks.ExpectAtLeast(name + ", what the deformation changes",
      scene.Compare(ours, deformed).Mean, mode.Blend == Mapper::ADDITIVE_BLEND ? 0.5 : 4.0);
    scene.Ours->ReferenceKernelsOn();
    const ffdTest::Distance reference = scene.Compare(deformed, scene.Render(scene.Ours));
    scene.Ours->ReferenceKernelsOff();
    scene.Ours->SetDeformation(nullptr);
    checks.Expect(reference.Mean <= 0.3, name + ", reference kernels",
      ffdTest::ToString(reference) + " (mean at most 0.3)");
  }
}

/// Gray colors: their luminance is the one component that they are compared with.
void CheckColors(ffdTest::Checks& checks)
{
  ffdTest::Scene scene(120);
  const auto gray = [](int, const ffdTest::Vec3& p) { return Bytes(3, p) / 255.0; };
  const auto three = ffdTest::MakeImage(32, VTK_FLOAT, 3, gray);
  const auto one = ffdTest::MakeImage(32, VTK_FLOAT, 1, gray);
  scene.SetCamera({ 25.0, 20.0, 1.0, true, false }, three->GetBounds());
  scene.SetSampleDistance(0.5);
  scene.Property->IndependentComponentsOff();
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(15.0, 14.0, 15.0);
  plane->SetNormal(0.3, -1.0, 0.4);
  scene.Property->SetSliceFunction(plane);
  scene.Property->GetIsoSurfaceValues()->SetValue(0, 0.4);
  scene.SetShadingAsGpuMapper(0.2, 0.7, 0.2, 10.0);
  for (const Mode& mode : Modes())
  {
    SetMode(scene, mode);
    scene.Ours->SetAverageIPScalarRange(0.1, 0.9);
    const bool minimum = mode.Blend == Mapper::MINIMUM_INTENSITY_BLEND;
    ffdTest::SetComponent(scene.Property, 0,
      { { 0, 0.0, 0.0, 0.0, minimum ? 0.8 : 0.0 }, { 1, 1.0, 1.0, 1.0, minimum ? 0.1 : 0.7 } },
      mode.Blend == Mapper::ADDITIVE_BLEND ? 20.0 : 1.0);
    scene.SetInput(three);
    const ffdTest::Picture ofThree = scene.Render(scene.Ours);
    scene.SetInput(one);
    const ffdTest::Distance apart = scene.Compare(ofThree, scene.Render(scene.Ours));
    checks.Expect(apart.Pixels > 1500 && apart.Max <= 1.0, "3 components, " + mode.Name,
      ffdTest::ToString(apart) + " from one component (max at most 1)");
  }
}

/// Binary masks and labels on two and four components, dependent or not.
void CheckMasks(ffdTest::Checks& checks)
{
  const auto inside = ffdTest::MakeImage(32, VTK_UNSIGNED_CHAR, 1,
    [](int, const ffdTest::Vec3& p) { return p[0] + 0.4 * p[2] > 0.7 ? 1.0 : 0.0; });
  for (const int components : { 2, 4 })
  {
    const auto image = ffdTest::MakeImage(32, VTK_UNSIGNED_CHAR, components, Bytes);
    enum
    {
      INDEPENDENT,
      DEPENDENT,
      LABELS
    };
    for (const int what : { INDEPENDENT, DEPENDENT, LABELS })
    {
      // Each with a GPU mapper of its own: it does not notice another type of mask.
      ffdTest::Scene scene(120);
      scene.SetInput(image);
      scene.SetCamera({ 25.0, 20.0, 1.0, true, false }, image->GetBounds());
      scene.SetSampleDistance(0.5);
      scene.Property->SetInterpolationTypeToLinear();
      for (int c = 0; c < components; ++c)
      {
        // As long as samples: the GPU mapper does not correct the opacities of labels.
        ffdTest::SetComponent(scene.Property, c,
          { { 20, 1.0, 0.3 * c, 0.1, 0.0 }, { 255, 1.0 - 0.3 * c, 1.0, 0.3 * c, 0.2 } }, 0.5);
      }
      const bool independent = what == INDEPENDENT;
      const std::string name = std::to_string(components) +
        (independent ? " independent components" : " dependent components");
      scene.Property->SetIndependentComponents(independent);
      scene.Ours->SetMaskInput(nullptr);
      const ffdTest::Picture all = scene.Render(scene.Ours);
      const auto compare = [&](const std::string& mask, double limit) {
        const ffdTest::Picture ours = scene.Render(scene.Ours);
        scene.Gpu->Modified();
        scene.Property->Modified();
        const ffdTest::Distance d = scene.Compare(ours, scene.Render(scene.Gpu));
        std::ostringstream figures;
        figures << d << " from the GPU mapper (mean at most " << limit << ")";
        checks.Expect(d.Pixels > 900 && d.Mean <= limit, name + mask, figures.str());
        checks.ExpectAtLeast(name + mask + ", matters", scene.Compare(all, ours).Mean, 3.0);
        ffdTest::CheckSamePictures(scene, name + mask, checks);
      };
      scene.Ours->SetMaskInput(inside);
      scene.Gpu->SetMaskInput(inside);
      if (what != LABELS)
      {
        scene.Ours->SetMaskTypeToBinary();
        scene.Gpu->SetMaskTypeToBinary();
        compare(", binary mask", 3.0);
      }
      else
      {
        vtkNew<vtkColorTransferFunction> color;
        color->AddRGBPoint(0.0, 0.1, 0.1, 1.0);
        color->AddRGBPoint(255.0, 0.2, 1.0, 1.0);
        vtkNew<vtkPiecewiseFunction> opacity;
        opacity->AddPoint(10.0, 0.0);
        opacity->AddPoint(255.0, 0.3);
        scene.Property->SetLabelColor(1, color);
        scene.Property->SetLabelScalarOpacity(1, opacity);
        scene.Ours->SetMaskTypeToLabelMap();
        const ffdTest::Picture labeled = scene.Render(scene.Ours);
        checks.ExpectAtLeast(name + ", labels matter", scene.Compare(all, labeled).Mean, 10.0);
        ffdTest::CheckSamePictures(scene, name + ", labels", checks);
        // Where the property shows nothing labels do, by what is looked up for opacity: as those of
        // that component alone.
        vtkNew<vtkPiecewiseFunction> nothing;
        nothing->AddPoint(0.0, 0.0);
        scene.Property->SetScalarOpacity(nothing);
        const ffdTest::Picture only = scene.Render(scene.Ours);
        ffdTest::CheckSamePictures(scene, name + ", labels only", checks);
        scene.SetInput(ffdTest::MakeImage(32, VTK_UNSIGNED_CHAR, 1,
          [&](int, const ffdTest::Vec3& p) { return Bytes(components - 1, p); }));
        const ffdTest::Distance apart = scene.Compare(only, scene.Render(scene.Ours));
        checks.Expect(apart.Pixels > 900 && apart.Max <= 1.0, name + ", labels only",
          ffdTest::ToString(apart) + " from one component (max at most 1)");
      }
    }
  }
}

} // namespace

int TestDependentBlends(int, char*[])
{
  ffdTest::Checks checks;
  CheckModes(2, checks);
  CheckModes(4, checks);
  CheckColors(checks);
  CheckMasks(checks);
  return checks.Result();
}
