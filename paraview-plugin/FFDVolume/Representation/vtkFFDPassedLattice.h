// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkFFDPassedLattice.h
 * Lattices for the output of ParaView's filters that drop those of their inputs. Private to this
 * module.
 */
#ifndef vtkFFDPassedLattice_h
#define vtkFFDPassedLattice_h

class vtkAlgorithm;

namespace ffdpassing
{

/**
 * Give what a filter makes the field data of its first input, and with them the lattice. Where the
 * filter interpolates between steps in time, the lattice is interpolated, too. One that makes a
 * data set of several parts warns of different lattices instead.
 */
void Follow(vtkAlgorithm* filter);

} // namespace ffdpassing

#endif
