// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Every option of the mapper, and of the property where the mapper reads it, does something.
#include "FFDTestVolume.h"

#include "vtkLight.h"

#include <functional>
#include <sstream>
#include <utility>

namespace
{

using Action = std::function<void()>;

/// The image differs with the option, and is the old one again without it.
bool Matters(FFDTestScene& scene, const char* name, const Action& on, const Action& off)
{
  off();
  const std::vector<unsigned char> before = scene.Render();
  on();
  const int with = FFDLargestDifference(before, scene.Render());
  off();
  const int again = FFDLargestDifference(before, scene.Render());
  if (with == 0 || with > 255 || again != 0)
  {
    std::cerr << name << ": difference " << with << ", and " << again << " when set back\n";
    return false;
  }
  return true;
}

/// Likewise for a count of the statistics: grows by at least `factor`.
bool Counts(FFDTestScene& scene, const char* name, const std::function<double()>& count,
  const Action& few, const Action& many, double factor)
{
  few();
  scene.Render();
  const double a = count();
  many();
  scene.Render();
  const double b = count();
  few();
  if (!(b >= factor * a) || !(a > 0.0))
  {
    std::cerr << name << ": " << a << " and " << b << "\n";
    return false;
  }
  return true;
}

int TestRayOptions()
{
  FFDTestScene scene;
  vtkFFDInverseRayVolumeMapper* m = scene.Mapper;
  vtkFFDRayStatistics* counts = m->GetStatistics();
  bool ok = true;
  scene.Render();
  FFD_CHECK(counts->GetNumberOfRays() == 0); // not collected yet
  m->CollectStatisticsOn();
  scene.Render();
  FFD_CHECK(counts->GetNumberOfRays() > 100 && counts->GetNumberOfSamples() > 0);

  ok &= Matters(
    scene, "InverseMode FIRST_ORDER", [&] { m->SetInverseModeToFirstOrder(); },
    [&] { m->SetInverseModeToExact(); });
  ok &= Matters(
    scene, "InverseMode PULL_BACK", [&] { m->SetInverseModeToPullBack(); },
    [&] { m->SetInverseModeToExact(); });
  ok &= Matters(
    scene, "Segmentation", [&] { m->SetSegmentationToGreedyAngle(); },
    [&] { m->SetSegmentationToErrorBound(); });
  ok &= Matters(
    scene, "OpacityLength", [&] { m->SetOpacityLengthToMaterial(); },
    [&] { m->SetOpacityLengthToWorld(); });
  ok &= Matters(
    scene, "SampleDistance", [&] { m->SetSampleDistance(3.0); },
    [&] { m->LockSampleDistanceToInputSpacingOn(); });
  ok &= Matters(
    scene, "LockSampleDistanceToInputSpacing", [&] { m->LockSampleDistanceToInputSpacingOn(); },
    [&] { m->SetSampleDistance(2.0); });
  m->LockSampleDistanceToInputSpacingOn();
  ok &= Matters(
    scene, "EarlyRayTerminationThreshold", [&] { m->SetEarlyRayTerminationThreshold(0.6); },
    [&] { m->SetEarlyRayTerminationThreshold(0.0); });

  // What makes the work.
  const auto evaluations = [&] { return static_cast<double>(counts->GetNumberOfEvaluations()); };
  const auto segments = [&] { return counts->GetSegmentsPerRay(); };
  m->SetSpaceLeapingToOff();
  ok &= Counts(
    scene, "PositionTolerance", segments, [&] { m->SetPositionTolerance(0.1); },
    [&] { m->SetPositionTolerance(0.01); }, 1.2);
  m->SetPositionTolerance(0.01);
  ok &= Counts(
    scene, "MinimumSegmentLength", segments, [&] { m->SetMinimumSegmentLength(16.0); },
    [&] { m->SetMinimumSegmentLength(0.5); }, 1.2);
  m->SetMinimumSegmentLength(0.5);
  m->SetPositionTolerance(0.1);
  ok &= Counts(
    scene, "MaximumSegmentLength of ERROR_BOUND", segments,
    [&] { m->SetMaximumSegmentLength(8.0); }, [&] { m->SetMaximumSegmentLength(2.0); }, 1.5);
  m->SetMaximumSegmentLength(8.0);
  m->ReferenceKernelsOn();
  m->SetSegmentationToGreedyAngle();
  ok &= Counts(
    scene, "InverseTolerance", evaluations, [&] { m->SetInverseTolerance(0.01); },
    [&] { m->SetInverseTolerance(1e-10); }, 1.1);
  m->SetInverseTolerance(0.01);
  ok &= Counts(
    scene, "AngleThreshold", segments, [&] { m->SetAngleThreshold(5.0); },
    [&] { m->SetAngleThreshold(0.5); }, 1.2);
  ok &= Counts(
    scene, "MaximumSegmentLength", segments, [&] { m->SetMaximumSegmentLength(8.0); },
    [&] { m->SetMaximumSegmentLength(1.0); }, 1.5);
  // From the curvature: long where nothing bends, so fewer than with 8 voxels.
  m->SetDeformation(nullptr);
  ok &= Counts(
    scene, "automatic MaximumSegmentLength", segments, [&] { m->SetMaximumSegmentLength(0.0); },
    [&] { m->SetMaximumSegmentLength(8.0); }, 1.05);
  m->SetMaximumSegmentLength(8.0);
  m->SetDeformation(scene.Lattice);
  m->SetSegmentationToErrorBound();

  // Space leaping: the same image for less. The ball leaves half of the volume empty; rays are
  // close to each other, as those of 4 x 4 pixels leap together.
  constexpr int size = 128;
  for (int reference = 0; reference < 2; ++reference)
  {
    m->SetReferenceKernels(reference);
    m->SetSpaceLeapingToOff();
    const std::vector<unsigned char> all = scene.Render(size);
    const double samplesOff = static_cast<double>(counts->GetNumberOfSamples());
    const double evaluationsOff = evaluations();
    const vtkTypeInt64 visible = counts->GetNumberOfVisibleSamples();
    FFD_CHECK(counts->GetNumberOfDistanceLookups() == 0);
    m->SetSpaceLeapingToSegment();
    FFD_CHECK(FFDLargestDifference(all, scene.Render(size)) <= 1);

    const double most = 0.9 * samplesOff;
    FFD_CHECK(counts->GetNumberOfSamples() < most);
    FFD_CHECK(counts->GetNumberOfDistanceLookups() > 0);
    FFD_CHECK(std::abs(counts->GetNumberOfVisibleSamples() - visible) <= visible / 1000);
    m->SetSpaceLeapingToLipschitz();
    FFD_CHECK(FFDLargestDifference(all, scene.Render(size)) <= 1);
    FFD_CHECK(counts->GetNumberOfSamples() < most);
    FFD_CHECK(reference || evaluations() <= evaluationsOff);
    FFD_CHECK(std::abs(counts->GetNumberOfVisibleSamples() - visible) <= visible / 1000);
  }
  const std::vector<unsigned char> slow = scene.Render();
  m->ReferenceKernelsOff();
  // Colors are not premultiplied: they mean nothing where there is next to no opacity.
  const std::vector<unsigned char> fast = scene.Render();
  for (std::size_t i = 0; i < slow.size(); ++i)
  {
    FFD_CHECK_NEAR(slow[i] * (i % 4 == 3 ? 255 : slow[i | 3]) / 255.0,
      fast[i] * (i % 4 == 3 ? 255 : fast[i | 3]) / 255.0, 2.0);
  }
  for (const int threads : { 1, 2, 5, 1024 })
  {
    const std::vector<unsigned char> automatic = scene.Render();
    m->SetNumberOfThreads(threads);
    FFD_CHECK(m->GetNumberOfThreads() == threads);
    FFD_CHECK(FFDLargestDifference(automatic, scene.Render()) == 0);
    m->SetNumberOfThreads(0);
  }
  m->SetNumberOfThreads(2147483647);
  FFD_CHECK(m->GetNumberOfThreads() == 1024);
  m->SetNumberOfThreads(0);
  FFD_CHECK(ok && scene.Errors->Count == 0);
  return EXIT_SUCCESS;
}

bool TestPropertyAndLights()
{
  FFDTestScene scene;
  vtkVolumeProperty* p = scene.Property;
  bool ok = true;
  const auto number = [&](const char* name, const std::function<void(double)>& set, double off,
                        double on) {
    ok &= Matters(
      scene, name, [&] { set(on); }, [&] { set(off); });
  };
  number(
    "interpolation", [&](double x) { p->SetInterpolationType(static_cast<int>(x)); },
    VTK_LINEAR_INTERPOLATION, VTK_NEAREST_INTERPOLATION);
  number(
    "unit distance", [&](double x) { p->SetScalarOpacityUnitDistance(x); }, 1.0, 4.0);
  number(
    "shade", [&](double x) { p->SetShade(static_cast<int>(x)); }, 0, 1);
  p->ShadeOn();
  number(
    "ambient", [&](double x) { p->SetAmbient(x); }, 0.1, 0.5);
  number(
    "diffuse", [&](double x) { p->SetDiffuse(x); }, 0.7, 0.3);
  number(
    "specular", [&](double x) { p->SetSpecular(x); }, 0.2, 0.8);
  number(
    "specular power", [&](double x) { p->SetSpecularPower(x); }, 10.0, 2.0);
  vtkNew<vtkLight> light;
  light->SetPosition(100.0, 0.0, 0.0);
  light->SetFocalPoint(0.0, 0.0, 0.0);
  number(
    "light",
    [&](double x) { x > 0 ? scene.Renderer->AddLight(light) : scene.Renderer->RemoveLight(light); },
    0, 1);
  scene.Renderer->AddLight(light);
  number(
    "two-sided", [&](double x) { scene.Renderer->SetTwoSidedLighting(x > 0.0); }, 1, 0);
  vtkNew<vtkPiecewiseFunction> gray;
  gray->AddPoint(0.0, 0.1);
  gray->AddPoint(200.0, 0.9);
  ok &= Matters(
    scene, "gray", [&] { p->SetColor(gray); }, [&] { p->SetColor(scene.Color); });
  number(
    "edit of the opacity", [&](double x) { scene.Opacity->AddPoint(200.0, x); }, 0.4, 0.9);
  ok &= Matters(
    scene, "edit of the colors", [&] { scene.Color->AddRGBPoint(200.0, 0.0, 1.0, 0.0); },
    [&] { scene.Color->AddRGBPoint(200.0, 1.0, 0.5, 0.1); });
  return ok;
}

bool TestPipeline()
{
  FFDTestScene scene;
  vtkFFDInverseRayVolumeMapper* m = scene.Mapper;
  bool ok = true;
  const auto voxels = [&](double value) {
    for (int i = 0; i < 300; ++i)
    {
      scene.Image->GetPointData()->GetScalars()->SetTuple1(6000 + i, value);
    }
    scene.Image->GetPointData()->GetScalars()->Modified();
  };
  ok &= Matters(
    scene, "scalars edited in place", [&] { voxels(200.0); }, [&] { voxels(0.0); });

  vtkSmartPointer<vtkImageData> small = FFDMakeBall(24);
  vtkNew<vtkFloatArray> other;
  other->SetName("other");
  other->SetNumberOfValues(scene.Image->GetNumberOfPoints());
  other->Fill(120.0);
  scene.Image->GetPointData()->AddArray(other);
  ok &= Matters(
    scene, "array by name",
    [&] {
      m->SetScalarModeToUsePointFieldData();
      m->SelectScalarArray("other");
    },
    [&] { m->SelectScalarArray("ball"), m->SetScalarModeToDefault(); });

  double moved[3] = { 6.0, 0.0, 0.0 };
  double still[3] = { 0.0, 0.0, 0.0 };
  ok &= Matters(
    scene, "lattice edit",
    [&] { scene.Lattice->SetDisplacement(2, 2, 1, moved[0], moved[1], moved[2]); },
    [&] { scene.Lattice->SetDisplacement(2, 2, 1, still[0], still[1], still[2]); });
  ok &= Matters(
    scene, "no deformation", [&] { m->SetDeformation(nullptr); },
    [&] { m->SetDeformation(scene.Lattice); });
  ok &= Matters(
    scene, "volume matrix", [&] { scene.Volume->SetPosition(3.0, 0.0, 0.0); },
    [&] { scene.Volume->SetPosition(0.0, 0.0, 0.0); });

  // The modification time and the bounds follow the deformation.
  const vtkMTimeType time = m->GetMTime();
  double before[6];
  m->GetBounds(before);
  scene.Lattice->SetDisplacement(4, 2, 2, 30.0, 0.0, 0.0);
  ok &= m->GetMTime() > time && m->GetBounds()[1] > before[1] + 1.0;
  scene.Lattice->Reset();
  ok &= std::abs(m->GetBounds()[1] - 23.0) < 1e-9;
  scene.Render();
  ok &= m->GetAuxiliaryMemorySize() > 0;
  return ok;
}

bool TestPrintSelf()
{
  vtkNew<vtkFFDInverseRayVolumeMapper> m;
  m->SetMaximumSegmentLength(7.25);
  std::ostringstream text;
  m->Print(text);
  for (const char* name :
    { "Deformation: ", "InverseMode: EXACT", "InverseTolerance: 0.01", "Segmentation: ERROR_BOUND",
      "PositionTolerance: 0.1", "AngleThreshold: 5", "MinimumSegmentLength: 0.5",
      "MaximumSegmentLength: 7.25", "SpaceLeaping: LIPSCHITZ",
      "EarlyRayTerminationThreshold: ", "OpacityLength: WORLD", " SampleDistance: 1",
      "InteractiveSampleDistance: 2", "LockSampleDistanceToInputSpacing: 1",
      " ImageSampleDistance: 1", "MinimumImageSampleDistance: 1", "MaximumImageSampleDistance: 10",
      "AutoAdjustSampleDistances: 1", "FrameCoherence: 1", "StillFrameCoherence: 0",
      "FrameCoherenceTolerance: 0.25", "IntermixIntersectingGeometry: 1", "NumberOfThreads: 0",
      "MaskInput: ", "MaskType: LabelMap", "MaskBlendFactor: 1", "Transfer2DYAxisArray: (none)",
      "VectorMode: DISABLED", "VectorComponent: 0", "ComputeNormalFromOpacity: 0",
      "ReferenceKernels: 0", "CollectStatistics: 0", "Statistics:" })
  {
    if (text.str().find(name) == std::string::npos)
    {
      std::cerr << "PrintSelf lacks \"" << name << "\"\n";
      return false;
    }
  }
  return true;
}

} // namespace

int TestMapperOptions(int, char*[])
{
  FFD_CHECK(TestRayOptions() == EXIT_SUCCESS);
  FFD_CHECK(TestPropertyAndLights());
  FFD_CHECK(TestPipeline());
  FFD_CHECK(TestPrintSelf());
  return EXIT_SUCCESS;
}
