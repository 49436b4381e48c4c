// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// vtkFFDBarrTransform and vtkFFDRayDeflector as VTK transforms, and as deformations of the mapper:
// the picture is that of the volume resampled by vtkImageReslice through the transform's inverse.
#include "FFDTestVolume.h"

#include "vtkFFDBarrTransform.h"
#include "vtkFFDRayDeflector.h"

#include "vtkGeneralTransform.h"
#include "vtkImageReslice.h"
#include "vtkMath.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace
{

struct Case
{
  std::string Name;
  vtkSmartPointer<vtkWarpTransform> Transform;
};

/// Every kind, over the ball of FFDMakeBall().
std::vector<Case> MakeCases()
{
  std::vector<Case> cases;
  const double bounds[6] = { 0.0, 23.0, 0.0, 23.0, 0.0, 23.0 };
  for (int type = vtkFFDBarrTransform::TAPER; type <= vtkFFDBarrTransform::BEND; ++type)
  {
    auto transform = vtkSmartPointer<vtkFFDBarrTransform>::New();
    transform->SetDeformationType(type);
    transform->SetAxis(1);
    transform->FitToBounds(bounds);
    transform->SetAngle(60.0);
    transform->SetScale(1.3, 0.6);
    transform->SmoothProfileOn();
    cases.push_back({ transform->GetDeformationTypeAsString(), transform });
  }
  for (int type = vtkFFDRayDeflector::TRANSLATE; type <= vtkFFDRayDeflector::SCALE; ++type)
  {
    auto transform = vtkSmartPointer<vtkFFDRayDeflector>::New();
    transform->SetDeflectorType(type);
    transform->SetCenter(10.0, 12.0, 11.0);
    transform->SetRadius(14.0);
    transform->SetVector(3.0, 4.0, -2.0);
    transform->SetAngle(70.0);
    transform->SetFactor(1.7);
    cases.push_back({ transform->GetDeflectorTypeAsString(), transform });
  }
  return cases;
}

int TestAsTransforms()
{
  FFDRandom random(9);
  for (const Case& each : MakeCases())
  {
    vtkWarpTransform* transform = each.Transform;
    vtkSmartPointer<vtkAbstractTransform> copy;
    copy.TakeReference(transform->MakeTransform());
    copy->DeepCopy(transform);
    vtkAbstractTransform* inverse = transform->GetInverse();
    vtkSmartPointer<vtkAbstractTransform> inverseCopy;
    inverseCopy.TakeReference(transform->MakeTransform());
    inverseCopy->DeepCopy(inverse);
    double moved = 0.0;
    for (int n = 0; n < 50; ++n)
    {
      const double p[3] = { random.Number(1, 22), random.Number(1, 22), random.Number(1, 22) };
      double q[3];
      double back[3];
      double other[3];
      transform->TransformPoint(p, q);
      inverse->TransformPoint(q, back);
      copy->TransformPoint(p, other);
      FFD_CHECK(FFDDistance(back, p) < 1e-9 && FFDDistance(other, q) == 0.0);
      inverseCopy->TransformPoint(q, other);
      FFD_CHECK(FFDDistance(other, back) == 0.0);
      moved = std::max(moved, FFDDistance(p, q));
      // Single precision.
      const float f[3] = { static_cast<float>(p[0]), static_cast<float>(p[1]),
        static_cast<float>(p[2]) };
      float g[3];
      transform->TransformPoint(f, g);
      FFD_CHECK(std::abs(g[0] - q[0]) + std::abs(g[1] - q[1]) + std::abs(g[2] - q[2]) < 1e-4);
      // Derivatives of both directions belong together, and are those of differences.
      double j[3][3];
      double i[3][3];
      float single[3][3];
      transform->InternalTransformDerivative(p, q, j);
      inverse->InternalTransformDerivative(q, back, i);
      transform->InternalTransformDerivative(f, g, single);
      double product[3][3];
      vtkMath::Multiply3x3(j, i, product);
      for (int a = 0; a < 3; ++a)
      {
        double forward[3] = { p[0], p[1], p[2] };
        constexpr double h = 1e-5;
        forward[a] += h;
        transform->TransformPoint(forward, forward);
        for (int b = 0; b < 3; ++b)
        {
          FFD_CHECK_NEAR(product[a][b], a == b ? 1.0 : 0.0, 1e-8);
          FFD_CHECK_NEAR(j[b][a], (forward[b] - q[b]) / h, 1e-3);
          FFD_CHECK_NEAR(j[a][b], single[a][b], 1e-4);
        }
      }
    }
    FFD_CHECK(moved > 1.0);
  }
  return EXIT_SUCCESS;
}

int TestSetters()
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  vtkNew<vtkFFDBarrTransform> barr;
  vtkNew<FFDErrorLog> log;
  log->Watch(barr);
  double p[3] = { 1.0, 2.0, 3.0 };
  double q[3];
  barr->TransformPoint(p, q);
  FFD_CHECK(FFDDistance(p, q) == 0.0);
  const vtkMTimeType time = barr->GetMTime();
  barr->SetAxis(3);
  FFD_CHECK(log->Had("no axis 3"));
  barr->SetBendAxis(2);
  FFD_CHECK(log->Had("axis 2 is not possible"));
  barr->SetCenter(0.0, nan, 0.0);
  FFD_CHECK(log->Had("is no position"));
  barr->SetCenter(nullptr);
  FFD_CHECK(log->Had("null"));
  barr->SetRange(1.0, 1.0);
  FFD_CHECK(log->Had("is no range"));
  barr->SetRange(nullptr);
  FFD_CHECK(log->Had("null"));
  barr->SetAngle(nan);
  FFD_CHECK(log->Had("the angle is"));
  barr->SetScale(1.0, 0.0);
  FFD_CHECK(log->Had("are no scales"));
  barr->SetScale(nullptr);
  FFD_CHECK(log->Had("null"));
  barr->FitToBounds(nullptr);
  FFD_CHECK(log->Had("null, inverted or flat"));
  const double flat[6] = { 0, 1, 0, 1, 2, 2 };
  barr->FitToBounds(flat);
  FFD_CHECK(log->Had("flat along axis 2"));
  FFD_CHECK(barr->GetMTime() == time);
  barr->SetAxis(0);
  FFD_CHECK(barr->GetBendAxis() == 1);
  // The axis that is bent towards, and the profile, make a difference.
  barr->SetAngle(90.0);
  barr->SetRange(-2.0, 2.0);
  barr->TransformPoint(2.0, 0.0, 0.0);
  const double* end = barr->TransformPoint(2.0, 0.0, 0.0);
  FFD_CHECK(end[1] > 0.5 && end[2] == 0.0);
  barr->SetBendAxis(2);
  end = barr->TransformPoint(2.0, 0.0, 0.0);
  FFD_CHECK(end[2] > 0.5 && end[1] == 0.0);
  barr->SetDeformationTypeToTwist();
  barr->TransformPoint(std::array<double, 3>{ -1.0, 1.0, 0.0 }.data(), p);
  barr->SmoothProfileOn();
  barr->TransformPoint(std::array<double, 3>{ -1.0, 1.0, 0.0 }.data(), q);
  FFD_CHECK(FFDDistance(p, q) > 0.05);

  vtkNew<vtkFFDRayDeflector> deflector;
  log->Watch(deflector);
  const vtkMTimeType before = deflector->GetMTime();
  deflector->SetCenter(nan, 0.0, 0.0);
  FFD_CHECK(log->Had("SetCenter"));
  deflector->SetVector(nullptr);
  FFD_CHECK(log->Had("SetVector"));
  deflector->SetRadius(0.0);
  FFD_CHECK(log->Had("the radius is 0"));
  deflector->SetAngle(nan);
  FFD_CHECK(log->Had("the angle is"));
  deflector->SetFactor(-1.0);
  FFD_CHECK(log->Had("the factor is -1"));
  FFD_CHECK(deflector->GetMTime() == before && deflector->IsFoldFree());
  deflector->SetVector(0.6, 0.0, 0.0);
  FFD_CHECK(!deflector->IsFoldFree());
  deflector->SetRadius(2.0);
  FFD_CHECK(deflector->IsFoldFree());
  // No axis, no rotation.
  deflector->SetDeflectorTypeToRotate();
  deflector->SetAngle(50.0);
  deflector->SetVector(0.0, 0.0, 0.0);
  deflector->TransformPoint(std::array<double, 3>{ 0.5, 0.5, 0.5 }.data(), p);
  FFD_CHECK_NEAR(p[0], 0.5, 1e-15);
  return EXIT_SUCCESS;
}

/// Mean difference of two pictures over what either of them covers.
double MeanDifference(const std::vector<unsigned char>& a, const std::vector<unsigned char>& b)
{
  double sum = 0.0;
  int covered = 0;
  for (std::size_t i = 0; i < a.size(); i += 4)
  {
    if (a[i + 3] > 0 || b[i + 3] > 0)
    {
      ++covered;
      for (std::size_t c = 0; c < 4; ++c)
      {
        sum += std::abs(static_cast<int>(a[i + c]) - b[i + c]) / 4.0;
      }
    }
  }
  return covered > 0 ? sum / covered : 256.0;
}

int TestInMapper()
{
  // Two deflectors one after the other, too.
  std::vector<std::pair<std::string, vtkSmartPointer<vtkAbstractTransform>>> all;
  for (const Case& each : MakeCases())
  {
    all.emplace_back(each.Name, each.Transform);
  }
  vtkNew<vtkGeneralTransform> both;
  both->Concatenate(all[3].second);
  both->Concatenate(all[4].second);
  all.emplace_back("two deflectors", both.Get());

  FFDTestScene scene;
  scene.Mapper->SetDeformation(nullptr);
  const std::vector<unsigned char> undeformed = scene.Render(80);
  for (const auto& each : all)
  {
    scene.Mapper->SetInputData(scene.Image);
    scene.Mapper->SetDeformation(each.second);
    const std::vector<unsigned char> picture = scene.Render(80);
    FFD_CHECK(scene.Errors->Count == 0 && FFDLargestAlpha(picture) > 50);

    vtkNew<vtkImageReslice> reslice;
    reslice->SetInputData(scene.Image);
    reslice->SetResliceTransform(each.second->GetInverse());
    reslice->SetInterpolationModeToLinear();
    reslice->SetOutputSpacing(0.5, 0.5, 0.5);
    reslice->SetOutputOrigin(-10.0, -10.0, -10.0);
    reslice->SetOutputExtent(0, 90, 0, 90, 0, 90);
    reslice->BorderOff();
    reslice->Update();
    scene.Mapper->SetInputData(reslice->GetOutput());
    scene.Mapper->SetDeformation(nullptr);
    scene.Mapper->SetSampleDistance(1.0);
    const std::vector<unsigned char> expected = scene.Render(80);
    scene.Mapper->LockSampleDistanceToInputSpacingOn();
    const double difference = MeanDifference(picture, expected);
    const double effect = MeanDifference(picture, undeformed);
    if (!(difference < 2.0 && effect > 4.0 * difference))
    {
      std::cerr << each.first << ": mean difference " << difference << " of 255, from undeformed "
                << effect << "\n";
      return EXIT_FAILURE;
    }
  }
  return EXIT_SUCCESS;
}

} // namespace

int TestFunctionalTransforms(int, char*[])
{
  return TestAsTransforms() || TestSetters() || TestInMapper() ? EXIT_FAILURE : EXIT_SUCCESS;
}
