// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDDeformVolume
 * @brief   attach a lattice to image data, so that it renders deformed
 *
 * The output is the input image, its arrays shared and not copied, with a lattice in its field
 * data (vtkFFDLattice::AttachTo()). vtkFFDInverseRayVolumeMapper draws it deformed; writers save
 * it. Nothing is resampled.
 *
 * The lattice is that of the keyframes if there are any, or else that of SetLattice(), or else the
 * second input, which is an image of control points (vtkFFDLatticeSource, a .vti file) or one with
 * a lattice attached, or else the one already attached to the input. With none of them the input
 * passes through, with an error. Where the second input has time steps (vtkFFDTransformSeries), the
 * output has them, too. A lattice of the second input that is linear and far larger than the image,
 * as vtkFFDTransformSeries makes it of a linear transform, is attached as one of the size of what
 * it moves, which is the same map there.
 *
 * Keyframes are lattices at times. The output then has time steps, those of the keyframes and of
 * the input, and the lattice attached at time t is interpolated between the keyframes, control
 * point by control point, so the deformation itself is. Before the first and after the last
 * keyframe the lattice is theirs; without a requested time it is that of the first. An animation
 * sets the time of the pipeline and draws:
 * @code{.py}
 * deform.AddKeyframe(0.0, rest)
 * deform.AddKeyframe(1.0, bent)
 * mapper.SetInputConnection(deform.GetOutputPort())
 * deform.UpdateTimeStep(0.25)
 * window.Render()
 * @endcode
 *
 * @sa vtkFFDLattice vtkFFDLatticeSource vtkFFDInverseRayVolumeMapper
 */
#ifndef vtkFFDDeformVolume_h
#define vtkFFDDeformVolume_h

#include "vtkFFDFiltersModule.h" // For export macro
#include "vtkImageAlgorithm.h"
#include "vtkSmartPointer.h" // for vtkSmartPointer

#include <vector> // for std::vector

class vtkFFDLattice;

class VTKFFDFILTERS_EXPORT vtkFFDDeformVolume : public vtkImageAlgorithm
{
public:
  static vtkFFDDeformVolume* New();
  vtkTypeMacro(vtkFFDDeformVolume, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The lattice to attach; its edits re-execute the filter. Default: none, see above.
   */
  void SetLattice(vtkFFDLattice* lattice);
  vtkFFDLattice* GetLattice();
  ///@}

  ///@{
  /**
   * Keyframes, ordered by time whatever the order of the calls. AddKeyframe() keeps a reference to
   * the lattice, so its edits re-execute the filter; a keyframe at the same time is replaced. All
   * lattices need the same dimensions, domain, border mode and inverse flag, which is checked when
   * the filter runs; their displacement scales may differ. Indices beyond the last are an error:
   * the time is then NaN and the lattice null. So is a time that is not finite or a null lattice in
   * AddKeyframe(), and a time without a keyframe in RemoveKeyframe(); nothing changes then.
   */
  void AddKeyframe(double time, vtkFFDLattice* lattice);
  void RemoveKeyframe(double time);
  void RemoveAllKeyframes();
  int GetNumberOfKeyframes();
  double GetKeyframeTime(int index);
  vtkFFDLattice* GetKeyframeLattice(int index);
  ///@}

  /// Interpolation of control points between keyframes.
  enum KeyframeInterpolations
  {
    STEP,   ///< they jump at each keyframe
    LINEAR, ///< on straight lines, at constant speed
    SPLINE  ///< on natural cubic splines (vtkCardinalSpline): velocity and acceleration continuous
  };

  ///@{
  /**
   * Default: LINEAR. With two keyframes SPLINE is the same as LINEAR.
   */
  vtkSetClampMacro(KeyframeInterpolation, int, STEP, SPLINE);
  vtkGetMacro(KeyframeInterpolation, int);
  void SetKeyframeInterpolationToStep() { this->SetKeyframeInterpolation(STEP); }
  void SetKeyframeInterpolationToLinear() { this->SetKeyframeInterpolation(LINEAR); }
  void SetKeyframeInterpolationToSpline() { this->SetKeyframeInterpolation(SPLINE); }
  const char* GetKeyframeInterpolationAsString();
  ///@}

  /**
   * The lattice of the keyframes at a time, into `lattice`. Returns 1, or 0 after an error: no
   * keyframes, a null lattice, a time that is not finite, keyframes that do not go together.
   */
  int InterpolateKeyframes(double time, vtkFFDLattice* lattice);

  ///@{
  /**
   * The second input: an image of control points, as vtkFFDLattice::FromImageData() takes, or an
   * image with a lattice attached, whose voxels do not matter.
   */
  void SetLatticeConnection(vtkAlgorithmOutput* connection);
  void SetLatticeData(vtkImageData* image);
  ///@}

  /// Includes the lattice and those of the keyframes.
  vtkMTimeType GetMTime() override;

  /// Overridden so that data that do not fit into the memory are an error, not an exception.
  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

protected:
  vtkFFDDeformVolume();
  ~vtkFFDDeformVolume() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestUpdateExtent(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkFFDDeformVolume(const vtkFFDDeformVolume&) = delete;
  void operator=(const vtkFFDDeformVolume&) = delete;

  struct Keyframe
  {
    double Time;
    vtkSmartPointer<vtkFFDLattice> Lattice;
  };

  vtkSmartPointer<vtkFFDLattice> Lattice;
  std::vector<Keyframe> Keyframes; // by time
  int KeyframeInterpolation = LINEAR;
};

#endif
