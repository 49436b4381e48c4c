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

/// Whether the rows of a scalar type can be looked up in a VoxelWindow.
template <class T>
constexpr bool HasVoxelWindow()
{
  return FFD_HAS_VOXEL_WINDOWS && std::is_same<T, std::uint8_t>::value;
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

#if FFD_HAS_VOXEL_WINDOWS
/**
 * The rays of a packet are neighbors: all bytes that they need at one sample mostly lie in a
 * window of 8 x 8 x 5 voxels, or of a few layers more. VoxelWindow tells where the window begins,
 * from the curve in the middle of the packet, and fetches ahead what comes into it. Whether a
 * window is large enough is told for a segment as a whole: that of each sample by itself would be
 * a branch that processors cannot foretell.
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
    this->Usable = std::min({ n[0], n[1], n[2] }) >= Side;
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
    // The last corner from which all slabs lie in the volume.
    this->LastCorner = _mm_setr_epi32(this->Volume.Dimensions[0] - Side + 1,
      this->Volume.Dimensions[1] - Side + 1, this->Volume.Dimensions[2] - layers - 2, 0);
    this->ToNextSlab = this->FindNextSlab(layers);
  }

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

  using D4 = hn::CappedTag<float, 4>;
  using V4 = hn::Vec<D4>;

  static constexpr int Side = 8;         ///< voxels along x and y
  static constexpr int Reach = Side - 4; ///< cells along x and y, beyond the first
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

  /// Finds the window for positions that extend over `width`, wherever they begin.
  static HWY_INLINE WindowFit FindFit(__m128 width)
  {
    const float reach = static_cast<float>(Reach);
    const auto isWithin = [width, reach](int layers) {
      const __m128 most = _mm_setr_ps(reach, reach, static_cast<float>(layers - 1), 0.0f);
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

  /// Finds the offset, from the first voxel of a window of some layers of cells, of the slab that
  /// enters it some samples later, on average over the segment.
  HWY_INLINE std::ptrdiff_t FindNextSlab(int layers) const
  {
    const __m128 sum = _mm_add_ps(_mm_add_ps(this->Lowest[1].raw, this->Lowest[2].raw),
      _mm_add_ps(this->Lowest[3].raw, this->Lowest[4].raw));
    const __m128i move =
      _mm_cvtps_epi32(_mm_mul_ps(sum, _mm_set1_ps(SamplesAhead * this->PerStep)));
    const int alongZ = _mm_extract_epi32(move, 2);
    const int slab = alongZ < 0 ? alongZ : alongZ + layers + 2;
    return slab * static_cast<std::ptrdiff_t>(this->Volume.IncrementZ) +
      _mm_extract_epi32(move, 1) * static_cast<std::ptrdiff_t>(this->Volume.IncrementY) +
      _mm_cvtsi128_si32(move) * static_cast<std::ptrdiff_t>(this->Volume.Components);
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
  __m128i Corner; ///< first cell along each axis
};

/// Where the rows of a window are, all voxels of which exist.
template <bool AtFaces>
class WindowAddresses
{
public:
  HWY_INLINE WindowAddresses(const PacketVolume& v, int x, int y, int z)
    : StepY(v.IncrementY)
    , StepZ(v.IncrementZ)
    , First(static_cast<const std::uint8_t*>(v.Scalars) + (z - 1) * this->StepZ +
        (y - 1) * this->StepY + (x - 1) * std::ptrdiff_t{ v.Components })
    , FirstX(x - 1)
  {
  }

  HWY_INLINE const std::uint8_t* Get(int slab, int row) const
  {
    return this->First + slab * this->StepZ + row * this->StepY;
  }

  /// The first voxel along x.
  HWY_INLINE int GetFirstX() const { return this->FirstX; }

private:
  std::ptrdiff_t StepY;
  std::ptrdiff_t StepZ;
  const std::uint8_t* First;
  int FirstX;
};

/// The same at the faces of the volume, where the outermost voxels are repeated; along x rows begin
/// where eight voxels exist.
template <>
class WindowAddresses<true>
{
public:
  HWY_INLINE WindowAddresses(const PacketVolume& v, int x, int y, int z)
    : FirstX(std::clamp(x - 1, 0, v.Dimensions[0] - 8))
  {
    const std::uint8_t* const first =
      static_cast<const std::uint8_t*>(v.Scalars) + this->FirstX * std::ptrdiff_t{ v.Components };
    for (int k = 0; k < 8; ++k)
    {
      this->Slabs[k] =
        first + std::clamp(z - 1 + k, 0, v.Dimensions[2] - 1) * std::ptrdiff_t{ v.IncrementZ };
      this->Rows[k] =
        std::clamp(y - 1 + k, 0, v.Dimensions[1] - 1) * std::ptrdiff_t{ v.IncrementY };
    }
  }

  HWY_INLINE const std::uint8_t* Get(int slab, int row) const
  {
    return this->Slabs[slab] + this->Rows[row];
  }

  HWY_INLINE int GetFirstX() const { return this->FirstX; }

private:
  const std::uint8_t* Slabs[8];
  std::ptrdiff_t Rows[8];
  int FirstX;
};

#if FFD_HAS_BYTE_PERMUTATIONS
/// Where the four bytes of each lane are in two slabs, which are 64 bytes each: their numbers.
template <bool AtFaces>
class WindowBytes
{
public:
  WindowBytes() = default;
  /// `first`: numbers of the first bytes.
  HWY_INLINE explicit WindowBytes(Vi first)
    : Numbers(_mm512_add_epi8(
        _mm512_shuffle_epi8(first.raw, _mm512_set4_epi32(0x0c0c0c0c, 0x08080808, 0x04040404, 0)),
        _mm512_set1_epi32(0x03020100)))
  {
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

  /// Looks up the bytes `rows` rows behind in two slabs, and in the lanes of `behind` in the `more`
  /// slabs, 0 to 2, behind these.
  template <int More>
  HWY_INLINE Vi LookUp(const __m512i* slabs, int rows, __mmask16 behind) const
  {
    const __m512i at =
      _mm512_add_epi8(this->Numbers, _mm512_set1_epi8(static_cast<char>(8 * rows)));
    const __m512i here = _mm512_permutex2var_epi8(slabs[0], at, slabs[1]);
    if constexpr (More == 0)
    {
      return Vi{ here };
    }
    else
    {
      const __m512i there = More == 1 ? _mm512_permutexvar_epi8(at, slabs[2])
                                      : _mm512_permutex2var_epi8(slabs[2], at, slabs[3]);
      return Vi{ _mm512_mask_mov_epi32(here, behind, there) };
    }
  }

private:
  __m512i Numbers;
};
#else
/// Where the four bytes of each lane are in two slabs, which are 16 words each: the word that the
/// first one is in, and how far it is behind the start of that word. The next word holds the rest.
template <bool AtFaces>
class WindowBytes
{
public:
  WindowBytes() = default;
  /// `first`: numbers of the first bytes.
  HWY_INLINE explicit WindowBytes(Vi first)
    : Words(_mm512_srai_epi32(first.raw, 2))
    , Down(_mm512_slli_epi32(_mm512_and_si512(first.raw, _mm512_set1_epi32(3)), 3))
    , Up(_mm512_sub_epi32(_mm512_set1_epi32(32), this->Down))
  {
  }

  /// From now on the second byte is the first one, too, in the lanes of `first`, and the third one
  /// the last one in those of `last`.
  HWY_INLINE void Repeat(__mmask16 first, __mmask16 last)
  {
    const __m512i same = _mm512_set4_epi32(0x0f0e0d0c, 0x0b0a0908, 0x07060504, 0x03020100);
    this->Order = _mm512_mask_add_epi32(same, first, same, _mm512_set1_epi32(1));
    this->Order = _mm512_mask_sub_epi32(this->Order, last, this->Order, _mm512_set1_epi32(1 << 24));
  }

  /// Looks up the bytes `rows` rows behind in two slabs, and in the lanes of `behind` in the `more`
  /// slabs, 0 to 2, behind these.
  template <int More>
  HWY_INLINE Vi LookUp(const __m512i* slabs, int rows, __mmask16 behind) const
  {
    const auto find = [&](int words) FFD_INLINE_LAMBDA {
      const __m512i at = _mm512_add_epi32(this->Words, _mm512_set1_epi32(words));
      const __m512i here = _mm512_permutex2var_epi32(slabs[0], at, slabs[1]);
      if constexpr (More == 0)
      {
        return here;
      }
      else if constexpr (More == 1)
      {
        return _mm512_mask_permutexvar_epi32(here, behind, at, slabs[2]);
      }
      else
      {
        return _mm512_mask_mov_epi32(
          here, behind, _mm512_permutex2var_epi32(slabs[2], at, slabs[3]));
      }
    };
    const __m512i bytes = _mm512_or_si512(_mm512_srlv_epi32(find(2 * rows), this->Down),
      _mm512_sllv_epi32(find(2 * rows + 1), this->Up));
    return Vi{ AtFaces ? _mm512_shuffle_epi8(bytes, this->Order) : bytes };
  }

private:
  __m512i Words;
  __m512i Down; ///< bits
  __m512i Up;
  __m512i Order; ///< of the bytes of each lane, `AtFaces`
};
#endif

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
    : Component(component)
    , Voxels(window.Volume, _mm_cvtsi128_si32(window.Corner), _mm_extract_epi32(window.Corner, 1),
        _mm_extract_epi32(window.Corner, 2))
  {
    const Di di;
    const int y = _mm_extract_epi32(window.Corner, 1);
    const int z = _mm_extract_epi32(window.Corner, 2);
    if constexpr (!AtFaces)
    {
      // Nothing is read there: it may lie outside of the volume.
      const std::uintptr_t next = reinterpret_cast<std::uintptr_t>(this->Voxels.Get(0, 0)) +
        static_cast<std::uintptr_t>(window.ToNextSlab);
      for (int row = 0; row < VoxelWindow<T>::Side; ++row)
      {
        const std::uintptr_t at =
          next + static_cast<std::uintptr_t>(row * std::ptrdiff_t{ window.Volume.IncrementY });
        _mm_prefetch(reinterpret_cast<const char*>(at), _MM_HINT_T0);
      }
    }
    const Vi dz = hn::Sub(cells.Z, hn::Set(di, z));
    const Vi odd = Fit == WindowFit::Two ? dz : hn::And(dz, hn::Set(di, 1));
    this->High = _mm512_cmpgt_epi32_mask(dz.raw, _mm512_set1_epi32(1));
    this->Bytes = WindowBytes<AtFaces>(hn::Add(hn::ShiftLeft<6>(odd),
      hn::Add(hn::ShiftLeft<3>(cells.Y),
        hn::Sub(cells.X, hn::Set(di, this->Voxels.GetFirstX() + 1 + 8 * (y - 1))))));
    if constexpr (AtFaces)
    {
      // Before the first voxel and behind the last one these are repeated.
      this->Bytes.Repeat(_mm512_cmpeq_epi32_mask(cells.X.raw, _mm512_setzero_si512()),
        _mm512_cmpeq_epi32_mask(cells.X.raw, _mm512_set1_epi32(window.Volume.Dimensions[0] - 2)));
    }
    for (int k = 1; k < NumberOfSlabs - 1; ++k)
    {
      this->Slabs[k] = this->LoadCells(k);
    }
  }

  static constexpr bool IsRepeating() { return AtFaces; }

  /// Before Gradient(): the voxels that it alone needs.
  HWY_INLINE void Widen()
  {
    this->Slabs[0] = this->LoadCells(0);
    this->Slabs[NumberOfSlabs - 1] = this->LoadCells(NumberOfSlabs - 1);
    if constexpr (Components == 1)
    {
      for (int k = 1; k < NumberOfSlabs - 1; ++k)
      {
        this->Slabs[k] = this->LoadRow(k, 7, this->LoadRow(k, 0, this->Slabs[k]));
      }
    }
  }

  HWY_INLINE Vi Row(int dy, int dz) const
  {
    return this->Bytes.template LookUp<NumberOfSlabs - 5>(this->Slabs + 1 + dz, dy, this->High);
  }

  HWY_INLINE Vi Middle(int dy, int dz, const SamplePosition& at) const
  {
    return Fetch<T>::Middle(this->Row(dy, dz), at);
  }

private:
  /// Voxels along z.
  static constexpr int NumberOfSlabs = Fit == WindowFit::Two ? 5 : Fit == WindowFit::Three ? 6 : 7;

  /// Loads one of the eight rows of a slab into the others.
  HWY_INLINE __m512i LoadRow(int slab, int row, __m512i others) const
  {
    return _mm512_mask_broadcastq_epi64(others, static_cast<__mmask8>(1 << row),
      _mm_loadl_epi64(reinterpret_cast<const __m128i*>(this->Voxels.Get(slab, row))));
  }

  /// Loads the rows of a slab that are voxels of the cells; of several components all rows.
  HWY_INLINE __m512i LoadCells(int slab) const
  {
    if constexpr (Components != 1)
    {
      return this->LoadComponent(slab);
    }
    __m512i rows = _mm512_broadcastq_epi64(
      _mm_loadl_epi64(reinterpret_cast<const __m128i*>(this->Voxels.Get(slab, 1))));
    for (int row = 2; row < 7; ++row)
    {
      rows = this->LoadRow(slab, row, rows);
    }
    return rows;
  }

  /// Loads all rows of a slab, of one of several components.
  HWY_INLINE __m512i LoadComponent(int slab) const
  {
    static_assert(Components == 1 || Components == 2 || Components == 4, "rows fill registers");
    if constexpr (Components == 2)
    {
      // Four rows of 16 bytes.
      const auto load = [&](int row) FFD_INLINE_LAMBDA {
        const auto add = [&](int k, __m512i others) FFD_INLINE_LAMBDA {
          return _mm512_mask_broadcast_i64x2(others, static_cast<__mmask8>(3 << 2 * k),
            _mm_loadu_si128(reinterpret_cast<const __m128i*>(this->Voxels.Get(slab, row + k))));
        };
        const __m512i zeroth = _mm512_broadcast_i64x2(
          _mm_loadu_si128(reinterpret_cast<const __m128i*>(this->Voxels.Get(slab, row))));
        return add(3, add(2, add(1, zeroth)));
      };
      return KeepBytes(load(0), load(4), this->Component);
    }
    else
    {
      // Two rows of 32 bytes.
      const auto load = [&](int row) FFD_INLINE_LAMBDA {
        const auto half = [&](int k) FFD_INLINE_LAMBDA {
          return _mm256_loadu_si256(
            reinterpret_cast<const __m256i*>(this->Voxels.Get(slab, row + k)));
        };
        return _mm512_inserti64x4(_mm512_castsi256_si512(half(0)), half(1), 1);
      };
      const int which = this->Component % 2;
      return KeepBytes(KeepBytes(load(0), load(2), which), KeepBytes(load(4), load(6), which),
        this->Component / 2);
    }
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
    return _mm512_inserti64x4(_mm512_castsi256_si512(keep(low)), keep(high), 1);
#endif
  }

#if FFD_HAS_BYTE_PERMUTATIONS
  HWY_ALIGN static constexpr std::uint8_t ByteNumbers[64] = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11,
    12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 32, 33, 34, 35,
    36, 37, 38, 39, 40, 41, 42, 43, 44, 45, 46, 47, 48, 49, 50, 51, 52, 53, 54, 55, 56, 57, 58, 59,
    60, 61, 62, 63 };
#endif

  int Component;
  WindowAddresses<AtFaces> Voxels; ///< from one before the first cell along each axis
  WindowBytes<AtFaces> Bytes;      ///< of the rows at (0, 0)
  __mmask16 High;                  ///< lanes whose rows are in the third or fourth layer of cells
  __m512i Slabs[NumberOfSlabs];
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
