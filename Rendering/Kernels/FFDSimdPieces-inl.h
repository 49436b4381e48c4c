// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
// The pieces that the rays of a tile are cut into. Included once per target of Highway.
#if defined(FFD_SIMD_PIECES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FFD_SIMD_PIECES_INL_H_
#undef FFD_SIMD_PIECES_INL_H_
#else
#define FFD_SIMD_PIECES_INL_H_
#endif

#include "FFDPacketCaster.h"

#include "FFDSimdInterpolant-inl.h"
#include "FFDSimdLeap-inl.h"
#include "FFDSimdMath-inl.h"
#include "FFDSimdPullBack-inl.h"
#include "FFDSimdRays-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ffd
{
namespace HWY_NAMESPACE
{

/// Viewing rays through the 4 x 4 nodes of a square of pixels, the outermost pixels included.
struct NodeRays
{
  alignas(64) NodeVectors Origins;    ///< local coordinates
  alignas(64) NodeVectors Directions; ///< local coordinates per unit of t

  /// (x0, y0): first pixel of the square; `at`: columns and rows of the nodes, 0 to 1.
  NodeRays(const ImageMap& near, const ImageMap& far, int x0, int y0, int side, const float at[4])
  {
    const Df d;
    HWY_ALIGN float x[TileNodes];
    HWY_ALIGN float y[TileNodes];
    for (int i = 0; i < TileNodes; ++i)
    {
      x[i] = static_cast<float>(x0) + 0.5f + at[i % NodesPerSide] * static_cast<float>(side - 1);
      y[i] = static_cast<float>(y0) + 0.5f + at[i / NodesPerSide] * static_cast<float>(side - 1);
    }
    for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(d))
    {
      const RayPacket rays = MakeRays(near, far, hn::Load(d, x + i), hn::Load(d, y + i));
      StoreNodes(rays.Origin, this->Origins, i);
      StoreNodes(rays.Direction, this->Directions, i);
    }
  }

  HWY_INLINE Vec3 At(Vf t, std::size_t first) const
  {
    return MulAdd(t, LoadNodes(this->Directions, first), LoadNodes(this->Origins, first));
  }
};

/// Columns and rows of the nodes, from the first to the last.
constexpr float NodeAt[4] = { 0.0f, 1.0f / 3.0f, 2.0f / 3.0f, 1.0f };

/// Points between the nodes where errors are measured: columns and rows, and where along the rays.
struct CheckSet
{
  float Across[4];
  float Along[4];
};
/// The first is about where interpolants of smooth functions have their largest errors.
constexpr CheckSet CheckSets[3] = { { { 0.12f, 0.39f, 0.61f, 0.88f },
                                      { 0.08f, 0.36f, 0.64f, 0.94f } },
  { { 0.06f, 0.22f, 0.5f, 0.93f }, { 0.04f, 0.19f, 0.55f, 0.98f } },
  { { 0.17f, 0.45f, 0.79f, 0.96f }, { 0.13f, 0.45f, 0.72f, 0.88f } } };

/**
 * The pieces of a tile: a tree that is made front to back as rays ask for it, so that nothing is
 * evaluated behind the point where all of them have ended. Where pieces begin and end depends on
 * the tile and the deformation alone, and samples do not depend on the pieces.
 *
 * In a piece the pull-back is replaced by an interpolant whose nodes are exact. Its error is
 * measured on itself, by the length of a Newton step at points between the nodes, times a safety
 * factor. A piece that is not close enough is halved along the rays or quartered across them.
 */
class TilePieces
{
public:
  /// (x0, y0): first pixel of the tile. `near` and `far` are kept by pointer.
  TilePieces(const PacketScene& scene, PacketScratch& scratch, const ImageMap& near,
    const ImageMap& far, int x0, int y0)
    : Scene(scene)
    , Scratch(scratch)
    , Near(near)
    , Far(far)
    , X0(x0)
    , Y0(y0)
  {
    scratch.Pieces.Clear();
    scratch.Tops.clear();
  }

  /// Range of t of all rays of the tile.
  void Start(float tMin, float tMax)
  {
    const double length = this->Scene.SamplesPerTop * this->Scene.Settings.SampleDistance;
    this->First = static_cast<int>(std::floor(static_cast<double>(tMin) / length));
    this->Last = static_cast<int>(std::floor(static_cast<double>(tMax) / length));
  }

  /// First pixel of the tile.
  int GetX() const { return this->X0; }
  int GetY() const { return this->Y0; }

  int GetFirst() const { return this->First; }
  int GetLast() const { return this->Last; }

  /// Top of the tree number `index`, First to Last.
  HWY_INLINE TilePiece& GetTop(int index)
  {
    const std::size_t at = static_cast<std::size_t>(index - this->First);
    while (this->Scratch.Tops.size() <= at)
    {
      this->AddTop();
    }
    return *this->Scratch.Tops[at];
  }

  /// What a piece is: found on first use.
  HWY_INLINE TilePiece::State Find(TilePiece& piece)
  {
    if (HWY_UNLIKELY(piece.Known == TilePiece::State::Unknown))
    {
      this->Expand(piece);
    }
    return piece.Known;
  }

  /// TilePiece::Needed and Inside of a part.
  HWY_INLINE void NeedPart(TilePiece& piece, int part)
  {
    while (HWY_UNLIKELY(piece.KnownParts <= part))
    {
      this->FindMoreParts(piece);
    }
  }

  /// TilePiece::Columns, found on first use.
  HWY_INLINE void NeedColumns(TilePiece& piece)
  {
    if (HWY_UNLIKELY(!piece.HasColumns))
    {
      this->FindColumns(piece);
    }
  }

  /// Of the packet at (x, y) of the tile, whose pixels are in `rows` from y on.
  HWY_NOINLINE RaySpread FindSpread(int x, int y, Vf rows, const RayPacket& rays) const
  {
    const Df d;
    const int lanes = static_cast<int>(hn::Lanes(d));
    HWY_ALIGN float columns[16];
    for (int lane = 0; lane < lanes; ++lane)
    {
      columns[lane] = static_cast<float>(lane % std::min(lanes, 4));
    }
    const Vf px = hn::Add(hn::Load(d, columns), Splat(static_cast<float>(this->X0 + x) + 0.5f));
    const Vf py = hn::Add(rows, Splat(static_cast<float>(this->Y0 + y) + 0.5f));
    return RaySpread(this->Near, this->Far, rays, px, py);
  }

private:
  using Layers = std::array<NodeVectors, TileLayers>;

  /// Newton steps at the points of check are multiplied by this, to stand for those between them.
  static constexpr float SafetyFactor = 2.0f;
  /// An error that is larger is not known well, voxels.
  static constexpr float LargestKnownError = 20.0f;
  /// Halving has not helped where it leaves more than this of an error.
  static constexpr float LittleHelp = 0.3f;
  /// What the derivatives of an interpolant may be wrong by, of their size; and the part of the
  /// tolerance of positions below which they are not looked at.
  static constexpr float LargestSlopeError = 0.1f;
  static constexpr float FinestForSlopes = 0.1f;
  static constexpr int SmallestSide = 4;
  static constexpr float Rounding = 0.01f;
  /// Of a piece from what can be seen, voxels: so far its error may be as large.
  static constexpr float FarAway = 4.0f;

  void SetTimes(TilePiece& piece, int firstSample, int samples) const
  {
    const double distance = this->Scene.Settings.SampleDistance;
    piece.FirstSample = firstSample;
    piece.Samples = samples;
    piece.T0 = static_cast<float>(firstSample * distance);
    piece.Dt =
      static_cast<float>((firstSample + static_cast<double>(samples)) * distance) - piece.T0;
  }

  NodeRays GetRays(const TilePiece& piece, const float at[4]) const
  {
    return NodeRays(this->Near, this->Far, this->X0 + piece.X, this->Y0 + piece.Y, piece.Side, at);
  }

  /// Where the nodes at t come from, index coordinates; `layer` has about that.
  HWY_NOINLINE void Solve(const NodeRays& rays, float t, NodeVectors& layer)
  {
    const Df d;
    const Mf all = hn::FirstN(d, hn::Lanes(d));
    for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(d))
    {
      const Vec3 q = PullBackFrom(this->Scene, rays.At(Splat(t), i),
        IndexToLocal(this->Scene, LoadNodes(layer, i)), this->Scene.NodeTolerance, all,
        this->Scratch.Statistics);
      StoreNodes(LocalToIndex(this->Scene, q), layer, i);
    }
  }

  /// The layers of a top, front to back, each from what is known of those before it.
  HWY_NOINLINE void SolveTop(const NodeRays& rays, const TilePiece& piece, Layers& layers)
  {
    const Df d;
    const Mf all = hn::FirstN(d, hn::Lanes(d));
    const float step = 0.25f * piece.Dt;
    for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(d))
    {
      const Vec3 path = Scale(Splat(step), LoadNodes(rays.Directions, i));
      Vec3 q[TileLayers];
      Vec3 move = path;
      for (int k = 0; k < TileLayers; ++k)
      {
        const Vec3 p = rays.At(Splat(piece.T0 + step * static_cast<float>(k)), i);
        // From nowhere, not from the piece before: what a piece is must not depend on where the
        // rays of a picture, or of a part of one, begin. Then by the polynomial through the layers
        // that has the derivative of the last one.
        Vec3 start;
        switch (k)
        {
          case 0:
            start = StartFromNowhere(this->Scene, p);
            break;
          case 1:
            start = Add(q[0], move);
            break;
          case 2:
            start = MulAdd(Splat(2.0f), move, q[0]);
            break;
          default:
            start = MulAdd(Splat(3.0f), Add(move, q[k - 2]),
              Scale(Splat(-0.5f), MulAdd(Splat(3.0f), q[k - 1], q[k - 3])));
            break;
        }
        move = path;
        q[k] = PullBackFrom(
          this->Scene, p, start, this->Scene.NodeTolerance, all, this->Scratch.Statistics, &move);
        StoreNodes(LocalToIndex(this->Scene, q[k]), layers[static_cast<std::size_t>(k)], i);
      }
    }
  }

  HWY_NOINLINE void AddTop()
  {
    TilePiece& piece = this->Scratch.Pieces.Add();
    piece.Side = TileSide;
    piece.X = 0;
    piece.Y = 0;
    const int number = static_cast<int>(this->Scratch.Tops.size());
    this->SetTimes(
      piece, (this->First + number) * this->Scene.SamplesPerTop, this->Scene.SamplesPerTop);
    alignas(64) Layers layers;
    this->SolveTop(this->GetRays(piece, NodeAt), piece, layers);
    FitQuartics(layers, piece.Terms);
    this->Scratch.Tops.push_back(&piece);
  }

  HWY_NOINLINE void Expand(TilePiece& piece)
  {
    const float tolerance = this->Scene.PositionTolerance;
    const BezierHull hull(piece.Terms);
    // What is sampled is the interpolant, or what replaces it within the error. Where that is far
    // from all that can be seen the error need not be known well.
    if (this->IsEmptyBox(hull.Low, hull.High, FarAway) &&
      this->EstimateError(piece) + tolerance <= FarAway)
    {
      piece.Known = TilePiece::State::Empty;
      return;
    }
    piece.Error = this->MeasureError(piece, hull);
    const bool close = piece.Error <= tolerance && this->HasCloseSlopes(piece);
    if (piece.Error < LargestKnownError)
    {
      const float margin = (close ? 0.0f : piece.Error + tolerance) + Rounding;
      if (this->IsEmptyBox(hull.Low, hull.High, margin))
      {
        piece.Known = TilePiece::State::Empty;
        return;
      }
    }
    if (close)
    {
      this->BeginParts(piece, hull);
      piece.Known = TilePiece::State::Curves;
      return;
    }
    this->Split(piece);
  }

  /// Of the interpolant, voxels, from few points of check.
  float EstimateError(const TilePiece& piece)
  {
    return this->Scene.Identity ? 0.0f
                                : 2.0f * SafetyFactor * PointsOfCheck(*this, piece, 0).FindError(0);
  }

  /**
   * Of the interpolant, voxels, with the safety factor: the longest Newton step at points of check.
   * They are looked at 16 at a time until one tells that the interpolant is not close enough, or
   * until it is well within the tolerance: by as much as there have been few of them. A piece over
   * several cells of the lattice has more.
   */
  HWY_NOINLINE float MeasureError(const TilePiece& piece, const BezierHull& hull)
  {
    if (this->Scene.Identity)
    {
      return 0.0f;
    }
    const float enough = this->Scene.PositionTolerance / SafetyFactor;
    const float cells = this->CountCells(hull);
    const int sets = cells > 2.0f ? 3 : cells > 1.0f ? 2 : 1;
    float largest = 0.0f;
    for (int set = 0; set < sets; ++set)
    {
      PointsOfCheck points(*this, piece, set);
      for (int turn = 0; turn < PointsOfCheck::Turns; ++turn)
      {
        largest = std::max(largest, points.FindError(turn));
        const float seen = static_cast<float>(set * PointsOfCheck::Turns + turn + 1) /
          static_cast<float>(sets * PointsOfCheck::Turns);
        if (largest > enough || largest <= 0.5f * seen / static_cast<float>(sets) * enough)
        {
          return SafetyFactor * largest;
        }
      }
    }
    return SafetyFactor * largest;
  }

  /// Whether the normals that the derivatives of an interpolant make are good enough. An error e
  /// that is zero at nodes a third of a width w apart has a derivative of at most 18 e / w.
  bool HasCloseSlopes(const TilePiece& piece) const
  {
    if (!this->Scene.Shade || piece.Error <= FinestForSlopes * this->Scene.PositionTolerance)
    {
      return true;
    }
    alignas(64) NodeVectors middle;
    alignas(64) NodeVectors end;
    FindLayer(piece.Terms, 0.5f, middle);
    FindLayer(piece.Terms, 1.0f, end);
    const float* m = this->Scene.IndexToLocal;
    const auto length = [m](float x, float y, float z) {
      float squared = 0.0f;
      for (int row = 0; row < 9; row += 3)
      {
        const float along = m[row] * x + m[row + 1] * y + m[row + 2] * z;
        squared += along * along;
      }
      return std::sqrt(squared);
    };
    const auto distance = [&](const NodeVectors& a, std::size_t i, const NodeVectors& b,
                            std::size_t j) {
      return length(b[0][j] - a[0][i], b[1][j] - a[1][i], b[2][j] - a[2][i]);
    };
    const float extent = std::min({ distance(middle, 0, middle, NodesPerSide - 1),
      distance(middle, 0, middle, TileNodes - NodesPerSide), distance(piece.Terms[0], 5, end, 5) });
    // Errors are in voxels: data units along the longest edge of one.
    const float edge =
      std::max({ length(1.0f, 0.0f, 0.0f), length(0.0f, 1.0f, 0.0f), length(0.0f, 0.0f, 1.0f) });
    return 18.0f / SafetyFactor * piece.Error * edge <= LargestSlopeError * extent;
  }

  /// Points between the nodes of a piece where its error is measured.
  class PointsOfCheck
  {
  public:
    static constexpr int Turns = 4;

    PointsOfCheck(const TilePieces& pieces, const TilePiece& piece, int set)
      : Pieces(pieces)
      , Piece(piece)
      , Along(CheckSets[set].Along)
      , Rays(pieces.GetRays(piece, CheckSets[set].Across))
    {
      const NodePositions positions(CheckSets[set].Across);
      for (std::size_t k = 0; k < TileLayers; ++k)
      {
        TransformNodes(piece.Terms[k], positions.Weight, positions.Weight, this->Terms[k]);
      }
    }

    /// The longest Newton step at the points, voxels; huge where it cannot be told. Each point sees
    /// four values of s, one a turn.
    HWY_NOINLINE float FindError(int turn) const
    {
      const Df d;
      const PacketScene& scene = this->Pieces.Scene;
      Vf largest = hn::Zero(d);
      HWY_ALIGN float at[TileNodes];
      for (int i = 0; i < TileNodes; ++i)
      {
        at[i] = this->Along[(i % 4 + i / 4 + turn) % 4];
      }
      for (std::size_t i = 0; i < TileNodes; i += hn::Lanes(d))
      {
        const Vf s = hn::Load(d, at + i);
        const Vec3 q = LoadQuartic(this->Terms, i).At(s);
        const Vec3 p =
          this->Rays.At(hn::MulAdd(s, Splat(this->Piece.Dt), Splat(this->Piece.T0)), i);
        const Vec3 error = Transform(scene.LocalToIndex,
          FindPullBackError(scene, p, IndexToLocal(scene, q), this->Pieces.Scratch.Statistics));
        const Vf length = Dot(error, error);
        // Comparisons with what is not a number are false.
        const Vf huge = Splat(1e20f);
        largest = hn::Max(largest, hn::IfThenElse(hn::Lt(length, huge), length, huge));
      }
      return std::sqrt(LargestLane(largest));
    }

  private:
    const TilePieces& Pieces;
    const TilePiece& Piece;
    const float* Along;
    NodeRays Rays;
    alignas(64) Layers Terms;
  };

  /// Cells of the lattice that a hull extends over, along the axis where they are most.
  float CountCells(const BezierHull& hull) const
  {
    float cells = 0.0f;
    for (int a = 0; a < 3; ++a)
    {
      float extent = 0.0f;
      for (int b = 0; b < 3; ++b)
      {
        extent += std::abs(this->Scene.IndexToLocal[3 * a + b]) * (hull.High[b] - hull.Low[b]);
      }
      cells = std::max(cells, extent * std::abs(this->Scene.Field.InverseSpacing[a]));
    }
    return cells;
  }

  bool IsEmptyBox(const float low[3], const float high[3], float margin) const
  {
    glm::dvec3 from;
    glm::dvec3 to;
    bool outside = false;
    for (int a = 0; a < 3; ++a)
    {
      from[a] = static_cast<double>(low[a] - margin);
      to[a] = static_cast<double>(high[a] + margin);
      outside =
        outside || high[a] + margin < this->Scene.Lower || low[a] - margin > this->Scene.Upper[a];
    }
    return outside ||
      (this->Scene.LeapsPieces &&
        this->Scene.Source->Distances->IsEmptyIn(from, to, this->Scene.Source->Volume.UpperIndex(),
          static_cast<double>(-this->Scene.Lower)));
  }

  /// A piece whose interpolant is not close enough.
  HWY_NOINLINE void Split(TilePiece& piece)
  {
    const float length = piece.Dt * this->Scene.VoxelsPerUnit;
    const float width = this->FindWidth(piece) * this->Scene.VoxelsPerUnit;
    const bool canHalve = piece.Samples > 1 && 0.5f * length >= this->Scene.ShortestPiece * 0.999f;
    const bool canQuarter = piece.Side > SmallestSide && width > 0.5f;
    // Where T folds or nearly so no interpolant will do.
    const float longest = this->Scene.Folds ? 32.0f : 8.0f;
    const bool hopeless = !(piece.Error < 1.0f) && length <= longest && piece.Side <= 16;
    const bool halvedInVain = piece.Error > LittleHelp * piece.ErrorBefore;
    if (hopeless || !(canHalve || canQuarter))
    {
      piece.Known = TilePiece::State::PerSample;
    }
    else if (canQuarter && (!canHalve || halvedInVain || length <= 0.5f * width))
    {
      this->Quarter(piece);
    }
    else
    {
      this->Halve(piece);
    }
  }

  /// Of the square of pixels, data units.
  float FindWidth(const TilePiece& piece) const
  {
    const NodeRays rays = this->GetRays(piece, NodeAt);
    float squared = 0.0f;
    for (std::size_t a = 0; a < 3; ++a)
    {
      const auto at = [&](std::size_t i) {
        return rays.Origins[a][i] + (piece.T0 + 0.5f * piece.Dt) * rays.Directions[a][i];
      };
      const float path = at(15) - at(0);
      squared += path * path;
    }
    return std::sqrt(0.5f * squared);
  }

  void Halve(TilePiece& piece)
  {
    const NodeRays rays = this->GetRays(piece, NodeAt);
    const int half = piece.Samples / 2;
    for (int h = 0; h < 2; ++h)
    {
      TilePiece& child = this->Scratch.Pieces.Add();
      child.Side = piece.Side;
      child.X = piece.X;
      child.Y = piece.Y;
      child.ErrorBefore = piece.Error;
      this->SetTimes(child, piece.FirstSample + h * half, h == 0 ? half : piece.Samples - half);
      alignas(64) Layers layers;
      for (std::size_t k = 0; k < TileLayers; ++k)
      {
        const float s = (child.T0 - piece.T0 + 0.25f * static_cast<float>(k) * child.Dt) / piece.Dt;
        FindLayer(piece.Terms, s, layers[k]);
        if (k % 2 == 1)
        {
          this->Solve(rays, child.T0 + 0.25f * static_cast<float>(k) * child.Dt, layers[k]);
        }
      }
      FitQuartics(layers, child.Terms);
      piece.Children[static_cast<std::size_t>(h)] = &child;
    }
    piece.Known = TilePiece::State::Halved;
  }

  void Quarter(TilePiece& piece)
  {
    const int half = piece.Side / 2;
    for (int q = 0; q < 4; ++q)
    {
      TilePiece& child = this->Scratch.Pieces.Add();
      child.Side = half;
      child.X = piece.X + q % 2 * half;
      child.Y = piece.Y + q / 2 * half;
      this->SetTimes(child, piece.FirstSample, piece.Samples);
      const auto positions = [&](int part) {
        float at[4];
        for (int i = 0; i < 4; ++i)
        {
          at[i] = (static_cast<float>(part * half) + NodeAt[i] * static_cast<float>(half - 1)) /
            static_cast<float>(piece.Side - 1);
        }
        return NodePositions(at);
      };
      const NodePositions x = positions(q % 2);
      const NodePositions y = positions(q / 2);
      alignas(64) Layers terms;
      for (std::size_t k = 0; k < TileLayers; ++k)
      {
        TransformNodes(piece.Terms[k], x.Weight, y.Weight, terms[k]);
      }
      const NodeRays rays = this->GetRays(child, NodeAt);
      alignas(64) Layers layers;
      for (std::size_t k = 0; k < TileLayers; ++k)
      {
        const float s = 0.25f * static_cast<float>(k);
        FindLayer(terms, s, layers[k]);
        this->Solve(rays, child.T0 + s * child.Dt, layers[k]);
      }
      FitQuartics(layers, child.Terms);
      piece.Children[static_cast<std::size_t>(q)] = &child;
    }
    piece.Known = TilePiece::State::Quartered;
  }

  /// What Needed and Inside are found from.
  HWY_NOINLINE void BeginParts(TilePiece& piece, const BezierHull& hull)
  {
    const Df d;
    piece.SamplesPerPart = std::min(piece.Samples,
      std::max(this->Scene.SamplesPerPart,
        (piece.Samples + LargestNumberOfParts - 1) / LargestNumberOfParts));
    piece.Parts = (piece.Samples + piece.SamplesPerPart - 1) / piece.SamplesPerPart;
    piece.KnownParts = 0;
    float across[3];
    hull.GetSpeeds(across, piece.Up, piece.Down);
    for (int a = 0; a < 3; ++a)
    {
      piece.Radius[a] =
        across[a] * 0.5f * static_cast<float>(BlockSide - 1) / static_cast<float>(piece.Side - 1) +
        2.0f * Rounding;
      piece.Up[a] /= static_cast<float>(piece.Samples);
      piece.Down[a] /= static_cast<float>(piece.Samples);
    }
    const int blocksPerRow = piece.Side / BlockSide;
    const int blocks = blocksPerRow * blocksPerRow;
    const Vf toNodes = Splat(3.0f / static_cast<float>(piece.Side - 1));
    for (int first = 0; first < blocks; first += static_cast<int>(hn::Lanes(d)))
    {
      HWY_ALIGN float x[16];
      HWY_ALIGN float y[16];
      for (int lane = 0; lane < static_cast<int>(hn::Lanes(d)); ++lane)
      {
        const int block = first + lane;
        const float middle = 0.5f * static_cast<float>(BlockSide - 1);
        x[lane] = static_cast<float>(block % blocksPerRow * BlockSide) + middle;
        y[lane] = static_cast<float>(block / blocksPerRow * BlockSide) + middle;
      }
      Vf wx[4];
      Vf wy[4];
      LagrangeWeights(hn::Mul(toNodes, hn::Load(d, x)), wx);
      LagrangeWeights(hn::Mul(toNodes, hn::Load(d, y)), wy);
      for (std::size_t k = 0; k < TileLayers; ++k)
      {
        hn::StoreInterleaved4(Interpolate(piece.Terms[k][0].data(), wx, wy),
          Interpolate(piece.Terms[k][1].data(), wx, wy),
          Interpolate(piece.Terms[k][2].data(), wx, wy), hn::Zero(d), d,
          piece.MiddleTerms[k][static_cast<std::size_t>(first)].data());
      }
    }
    std::fill_n(piece.Needed.begin(), blocks, 0u);
    std::fill_n(piece.Inside.begin(), blocks, 0u);
    std::fill_n(piece.SkippedParts.begin(), blocks, 0.0f);
    // In wide blocks single rays may leap where the block does not.
    piece.LeapsRays = this->Scene.Distances != nullptr &&
      (this->Scene.LeapsRays || !CanTellBoxes(this->FindPartRadius(piece)));
  }

  /// Most that the positions of a block in a part are from that in the middle, index units.
  std::array<float, 3> FindPartRadius(const TilePiece& piece) const
  {
    std::array<float, 3> radius;
    for (std::size_t a = 0; a < 3; ++a)
    {
      radius[a] = piece.Radius[a] +
        0.5f * static_cast<float>(piece.SamplesPerPart) * std::max(piece.Up[a], piece.Down[a]);
    }
    return radius;
  }

  /// Fills Needed and Inside for the next parts.
  HWY_NOINLINE void FindMoreParts(TilePiece& piece)
  {
    const Df d;
    const Di di;
    const PacketScene& scene = this->Scene;
    const std::array<float, 3> radius = this->FindPartRadius(piece);
    const bool tellsBoxes = CanTellBoxes(radius);
    const float samples = static_cast<float>(piece.SamplesPerPart);
    float up[3]; // from part to part
    float down[3];
    for (int a = 0; a < 3; ++a)
    {
      up[a] = samples * piece.Up[a];
      down[a] = samples * piece.Down[a];
    }
    const float perSample = 1.0f / static_cast<float>(piece.Samples);
    const int end = std::min(piece.Parts, piece.KnownParts + PartsAtOnce);
    const int blocks = (piece.Side / BlockSide) * (piece.Side / BlockSide);
    for (std::size_t first = 0; first < static_cast<std::size_t>(blocks); first += hn::Lanes(d))
    {
      Quartic curve;
      for (std::size_t k = 0; k < TileLayers; ++k)
      {
        Vf unused;
        Vec3& term = curve.Terms[k];
        hn::LoadInterleaved4(d, piece.MiddleTerms[k][first].data(), term.x, term.y, term.z, unused);
      }
      const hn::Rebind<std::uint32_t, Df> du;
      auto needed = hn::BitCast(di, hn::Load(du, piece.Needed.data() + first));
      auto inside = hn::BitCast(di, hn::Load(du, piece.Inside.data() + first));
      Vf skipTo = hn::Load(d, piece.SkippedParts.data() + first);
      const Mf blocksHere = hn::FirstN(d, static_cast<std::size_t>(blocks) - first);
      for (int part = piece.KnownParts; part < end; ++part)
      {
        const Vf number = Splat(static_cast<float>(part));
        const Mf looking = hn::And(blocksHere, hn::Ge(number, skipTo));
        if (hn::AllFalse(d, looking))
        {
          continue;
        }
        const Vec3 at = curve.At(Splat((static_cast<float>(part) + 0.5f) * samples * perSample));
        const Vf q[3] = { at.x, at.y, at.z };
        Mf within = looking;
        Mf outside = hn::FirstN(d, 0);
        for (int a = 0; a < 3; ++a)
        {
          const float r = radius[static_cast<std::size_t>(a)];
          const float last = static_cast<float>(scene.Volume.Dimensions[a] - 2);
          within =
            hn::And(within, hn::And(hn::Ge(q[a], Splat(1.0f + r)), hn::Lt(q[a], Splat(last - r))));
          outside = hn::Or(outside,
            hn::Or(hn::Lt(q[a], Splat(scene.Lower - r)), hn::Gt(q[a], Splat(scene.Upper[a] + r))));
        }
        Mf seen = hn::AndNot(outside, looking);
        if (scene.Distances && !hn::AllFalse(d, seen))
        {
          this->Scratch.Statistics.DistanceLookups +=
            static_cast<std::int64_t>(hn::CountTrue(d, seen));
          const EmptySpaceQuery query(scene, at);
          const Vf steps = query.CountSteps(radius.data(), up, down);
          const Mf empty = hn::And(seen, hn::Ge(steps, hn::Zero(d)));
          skipTo = hn::IfThenElse(empty, hn::Add(hn::Add(number, Splat(1.0f)), steps), skipTo);
          seen = hn::AndNot(empty, seen);
          if (tellsBoxes)
          {
            const Mf unclear = hn::And(seen, query.IsEmpty());
            seen = hn::AndNot(FindEmptyBoxes(scene, at, radius, unclear), seen);
          }
        }
        const Vi bit = hn::Set(di, static_cast<int>(1u << part));
        needed = hn::Or(needed, hn::IfThenElseZero(hn::RebindMask(di, seen), bit));
        inside = hn::Or(inside, hn::IfThenElseZero(hn::RebindMask(di, within), bit));
      }
      hn::Store(hn::BitCast(du, needed), du, piece.Needed.data() + first);
      hn::Store(hn::BitCast(du, inside), du, piece.Inside.data() + first);
      hn::Store(skipTo, d, piece.SkippedParts.data() + first);
    }
    piece.KnownParts = end;
  }

  static HWY_INLINE Vf Interpolate(const float* nodes, const Vf wx[4], const Vf wy[4])
  {
    Vf sum = hn::Zero(Df());
    for (int j = 0; j < NodesPerSide; ++j)
    {
      sum = hn::MulAdd(wy[j], InterpolateRow(nodes + NodesPerSide * j, wx), sum);
    }
    return sum;
  }

  HWY_NOINLINE void FindColumns(TilePiece& piece) const
  {
    const Df d;
    const float nodesPerPixel = 3.0f / static_cast<float>(piece.Side - 1);
    for (int x = 0; x < piece.Side; x += static_cast<int>(hn::Lanes(d)))
    {
      const Vf u =
        hn::Mul(Splat(nodesPerPixel), hn::Add(hn::Iota(d, 0.0f), Splat(static_cast<float>(x))));
      Vf w[4];
      Vf slope[4];
      LagrangeWeights(u, w);
      LagrangeSlopes(u, slope);
      for (Vf& v : slope)
      {
        v = hn::Mul(v, Splat(nodesPerPixel));
      }
      for (std::size_t k = 0; k < TileLayers; ++k)
      {
        for (std::size_t a = 0; a < 3; ++a)
        {
          for (std::size_t j = 0; j < NodesPerSide; ++j)
          {
            const float* row = piece.Terms[k][a].data() + NodesPerSide * j;
            hn::Store(InterpolateRow(row, w), d, piece.Columns[k][a][j].data() + x);
            hn::Store(InterpolateRow(row, slope), d, piece.ColumnSlopes[k][a][j].data() + x);
          }
        }
      }
    }
    piece.HasColumns = true;
  }

  const PacketScene& Scene;
  PacketScratch& Scratch;
  const ImageMap& Near;
  const ImageMap& Far;
  int X0;
  int Y0;
  int First = 0;
  int Last = -1;
};

/// The curves of a packet whose first pixel is (x, y), from that of the square of a piece, and
/// their derivatives by pixels. `rows`: weights of the rows of nodes, or their slopes.
HWY_INLINE Quartic FindPacketCurve(
  const std::array<TilePiece::ColumnTerms, TileLayers>& columns, int x, const Vf rows[4])
{
  const Df d;
  Quartic curve;
  for (std::size_t k = 0; k < TileLayers; ++k)
  {
    const auto component = [&](std::size_t a) {
      const auto row = [&](std::size_t j) {
#if HWY_TARGET == HWY_SCALAR
        return hn::Load(d, columns[k][a][j].data() + x);
#else
        return hn::LoadDup128(d, columns[k][a][j].data() + x);
#endif
      };
      Vf sum = hn::Mul(rows[0], row(0));
      sum = hn::MulAdd(rows[1], row(1), sum);
      sum = hn::MulAdd(rows[2], row(2), sum);
      return hn::MulAdd(rows[3], row(3), sum);
    };
    curve.Terms[k] = { component(0), component(1), component(2) };
  }
  return curve;
}

} // namespace HWY_NAMESPACE
} // namespace ffd
HWY_AFTER_NAMESPACE();

#endif
