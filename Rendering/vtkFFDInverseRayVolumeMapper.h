// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Longer than other files, because it is the documentation of one class: VTK wants a public class
// in one header, and each of its options states units, range, default and errors here, where users
// and the generated reference read them. The code is in vtkFFDInverseRayVolumeMapper*.cxx and
// vtkFFDFrame*.
/**
 * @class   vtkFFDInverseRayVolumeMapper
 * @brief   volume renderer that bends the viewing rays instead of the voxels
 *
 * Renders a vtkImageData as it looks after a free-form deformation, without ever making a deformed
 * copy: each viewing ray is taken through the inverse of the deformation and followed through the
 * volume at rest, after "Fast Volume Deformation Using Inverse-Ray-Deformation and FFD" (equation
 * numbers and sections below are those of that paper). Editing the deformation costs nothing per
 * voxel. Runs on the CPU with all cores; the image does not depend on their number.
 *
 * Put it in the place of a vtkFixedPointVolumeRayCastMapper and give it a deformation:
 *
 * @code
 * vtkNew<vtkFFDInverseRayVolumeMapper> mapper;
 * mapper->SetInputConnection(reader->GetOutputPort());
 * mapper->SetDeformation(lattice);
 * volume->SetMapper(mapper);
 * @endcode
 *
 * The deformation T works in the data coordinates of the image: those of its origin, spacing and
 * direction, before the matrix of the vtkVolume.
 *
 * Input: a vtkImageData or a vtkRectilinearGrid with at least two points along each axis, and
 * scalars of any of VTK's numeric types with 1 to 4 components, of points or of cells (two cells an
 * axis or more), chosen with SetScalarMode() and SelectScalarArray(). Scalars of cells reach up to
 * the outermost faces. Scalars that are not a number are transparent, and so are blanked points and
 * cells (any flag of vtkGhostType, as in vtkGPUVolumeRayCastMapper: duplicates of other processes,
 * too, which these render). The voxel of a rectilinear grid, as a unit of length, is one of a grid
 * of equal steps with as many points. The diagonal of the volume is from 1e-16 to 1e16 in units of
 * the data. Everything else is refused with an error that says what is wrong; the rest of the scene
 * still renders.
 *
 * The vtkVolumeProperty, as with VTK's own mappers:
 * - Independent components have functions, weights and surfaces of their own; all of them are
 *   shaded or none, by the flag of component 0. Opacities a
 *   over a sample distance make the opacity sum(a^2) / sum(a), colors c the premultiplied color
 *   sum(a c), of a still picture's sample distance. The weight of a single component is not used.
 * - Dependent components: of two, the first is looked up for color, the second for opacity. Of
 *   four, three are red, green and blue, the fourth is looked up for opacity. Of three, red, green
 *   and blue, the luminance (0.299, 0.587, 0.114) is looked up for opacity, which VTK's mappers do
 *   not have. Colors are unsigned char, unsigned short, or float and double from 0 to 1. Normals
 *   and gradients are those of what is looked up for opacity. The opacity unit distance is that of
 *   component 0, as in vtkFixedPointVolumeRayCastMapper; vtkGPUVolumeRayCastMapper takes that of
 *   the last component, although it takes the function of component 0. Blend modes other than
 *   composite look as in VTK's mappers where these draw them: maximum and minimum intensity show
 *   the sample with the extreme of what is looked up for opacity; average, additive and isosurface
 *   are those of the first component (of RGB: of the luminance), opacities being looked up as ever,
 *   of isosurfaces at the same part of the range. Isosurfaces of colors are gray.
 * - Gradient opacity multiplies the opacity over the sample distance. It is that of the volume at
 *   rest, in scalar units per mean edge of a voxel, so tissue looks the same wherever the
 *   deformation takes it; magnitudes above a quarter of the range of the scalars count as that.
 * - Two-dimensional transfer functions span the range of the scalars and, on the second axis, that
 *   quarter or the range of Transfer2DYAxisArray; their opacity is that over the unit distance.
 *   vtkGPUVolumeRayCastMapper does not correct it for the sample distance.
 * - Color functions in all color spaces, with logarithmic scale and colors beyond the range.
 *   Functions are looked up in at most 16384 equal steps, as in VTK's mappers: the small end of
 *   logarithmic ones over five decades and more is coarse.
 * - Interpolation is nearest or linear: vtkVolumeProperty offers no other (it clamps to these).
 *
 * Blend modes (vtkVolumeMapper::SetBlendMode) look as with vtkGPUVolumeRayCastMapper:
 * - composite;
 * - maximum and minimum intensity: the transfer functions at the extreme value of each ray;
 * - average: the mean of opacity times value, values from 0 to 1 over the scalar range, of those in
 *   AverageIPScalarRange; gray and opaque wherever there are any;
 * - additive: the same summed up, the opacity being that over the scalar opacity unit distance;
 *   gray and opaque wherever a ray meets the volume;
 * - isosurface: surfaces where the scalars cross the values of
 *   vtkVolumeProperty::GetIsoSurfaceValues() (without any nothing is drawn), colored and made
 *   semi-transparent by the transfer functions, and shaded if the property says so. The crossing is
 *   found in its sample interval to a millionth of that, so neither pictures nor depths have steps;
 *   two crossings of one value within an interval are none;
 * - slice: the transfer functions on the plane of vtkVolumeProperty::SetSliceFunction(), world
 *   coordinates: a plane cut through the deformed volume.
 *
 * Average and additive weight samples by the lengths of their intervals (OpacityLength).
 *
 * Clipping planes (vtkAbstractMapper::AddClippingPlane) are planes of the world: they cut what has
 * been deformed. With vtkVolumeProperty::UseClippedVoxelIntensity gradients count what is cut off
 * as having the intensity ClippedVoxelIntensity, in scalar units; in vtkGPUVolumeRayCastMapper it
 * is in those of the texture, which are the same for float scalars only. Cropping is that of the
 * volume at rest or of deformed space, see CroppingSpace.
 *
 * Volumes and opaque geometry: geometry that was drawn before hides what is behind it. Several
 * volumes are blended in the order in which the renderer draws them, as with VTK's own mappers;
 * where they overlap the later one is drawn over the earlier one. Translucent surfaces are drawn
 * before them; vtkRenderer::UseDepthPeelingForVolumes, or a vtkDualDepthPeelingPass with a
 * volumetric pass, is refused with an error.
 *
 * Normals and gradient opacities are those of central differences over one voxel to each side; at
 * the faces of the volume, and beside blanked cells, over what there is. With nearest interpolation
 * they are those of the nearest voxel.
 *
 * Interpolated scalars are classified as they are, whatever their type: the same values as bytes
 * and as floats give the same picture, that of vtkGPUVolumeRayCastMapper on floats.
 * vtkFixedPointVolumeRayCastMapper rounds interpolated whole numbers up, so that its pictures of
 * them are a little denser (1 to 4 of 255).
 *
 * Picking by rendering (vtkHardwareSelector, vtkPropPicker, vtkRenderedAreaPicker) finds the volume
 * where it is visible: where its opacity is more than 3 / 255, as VTK's GPU mapper. Cells and
 * points are those of the input whose material is shown: of the first visible sample.
 *
 * A headlight shines from the position of the camera, in parallel projection, too, as that of
 * vtkGPUVolumeRayCastMapper does, but with the camera's user view and model transforms, as on
 * surfaces. A single one of intensity 1 lights the ambient term whatever its
 * ambient color, again as there; otherwise the ambient term is that of the ambient colors of the
 * lights times their intensities, black by default. Where no light is on there is a headlight, as
 * the renderer makes one in a window, unless its AutomaticLightCreation is off.
 *
 * Lengths are those of the data coordinates, before the matrix of the vtkVolume: as VTK's mappers
 * do it, a volume that its matrix makes larger looks no denser. Lights shine in the world: where a
 * matrix does not scale all axes alike, or shears, normals are those of the shape that it makes.
 * "Voxel" as a unit of length is the shortest voxel edge.
 *
 * Progress and abort: StartEvent and VolumeMapperRenderStartEvent begin a frame, ProgressEvent
 * (GetProgress()) and VolumeMapperRenderProgressEvent (with a double) tell how much of it is done,
 * from 0 to 1, every 10 to 50 ms, its preparation included (limits of the voxels, distances,
 * bounds), and VolumeMapperRenderEndEvent and EndEvent end it, all in the thread that renders.
 * SetAbortExecute(1) in an observer ends the frame, and so does vtkRenderWindow::SetAbortRender(),
 * as of an observer of the window's AbortCheckEvent; while the scene moves, once the frame has
 * taken twice what is allotted to it. A window then goes on to show its last picture; the next
 * frame is made as a whole. See vtkFFDInteractiveFrames for applications.
 *
 * Observers of these events, and of others while the mapper renders, may do anything to the mapper,
 * its inputs and the scene, but take the renderer from its window, give this another one or
 * finalize it, since VTK goes on to use them. The frame shows what it began with: new inputs,
 * deformations and options count from the next frame on, what is removed or deleted stays until the
 * frame is over, and so do the resources that ReleaseGraphicsResources() releases. GetBounds(),
 * GetRestPosition() and pickers tell of the frame. Render(), RenderToImage() and TraceRays() of the
 * same mapper are refused with an error, and a frame ends without a picture, and with an error, if
 * the memory of an array that it reads is freed by changing the size of the array.
 *
 * @sa
 * vtkFFDLattice vtkFFDVolumePicker vtkFixedPointVolumeRayCastMapper vtkImageReslice
 * vtkBSplineTransform
 */
#ifndef vtkFFDInverseRayVolumeMapper_h
#define vtkFFDInverseRayVolumeMapper_h

#include "vtkFFDRenderingModule.h" // For export macro
#include "vtkFFDVersions.h"        // For VTK_FFD_OWN_COMPUTE_NORMAL_FROM_OPACITY
#include "vtkVolumeMapper.h"

#include <memory> // For std::unique_ptr

class vtkAbstractTransform;
class vtkContourValues;
class vtkFFDRayStatistics;
class vtkIdTypeArray;
class vtkImageData;
class vtkPolyData;
class vtkRenderWindow;
class vtkTextureObject;
class vtkVolumeProperty;
struct vtkFFDProbeView;

class VTKFFDRENDERING_EXPORT vtkFFDInverseRayVolumeMapper : public vtkVolumeMapper
{
public:
  static vtkFFDInverseRayVolumeMapper* New();
  vtkTypeMacro(vtkFFDInverseRayVolumeMapper, vtkVolumeMapper);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The deformation T, in data coordinates. A vtkFFDLattice or any vtkBSplineTransform is used as
   * it is; any other transform is approximated by a lattice within PositionTolerance over the
   * region that matters (a warning tells when that could not be reached). Default: none, which
   * means the lattice attached to the input if there is one (vtkFFDLattice::AttachTo), else no
   * deformation. One that makes the diagonal of the bounds more than 100000 times as long is
   * refused with an error; of one that presses the volume flat EXACT shows nothing, with a warning.
   */
  virtual void SetDeformation(vtkAbstractTransform*);
  virtual vtkAbstractTransform* GetDeformation();
  ///@}

  /**
   * Set/Get the method for the pull-back Phi, which maps a deformed point P to the rest point where
   * the volume is sampled, from the deformation T.
   */
  enum InverseModes
  {
    FIRST_ORDER, ///< Phi(P) = 2P - T(P): the inverse ray deformation of equation (3)
    EXACT,       ///< Phi = T^-1, by Newton's method
    PULL_BACK    ///< Phi = T: for transforms that map output to input, as registrations do
  };

  ///@{
  /**
   * Which pull-back is used. Default: EXACT. Where T folds, a deformed point has several rest
   * points: those count where T keeps the orientation of the volume, what it turns inside out is
   * not shown. Points without such a rest point show nothing and are counted, see
   * vtkFFDRayStatistics::GetNumberOfUnconvergedPoints. (The paper's segmentation, GREEDY_ANGLE,
   * uses the first-order point there.)
   */
  vtkSetClampMacro(InverseMode, int, FIRST_ORDER, PULL_BACK);
  vtkGetMacro(InverseMode, int);
  void SetInverseModeToFirstOrder() { this->SetInverseMode(FIRST_ORDER); }
  void SetInverseModeToExact() { this->SetInverseMode(EXACT); }
  void SetInverseModeToPullBack() { this->SetInverseMode(PULL_BACK); }
  const char* GetInverseModeAsString() const;
  ///@}

  ///@{
  /**
   * Largest distance between T(Phi(P)) and P in EXACT mode, in voxels. Default: 0.01. Must be
   * positive; more than 1 counts as that. With ERROR_BOUND positions are as close as the
   * PositionTolerance says; InverseTolerance counts only where samples are pulled back by
   * themselves, and there at most as a tenth of that.
   */
  virtual void SetInverseTolerance(double voxels);
  vtkGetMacro(InverseTolerance, double);
  ///@}

  /**
   * Set/Get the segmentation of deformed rays.
   */
  enum Segmentations
  {
    ERROR_BOUND, ///< curves whose distance from the true ones is measured to be small
    GREEDY_ANGLE ///< the paper's polyline, section 4.5
  };

  ///@{
  /**
   * Default: ERROR_BOUND.
   */
  vtkSetClampMacro(Segmentation, int, ERROR_BOUND, GREEDY_ANGLE);
  vtkGetMacro(Segmentation, int);
  void SetSegmentationToErrorBound() { this->SetSegmentation(ERROR_BOUND); }
  void SetSegmentationToGreedyAngle() { this->SetSegmentation(GREEDY_ANGLE); }
  const char* GetSegmentationAsString() const;
  ///@}

  ///@{
  /**
   * Largest distance of a sample from its true position, in voxels, for ERROR_BOUND. Default: 0.1.
   * Must be positive. While the scene moves and rays are some pixels apart
   * (AutoAdjustSampleDistances) it is as many times as large. Neighboring rays share interpolants
   * of the pull-back, whose error is measured on themselves, at points between their nodes, with a
   * safety factor; where no interpolant is close enough, every sample is pulled back by itself.
   * Normals follow from the derivatives of the interpolants: measured where neighboring control
   * points of a fine lattice are moved apart by up to its spacing, lit pictures differ from those
   * with true normals by a mean of 0.4 of 255, 99 % of the pixels by at most 4; by 0.15 and 1 with
   * a tolerance of 0.02.
   */
  virtual void SetPositionTolerance(double voxels);
  vtkGetMacro(PositionTolerance, double);
  ///@}

  ///@{
  /**
   * Largest angle between neighboring segments, in degrees, for GREEDY_ANGLE; segments of the
   * minimum length may turn by more. Default: 5, as the paper. Must be positive and below 180.
   */
  virtual void SetAngleThreshold(double degrees);
  vtkGetMacro(AngleThreshold, double);
  ///@}

  ///@{
  /**
   * Limits of the length of a segment on the viewing ray, in voxels. Defaults: 0.5 and 64; the
   * paper has 0.5 and 8. The minimum must be positive; less than 0.001 and more than 64 count as
   * these. A maximum of more than 10000 counts as that, one below the minimum as the minimum. A
   * maximum of 0 means: for GREEDY_ANGLE what follows from the deformation (section 4.5), the arc
   * that turns by the angle threshold on the circle of the largest curvature that any deformed ray
   * can have, at most 64 voxels; for ERROR_BOUND 64 voxels, which is also the most that it takes.
   * Its segments have a power of two of samples, at least one.
   */
  virtual void SetMinimumSegmentLength(double voxels);
  vtkGetMacro(MinimumSegmentLength, double);
  virtual void SetMaximumSegmentLength(double voxels);
  vtkGetMacro(MaximumSegmentLength, double);
  ///@}

  /**
   * Set/Get the empty-space leaping of rays.
   */
  enum SpaceLeapings
  {
    OFF,      ///< every sample is taken
    SEGMENT,  ///< leaps end with the segment, as section 4.6
    LIPSCHITZ ///< leaps pass any number of segments that stay in empty space
  };

  ///@{
  /**
   * Default: LIPSCHITZ. The image is the same with all three.
   */
  vtkSetClampMacro(SpaceLeaping, int, OFF, LIPSCHITZ);
  vtkGetMacro(SpaceLeaping, int);
  void SetSpaceLeapingToOff() { this->SetSpaceLeaping(OFF); }
  void SetSpaceLeapingToSegment() { this->SetSpaceLeaping(SEGMENT); }
  void SetSpaceLeapingToLipschitz() { this->SetSpaceLeaping(LIPSCHITZ); }
  const char* GetSpaceLeapingAsString() const;
  ///@}

  ///@{
  /**
   * A ray ends when less than this part of the light from behind would pass what it has met
   * (section 4.6, early ray termination). Range 0 (never) to 1, other numbers are refused with an
   * error. Default: 1/255, less than what an 8-bit image can show.
   */
  virtual void SetEarlyRayTerminationThreshold(double transmittance);
  vtkGetMacro(EarlyRayTerminationThreshold, double);
  ///@}

  /**
   * Which length the opacity of a sample interval is corrected by.
   */
  enum OpacityLengths
  {
    WORLD,   ///< its length on the viewing ray: the image equals that of the resampled volume
    MATERIAL ///< its length in the volume at rest, as the paper: stretching makes nothing more
             ///< opaque
  };

  ///@{
  /**
   * Default: WORLD.
   */
  vtkSetClampMacro(OpacityLength, int, WORLD, MATERIAL);
  vtkGetMacro(OpacityLength, int);
  void SetOpacityLengthToWorld() { this->SetOpacityLength(WORLD); }
  void SetOpacityLengthToMaterial() { this->SetOpacityLength(MATERIAL); }
  const char* GetOpacityLengthAsString() const;
  ///@}

  /**
   * Set/Get the classification: by samples, or by the intervals between them.
   */
  enum Classifications
  {
    POST_INTERPOLATED, ///< the samples: as in VTK's mappers
    PRE_INTEGRATED,    ///< the intervals between samples, from the values at their ends
    AUTO               ///< PRE_INTEGRATED where the opacity is steep for the sample distance
  };

  ///@{
  /**
   * Default: POST_INTERPOLATED. Where opacity rises by much within what scalars change from one
   * sample to the next, samples show rings (wood grain). PRE_INTEGRATED shows what is between them
   * (Engel, Kraus, Ertl 2001): the extinction of an interval is its integral over the values from
   * the sample before, over one where the steep part is crossed, to the sample; that one is shaded.
   * Errors of steep functions are then 0.05 to 0.4 of what they were, in 1.2 to 2.4 times the time
   * (where most intervals may show something, as thin shells in noise, up to 5.4). AUTO does so
   * where over a sixteenth of the range of the transfer functions the opacity of a sample interval
   * changes by more than a quarter.
   *
   * It is for one component, interpolated linearly, in blend mode composite with ERROR_BOUND.
   * Samples are classified (whatever this says) of several components, with gradient opacity,
   * two-dimensional transfer functions, masks, label maps, blanked cells, nearest interpolation, of
   * which values are constant between samples, and with a ClipBox: GetUsedClassification() tells.
   */
  vtkSetClampMacro(Classification, int, POST_INTERPOLATED, AUTO);
  vtkGetMacro(Classification, int);
  void SetClassificationToPostInterpolated() { this->SetClassification(POST_INTERPOLATED); }
  void SetClassificationToPreIntegrated() { this->SetClassification(PRE_INTEGRATED); }
  void SetClassificationToAuto() { this->SetClassification(AUTO); }
  const char* GetClassificationAsString() const;
  ///@}

  /**
   * POST_INTERPOLATED or PRE_INTEGRATED: what the last picture was made with. POST_INTERPOLATED
   * before the first one.
   */
  int GetUsedClassification();

  ///@{
  /**
   * Distance between samples along the viewing ray, data units. Default: locked to the input, one
   * voxel; setting this distance unlocks it. Must be positive; less than a thousandth of a voxel
   * counts as that. Samples lie at whole multiples of it behind the face through which the ray
   * enters the volume, or behind the near clipping plane if that is inside, as with
   * vtkGPUVolumeRayCastMapper. Those of a deformed ray lie as far along it as where nothing is
   * deformed, so that an edit of the deformation moves none. With GREEDY_ANGLE distances are those
   * at rest from the start of each segment, whose last interval is shorter (figure 4 of the paper).
   */
  virtual void SetSampleDistance(double distance);
  vtkGetMacro(SampleDistance, double);
  ///@}

  ///@{
  /**
   * Distance between samples while the scene is being moved: when AutoAdjustSampleDistances is on
   * and less than 1 / InteractiveUpdateRate seconds are allotted to the frame. Data units. Default:
   * locked to the input, two voxels, or SampleDistance where that is more; setting this distance,
   * nothing else, unlocks it. Must be positive; less than a thousandth of a voxel counts as that.
   */
  virtual void SetInteractiveSampleDistance(double distance);
  vtkGetMacro(InteractiveSampleDistance, double);
  ///@}

  ///@{
  /**
   * Whether the distance between samples is one voxel, instead of SampleDistance. On also locks
   * InteractiveSampleDistance, to two voxels, until that is set again. Default: on.
   * (vtkFixedPointVolumeRayCastMapper has a distance of 1.0 by default, which is wrong for volumes
   * whose voxels are much smaller or larger.)
   */
  virtual void SetLockSampleDistanceToInputSpacing(vtkTypeBool lock);
  vtkGetMacro(LockSampleDistanceToInputSpacing, vtkTypeBool);
  vtkBooleanMacro(LockSampleDistanceToInputSpacing, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Pixels between rays in each direction when sample distances are not adjusted automatically.
   * Range 0.1 to 100, positive numbers beyond it are clamped; below 1 there are several rays a
   * pixel. Default: 1.
   */
  virtual void SetImageSampleDistance(double pixels);
  vtkGetMacro(ImageSampleDistance, double);
  ///@}

  ///@{
  /**
   * Limits of the automatic image sample distance. Defaults: 1 and 10. Range 0.1 to 100, positive
   * numbers beyond it are clamped. A maximum below the minimum counts as the minimum.
   */
  virtual void SetMinimumImageSampleDistance(double pixels);
  vtkGetMacro(MinimumImageSampleDistance, double);
  virtual void SetMaximumImageSampleDistance(double pixels);
  vtkGetMacro(MaximumImageSampleDistance, double);
  ///@}

  ///@{
  /**
   * Whether the image sample distance is chosen so that a frame takes the time that the renderer
   * allots to it (vtkRenderWindow::SetDesiredUpdateRate), and the interactive sample distance is
   * used in quick frames. What does not depend on the number of rays, as an edit of a fine lattice
   * or many small volumes, may take longer than that by itself: the rays then get up to a quarter
   * of its time, but no more than is allotted: fewer would not make the frame much shorter.
   * Default: on. Still frames then have the minimum image sample distance, one ray a pixel by
   * default.
   */
  vtkSetMacro(AutoAdjustSampleDistances, vtkTypeBool);
  vtkGetMacro(AutoAdjustSampleDistances, vtkTypeBool);
  vtkBooleanMacro(AutoAdjustSampleDistances, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Whether a frame that follows an edit of the control points alone, while the scene moves, casts
   * only those parts, of 16 x 16 rays, anew that see the edit. "While the scene moves": the
   * renderer allots less than 1 / InteractiveUpdateRate seconds to the frame
   * (vtkRenderWindow::SetDesiredUpdateRate, as interactors and widgets set it during a drag). Any
   * other change, to camera, clipping range, light, transfer functions, voxels or options, makes
   * the next picture as a whole, and so does a still frame: no still picture depends on what was
   * drawn before (see SetStillFrameCoherence()). Not used for blend mode slice, nor with
   * CollectStatistics, nor where T is not proven to be one to one. Default: on.
   */
  vtkSetMacro(FrameCoherence, vtkTypeBool);
  vtkGetMacro(FrameCoherence, vtkTypeBool);
  vtkBooleanMacro(FrameCoherence, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Set/Get the largest motion of the material in a part of the picture, summed over all edits
   * since its rays were cast, for which FrameCoherence reuses the part: pixels, by their size at
   * the material. (If T is not inverted, motion in the volume at rest.) 0: a part is shown again
   * only if nothing in it has moved at all. Not negative. Default: 0.25.
   */
  virtual void SetFrameCoherenceTolerance(double pixels);
  vtkGetMacro(FrameCoherenceTolerance, double);
  ///@}

  ///@{
  /**
   * Whether a still frame in a window shows the last still picture again where nothing that it is
   * made from has changed since: the same volume, deformation, camera, lights and options. Cast
   * anew are those parts, of 64 x 64 rays, in which other props hide more or less of the volume. So
   * a pointer that moves over a widget, or a text that changes, does not wait for the volume.
   * Coarse frames, as a click makes one, and images in between leave the still picture as it is. It
   * is the same as without, bit by bit, and GetTimeToDraw() stays that of the frame that was cast,
   * by which vtkLODProp3D chooses. Costs the memory of two more pictures. Not used for blend mode
   * slice, nor with CollectStatistics. Leave it off where the time of frames is measured. Default:
   * off.
   */
  vtkSetMacro(StillFrameCoherence, vtkTypeBool);
  vtkGetMacro(StillFrameCoherence, vtkTypeBool);
  vtkBooleanMacro(StillFrameCoherence, vtkTypeBool);
  ///@}

  /**
   * Seconds that a still picture in a window is expected to take, without what a change of voxels,
   * deformation or functions makes necessary before its rays are cast: as long as the last one did,
   * or what follows from a moving or an aborted one. 0 before the first frame.
   */
  double GetExpectedStillTime();

  /**
   * Get the part, 0 to 1, of the last picture in a window that was taken from the picture before
   * it, see SetFrameCoherence() and SetStillFrameCoherence(). 0 after RenderToImage().
   */
  double GetReusedFraction();

  ///@{
  /**
   * Whether opaque geometry that was rendered before hides what is behind it. Default: on. Depths
   * of the window are read for it, which takes time, but where the volume is all that can have been
   * drawn: no other prop of the renderer, a vtkOpenGLRenderer itself, is visible, and it has no
   * render pass, erases and does not preserve depths.
   */
  vtkSetMacro(IntermixIntersectingGeometry, vtkTypeBool);
  vtkGetMacro(IntermixIntersectingGeometry, vtkTypeBool);
  vtkBooleanMacro(IntermixIntersectingGeometry, vtkTypeBool);
  ///@}

  /**
   * Which space is cropped.
   */
  enum CroppingSpaces
  {
    REST,    ///< the volume before it is deformed: regions move with the material
    DEFORMED ///< what has been deformed: regions stay where they are
  };

  ///@{
  /**
   * The space that the planes of SetCroppingRegionPlanes(), data coordinates, cut into the 27
   * regions of SetCroppingRegionFlags() when CroppingOn() is set. Default: REST. Planes run along
   * the axes of the image at rest (its direction matrix turns them, too), in deformed space along
   * those of the data coordinates.
   */
  vtkSetClampMacro(CroppingSpace, int, REST, DEFORMED);
  vtkGetMacro(CroppingSpace, int);
  void SetCroppingSpaceToRest() { this->SetCroppingSpace(REST); }
  void SetCroppingSpaceToDeformed() { this->SetCroppingSpace(DEFORMED); }
  const char* GetCroppingSpaceAsString() const;
  ///@}

  ///@{
  /**
   * Whether the samples of each ray are moved on by a part of the sample distance that differs from
   * pixel to pixel, in a fixed pattern: jitter trades the banding that samples at equal depths make
   * for noise. Default: off. Isosurfaces and slices, which are exact, are not changed by it.
   */
  vtkSetMacro(UseJittering, vtkTypeBool);
  vtkGetMacro(UseJittering, vtkTypeBool);
  vtkBooleanMacro(UseJittering, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Window and level of the colors of the finished picture, from 0 to 1: colors of level - window
   * / 2 become black, of level + window / 2 white. A negative window inverts. Defaults: 1 and 0.5,
   * which change nothing. The window must not be 0.
   */
  virtual void SetFinalColorWindow(double window);
  vtkGetMacro(FinalColorWindow, double);
  virtual void SetFinalColorLevel(double level);
  vtkGetMacro(FinalColorLevel, double);
  ///@}

  /**
   * Kinds of masks, as in vtkGPUVolumeRayCastMapper.
   */
  enum MaskTypes
  {
    BinaryMaskType = 0, ///< nothing is rendered where it is 0 or negative
    LabelMapMaskType    ///< labels have functions of their own
  };

  ///@{
  /**
   * A mask at rest, one component of any type: it is deformed along with the volume. Its scalars
   * are those of its points, or of its cells if there are no others or the volume's are of cells,
   * too. Each sample takes the nearest voxel of it. A mask with the dimensions of the scalars
   * belongs to them voxel by voxel; another lies where its origin, spacing and direction say, and
   * is 0 elsewhere.
   *
   * In a label map, label 0 and labels without functions look as the property says. Others have
   * those of vtkVolumeProperty::SetLabelColor(), SetLabelScalarOpacity() and
   * SetLabelGradientOpacity(); color and scalar opacity that a label has none for are those of the
   * property, the gradient opacity is then none. Labels with functions range from 1 to 65535; a
   * larger one is refused with an error. Label maps need one component or dependent ones, of which
   * labels look up the one that is looked up for opacity; they are composited only. (VTK's mappers
   * draw labels on one component only: the GPU mapper ignores them on dependent ones, and its
   * shader does not compile with independent ones.) Binary masks work on any components and with
   * all blend modes. Default: none.
   */
  virtual void SetMaskInput(vtkImageData* mask);
  vtkGetObjectMacro(MaskInput, vtkImageData);
  ///@}

  ///@{
  /**
   * Default: LabelMapMaskType.
   */
  vtkSetClampMacro(MaskType, int, BinaryMaskType, LabelMapMaskType);
  vtkGetMacro(MaskType, int);
  void SetMaskTypeToBinary() { this->SetMaskType(BinaryMaskType); }
  void SetMaskTypeToLabelMap() { this->SetMaskType(LabelMapMaskType); }
  ///@}

  ///@{
  /**
   * Set/Get the weight of a label's color and opacity; the rest is the weight of those without a
   * mask. Range 0 to 1, other numbers are refused with an error. Default: 1.
   */
  virtual void SetMaskBlendFactor(float factor);
  vtkGetMacro(MaskBlendFactor, float);
  ///@}

  /**
   * Ways to render scalars with several components, as in vtkSmartVolumeMapper.
   */
  enum VectorModeType
  {
    DISABLED = -1, ///< the components, as the property says
    MAGNITUDE = 0, ///< the root of the sum of their squares
    COMPONENT = 1  ///< one of them: VectorComponent
  };

  ///@{
  /**
   * Whether scalars with several components are rendered as one with the functions of component 0
   * of the property: their magnitude (a float, or a double where that does not hold the type) or
   * one of them. Scalars of one component are rendered as they are. An array of these scalars is
   * kept, see GetAuxiliaryMemorySize(). Default: DISABLED.
   */
  vtkSetClampMacro(VectorMode, int, DISABLED, COMPONENT);
  vtkGetMacro(VectorMode, int);
  void SetVectorModeToDisabled() { this->SetVectorMode(DISABLED); }
  void SetVectorModeToMagnitude() { this->SetVectorMode(MAGNITUDE); }
  void SetVectorModeToComponent() { this->SetVectorMode(COMPONENT); }
  const char* GetVectorModeAsString() const;
  ///@}

  ///@{
  /**
   * Which component VectorMode COMPONENT renders, counted from 0; an error if there is none of that
   * number. Range 0 to 3. Default: 0.
   */
  vtkSetClampMacro(VectorComponent, int, 0, 3);
  vtkGetMacro(VectorComponent, int);
  ///@}

  ///@{
  /**
   * Name of the array, of the points or cells that the scalars belong to, that is the second axis
   * of two-dimensional transfer functions (vtkVolumeProperty::SetTransferFunction2D()); they span
   * the range of its first component; not used with functions of one dimension. Default: none,
   * which means the magnitude of the gradient, up to a quarter of the range of the scalars.
   */
  vtkSetStringMacro(Transfer2DYAxisArray);
  vtkGetStringMacro(Transfer2DYAxisArray);
  ///@}

#ifdef VTK_FFD_OWN_COMPUTE_NORMAL_FROM_OPACITY
  ///@{
  /**
   * Whether normals for shading are those of the opacity function instead of the scalars. Default:
   * off. (vtkVolumeMapper has this since VTK 9.2.)
   */
  vtkSetMacro(ComputeNormalFromOpacity, bool);
  vtkGetMacro(ComputeNormalFromOpacity, bool);
  vtkBooleanMacro(ComputeNormalFromOpacity, bool);
  ///@}
#endif

  ///@{
  /**
   * A box of deformed space, data coordinates (xmin, xmax, ymin, ymax, zmin, zmax), that the rays
   * are cut to, min <= max. The samples stay where they are without it: each belongs to one of two
   * boxes that share a face, so that pictures of the boxes of a partition, blended in their order,
   * are the picture of the whole. For parallel rendering, where a process may hold only the part of
   * the volume that its box is pulled back to. Limits may be infinite, not NaN. Default: all of
   * space.
   */
  void SetClipBox(const double box[6]);
  void SetClipBox(double xmin, double xmax, double ymin, double ymax, double zmin, double zmax);
  void GetClipBox(double box[6]) const;
  void RemoveClipBox();
  ///@}

  ///@{
  /**
   * Bounds of the whole volume at rest, data coordinates, when the input is a part of it: the one
   * that ClipBox needs. Then the same segments of rays are sampled as with the whole, and
   * GetBounds() are those of the whole. Default: none (uninitialized bounds), the input is all
   * there is.
   */
  void SetWholeBounds(const double bounds[6]);
  void SetWholeBounds(double xmin, double xmax, double ymin, double ymax, double zmin, double zmax);
  vtkGetVector6Macro(WholeBounds, double);
  ///@}

  ///@{
  /**
   * Least and largest finite scalar of that whole volume, where it has one component: tables of the
   * transfer functions and blend modes are then those of the whole, and a part without finite
   * scalars is empty, not an error. Must be finite. Default: none (1, -1), those of the input.
   */
  void SetWholeScalarRange(double min, double max);
  void SetWholeScalarRange(const double range[2]);
  vtkGetVector2Macro(WholeScalarRange, double);
  ///@}

  ///@{
  /**
   * Largest number of threads, up to 1024, that make a picture and what it needs; 0, the default,
   * means as many as vtkSMPTools uses, and there are never more than that. Other mappers, and the
   * process, are not affected. The image is the same, bit by bit, with any number.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  ///@}

  ///@{
  /**
   * Whether the reference kernels render: one ray after the other in double precision, the oracle
   * that the fast kernels are tested against. Default: off. The pictures differ by rounding and by
   * what PositionTolerance and InverseTolerance allow.
   *
   * They always render GREEDY_ANGLE, and slices of more than 7 * 10^8 voxels (or cells).
   */
  vtkSetMacro(ReferenceKernels, vtkTypeBool);
  vtkGetMacro(ReferenceKernels, vtkTypeBool);
  vtkBooleanMacro(ReferenceKernels, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Whether GetStatistics is filled by every image. Default: off.
   */
  vtkSetMacro(CollectStatistics, vtkTypeBool);
  vtkGetMacro(CollectStatistics, vtkTypeBool);
  vtkBooleanMacro(CollectStatistics, vtkTypeBool);
  ///@}

  /**
   * Counts of the last image rendered with CollectStatistics on; zeros before. Never null.
   */
  vtkFFDRayStatistics* GetStatistics();

  ///@{
  /**
   * Whether the colors that RenderToImage() writes are multiplied by their alpha. Over black they
   * are then the picture in a window, over a background b they are colors + (1 - alpha) b.
   * Default: off, straight alpha, which image files and most programs expect: colors are divided
   * by alpha and cut at 1. Straight alpha therefore loses what is brighter than its alpha: the sums
   * of several independent components.
   */
  vtkSetMacro(PremultipliedAlpha, vtkTypeBool);
  vtkGetMacro(PremultipliedAlpha, vtkTypeBool);
  vtkBooleanMacro(PremultipliedAlpha, vtkTypeBool);
  ///@}

  /**
   * Render the volume into images, without any window or OpenGL. Camera, lights and two-sided
   * lighting are those of `renderer`; its window, if any, is not used.
   *
   * `colors` becomes a width x height x 1 image of 4 unsigned chars, red, green, blue, alpha, rows
   * bottom up, 0 where there is nothing; see PremultipliedAlpha for what colors are. `depths`, if
   * not null, becomes one of floats: the window depth (0 near, 1 far) of the first visible sample
   * (of the sample with the extreme value, of the first surface, or of the slice in those blend
   * modes), 1 where there is none. `inputDepths`, if not null, is such an image of what lies in
   * front: rays end there.
   *
   * Returns 1, or 0 after an error or an abort; the images are then left as they were. Width and
   * height range from 1 to 16384. The volume and its mask are refused as images to be written.
   */
  int RenderToImage(vtkRenderer* renderer, vtkVolume* volume, int width, int height,
    vtkImageData* colors, vtkImageData* depths = nullptr, vtkImageData* inputDepths = nullptr);

  ///@{
  /**
   * Whether frames of a render window become images instead of pictures in the window, as with
   * vtkGPUVolumeRayCastMapper: Render() then draws nothing, and GetColorImage() and GetDepthImage()
   * give what it would have drawn, a ray for each pixel of the viewport. (RenderToImage() needs
   * neither a window nor this option.) Default: off.
   */
  void SetRenderToImage(vtkTypeBool on);
  vtkTypeBool GetRenderToImage() { return this->RendersToImage; }
  vtkBooleanMacro(RenderToImage, vtkTypeBool);
  ///@}

  ///@{
  /**
   * The last frame with RenderToImageOn(). Colors are 4 unsigned chars, always premultiplied, 0
   * where there is nothing. Depths are one number of DepthImageScalarType: what the depths of
   * RenderToImage() are, from 0 to 1 as float, to 255 or 65535 as unsigned char or short. An error,
   * and `image` stays as it is, if there was no such frame.
   */
  void GetColorImage(vtkImageData* image);
  void GetDepthImage(vtkImageData* image);
  ///@}

  ///@{
  /**
   * Type of GetDepthImage(): VTK_UNSIGNED_CHAR, VTK_UNSIGNED_SHORT, or VTK_FLOAT for any other
   * number. Default: VTK_FLOAT.
   */
  vtkSetMacro(DepthImageScalarType, int);
  vtkGetMacro(DepthImageScalarType, int);
  void SetDepthImageScalarTypeToUnsignedChar() { this->SetDepthImageScalarType(VTK_UNSIGNED_CHAR); }
  void SetDepthImageScalarTypeToUnsignedShort()
  {
    this->SetDepthImageScalarType(VTK_UNSIGNED_SHORT);
  }
  void SetDepthImageScalarTypeToFloat() { this->SetDepthImageScalarType(VTK_FLOAT); }
  ///@}

  ///@{
  /**
   * Whether GetDepthImage() has, where nothing is visible, the depth at which the ray leaves
   * GetBounds() (without deformation: the back faces of the volume), cut to ClipBox and, with
   * CroppingSpace DEFORMED and VTK_CROP_SUBVOLUME, to the cropping planes, instead of 1. Default:
   * off.
   */
  vtkSetMacro(ClampDepthToBackface, vtkTypeBool);
  vtkGetMacro(ClampDepthToBackface, vtkTypeBool);
  vtkBooleanMacro(ClampDepthToBackface, vtkTypeBool);
  ///@}

  /**
   * Which scalars transfer functions are asked for.
   */
  enum TFRangeType
  {
    SCALAR = 0, ///< all: beyond the first and last point the function's Clamping says what it is
    NATIVE      ///< those of the range of the function: others count as its nearest end
  };

  ///@{
  /**
   * Default: SCALAR. As in vtkGPUVolumeRayCastMapper; of functions with ClampingOn(), their
   * default, and without colors beyond the range NATIVE changes nothing.
   */
  vtkSetClampMacro(ColorRangeType, int, SCALAR, NATIVE);
  vtkGetMacro(ColorRangeType, int);
  vtkSetClampMacro(ScalarOpacityRangeType, int, SCALAR, NATIVE);
  vtkGetMacro(ScalarOpacityRangeType, int);
  vtkSetClampMacro(GradientOpacityRangeType, int, SCALAR, NATIVE);
  vtkGetMacro(GradientOpacityRangeType, int);
  ///@}

  ///@{
  /**
   * The scene counts as moving when the renderer allots less than 1 / InteractiveUpdateRate seconds
   * to a frame: then AutoAdjustSampleDistances and FrameCoherence apply. Range 1e-10 to 1e10,
   * positive numbers beyond it are clamped, others refused with an error. Default: 1, as in
   * vtkSmartVolumeMapper.
   */
  virtual void SetInteractiveUpdateRate(double framesPerSecond);
  vtkGetMacro(InteractiveUpdateRate, double);
  ///@}

  ///@{
  /**
   * Whether pictures invoke ProgressEvent and VolumeMapperRenderProgressEvent. Default: on.
   */
  vtkSetMacro(ReportProgress, bool);
  vtkGetMacro(ReportProgress, bool);
  ///@}

  ///@{
  /**
   * A picture of the volume alone, without cropping, in parallel projection along `viewDirection`,
   * over black: `image`, whose dimensions say how large, is given 3 unsigned chars a pixel. The
   * half width of the bounds fits its half height. Three signatures, those of
   * vtkFixedPointVolumeRayCastMapper, vtkGPUVolumeRayCastMapper and vtkSmartVolumeMapper; the
   * lights are those of the renderer, or a headlight. `volume2` is not used.
   */
  void CreateCanonicalView(vtkVolume* volume, vtkImageData* image, int blendMode,
    double viewDirection[3], double viewUp[3]);
  void CreateCanonicalView(vtkRenderer* renderer, vtkVolume* volume, vtkImageData* image,
    int blendMode, double viewDirection[3], double viewUp[3]);
  void CreateCanonicalView(vtkRenderer* renderer, vtkVolume* volume, vtkVolume* volume2,
    vtkImageData* image, int blendMode, double viewDirection[3], double viewUp[3]);
  ///@}

  /**
   * Make what the next frame needs of voxels, deformation and functions now. False after an error.
   */
  bool PreLoadData(vtkRenderer* renderer, vtkVolume* volume);

  ///@{
  /**
   * Seconds that a picture with a ray a pixel would take, from the last one in a window; 0 before.
   * The arguments are not used: it is that of the last volume and renderer.
   */
  float GetEstimatedRenderTime(vtkRenderer* renderer, vtkVolume* volume = nullptr);
  ///@}

  /**
   * Pixels between rays, within the limits of the automatic image sample distance, with which that
   * would take `desiredTime` seconds.
   */
  float ComputeRequiredImageSampleDistance(
    float desiredTime, vtkRenderer* renderer, vtkVolume* volume = nullptr);

  /**
   * End the picture that is being made, as SetAbortExecute(1) does: to be called by its observers.
   */
  void AbortRender() { this->SetAbortExecute(1); }

  ///@{
  /**
   * Names of vtkGPUVolumeRayCastMapper, vtkOpenGLGPUVolumeRayCastMapper and vtkSmartVolumeMapper
   * that change nothing here, so that code written for those mappers compiles and runs.
   *
   * They choose among mappers, of which there is one: it draws in every window
   * (IsRenderSupported() is 1) on the CPU (GetLastUsedRenderMode() is RayCastRenderMode); whether
   * distances adapt is AutoAdjustSampleDistances alone. They limit, split or reduce textures, of
   * which there are none: the reduction ratio is 1, textures are null. They look for the first
   * surface in a pass of its own, which space leaping does. There is one input. Light is not
   * scattered: GlobalIlluminationReach, clamped to 0 to 1, and VolumetricScatteringBlending,
   * clamped to 0 to 2, are those of VTK 9.2; default 0. MaxMemoryFraction is clamped to 0.1 to 1.
   * AnariRenderMode is that of VTK 9.4.
   */
  enum
  {
    DefaultRenderMode = 0,
    RayCastRenderMode = 1,
    GPURenderMode = 2,
    OSPRayRenderMode = 3,
    AnariRenderMode = 4,
    UndefinedRenderMode = 5,
    InvalidRenderMode = 6
  };
  enum Passes
  {
    RenderPass,
    DepthPass = 1
  };
  enum LowResModeType
  {
    LowResModeDisabled = 0,
    LowResModeResample
  };
  virtual int IsRenderSupported(vtkRenderWindow*, vtkVolumeProperty*) { return 1; }
  vtkSetMacro(RequestedRenderMode, int);
  vtkGetMacro(RequestedRenderMode, int);
  void SetRequestedRenderModeToDefault() { this->SetRequestedRenderMode(DefaultRenderMode); }
  void SetRequestedRenderModeToRayCast() { this->SetRequestedRenderMode(RayCastRenderMode); }
  void SetRequestedRenderModeToGPU() { this->SetRequestedRenderMode(GPURenderMode); }
  void SetRequestedRenderModeToOSPRay() { this->SetRequestedRenderMode(OSPRayRenderMode); }
  void SetRequestedRenderModeToAnari() { this->SetRequestedRenderMode(AnariRenderMode); }
  int GetLastUsedRenderMode() { return RayCastRenderMode; }
  vtkSetMacro(InteractiveAdjustSampleDistances, vtkTypeBool);
  vtkGetMacro(InteractiveAdjustSampleDistances, vtkTypeBool);
  vtkBooleanMacro(InteractiveAdjustSampleDistances, vtkTypeBool);
  vtkSetMacro(InterpolationMode, int);
  vtkGetMacro(InterpolationMode, int);
  void SetInterpolationModeToNearestNeighbor() { this->SetInterpolationMode(0); }
  void SetInterpolationModeToLinear() { this->SetInterpolationMode(1); }
  void SetInterpolationModeToCubic() { this->SetInterpolationMode(3); }
  vtkSetMacro(MaxMemoryInBytes, vtkIdType);
  vtkGetMacro(MaxMemoryInBytes, vtkIdType);
  virtual void SetMaxMemoryFraction(float fraction);
  vtkGetMacro(MaxMemoryFraction, float);
  void GetReductionRatio(double ratio[3]) { ratio[0] = ratio[1] = ratio[2] = 1.0; }
  void SetPartitions(unsigned short, unsigned short, unsigned short) {}
  vtkTextureObject* GetColorTexture() { return nullptr; }
  vtkTextureObject* GetDepthTexture() { return nullptr; }
  void SetSharedDepthTexture(vtkTextureObject*) {}
  vtkSetMacro(LowResMode, int);
  vtkGetMacro(LowResMode, int);
  vtkSetMacro(UseDepthPass, vtkTypeBool);
  vtkGetMacro(UseDepthPass, vtkTypeBool);
  vtkBooleanMacro(UseDepthPass, vtkTypeBool);
  virtual void SetGlobalIlluminationReach(float reach);
  vtkGetMacro(GlobalIlluminationReach, float);
  virtual void SetVolumetricScatteringBlending(float blending);
  vtkGetMacro(VolumetricScatteringBlending, float);
  vtkContourValues* GetDepthPassContourValues();
  int GetCurrentPass() { return RenderPass; }
  int GetInputCount() { return this->GetNumberOfInputConnections(0); }
  vtkDataSet* GetTransformedInput(int = 0) { return this->GetInput(); }
  double* GetBoundsFromPort(int) VTK_SIZEHINT(6) { return this->GetBounds(); }
  void GPURender(vtkRenderer* renderer, vtkVolume* volume) { this->Render(renderer, volume); }
  ///@}

  /**
   * Makes the output of vtkFFDRayTracer, see there: the rays of the given pixels (2 components,
   * column and row, from the lower left) of a picture of width x height pixels, as RenderToImage()
   * would cast them. `viewingRays` and `samples` may be null. Returns 1, or 0 after an error. A
   * pixel outside of the picture is left out, with an error; the others are traced.
   */
  int TraceRays(vtkRenderer* renderer, vtkVolume* volume, int width, int height,
    vtkIdTypeArray* pixels, vtkPolyData* rays, vtkPolyData* viewingRays, vtkPolyData* samples);

  /**
   * Compute the rest position of the material at a point of deformed space: the pull-back of
   * `deformed`, by InverseMode, but to a billionth of a voxel. Both in data coordinates; the point
   * may lie outside of the volume, then so does the result. vtkFFDVolumePicker does this for what
   * is seen at a pixel. Returns 1, or 0 after an error; `rest` is then left as it was.
   */
  int GetRestPosition(const double deformed[3], double rest[3]);

  ///@{
  /**
   * Bounds of the deformed volume, data coordinates: (xmin, xmax, ymin, ymax, zmin, zmax), from
   * the control points, so never too small. Uninitialized (1, -1, ...) without a valid input.
   */
  double* GetBounds() VTK_SIZEHINT(6) override;
  void GetBounds(double bounds[6]) override { this->vtkAbstractVolumeMapper::GetBounds(bounds); }
  ///@}

  /**
   * Parts that are made from the inputs and kept between frames.
   */
  enum CachedParts
  {
    MIN_MAX_BLOCKS,     ///< limits of the scalars, from the voxels
    DEFORMATION_FIELD,  ///< the B-spline, from the deformation (a foreign one is approximated)
    DEFORMATION_BOUNDS, ///< of the pull-back and of the deformed volume, from that
    TRANSFER_TABLE,     ///< functions and surfaces, from the property
    DISTANCE_MAP,       ///< of empty space, from blocks and table
    NUMBER_OF_CACHED_PARTS
  };

  /**
   * Get the number of times that a stage has been made since this mapper was created: none is made
   * again before something that it depends on has changed. Bounds that another mapper has found for
   * the same deformation and volume are shared, and do not count. For tests and for finding out why
   * a frame is slow. -1 for a number that is no stage.
   */
  vtkTypeInt64 GetNumberOfBuilds(int part);

  /**
   * Memory held besides the volume itself, in bytes: limits and distances of the blocks, transfer
   * table, lattice and its bounds, the scalars that VectorMode makes, blanked cells, the
   * coordinates of a rectilinear grid, and what FrameCoherence keeps of the last picture; not the
   * image.
   */
  vtkTypeInt64 GetAuxiliaryMemorySize();

  ///@{
  /**
   * Bring the input up to date. No StartEvent, ProgressEvent and EndEvent come of this: they are
   * those of frames.
   */
  void Update() override;
  void Update(int port) override;
  using vtkVolumeMapper::Update;
  ///@}

  /**
   * Includes the modification times of the deformation, the mask and the clipping planes.
   */
  vtkMTimeType GetMTime() override;

  /**
   * Take over the input connection, the options and the clipping planes of another mapper: those of
   * this class, or of a vtkVolumeMapper what that has. Nothing that is kept between frames.
   */
  void ShallowCopy(vtkAbstractMapper* mapper) override;

  ///@{
  /**
   * WARNING: INTERNAL METHODS - NOT INTENDED FOR GENERAL USE
   */
  void Render(vtkRenderer* renderer, vtkVolume* volume) override;
  void ReleaseGraphicsResources(vtkWindow* window) override;
  ///@}

protected:
  vtkFFDInverseRayVolumeMapper();
  ~vtkFFDInverseRayVolumeMapper() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void ReportReferences(vtkGarbageCollector* collector) override;

private:
  vtkFFDInverseRayVolumeMapper(const vtkFFDInverseRayVolumeMapper&) = delete;
  void operator=(const vtkFFDInverseRayVolumeMapper&) = delete;

  void SetClamped(float& option, float value, float low, float high);
  double FindSampleDistance(double voxelSize, bool interactive) const;

  // The bodies of public methods, which guard them against exceptions.
  void RenderInWindow(vtkRenderer* renderer, vtkVolume* volume);
  int MakeImages(vtkRenderer* renderer, vtkVolume* volume, int width, int height,
    vtkImageData* colors, vtkImageData* depths, vtkImageData* inputDepths);
  int MakeRays(vtkRenderer* renderer, vtkVolume* volume, int width, int height,
    vtkIdTypeArray* pixels, vtkPolyData* rays, vtkPolyData* viewingRays, vtkPolyData* samples);

  // For looking at the volume point by point; false after an error.
  friend class vtkFFDVolumePicker;
  bool MakeProbeView(vtkFFDProbeView& view);
  friend class vtkFFDFramePlan;
  friend class vtkFFDFrameScene;
  vtkMTimeType GetSettingsTime();

  vtkAbstractTransform* Deformation = nullptr;
  int InverseMode = EXACT;
  double InverseTolerance = 0.01;
  int Segmentation = ERROR_BOUND;
  double PositionTolerance = 0.1;
  double AngleThreshold = 5.0;
  double MinimumSegmentLength = 0.5;
  double MaximumSegmentLength = 64.0;
  int SpaceLeaping = LIPSCHITZ;
  double EarlyRayTerminationThreshold = 1.0 / 255.0;
  int OpacityLength = WORLD;
  int Classification = POST_INTERPOLATED;
  double SampleDistance = 1.0;
  double InteractiveSampleDistance = 2.0;
  vtkTypeBool LockSampleDistanceToInputSpacing = 1;
  bool InteractiveSampleDistanceLocked = true;
  double ImageSampleDistance = 1.0;
  double MinimumImageSampleDistance = 1.0;
  double MaximumImageSampleDistance = 10.0;
  vtkTypeBool AutoAdjustSampleDistances = 1;
  vtkTypeBool FrameCoherence = 1;
  double FrameCoherenceTolerance = 0.25;
  vtkTypeBool StillFrameCoherence = 0;
  vtkTypeBool IntermixIntersectingGeometry = 1;
  vtkImageData* MaskInput = nullptr;
  int MaskType = LabelMapMaskType;
  float MaskBlendFactor = 1.0f;
  char* Transfer2DYAxisArray = nullptr;
  int VectorMode = DISABLED;
  int VectorComponent = 0;
#ifdef VTK_FFD_OWN_COMPUTE_NORMAL_FROM_OPACITY
  bool ComputeNormalFromOpacity = false;
#endif
  double ClipBox[6]; // all of space: infinite limits
  bool HasClipBox = false;
  double WholeBounds[6] = { 1.0, -1.0, 1.0, -1.0, 1.0, -1.0 };
  double WholeScalarRange[2] = { 1.0, -1.0 };
  int CroppingSpace = REST;
  vtkTypeBool UseJittering = 0;
  double FinalColorWindow = 1.0;
  double FinalColorLevel = 0.5;
  vtkTypeBool PremultipliedAlpha = 0;
  vtkTypeBool RendersToImage = 0;
  int DepthImageScalarType = VTK_FLOAT;
  vtkTypeBool ClampDepthToBackface = 0;
  int ColorRangeType = SCALAR;
  int ScalarOpacityRangeType = SCALAR;
  int GradientOpacityRangeType = SCALAR;
  double InteractiveUpdateRate = 1.0;
  bool ReportProgress = true;
  int RequestedRenderMode = DefaultRenderMode;
  vtkTypeBool InteractiveAdjustSampleDistances = 1;
  int InterpolationMode = 3;
  vtkIdType MaxMemoryInBytes = 0;
  float MaxMemoryFraction = 0.75f;
  int LowResMode = LowResModeDisabled;
  vtkTypeBool UseDepthPass = 0;
  float GlobalIlluminationReach = 0.0f;
  float VolumetricScatteringBlending = 0.0f;
  int NumberOfThreads = 0;
  vtkTypeBool ReferenceKernels = 0;
  vtkTypeBool CollectStatistics = 0;

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
