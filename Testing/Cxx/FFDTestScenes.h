// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What the tests that compare pictures share: volumes, transfer functions, cameras, deformations,
// the distance between two pictures, and a list of checks that prints every figure.
#ifndef FFDTestScenes_h
#define FFDTestScenes_h

#include "vtkAbstractVolumeMapper.h"
#include "vtkBSplineTransform.h"
#include "vtkCamera.h"
#include "vtkColorTransferFunction.h"
#include "vtkDoubleArray.h"
#include "vtkFFDInverseRayVolumeMapper.h"
#include "vtkFFDVersions.h"
#include "vtkFixedPointRayCastImage.h"
#include "vtkFixedPointVolumeRayCastMapper.h"
#include "vtkImageCast.h"
#include "vtkImageChangeInformation.h"
#include "vtkImageConstantPad.h"
#include "vtkImageData.h"
#include "vtkImageShrink3D.h"
#include "vtkLight.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkOpenGLGPUVolumeRayCastMapper.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPNGReader.h"
#include "vtkPNGWriter.h"
#include "vtkPointData.h"
#include "vtkRegressionTestImage.h"
#include "vtkRenderer.h"
#include "vtkRenderWindow.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVolume.h"
#include "vtkVolumeProperty.h"
#include "vtkXMLImageDataReader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <iomanip>
#include <iostream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

namespace ffdTest
{

using Vec3 = std::array<double, 3>;

//------------------------------------------------------------------------------
/// The checks of a test. Each prints its figures; the test fails if any of them fails.
class Checks
{
public:
  /// `figures`: what was measured, and the limits.
  void Expect(bool ok, const std::string& what, const std::string& figures)
  {
    std::cout << (ok ? "ok    " : "WRONG ") << what << ": " << figures << std::endl;
    ++this->Count;
    this->Wrong += ok ? 0 : 1;
  }

  void ExpectAtMost(const std::string& what, double value, double limit)
  {
    std::ostringstream text;
    text << value << " (at most " << limit << ")";
    this->Expect(value <= limit, what, text.str());
  }

  void ExpectAtLeast(const std::string& what, double value, double limit)
  {
    std::ostringstream text;
    text << value << " (at least " << limit << ")";
    this->Expect(value >= limit, what, text.str());
  }

  int Result() const
  {
    std::cout << this->Count - this->Wrong << " of " << this->Count << " checks passed\n";
    return this->Count > 0 && this->Wrong == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
  }

private:
  int Count = 0;
  int Wrong = 0;
};

//------------------------------------------------------------------------------
/// The argument that follows `flag` on the command line of a test.
inline std::string FindArgument(int argc, char* argv[], const std::string& flag)
{
  for (int i = 1; i + 1 < argc; ++i)
  {
    if (flag == argv[i])
    {
      return argv[i + 1];
    }
  }
  return std::string();
}

/// Volume `name`.vti of the test data, every `shrink`-th voxel (averaged) along each axis.
inline vtkSmartPointer<vtkImageData> ReadVolume(
  int argc, char* argv[], const std::string& name, int shrink = 1)
{
  vtkNew<vtkXMLImageDataReader> reader;
  reader->SetFileName((FindArgument(argc, argv, "-D") + "/" + name + ".vti").c_str());
  vtkSmartPointer<vtkImageData> image;
  if (shrink > 1)
  {
    vtkNew<vtkImageShrink3D> smaller;
    smaller->SetInputConnection(reader->GetOutputPort());
    smaller->SetShrinkFactors(shrink, shrink, shrink);
    smaller->Update();
    image = smaller->GetOutput();
  }
  else
  {
    reader->Update();
    image = reader->GetOutput();
  }
  if (!image->GetPointData()->GetScalars() || image->GetNumberOfPoints() < 8)
  {
    std::cerr << "The volume " << name << " could not be read from the test data.\n";
    std::exit(EXIT_FAILURE);
  }
  return image;
}

/// The image with float scalars: VTK's mappers round whole numbers.
inline vtkSmartPointer<vtkImageData> AsFloats(vtkImageData* image)
{
  vtkNew<vtkImageCast> cast;
  cast->SetInputData(image);
  cast->SetOutputScalarTypeToFloat();
  cast->Update();
  return cast->GetOutput();
}

/**
 * The volume with a layer of transparent voxels of value `value` around it. VTK's mappers differ
 * in whether they take a sample that lies on the face of the volume, which is seen as rings where
 * the face cuts through opaque matter.
 */
inline vtkSmartPointer<vtkImageData> Padded(vtkImageData* image, double value)
{
  int extent[6];
  image->GetExtent(extent);
  vtkNew<vtkImageConstantPad> pad;
  pad->SetInputData(image);
  pad->SetConstant(value);
  pad->SetOutputWholeExtent(
    extent[0] - 1, extent[1] + 1, extent[2] - 1, extent[3] + 1, extent[4] - 1, extent[5] + 1);
  vtkNew<vtkImageChangeInformation> shift;
  shift->SetInputConnection(pad->GetOutputPort());
  shift->SetOutputExtentStart(0, 0, 0);
  shift->Update();
  return shift->GetOutput();
}

//------------------------------------------------------------------------------
/// Pixels of a window or image, rows bottom up, three bytes each.
struct Picture
{
  int Width = 0;
  int Height = 0;
  std::vector<unsigned char> Rgb;
};

/// How far two pictures are apart, over the pixels where either differs from the background.
struct Distance
{
  int Pixels = 0;
  double Mean = 0.0; ///< of the largest difference of a pixel's channels, 0 to 255
  double P99 = 0.0;  ///< its 99th percentile
  double Max = 0.0;
  double Psnr = std::numeric_limits<double>::infinity(); ///< dB, over all three channels
};

inline std::ostream& operator<<(std::ostream& os, const Distance& d)
{
  return os << std::fixed << std::setprecision(3) << "mean " << d.Mean << " p99 "
            << std::setprecision(0) << d.P99 << " max " << d.Max << std::setprecision(2) << " psnr "
            << d.Psnr << " dB over " << d.Pixels << " px" << std::defaultfloat
            << std::setprecision(6);
}

inline std::string ToString(const Distance& d)
{
  std::ostringstream text;
  text << d;
  return text.str();
}

/// Compares two pictures; `background`: three bytes. Where there is nothing to compare, because the
/// pictures differ in size or neither shows anything, no number is one: comparisons with NaN are
/// false, so that checks of an upper and of a lower limit fail both. Write them as `d.Max <= limit`
/// and `d.Mean > limit`, never as `!(d.Max > limit)` or with std::max().
inline Distance Compare(
  const Picture& a, const Picture& b, const std::array<unsigned char, 3>& background)
{
  Distance result;
  result.Mean = result.P99 = result.Max = result.Psnr = std::numeric_limits<double>::quiet_NaN();
  if (a.Rgb.size() != b.Rgb.size())
  {
    return result;
  }
  std::vector<int> worst;
  double squares = 0.0;
  for (std::size_t i = 0; i + 2 < a.Rgb.size(); i += 3)
  {
    int difference = 0;
    bool inside = false;
    double square = 0.0;
    for (std::size_t c = 0; c < 3; ++c)
    {
      const int d = static_cast<int>(a.Rgb[i + c]) - static_cast<int>(b.Rgb[i + c]);
      difference = std::max(difference, std::abs(d));
      square += d * d;
      inside = inside || a.Rgb[i + c] != background[c] || b.Rgb[i + c] != background[c];
    }
    if (inside)
    {
      worst.push_back(difference);
      squares += square;
    }
  }
  if (worst.empty())
  {
    return result;
  }
  std::sort(worst.begin(), worst.end());
  double sum = 0.0;
  for (int d : worst)
  {
    sum += d;
  }
  result.Pixels = static_cast<int>(worst.size());
  result.Mean = sum / static_cast<double>(worst.size());
  result.P99 = worst[(worst.size() - 1) * 99 / 100];
  result.Max = worst.back();
  result.Psnr = std::numeric_limits<double>::infinity();
  if (squares > 0.0)
  {
    result.Psnr =
      10.0 * std::log10(255.0 * 255.0 * 3.0 * static_cast<double>(worst.size()) / squares);
  }
  return result;
}

//------------------------------------------------------------------------------
/// Points of a transfer function: scalar, red, green, blue, opacity.
using Transfer = std::vector<std::array<double, 5>>;

inline void SetTransfer(vtkVolumeProperty* property, const Transfer& points, double unit)
{
  vtkNew<vtkColorTransferFunction> color;
  vtkNew<vtkPiecewiseFunction> opacity;
  for (const std::array<double, 5>& p : points)
  {
    color->AddRGBPoint(p[0], p[1], p[2], p[3]);
    opacity->AddPoint(p[0], p[4]);
  }
  property->SetColor(color);
  property->SetScalarOpacity(opacity);
  property->SetScalarOpacityUnitDistance(unit);
  property->SetInterpolationTypeToLinear();
}

/// Transfer functions that suit the volumes of the test data.
inline Transfer SemiTransparentEngine()
{
  return { { 40, 0.2, 0.3, 0.8, 0.0 }, { 100, 0.3, 0.7, 0.6, 0.02 }, { 150, 0.9, 0.7, 0.3, 0.03 },
    { 200, 0.9, 0.2, 0.1, 0.1 }, { 255, 1.0, 1.0, 1.0, 0.2 } };
}

inline Transfer SolidEngine()
{
  return { { 70, 0.8, 0.6, 0.3, 0.0 }, { 90, 0.8, 0.6, 0.3, 0.3 }, { 150, 0.7, 0.7, 0.9, 0.4 },
    { 220, 1.0, 1.0, 1.0, 0.9 } };
}

/// Only the densest parts: most of the volume is empty space.
inline Transfer SparseEngine()
{
  return { { 180, 0.9, 0.3, 0.1, 0.0 }, { 190, 0.9, 0.5, 0.1, 0.8 }, { 255, 1.0, 0.9, 0.4, 1.0 } };
}

inline Transfer HeadSkinAndBone()
{
  return { { 40, 0.9, 0.6, 0.4, 0.0 }, { 70, 0.9, 0.6, 0.4, 0.02 }, { 100, 0.8, 0.4, 0.3, 0.04 },
    { 130, 0.9, 0.8, 0.7, 0.4 }, { 220, 1.0, 1.0, 0.95, 0.8 } };
}

inline Transfer HeadSkin()
{
  return { { 25, 0.85, 0.6, 0.5, 0.0 }, { 45, 0.9, 0.7, 0.6, 0.5 }, { 120, 0.95, 0.85, 0.75, 0.8 },
    { 200, 1.0, 1.0, 1.0, 0.9 } };
}

inline Transfer HeadBone()
{
  return { { 120, 0.8, 0.7, 0.5, 0.0 }, { 135, 0.9, 0.85, 0.7, 0.8 }, { 220, 1.0, 1.0, 0.9, 1.0 } };
}

inline Transfer HeadsqSoft()
{
  return { { 400, 0.9, 0.5, 0.3, 0.0 }, { 900, 0.9, 0.6, 0.4, 0.01 }, { 1100, 0.8, 0.4, 0.4, 0.03 },
    { 1300, 0.9, 0.9, 0.8, 0.1 }, { 2500, 1.0, 1.0, 1.0, 0.3 } };
}

inline Transfer HeadsqSkin()
{
  return { { 500, 0.9, 0.6, 0.5, 0.0 }, { 700, 0.9, 0.7, 0.6, 0.4 }, { 1150, 0.9, 0.8, 0.7, 0.5 },
    { 1400, 1.0, 1.0, 0.9, 0.9 } };
}

inline Transfer HeadsqBone()
{
  return { { 1150, 0.8, 0.7, 0.5, 0.0 }, { 1250, 0.9, 0.85, 0.7, 0.7 },
    { 2500, 1.0, 1.0, 0.9, 1.0 } };
}

//------------------------------------------------------------------------------
/// A camera: angles in degrees about the view from -y with +z up, zoom, and whether parallel.
struct View
{
  double Azimuth = 0.0;
  double Elevation = 0.0;
  double Zoom = 1.0;
  bool Parallel = false;
  bool Inside = false; ///< from a point inside the volume, a wide angle
};

//------------------------------------------------------------------------------
/// A window with one volume, and the three mappers that can draw it with equal settings.
class Scene
{
public:
  static constexpr int Size = 140;

  explicit Scene(int size = Size)
  {
    this->Window->SetOffScreenRendering(1);
    this->Window->SetMultiSamples(0);
    this->Window->SetSize(size, size);
    this->Window->AddRenderer(this->Renderer);
    // Whole bytes, so that the background is the same in all pictures.
    this->Renderer->SetBackground(26.0 / 255.0, 26.0 / 255.0, 51.0 / 255.0);
    // The ambient color of VTK's lights is black. The GPU mapper and ours take a single headlight
    // to be white, vtkFixedPointVolumeRayCastMapper does not.
    this->Headlight->SetLightTypeToHeadlight();
    this->Headlight->SetAmbientColor(1.0, 1.0, 1.0);
    this->Renderer->AddLight(this->Headlight);
    // What the tolerance allows is not what these scenes compare.
    this->Ours->SetPositionTolerance(0.01);
    this->Volume->SetProperty(this->Property);
    this->Renderer->AddVolume(this->Volume);
    this->Ours->SetAutoAdjustSampleDistances(0);
    this->Fixed->SetAutoAdjustSampleDistances(0);
    this->Fixed->SetImageSampleDistance(1.0f);
    this->Fixed->SetIntermixIntersectingGeometry(1);
    this->Gpu->SetAutoAdjustSampleDistances(0);
    this->Gpu->SetUseJittering(0);
    this->Gpu->SetImageSampleDistance(1.0f);
    this->SetSampleDistance(1.0);
  }

  void SetInput(vtkImageData* image)
  {
    this->Ours->SetInputData(image);
    this->Fixed->SetInputData(image);
    this->Gpu->SetInputData(image);
  }

  void SetSampleDistance(double distance)
  {
    this->Ours->SetSampleDistance(distance);
    this->Fixed->SetSampleDistance(static_cast<float>(distance));
    this->Gpu->SetSampleDistance(static_cast<float>(distance));
  }

  void SetShading(double ambient, double diffuse, double specular, double power)
  {
    this->Property->ShadeOn();
    this->Property->SetAmbient(ambient);
    this->Property->SetDiffuse(diffuse);
    this->Property->SetSpecular(specular);
    this->Property->SetSpecularPower(power);
  }

  /// SetShading() without highlights if those of the GPU mapper differ from ours.
  void SetShadingAsGpuMapper(double ambient, double diffuse, double specular, double power)
  {
#ifdef VTK_FFD_GPU_MAPPER_REFLECTS_HIGHLIGHTS
    specular = 0.0;
#endif
    this->SetShading(ambient, diffuse, specular, power);
  }

  /// The headlight's ambient color: black as VTK's default, or white, which makes
  /// vtkFixedPointVolumeRayCastMapper light the ambient term as the GPU mapper always does.
  void SetWhiteAmbientLight(bool white)
  {
    const double channel = white ? 1.0 : 0.0;
    this->Headlight->SetAmbientColor(channel, channel, channel);
  }

  /// Look at the middle of `bounds`.
  void SetCamera(const View& view, const double bounds[6])
  {
    vtkCamera* camera = this->Renderer->GetActiveCamera();
    const double middle[3] = { 0.5 * (bounds[0] + bounds[1]), 0.5 * (bounds[2] + bounds[3]),
      0.5 * (bounds[4] + bounds[5]) };
    camera->SetParallelProjection(view.Parallel ? 1 : 0);
    camera->SetViewAngle(view.Inside ? 80.0 : 30.0);
    camera->SetFocalPoint(middle);
    camera->SetPosition(middle[0], middle[1] - (bounds[3] - bounds[2]), middle[2]);
    camera->SetViewUp(0.0, 0.0, 1.0);
    camera->Azimuth(view.Azimuth);
    camera->Elevation(view.Elevation);
    camera->OrthogonalizeViewUp();
    if (view.Inside)
    {
      const double reach = 0.2 / std::max(1e-9, camera->GetDistance()) *
        std::min({ bounds[1] - bounds[0], bounds[3] - bounds[2], bounds[5] - bounds[4] });
      double position[3];
      camera->GetPosition(position);
      for (int a = 0; a < 3; ++a)
      {
        position[a] = middle[a] + reach * (position[a] - middle[a]);
      }
      camera->SetPosition(position);
      this->Renderer->ResetCameraClippingRange(bounds);
      return;
    }
    this->Renderer->ResetCamera(bounds);
    camera->Zoom(1.3 * view.Zoom);
    if (view.Parallel)
    {
      // From far away: VTK 9.1's GPU mapper lets a headlight shine from the position of the camera
      // even if the projection is parallel.
      double position[3];
      camera->GetPosition(position);
      for (int a = 0; a < 3; ++a)
      {
        position[a] = middle[a] + 20.0 * (position[a] - middle[a]);
      }
      camera->SetPosition(position);
    }
    this->Renderer->ResetCameraClippingRange(bounds);
  }

  Picture Render(vtkAbstractVolumeMapper* mapper)
  {
    this->Volume->SetMapper(mapper);
    return this->Render();
  }

  Picture Render()
  {
    this->Window->Render();
    Picture picture;
    const int* size = this->Window->GetActualSize(); // not of all tiles
    picture.Width = size[0];
    picture.Height = size[1];
    vtkNew<vtkUnsignedCharArray> pixels;
    this->Window->GetPixelData(0, 0, size[0] - 1, size[1] - 1, 0, pixels);
    picture.Rgb.assign(pixels->GetPointer(0), pixels->GetPointer(0) + pixels->GetNumberOfValues());
    return picture;
  }

  /**
   * The rays of vtkFixedPointVolumeRayCastMapper over the background, pixel by pixel. In the
   * window its picture is stretched by up to half a pixel at the edges: the texture spans the
   * centers of the outermost rays, the rectangle it is drawn on their borders. That blur would
   * hide what is compared.
   */
  Picture RenderFixedRays()
  {
    Picture picture = this->Render(this->Fixed);
    vtkFixedPointRayCastImage* rays = this->Fixed->GetRayCastImage();
    int origin[2];
    int size[2];
    int memory[2];
    rays->GetImageOrigin(origin);
    rays->GetImageInUseSize(size);
    rays->GetImageMemorySize(memory);
    double background[3];
    this->Renderer->GetBackground(background);
    const std::array<unsigned char, 3> bytes = this->GetBackground();
    for (std::size_t i = 0; i < picture.Rgb.size(); ++i)
    {
      picture.Rgb[i] = bytes[i % 3];
    }
    constexpr double One = 0x7fff; // the mapper's fixed-point unit
    for (int y = 0; y < size[1]; ++y)
    {
      for (int x = 0; x < size[0]; ++x)
      {
        const unsigned short* rgba = rays->GetImage() + 4 * (y * memory[0] + x);
        unsigned char* out =
          &picture
             .Rgb[3 * static_cast<std::size_t>((y + origin[1]) * picture.Width + x + origin[0])];
        for (int c = 0; c < 3; ++c)
        {
          const double value = rgba[c] / One + background[c] * (1.0 - rgba[3] / One);
          out[c] = static_cast<unsigned char>(255.0 * std::min(1.0, std::max(0.0, value)) + 0.5);
        }
      }
    }
    return picture;
  }

  /// Our picture without a window, over the background.
  Picture RenderToImage(vtkImageData* inputDepths = nullptr, vtkImageData* depths = nullptr)
  {
    const int* size = this->Window->GetSize();
    vtkNew<vtkImageData> colors;
    Picture picture;
    if (!this->Ours->RenderToImage(
          this->Renderer, this->Volume, size[0], size[1], colors, depths, inputDepths))
    {
      return picture;
    }
    picture.Width = size[0];
    picture.Height = size[1];
    const auto* rgba = static_cast<const unsigned char*>(colors->GetScalarPointer());
    double background[3];
    this->Renderer->GetBackground(background);
    const std::size_t pixels =
      static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]);
    picture.Rgb.resize(3 * pixels);
    for (std::size_t i = 0; i < pixels; ++i)
    {
      const double alpha = rgba[4 * i + 3] / 255.0;
      for (std::size_t c = 0; c < 3; ++c)
      {
        picture.Rgb[3 * i + c] = static_cast<unsigned char>(
          rgba[4 * i + c] * alpha + 255.0 * background[c] * (1.0 - alpha) + 0.5);
      }
    }
    return picture;
  }

  std::array<unsigned char, 3> GetBackground() const
  {
    double background[3];
    this->Renderer->GetBackground(background);
    std::array<unsigned char, 3> bytes;
    for (std::size_t c = 0; c < 3; ++c)
    {
      bytes[c] = static_cast<unsigned char>(background[c] * 255.0 + 0.5);
    }
    return bytes;
  }

  Distance Compare(const Picture& a, const Picture& b) const
  {
    return ffdTest::Compare(a, b, this->GetBackground());
  }

  vtkNew<vtkRenderWindow> Window;
  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkLight> Headlight;
  vtkNew<vtkVolume> Volume;
  vtkNew<vtkVolumeProperty> Property;
  vtkNew<vtkFFDInverseRayVolumeMapper> Ours;
  vtkNew<vtkFixedPointVolumeRayCastMapper> Fixed;
  vtkNew<vtkOpenGLGPUVolumeRayCastMapper> Gpu;
};

/**
 * The window against the baseline image of the test: what main() returns. vtkRegressionTestImage
 * forgives differences of up to two fifths of the range, and shifts; a bend that is off by some
 * voxels passes. So the distance of the pictures has to be small, too: other instruction sets
 * differ by some thousandths of 1/255 on average, other cuts of rays into segments by up to a half.
 */
inline int CompareWithBaseline(Scene& scene, int argc, char* argv[])
{
  // Short steps: otherwise where the samples of an opaque surface lie, and so the noise on it,
  // would depend on how rays are cut into segments, which may change.
  scene.SetSampleDistance(0.2);
  scene.Window->Render();
  if (vtkRegressionTestImage(scene.Window) != vtkRegressionTester::PASSED)
  {
    return EXIT_FAILURE;
  }
  const Picture now = scene.Render();
  const std::string file = FindArgument(argc, argv, "-V");
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  Picture baseline;
  const int* dims = image->GetDimensions();
  baseline.Width = dims[0];
  baseline.Height = dims[1];
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    for (int c = 0; c < 3; ++c)
    {
      baseline.Rgb.push_back(
        static_cast<unsigned char>(image->GetPointData()->GetScalars()->GetComponent(i, c)));
    }
  }
  const Distance distance = scene.Compare(now, baseline);
  const bool same = distance.Pixels > 3000 && distance.Mean <= 0.7;
  std::cout << (same ? "ok    " : "WRONG ") << distance
            << " from the baseline (mean at most 0.7)\n";
  if (!same)
  {
    // The picture and five times its difference, where vtkTesting leaves them.
    const std::string name =
      FindArgument(argc, argv, "-T") + "/" + file.substr(file.find_last_of('/') + 1);
    vtkNew<vtkPNGWriter> writer;
    vtkNew<vtkImageData> out;
    out->SetDimensions(now.Width, now.Height, 1);
    out->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    auto* bytes = static_cast<unsigned char*>(out->GetScalarPointer());
    std::copy(now.Rgb.begin(), now.Rgb.end(), bytes);
    writer->SetInputData(out);
    writer->SetFileName(name.c_str());
    writer->Write();
    for (std::size_t i = 0; i < std::min(now.Rgb.size(), baseline.Rgb.size()); ++i)
    {
      bytes[i] =
        static_cast<unsigned char>(std::min(255, 5 * std::abs(now.Rgb[i] - baseline.Rgb[i])));
    }
    out->Modified();
    writer->SetFileName((name.substr(0, name.size() - 4) + ".diff.png").c_str());
    writer->Write();
    std::cout << "See " << name << "\n";
  }
  return same ? EXIT_SUCCESS : EXIT_FAILURE;
}

//------------------------------------------------------------------------------
/**
 * The picture of the unshaded, undeformed volume in double precision, straight from the transfer
 * functions and without any early end of rays: what all the mappers approximate. The image must
 * have no direction matrix, the volume no matrix.
 */
inline Picture RenderExactly(Scene& scene, vtkImageData* image, double sampleDistance)
{
  Picture picture;
  const int* size = scene.Window->GetSize();
  picture.Width = size[0];
  picture.Height = size[1];
  picture.Rgb.resize(3 * static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]));
  vtkNew<vtkMatrix4x4> toWorld;
  toWorld->DeepCopy(scene.Renderer->GetActiveCamera()->GetCompositeProjectionTransformMatrix(
    static_cast<double>(size[0]) / size[1], -1.0, 1.0));
  toWorld->Invert();
  double background[3];
  scene.Renderer->GetBackground(background);
  int dims[3];
  double origin[3];
  double spacing[3];
  image->GetDimensions(dims);
  image->GetOrigin(origin);
  image->GetSpacing(spacing);
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  std::vector<double> values(static_cast<std::size_t>(scalars->GetNumberOfTuples()));
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    values[i] = scalars->GetComponent(static_cast<vtkIdType>(i), 0);
  }
  const double exponent = sampleDistance / scene.Property->GetScalarOpacityUnitDistance();
  for (int pixel = 0; pixel < size[0] * size[1]; ++pixel)
  {
    double ends[2][4];
    for (int e = 0; e < 2; ++e)
    {
      const double ndc[4] = { (pixel % size[0] + 0.5) / size[0] * 2.0 - 1.0,
        (pixel / size[0] + 0.5) / size[1] * 2.0 - 1.0, e == 0 ? -1.0 : 1.0, 1.0 };
      toWorld->MultiplyPoint(ndc, ends[e]);
      for (int a = 0; a < 3; ++a)
      {
        ends[e][a] = (ends[e][a] / ends[e][3] - origin[a]) / spacing[a];
      }
    }
    double length = 0.0;
    double from = 0.0;
    double to = 1.0;
    for (int a = 0; a < 3; ++a)
    {
      const double d = ends[1][a] - ends[0][a];
      length += d * d * spacing[a] * spacing[a];
      const double t0 = -ends[0][a] / d;
      const double t1 = (dims[a] - 1 - ends[0][a]) / d;
      from = std::max(from, std::min(t0, t1));
      to = std::min(to, std::max(t0, t1));
    }
    const double step = sampleDistance / std::sqrt(length);
    double rgb[3] = { 0.0, 0.0, 0.0 };
    double light = 1.0;
    // The first sample lies a step behind the face, less what keeps the last one of a whole number
    // of steps inside.
    for (double t = from + 0.99 * step; t < to && light > 1e-5; t += step)
    {
      double weight[3];
      std::size_t at = 0;
      const std::size_t stride[3] = { 1, static_cast<std::size_t>(dims[0]),
        static_cast<std::size_t>(dims[0]) * static_cast<std::size_t>(dims[1]) };
      for (int a = 0; a < 3; ++a)
      {
        const double q = ends[0][a] + t * (ends[1][a] - ends[0][a]);
        const int cell = std::max(0, std::min(static_cast<int>(q), dims[a] - 2));
        weight[a] = q - cell;
        at += static_cast<std::size_t>(cell) * stride[a];
      }
      double value = 0.0;
      for (std::size_t corner = 0; corner < 8; ++corner)
      {
        double w = 1.0;
        std::size_t offset = at;
        for (std::size_t a = 0; a < 3; ++a)
        {
          const bool upper = (corner >> a & 1) != 0;
          w *= upper ? weight[a] : 1.0 - weight[a];
          offset += upper ? stride[a] : 0;
        }
        value += w * values[offset];
      }
      const double opacity = scene.Property->GetScalarOpacity()->GetValue(value);
      if (opacity > 0.0)
      {
        double color[3];
        scene.Property->GetRGBTransferFunction()->GetColor(value, color);
        const double passed = std::pow(1.0 - opacity, exponent);
        for (int c = 0; c < 3; ++c)
        {
          rgb[c] += light * (1.0 - passed) * color[c];
        }
        light *= passed;
      }
    }
    for (int c = 0; c < 3; ++c)
    {
      picture.Rgb[static_cast<std::size_t>(3 * pixel + c)] =
        static_cast<unsigned char>(255.0 * (rgb[c] + light * background[c]) + 0.5);
    }
  }
  return picture;
}

//------------------------------------------------------------------------------
/**
 * A B-spline transform of n^3 control points whose domain is `bounds` grown on each side by
 * `margin` times their size, with one node of padding. `displacement` is given the rest position
 * of the control point, and that position relative to the bounds (0 to 1).
 */
using DisplacementAt = std::function<Vec3(const Vec3& point, const Vec3& relative)>;

inline vtkSmartPointer<vtkBSplineTransform> MakeTransform(
  const double bounds[6], int n, const DisplacementAt& displacement, double margin = 0.0)
{
  vtkNew<vtkImageData> net;
  double origin[3];
  double spacing[3];
  for (int a = 0; a < 3; ++a)
  {
    const double size = bounds[2 * a + 1] - bounds[2 * a];
    spacing[a] = size * (1.0 + 2.0 * margin) / (n - 3);
    origin[a] = bounds[2 * a] - margin * size - spacing[a];
  }
  net->SetOrigin(origin);
  net->SetSpacing(spacing);
  net->SetDimensions(n, n, n);
  net->AllocateScalars(VTK_DOUBLE, 3);
  for (int k = 0; k < n; ++k)
  {
    for (int j = 0; j < n; ++j)
    {
      for (int i = 0; i < n; ++i)
      {
        const Vec3 point = { origin[0] + i * spacing[0], origin[1] + j * spacing[1],
          origin[2] + k * spacing[2] };
        Vec3 relative;
        for (std::size_t a = 0; a < 3; ++a)
        {
          relative[a] = (point[a] - bounds[2 * a]) / (bounds[2 * a + 1] - bounds[2 * a]);
        }
        const Vec3 d = displacement(point, relative);
        std::copy(d.begin(), d.end(), static_cast<double*>(net->GetScalarPointer(i, j, k)));
      }
    }
  }
  auto transform = vtkSmartPointer<vtkBSplineTransform>::New();
  transform->SetCoefficientData(net);
  return transform;
}

/// Bends along z, waves across: displacements of up to `amplitude`, smooth, free of folds for
/// amplitudes of up to about a fifth of the shortest side.
inline DisplacementAt BendAndWaves(double amplitude)
{
  return [amplitude](const Vec3&, const Vec3& r) {
    const double pi = vtkMath::Pi();
    return Vec3{ amplitude * (0.75 * std::cos(pi * (r[2] - 0.5)) - 0.25 * std::sin(pi * r[1])),
      amplitude * 0.4 * std::sin(2.0 * pi * r[0]),
      amplitude * 0.5 * std::sin(pi * r[0]) * std::sin(pi * r[1]) };
  };
}

/// The same transform with the displacements times `factor`.
inline vtkSmartPointer<vtkBSplineTransform> Scaled(vtkBSplineTransform* transform, double factor)
{
  vtkNew<vtkImageData> net;
  net->DeepCopy(transform->GetCoefficientData());
  vtkDataArray* d = net->GetPointData()->GetScalars();
  for (vtkIdType i = 0; i < d->GetNumberOfTuples(); ++i)
  {
    for (int c = 0; c < 3; ++c)
    {
      d->SetComponent(i, c, factor * d->GetComponent(i, c));
    }
  }
  auto scaled = vtkSmartPointer<vtkBSplineTransform>::New();
  scaled->SetCoefficientData(net);
  return scaled;
}

/// Smallest determinant of the Jacobian of a transform on a grid of points over `bounds`.
inline double FindSmallestDeterminant(vtkAbstractTransform* transform, const double bounds[6])
{
  constexpr int N = 24;
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < N * N * N; ++i)
  {
    const int at[3] = { i % N, i / N % N, i / (N * N) };
    double in[3];
    for (int a = 0; a < 3; ++a)
    {
      in[a] = bounds[2 * a] + (bounds[2 * a + 1] - bounds[2 * a]) * at[a] / (N - 1);
    }
    double out[3];
    double jacobian[3][3];
    transform->Update();
    transform->InternalTransformDerivative(in, out, jacobian);
    smallest = std::min(smallest, vtkMath::Determinant3x3(jacobian));
  }
  return smallest;
}

} // namespace ffdTest

#endif
