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

#include "FFDSimdCells-inl.h"
#include "FFDSimdCurve-inl.h"
#include "FFDSimdFetch-inl.h"
#include "FFDSimdInterpolant-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdRows-inl.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

// Permutations of two registers, which Highway has no words for: of words by AVX-512, of bytes by
// its VBMI.
#undef FFD_HAS_VOXEL_WINDOWS
#undef FFD_HAS_BYTE_PERMUTATIONS
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
#define FFD_HAS_VOXEL_WINDOWS 1
#else
#define FFD_HAS_VOXEL_WINDOWS 0
#endif
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3_DL
#define FFD_HAS_BYTE_PERMUTATIONS 1
#else
#define FFD_HAS_BYTE_PERMUTATIONS 0
#endif

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Whether the rows of scalars can be looked up in a VoxelWindow.
constexpr bool HasVoxelWindow() { return FFD_HAS_VOXEL_WINDOWS; }

/// Whether those of one of several components can be, too. Of four wide ones lanes load their
/// voxels sooner by themselves.
template <class T>
constexpr bool HasWindowOfOne(int components)
{
  return HasVoxelWindow() && (components == 2 || (components == 4 && sizeof(T) == 1));
}

/// Layers of cells along z that a packet may be in at a sample of a segment.
enum class WindowFit
{
  Two,
  Three,
  Four,
  None ///< it may be wider than the window
};

template <class T, WindowFit Fit, bool AtFaces = false, int Components = 1>
class WindowRows;

template <class T, WindowFit Fit, bool AtFaces>
class WindowPair;

#if FFD_HAS_VOXEL_WINDOWS
/// A slab of a window, 8 x 8 voxels along x and y, in registers, row by row.
template <class T>
class WindowSlab;

/// Where the voxels of the cells of each lane are in the slabs of a window.
template <class T, WindowFit Fit, bool AtFaces>
class WindowPlaces;

/// Rows along y of a window: eight of integers of one or two bytes, which are looked up in the
/// registers that hold all of them, and seven of other numbers, of which registers hold four.
template <class T>
constexpr int WindowRowsAlongY()
{
  return sizeof(T) <= 2 ? 8 : 7;
}

/// A register of two halves. Halves are filled by blends of 256 bits, which take half as long as
/// masked ones of 512 bits where a processor executes these in two steps, and no longer elsewhere.
HWY_INLINE __m512i JoinHalves(__m256i low, __m256i high)
{
  return _mm512_inserti64x4(_mm512_castsi256_si512(low), high, 1);
}

/// Two rows of 16 bytes.
HWY_INLINE __m256i LoadTwo(const void* row, const void* next)
{
  const auto load = [](const void* from) {
    return _mm_loadu_si128(static_cast<const __m128i*>(from));
  };
  return _mm256_inserti128_si256(_mm256_castsi128_si256(load(row)), load(next), 1);
}

/// Which lanes are in the third or fourth layer of a window.
HWY_INLINE __mmask16 IsBehind(Vi layer)
{
  return _mm512_cmpgt_epi32_mask(layer.raw, _mm512_set1_epi32(1));
}

/// Numbers in a slab as those in two, which those of the second or fourth layer are in the second
/// of.
template <WindowFit Fit>
HWY_INLINE Vi AddOddLayers(Vi numbers, Vi layer)
{
  const Vi odd = Fit == WindowFit::Two ? layer : hn::And(layer, hn::Set(Di(), 1));
  return hn::Add(hn::ShiftLeft<6>(odd), numbers);
}

/**
 * The rays of a packet are neighbors: all voxels that they need at one sample mostly lie in a
 * window of 8 x 8 x 5 voxels, or 8 x 7 x 5, or of a few layers more. VoxelWindow tells where the
 * window begins, from the curve in the middle of the packet, and fetches ahead what comes into it.
 * Whether a window is large enough is told for a segment as a whole: that of each sample by itself
 * would be a branch that processors cannot foretell.
 */
template <class T>
class VoxelWindow
{
public:
  /// `scene` must outlive the window.
  explicit VoxelWindow(const PacketScene& scene)
    : Volume(scene.Volume)
    , Grid(scene.Grid)
    , IndexShift(Vector(scene.IndexShift))
  {
    const int* const n = scene.Volume.Dimensions;
    this->Usable = std::min({ n[0], n[1], n[2] }) >= Side && AreOfType(scene.Volume);
    this->LastCell = _mm_setr_epi32(n[0] - 2, n[1] - 2, n[2] - 2, 0);
  }

  /// Prepares for the samples that the lanes of `rays` take of a curve, of the block of a segment.
  /// `within`: also for all places in the intervals that end there.
  HWY_INLINE void Follow(
    const PacketCurve& curve, const SampleNumbers& numbers, Mf rays, int block, bool within)
  {
    const TileSegment& segment = *curve.Segment;
    LoadMiddleTerms(D4(), segment, block, 0, this->Lowest);
    Vec3 low;
    Vec3 high;
    FindExtent(curve, numbers, block, low, high);
    const auto reduce = [rays](const Vec3& v, float others, const auto& choose) {
      const Vf none = Splat(others);
      const Vec3 shown{ hn::IfThenElse(rays, v.x, none), hn::IfThenElse(rays, v.y, none),
        hn::IfThenElse(rays, v.z, none) };
      return ReduceLanes(shown, choose);
    };
    const __m128 rounding = _mm_set1_ps(Rounding);
    const auto smaller = [](auto a, auto b) { return hn::Min(a, b); };
    const auto larger = [](auto a, auto b) { return hn::Max(a, b); };
    __m128 from = _mm_sub_ps(reduce(low, 1e9f, smaller), rounding);
    __m128 to = _mm_add_ps(reduce(high, -1e9f, larger), rounding);
    if (within)
    {
      from = _mm_sub_ps(from, Vector(segment.Up));
      to = _mm_add_ps(to, Vector(segment.Down));
    }
    __m128 width = _mm_sub_ps(to, from);
    this->Lowest[0] = V4{ _mm_add_ps(_mm_sub_ps(this->Lowest[0].raw, this->IndexShift), from) };
    if (HWY_UNLIKELY(this->Grid.Uneven))
    {
      width = this->FindWidest(width);
    }
    this->PerStep = 1.0f / static_cast<float>(segment.Samples);
    this->Offset = -static_cast<float>(segment.FirstSample);
    this->Fit = this->Usable ? FindFit(width) : WindowFit::None;
    const int layers = this->Fit == WindowFit::Two ? 2
      : this->Fit == WindowFit::Three              ? 3
                                                   : LargestDepth;
    const int lastRow = this->Volume.Components > 1 ? this->FindRows(width) : RowsAlongY - 1;
    // The last corner from which all slabs lie in the volume.
    this->LastCorner = _mm_setr_epi32(this->Volume.Dimensions[0] - Side + 1,
      this->Volume.Dimensions[1] - lastRow, this->Volume.Dimensions[2] - layers - 2, 0);
    this->ToNextSlab = this->FindNextSlab(layers);
  }

  /// Before samples that are not those of one number of the rays.
  HWY_INLINE void Leave() { this->Fit = WindowFit::None; }

  /// Which window holds all voxels of any sample of the segment.
  HWY_INLINE WindowFit GetFit() const { return this->Fit; }

  /// Moves the window to the samples n of the rays. Without `AtFaces` all voxels that they and
  /// their gradients need must exist; without `AnyGrid` the volume is a plain image.
  template <bool AtFaces, bool AnyGrid = true>
  HWY_INLINE void MoveTo(int n)
  {
    __m128 lowest = this->LowestAt(n);
    if (AnyGrid && HWY_UNLIKELY(this->Grid.Uneven))
    {
      lowest = this->ToVoxels(lowest);
    }
    if constexpr (AtFaces)
    {
      // The last position is in the cell before it.
      this->Corner = _mm_min_epi32(_mm_cvttps_epi32(_mm_floor_ps(lowest)), this->LastCell);
    }
    else
    {
      // The window may begin before or after positions that none of the rays is at.
      const __m128i low = _mm_max_epi32(_mm_cvttps_epi32(lowest), _mm_set1_epi32(1));
      this->Corner = _mm_min_epi32(low, this->LastCorner);
    }
  }

private:
  template <class, WindowFit, bool, int>
  friend class WindowRows;
  template <class, bool, int>
  friend class WindowAddresses;

  using D4 = hn::CappedTag<float, 4>;
  using V4 = hn::Vec<D4>;

  static constexpr int Side = 8; ///< voxels along x, and along y at most
  static constexpr int RowsAlongY = WindowRowsAlongY<T>();
  static constexpr int LargestDepth = 4; ///< cells along z
  static constexpr int SamplesAhead = 3;
  static constexpr float Rounding = 0.02f;      ///< of positions, voxels: some times what it is
  static constexpr float VoxelRounding = 2e-3f; ///< of positions from an AxisMap, the same

  static HWY_INLINE __m128 Vector(const float v[3]) { return _mm_setr_ps(v[0], v[1], v[2], 0.0f); }

  /**
   * Finds bounds of the way to the samples n of each lane from the middle of the block at s = (n -
   * FirstSample) / Samples: the extremes of the Bezier coefficients of their difference, which is a
   * quartic in s.
   */
  static HWY_INLINE void FindExtent(
    const PacketCurve& curve, const SampleNumbers& numbers, int block, Vec3& low, Vec3& high)
  {
    const Vf shift = hn::Mul(numbers.Phase, curve.PerStep);
    const auto extent = [&](Vf Vec3::*axis, std::size_t a) {
      Vf t[TileLayers];
      for (int k = 0; k < TileLayers; ++k)
      {
        t[k] = curve.Position.Terms[k].*axis;
      }
      if (curve.Interpolated)
      {
        // The terms of s + shift: Horner's scheme, once for each.
        for (int k = 0; k < TileLayers; ++k)
        {
          for (int i = TileLayers - 2; i >= k; --i)
          {
            t[i] = hn::MulAdd(shift, t[i + 1], t[i]);
          }
        }
      }
      else
      {
        t[0] = hn::MulAdd(shift, t[1], t[0]);
      }
      for (std::size_t k = 0; k < TileLayers; ++k)
      {
        t[k] =
          hn::Sub(t[k], Splat(curve.Segment->MiddleTerms[k][static_cast<std::size_t>(block)][a]));
      }
      Vf b[TileLayers];
      FindBezier(t, b);
      low.*axis = hn::Min(hn::Min(b[0], b[1]), hn::Min(hn::Min(b[2], b[3]), b[4]));
      high.*axis = hn::Max(hn::Max(b[0], b[1]), hn::Max(hn::Max(b[2], b[3]), b[4]));
    };
    extent(&Vec3::x, 0);
    extent(&Vec3::y, 1);
    extent(&Vec3::z, 2);
  }

  /// Reduces the lanes of three vectors to one each.
  template <class Choose>
  static HWY_INLINE __m128 ReduceLanes(const Vec3& v, const Choose& choose)
  {
    const hn::CappedTag<float, 8> d8;
    const D4 d4;
    const auto toFour = [&](Vf lanes) {
      const auto eight = choose(hn::LowerHalf(d8, lanes), hn::UpperHalf(d8, lanes));
      return choose(hn::LowerHalf(d4, eight), hn::UpperHalf(d4, eight));
    };
    const __m128 x = toFour(v.x).raw;
    const __m128 y = toFour(v.y).raw;
    const __m128 z = toFour(v.z).raw;
    // A transposition of 4 x 4 numbers, of which the last column does not count.
    const __m128 xy0 = _mm_unpacklo_ps(x, y);
    const __m128 xy1 = _mm_unpackhi_ps(x, y);
    const __m128 z0 = _mm_unpacklo_ps(z, z);
    const __m128 z1 = _mm_unpackhi_ps(z, z);
    const V4 a{ _mm_movelh_ps(xy0, z0) };
    const V4 b{ _mm_movehl_ps(z0, xy0) };
    const V4 c{ _mm_movelh_ps(xy1, z1) };
    const V4 e{ _mm_movehl_ps(z1, xy1) };
    return choose(choose(a, b), choose(c, e)).raw;
  }

  /// Whether WindowSlab reads scalars of the type.
  static HWY_INLINE bool AreOfType(const PacketVolume& v)
  {
    const bool wide =
      v.Type == ScalarType::Float64 || v.Type == ScalarType::Int64 || v.Type == ScalarType::UInt64;
    return !std::is_same<T, double>::value || (wide && !v.MayOverflow);
  }

  /// Finds the window for positions that extend over `width`, wherever they begin.
  static HWY_INLINE WindowFit FindFit(__m128 width)
  {
    // Cells beyond the first: one voxel is before that, and two are behind the last.
    const auto isWithin = [width](int layers) {
      const __m128 most = _mm_setr_ps(static_cast<float>(Side - 4),
        static_cast<float>(RowsAlongY - 4), static_cast<float>(layers - 1), 0.0f);
      return (_mm_movemask_ps(_mm_cmpgt_ps(width, most)) & 7) == 0;
    };
    return isWithin(2)         ? WindowFit::Two
      : isWithin(3)            ? WindowFit::Three
      : isWithin(LargestDepth) ? WindowFit::Four
                               : WindowFit::None;
  }

  /// Voxel coordinates of index coordinates, rounded down.
  HWY_INLINE __m128 ToVoxels(__m128 index) const
  {
    alignas(16) float x[4];
    _mm_store_ps(x, index);
    const auto find = [&](int a) { return this->Grid.Axes[a].ToVoxel(x[a]) - VoxelRounding; };
    return _mm_setr_ps(find(0), find(1), find(2), 0.0f);
  }

  /// Finds the rows along y that gradients at positions may need that extend over `width`; returns
  /// the last one.
  HWY_INLINE int FindRows(__m128 width)
  {
    // One is before the first cell, two are behind the last one.
    const __m128 last =
      _mm_min_ps(_mm_add_ps(_mm_ceil_ps(width), _mm_set1_ps(3.0f)), _mm_set1_ps(RowsAlongY - 1));
    const int lastAlongY = std::max(4, _mm_extract_epi32(_mm_cvttps_epi32(last), 1));
    const __m512i rows =
      _mm512_min_epi64(_mm512_setr_epi64(0, 1, 2, 3, 4, 5, 6, 7), _mm512_set1_epi64(lastAlongY));
    _mm512_store_si512(
      this->ToRows, _mm512_mullo_epi64(rows, _mm512_set1_epi64(this->Volume.IncrementY)));
    return lastAlongY;
  }

  /// A bound, voxels, of the ranges of voxel coordinates of positions that extend over `width`,
  /// index units, from those of Lowest on.
  HWY_NOINLINE __m128 FindWidest(__m128 width) const
  {
    __m128 low = this->Lowest[0].raw;
    __m128 high = _mm_add_ps(low, width);
    for (int k = 1; k < TileLayers; ++k)
    {
      low = _mm_add_ps(low, _mm_min_ps(this->Lowest[k].raw, _mm_setzero_ps()));
      high = _mm_add_ps(high, _mm_max_ps(this->Lowest[k].raw, _mm_setzero_ps()));
    }
    alignas(16) float from[4], to[4];
    _mm_store_ps(from, low);
    _mm_store_ps(to, high);
    const auto slope = [&](int a) { return this->Grid.Axes[a].FindSteepest(from[a], to[a]); };
    return _mm_add_ps(_mm_mul_ps(width, _mm_setr_ps(slope(0), slope(1), slope(2), 0.0f)),
      _mm_set1_ps(2.0f * VoxelRounding));
  }

  /// A lower bound, index coordinates, of the positions of the samples n of all rays.
  HWY_INLINE __m128 LowestAt(int n) const
  {
    const float s = (static_cast<float>(n) + this->Offset) * this->PerStep;
    return EvaluateQuartic(D4(), this->Lowest, hn::Set(D4(), s)).raw;
  }

  /// Finds the offset in bytes, from the first voxel of a window of some layers of cells, of the
  /// slab that enters it some samples later, on average over the segment.
  HWY_INLINE std::ptrdiff_t FindNextSlab(int layers) const
  {
    const __m128 sum = _mm_add_ps(_mm_add_ps(this->Lowest[1].raw, this->Lowest[2].raw),
      _mm_add_ps(this->Lowest[3].raw, this->Lowest[4].raw));
    const __m128i move =
      _mm_cvtps_epi32(_mm_mul_ps(sum, _mm_set1_ps(SamplesAhead * this->PerStep)));
    const int alongZ = _mm_extract_epi32(move, 2);
    const int slab = alongZ < 0 ? alongZ : alongZ + layers + 2;
    return static_cast<std::ptrdiff_t>(sizeof(T)) *
      (slab * static_cast<std::ptrdiff_t>(this->Volume.IncrementZ) +
        _mm_extract_epi32(move, 1) * static_cast<std::ptrdiff_t>(this->Volume.IncrementY) +
        _mm_cvtsi128_si32(move) * static_cast<std::ptrdiff_t>(this->Volume.Components));
  }

  const PacketVolume& Volume;
  const PacketGrid& Grid;
  __m128 IndexShift; ///< PacketScene::IndexShift
  bool Usable;       ///< whether the volume is as large as a window
  __m128i LastCell;
  WindowFit Fit = WindowFit::None;
  float PerStep = 0.0f;
  float Offset = 0.0f;
  V4 Lowest[TileLayers]; ///< terms of the curve that no position is below
  __m128i LastCorner;
  std::ptrdiff_t ToNextSlab;
  /// Of several components: elements from the first row along y to each one. The last one that may
  /// be needed stands for those behind it, whose lines of the cache would come from memory.
  HWY_ALIGN std::int64_t ToRows[8];
  __m128i Corner; ///< first cell along each axis
};
#else
/// Not used.
template <class T>
class VoxelWindow
{
public:
  explicit VoxelWindow(const PacketScene&) {}
};
#endif

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
