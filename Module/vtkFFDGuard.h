// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to the libraries of this project: not installed, not wrapped.
#ifndef vtkFFDGuard_h
#define vtkFFDGuard_h

#include "vtkFFDCoreModule.h" // For export macro

#include <functional>
#include <string>

class vtkInformationVector;
class vtkObject;

/**
 * Bytes that this process can still allocate and fill: the least of what the machine has left
 * (memory that is free or easily made free, and swap), of what the control groups of the process
 * leave it, and of what its resource limits do. Where none of these is known: infinity.
 */
VTKFFDCORE_EXPORT double vtkFFDAvailableMemory();

/**
 * To be called before a large allocation, inside of vtkFFDGuard(): throws an error that the guard
 * reports when `bytes` are more than there are. On systems that overcommit, the allocation itself
 * would succeed and the process be killed when it fills the memory. `what` is the subject of the
 * message, "1024 x 1024 x 1024 control points"; `advice` says what to do, a sentence.
 */
VTKFFDCORE_EXPORT void vtkFFDRequireMemory(
  double bytes, const std::string& what, const std::string& advice);

/**
 * Runs `work`, and reports each exception as an error of `self`: no exception may pass through VTK,
 * which would end the process. `where` starts the message. Returns whether `work` came to its end.
 */
VTKFFDCORE_EXPORT bool vtkFFDGuard(
  vtkObject* self, const char* where, const std::function<void()>& work);

/// The result of `work`, or `failure` where an exception ended it: see vtkFFDGuard().
template <typename Result, typename Work>
Result vtkFFDGuarded(vtkObject* self, const char* where, Result failure, const Work& work)
{
  Result result = failure;
  return vtkFFDGuard(self, where, [&] { result = work(); }) ? result : failure;
}

/// vtkFFDGuarded() for vtkAlgorithm::ProcessRequest(): after a failure the next request starts
/// anew.
VTKFFDCORE_EXPORT int vtkFFDGuardedRequest(vtkObject* self, const char* where,
  vtkInformationVector* outputs, const std::function<int()>& work);

///@{
/// Whether an inverse can be found with such a tolerance, and so many iterations; an error of
/// `self` where it cannot.
VTKFFDCORE_EXPORT bool vtkFFDIsInverseTolerance(vtkObject* self, double tolerance);
VTKFFDCORE_EXPORT bool vtkFFDIsInverseIterations(vtkObject* self, int iterations);
///@}

/**
 * The definition of ProcessRequest() of an algorithm, which all that a pipeline asks of it goes
 * through: that of the superclass, guarded. An exception makes the request fail.
 */
#define vtkFFDGuardedProcessRequestMacro(thisClass)                                                \
  vtkTypeBool thisClass::ProcessRequest(                                                           \
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)         \
  {                                                                                                \
    return vtkFFDGuardedRequest(this, #thisClass, outputs,                                         \
      [&] { return this->Superclass::ProcessRequest(request, inputs, outputs); });                 \
  }

#endif
