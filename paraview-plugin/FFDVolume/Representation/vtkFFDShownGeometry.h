// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDShownGeometry
 * @brief   surfaces of data with a lattice, moved before they are rendered
 *
 * ParaView's filters pass the field data of their input on, and with them the lattice: slices,
 * contours and clips of a volume with a lattice have it, too. This filter stands between what
 * ParaView's representations make for rendering (surface, outline, points, feature edges, glyph
 * positions, the highlight of a selection) and their mappers, and moves the points to where FFD
 * Volume shows what lies there: as vtkFFDDeformGeometry does, with the mode of GetMode(). Arrays
 * stay as they are, normals are turned. Lines of outlines are cut, so that they bend. Data without
 * a lattice pass.
 *
 * @sa vtkFFDDeformGeometry vtkFFDEditLattice vtkSIFFDAttachment
 */
#ifndef vtkFFDShownGeometry_h
#define vtkFFDShownGeometry_h

#include "vtkPassInputTypeAlgorithm.h"

class vtkObjectBase;
class vtkPolyData;

class vtkFFDShownGeometry : public vtkPassInputTypeAlgorithm
{
public:
  static vtkFFDShownGeometry* New();
  vtkTypeMacro(vtkFFDShownGeometry, vtkPassInputTypeAlgorithm);

  /// The algorithm whose output is the input: its own input has the lattice.
  void SetMaker(vtkAlgorithm* maker) { this->Maker = maker; }

  /**
   * Let one of ParaView's representations of surfaces or of selections show what it shows where the
   * lattice of its data moves it to, or a data axes grid be around that. What takes places from
   * the picture, or probes at places, works with what is shown there (vtkFFDShownPlaces.h). Other
   * filters are made to give their output the lattice (vtkFFDPassedLattice.h).
   */
  static void Follow(vtkObjectBase* object);

  /// Lines of two points become lines of many, so that they can bend; cells and their arrays stay.
  static void CutLines(vtkPolyData* outline);

protected:
  vtkFFDShownGeometry() = default;
  ~vtkFFDShownGeometry() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkFFDShownGeometry(const vtkFFDShownGeometry&) = delete;
  void operator=(const vtkFFDShownGeometry&) = delete;

  vtkAlgorithm* Maker = nullptr;
};

#endif
