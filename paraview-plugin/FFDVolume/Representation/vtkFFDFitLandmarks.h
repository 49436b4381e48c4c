// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDFitLandmarks
 * @brief   the lattice that moves landmarks to where they shall be, in a pipeline
 *
 * vtkFFDFitLattice with its landmarks at inputs: point i of the first is to move to point i of the
 * second, as many of either. The third, optional input is the volume to deform: the lattice then
 * covers its bounds and all landmarks, else the landmarks alone, with a margin of a tenth. Each of
 * several processes asks for all landmarks.
 *
 * Output 0 has the control points, for the second input of vtkFFDDeformVolume. Output 1 has the
 * landmarks where the lattice moves them to, and after them their targets, with a line from each to
 * its target; point arrays "Residual" (distance from the target, data units) and "ResidualVector"
 * (from there to the target).
 */
#ifndef vtkFFDFitLandmarks_h
#define vtkFFDFitLandmarks_h

#include "vtkFFDParaViewModule.h" // For export macro
#include "vtkImageAlgorithm.h"
#include "vtkNew.h"       // for vtkNew
#include "vtkTimeStamp.h" // for vtkTimeStamp

class vtkFFDFitLattice;

class VTKFFDPARAVIEW_EXPORT vtkFFDFitLandmarks : public vtkImageAlgorithm
{
public:
  static vtkFFDFitLandmarks* New();
  vtkTypeMacro(vtkFFDFitLandmarks, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * As in vtkFFDFitLattice: largest residual to aim at, data units, > 0 (default 0.1), most cells
   * per axis (1 to 256, default 64), and smoothness between landmarks (0 or more, default 1e-6).
   */
  void SetTolerance(double tolerance);
  double GetTolerance();
  void SetMaximumCells(int cells);
  int GetMaximumCells();
  void SetSmoothness(double smoothness);
  double GetSmoothness();
  ///@}

  ///@{
  /**
   * Residuals of the last fit, data units: the largest, and the root of the mean square; -1 before
   * a fit and after an error.
   */
  double GetMaximumError();
  double GetRootMeanSquareError();
  ///@}

protected:
  vtkFFDFitLandmarks();
  ~vtkFFDFitLandmarks() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestUpdateExtent(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkFFDFitLandmarks(const vtkFFDFitLandmarks&) = delete;
  void operator=(const vtkFFDFitLandmarks&) = delete;

  bool UpdateFit(bool report);

  vtkNew<vtkFFDFitLattice> Fit;
  vtkTimeStamp FitTime;
  double RegionBounds[6] = { 1.0, -1.0, 1.0, -1.0, 1.0, -1.0 }; ///< of the volume to deform
};

#endif
