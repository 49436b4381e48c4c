// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Setters that take arrays refuse a null pointer with an error, and change nothing.

#include "FFDTestHelpers.h"

#include "vtkFFDBarrTransform.h"
#include "vtkFFDEditLattice.h"
#include "vtkFFDFitLattice.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDLattice.h"
#include "vtkFFDLatticeRepresentation.h"
#include "vtkFFDLatticeSource.h"
#include "vtkFFDMassSpring.h"
#include "vtkFFDRayDeflector.h"
#include "vtkFFDRayTracer.h"
#include "vtkFFDResampleVolume.h"
#include "vtkFFDTransformReader.h"
#include "vtkFFDTransformSeries.h"

namespace
{

template <class Class, class Value, class... Rest>
bool Refused(const char* name, void (Class::*set)(const Value*, Rest...), const Rest&... rest)
{
  vtkNew<Class> object;
  vtkNew<FFDErrorLog> log;
  log->Watch(object);
  const vtkMTimeType before = object->GetMTime();
  ((*object).*set)(nullptr, rest...);
  const bool unchanged = object->GetMTime() == before;
  if (log->Had("") && unchanged)
  {
    return true;
  }
  std::cerr << name << ": null was not refused\n";
  return false;
}

} // namespace

#define FFD_CHECK_NULL(Class, Method, ...)                                                         \
  FFD_CHECK((Refused<Class, __VA_ARGS__>(#Class "::" #Method, &Class::Method)))

int TestNullPointers(int, char*[])
{
  FFD_CHECK_NULL(vtkFFDBarrTransform, SetCenter, double);
  FFD_CHECK_NULL(vtkFFDBarrTransform, SetRange, double);
  FFD_CHECK_NULL(vtkFFDBarrTransform, SetScale, double);
  FFD_CHECK_NULL(vtkFFDBarrTransform, FitToBounds, double);
  FFD_CHECK_NULL(vtkFFDEditLattice, SetDimensions, int);
  FFD_CHECK_NULL(vtkFFDEditLattice, SetEditDimensions, int);
  FFD_CHECK_NULL(vtkFFDFitLattice, SetBounds, double);
  FFD_CHECK_NULL(vtkFFDInverseRayVolumeMapper, SetClipBox, double);
  FFD_CHECK_NULL(vtkFFDInverseRayVolumeMapper, SetWholeBounds, double);
  FFD_CHECK_NULL(vtkFFDInverseRayVolumeMapper, SetWholeScalarRange, double);
  FFD_CHECK_NULL(vtkFFDLattice, SetDimensions, int);
  FFD_CHECK_NULL(vtkFFDLattice, SetDomain, double);
  FFD_CHECK((Refused<vtkFFDLattice, double, double>(
    "vtkFFDLattice::FitToBounds", &vtkFFDLattice::FitToBounds, 0.0)));
  FFD_CHECK_NULL(vtkFFDLatticeRepresentation, SetOutlineBounds, double);
  FFD_CHECK_NULL(vtkFFDLatticeRepresentation, SetSymmetry, vtkTypeBool);
  FFD_CHECK_NULL(vtkFFDLatticeSource, SetBounds, double);
  FFD_CHECK_NULL(vtkFFDLatticeSource, SetDimensions, int);
  FFD_CHECK_NULL(vtkFFDMassSpring, SetGravity, double);
  FFD_CHECK_NULL(vtkFFDRayDeflector, SetCenter, double);
  FFD_CHECK_NULL(vtkFFDRayDeflector, SetVector, double);
  FFD_CHECK_NULL(vtkFFDRayTracer, SetImageSize, int);
  FFD_CHECK_NULL(vtkFFDResampleVolume, SetOutputSpacing, double);
  FFD_CHECK_NULL(vtkFFDResampleVolume, SetOutputOrigin, double);
  FFD_CHECK_NULL(vtkFFDResampleVolume, SetOutputExtent, int);
  FFD_CHECK_NULL(vtkFFDTransformReader, SetFitBounds, double);
  FFD_CHECK_NULL(vtkFFDTransformSeries, SetFitBounds, double);
  vtkNew<vtkFFDLatticeRepresentation> representation;
  vtkNew<FFDErrorLog> log;
  log->Watch(representation);
  representation->PlaceWidget(nullptr);
  FFD_CHECK(log->Had(""));
  vtkNew<vtkFFDLattice> lattice;
  log->Watch(lattice);
  lattice->SetControlPoint(0, 0, 0, nullptr);
  FFD_CHECK(log->Had(""));
  lattice->SetDisplacement(0, 0, 0, nullptr);
  FFD_CHECK(log->Had(""));
  return EXIT_SUCCESS;
}
