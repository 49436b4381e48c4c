// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The rows of samples in a window of voxels. Included once per target of Highway.
#if defined(FFD_SIMD_WINDOW_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_WINDOW_ROWS_INL_H_
#undef FFD_SIMD_WINDOW_ROWS_INL_H_
#else
#define FFD_SIMD_WINDOW_ROWS_INL_H_
#endif

#include "FFDPacketVolume.h"

#include "FFDSimdCells-inl.h"
#include "FFDSimdFetch-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdWindow-inl.h"
#include "FFDSimdWindowBytes-inl.h"
#include "FFDSimdWindowNumbers-inl.h"
#include "FFDSimdWindowWords-inl.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

#if FFD_HAS_VOXEL_WINDOWS
/// Where the rows of a window are, all voxels of which exist.
template <class T, bool AtFaces, int Components>
class WindowAddresses
{
public:
  HWY_INLINE WindowAddresses(const VoxelWindow<T>& window, int x, int y, int z)
    : ToRows(window.ToRows)
    , StepY(window.Volume.IncrementY)
    , StepZ(window.Volume.IncrementZ)
    , First(static_cast<const T*>(window.Volume.Scalars) + (z - 1) * this->StepZ +
        (y - 1) * this->StepY + (x - 1) * std::ptrdiff_t{ window.Volume.Components })
    , FirstX(x - 1)
  {
  }

  HWY_INLINE const T* Get(int slab, int row) const
  {
    return this->First + slab * this->StepZ +
      (Components > 1 ? std::ptrdiff_t{ this->ToRows[row] } : row * this->StepY);
  }

  /// The first voxel along x.
  HWY_INLINE int GetFirstX() const { return this->FirstX; }

private:
  const std::int64_t* ToRows; ///< VoxelWindow::ToRows
  std::ptrdiff_t StepY;
  std::ptrdiff_t StepZ;
  const T* First;
  int FirstX;
};

/// The same at the faces of the volume, where the outermost voxels are repeated; along x rows begin
/// where eight voxels exist.
template <class T, int Components>
class WindowAddresses<T, true, Components>
{
public:
  HWY_INLINE WindowAddresses(const VoxelWindow<T>& window, int x, int y, int z)
    : FirstX(std::clamp(x - 1, 0, window.Volume.Dimensions[0] - 8))
  {
    const PacketVolume& v = window.Volume;
    const T* const first =
      static_cast<const T*>(v.Scalars) + this->FirstX * std::ptrdiff_t{ v.Components };
    for (int k = 0; k < 8; ++k)
    {
      this->Slabs[k] =
        first + std::clamp(z - 1 + k, 0, v.Dimensions[2] - 1) * std::ptrdiff_t{ v.IncrementZ };
      this->Rows[k] =
        std::clamp(y - 1 + k, 0, v.Dimensions[1] - 1) * std::ptrdiff_t{ v.IncrementY };
    }
  }

  HWY_INLINE const T* Get(int slab, int row) const { return this->Slabs[slab] + this->Rows[row]; }

  HWY_INLINE int GetFirstX() const { return this->FirstX; }

private:
  const T* Slabs[8];
  std::ptrdiff_t Rows[8];
  int FirstX;
};

/**
 * The rows of a sample: the window is loaded into registers, slab by slab, and rows are looked up
 * there by permutations, where loads lane by lane would take several times as many instructions. A
 * source of rows as OffsetRows. `AtFaces`: voxels that they or their gradients need may not exist.
 * Of two or four components, one.
 */
template <class T, WindowFit Fit, bool AtFaces, int Components>
class WindowRows
{
public:
  /// `window`: moved to the sample, which `cells` are of. `component`: whose voxels are looked up.
  HWY_INLINE WindowRows(
    const VoxelWindow<T>& window, const SampleCells& cells, int component = Components - 1)
    : WindowRows(window, cells, component, Empty())
  {
    this->FetchAhead(window);
    for (int k = 1; k < NumberOfSlabs - 1; ++k)
    {
      this->LoadCells(k);
    }
  }

  static constexpr bool IsRepeating() { return AtFaces; }

  /// Before Gradient(): the voxels that it alone needs.
  HWY_INLINE void Widen()
  {
    this->LoadCells(0);
    this->LoadCells(NumberOfSlabs - 1);
    for (int k = 1; k < NumberOfSlabs - 1; ++k)
    {
      this->Slabs[k].template LoadOuter<Components>(this->Volume, this->Voxels, k, this->Component);
    }
  }

  HWY_INLINE typename Fetch<T>::Row Row(int dy, int dz) const
  {
    return this->Places.Row(this->Slabs + 1 + dz, dy);
  }

  HWY_INLINE auto Middle(int dy, int dz, const SamplePosition& at) const
  {
    return this->Places.Middle(this->Slabs + 1 + dz, dy, at);
  }

private:
  template <class, WindowFit, bool>
  friend class WindowPair;

  /// Tells that no voxels are loaded.
  struct Empty
  {
  };

  HWY_INLINE WindowRows(
    const VoxelWindow<T>& window, const SampleCells& cells, int component, Empty)
    : Volume(window.Volume)
    , Component(component)
    , Voxels(window, _mm_cvtsi128_si32(window.Corner), _mm_extract_epi32(window.Corner, 1),
        _mm_extract_epi32(window.Corner, 2))
  {
    const Di di;
    const int y = _mm_extract_epi32(window.Corner, 1);
    const int z = _mm_extract_epi32(window.Corner, 2);
    const int corner = this->Voxels.GetFirstX() + 1 + 8 * (y - 1);
    this->Places = { hn::Add(hn::ShiftLeft<3>(cells.Y), hn::Sub(cells.X, hn::Set(di, corner))),
      hn::Sub(cells.Z, hn::Set(di, z)) };
    if constexpr (AtFaces)
    {
      // Before the first voxel and behind the last one these are repeated.
      this->Places.Repeat(_mm512_cmpeq_epi32_mask(cells.X.raw, _mm512_setzero_si512()),
        _mm512_cmpeq_epi32_mask(cells.X.raw, _mm512_set1_epi32(window.Volume.Dimensions[0] - 2)));
    }
  }

  static constexpr std::size_t RowBytes = VoxelWindow<T>::Side * Components * sizeof(T);
  static constexpr std::size_t LineBytes = 64; ///< of caches

  /// Voxels along z.
  static constexpr int NumberOfSlabs = Fit == WindowFit::Two ? 5 : Fit == WindowFit::Three ? 6 : 7;

  static HWY_INLINE void Prefetch(std::uintptr_t at)
  {
    _mm_prefetch(reinterpret_cast<const char*>(at), _MM_HINT_T0);
  }

  /// Fetches the slab that comes in some samples later.
  HWY_INLINE void FetchAhead(const VoxelWindow<T>& window) const
  {
    if constexpr (!AtFaces)
    {
      // Nothing is read there: it may lie outside of the volume.
      for (int row = 0; row < VoxelWindow<T>::Side; ++row)
      {
        const std::uintptr_t at = reinterpret_cast<std::uintptr_t>(this->Voxels.Get(0, row)) +
          static_cast<std::uintptr_t>(window.ToNextSlab);
        Prefetch(at);
        // Rows may end in the line behind the one that they begin in. Longer ones do not gain.
        if constexpr (RowBytes > LineBytes / 4 && RowBytes <= LineBytes)
        {
          Prefetch(at + RowBytes - 1);
        }
      }
    }
  }

  HWY_INLINE void LoadCells(int slab)
  {
    this->Slabs[slab].template LoadCells<Components>(
      this->Volume, this->Voxels, slab, this->Component);
  }

  const PacketVolume& Volume;
  int Component;
  /// From one before the first cell along each axis.
  WindowAddresses<T, AtFaces, Components> Voxels;
  WindowPlaces<T, Fit, AtFaces> Places; ///< of the rows at (0, 0)
  WindowSlab<T> Slabs[NumberOfSlabs];
};

/// The rows of both components of a volume of two, whose voxels are loaded together.
template <class T, WindowFit Fit, bool AtFaces>
class WindowPair
{
public:
  using Rows = WindowRows<T, Fit, AtFaces, 2>;

  /// As WindowRows.
  HWY_INLINE WindowPair(const VoxelWindow<T>& window, const SampleCells& cells)
    : First(window, cells, 0, typename Rows::Empty())
    , Second(window, cells, 1, typename Rows::Empty())
  {
    this->First.FetchAhead(window);
    for (int k = 1; k < Rows::NumberOfSlabs - 1; ++k)
    {
      if constexpr (std::is_same_v<T, std::uint8_t>)
      {
        WindowSlab<T>::LoadBoth(this->First.Voxels, k, this->First.Slabs[k], this->Second.Slabs[k]);
      }
      else
      {
        this->First.LoadCells(k);
        this->Second.LoadCells(k);
      }
    }
  }

  Rows First;
  Rows Second;
};
#endif

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
