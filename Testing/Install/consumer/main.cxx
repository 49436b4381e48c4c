// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Use the installed classes together: a lattice, the mapper, and a window that renders.
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDLattice.h"
#include "vtkFFDLatticeRepresentation.h"
#include "vtkFFDLatticeSource.h"
#include "vtkFFDLatticeWidget.h"
#include "vtkFFDMassSpring.h"
#include "vtkFFDTransformReader.h"

#include "vtkColorTransferFunction.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPiecewiseFunction.h"
#include "vtkRenderer.h"
#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkRTAnalyticSource.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <cmath>
#include <cstdlib>
#include <iostream>

int main()
{
  // A uniform displacement of all control points is a translation.
  vtkNew<vtkImageData> coefficients;
  coefficients->SetDimensions(5, 5, 5);
  coefficients->SetOrigin(-10.0, -10.0, -10.0);
  coefficients->SetSpacing(5.0, 5.0, 5.0);
  coefficients->AllocateScalars(VTK_DOUBLE, 3);
  auto* values = static_cast<double*>(coefficients->GetScalarPointer());
  for (vtkIdType i = 0; i < 3 * coefficients->GetNumberOfPoints(); ++i)
  {
    values[i] = i % 3 == 0 ? 2.0 : 0.0;
  }
  vtkNew<vtkFFDLattice> lattice;
  lattice->SetCoefficientData(coefficients);
  const double in[3] = { 1.0, 2.0, 3.0 };
  double out[3];
  lattice->TransformPoint(in, out);
  if (std::abs(out[0] - 3.0) > 1e-9 || std::abs(out[1] - 2.0) > 1e-9 ||
    std::abs(out[2] - 3.0) > 1e-9)
  {
    std::cerr << "The lattice maps (1, 2, 3) to (" << out[0] << ", " << out[1] << ", " << out[2]
              << ") instead of (3, 2, 3).\n";
    return EXIT_FAILURE;
  }

  vtkNew<vtkRTAnalyticSource> wavelet;
  wavelet->SetWholeExtent(-8, 8, -8, 8, -8, 8);
  vtkNew<vtkFFDInverseRayVolumeMapper> mapper;
  mapper->SetInputConnection(wavelet->GetOutputPort());

  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(0.0, 0.0);
  opacity->AddPoint(250.0, 1.0);
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(0.0, 0.0, 0.0, 1.0);
  color->AddRGBPoint(250.0, 1.0, 0.0, 0.0);
  vtkNew<vtkVolumeProperty> property;
  property->SetScalarOpacity(opacity);
  property->SetColor(color);
  vtkNew<vtkVolume> volume;
  volume->SetMapper(mapper);
  volume->SetProperty(property);
  vtkNew<vtkRenderer> renderer;
  renderer->AddVolume(volume);
  vtkNew<vtkRenderWindow> window;
  window->SetSize(64, 64);
  window->AddRenderer(renderer);
  window->Render();

  // A widget around the volume, and an edit by it.
  vtkNew<vtkFFDLattice> edited;
  edited->FitToBounds(mapper->GetBounds());
  mapper->SetDeformation(edited);
  vtkNew<vtkRenderWindowInteractor> interactor;
  interactor->SetRenderWindow(window);
  vtkNew<vtkFFDLatticeWidget> widget;
  widget->SetInteractor(interactor);
  vtkFFDLatticeRepresentation* representation = widget->GetLatticeRepresentation();
  representation->SetLattice(edited);
  representation->SetProp(volume);
  widget->On();
  representation->SelectPoint(1, 1, 1);
  const int moved = representation->TranslateSelection(1.0, 0.0, 0.0);
  window->Render();
  if (!moved || edited->IsIdentity() || !representation->Undo() || !edited->IsIdentity())
  {
    std::cerr << "The widget does not edit the lattice.\n";
    return EXIT_FAILURE;
  }
  widget->Off();

  // A class of each further module.
  vtkNew<vtkFFDTransformReader> reader;
  vtkNew<vtkFFDMassSpring> body;
  body->SetLattice(edited);
  if (!vtkFFDLatticeSource::ApplyShape(edited, vtkFFDLatticeSource::TWIST, 0.5) || !body->Step(1))
  {
    std::cerr << "The lattice of a body does not move.\n";
    return EXIT_FAILURE;
  }

  std::cout << "rendered with " << window->GetClassName() << " and " << mapper->GetClassName()
            << "\n";
  return EXIT_SUCCESS;
}
