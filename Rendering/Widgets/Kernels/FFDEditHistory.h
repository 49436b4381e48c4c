// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDEditHistory_h
#define FFDEditHistory_h

#include "FFDExport.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <deque>
#include <string>
#include <vector>

namespace ffd
{

/// The changes of an edit: the displacements of some control points, before and after.
struct FFD_WIDGETS_EXPORT LatticeEdit
{
  std::string Name;
  std::vector<std::size_t> Nodes;
  std::vector<glm::dvec3> Before;
  std::vector<glm::dvec3> After;

  std::size_t GetMemorySize() const;
};

/**
 * Edits that can be undone and redone, any number within a bound of memory: the oldest go first.
 * An edit that is larger than the bound cannot be undone, nor can those before it.
 */
class FFD_WIDGETS_EXPORT EditHistory
{
public:
  /// Bytes; 64 MiB by default.
  void SetMemoryLimit(std::size_t bytes);
  std::size_t GetMemoryLimit() const { return this->MemoryLimit; }
  std::size_t GetMemorySize() const { return this->MemorySize; }

  /// Append an edit; those that were undone are forgotten.
  void Add(LatticeEdit edit);

  std::size_t GetNumberOfUndos() const { return this->Position; }
  std::size_t GetNumberOfRedos() const { return this->Edits.size() - this->Position; }

  /// The edit to take back, null if there is none; it is the next to redo from then on.
  const LatticeEdit* Undo();
  /// The edit to do again, or null.
  const LatticeEdit* Redo();

  void Clear();

private:
  void Trim();

  std::deque<LatticeEdit> Edits;
  std::size_t Position = 0; // edits before it are done, the others undone
  std::size_t MemoryLimit = std::size_t(64) << 20;
  std::size_t MemorySize = 0;
};

} // namespace ffd

#endif
