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
  /// Loads the rows that are voxels of the cells, of a component.
  template <int Components, class Addresses>
  HWY_INLINE void LoadCells(const PacketVolume& v, const Addresses& voxels, int slab, int component)
  {
    for (int row = 1; row < WindowRowsAlongY<T>() - 1; ++row)
    {
      this->LoadRow<Components>(v, voxels, slab, row, component);
    }
  }

  /// Loads the rows beside these.
  template <int Components, class Addresses>
  HWY_INLINE void LoadOuter(const PacketVolume& v, const Addresses& voxels, int slab, int component)
  {
    this->LoadRow<Components>(v, voxels, slab, 0, component);
    this->LoadRow<Components>(v, voxels, slab, WindowRowsAlongY<T>() - 1, component);
  }

  /// Two rows.
  HWY_INLINE __m512 GetPair(int row) const
  {
    const __m256 first = _mm256_load_ps(this->Rows[row]);
    return _mm512_insertf32x8(
      _mm512_castps256_ps512(first), _mm256_load_ps(this->Rows[row + 1]), 1);
  }

private:
  template <int Components, class Addresses>
  HWY_INLINE void LoadRow(
    const PacketVolume& v, const Addresses& voxels, int slab, int row, int component)
  {
    const T* const from = voxels.Get(slab, row);
    _mm256_store_ps(
      this->Rows[row], ToFloats(v, LoadEight<Components>(from, component), component));
  }

  /// The numbers, as they are in memory, of a component of eight voxels.
  template <int Components>
  static HWY_INLINE auto LoadEight(const T* row, int component)
  {
    static_assert(Components <= 2, "of more, lanes load their voxels sooner by themselves");
    if constexpr (sizeof(T) == 8)
    {
      const __m512d first = _mm512_loadu_pd(row);
      if constexpr (Components == 1)
      {
        static_cast<void>(component);
        return first;
      }
      else
      {
        const __m512i at = _mm512_add_epi64(
          _mm512_setr_epi64(0, 2, 4, 6, 8, 10, 12, 14), _mm512_set1_epi64(component));
        return _mm512_permutex2var_pd(first, at, _mm512_loadu_pd(row + 8));
      }
    }
    else if constexpr (Components == 1)
    {
      static_cast<void>(component);
      return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(row));
    }
    else
    {
      const __m256i at = _mm256_add_epi32(
        _mm256_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14), _mm256_set1_epi32(component));
      return _mm512_castsi512_si256(
        _mm512_permutexvar_epi32(_mm512_castsi256_si512(at), _mm512_loadu_si512(row)));
    }
  }

  static HWY_INLINE __m256 ToFloats(const PacketVolume& v, __m256i words, int component)
  {
    if constexpr (std::is_same<T, float>::value)
    {
      static_cast<void>(v);
      static_cast<void>(component);
      return _mm256_castsi256_ps(words);
    }
    else
    {
      // As FromWords().
      const PacketWords& of = v.Words[component];
      const __m256i difference = _mm256_sub_epi32(words, _mm256_set1_epi32(of.Origin));
      return _mm256_fmadd_ps(
        _mm256_cvtepi32_ps(difference), _mm256_set1_ps(of.Unit), _mm256_set1_ps(of.Zero));
    }
  }

  /// Of numbers of 64 bits, which may be integers.
  static HWY_INLINE __m256 ToFloats(const PacketVolume& v, __m512d numbers, int component)
  {
    if (HWY_UNLIKELY(v.Type != ScalarType::Float64))
    {
      const __m512i integers = _mm512_castpd_si512(numbers);
      numbers =
        v.Type == ScalarType::Int64 ? _mm512_cvtepi64_pd(integers) : _mm512_cvtepu64_pd(integers);
    }
    return _mm512_cvtpd_ps(_mm512_mul_pd(_mm512_sub_pd(numbers, _mm512_set1_pd(v.Shift[component])),
      _mm512_set1_pd(v.Scale[component])));
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
