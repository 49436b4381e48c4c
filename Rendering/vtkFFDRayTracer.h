// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDRayTracer
 * @brief   the inversely deformed rays of chosen pixels, as polylines
 *
 * Shows what vtkFFDInverseRayVolumeMapper does: the rays of some pixels, bent as it bends them, the
 * segments it cuts them into, and where it samples and leaps (figures 2 to 4 of the paper;
 * Examples/Python/paper_figures.py draws them). The rays are cast by the mapper of the given
 * volume with all its settings, for a picture of ImageSize pixels seen by the renderer's camera,
 * as vtkFFDInverseRayVolumeMapper::RenderToImage() would make it. With GREEDY_ANGLE these are the
 * paper's polylines. With ERROR_BOUND they are the segments of the tile of the pixel, as the mapper
 * found them for all rays of the tile together, up to where it stopped: curves of 8 lines each,
 * those that it found empty included; where no curve is close enough and each sample is pulled
 * back by itself, the curve that it started from. With ReferenceKernels they are lines from sample
 * to sample.
 *
 * Three outputs, in data coordinates of the volume:
 * - 0: the rays in rest space, one polyline for each pixel whose ray meets the deformed bounds, in
 *   the order they were added (the array "Pixel" says which). Point arrays about the segment that
 *   begins at a vertex (the last vertex of a ray has -1 and zeros): "Segment" (its number on the
 *   ray), "SegmentLength" (on the viewing ray, data units), "RestLength" (at rest, data units),
 *   "Samples" (that were interpolated), "Leaps" (look-ups in the distance map that started a leap;
 *   not of ERROR_BOUND without ReferenceKernels), "Passed" (1: empty, nothing was looked at), and
 *   of the vertex "T" (distance from the near plane on the viewing ray, data units). Cell arrays:
 *   "Pixel" (2 components), "Segments", "Samples", "VisibleSamples", "Leaps", "Terminated" (1:
 *   early ray termination), "Color" (RGBA, not premultiplied: that of the pixel).
 * - 1: the viewing rays, with the same points, cells and arrays, in deformed space.
 * - 2: what was looked at, a vertex each, in rest space: "Ray" (number of the cell in output 0),
 *   "Segment", "T", "Interval" (the length it stands for on the viewing ray, data units; the last
 *   one of a GREEDY_ANGLE segment is shorter, figure 4), "Opacity" (corrected by that length),
 *   "Leap" (1: a look-up that started a leap, 0: a sample).
 *
 * This class lives next to the mapper and not with the filters because it is the mapper's ray
 * caster that it shows, not another one.
 *
 * @sa vtkFFDInverseRayVolumeMapper vtkFFDRayStatistics
 */
#ifndef vtkFFDRayTracer_h
#define vtkFFDRayTracer_h

#include "vtkFFDRenderingModule.h" // For export macro
#include "vtkNew.h"                // for vtkNew
#include "vtkPolyDataAlgorithm.h"

#include <memory> // For std::unique_ptr

class vtkIdTypeArray;
class vtkRenderer;
class vtkVolume;

class VTKFFDRENDERING_EXPORT vtkFFDRayTracer : public vtkPolyDataAlgorithm
{
public:
  static vtkFFDRayTracer* New();
  vtkTypeMacro(vtkFFDRayTracer, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Whose camera the rays start from. Required.
   */
  virtual void SetRenderer(vtkRenderer*);
  virtual vtkRenderer* GetRenderer();
  ///@}

  ///@{
  /**
   * The volume, whose mapper must be a vtkFFDInverseRayVolumeMapper. Required.
   */
  virtual void SetVolume(vtkVolume*);
  virtual vtkVolume* GetVolume();
  ///@}

  ///@{
  /**
   * Width and height of the picture, pixels, 1 to 16384. Default: 512, 512.
   */
  void SetImageSize(int width, int height);
  void SetImageSize(const int size[2]);
  vtkGetVector2Macro(ImageSize, int);
  ///@}

  ///@{
  /**
   * The pixels, by column and row from the lower left. AddPixelGrid() adds columns x rows of them,
   * evenly spread over the picture of the present ImageSize; more than that has are an error. A
   * pixel outside of the picture is an error when the filter runs, and is left out.
   */
  void AddPixel(int x, int y);
  void AddPixelGrid(int columns, int rows);
  void RemoveAllPixels();
  vtkIdType GetNumberOfPixels();
  ///@}

  /// Includes the renderer's camera, lights and lighting, the volume, its property, its mapper and
  /// what leads to the mapper's input.
  vtkMTimeType GetMTime() override;

  /// Overridden so that data that do not fit into the memory are an error, not an exception.
  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

protected:
  vtkFFDRayTracer();
  ~vtkFFDRayTracer() override;

  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  void ReportReferences(vtkGarbageCollector* collector) override;

private:
  vtkFFDRayTracer(const vtkFFDRayTracer&) = delete;
  void operator=(const vtkFFDRayTracer&) = delete;

  vtkRenderer* Renderer = nullptr;
  vtkVolume* Volume = nullptr;
  int ImageSize[2] = { 512, 512 };
  vtkNew<vtkIdTypeArray> Pixels;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
