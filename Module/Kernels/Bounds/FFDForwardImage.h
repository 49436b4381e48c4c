// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDForwardImage_h
#define FFDForwardImage_h

#include "Bounds/FFDBox.h"

#include "FFDBSplineField.h"

namespace ffd
{

/// The bounds of the image of `region` under T, tight: the sub-cells of the region are cut to it,
/// and the Bezier coefficients of X + D(X) over each bound what it reaches.
Box FindForwardImage(const BSplineField& field, const Box& region);

} // namespace ffd

#endif
