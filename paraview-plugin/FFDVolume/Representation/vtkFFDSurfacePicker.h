// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDSurfacePicker
 * @brief   finds where a ray meets a surface that is shown moved by a lattice, and where that is at
 * rest
 *
 * For the pointer over slices, contours and other surfaces of a volume with a lattice. The cell
 * that is met is given by a selection, as ParaView makes it of what a pixel of the view shows.
 */
#ifndef vtkFFDSurfacePicker_h
#define vtkFFDSurfacePicker_h

#include "vtkFFDParaViewModule.h" // For export macro
#include "vtkObject.h"
#include "vtkSmartPointer.h" // for vtkSmartPointer

#include <array>  // for std::array
#include <string> // for std::string

class vtkAlgorithm;

class VTKFFDPARAVIEW_EXPORT vtkFFDSurfacePicker : public vtkObject
{
public:
  static vtkFFDSurfacePicker* New();
  vtkTypeMacro(vtkFFDSurfacePicker, vtkObject);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * What makes the surface at rest, and the selection of its cell.
   */
  void SetInput(vtkAlgorithm* input);
  void SetSelection(vtkAlgorithm* selection);
  ///@}

  ///@{
  /**
   * The ends of the ray, in world coordinates.
   */
  vtkSetVector3Macro(PointA, double);
  vtkSetVector3Macro(PointB, double);
  ///@}

  /**
   * The array whose value is asked for, null for none, and whether it is one of cells.
   */
  void SetArrayName(const char* name);
  vtkSetMacro(OfCells, bool);

  /**
   * Find it. To be called on all processes that have parts of the surface.
   */
  void Pick();

  /**
   * 1, or 0 if the surface has no lattice (and zeros); the place in the scene; its place at rest;
   * the value there, for several components their norm.
   */
  double* GetPicked() VTK_SIZEHINT(8);

protected:
  vtkFFDSurfacePicker();
  ~vtkFFDSurfacePicker() override;

private:
  vtkFFDSurfacePicker(const vtkFFDSurfacePicker&) = delete;
  void operator=(const vtkFFDSurfacePicker&) = delete;

  vtkSmartPointer<vtkAlgorithm> Input;
  vtkSmartPointer<vtkAlgorithm> Selection;
  double PointA[3] = { 0.0, 0.0, 0.0 };
  double PointB[3] = { 0.0, 0.0, 0.0 };
  std::string ArrayName;
  bool OfCells = false;
  std::array<double, 8> Picked{};
};

#endif
