// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Voxels of a packet in registers. Included once per target of Highway.
#if defined(FFD_SIMD_WINDOW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_WINDOW_INL_H_
#undef FFD_SIMD_WINDOW_INL_H_
#else
#define FFD_SIMD_WINDOW_INL_H_
#endif

#include "FFDPacketVolume.h"

#include "FFDSimdFetch-inl.h"
#include "FFDSimdMath-inl.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

// Permutations of all bytes of two registers, which Highway has no words for: AVX-512 VBMI.
#undef FFD_HAS_VOXEL_WINDOWS
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3_DL
#define FFD_HAS_VOXEL_WINDOWS 1
#else
#define FFD_HAS_VOXEL_WINDOWS 0
#endif

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Whether the rows of a scalar type can be looked up in a VoxelWindow.
template <class T>
constexpr bool HasVoxelWindow()
{
  return FFD_HAS_VOXEL_WINDOWS &&
    (std::is_same<T, std::uint8_t>::value || std::is_same<T, std::int8_t>::value);
}

template <class T>
class VoxelWindow;

#if FFD_HAS_VOXEL_WINDOWS
/**
 * The rays of a packet are neighbours: all bytes that they need at one sample mostly lie in a
 * window of 8 x 8 x 7 voxels. It is loaded into registers, slab by slab, and rows are looked up
 * there by permutations of bytes, where loads lane by lane would take several times as many
 * instructions. A source of rows as OffsetRows.
 */
template <class T>
class VoxelWindow
{
public:
  /// Whether the window of some lanes is large enough; then Sample() may follow. `lanes`: interior.
  HWY_INLINE bool Fit(const PacketVolume& v, const SampleCells& cells, Mf lanes)
  {
    const Di di;
    if (v.Dimensions[0] < Side || v.Dimensions[1] < Side || v.Dimensions[2] < Side)
    {
      return false;
    }
    const hn::Mask<Di> mine = hn::RebindMask(di, lanes);
    const auto cornerOf = [&](Vi cell, int voxels, int a) {
      const Vi far = hn::Set(di, 1 << 30);
      const int least = hn::GetLane(hn::MinOfLanes(di, hn::IfThenElse(mine, cell, far)));
      return std::clamp(least, 1, v.Dimensions[a] - voxels + 1);
    };
    const int x = cornerOf(cells.X, Side, 0);
    const int y = cornerOf(cells.Y, Side, 1);
    const int z = cornerOf(cells.Z, Slabs, 2);
    const Vi dx = hn::Sub(cells.X, hn::Set(di, x));
    const Vi dy = hn::Sub(cells.Y, hn::Set(di, y));
    const Vi dz = hn::Sub(cells.Z, hn::Set(di, z));
    const __mmask16 outside = _mm512_cmpgt_epu32_mask(dx.raw, _mm512_set1_epi32(Reach)) |
      _mm512_cmpgt_epu32_mask(dy.raw, _mm512_set1_epi32(Reach)) |
      _mm512_cmpgt_epu32_mask(dz.raw, _mm512_set1_epi32(Depth - 1));
    if ((outside & mine.raw) != 0)
    {
      return false;
    }
    this->Corner = static_cast<const std::uint8_t*>(v.Scalars) +
      static_cast<std::ptrdiff_t>(z) * v.IncrementZ +
      static_cast<std::ptrdiff_t>(y) * v.IncrementY + x - 1;
    this->StepY = v.IncrementY;
    this->StepZ = v.IncrementZ;
    this->High = _mm512_cmpgt_epi32_mask(dz.raw, _mm512_set1_epi32(1));
    // Of the row at (0, 0), in two slabs: its first byte, and the three behind it.
    const Vi first = hn::Add(hn::ShiftLeft<6>(hn::And(dz, hn::Set(di, 1))),
      hn::Add(hn::ShiftLeft<3>(hn::Add(dy, hn::Set(di, 1))), dx));
    this->Index = _mm512_add_epi8(
      _mm512_shuffle_epi8(first.raw, _mm512_set4_epi32(0x0c0c0c0c, 0x08080808, 0x04040404, 0)),
      _mm512_set1_epi32(0x03020100));
    for (int k = 1; k < Slabs - 1; ++k)
    {
      this->Slab[k] = this->Load(k, _mm512_setzero_si512(), std::make_integer_sequence<int, 6>());
    }
    return true;
  }

  /// Before Gradient(): the voxels that it alone needs.
  HWY_INLINE void Widen()
  {
    this->Slab[0] = this->Load(0, _mm512_setzero_si512(), std::make_integer_sequence<int, 6>());
    this->Slab[Slabs - 1] =
      this->Load(Slabs - 1, _mm512_setzero_si512(), std::make_integer_sequence<int, 6>());
    for (int k = 1; k < Slabs - 1; ++k)
    {
      this->Slab[k] = this->LoadRow<7>(k, this->LoadRow<0>(k, this->Slab[k]));
    }
  }

  HWY_INLINE Vi Row(int dy, int dz) const
  {
    const __m512i index = _mm512_add_epi8(this->Index, _mm512_set1_epi8(static_cast<char>(8 * dy)));
    const __m512i* const slab = this->Slab + 1 + dz;
    const __m512i low = _mm512_permutex2var_epi8(slab[0], index, slab[1]);
    const __m512i high = _mm512_permutex2var_epi8(slab[2], index, slab[3]);
    return Vi{ _mm512_mask_mov_epi32(low, this->High, high) };
  }

  HWY_INLINE Vi Middle(int dy, int dz, const SamplePosition& at) const
  {
    return Fetch<T>::Middle(this->Row(dy, dz), at);
  }

private:
  static constexpr int Side = 8;          ///< voxels along x and y
  static constexpr int Reach = Side - 4;  ///< cells of a window, along x and y, beyond the first
  static constexpr int Depth = 4;         ///< cells along z
  static constexpr int Slabs = Depth + 3; ///< voxels along z

  /// Row `number` of a slab, counted from the one before the corner.
  template <int Number>
  HWY_INLINE __m512i LoadRow(int slab, __m512i rows) const
  {
    const std::uint8_t* const row =
      this->Corner + (slab - 1) * this->StepZ + (Number - 1) * this->StepY;
    return _mm512_mask_broadcastq_epi64(
      rows, 1 << Number, _mm_loadl_epi64(reinterpret_cast<const __m128i*>(row)));
  }

  /// Rows 1 to 6.
  template <int... Numbers>
  HWY_INLINE __m512i Load(int slab, __m512i rows, std::integer_sequence<int, Numbers...>) const
  {
    ((rows = this->LoadRow<Numbers + 1>(slab, rows)), ...);
    return rows;
  }

  const std::uint8_t* Corner = nullptr;
  std::ptrdiff_t StepY = 0;
  std::ptrdiff_t StepZ = 0;
  __m512i Index;
  __mmask16 High;
  __m512i Slab[Slabs];
};
#endif

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
