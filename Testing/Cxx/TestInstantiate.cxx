// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Every public class can be made, printed and deleted, and knows its superclass.
#include "vtkFFDBarrTransform.h"
#include "vtkFFDDeformGeometry.h"
#include "vtkFFDDeformVolume.h"
#include "vtkFFDDistanceMap.h"
#include "vtkFFDEditLattice.h"
#include "vtkFFDFitLattice.h"
#include "vtkFFDInteractiveFrames.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDJacobian.h"
#include "vtkFFDLattice.h"
#include "vtkFFDLatticeRepresentation.h"
#include "vtkFFDLatticeSource.h"
#include "vtkFFDLatticeWidget.h"
#include "vtkFFDMassSpring.h"
#include "vtkFFDRayDeflector.h"
#include "vtkFFDRayTracer.h"
#include "vtkFFDResampleVolume.h"
#include "vtkFFDSplineTransform.h"
#include "vtkFFDSumTransform.h"
#include "vtkFFDTransformReader.h"
#include "vtkFFDTransformSeries.h"
#include "vtkFFDTransformWriter.h"
#include "vtkFFDVolumePicker.h"
#include "vtkFFDVolumeReader.h"
#include "vtkFFDVolumeSeries.h"

#include "vtkNew.h"

#include <iostream>
#include <sstream>
#include <string>

namespace
{
template <typename T>
bool Check(const char* className, const char* superclassName)
{
  vtkNew<T> object;
  std::ostringstream text;
  object->Print(text);
  const bool ok = object->IsA(className) && object->IsA(superclassName) &&
    text.str().find(className) != std::string::npos &&
    // The executive of an algorithm holds a reference to it.
    (object->GetReferenceCount() == 1 || object->IsA("vtkAlgorithm"));
  if (!ok)
  {
    std::cerr << className << " does not print itself, is no " << superclassName
              << ", or keeps a reference to itself:\n"
              << text.str();
  }
  return ok;
}
}

int TestInstantiate(int, char*[])
{
  bool ok = Check<vtkFFDLattice>("vtkFFDLattice", "vtkBSplineTransform");
  ok &= Check<vtkFFDDeformVolume>("vtkFFDDeformVolume", "vtkAlgorithm");
  ok &= Check<vtkFFDEditLattice>("vtkFFDEditLattice", "vtkAlgorithm");
  ok &= Check<vtkFFDFitLattice>("vtkFFDFitLattice", "vtkAlgorithm");
  ok &= Check<vtkFFDMassSpring>("vtkFFDMassSpring", "vtkAlgorithm");
  ok &= Check<vtkFFDSplineTransform>("vtkFFDSplineTransform", "vtkWarpTransform");
  ok &= Check<vtkFFDSumTransform>("vtkFFDSumTransform", "vtkWarpTransform");
  ok &= Check<vtkFFDTransformReader>("vtkFFDTransformReader", "vtkAlgorithm");
  ok &= Check<vtkFFDTransformSeries>("vtkFFDTransformSeries", "vtkAlgorithm");
  ok &= Check<vtkFFDTransformWriter>("vtkFFDTransformWriter", "vtkObject");
  ok &= Check<vtkFFDVolumeReader>("vtkFFDVolumeReader", "vtkAlgorithm");
  ok &= Check<vtkFFDVolumeSeries>("vtkFFDVolumeSeries", "vtkAlgorithm");
  ok &= Check<vtkFFDInverseRayVolumeMapper>("vtkFFDInverseRayVolumeMapper", "vtkVolumeMapper");
  ok &=
    Check<vtkFFDLatticeRepresentation>("vtkFFDLatticeRepresentation", "vtkWidgetRepresentation");
  ok &= Check<vtkFFDLatticeWidget>("vtkFFDLatticeWidget", "vtkAbstractWidget");
  ok &= Check<vtkFFDBarrTransform>("vtkFFDBarrTransform", "vtkWarpTransform");
  ok &= Check<vtkFFDRayDeflector>("vtkFFDRayDeflector", "vtkWarpTransform");
  ok &= Check<vtkFFDLatticeSource>("vtkFFDLatticeSource", "vtkImageAlgorithm");
  ok &= Check<vtkFFDResampleVolume>("vtkFFDResampleVolume", "vtkImageAlgorithm");
  ok &= Check<vtkFFDDeformGeometry>("vtkFFDDeformGeometry", "vtkPointSetAlgorithm");
  ok &= Check<vtkFFDJacobian>("vtkFFDJacobian", "vtkImageAlgorithm");
  ok &= Check<vtkFFDDistanceMap>("vtkFFDDistanceMap", "vtkImageAlgorithm");
  ok &= Check<vtkFFDInteractiveFrames>("vtkFFDInteractiveFrames", "vtkObject");
  ok &= Check<vtkFFDRayTracer>("vtkFFDRayTracer", "vtkPolyDataAlgorithm");
  ok &= Check<vtkFFDVolumePicker>("vtkFFDVolumePicker", "vtkVolumePicker");
  return ok ? EXIT_SUCCESS : EXIT_FAILURE;
}
