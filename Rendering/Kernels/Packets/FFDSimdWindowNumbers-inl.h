// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Rows of numbers of 32 and 64 bits in a window. Included once per target of Highway.
#if defined(FFD_SIMD_WINDOW_NUMBERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_WINDOW_NUMBERS_INL_H_
#undef FFD_SIMD_WINDOW_NUMBERS_INL_H_
#else
#define FFD_SIMD_WINDOW_NUMBERS_INL_H_
#endif

#include "FFDSimdCells-inl.h"
#include "FFDSimdFetch-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdWide-inl.h"
#include "FFDSimdWindow-inl.h"

#include <cstdint>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

#if FFD_HAS_VOXEL_WINDOWS
/// A slab of a window: seven rows of eight numbers in single precision, as Fetch makes them.
template <class T>
class WindowSlab
{
public:
  /// Loads the rows that are voxels of the cells.
  template <class Addresses>
  HWY_INLINE void LoadCells(const PacketVolume& v, const Addresses& voxels, int slab)
  {
    for (int row = 1; row < WindowRowsAlongY<T>() - 1; ++row)
    {
      this->LoadRow(v, voxels, slab, row);
    }
  }

  /// Loads the rows beside these.
  template <class Addresses>
  HWY_INLINE void LoadOuter(const PacketVolume& v, const Addresses& voxels, int slab)
  {
    this->LoadRow(v, voxels, slab, 0);
    this->LoadRow(v, voxels, slab, WindowRowsAlongY<T>() - 1);
  }

  /// Two rows.
  HWY_INLINE __m512 GetPair(int row) const
  {
    const __m256 first = _mm256_load_ps(this->Rows[row]);
    return _mm512_insertf32x8(
      _mm512_castps256_ps512(first), _mm256_load_ps(this->Rows[row + 1]), 1);
  }

private:
  template <class Addresses>
  HWY_INLINE void LoadRow(const PacketVolume& v, const Addresses& voxels, int slab, int row)
  {
    _mm256_store_ps(this->Rows[row], ToFloats(v, voxels.Get(slab, row)));
  }

  /// Eight numbers of 64 bits, which may be integers.
  static HWY_INLINE __m512d LoadDoubles(const PacketVolume& v, const double* row)
  {
    const __m512d numbers = _mm512_loadu_pd(row);
    if (HWY_LIKELY(v.Type == ScalarType::Float64))
    {
      return numbers;
    }
    const __m512i integers = _mm512_castpd_si512(numbers);
    return v.Type == ScalarType::Int64 ? _mm512_cvtepi64_pd(integers)
                                       : _mm512_cvtepu64_pd(integers);
  }

  static HWY_INLINE __m256 ToFloats(const PacketVolume& v, const T* row)
  {
    if constexpr (std::is_same<T, float>::value)
    {
      static_cast<void>(v);
      return _mm256_loadu_ps(row);
    }
    else if constexpr (std::is_same<T, double>::value)
    {
      return _mm512_cvtpd_ps(
        _mm512_mul_pd(_mm512_sub_pd(LoadDoubles(v, row), _mm512_set1_pd(v.Shift[0])),
          _mm512_set1_pd(v.Scale[0])));
    }
    else
    {
      // As FromWords().
      const PacketWords& of = v.Words[0];
      const __m256i words = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(row));
      const __m256i difference = _mm256_sub_epi32(words, _mm256_set1_epi32(of.Origin));
      return _mm256_fmadd_ps(
        _mm256_cvtepi32_ps(difference), _mm256_set1_ps(of.Unit), _mm256_set1_ps(of.Zero));
    }
  }

  HWY_ALIGN float Rows[WindowRowsAlongY<T>()][8];
};

/// Where the four numbers of each lane are in two pairs of rows of a slab, of which the first one
/// begins a given number of rows behind the first of the window.
template <class T, WindowFit Fit, bool AtFaces>
class WindowPlaces
{
public:
  using Slab = WindowSlab<T>;

  WindowPlaces() = default;
  /// `first`: of the first numbers in a slab, whose first row no lane is in. `layer`: of the cells.
  HWY_INLINE WindowPlaces(Vi first, Vi layer)
    : Odd(_mm512_test_epi32_mask(layer.raw, _mm512_set1_epi32(1)))
    , Behind(IsBehind(layer))
    , First(_mm512_sub_epi32(first.raw, _mm512_set1_epi32(8)))
  {
  }

  /// From now on the second number is the first one, too, in the lanes of `first`, and the third
  /// one the last one in those of `last`.
  HWY_INLINE void Repeat(__mmask16 first, __mmask16 last)
  {
    this->AtFirst = first;
    this->AtLast = last;
  }

  /// The numbers `rows` rows behind, in slabs from that of the first layer on.
  HWY_INLINE Row4 Row(const Slab* slabs, int rows) const
  {
    const Layers layers(slabs, rows);
    Row4 row{ this->Find(layers, 0), this->Find(layers, 1), this->Find(layers, 2),
      this->Find(layers, 3) };
    if constexpr (AtFaces)
    {
      row.A.raw = _mm512_mask_mov_ps(row.A.raw, this->AtFirst, row.B.raw);
      row.D.raw = _mm512_mask_mov_ps(row.D.raw, this->AtLast, row.C.raw);
    }
    return row;
  }

  HWY_INLINE Vf Middle(const Slab* slabs, int rows, const SamplePosition& at) const
  {
    const Layers layers(slabs, rows);
    return Between(this->Find(layers, 1), this->Find(layers, 2), at.Fx, at);
  }

private:
  /// The four rows that the lanes of a window are in, of each layer.
  struct Layers
  {
    static constexpr int Count = Fit == WindowFit::Two ? 2 : Fit == WindowFit::Three ? 3 : 4;

    HWY_INLINE Layers(const Slab* slabs, int rows)
    {
      for (int k = 0; k < Count; ++k)
      {
        this->Low[k] = slabs[k].GetPair(rows + 1);
        this->High[k] = slabs[k].GetPair(rows + 3);
      }
    }
    __m512 Low[Count];
    __m512 High[Count];
  };

  /// Looks up numbers `behind` the first ones.
  HWY_INLINE Vf Find(const Layers& layers, int behind) const
  {
    const __m512i at = _mm512_add_epi32(this->First, _mm512_set1_epi32(behind));
    const auto find = [&](int k) FFD_INLINE_LAMBDA {
      return _mm512_permutex2var_ps(layers.Low[k], at, layers.High[k]);
    };
    const __m512 here = _mm512_mask_mov_ps(find(0), this->Odd, find(1));
    if constexpr (Fit == WindowFit::Two)
    {
      return Vf{ here };
    }
    else if constexpr (Fit == WindowFit::Three)
    {
      return Vf{ _mm512_mask_mov_ps(here, this->Behind, find(2)) };
    }
    else
    {
      return Vf{ _mm512_mask_mov_ps(
        here, this->Behind, _mm512_mask_mov_ps(find(2), this->Odd, find(3))) };
    }
  }

  __mmask16 Odd;     ///< lanes whose cells are in the second or fourth layer
  __mmask16 Behind;  ///< in the third or fourth one
  __mmask16 AtFirst; ///< lanes of Repeat()
  __mmask16 AtLast;
  __m512i First; ///< of the first numbers in pairs of rows
};
#endif

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
