// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkFFDFinalColors
 * @brief   window and level of the colors of a picture
 *
 * Private to this module: not installed, not wrapped. See FinalColorWindow and FinalColorLevel of
 * vtkVolumeMapper.
 */
#ifndef vtkFFDFinalColors_h
#define vtkFFDFinalColors_h

#include "vtkFFDFrameCoherence.h"

namespace ffd
{
struct CastImage;
}

class vtkFFDFinalColors
{
public:
  vtkFFDFinalColors() = default;
  vtkFFDFinalColors(double window, double level)
    : Window(window)
    , Level(level)
  {
  }

  /// Change the premultiplied colors of a tile that has been cast.
  void Apply(const ffd::CastImage& image, const vtkFFDFrameCoherence::Part& tile) const;

private:
  double Window = 1.0;
  double Level = 0.5;
};

#endif
