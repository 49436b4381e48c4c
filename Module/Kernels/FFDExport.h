// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDExport_h
#define FFDExport_h

/// Visibility of kernel symbols that another library of this project or a test calls. Kernels do
/// not include VTK's generated export headers.
#if defined(_WIN32)
#if defined(FFD_BUILDING_KERNELS)
#define FFD_KERNEL_EXPORT __declspec(dllexport)
#else
#define FFD_KERNEL_EXPORT __declspec(dllimport)
#endif
#else
#define FFD_KERNEL_EXPORT __attribute__((visibility("default")))
#endif

#endif
