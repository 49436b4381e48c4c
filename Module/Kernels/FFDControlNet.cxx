// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#include "FFDControlNet.h"

#include "FFDGridIndex.h"

#include <algorithm>
#include <cstddef>

namespace ffd
{
namespace
{

/// Apply `line` (n values in, m values out) along one axis of a net.
template <typename Line>
ControlNet MapLines(const ControlNet& net, int axis, int size, const Line& line)
{
  ControlNet result;
  result.Nodes = net.Nodes;
  result.Nodes[axis] = size;
  result.Values.resize(GridSize(result.Nodes));
  std::size_t stride = 1;
  for (int a = 0; a < axis; ++a)
  {
    stride *= static_cast<std::size_t>(net.Nodes[a]);
  }
  const std::size_t n = static_cast<std::size_t>(net.Nodes[axis]);
  const std::size_t m = static_cast<std::size_t>(size);
  const std::size_t outer = net.Values.size() / (stride * n);
  std::vector<glm::dvec3> in(n);
  std::vector<glm::dvec3> out(m);
  for (std::size_t o = 0; o < outer; ++o)
  {
    for (std::size_t s = 0; s < stride; ++s)
    {
      for (std::size_t i = 0; i < n; ++i)
      {
        in[i] = net.Values[(o * n + i) * stride + s];
      }
      line(in, out);
      for (std::size_t i = 0; i < m; ++i)
      {
        result.Values[(o * m + i) * stride + s] = out[i];
      }
    }
  }
  return result;
}

/// ((1 + z + ... + z^(f-1)) / f)^4 * f.
std::vector<double> RefinementMask(int factor)
{
  std::vector<double> mask(1, static_cast<double>(factor));
  for (int power = 0; power < 4; ++power)
  {
    std::vector<double> next(mask.size() + static_cast<std::size_t>(factor) - 1, 0.0);
    for (std::size_t i = 0; i < mask.size(); ++i)
    {
      for (std::size_t j = 0; j < static_cast<std::size_t>(factor); ++j)
      {
        next[i + j] += mask[i] / factor;
      }
    }
    mask = next;
  }
  return mask;
}

/// Coefficients c[0 ... m + 1] with (c[i-1] + 4 c[i] + c[i+1]) / 6 = f[i-1], i = 1 ... m.
void InterpolateLine(const std::vector<glm::dvec3>& f, std::vector<glm::dvec3>& c)
{
  const std::size_t m = f.size();
  const auto sample = [&f](std::size_t i) { return f[i - 1]; };
  if (m == 2)
  {
    c[1] = sample(1);
    c[2] = sample(2);
  }
  else if (m == 3)
  {
    // The quadratic through three samples: second difference s, c = f - s / 6.
    const glm::dvec3 sixth = (sample(1) - 2.0 * sample(2) + sample(3)) / 6.0;
    for (std::size_t i = 1; i <= 3; ++i)
    {
      c[i] = sample(i) - sixth;
    }
  }
  else
  {
    // Not-a-knot and the first three equations leave one unknown: c[2] is explicit; so is c[m-1].
    c[2] = (8.0 * sample(2) - sample(1) - sample(3)) / 6.0;
    c[m - 1] = (8.0 * sample(m - 1) - sample(m) - sample(m - 2)) / 6.0;
    // Thomas' algorithm for c[3] ... c[m-2]; the matrix is diagonally dominant.
    if (m > 4)
    {
      std::vector<double> upper(m, 0.0);
      for (std::size_t i = 3; i <= m - 2; ++i)
      {
        glm::dvec3 right = 6.0 * sample(i);
        right -= i == m - 2 ? c[m - 1] : glm::dvec3(0.0);
        const double pivot = 4.0 - upper[i - 1];
        upper[i] = 1.0 / pivot;
        // c[2] is known, so the first row carries it to the right-hand side like any other.
        c[i] = (right - c[i - 1]) / pivot;
      }
      for (std::size_t i = m - 3; i >= 3; --i)
      {
        c[i] -= upper[i] * c[i + 1];
      }
    }
    c[1] = 6.0 * sample(2) - 4.0 * c[2] - c[3];
    c[m] = 6.0 * sample(m - 1) - 4.0 * c[m - 1] - c[m - 2];
  }
  c[0] = 6.0 * sample(1) - 4.0 * c[1] - c[2];
  c[m + 1] = 6.0 * sample(m) - 4.0 * c[m] - c[m - 1];
}

} // namespace

//------------------------------------------------------------------------------
ControlNet RefineControlNet(const ControlNet& net, const glm::ivec3& factors)
{
  ControlNet result = net;
  for (int axis = 0; axis < 3; ++axis)
  {
    const int factor = factors[axis];
    if (factor <= 1)
    {
      continue;
    }
    const std::vector<double> mask = RefinementMask(factor);
    const int nodes = result.Nodes[axis];
    const int size = (nodes - 3) * factor + 3;
    result = MapLines(
      result, axis, size, [&](const std::vector<glm::dvec3>& in, std::vector<glm::dvec3>& out) {
        for (int i = 0; i < size; ++i)
        {
          // Fine control point i rests at 1 + (i - 1) / factor of the coarse ones.
          const int fine = factor + i - 1;
          glm::dvec3 sum(0.0);
          for (int j = 0; j < nodes; ++j)
          {
            const int k = fine - factor * j + 2 * (factor - 1);
            if (k >= 0 && k < static_cast<int>(mask.size()))
            {
              sum += mask[static_cast<std::size_t>(k)] * in[static_cast<std::size_t>(j)];
            }
          }
          out[static_cast<std::size_t>(i)] = sum;
        }
      });
  }
  return result;
}

//------------------------------------------------------------------------------
ControlNet InterpolateControlNet(const ControlNet& samples)
{
  ControlNet result = samples;
  for (int axis = 0; axis < 3; ++axis)
  {
    result = MapLines(result, axis, result.Nodes[axis] + 2, InterpolateLine);
  }
  return result;
}

} // namespace ffd
