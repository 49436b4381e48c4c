// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Trilinear samples of several components and their gradients. Included once per target of Highway.
#if defined(FFD_SIMD_COMPONENTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_COMPONENTS_INL_H_
#undef FFD_SIMD_COMPONENTS_INL_H_
#else
#define FFD_SIMD_COMPONENTS_INL_H_
#endif

#include "FFDPacketVolume.h"

#include "FFDSimdFetch-inl.h"
#include "FFDSimdMath-inl.h"

#include <cstddef>
#include <cstdint>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

constexpr int LargestNumberOfComponents = 4;

/**
 * The components of one voxel for each lane, at `offsets + delta` elements. Words of 32 bits are
 * loaded, which may reach beyond the voxel: there must be another one behind it.
 */
template <class T>
HWY_INLINE void LoadComponents(
  const PacketVolume& v, const int* offsets, std::ptrdiff_t delta, Vf* values)
{
  const Df d;
  if constexpr (std::is_same<T, float>::value)
  {
    for (int c = 0; c < v.Components; ++c)
    {
      values[c] = LoadLanes<float, 4>(v.Scalars, 4 * (delta + c), offsets);
    }
  }
  else if constexpr (sizeof(T) == 1)
  {
    const Vi word = LoadLanes<int, 1>(v.Scalars, delta, offsets);
    // To the highest byte, and back with its sign or without.
    const auto component = [&](Vi highest) {
      if constexpr (std::is_signed<T>::value)
      {
        return hn::ConvertTo(d, hn::ShiftRight<24>(highest));
      }
      else
      {
        return hn::ConvertTo(d, hn::And(hn::ShiftRight<24>(highest), hn::Set(Di(), 0xff)));
      }
    };
    values[0] = component(hn::ShiftLeft<24>(word));
    values[1] = component(hn::ShiftLeft<16>(word));
    if (v.Components > 2)
    {
      values[2] = component(hn::ShiftLeft<8>(word));
      values[3] = component(word);
    }
  }
  else
  {
    const auto pair = [&](int first, Vf& low, Vf& high) {
      const Vi word = LoadLanes<int, 2>(v.Scalars, 2 * (delta + first), offsets);
      if constexpr (std::is_signed<T>::value)
      {
        low = hn::ConvertTo(d, hn::ShiftRight<16>(hn::ShiftLeft<16>(word)));
        high = hn::ConvertTo(d, hn::ShiftRight<16>(word));
      }
      else
      {
        const Vi half = hn::Set(Di(), 0xffff);
        low = hn::ConvertTo(d, hn::And(word, half));
        high = hn::ConvertTo(d, hn::And(hn::ShiftRight<16>(word), half));
      }
    };
    pair(0, values[0], values[1]);
    if (v.Components > 2)
    {
      pair(2, values[2], values[3]);
    }
  }
}

/// The components around the positions of a packet: values, and differences over two voxels, as
/// Sample() and Gradient() give them of one.
template <class T>
class ComponentSamples
{
public:
  /// Fetches from the cells of `lanes`, FindInterior(); other lanes get a cell that can be fetched.
  HWY_INLINE ComponentSamples(
    const PacketVolume& v, const SampleCells& cells, const SamplePosition& at, Mf lanes)
    : Volume(v)
    , Steps{ v.Components, v.IncrementY, v.IncrementZ }
  {
    this->Voxels.Fit(v, cells, lanes, this->Offsets);
    const Vf one = Splat(1.0f);
    const Vf parts[3] = { at.Fx, at.Fy, at.Fz };
    for (int a = 0; a < 3; ++a)
    {
      this->Weights[a][0] = hn::Sub(one, parts[a]);
      this->Weights[a][1] = parts[a];
    }
  }

  HWY_NOINLINE void FindValues(Vf values[LargestNumberOfComponents])
  {
    for (int c = 0; c < this->Volume.Components; ++c)
    {
      values[c] = hn::Zero(Df());
    }
    for (int corner = 0; corner < 8; ++corner)
    {
      const int i = corner & 1;
      const int j = corner >> 1 & 1;
      const int k = corner >> 2;
      Vf* const here = this->Corners[corner];
      LoadComponents<T>(this->Voxels.Get(), this->Offsets, this->DeltaOf(i, j, k), here);
      const Vf weight =
        hn::Mul(this->Weights[0][i], hn::Mul(this->Weights[1][j], this->Weights[2][k]));
      for (int c = 0; c < this->Volume.Components; ++c)
      {
        values[c] = hn::MulAdd(weight, here[c], values[c]);
      }
    }
  }

  /// After FindValues().
  HWY_NOINLINE void FindGradients(Vec3 gradients[LargestNumberOfComponents]) const
  {
    const Vf zero = hn::Zero(Df());
    for (int c = 0; c < this->Volume.Components; ++c)
    {
      gradients[c] = { zero, zero, zero };
    }
    for (int axis = 0; axis < 3; ++axis)
    {
      const int b = (axis + 1) % 3;
      const int e = (axis + 2) % 3;
      for (int side = 0; side < 4; ++side)
      {
        int at[3];
        at[b] = side & 1;
        at[e] = side >> 1;
        const auto corner = [&](int end) {
          at[axis] = end;
          return this->Corners[at[0] + 2 * at[1] + 4 * at[2]];
        };
        const auto load = [&](int end, Vf* voxels) {
          at[axis] = end;
          LoadComponents<T>(
            this->Voxels.Get(), this->Offsets, this->DeltaOf(at[0], at[1], at[2]), voxels);
        };
        const Vf* const first = corner(0);
        const Vf* const second = corner(1);
        Vf before[LargestNumberOfComponents];
        Vf behind[LargestNumberOfComponents];
        load(-1, before);
        load(2, behind);
        const Vf weight = hn::Mul(this->Weights[b][at[b]], this->Weights[e][at[e]]);
        for (int c = 0; c < this->Volume.Components; ++c)
        {
          // Differences first: they are zero where voxels are equal.
          const Vf difference = Lerp(
            hn::Sub(second[c], before[c]), hn::Sub(behind[c], first[c]), this->Weights[axis][1]);
          Vf& sum = axis == 0 ? gradients[c].x : axis == 1 ? gradients[c].y : gradients[c].z;
          sum = hn::MulAdd(weight, difference, sum);
        }
      }
    }
  }

private:
  HWY_INLINE std::ptrdiff_t DeltaOf(int i, int j, int k) const
  {
    return i * this->Steps[0] + j * this->Steps[1] + k * this->Steps[2];
  }

  const PacketVolume& Volume;
  std::ptrdiff_t Steps[3]; ///< elements
  VoxelsInReach Voxels;
  HWY_ALIGN int Offsets[16];
  Vf Weights[3][2];                         ///< of the voxels of a cell, along each axis
  Vf Corners[8][LargestNumberOfComponents]; ///< of the cells
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
