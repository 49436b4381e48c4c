// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDExport_h
#define FFDExport_h

/// Visibility of kernel symbols that another library of this project or a test calls. Kernels do
/// not include VTK's generated export headers. Each module has a macro of its own, because on
/// Windows a library exports its own kernels and imports those of others: FFD_BUILDING_<MODULE> is
/// defined while the module is compiled.
#if defined(_WIN32)
#define FFD_EXPORTED __declspec(dllexport)
#define FFD_IMPORTED __declspec(dllimport)
#else
#define FFD_EXPORTED __attribute__((visibility("default")))
#define FFD_IMPORTED FFD_EXPORTED
#endif

#if defined(FFD_BUILDING_CORE)
#define FFD_CORE_EXPORT FFD_EXPORTED
#else
#define FFD_CORE_EXPORT FFD_IMPORTED
#endif

#if defined(FFD_BUILDING_VOLUMES)
#define FFD_VOLUMES_EXPORT FFD_EXPORTED
#else
#define FFD_VOLUMES_EXPORT FFD_IMPORTED
#endif

#if defined(FFD_BUILDING_FILTERS)
#define FFD_FILTERS_EXPORT FFD_EXPORTED
#else
#define FFD_FILTERS_EXPORT FFD_IMPORTED
#endif

#if defined(FFD_BUILDING_IO)
#define FFD_IO_EXPORT FFD_EXPORTED
#else
#define FFD_IO_EXPORT FFD_IMPORTED
#endif

#if defined(FFD_BUILDING_PHYSICS)
#define FFD_PHYSICS_EXPORT FFD_EXPORTED
#else
#define FFD_PHYSICS_EXPORT FFD_IMPORTED
#endif

#if defined(FFD_BUILDING_RENDERING)
#define FFD_RENDERING_EXPORT FFD_EXPORTED
#else
#define FFD_RENDERING_EXPORT FFD_IMPORTED
#endif

#if defined(FFD_BUILDING_WIDGETS)
#define FFD_WIDGETS_EXPORT FFD_EXPORTED
#else
#define FFD_WIDGETS_EXPORT FFD_IMPORTED
#endif

#endif
