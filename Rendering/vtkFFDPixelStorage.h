// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDPixelStorage
 * @brief   how OpenGL finds pixels in memory, for as long as it lives
 *
 * Private to this module: not installed, not wrapped. Whoever else draws in the context may have
 * left it otherwise, or have bound a buffer that pixels would go to.
 */
#ifndef vtkFFDPixelStorage_h
#define vtkFFDPixelStorage_h

#include <array>

class vtkFFDPixelStorage
{
public:
  enum Direction
  {
    Read,
    Upload
  };
  /// Rows of `width` pixels (0: those that are transferred), without gaps.
  explicit vtkFFDPixelStorage(Direction direction, int width = 0);
  ~vtkFFDPixelStorage();
  vtkFFDPixelStorage(const vtkFFDPixelStorage&) = delete;
  void operator=(const vtkFFDPixelStorage&) = delete;

private:
  struct NameSet;
  static const NameSet& FindNames(Direction direction);

  const NameSet& Names;
  std::array<int, 5> Values{};
  int Buffer = 0;
};

#endif
