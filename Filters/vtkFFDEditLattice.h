// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDEditLattice
 * @brief   attach a lattice to image data whose shape is given by plain values
 *
 * For applications that describe a pipeline by values alone, as ParaView does: everything that
 * defines the lattice is a number or an array of numbers, so that it can be saved in state files,
 * sent to servers and animated. The output is the input image, its arrays shared and not copied,
 * with the lattice in its field data (vtkFFDLattice::AttachTo()); what was attached before is
 * replaced. A vtkRectilinearGrid is taken as an image is. Of a multi-block or partitioned data set
 * (vtkDataObjectTree) all blocks get one lattice, that of their common bounds, or each one of its
 * own: SetLatticePerBlock(). So do those of an AMR, of which a multi-block data set is made. The
 * output has else the type of the input; GetOutput() is null where that is no image,
 * GetOutputDataObject(0) has it always. Several processes have one lattice, of the
 * bounds of all of them.
 *
 * The displacements of the control points are the sum of
 * - those of the lattice attached to the input, if there is one and UseInputLattice is on. The
 *   domain is then its domain, else that of the whole image enlarged by Padding;
 * - the Shape, as vtkFFDLatticeSource::ApplyShape();
 * - the edits, SetDisplacement().
 * The sum is scaled by DisplacementScale, and by that of the input's lattice where that is used.
 *
 * The edits are those of a lattice of EditDimensions control points over the same domain; when
 * Dimensions differs they are carried over, AddEdits(). So a change of the resolution does not lose
 * edits that say what they are meant for.
 *
 * RequestInformation already knows the lattice, and passes it down the pipeline under the key
 * LATTICE(): parallel consumers find out from it which part of the image they need. If the input
 * has a lattice in its data only (a file), that is known not before RequestData, and the key is
 * not set. The lattice covers the image as it is announced: where vtkDataObject::DIRECTION() is not
 * (VTK's filters do not pass it on), with the direction of the image that was there last, at first
 * with none. What RequestData attaches covers the image itself.
 *
 * @sa vtkFFDLattice vtkFFDLatticeSource vtkFFDDeformVolume
 */
#ifndef vtkFFDEditLattice_h
#define vtkFFDEditLattice_h

#include "vtkFFDFiltersModule.h" // For export macro
#include "vtkImageAlgorithm.h"
#include "vtkNew.h"       // for vtkNew
#include "vtkTimeStamp.h" // for vtkTimeStamp

#include <vector> // for std::vector

class vtkDataArray;
class vtkDataObject;
class vtkDoubleArray;
class vtkFFDLattice;
class vtkImageData;
class vtkInformationDataObjectMetaDataKey;

class VTKFFDFILTERS_EXPORT vtkFFDEditLattice : public vtkImageAlgorithm
{
public:
  static vtkFFDEditLattice* New();
  vtkTypeMacro(vtkFFDEditLattice, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Control points per axis, 4 to 64. Default 6, 6, 6.
   */
  void SetDimensions(int nx, int ny, int nz);
  void SetDimensions(const int dimensions[3]);
  vtkGetVector3Macro(Dimensions, int);
  ///@}

  ///@{
  /**
   * Margin that is added to the bounds of the image on each side, as a fraction of the extent, 0 to
   * 10. Default 0. Not used with a lattice of the input.
   */
  void SetPadding(double padding);
  vtkGetMacro(Padding, double);
  ///@}

  ///@{
  /**
   * Whether the lattice attached to the input is where the new one starts from. Default on.
   */
  vtkSetMacro(UseInputLattice, vtkTypeBool);
  vtkGetMacro(UseInputLattice, vtkTypeBool);
  vtkBooleanMacro(UseInputLattice, vtkTypeBool);
  ///@}

  ///@{
  /**
   * One of vtkFFDLatticeSource::ShapeType. Default IDENTITY.
   */
  void SetShape(int shape);
  vtkGetMacro(Shape, int);
  ///@}

  ///@{
  /**
   * Strength of the shape, finite. Default 1.
   */
  void SetStrength(double strength);
  vtkGetMacro(Strength, double);
  ///@}

  ///@{
  /**
   * Seed of the shape RANDOM, 1 to 2147483646. Default 1.
   */
  vtkSetClampMacro(Seed, int, 1, 2147483646);
  vtkGetMacro(Seed, int);
  ///@}

  ///@{
  /**
   * Border mode of the lattice: VTK_BSPLINE_EDGE, _ZERO, _ZERO_AT_BORDER. Not used with a lattice
   * of the input. Default: VTK_BSPLINE_EDGE.
   */
  vtkSetClampMacro(BorderMode, int, 0, 2);
  vtkGetMacro(BorderMode, int);
  ///@}

  ///@{
  /**
   * Factor on the deformation as a whole, finite: 0 is none. Default 1.
   */
  void SetDisplacementScale(double scale);
  vtkGetMacro(DisplacementScale, double);
  ///@}

  ///@{
  /**
   * Edits: displacement of control point `index` = i + nx * (j + ny * k), data units, nx and ny of
   * EditDimensions, or of Dimensions where there are as many as that has control points and not as
   * many as EditDimensions. Another number than 0, none at all, is an error when the filter
   * executes, and the edits are not used. Displacements that are not finite are refused. Default:
   * 0.
   */
  void SetNumberOfDisplacements(int count);
  int GetNumberOfDisplacements() const;
  void SetDisplacement(int index, double dx, double dy, double dz);
  void GetDisplacement(int index, double displacement[3]) const;
  /**
   * All of them by one call: an array of three components. Returns 1, or 0 after an error, when it
   * is null, has another shape, or holds what is not finite; the edits are then left as they were.
   */
  int SetDisplacements(vtkDataArray* displacements);
  void RemoveAllDisplacements() { this->SetNumberOfDisplacements(0); }
  ///@}

  ///@{
  /**
   * Control points per axis that the edits are meant for, 4 to 64 each, or 0, 0, 0 (default):
   * those of Dimensions.
   */
  void SetEditDimensions(int nx, int ny, int nz);
  void SetEditDimensions(const int dimensions[3]);
  vtkGetVector3Macro(EditDimensions, int);
  ///@}

#ifndef __VTK_WRAP__
  /**
   * Adds edits that are meant for a lattice of `editDimensions` control points to `lattice`, as
   * this filter does: carried over as vtkFFDLattice::SetDimensions() does, exactly where the cells
   * of one divide those of the other. Edits of another number are those of the lattice itself, or,
   * if it has not as many control points, of none: returns false, and the lattice stays as it was.
   */
  static bool AddEdits(
    const std::vector<double>& edits, const int editDimensions[3], vtkFFDLattice* lattice);
#endif

  ///@{
  /**
   * Whether each block of a composite data set gets a lattice of its own, over its own bounds, with
   * the same shape and edits; off (default): one lattice is over the bounds of all blocks. What
   * GetLattice() and the like tell is then of the last block. Parts of a block that several
   * processes have, at the same place of the data set, get one lattice. Not used with other data.
   */
  vtkSetMacro(LatticePerBlock, vtkTypeBool);
  vtkGetMacro(LatticePerBlock, vtkTypeBool);
  vtkBooleanMacro(LatticePerBlock, vtkTypeBool);
  ///@}

  /// Modes of showing surfaces of the data in applications that move them by the lattice.
  enum GeometryModes
  {
    FIRST_ORDER, ///< as vtkFFDDeformGeometry's mode of that name, and the next two as well
    EXACT,
    PULL_BACK,
    AT_REST ///< not moved
  };

  ///@{
  /**
   * Set/Get the mode of showing surfaces of the output, and of the output of filters on it: the
   * same as InverseMode of the mapper of the volume. Default: EXACT. Another mode is attached to
   * the output as field data "FFDGeometryMode" (int), which filters pass on; GetGeometryModeOf()
   * reads it, EXACT where there is none or none that is valid.
   */
  vtkSetClampMacro(GeometryMode, int, FIRST_ORDER, AT_REST);
  vtkGetMacro(GeometryMode, int);
  static int GetGeometryModeOf(vtkDataObject* data);
  ///@}

  /**
   * The lattice of the last update. It belongs to the filter: edits are overwritten.
   */
  vtkFFDLattice* GetLattice();

  ///@{
  /**
   * Facts about the lattice of the last update, for display: the number of control points per axis,
   * the domain (xmin, xmax, ymin, ...), the bounds at rest of the data that it deforms, and a
   * proven lower bound of the local change of volume; zero or less means that the deformation may
   * fold (vtkFFDLattice::GetMinimumJacobianBound()).
   */
  int* GetLatticeDimensions() VTK_SIZEHINT(3);
  double* GetLatticeDomain() VTK_SIZEHINT(6);
  vtkGetVector6Macro(DataBounds, double);
  double GetMinimumJacobianBound();
  ///@}

  ///@{
  /**
   * Results of the last update that editors need: the displacements that the edits are
   * added to (those of the input's lattice and of the shape), 3 components, as many tuples as
   * GetLatticeDimensions() has control points; and the DisplacementScale of the lattice, that of
   * the input's included. The array belongs to the filter.
   */
  vtkDoubleArray* GetBaseDisplacements();
  double GetLatticeDisplacementScale();
  ///@}

  /**
   * In the pipeline information of the output: the lattice as vtkFFDLattice::ToImageData() makes
   * it.
   */
  static vtkInformationDataObjectMetaDataKey* LATTICE();

  /// Overridden so that data that do not fit into the memory are an error, not an exception.
  vtkTypeBool ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

protected:
  vtkFFDEditLattice();
  ~vtkFFDEditLattice() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

private:
  vtkFFDEditLattice(const vtkFFDEditLattice&) = delete;
  void operator=(const vtkFFDEditLattice&) = delete;

  bool SetFinite(const char* name, double& member, double value);
  void SetSizes(const char* name, int member[3], const int sizes[3], bool zeroAllowed);
  bool MakeLattice(const double bounds[6], vtkFFDLattice* inputLattice, bool report);
  void MakeOutput(vtkInformationVector** inputs, vtkInformationVector* outputs);
  bool Attach(vtkDataObject* input, const double bounds[6], vtkDataObject* output);
  int RequestBlocks(vtkDataObject* input, vtkDataObject* output);

  vtkNew<vtkFFDLattice> Lattice;
  vtkNew<vtkFFDLattice> BaseLattice; // without the edits
  int Dimensions[3] = { 6, 6, 6 };
  double Padding = 0.0;
  vtkTypeBool UseInputLattice = 1;
  int Shape = 0;
  double Strength = 1.0;
  int Seed = 1;
  int BorderMode = 0;
  double DisplacementScale = 1.0;
  std::vector<double> Displacements;
  double DataBounds[6] = { 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 };
  vtkTimeStamp MadeTime; // of the lattices, by DataBounds alone; 0: by a lattice of the input
  int EditDimensions[3] = { 0, 0, 0 };
  vtkTypeBool LatticePerBlock = 0;
  int GeometryMode = EXACT;
};

#endif
