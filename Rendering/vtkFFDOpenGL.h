// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Private to this library: the OpenGL functions and names that VTK was built with.
#ifndef vtkFFDOpenGL_h
#define vtkFFDOpenGL_h

#include "vtkVersionMacros.h" // For VTK_VERSION_NUMBER

// VTK 9.4 loads OpenGL with glad instead of glew.
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 4, 0)
#include "vtk_glad.h"
#else
#include "vtk_glew.h"
#endif

#endif
