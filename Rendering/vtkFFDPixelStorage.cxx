// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFFDPixelStorage.h"

#include "vtkFFDVersions.h"

#include VTK_FFD_OPENGL_HEADER

#include <cstddef>

//------------------------------------------------------------------------------
struct vtkFFDPixelStorage::NameSet
{
  std::array<GLenum, 5> Parameters; ///< first the alignment and the width of rows
  GLenum Target;
  GLenum Binding;
};

//------------------------------------------------------------------------------
const vtkFFDPixelStorage::NameSet& vtkFFDPixelStorage::FindNames(Direction direction)
{
  static constexpr NameSet ForReading = { { GL_PACK_ALIGNMENT, GL_PACK_ROW_LENGTH,
                                            GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS,
                                            GL_PACK_SWAP_BYTES },
    GL_PIXEL_PACK_BUFFER, GL_PIXEL_PACK_BUFFER_BINDING };
  static constexpr NameSet ForUploads = { { GL_UNPACK_ALIGNMENT, GL_UNPACK_ROW_LENGTH,
                                            GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS,
                                            GL_UNPACK_SWAP_BYTES },
    GL_PIXEL_UNPACK_BUFFER, GL_PIXEL_UNPACK_BUFFER_BINDING };
  return direction == Read ? ForReading : ForUploads;
}

//------------------------------------------------------------------------------
vtkFFDPixelStorage::vtkFFDPixelStorage(Direction direction, int width)
  : Names(FindNames(direction))
{
  for (std::size_t i = 0; i < this->Values.size(); ++i)
  {
    glGetIntegerv(this->Names.Parameters[i], &this->Values[i]);
    glPixelStorei(this->Names.Parameters[i], i == 0 ? 1 : i == 1 ? width : 0);
  }
  glGetIntegerv(this->Names.Binding, &this->Buffer);
  glBindBuffer(this->Names.Target, 0);
}

//------------------------------------------------------------------------------
vtkFFDPixelStorage::~vtkFFDPixelStorage()
{
  for (std::size_t i = 0; i < this->Values.size(); ++i)
  {
    glPixelStorei(this->Names.Parameters[i], this->Values[i]);
  }
  glBindBuffer(this->Names.Target, static_cast<GLuint>(this->Buffer));
}
