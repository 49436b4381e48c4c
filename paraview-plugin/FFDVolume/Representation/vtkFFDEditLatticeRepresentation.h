// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDEditLatticeRepresentation
 * @brief   the lattice of vtkFFDEditLattice in the scene, described by plain values
 *
 * The representation of the lattice widget in ParaView. What it shows and edits is given as
 * vtkFFDEditLattice's lattice is: dimensions, domain, the displacements that the edits are added
 * to (vtkFFDEditLattice::GetBaseDisplacements()), and the edits themselves. So the properties of a
 * server manager proxy can be pushed to it one by one, on the client and on the render server;
 * UpdateLattice(), called after each push, puts them together. Values that do not fit together
 * (numbers of control points that differ while only some have been pushed) are taken for zeros.
 *
 * The lattice of the superclass belongs to this class: SetLattice() is not to be called.
 *
 * GetEdits() gives the edits back, with what the user has dragged. As long as nothing was dragged
 * they are exactly what was set, also when those were meant for other dimensions; when all are
 * zero there are none.
 *
 * @sa vtkFFDEditLattice vtkFFDLatticeWidget
 */
#ifndef vtkFFDEditLatticeRepresentation_h
#define vtkFFDEditLatticeRepresentation_h

#include "vtkFFDLatticeRepresentation.h"
#include "vtkFFDParaViewModule.h" // For export macro
#include "vtkNew.h"               // for vtkNew

#include <vector> // for std::vector

class vtkDataArray;
class vtkDoubleArray;

class VTKFFDPARAVIEW_EXPORT vtkFFDEditLatticeRepresentation : public vtkFFDLatticeRepresentation
{
public:
  static vtkFFDEditLatticeRepresentation* New();
  vtkTypeMacro(vtkFFDEditLatticeRepresentation, vtkFFDLatticeRepresentation);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Control points per axis, 4 to 64, default 6, 6, 6; and the domain, data coordinates, default
   * the unit cube. Other values are errors and change nothing.
   */
  void SetDimensions(int nx, int ny, int nz);
  vtkGetVector3Macro(Dimensions, int);
  void SetDomain(double xmin, double xmax, double ymin, double ymax, double zmin, double zmax);
  vtkGetVector6Macro(Domain, double);
  ///@}

  ///@{
  /**
   * Set the displacements that the edits are added to, of a lattice of BaseDimensions control
   * points, x fastest, and the factor on the deformation as a whole. Defaults: none, 1. Arrays that
   * are too long, have not three components or hold what is not finite are errors and change
   * nothing.
   */
  void SetBaseDimensions(int nx, int ny, int nz);
  vtkGetVector3Macro(BaseDimensions, int);
  void SetBaseDisplacements(vtkDataArray* displacements);
  void SetDisplacementScale(double scale);
  vtkGetMacro(DisplacementScale, double);
  ///@}

  ///@{
  /**
   * The edits as vtkFFDEditLattice takes them; dimensions 0, 0, 0 mean those of the lattice.
   */
  void SetEditDimensions(int nx, int ny, int nz);
  void SetDisplacements(vtkDataArray* displacements);
  ///@}

  ///@{
  /**
   * The edits as they are now, three numbers a control point and as many as GetEditDimensions()
   * says; empty when there are none.
   */
  vtkDoubleArray* GetEdits();
  int* GetEditDimensions() VTK_SIZEHINT(3);
  ///@}

  /// No edits any more: the base is left. Empties the history. Returns 1 if something changed.
  int ResetEdits();

  ///@{
  /**
   * The selection as plain numbers, so that a render server shows it. Bad indices are left out.
   */
  void SetSelection(vtkDataArray* points);
  vtkDoubleArray* GetSelection();
  ///@}

  /// Put together what was set.
  void UpdateLattice();

  void BuildRepresentation() override;

  /**
   * On a render server with room for the handles, whose size is in pixels: processes draw only what
   * is in the bounds of all that is visible. Elsewhere without, as the camera is reset by them.
   */
  double* GetBounds() VTK_SIZEHINT(6) override;

protected:
  vtkFFDEditLatticeRepresentation();
  ~vtkFFDEditLatticeRepresentation() override;

private:
  vtkFFDEditLatticeRepresentation(const vtkFFDEditLatticeRepresentation&) = delete;
  void operator=(const vtkFFDEditLatticeRepresentation&) = delete;

  void SetSizes(const char* name, int member[3], const int sizes[3], bool zeroAllowed);
  void SetVectors(const char* name, std::vector<double>& values, vtkDataArray* vectors);
  bool IsEdited();

  int Dimensions[3] = { 6, 6, 6 };
  double Domain[6] = { 0.0, 1.0, 0.0, 1.0, 0.0, 1.0 };
  int BaseDimensions[3] = { 6, 6, 6 };
  std::vector<double> Base;
  double DisplacementScale = 1.0;
  int EditDimensions[3] = { 0, 0, 0 };
  std::vector<double> Edits; // as set
  std::vector<double> Selected;
  bool LatticeIsStale = true;
  bool SelectionIsStale = false;

  std::vector<double> BaseHere;       // of the dimensions of the lattice
  std::vector<double> Composed;       // what UpdateLattice() made the displacements
  std::vector<double> LastReported;   // what GetEdits() gave last, when something was edited,
  std::vector<double> ReportedValues; // and what the displacements were then
  double BoundsWithHandles[6] = { 1.0, -1.0, 1.0, -1.0, 1.0, -1.0 };
  vtkNew<vtkDoubleArray> EditArray;
  vtkNew<vtkDoubleArray> SelectionArray;
};

#endif
