// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to the libraries of this project: not installed, not wrapped.
#ifndef vtkFFDPipeline_h
#define vtkFFDPipeline_h

#include "vtkFFDCoreModule.h" // For export macro

#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

class vtkAlgorithmOutput;
class vtkCompositeDataSet;
class vtkDataArray;
class vtkDataObject;
class vtkDataSet;
class vtkImageData;
class vtkInformation;
class vtkInformationVector;

/// In RequestUpdateExtent(): asks an input, which may be null, for all of its data, whatever part
/// of the output is asked for.
VTKFFDCORE_EXPORT void vtkFFDRequestWhole(vtkInformation* input);

///@{
/**
 * For filters whose output has an extent that follows from data, which may change with time. In
 * RequestInformation() vtkFFDUpdateWhole() brings all data of a connection up to date, at the time
 * that `output`, unless it is null, is wanted for, and vtkFFDFollowTime() makes the executive ask
 * again where there are time steps. What it then sends, REQUEST_TIME_DEPENDENT_INFORMATION(), goes
 * to vtkFFDRequestInformationAgain(): who had asked for all of the output does so again.
 */
VTKFFDCORE_EXPORT void vtkFFDUpdateWhole(vtkAlgorithmOutput* connection, vtkInformation* output);
VTKFFDCORE_EXPORT void vtkFFDFollowTime(vtkInformation* input, vtkInformation* output);
VTKFFDCORE_EXPORT int vtkFFDRequestInformationAgain(
  vtkInformationVector* outputs, const std::function<int()>& requestInformation);
///@}

///@{
/**
 * The geometry of the whole image of an input. Filters of VTK do not pass on
 * vtkDataObject::DIRECTION(): where that key is missing, only the image itself has the direction.
 * vtkFFDGetWholeGeometry() sets extent, origin, spacing and direction of `geometry` as `input`
 * announces them, all but the extent as those of `image`, if that is up to date and not empty; it
 * may be null. vtkFFDUpdatePart() is for RequestInformation() of filters whose extent follows from
 * the direction. It brings the image of a connection up to date, at the time that `output`, unless
 * it is null, is wanted for: the part that was asked for last, or 2 x 2 x 2 voxels.
 */
VTKFFDCORE_EXPORT void vtkFFDGetWholeGeometry(
  vtkInformation* input, vtkImageData* image, vtkImageData* geometry);
VTKFFDCORE_EXPORT void vtkFFDUpdatePart(vtkAlgorithmOutput* connection, vtkInformation* output);
///@}

/// Whether `data` is a block of `blocks`, which may be null. An executive that hands the blocks of
/// a data set to a filter sets each in the place of the data set, whose producer must not be
/// brought up to date meanwhile: the blocks are.
VTKFFDCORE_EXPORT bool vtkFFDIsBlock(vtkCompositeDataSet* blocks, vtkDataObject* data);

/// Whether the array that a filter was told to process, `chosen`, is one of points, or none was
/// named; else `message` says what is wrong. `found`, of `association`: that array, or null.
VTKFFDCORE_EXPORT bool vtkFFDIsPointArray(vtkInformation* chosen, vtkDataSet* data,
  vtkDataArray* found, int association, std::string& message);

/// The definition of ProcessRequest() of such a filter, guarded as
/// vtkFFDGuardedProcessRequestMacro() does it.
#define vtkFFDProcessRequestInTimeMacro(thisClass)                                                 \
  vtkTypeBool thisClass::ProcessRequest(                                                           \
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)         \
  {                                                                                                \
    return vtkFFDGuardedRequest(this, #thisClass, outputs, [&] {                                   \
      return request->Has(vtkStreamingDemandDrivenPipeline::REQUEST_TIME_DEPENDENT_INFORMATION())  \
        ? vtkFFDRequestInformationAgain(                                                           \
            outputs, [&] { return this->RequestInformation(request, inputs, outputs); })           \
        : this->Superclass::ProcessRequest(request, inputs, outputs);                              \
    });                                                                                            \
  }

/// In RequestInformation(): the time steps and the range of `output` are `steps` and those of the
/// inputs, which may be null.
VTKFFDCORE_EXPORT void vtkFFDMergeTimes(
  std::vector<double> steps, std::initializer_list<vtkInformation*> inputs, vtkInformation* output);

#endif
