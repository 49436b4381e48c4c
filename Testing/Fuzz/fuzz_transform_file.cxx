// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer target for the parsers of transform files; see README.md in this folder.
#include "FFDFuzzTransformFile.h"

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  FFDFuzzTransformFile({ reinterpret_cast<const char*>(data), size });
  return 0;
}
