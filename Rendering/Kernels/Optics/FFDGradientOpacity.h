// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FFDGradientOpacity_h
#define FFDGradientOpacity_h

#include <algorithm>
#include <cstddef>
#include <vector>

namespace ffd
{

/// Factor of the opacity over the magnitude of the gradient, sampled at equal steps and
/// interpolated linearly.
class GradientOpacity
{
public:
  GradientOpacity() = default;

  /// `factors`: two or more, from magnitude 0 to `largest` (> 0); beyond, the last one holds.
  GradientOpacity(std::vector<float> factors, double largest)
    : Scale(static_cast<double>(factors.size() - 1) / largest)
    , Factors(std::move(factors))
  {
  }

  /// Without factors there is nothing to look up: opacities stay as they are.
  bool IsEmpty() const { return this->Factors.empty(); }

  float operator()(double magnitude) const
  {
    const double last = static_cast<double>(this->Factors.size() - 1);
    // In this order what is not a number becomes 0.
    const double x = std::min(std::max(0.0, magnitude * this->Scale), last);
    const std::size_t i = std::min(static_cast<std::size_t>(x), this->Factors.size() - 2);
    const float f = static_cast<float>(x - static_cast<double>(i));
    return this->Factors[i] + f * (this->Factors[i + 1] - this->Factors[i]);
  }

  const std::vector<float>& GetFactors() const { return this->Factors; }
  double GetScale() const { return this->Scale; }

private:
  double Scale = 1.0; // entries per unit of magnitude
  std::vector<float> Factors;
};

} // namespace ffd

#endif
