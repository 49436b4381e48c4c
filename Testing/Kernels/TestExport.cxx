// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The macros of FFDExport.h as they are on Windows, while FFD::Rendering is compiled.
#ifndef _WIN32
#define _WIN32 1
#define FFD_NOT_WINDOWS
#endif
#define FFD_BUILDING_RENDERING
#include "FFDExport.h"
#ifdef FFD_NOT_WINDOWS
#undef _WIN32
#endif

#include <gtest/gtest.h>

#define FFD_TEXT_OF(macro) FFD_TEXT(macro)
#define FFD_TEXT(text) #text

TEST(Export, AModuleExportsItsOwnKernelsAndImportsThoseOfOthers)
{
  EXPECT_STREQ(FFD_TEXT_OF(FFD_RENDERING_EXPORT), "__declspec(dllexport)");
  EXPECT_STREQ(FFD_TEXT_OF(FFD_CORE_EXPORT), "__declspec(dllimport)");
  EXPECT_STREQ(FFD_TEXT_OF(FFD_VOLUMES_EXPORT), "__declspec(dllimport)");
}
