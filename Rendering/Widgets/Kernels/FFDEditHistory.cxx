// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDEditHistory.h"

#include <utility>

namespace ffd
{

//------------------------------------------------------------------------------
std::size_t LatticeEdit::GetMemorySize() const
{
  return sizeof(LatticeEdit) + this->Name.capacity() +
    this->Nodes.capacity() * sizeof(std::size_t) +
    (this->Before.capacity() + this->After.capacity()) * sizeof(glm::dvec3);
}

//------------------------------------------------------------------------------
void EditHistory::SetMemoryLimit(std::size_t bytes)
{
  this->MemoryLimit = bytes;
  this->Trim();
}

//------------------------------------------------------------------------------
void EditHistory::Add(LatticeEdit edit)
{
  while (this->Edits.size() > this->Position)
  {
    this->MemorySize -= this->Edits.back().GetMemorySize();
    this->Edits.pop_back();
  }
  edit.Nodes.shrink_to_fit();
  edit.Before.shrink_to_fit();
  edit.After.shrink_to_fit();
  this->MemorySize += edit.GetMemorySize();
  this->Edits.push_back(std::move(edit));
  ++this->Position;
  this->Trim();
}

//------------------------------------------------------------------------------
const LatticeEdit* EditHistory::Undo()
{
  return this->Position > 0 ? &this->Edits[--this->Position] : nullptr;
}

//------------------------------------------------------------------------------
const LatticeEdit* EditHistory::Redo()
{
  return this->Position < this->Edits.size() ? &this->Edits[this->Position++] : nullptr;
}

//------------------------------------------------------------------------------
void EditHistory::Clear()
{
  this->Edits.clear();
  this->Position = 0;
  this->MemorySize = 0;
}

//------------------------------------------------------------------------------
void EditHistory::Trim()
{
  while (this->MemorySize > this->MemoryLimit)
  {
    if (this->Position == 0)
    {
      // The edits that are left were undone: without the first one the others cannot be redone.
      this->Clear();
      return;
    }
    this->MemorySize -= this->Edits.front().GetMemorySize();
    this->Edits.pop_front();
    --this->Position;
  }
}

} // namespace ffd
