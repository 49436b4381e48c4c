// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDScalarDispatch_h
#define FFDScalarDispatch_h

#include "FFDVolumeView.h"

#include <cstdint>

namespace ffd
{

/// Call `function(T{})` with the C++ type that `type` stands for.
template <class Function>
auto DispatchScalarType(ScalarType type, Function&& function)
{
  switch (type)
  {
    case ScalarType::Int8:
      return function(std::int8_t{});
    case ScalarType::Int16:
      return function(std::int16_t{});
    case ScalarType::UInt16:
      return function(std::uint16_t{});
    case ScalarType::Int32:
      return function(std::int32_t{});
    case ScalarType::UInt32:
      return function(std::uint32_t{});
    case ScalarType::Int64:
      return function(std::int64_t{});
    case ScalarType::UInt64:
      return function(std::uint64_t{});
    case ScalarType::Float32:
      return function(float{});
    case ScalarType::Float64:
      return function(double{});
    case ScalarType::UInt8:
    default:
      return function(std::uint8_t{});
  }
}

} // namespace ffd

#endif
