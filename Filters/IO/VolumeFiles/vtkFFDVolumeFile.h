// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file    vtkFFDVolumeFile.h
 * @brief   interface to a file of a volume: VTK's reader of it, and what this reader leaves out
 *
 * Private to this module: not installed, not wrapped. A source file beside this one implements it
 * for each format, with a function Open() that returns null for files of other formats.
 */
#ifndef vtkFFDVolumeFile_h
#define vtkFFDVolumeFile_h

#include "vtkFFDStoredVoxels.h"

#include "vtkAlgorithm.h"
#include "vtkCommand.h"
#include "vtkSmartPointer.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <optional>
#include <string>

class vtkImageData;
class vtkPointData;

/// Files that vtkImageReader2Factory knows, as they come; derived classes know more of theirs. A
/// problem is a sentence without its full stop, an empty text is none.
class vtkFFDVolumeFile
{
public:
  /// Position of voxel (0, 0, 0), and the steps from voxel to voxel, LPS.
  struct Placement
  {
    glm::dvec3 Origin{ 0.0 };
    glm::dmat3 Steps{ 1.0 };

    /// LPS has x and y the other way round.
    static inline const glm::dvec3 FromRas{ -1.0, -1.0, 1.0 };

    /// Whether the origin is finite, and the steps have directions of three axes.
    bool IsValid() const;
  };

  /// What the numbers of a file mean: Slope times what is stored, plus Intercept.
  struct Scaling
  {
    double Slope = 1.0;
    double Intercept = 0.0;
    int Type = VTK_FLOAT;

    bool IsNone() const { return this->Slope == 1.0 && this->Intercept == 0.0; }

    /// Sets the scalars that are meant in the place of those that are stored.
    void Apply(vtkPointData* data) const;
  };

  /// What a file says of its voxels.
  struct Header
  {
    std::array<int, 3> Size{ { 0, 0, 0 } };
    glm::dvec3 Spacing{ 1.0 };      ///< as VTK's reader has it
    std::optional<Placement> Place; ///< none: that of VTK's reader
    Scaling Scales;
    vtkFFDStoredVoxels Stored;
    std::string Warning;
  };

  /// VTK's reader has the path already; `errors` is to hear of its errors and warnings.
  vtkFFDVolumeFile(const std::string& path, vtkAlgorithm* reader, vtkCommand* errors);
  virtual ~vtkFFDVolumeFile() = default;
  vtkFFDVolumeFile(const vtkFFDVolumeFile&) = delete;
  void operator=(const vtkFFDVolumeFile&) = delete;

  vtkAlgorithm* GetReader() const { return this->Reader; }

  /// Finds what the reader would hang on or crash of, before it opens the file.
  virtual std::string FindProblem() const { return std::string(); }

  /// Fills in the header and returns its problem, after UpdateInformation() of the reader.
  std::string ReadHeader(Header& header) const;

  /// The problem that an error of the reader in UpdateInformation() or ReadHeader() means.
  virtual std::string Explain(const std::string& error) const;

  /// The image; an error that the reader does not tell of goes into `error`.
  virtual vtkSmartPointer<vtkImageData> Read(const Header& header, std::string& error) const;

  /// The last extension of a path, in small letters.
  static std::string FindEnding(const std::string& path);

protected:
  /// Parts of ReadHeader(), which fill in the header and return its problem: the first comes before
  /// the size, which is VTK's, is checked and may replace it; the second is to place the voxels.
  virtual std::string FindVoxels(Header&) const { return std::string(); }
  virtual std::string FindPlacement(Header&) const { return std::string(); }

  /// Bytes of all voxels, uncompressed; the reader is a vtkImageReader2.
  double CountBytes(const Header& header) const;

  /// Lets errors and warnings of a reader be heard.
  void Watch(vtkAlgorithm* reader) const;

  const std::string Path;

private:
  const vtkSmartPointer<vtkAlgorithm> Reader;
  const vtkSmartPointer<vtkCommand> Errors;
};

#endif
