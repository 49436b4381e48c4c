// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// What the benchmarks render: volumes, opacity settings, deformations, and the window that all
// competitors share.
#ifndef FFDBenchmarkScene_h
#define FFDBenchmarkScene_h

#include "vtkNew.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"

#include <string>
#include <vector>

class vtkFFDInverseRayVolumeMapper;
class vtkFFDLattice;
class vtkImageData;
class vtkRenderer;
class vtkRenderWindow;
class vtkVolume;
class vtkVolumeMapper;
class vtkVolumeProperty;

namespace ffdBenchmark
{

/// The three opacity settings of the paper's section 5, as ramps over 8-bit scalars.
enum class Opacity
{
  Semi,   ///< semi-transparent: 0.03 * (v - 70) / 150 above 70
  Opaque, ///< nothing below 70, 0.9 from 90 on
  Sparse  ///< opaque with lots of empty space: nothing below 150, 0.9 from 170 on
};
const char* GetName(Opacity opacity);

/// Shaded, one of the opacity settings, linear interpolation.
vtkSmartPointer<vtkVolumeProperty> MakeProperty(Opacity opacity);

enum class Shape
{
  Identity,
  Smooth, ///< x bends by a half cosine over z, y by half as much over x
  Random  ///< every component uniform in +-magnitude
};

/// A deformation of at most `magnitude` world units at the control points.
struct Deformation
{
  Shape Form = Shape::Identity;
  double Magnitude = 0.0;
};
std::string GetName(const Deformation& deformation);

/// side^3 control points over the bounds of the image.
void Deform(
  vtkFFDLattice* lattice, vtkImageData* image, const Deformation& deformation, int side = 8);

/// "engine" (its slices 0 to 112) or "cthead". Stops the program with a message without the file.
vtkSmartPointer<vtkImageData> ReadVolume(const std::string& folder, const std::string& name);

/// The image interpolated to side^3 voxels of edge 1.
vtkSmartPointer<vtkImageData> ResampleToCube(vtkImageData* image, int side);

/// How much two images differ, over the blocks of pixels that either of them covers.
struct Difference
{
  double Mean = 0.0;     ///< of the absolute differences of the channels, of 255
  double Outliers = 0.0; ///< part of the blocks where a channel differs by more than 32 of 255
  double Covered = 0.0;  ///< part of the image that is covered
};

/// A window of size x size pixels with one camera; of its volumes one at a time is drawn.
class Stage
{
public:
  Stage(int size, vtkImageData* image);
  ~Stage();

  /// The property is shared, so that all volumes follow its edits.
  vtkVolume* AddVolume(vtkVolumeMapper* mapper, vtkVolumeProperty* property);

  /// Draw one volume into the window, and wait until the picture is finished.
  void Draw(vtkVolume* volume);

  /// What is drawn in the window.
  vtkSmartPointer<vtkUnsignedCharArray> Capture();
  vtkSmartPointer<vtkUnsignedCharArray> DrawAndCapture(vtkVolume* volume);

  vtkRenderer* GetRenderer();
  int GetSize() const { return this->Size; }

private:
  int Size;
  vtkNew<vtkRenderWindow> Window;
  vtkNew<vtkRenderer> Renderer;
  std::vector<vtkSmartPointer<vtkVolume>> Volumes;
};

/**
 * Compare pictures of size x size pixels by the means of their block x block pixels. Blocks of one
 * pixel are for one and the same method; ray casters that put their samples elsewhere show other
 * bands, a pixel or two wide, on steep opacity ramps, and look the same from a little farther away.
 */
Difference Compare(vtkUnsignedCharArray* a, vtkUnsignedCharArray* b, int size, int block);

/// How ours renders.
enum class Variant
{
  Exact,      ///< the default settings
  FirstOrder, ///< the default settings with the paper's inverse
  PullBack,   ///< the default settings, the lattice read as vtkImageReslice reads it
  Paper,      ///< FIRST_ORDER, GREEDY_ANGLE, SEGMENT, MATERIAL
  Unoptimized ///< every sample is taken: no leaping, no early termination
};

/// Ours, with sample distances that do not adapt to the time.
vtkSmartPointer<vtkFFDInverseRayVolumeMapper> MakeMapper(
  vtkImageData* image, vtkFFDLattice* lattice, Variant variant);

/// The reference kernels with the picture of a variant: its inverse mode and opacity length.
vtkSmartPointer<vtkFFDInverseRayVolumeMapper> MakeOracle(
  vtkImageData* image, vtkFFDLattice* lattice, Variant variant);

/// vtkFixedPointVolumeRayCastMapper with the same distances between samples and pixels.
vtkSmartPointer<vtkVolumeMapper> MakeFixedPointMapper();

} // namespace ffdBenchmark

#endif
