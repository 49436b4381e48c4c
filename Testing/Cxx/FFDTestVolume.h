// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDTestVolume_h
#define FFDTestVolume_h

#include "FFDTestHelpers.h"

#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkColorTransferFunction.h"
#include "vtkConeSource.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDRayStatistics.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderer.h"
#include "vtkRenderWindow.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"

#include <cmath>
#include <vector>

/// A ball that fades outwards: scalars from 200 in the center to 0 at the border, off center so
/// that no view of it is symmetric.
inline vtkSmartPointer<vtkImageData> FFDMakeBall(int n = 24, int type = VTK_FLOAT)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(n, n, n);
  image->AllocateScalars(type, 1);
  const double center = 0.45 * (n - 1);
  for (int k = 0; k < n; ++k)
  {
    for (int j = 0; j < n; ++j)
    {
      for (int i = 0; i < n; ++i)
      {
        const double r = std::sqrt((i - center) * (i - center) + (j - center) * (j - center) +
          1.5 * (k - center) * (k - center));
        image->SetScalarComponentFromDouble(
          i, j, k, 0, std::floor(std::max(0.0, 200.0 * (1.0 - r / (0.5 * n)))));
      }
    }
  }
  image->GetPointData()->GetScalars()->SetName("ball");
  return image;
}

/// A volume with a mapper, a camera that sees it, and a green cone next to it.
struct FFDTestScene
{
  FFDTestScene()
  {
    this->Image = FFDMakeBall();
    this->Mapper->SetInputData(this->Image);
    this->Mapper->SetDeformation(this->Lattice);
    this->Errors->Watch(this->Mapper);
    this->Lattice->SetDimensions(5, 5, 5);
    this->Lattice->FitToBounds(this->Image->GetBounds(), 0.0);
    this->Lattice->SetDisplacement(2, 2, 2, 5.0, 3.0, 2.0);
    this->Lattice->SetDisplacement(1, 3, 2, -3.0, 4.0, 1.0);
    this->Opacity->AddPoint(0.0, 0.0);
    this->Opacity->AddPoint(40.0, 0.0);
    this->Opacity->AddPoint(200.0, 0.4);
    this->Color->AddRGBPoint(0.0, 0.2, 0.2, 1.0);
    this->Color->AddRGBPoint(200.0, 1.0, 0.5, 0.1);
    this->Property->SetScalarOpacity(this->Opacity);
    this->Property->SetColor(this->Color);
    this->Property->SetInterpolationTypeToLinear();
    this->Volume->SetMapper(this->Mapper);
    this->Volume->SetProperty(this->Property);
    this->Renderer->AddVolume(this->Volume);
    this->Renderer->SetBackground(0.0, 0.0, 0.0);

    this->Cone->SetCenter(-8.0, -8.0, 8.0);
    this->Cone->SetHeight(6.0);
    this->Cone->SetRadius(4.0);
    this->ConeMapper->SetInputConnection(this->Cone->GetOutputPort());
    this->ConeActor->SetMapper(this->ConeMapper);
    this->ConeActor->GetProperty()->SetColor(0.0, 1.0, 0.0);
    this->ConeActor->GetProperty()->LightingOff();
    this->Renderer->AddActor(this->ConeActor);

    vtkCamera* camera = this->Renderer->GetActiveCamera();
    camera->SetFocalPoint(9.0, 9.0, 11.0);
    camera->SetPosition(29.0, 25.0, 70.0);
    camera->SetViewUp(0.0, 1.0, 0.0);
    camera->SetClippingRange(20.0, 120.0);
  }

  /// RenderToImage; empty after an error.
  std::vector<unsigned char> Render(int size = 40)
  {
    vtkNew<vtkImageData> out;
    if (!this->Mapper->RenderToImage(this->Renderer, this->Volume, size, size, out))
    {
      return {};
    }
    auto* bytes = static_cast<unsigned char*>(out->GetScalarPointer());
    return std::vector<unsigned char>(bytes, bytes + 4 * size * size);
  }

  /// The window, made on first use; RGB bytes of it.
  std::vector<unsigned char> Show(int size = 80)
  {
    if (!this->Window)
    {
      this->Window = vtkSmartPointer<vtkRenderWindow>::New();
      this->Window->SetMultiSamples(0);
      this->Window->SetOffScreenRendering(1);
      this->Window->SetSize(size, size);
      this->Window->AddRenderer(this->Renderer);
    }
    this->Window->Render();
    vtkNew<vtkUnsignedCharArray> pixels;
    this->Window->GetPixelData(0, 0, size - 1, size - 1, 0, pixels);
    const unsigned char* p = pixels->GetPointer(0);
    return std::vector<unsigned char>(p, p + pixels->GetNumberOfValues());
  }

  vtkSmartPointer<vtkImageData> Image;
  vtkNew<vtkFFDLattice> Lattice;
  vtkNew<vtkFFDInverseRayVolumeMapper> Mapper;
  vtkNew<FFDErrorLog> Errors;
  vtkNew<vtkPiecewiseFunction> Opacity;
  vtkNew<vtkColorTransferFunction> Color;
  vtkNew<vtkVolumeProperty> Property;
  vtkNew<vtkVolume> Volume;
  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkConeSource> Cone;
  vtkNew<vtkPolyDataMapper> ConeMapper;
  vtkNew<vtkActor> ConeActor;
  vtkSmartPointer<vtkRenderWindow> Window;
};

/// Pixels of the pure green of the cone.
inline int FFDCountGreen(const std::vector<unsigned char>& rgb)
{
  int count = 0;
  for (std::size_t i = 0; i + 2 < rgb.size(); i += 3)
  {
    count += rgb[i] == 0 && rgb[i + 1] == 255 && rgb[i + 2] == 0 ? 1 : 0;
  }
  return count;
}

/// Largest alpha of RGBA bytes; -1 for no image.
inline int FFDLargestAlpha(const std::vector<unsigned char>& rgba)
{
  int most = rgba.empty() ? -1 : 0;
  for (std::size_t i = 3; i < rgba.size(); i += 4)
  {
    most = std::max(most, static_cast<int>(rgba[i]));
  }
  return most;
}

/// Largest difference of two images of the same size; 256 otherwise.
inline int FFDLargestDifference(
  const std::vector<unsigned char>& a, const std::vector<unsigned char>& b)
{
  if (a.size() != b.size() || a.empty())
  {
    return 256;
  }
  int most = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    most = std::max(most, std::abs(static_cast<int>(a[i]) - b[i]));
  }
  return most;
}

#endif
