// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Rows of bytes in the registers of a window. Included once per target of Highway.
#if defined(FFD_SIMD_WINDOW_BYTES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_WINDOW_BYTES_INL_H_
#undef FFD_SIMD_WINDOW_BYTES_INL_H_
#else
#define FFD_SIMD_WINDOW_BYTES_INL_H_
#endif

#include "FFDSimdCells-inl.h"
#include "FFDSimdFetch-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdWindow-inl.h"

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

#if FFD_HAS_VOXEL_WINDOWS
/// A slab of a window in a register: eight rows of eight bytes.
template <>
class WindowSlab<std::uint8_t>
{
public:
  /// Loads the rows that are voxels of the cells, of a component; of several all rows.
  template <int Components, class Addresses>
  HWY_INLINE void LoadCells(const PacketVolume&, const Addresses& voxels, int slab, int component)
  {
    if constexpr (Components == 1)
    {
      static_cast<void>(component);
      const auto row = [&](int k) FFD_INLINE_LAMBDA {
        return _mm256_broadcastq_epi64(Load(voxels.Get(slab, k)));
      };
      const __m256i low =
        _mm256_blend_epi32(_mm256_blend_epi32(row(1), row(2), 0x30), row(3), 0xc0);
      const __m256i high =
        _mm256_blend_epi32(_mm256_blend_epi32(row(4), row(5), 0x0c), row(6), 0x30);
      this->Rows = JoinHalves(low, high);
    }
    else
    {
      this->LoadComponent<Components>(voxels, slab, component);
    }
  }

  /// Loads the rows beside these.
  template <int Components, class Addresses>
  HWY_INLINE void LoadOuter(const PacketVolume&, const Addresses& voxels, int slab, int)
  {
    if constexpr (Components == 1)
    {
      this->LoadRow(voxels, slab, 0);
      this->LoadRow(voxels, slab, 7);
    }
  }

  /// Does what LoadCells() does of both components of a volume of two.
  template <class Addresses>
  static HWY_INLINE void LoadBoth(
    const Addresses& voxels, int slab, WindowSlab& first, WindowSlab& second)
  {
    const __m512i low = LoadFour(voxels, slab, 0);
    const __m512i high = LoadFour(voxels, slab, 4);
    first.Rows = KeepBytes(low, high, 0);
    second.Rows = KeepBytes(low, high, 1);
  }

  __m512i Rows;

private:
  /// Loads all rows of a component of several.
  template <int Components, class Addresses>
  HWY_INLINE void LoadComponent(const Addresses& voxels, int slab, int component)
  {
    static_assert(Components == 2 || Components == 4, "rows fill registers");
    if constexpr (Components == 2)
    {
      this->Rows = KeepBytes(LoadFour(voxels, slab, 0), LoadFour(voxels, slab, 4), component);
    }
    else
    {
      // Two rows of 32 bytes.
      const auto load = [&](int row) FFD_INLINE_LAMBDA {
        const auto half = [&](int k) FFD_INLINE_LAMBDA {
          return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(voxels.Get(slab, row + k)));
        };
        return JoinHalves(half(0), half(1));
      };
      const int which = component % 2;
      this->Rows = KeepBytes(
        KeepBytes(load(0), load(2), which), KeepBytes(load(4), load(6), which), component / 2);
    }
  }

  /// Four rows of 16 bytes.
  template <class Addresses>
  static HWY_INLINE __m512i LoadFour(const Addresses& voxels, int slab, int first)
  {
    const auto two = [&](int row) FFD_INLINE_LAMBDA {
      return LoadTwo(voxels.Get(slab, row), voxels.Get(slab, row + 1));
    };
    return JoinHalves(two(first), two(first + 2));
  }

  static HWY_INLINE __m128i Load(const std::uint8_t* row)
  {
    return _mm_loadl_epi64(reinterpret_cast<const __m128i*>(row));
  }

  template <class Addresses>
  HWY_INLINE void LoadRow(const Addresses& voxels, int slab, int row)
  {
    this->Rows = _mm512_mask_broadcastq_epi64(
      this->Rows, static_cast<__mmask8>(1 << row), Load(voxels.Get(slab, row)));
  }

  /// The first or the second byte, `which`, of all pairs of bytes of two registers.
  static HWY_INLINE __m512i KeepBytes(__m512i low, __m512i high, int which)
  {
#if FFD_HAS_BYTE_PERMUTATIONS
    const __m512i numbers = _mm512_load_si512(ByteNumbers);
    const __m512i shift = _mm512_set1_epi8(static_cast<char>(which));
    return _mm512_permutex2var_epi8(
      low, _mm512_add_epi8(_mm512_add_epi8(numbers, numbers), shift), high);
#else
    const __m128i shift = _mm_cvtsi32_si128(8 * which);
    const auto keep = [shift](__m512i bytes) {
      return _mm512_cvtepi16_epi8(_mm512_srl_epi16(bytes, shift));
    };
    return JoinHalves(keep(low), keep(high));
#endif
  }

#if FFD_HAS_BYTE_PERMUTATIONS
  HWY_ALIGN static constexpr std::uint8_t ByteNumbers[64] = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11,
    12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 32, 33, 34, 35,
    36, 37, 38, 39, 40, 41, 42, 43, 44, 45, 46, 47, 48, 49, 50, 51, 52, 53, 54, 55, 56, 57, 58, 59,
    60, 61, 62, 63 };
#endif
};

#if FFD_HAS_BYTE_PERMUTATIONS
/// Where the four bytes of each lane are in two slabs, which are 64 bytes each: their numbers.
template <WindowFit Fit, bool AtFaces>
class WindowPlaces<std::uint8_t, Fit, AtFaces>
{
public:
  using Slab = WindowSlab<std::uint8_t>;

  WindowPlaces() = default;
  /// `first`: numbers of the first bytes in a slab. `layer`: of the cells.
  HWY_INLINE WindowPlaces(Vi first, Vi layer)
    : Behind(IsBehind(layer))
  {
    const __m512i number = AddOddLayers<Fit>(first, layer).raw;
    this->Numbers = _mm512_add_epi8(
      _mm512_shuffle_epi8(number, _mm512_set4_epi32(0x0c0c0c0c, 0x08080808, 0x04040404, 0)),
      _mm512_set1_epi32(0x03020100));
  }

  /// From now on the second byte is the first one, too, in the lanes of `first`, and the third one
  /// the last one in those of `last`.
  HWY_INLINE void Repeat(__mmask16 first, __mmask16 last)
  {
    this->Numbers =
      _mm512_mask_add_epi32(this->Numbers, first, this->Numbers, _mm512_set1_epi32(1));
    this->Numbers =
      _mm512_mask_sub_epi32(this->Numbers, last, this->Numbers, _mm512_set1_epi32(1 << 24));
  }

  /// The bytes `rows` rows behind, in slabs from that of the first layer on.
  HWY_INLINE Vi Row(const Slab* slabs, int rows) const
  {
    const __m512i at =
      _mm512_add_epi8(this->Numbers, _mm512_set1_epi8(static_cast<char>(8 * rows)));
    const __m512i here = _mm512_permutex2var_epi8(slabs[0].Rows, at, slabs[1].Rows);
    if constexpr (Fit == WindowFit::Two)
    {
      return Vi{ here };
    }
    else
    {
      const __m512i there = Fit == WindowFit::Three
        ? _mm512_permutexvar_epi8(at, slabs[2].Rows)
        : _mm512_permutex2var_epi8(slabs[2].Rows, at, slabs[3].Rows);
      return Vi{ _mm512_mask_mov_epi32(here, this->Behind, there) };
    }
  }

  HWY_INLINE Vi Middle(const Slab* slabs, int rows, const SamplePosition& at) const
  {
    return Fetch<std::uint8_t>::Middle(this->Row(slabs, rows), at);
  }

private:
  __mmask16 Behind; ///< lanes whose cells are in the third or fourth layer
  __m512i Numbers;
};
#else
/// Where the four bytes of each lane are in two slabs, which are 16 words each: the word that the
/// first one is in, and how far it is behind the start of that word. The next word holds the rest.
template <WindowFit Fit, bool AtFaces>
class WindowPlaces<std::uint8_t, Fit, AtFaces>
{
public:
  using Slab = WindowSlab<std::uint8_t>;

  WindowPlaces() = default;
  /// `first`: numbers of the first bytes in a slab. `layer`: of the cells.
  HWY_INLINE WindowPlaces(Vi first, Vi layer)
    : Behind(IsBehind(layer))
  {
    const __m512i number = AddOddLayers<Fit>(first, layer).raw;
    this->Words = _mm512_srai_epi32(number, 2);
    this->Down = _mm512_slli_epi32(_mm512_and_si512(number, _mm512_set1_epi32(3)), 3);
    this->Up = _mm512_sub_epi32(_mm512_set1_epi32(32), this->Down);
  }

  /// From now on the second byte is the first one, too, in the lanes of `first`, and the third one
  /// the last one in those of `last`.
  HWY_INLINE void Repeat(__mmask16 first, __mmask16 last)
  {
    const __m512i same = _mm512_set4_epi32(0x0f0e0d0c, 0x0b0a0908, 0x07060504, 0x03020100);
    this->Order = _mm512_mask_add_epi32(same, first, same, _mm512_set1_epi32(1));
    this->Order = _mm512_mask_sub_epi32(this->Order, last, this->Order, _mm512_set1_epi32(1 << 24));
  }

  /// The bytes `rows` rows behind, in slabs from that of the first layer on.
  HWY_INLINE Vi Row(const Slab* slabs, int rows) const
  {
    const auto find = [&](int words) FFD_INLINE_LAMBDA {
      const __m512i at = _mm512_add_epi32(this->Words, _mm512_set1_epi32(words));
      const __m512i here = _mm512_permutex2var_epi32(slabs[0].Rows, at, slabs[1].Rows);
      if constexpr (Fit == WindowFit::Two)
      {
        return here;
      }
      else if constexpr (Fit == WindowFit::Three)
      {
        return _mm512_mask_permutexvar_epi32(here, this->Behind, at, slabs[2].Rows);
      }
      else
      {
        return _mm512_mask_mov_epi32(
          here, this->Behind, _mm512_permutex2var_epi32(slabs[2].Rows, at, slabs[3].Rows));
      }
    };
    const __m512i bytes = _mm512_or_si512(_mm512_srlv_epi32(find(2 * rows), this->Down),
      _mm512_sllv_epi32(find(2 * rows + 1), this->Up));
    return Vi{ AtFaces ? _mm512_shuffle_epi8(bytes, this->Order) : bytes };
  }

  HWY_INLINE Vi Middle(const Slab* slabs, int rows, const SamplePosition& at) const
  {
    return Fetch<std::uint8_t>::Middle(this->Row(slabs, rows), at);
  }

private:
  __mmask16 Behind; ///< lanes whose cells are in the third or fourth layer
  __m512i Words;
  __m512i Down; ///< bits
  __m512i Up;
  __m512i Order; ///< of the bytes of each lane, `AtFaces`
};
#endif
#endif

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
