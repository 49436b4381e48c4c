// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to the plugin.
#ifndef vtkFFDCameraPlace_h
#define vtkFFDCameraPlace_h

#include "vtkCamera.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"

/// Where a camera looks from, and the unit vector along which it looks; with the matrices of the
/// user that it may have, which vtkCamera::GetPosition() leaves out.
struct vtkFFDCameraPlace
{
  double Position[3];
  double Direction[3];

  explicit vtkFFDCameraPlace(vtkCamera* camera)
  {
    vtkNew<vtkMatrix4x4> fromView;
    vtkMatrix4x4::Invert(camera->GetModelViewTransformMatrix(), fromView);
    for (int a = 0; a < 3; ++a)
    {
      this->Position[a] = fromView->GetElement(a, 3);
      this->Direction[a] = -fromView->GetElement(a, 2);
    }
    vtkMath::Normalize(this->Direction);
  }
};

#endif
