// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this module: not installed, not wrapped.
#ifndef vtkFFDSceneState_h
#define vtkFFDSceneState_h

#include "vtkType.h"

#include <utility>
#include <vector>

class vtkRenderer;
class vtkRenderWindow;

/**
 * What a picture is made from: the objects, each with its modification time, and numbers, each with
 * the object that it belongs to. Two states are equal where nothing has changed between them. The
 * latest of the times would not tell that: an object that takes the place of another one, or stays
 * when another one goes, may be older.
 */
using vtkFFDSceneState = std::vector<std::pair<const void*, vtkMTimeType>>;

/// Add the camera and the lights of a renderer, and how it lights: what rays and colors of its
/// volumes depend on.
void vtkFFDAddView(vtkRenderer* renderer, vtkFFDSceneState& state);

/// All that a window shows. Brings the inputs of what is visible up to date.
vtkFFDSceneState vtkFFDFindSceneState(vtkRenderWindow* window);

#endif
