// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDVolumeRepresentation
 * @brief   the ParaView representation "FFD Volume"
 *
 * Renders image data deformed by the lattice that is attached to it, with
 * vtkFFDInverseRayVolumeMapper; without a lattice, undeformed. Color and opacity functions,
 * shading and the like are those of ParaView's own volume representation. The bounds that the view
 * sees are those of the deformed volume.
 *
 * Arrays of several components are rendered by the component or magnitude that the color map is
 * set to, cell arrays after averaging to the points; both copy the array. As with ParaView's own
 * volume, opacity can be that of another array, two components can be looked up for color and for
 * opacity, four can be colors and an opacity as they are, and color and opacity can be looked up in
 * the plane of two arrays or of an array and its gradient. Rectilinear grids and blocks of images
 * are rendered, too: see vtkFFDVolumeInput.
 *
 * The volume stays where it is: a client gets the outline only.
 *
 * With several processes, deformed space is cut into boxes, one a process. Each renders the parts
 * of the rays inside its box, which ParaView blends in the order of the boxes, so that the picture
 * is that of one process however the volume is bent. Boxes are cut so that their processes need few
 * voxels, which the control points bound. The input is asked for pieces, as all of ParaView does:
 * an extent would be computed or read a second time, for the selection that ParaView always
 * extracts asks for pieces. The voxels that a box is pulled back to are exchanged, when the data
 * change or a box needs others than it has; an edit of the lattice most often needs none.
 *
 * A volume that is rotated in the scene is rendered by the first process alone: its boxes would not
 * be aligned with the axes, which ParaView's order by boxes needs.
 *
 * Several volumes of a view share the boxes, and are drawn from the farthest to the nearest: the
 * picture is right where their bounds do not overlap. If one of them is rotated, or is no
 * composite, the first process renders all. Blocks with a lattice each are such volumes, too: each
 * has a mapper of its own, with the options of this representation.
 *
 * While the volume is shown the view renders without depth peeling for volumes, which only
 * vtkOpenGLGPUVolumeRayCastMapper takes part in: translucent surfaces come before all volumes.
 *
 * @sa vtkFFDInverseRayVolumeMapper vtkFFDEditLattice
 */
#ifndef vtkFFDVolumeRepresentation_h
#define vtkFFDVolumeRepresentation_h

#include "vtkFFDParaViewModule.h" // For export macro
#include "vtkImageVolumeRepresentation.h"

#include <array>   // for std::array
#include <cstddef> // for std::size_t
#include <memory>  // for std::unique_ptr
#include <vector>  // for std::vector

class vtkAlgorithm;
class vtkFFDInverseRayVolumeMapper;
class vtkFFDLattice;
class vtkImageData;
class vtkPVRenderView;
struct vtkFFDShownComponents;

class VTKFFDPARAVIEW_EXPORT vtkFFDVolumeRepresentation : public vtkImageVolumeRepresentation
{
public:
  static vtkFFDVolumeRepresentation* New();
  vtkTypeMacro(vtkFFDVolumeRepresentation, vtkImageVolumeRepresentation);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  int ProcessViewRequest(
    vtkInformationRequestKey* request, vtkInformation* inInfo, vtkInformation* outInfo) override;

  ///@{
  /**
   * Overridden as volumes of a view that several processes render share their boxes: what changes
   * one changes the parts of all.
   */
  void MarkModified() override;
  void SetVisibility(bool visible) override;
  ///@}

  ///@{
  /**
   * Forwarded to vtkFFDInverseRayVolumeMapper, see there.
   */
  void SetInverseMode(int mode);
  void SetOpacityLength(int length);
  void SetUseJittering(vtkTypeBool jittering);
  void SetSpaceLeaping(int leaping);
  void SetSegmentation(int segmentation);
  void SetInverseTolerance(double voxels);
  void SetPositionTolerance(double voxels);
  void SetAngleThreshold(double degrees);
  void SetMinimumSegmentLength(double voxels);
  void SetMaximumSegmentLength(double voxels);
  void SetEarlyRayTerminationThreshold(double transmittance);
  ///@}

  /**
   * Let a representation of ParaView that was made before the plugin was loaded follow
   * lattices as later ones do (FFDAttachments.xml).
   */
  void FollowOlder(vtkObject* older);

  /**
   * Threads of each process, 0 to 1024. Default 0: all, of which the processes of one host take
   * equal parts.
   */
  void SetNumberOfThreads(int threads);

  ///@{
  /**
   * Distance between samples in still images, in voxels of the data: whatever the volume is scaled
   * by. Range 0.05 to 10, default 1.
   */
  void SetSampleDistance(double voxels);
  ///@}

  ///@{
  /**
   * The length over which the opacities of one-dimensional transfer functions hold, data units.
   * Those of two-dimensional ones hold over the distance of the samples of ParaView's own Volume,
   * which has no other length for them.
   */
  void SetScalarOpacityUnitDistance(double length);
  ///@}

  ///@{
  /**
   * Pixels between rays in still images, 0.25 to 8; default 1.
   */
  void SetImageSampleDistance(double pixels);
  ///@}

  ///@{
  /**
   * Whether quality gives way while the scene moves, so that it moves smoothly; default on. Off,
   * interactive images are as still ones. On, it follows the view's settings of the level of
   * detail: for data above the LOD threshold samples are 1 / r times as far apart as in still
   * images, r being the LOD resolution (0 to 1, ParaView's default 0.5), and for all data rays are
   * at most 1 / r^2 times as far apart, as few as keep up the frame rate. Both factors are limited
   * to 10.
   */
  void SetAdaptInteractiveQuality(bool adapt);
  ///@}

  ///@{
  /**
   * Blend mode, vtkVolumeMapper::BlendModes, and cropping as in vtkImageVolumeRepresentation: the
   * box is CroppingOrigin + CroppingScale times the bounds of the whole image, at rest or deformed
   * as CroppingSpace says (vtkFFDInverseRayVolumeMapper::CroppingSpaces, default REST). Where the
   * order of the parts does not matter for blending but the parts would be blended as if it did
   * (all modes but COMPOSITE_BLEND), the first of several processes renders the volume alone.
   */
  void SetBlendMode(int mode);
  void SetCropping(int cropping);
  void SetCroppingSpace(int space);
  ///@}

  ///@{
  /**
   * Place of the volume in the scene, as for other representations.
   */
  void SetPosition(double x, double y, double z);
  void SetScale(double x, double y, double z);
  void SetOrientation(double x, double y, double z);
  void SetOrigin(double x, double y, double z);
  ///@}

  /**
   * Make the next picture, if it is to be a still one, with the quality of moving ones of `rate`
   * pictures a second, more than 0. For a server: a client sees to its own window, see
   * pqFFDLongFrames.
   */
  void RenderNextAtRate(double rate);

  /**
   * Whether coarse pictures differ from still ones, SetAdaptInteractiveQuality().
   */
  bool GetAdaptInteractiveQuality();

  ///@{
  /**
   * Find what is seen first along a line of the scene, from (x0, y0, z0) to (x1, y1, z1) in world
   * coordinates: where the opacity exceeds 0.05, or 0.005 if it is nowhere as large; in blend modes
   * other than composite the place that the picture shows. The result is 8 numbers: 1, or 0 for
   * nothing (and zeros); the place in the scene; its place in the data at rest; the scalar there.
   * To be called on all rendering processes, all of which have the result; a client is given it by
   * SetPicked(). The normal is that of the surface there, or points against the line.
   */
  void Pick(double x0, double y0, double z0, double x1, double y1, double z1);
  double* GetPicked() VTK_SIZEHINT(8);
  void SetPicked(const double picked[8]);
  const double* GetPickedNormal() VTK_SIZEHINT(3);
  ///@}

  /**
   * The visible representation of what `input` makes, in the view that was rendered last of those
   * that have a line from their cameras; null if there is none. ParaView renders a view whenever it
   * looks what is picked there.
   */
  static vtkFFDVolumeRepresentation* FindShownBy(
    vtkAlgorithm* input, const double from[3], const double to[3]);

protected:
  vtkFFDVolumeRepresentation();
  ~vtkFFDVolumeRepresentation() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  void UpdateMapperParameters() override;
  bool AddToView(vtkView* view) override;
  bool RemoveFromView(vtkView* view) override;

private:
  vtkFFDVolumeRepresentation(const vtkFFDVolumeRepresentation&) = delete;
  void operator=(const vtkFFDVolumeRepresentation&) = delete;

  void HandOver(vtkInformation* view, const std::array<double, 6>& place);
  std::vector<vtkFFDVolumeRepresentation*> FindShownVolumes();
  void MarkOthersModified();
  static void ShareOut(const std::vector<vtkFFDVolumeRepresentation*>& volumes);
  void SetNumberOfVolumes(std::size_t count);
  void SetNumberOfShown(std::size_t count);
  void HoldImages(const std::vector<vtkImageData*>& images);
  void UpdateOutline();
  void DescribeInputs();
  void TakeParts();
  void MarkMoved();
  vtkFFDShownComponents FindShown(vtkImageData* image);
  bool UsesPlane();
  void UpdateTable();
  void UpdateUnitDistance(vtkImageData* image, const double whole[6]);
  void UpdateOtherVolumes();
  void UpdateRenderedImage(std::size_t which, vtkImageData* image);
  void UpdateSampleDistances(
    vtkFFDInverseRayVolumeMapper* mapper, vtkImageData* image, vtkPVRenderView* view, bool useLOD);
  void UpdateCropping(vtkFFDInverseRayVolumeMapper* mapper, vtkImageData* image);
  void ReportProblem(std::size_t which, bool hasArray);

  vtkFFDInverseRayVolumeMapper* Mapper; // the superclass's VolumeMapper, that of the first volume
  double UnitDistance = 1.0;
  double SampleDistance = 1.0;
  double ImageSampleDistance = 1.0;
  double NextRate = 0.0; // RenderNextAtRate(); 0: as asked
  int Threads = 0;       // SetNumberOfThreads(); 0: all that are there
  int SharedThreads = 0; // these, with several processes; 0: not known

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
