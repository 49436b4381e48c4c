// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Rows of numbers of 16 bits in the registers of a window. Included once per target of Highway.
#if defined(FFD_SIMD_WINDOW_WORDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_WINDOW_WORDS_INL_H_
#undef FFD_SIMD_WINDOW_WORDS_INL_H_
#else
#define FFD_SIMD_WINDOW_WORDS_INL_H_
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
/// A slab of a window in two registers: eight rows of eight numbers of 16 bits.
template <>
class WindowSlab<std::uint16_t>
{
public:
  /// Loads the rows that are voxels of the cells, of a component; of several all rows.
  template <int Components, class Addresses>
  HWY_INLINE void LoadCells(const PacketVolume& v, const Addresses& voxels, int slab, int component)
  {
    static_assert(Components <= 2, "of more, lanes load their voxels sooner by themselves");
    for (int half = 0; half < 2; ++half)
    {
      __m512i rows;
      if constexpr (Components == 1)
      {
        static_cast<void>(component);
        const auto two = [&](int row) FFD_INLINE_LAMBDA {
          return LoadTwo(voxels.Get(slab, row), voxels.Get(slab, row + 1));
        };
        const auto one = [&](int row) FFD_INLINE_LAMBDA {
          return _mm256_broadcastsi128_si256(Load(voxels.Get(slab, row)));
        };
        rows = half == 0 ? JoinHalves(one(1), two(2)) : JoinHalves(two(4), one(6));
      }
      else
      {
        const auto two = [&](int row) FFD_INLINE_LAMBDA {
          return KeepWords(voxels.Get(slab, row), voxels.Get(slab, row + 1), component);
        };
        rows = JoinHalves(two(4 * half), two(4 * half + 2));
      }
      this->Rows[half] = ToSigned(v, rows);
    }
  }

  /// Loads the rows beside these.
  template <int Components, class Addresses>
  HWY_INLINE void LoadOuter(const PacketVolume& v, const Addresses& voxels, int slab, int)
  {
    for (int half = 0; Components == 1 && half < 2; ++half)
    {
      const int row = 7 * half;
      const __m512i same = _mm512_broadcast_i32x4(Load(voxels.Get(slab, row)));
      this->Rows[half] = _mm512_mask_mov_epi64(this->Rows[half], MaskOf(row), ToSigned(v, same));
    }
  }

  __m512i Rows[2];

private:
  static HWY_INLINE __m128i Load(const std::uint16_t* row)
  {
    return _mm_loadu_si128(reinterpret_cast<const __m128i*>(row));
  }
  /// The first or the second number, `which`, of all pairs in two rows.
  static HWY_INLINE __m256i KeepWords(
    const std::uint16_t* row, const std::uint16_t* next, int which)
  {
    const auto load = [](const std::uint16_t* from) {
      return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
    };
    const __m512i pairs = JoinHalves(load(row), load(next));
    return _mm512_cvtepi32_epi16(_mm512_srl_epi32(pairs, _mm_cvtsi32_si128(16 * which)));
  }
  static HWY_INLINE __mmask8 MaskOf(int row) { return static_cast<__mmask8>(3 << 2 * (row % 4)); }
  static HWY_INLINE __m512i ToSigned(const PacketVolume& v, __m512i pairs)
  {
    return Fetch<std::uint16_t>::ToSigned(v, Vi{ pairs }).raw;
  }
};

/// Where the four numbers of each lane are in a slab, which is 32 words: the word that the first
/// one is in, and how far it is behind the start of that word. The next two words hold the rest.
template <WindowFit Fit, bool AtFaces>
class WindowPlaces<std::uint16_t, Fit, AtFaces>
{
public:
  using Slab = WindowSlab<std::uint16_t>;

  WindowPlaces() = default;
  /// `first`: of the first numbers in a slab. `layer`: of the cells.
  HWY_INLINE WindowPlaces(Vi first, Vi layer)
    : Odd(_mm512_test_epi32_mask(layer.raw, _mm512_set1_epi32(1)))
    , Behind(IsBehind(layer))
    , OfRow(first.raw)
    , OfCell(_mm512_add_epi32(first.raw, _mm512_set1_epi32(1)))
  {
  }

  /// From now on the second number is the first one, too, in the lanes of `first`, and the third
  /// one the last one in those of `last`.
  HWY_INLINE void Repeat(__mmask16 first, __mmask16 last)
  {
    this->First = Bytes(first);
    this->Last = Bytes(last);
  }

  /// The numbers `rows` rows behind, in slabs from that of the first layer on.
  HWY_INLINE Fetch<std::uint16_t>::Row Row(const Slab* slabs, int rows) const
  {
    const __m512i a = this->Find(slabs, this->OfRow.Words, 4 * rows);
    const __m512i b = this->Find(slabs, this->OfRow.Words, 4 * rows + 1);
    const __m512i c = this->Find(slabs, this->OfRow.Words, 4 * rows + 2);
    __m512i ab = this->OfRow.Join(a, b);
    __m512i cd = this->OfRow.Join(b, c);
    if constexpr (AtFaces)
    {
      ab = _mm512_mask_shuffle_epi8(
        ab, this->First, ab, _mm512_set4_epi32(0x0f0e0f0e, 0x0b0a0b0a, 0x07060706, 0x03020302));
      cd = _mm512_mask_shuffle_epi8(
        cd, this->Last, cd, _mm512_set4_epi32(0x0d0c0d0c, 0x09080908, 0x05040504, 0x01000100));
    }
    return { Vi{ ab }, Vi{ cd } };
  }

  HWY_INLINE Vi Middle(const Slab* slabs, int rows, const SamplePosition& at) const
  {
    const __m512i b = this->Find(slabs, this->OfCell.Words, 4 * rows);
    const __m512i c = this->Find(slabs, this->OfCell.Words, 4 * rows + 1);
    return MultiplyPairs(Vi{ this->OfCell.Join(b, c) }, at.Weights);
  }

private:
  /// The words that hold two numbers.
  struct Pair
  {
    Pair() = default;
    HWY_INLINE explicit Pair(__m512i number)
      : Words(_mm512_srai_epi32(number, 1))
      , Down(_mm512_slli_epi32(_mm512_and_si512(number, _mm512_set1_epi32(1)), 4))
      , Up(_mm512_sub_epi32(_mm512_set1_epi32(32), this->Down))
    {
    }
    /// The pair that begins in one word and ends in the next one, if not in the same.
    HWY_INLINE __m512i Join(__m512i word, __m512i next) const
    {
      return _mm512_or_si512(
        _mm512_srlv_epi32(word, this->Down), _mm512_sllv_epi32(next, this->Up));
    }
    __m512i Words;
    __m512i Down; ///< bits
    __m512i Up;
  };

  /// Looks up words in slabs.
  HWY_INLINE __m512i Find(const Slab* slabs, __m512i words, int behind) const
  {
    const __m512i at = _mm512_add_epi32(words, _mm512_set1_epi32(behind));
    const auto find = [&](int slab) FFD_INLINE_LAMBDA {
      return _mm512_permutex2var_epi32(slabs[slab].Rows[0], at, slabs[slab].Rows[1]);
    };
    const __m512i here = _mm512_mask_mov_epi32(find(0), this->Odd, find(1));
    if constexpr (Fit == WindowFit::Two)
    {
      return here;
    }
    else if constexpr (Fit == WindowFit::Three)
    {
      return _mm512_mask_mov_epi32(here, this->Behind, find(2));
    }
    else
    {
      return _mm512_mask_mov_epi32(
        here, this->Behind, _mm512_mask_mov_epi32(find(2), this->Odd, find(3)));
    }
  }

  /// The bytes of words.
  static HWY_INLINE __mmask64 Bytes(__mmask16 words)
  {
    return _mm512_movepi8_mask(_mm512_movm_epi32(words));
  }

  __mmask16 Odd;    ///< lanes whose cells are in the second or fourth layer
  __mmask16 Behind; ///< in the third or fourth one
  __mmask64 First;  ///< bytes of the lanes of Repeat()
  __mmask64 Last;
  Pair OfRow;  ///< the first two numbers of rows
  Pair OfCell; ///< the two in the middle
};
#endif

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
