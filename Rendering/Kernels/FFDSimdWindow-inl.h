// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Keeps the voxels of a packet in registers. Included once per target of Highway.
#if defined(FFD_SIMD_WINDOW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_WINDOW_INL_H_
#undef FFD_SIMD_WINDOW_INL_H_
#else
#define FFD_SIMD_WINDOW_INL_H_
#endif

#include "FFDPacketVolume.h"
#include "FFDTileSegment.h"

#include "FFDSimdFetch-inl.h"
#include "FFDSimdInterpolant-inl.h"
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

/// Layers of cells along z that a packet is in at a sample.
enum class WindowFit
{
  Two,
  Three,
  Four,
  None ///< it is wider than the window
};

template <class T, WindowFit Fit>
class WindowRows;

#if FFD_HAS_VOXEL_WINDOWS
/**
 * The rays of a packet are neighbors: all bytes that they need at one sample mostly lie in a
 * window of 8 x 8 x 5 voxels, or of a few layers more. VoxelWindow tells where the window begins,
 * from the curve in the middle of the packet, and fetches ahead what comes into it.
 */
template <class T>
class VoxelWindow
{
public:
  /// `v` must outlive the window.
  explicit VoxelWindow(const PacketVolume& v)
    : Volume(v)
    , LastCorner(
        _mm_setr_epi32(v.Dimensions[0] - Side + 1, v.Dimensions[1] - Side + 1, v.Dimensions[2], 0))
    , Usable(std::min({ v.Dimensions[0], v.Dimensions[1], v.Dimensions[2] }) >= Side)
  {
  }

  /// Prepares for the samples of the packet that is a block of a segment: sample n of each ray lies
  /// at s = (n - FirstSample + p) / Samples, p being at most `range` from `phase`.
  HWY_INLINE void Follow(const TileSegment& segment, int block, float phase, float range)
  {
    LoadMiddleTerms(D4(), segment, block, 0, this->Lowest);
    const __m128 speed = _mm_max_ps(Vector(segment.Up), Vector(segment.Down));
    const __m128 radius = _mm_fmadd_ps(_mm_set1_ps(range), speed, Vector(segment.Radius));
    this->Lowest[0] = V4{ _mm_sub_ps(this->Lowest[0].raw, radius) };
    this->Width = _mm_add_ps(radius, radius);
    this->Up = Vector(segment.Up);
    this->Down = Vector(segment.Down);
    this->PerStep = 1.0f / static_cast<float>(segment.Samples);
    this->Offset = phase - static_cast<float>(segment.FirstSample);
    // The offset of the first voxel of the slab that comes next from the first cell of the window.
    this->ToNextSlab =
      _mm_setr_epi32(-1, -1, segment.Up[2] > segment.Down[2] ? LargestDepth : -1, 0);
  }

  /// Moves the window to the samples n of the rays, `within`: to all places in the intervals that
  /// end there. All voxels that they and their gradients need must exist.
  HWY_INLINE WindowFit MoveTo(int n, bool within)
  {
    if (HWY_UNLIKELY(!this->Usable))
    {
      return WindowFit::None;
    }
    this->Prefetch(n + SamplesAhead);
    __m128 low = this->LowestAt(n);
    __m128 width = this->Width;
    if (within)
    {
      low = _mm_sub_ps(low, this->Up);
      width = _mm_add_ps(width, _mm_add_ps(this->Up, this->Down));
    }
    this->Corner = _mm_min_epi32(_mm_cvttps_epi32(low), this->LastCorner);
    const __m128i beyond = _mm_sub_epi32(_mm_cvttps_epi32(_mm_add_ps(low, width)), this->Corner);
    const __m128i most = _mm_setr_epi32(Reach, Reach, LargestDepth - 1, 0);
    if (_mm_movemask_epi8(_mm_cmpgt_epi32(beyond, most)) != 0)
    {
      return WindowFit::None;
    }
    const int layers = _mm_extract_epi32(beyond, 2) + 1;
    return layers <= 2 ? WindowFit::Two : layers == 3 ? WindowFit::Three : WindowFit::Four;
  }

private:
  template <class, WindowFit>
  friend class WindowRows;

  using D4 = hn::CappedTag<float, 4>;
  using V4 = hn::Vec<D4>;

  static constexpr int Side = 8;         ///< voxels along x and y
  static constexpr int Reach = Side - 4; ///< cells along x and y, beyond the first
  static constexpr int LargestDepth = 4; ///< cells along z
  static constexpr int SamplesAhead = 3;

  static HWY_INLINE __m128 Vector(const float v[3]) { return _mm_setr_ps(v[0], v[1], v[2], 0.0f); }

  /// A lower bound, index coordinates, of the positions of the samples n of all rays.
  HWY_INLINE __m128 LowestAt(int n) const
  {
    const float s = (static_cast<float>(n) + this->Offset) * this->PerStep;
    return EvaluateQuartic(D4(), this->Lowest, hn::Set(D4(), s)).raw;
  }

  /// Prefetches the slab of voxels that enters the window with the samples n.
  HWY_INLINE void Prefetch(int n) const
  {
    const PacketVolume& v = this->Volume;
    const __m128i last =
      _mm_setr_epi32(v.Dimensions[0] - Side, v.Dimensions[1] - Side, v.Dimensions[2] - 1, 0);
    const __m128i next = _mm_add_epi32(_mm_cvttps_epi32(this->LowestAt(n)), this->ToNextSlab);
    const __m128i at = _mm_max_epi32(_mm_min_epi32(next, last), _mm_setzero_si128());
    const std::ptrdiff_t stepY = v.IncrementY;
    const char* const rows = static_cast<const char*>(v.Scalars) +
      _mm_extract_epi32(at, 2) * static_cast<std::ptrdiff_t>(v.IncrementZ) +
      _mm_extract_epi32(at, 1) * stepY + _mm_cvtsi128_si32(at);
    for (int row = 0; row < Side; ++row)
    {
      _mm_prefetch(rows + row * stepY, _MM_HINT_T0);
    }
  }

  const PacketVolume& Volume;
  __m128i LastCorner;
  bool Usable; ///< whether the volume is as large as a window
  float PerStep = 0.0f;
  float Offset = 0.0f;
  V4 Lowest[TileLayers]; ///< terms of the curve that no ray is below
  __m128 Width;          ///< largest distance of a ray above that curve
  __m128 Up;             ///< bounds of the motion of a ray from sample to sample
  __m128 Down;
  __m128i ToNextSlab;
  __m128i Corner; ///< first cell along each axis
};

/**
 * The rows of a sample: the window is loaded into registers, slab by slab, and rows are looked up
 * there by permutations of bytes, where loads lane by lane would take several times as many
 * instructions. A source of rows as OffsetRows.
 */
template <class T, WindowFit Fit>
class WindowRows
{
public:
  /// `window`: moved to the sample, which `cells` are of.
  HWY_INLINE WindowRows(const VoxelWindow<T>& window, const SampleCells& cells)
  {
    const Di di;
    const int x = _mm_cvtsi128_si32(window.Corner);
    const int y = _mm_extract_epi32(window.Corner, 1);
    const int z = _mm_extract_epi32(window.Corner, 2);
    this->StepY = window.Volume.IncrementY;
    this->StepZ = window.Volume.IncrementZ;
    this->First = static_cast<const std::uint8_t*>(window.Volume.Scalars) + (z - 1) * this->StepZ +
      (y - 1) * this->StepY + x - 1;
    const Vi dz = hn::Sub(cells.Z, hn::Set(di, z));
    const Vi odd = Fit == WindowFit::Two ? dz : hn::And(dz, hn::Set(di, 1));
    this->High = _mm512_cmpgt_epi32_mask(dz.raw, _mm512_set1_epi32(1));
    // Numbers, within two slabs, of the four bytes of the row at (0, 0).
    const Vi at = hn::Add(hn::ShiftLeft<6>(odd),
      hn::Add(hn::ShiftLeft<3>(cells.Y), hn::Sub(cells.X, hn::Set(di, x + 8 * (y - 1)))));
    this->Index = _mm512_add_epi8(
      _mm512_shuffle_epi8(at.raw, _mm512_set4_epi32(0x0c0c0c0c, 0x08080808, 0x04040404, 0)),
      _mm512_set1_epi32(0x03020100));
    for (int k = 1; k < NumberOfSlabs - 1; ++k)
    {
      this->Slabs[k] = this->LoadSlab(k);
    }
  }

  /// Before Gradient(): the voxels that it alone needs.
  HWY_INLINE void Widen()
  {
    this->Slabs[0] = this->LoadSlab(0);
    this->Slabs[NumberOfSlabs - 1] = this->LoadSlab(NumberOfSlabs - 1);
  }

  HWY_INLINE Vi Row(int dy, int dz) const
  {
    const __m512i index = _mm512_add_epi8(this->Index, _mm512_set1_epi8(static_cast<char>(8 * dy)));
    const __m512i* const slab = this->Slabs + 1 + dz;
    const __m512i low = _mm512_permutex2var_epi8(slab[0], index, slab[1]);
    if constexpr (Fit == WindowFit::Two)
    {
      return Vi{ low };
    }
    else
    {
      const __m512i high = Fit == WindowFit::Three
        ? _mm512_permutexvar_epi8(index, slab[2])
        : _mm512_permutex2var_epi8(slab[2], index, slab[3]);
      return Vi{ _mm512_mask_mov_epi32(low, this->High, high) };
    }
  }

  HWY_INLINE Vi Middle(int dy, int dz, const SamplePosition& at) const
  {
    return Fetch<T>::Middle(this->Row(dy, dz), at);
  }

private:
  /// Voxels along z.
  static constexpr int NumberOfSlabs = Fit == WindowFit::Two ? 5 : Fit == WindowFit::Three ? 6 : 7;

  HWY_INLINE __m512i LoadSlab(int slab) const
  {
    const std::uint8_t* const first = this->First + slab * this->StepZ;
    const auto twoRows = [&](int row) {
      const std::uint8_t* const from = first + row * this->StepY;
      const __m128i low = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(from));
      return _mm_castps_si128(
        _mm_loadh_pi(_mm_castsi128_ps(low), reinterpret_cast<const __m64*>(from + this->StepY)));
    };
    const auto fourRows = [&](int row) {
      return _mm256_inserti128_si256(_mm256_castsi128_si256(twoRows(row)), twoRows(row + 2), 1);
    };
    return _mm512_inserti64x4(_mm512_castsi256_si512(fourRows(0)), fourRows(4), 1);
  }

  const std::uint8_t* First; ///< voxel of the window, one before the first cell
  std::ptrdiff_t StepY;
  std::ptrdiff_t StepZ;
  __m512i Index;
  __mmask16 High;
  __m512i Slabs[NumberOfSlabs];
};
#else
/// Not used.
template <class T>
class VoxelWindow
{
public:
  explicit VoxelWindow(const PacketVolume&) {}
};
#endif

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
