// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Voxels at the faces of the volume, repeated beyond it. Included once per target of Highway.
#if defined(FFD_SIMD_REPEATED_VOXELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_REPEATED_VOXELS_INL_H_
#undef FFD_SIMD_REPEATED_VOXELS_INL_H_
#else
#define FFD_SIMD_REPEATED_VOXELS_INL_H_
#endif

#include "FFDPacketVolume.h"

#include "FFDSimdCells-inl.h"
#include "FFDSimdMath-inl.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/**
 * The 4 x 4 x 4 voxels around the cells of some lanes, those at the faces of the volume repeated
 * beyond it: with them a sample near a face is fetched as any other.
 */
template <class T>
class RepeatedVoxels
{
public:
  /// Copies to `voxels`, which is kept: those of 16 lanes, and 16 bytes that vectors may read
  /// beyond the last one.
  explicit RepeatedVoxels(void* voxels)
    : Voxels(voxels)
  {
  }

  /// `lanes`: those of at least one position.
  HWY_NOINLINE void Fill(const PacketVolume& v, const Vec3& q, Mf lanes)
  {
    const Df d;
    const Di di;
    this->View = v;
    this->View.Scalars = this->Voxels;
    const int components = v.Components;
    this->View.IncrementY = Side * components;
    this->View.IncrementZ = Side * Side * components;
    this->View.SlicesInReach = 0;
    SampleCells found;
    this->At = FindCells(v, q, false, found);
    HWY_ALIGN int cells[3][16];
    hn::Store(found.X, di, cells[0]);
    hn::Store(found.Y, di, cells[1]);
    hn::Store(found.Z, di, cells[2]);
    HWY_ALIGN float flags[16];
    hn::Store(hn::IfThenElseZero(lanes, Splat(1.0f)), d, flags);
    int block = 0;
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
    {
      // Lanes that take no sample read the voxels of others.
      this->Offsets[lane] = components * (1 + Side + Side * Side);
      if (flags[lane] != 0.0f)
      {
        const int cell[3] = { cells[0][lane], cells[1][lane], cells[2][lane] };
        switch (components)
        {
          case 1:
            this->Copy<1>(v, cell, block);
            break;
          case 2:
            this->Copy<2>(v, cell, block);
            break;
          case 3:
            this->Copy<3>(v, cell, block);
            break;
          default:
            this->Copy<4>(v, cell, block);
            break;
        }
        this->Offsets[lane] += block;
        block += Side * Side * Side * components;
      }
    }
  }

  const PacketVolume& GetView() const { return this->View; }
  const SamplePosition& GetPosition() const { return this->At; }
  const int* GetOffsets() const { return this->Offsets; }

private:
  static constexpr int Side = 4;

  /// Copies the voxels from one before the cell to one behind it, to `block` elements.
  template <int Components>
  HWY_INLINE void Copy(const PacketVolume& v, const int cell[3], int block)
  {
    if constexpr (std::is_same<T, double>::value)
    {
      // Their bits do, whatever they stand for.
      v.ElementSize == 4
        ? Copy<Components>(v, cell, static_cast<std::uint32_t*>(this->Voxels) + block)
        : Copy<Components>(v, cell, static_cast<std::uint64_t*>(this->Voxels) + block);
    }
    else
    {
      Copy<Components>(v, cell, static_cast<T*>(this->Voxels) + block);
    }
  }
  template <int Components, class Word>
  static void Copy(const PacketVolume& v, const int cell[3], Word* to)
  {
    const auto place = [&](int a, int i) {
      return static_cast<std::ptrdiff_t>(std::clamp(cell[a] + i - 1, 0, v.Dimensions[a] - 1));
    };
    const std::ptrdiff_t x[Side] = { place(0, 0), place(0, 1), place(0, 2), place(0, 3) };
    const Word* rows[Side];
    for (int j = 0; j < Side; ++j)
    {
      rows[j] = static_cast<const Word*>(v.Scalars) + place(1, j) * v.IncrementY;
    }
    const bool whole = x[3] - x[0] == Side - 1;
    for (int k = 0; k < Side; ++k)
    {
      const std::ptrdiff_t slice = place(2, k) * v.IncrementZ;
      for (int j = 0; j < Side; ++j, to += Side * Components)
      {
        // As words, which is how they are read: loads wait for smaller stores.
        const Word* const row = rows[j] + slice;
        if (HWY_LIKELY(whole))
        {
          std::memcpy(to, row + x[0] * Components, Side * Components * sizeof(Word));
        }
        else
        {
          Word voxels[Side * Components];
          for (int i = 0; i < Side; ++i)
          {
            std::copy_n(row + x[i] * Components, Components, voxels + i * Components);
          }
          std::memcpy(to, voxels, sizeof(voxels));
        }
      }
    }
  }

  void* Voxels;
  PacketVolume View;
  SamplePosition At;
  HWY_ALIGN int Offsets[16] = {}; ///< elements
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
