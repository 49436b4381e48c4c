// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// Trilinear samples of several components and their gradients. Included once per target of Highway.
#if defined(FFD_SIMD_COMPONENTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_COMPONENTS_INL_H_
#undef FFD_SIMD_COMPONENTS_INL_H_
#else
#define FFD_SIMD_COMPONENTS_INL_H_
#endif

#include "FFDPacketVolume.h"

#include "FFDSimdCells-inl.h"
#include "FFDSimdFetch-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdRepeatedVoxels-inl.h"
#include "FFDSimdRows-inl.h"

#include <cstddef>
#include <cstdint>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

constexpr int LargestNumberOfComponents = 4;

/// Calls take(c) for components as constants, so that what is theirs can stay in registers.
template <class Take>
HWY_INLINE void ForComponents(const Take& take)
{
  take(std::integral_constant<int, 0>());
  take(std::integral_constant<int, 1>());
  take(std::integral_constant<int, 2>());
  take(std::integral_constant<int, 3>());
}

constexpr unsigned int AllComponents = (1u << LargestNumberOfComponents) - 1u; ///< a bit each

/// Whether a component is one of `wanted`, a bit each.
HWY_INLINE constexpr bool IsWanted(unsigned int wanted, int c) { return (wanted >> c & 1u) != 0; }

/// Rows of voxels, one of each component.
template <class T>
struct ComponentRows
{
  typename Fetch<T>::Row Of[LargestNumberOfComponents];
};

/// Does what LoadComponentRows() does for types that single precision does not hold.
template <class T, bool Inner>
HWY_INLINE ComponentRows<T> LoadWideRows(
  const PacketVolume& v, const int* offsets, std::ptrdiff_t delta)
{
  ComponentRows<T> rows;
  const auto set = [&](int first, Vf Row4::*voxel) {
    const Row4 words = WideVoxels::Load<Row4>(v, offsets, delta + first * v.Components);
    const Vf of[4] = { words.A, words.B, words.C, words.D };
    ForComponents([&](auto c) { rows.Of[c].*voxel = of[c]; });
  };
  set(0, &Row4::B);
  set(1, &Row4::C);
  if constexpr (!Inner)
  {
    set(-1, &Row4::A);
    set(2, &Row4::D);
  }
  return rows;
}

#if HWY_TARGET == HWY_SCALAR
/// Loads the rows of all components that lie `delta` elements from those of the cells.
template <class T, bool Inner>
HWY_INLINE ComponentRows<T> LoadComponentRows(
  const PacketVolume& v, const int* offsets, std::ptrdiff_t delta)
{
  ComponentRows<T> rows;
  const T* const first = static_cast<const T*>(v.Scalars) + offsets[0] + delta - v.Components;
  for (int c = 0; c < v.Components; ++c)
  {
    const T voxels[4] = { first[c], first[v.Components + c], first[2 * v.Components + c],
      first[3 * v.Components + c] };
    PacketVolume row = v;
    row.Scalars = voxels;
    row.Words[0] = v.Words[c];
    const int second = 1;
    rows.Of[c] = Fetch<T>::LoadRow(row, &second, 0);
  }
  return rows;
}
#else
/// The bytes of 16 in a row of voxels that are the words of their components: of four voxels of one
/// byte, or of two of two bytes. By the number of components less two.
HWY_ALIGN constexpr std::uint8_t ByteOrders[3][16] = {
  { 0, 2, 4, 6, 1, 3, 5, 7, 0, 0, 0, 0, 0, 0, 0, 0 },
  { 0, 3, 6, 9, 1, 4, 7, 10, 2, 5, 8, 11, 0, 0, 0, 0 },
  { 0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15 },
};
HWY_ALIGN constexpr std::uint8_t WordOrders[3][16] = {
  { 0, 1, 4, 5, 2, 3, 6, 7, 0, 0, 0, 0, 0, 0, 0, 0 },
  { 0, 1, 6, 7, 2, 3, 8, 9, 4, 5, 10, 11, 0, 0, 0, 0 },
  { 0, 1, 8, 9, 2, 3, 10, 11, 4, 5, 12, 13, 6, 7, 14, 15 },
};

/**
 * Loads the rows of all components that lie `delta` elements from those of the cells. `Inner`: only
 * the voxels of the cells are needed. 16 bytes are loaded at once, which may reach up to 8 bytes
 * beyond the row: there is another one behind it, because no row is the last along y and z.
 */
template <class T, bool Inner>
HWY_INLINE ComponentRows<T> LoadComponentRows(
  const PacketVolume& v, const int* offsets, std::ptrdiff_t delta)
{
  const Di di;
  constexpr int Size = sizeof(T);
  // The words from the voxel `first` of the rows on.
  const auto load = [&](int first, auto permute) {
    return LoadQuadLanes<Size>(v.Scalars, Size * (delta + first * v.Components), offsets, permute);
  };
  ComponentRows<T> rows;
  if constexpr (std::is_same<T, float>::value || std::is_same<T, WordScalar>::value)
  {
    const auto asIs = [](Vi quads) { return quads; };
    const auto set = [&](int first, Vf Row4::*voxel) {
      const Quads words = load(first, asIs);
      const Vi of[4] = { words.x, words.y, words.z, words.w };
      ForComponents([&](auto c) { rows.Of[c].*voxel = FromWords<T>(v, of[c], c); });
    };
    set(0, &Row4::B);
    set(1, &Row4::C);
    if constexpr (!Inner)
    {
      set(-1, &Row4::A);
      set(2, &Row4::D);
    }
  }
  else
  {
    const auto* const orders = sizeof(T) == 1 ? ByteOrders : WordOrders;
    const hn::Repartition<std::uint8_t, Di> bytes;
    const auto order = hn::LoadDup128(bytes, orders[v.Components - 2]);
    const auto sort = [&](Vi quads) {
      return hn::BitCast(di, hn::TableLookupBytes(hn::BitCast(bytes, quads), order));
    };
    const Quads words = load(-1, sort);
    const Vi of[4] = { words.x, words.y, words.z, words.w };
    if constexpr (sizeof(T) == 1)
    {
      ForComponents([&](auto c) { rows.Of[c] = of[c]; });
    }
    else
    {
      const Quads next = load(1, sort);
      const Vi ofNext[4] = { next.x, next.y, next.z, next.w };
      ForComponents([&](auto c) {
        rows.Of[c] = { Fetch<T>::ToSigned(v, of[c]), Fetch<T>::ToSigned(v, ofNext[c]) };
      });
    }
  }
  return rows;
}
#endif

/// The components around the positions of a packet: values, and differences over two voxels, as
/// Sample() and Gradient() give them of one.
template <class T>
class ComponentSamples
{
public:
  /// Fetches from the cells of `lanes`, FindInterior(); other lanes get a cell that can be fetched.
  HWY_INLINE ComponentSamples(
    const PacketVolume& v, const SampleCells& cells, const SamplePosition& at, Mf lanes)
    : At(Copy(at))
  {
    this->Voxels.Fit(v, cells, lanes, this->Offsets);
  }

  /// Fetches from copied voxels.
  explicit ComponentSamples(const RepeatedVoxels<T>& voxels)
    : At(voxels.GetPosition())
  {
    this->Voxels.Set(voxels.GetView());
    std::copy_n(voxels.GetOffsets(), 16, this->Offsets);
  }

  /// The values of the components `wanted`, a bit each.
  HWY_NOINLINE void FindValues(
    Vf values[LargestNumberOfComponents], unsigned int wanted = AllComponents)
  {
    const ComponentRows<T> rows[4] = { this->template Load<false>(0, 0),
      this->template Load<false>(1, 0), this->template Load<false>(0, 1),
      this->template Load<false>(1, 1) };
    ForComponents([&](auto c) {
      if (c < this->Voxels.Get().Components && IsWanted(wanted, c))
      {
        values[c] = Sample<T>(InnerRows<c>{ rows }, this->At, this->Rows[c]);
      }
    });
  }

  /// The gradients of the components `wanted`, a bit each; zero of the others. After FindValues().
  HWY_NOINLINE void FindGradients(
    unsigned int wanted, Vec3 gradients[LargestNumberOfComponents]) const
  {
    OuterRows outer[LargestNumberOfComponents];
    this->LoadOuterRows(wanted, outer);
    const Vf zero = hn::Zero(Df());
    ForComponents([&](auto c) {
      gradients[c] = IsWanted(wanted, c) ? Gradient<T>(outer[c], this->At, this->Rows[c])
                                         : Vec3{ zero, zero, zero };
    });
  }

  /// The values whose differences FindGradients() gives, of the components `wanted`.
  HWY_NOINLINE void FindNeighbors(
    unsigned int wanted, NeighborValues neighbors[LargestNumberOfComponents]) const
  {
    OuterRows outer[LargestNumberOfComponents];
    this->LoadOuterRows(wanted, outer);
    ForComponents([&](auto c) {
      if (IsWanted(wanted, c))
      {
        neighbors[c] = FindNeighborValues<T>(outer[c], this->At, this->Rows[c]);
      }
    });
  }

private:
  /// The rows of the cells, as Sample() takes them of a component.
  template <int Component>
  struct InnerRows
  {
    const ComponentRows<T>* Rows;
    HWY_INLINE typename Fetch<T>::Row Row(int dy, int dz) const
    {
      return this->Rows[dy + 2 * dz].Of[Component];
    }
  };

  /// The rows beside the cells, as Gradient() takes them of a component.
  struct OuterRows
  {
    static constexpr int Count = 8;
    static constexpr int Places[Count][2] = { { -1, 0 }, { 2, 0 }, { -1, 1 }, { 2, 1 }, { 0, -1 },
      { 1, -1 }, { 0, 2 }, { 1, 2 } }; ///< dy, dz
    typename Fetch<T>::Along Middles[Count];
    HWY_INLINE typename Fetch<T>::Along Middle(int dy, int dz, const SamplePosition&) const
    {
      const bool alongY = dy < 0 || dy > 1;
      return this->Middles[alongY ? 2 * dz + (dy > 1 ? 1 : 0) : 4 + dy + (dz > 1 ? 2 : 0)];
    }
  };

  HWY_NOINLINE void LoadOuterRows(
    unsigned int wanted, OuterRows (&outer)[LargestNumberOfComponents]) const
  {
    for (int i = 0; i < OuterRows::Count; ++i)
    {
      const ComponentRows<T> rows =
        this->template Load<true>(OuterRows::Places[i][0], OuterRows::Places[i][1]);
      ForComponents([&](auto c) {
        if (IsWanted(wanted, c))
        {
          outer[c].Middles[i] = Fetch<T>::Middle(rows.Of[c], this->At);
        }
      });
    }
  }

  template <bool Inner>
  HWY_INLINE ComponentRows<T> Load(int dy, int dz) const
  {
    const PacketVolume& v = this->Voxels.Get();
    const std::ptrdiff_t delta = dy * static_cast<std::ptrdiff_t>(v.IncrementY) +
      dz * static_cast<std::ptrdiff_t>(v.IncrementZ);
    if constexpr (std::is_same<T, double>::value)
    {
      return LoadWideRows<T, Inner>(v, this->Offsets, delta);
    }
    else
    {
      return LoadComponentRows<T, Inner>(v, this->Offsets, delta);
    }
  }

  VoxelsInReach Voxels;
  HWY_ALIGN int Offsets[16]; ///< elements
  SamplePosition At;
  SampleRows<T> Rows[LargestNumberOfComponents];
};

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
