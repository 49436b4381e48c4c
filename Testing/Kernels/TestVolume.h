// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef TestVolume_h
#define TestVolume_h

#include "FFDMinMaxBlocks.h"
#include "FFDScalarDispatch.h"
#include "FFDTransferTable.h"
#include "FFDVolumeView.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

constexpr ffd::ScalarType AllScalarTypes[] = { ffd::ScalarType::Int8, ffd::ScalarType::UInt8,
  ffd::ScalarType::Int16, ffd::ScalarType::UInt16, ffd::ScalarType::Int32, ffd::ScalarType::UInt32,
  ffd::ScalarType::Int64, ffd::ScalarType::UInt64, ffd::ScalarType::Float32,
  ffd::ScalarType::Float64 };

/// A volume that owns its voxels, of any scalar type; `stride` elements lie between neighbors
/// along x, as for one component of several.
class TestVolume
{
public:
  using Function = std::function<double(int i, int j, int k)>;

  TestVolume(
    ffd::ScalarType type, const glm::ivec3& dimensions, const Function& function, int stride = 1)
  {
    this->View.Type = type;
    this->View.Dimensions = dimensions;
    this->View.Increments[0] = stride;
    this->View.Increments[1] = static_cast<std::int64_t>(stride) * dimensions.x;
    this->View.Increments[2] = this->View.Increments[1] * dimensions.y;
    // Doubles are large enough, and aligned, for every type.
    this->Storage.assign(static_cast<std::size_t>(this->View.Increments[2]) * dimensions.z, 0.0);
    this->View.Scalars = this->Storage.data();
    this->Fill(function);
  }
  TestVolume(const TestVolume&) = delete;
  TestVolume& operator=(const TestVolume&) = delete;

  void Fill(const Function& function)
  {
    ffd::DispatchScalarType(this->View.Type, [&](auto zero) {
      using T = decltype(zero);
      T* scalars = reinterpret_cast<T*>(this->Storage.data());
      this->ForEach([&](int i, int j, int k) {
        scalars[this->Offset(i, j, k)] = static_cast<T>(function(i, j, k));
      });
    });
  }

  double At(int i, int j, int k) const
  {
    return ffd::DispatchScalarType(this->View.Type, [&](auto zero) {
      using T = decltype(zero);
      return static_cast<double>(
        reinterpret_cast<const T*>(this->Storage.data())[this->Offset(i, j, k)]);
    });
  }

  /// Trilinear interpolation, written out from the eight corners: the oracle of the samplers.
  double Interpolate(const glm::dvec3& q) const
  {
    double sum = 0.0;
    glm::ivec3 c;
    for (int a = 0; a < 3; ++a)
    {
      c[a] = std::min(static_cast<int>(std::floor(q[a])), this->View.Dimensions[a] - 2);
    }
    for (int corner = 0; corner < 8; ++corner)
    {
      const glm::ivec3 at = c + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
      double weight = 1.0;
      for (int a = 0; a < 3; ++a)
      {
        weight *= 1.0 - std::abs(q[a] - at[a]);
      }
      sum += weight * this->At(at.x, at.y, at.z);
    }
    return sum;
  }

  template <class F>
  void ForEach(const F& function) const
  {
    for (int k = 0; k < this->View.Dimensions.z; ++k)
    {
      for (int j = 0; j < this->View.Dimensions.y; ++j)
      {
        for (int i = 0; i < this->View.Dimensions.x; ++i)
        {
          function(i, j, k);
        }
      }
    }
  }

  /// Place the voxels: data = first + matrix * index.
  void Place(const glm::dvec3& first, const glm::dmat3& matrix)
  {
    this->View.FirstVoxel = first;
    this->View.IndexToData = matrix;
    this->View.DataToIndex = glm::inverse(matrix);
  }

  ffd::VolumeView View;

private:
  std::size_t Offset(int i, int j, int k) const
  {
    return static_cast<std::size_t>(
      i * this->View.Increments[0] + j * this->View.Increments[1] + k * this->View.Increments[2]);
  }

  std::vector<double> Storage;
};

/// A table over [lo, hi] from functions of the scalar.
inline ffd::TransferTable MakeTable(
  double lo, double hi, std::size_t size, const std::function<double(double)>& opacity,
  const std::function<glm::dvec3(double)>& color = [](double) { return glm::dvec3(1.0); },
  double unitDistance = 1.0)
{
  std::vector<float> rgb;
  std::vector<float> opacities;
  for (std::size_t i = 0; i < size; ++i)
  {
    const double x = lo + (hi - lo) * static_cast<double>(i) / static_cast<double>(size - 1);
    opacities.push_back(static_cast<float>(opacity(x)));
    const glm::dvec3 c = color(x);
    rgb.insert(
      rgb.end(), { static_cast<float>(c.r), static_cast<float>(c.g), static_cast<float>(c.b) });
  }
  return ffd::TransferTable(lo, hi, size, rgb.data(), opacities.data(), unitDistance);
}

#endif
