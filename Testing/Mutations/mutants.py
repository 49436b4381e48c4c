# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The defects that check_mutants.py puts into the sources, one at a time.

A mutant names no file: its text occurs once in all of the sources, white space apart, so that it
survives moves of files and of functions. `tests` are names of ctest, cheapest first; the first one
that fails notices the mutant. `survives` is the reason why no test has to notice it, and is empty
otherwise.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Mutant:
    """One defect: `text` is replaced by `by`."""

    name: str
    kind: str  # sign, bound, index or term
    text: str
    by: str
    tests: tuple
    survives: str = ""


def kernels(*names):
    return tuple("Kernels.Test" + name for name in names)


def cxx(*names):
    return tuple("Cxx.Test" + name for name in names)


def python(*names):
    return tuple("Python.Test" + name for name in names)


PACKETS = kernels("PacketCaster")

MUTANTS = (
    # The deformation.
    Mutant(
        "border: control points are not reflected with the other sign",
        "sign",
        "return { i < 0 ? 0 : last, -1.0 };",
        "return { i < 0 ? 0 : last, 1.0 };",
        kernels("BSplineField") + cxx("FFDLatticeAgainstVTK")),
    Mutant(
        "field: the derivative does not vanish outside of the lattice",
        "term",
        "const double toData = at[a].Constant ? 0.0 : this->InverseSpacing[a];",
        "const double toData = this->InverseSpacing[a];",
        kernels("BSplineField", "PullBack") + cxx("FFDLatticeAgainstVTK")),
    Mutant(
        "interpolation of a net: the last equation forgets the known coefficient",
        "term",
        "right -= i == m - 2 ? c[m - 1] : glm::dvec3(0.0);",
        "right -= glm::dvec3(0.0);",
        kernels("ControlNet", "Lattice", "LatticeFit")),
    Mutant(
        "fold guard: cells before the moved control points are left out",
        "index",
        "const glm::ivec3 first = glm::max(low - 2, glm::ivec3(1));",
        "const glm::ivec3 first = glm::max(low - 1, glm::ivec3(1));",
        kernels("FoldGuard", "LatticeEditor")),
    Mutant(
        "continuation: the predictor goes backwards",
        "sign",
        "field, p, current.Point - (next - strength) * tangent, next, evaluations);",
        "field, p, current.Point + (next - strength) * tangent, next, evaluations);",
        kernels("PullBack", "Lattice") + python("Folds")),
    Mutant(
        "Jacobian of the mirrored inverse at the wrong point",
        "term",
        "this->Field->Displacement(mirrored ? p + (p - q) : q, jacobian);",
        "this->Field->Displacement(q, jacobian);",
        kernels("PullBack", "RayCaster", "PacketCaster")),
    Mutant(
        "frame coherence: motions of an edit count a quarter",
        "term",
        "return length * (visible && depth > 0.0f",
        "return 0.25f * length * (visible && depth > 0.0f",
        kernels("PullBackChange")),
    Mutant(
        "rays: their change across them from pixel to pixel has the other sign",
        "sign",
        "Sub(Cross(direction, take(image.Moment)), Scale(stretch, nearest))",
        "Sub(Cross(take(image.Moment), direction), Scale(stretch, nearest))",
        PACKETS),
    Mutant(
        "resizing a lattice moves its origin the wrong way",
        "sign",
        "result.Origin[a] = this->Origin[a] + this->Spacing[a] - result.Spacing[a];",
        "result.Origin[a] = this->Origin[a] + this->Spacing[a] + result.Spacing[a];",
        kernels("Lattice") + cxx("FFDLattice")),
    Mutant(
        "bounds of the inverse: the series stops after its first term",
        "term",
        "inverse.Spread = glm::inverse(glm::dmat3(1.0) - w) * w * size;",
        "inverse.Spread = w * size;",
        kernels("PullBackBounds")),
    Mutant(
        "second derivative: mixed terms count once",
        "term",
        "sum += (a == b ? 1.0 : 2.0) * second * second;",
        "sum += second * second;",
        kernels("PullBackBounds", "Polyline")),
    Mutant(
        "bounds after an edit: the last changed cells are not bounded again",
        "bound",
        "std::min(high[a] + 2, field.GetEndCell()[a]);",
        "std::min(high[a] + 1, field.GetEndCell()[a]);",
        kernels("PullBackBounds")),
    Mutant(
        "determinant: interval difference with the wrong end",
        "bound",
        "{ plus.Min - minus.Max, plus.Max - minus.Min }",
        "{ plus.Min - minus.Min, plus.Max - minus.Min }",
        kernels("JacobianDeterminant", "FoldGuard", "PullBackBounds")),
    Mutant(
        "fit to points: mixed second derivatives count once",
        "term",
        "const double mixed = std::sqrt(2.0 * scale) / (h[a] * h[b]);",
        "const double mixed = std::sqrt(scale) / (h[a] * h[b]);",
        kernels("LatticeFit") + python("FitLattice")),
    Mutant(
        "twist: derivative along the axis with the wrong sign",
        "sign",
        "jacobian[u][w] = this->Angle * slope * (c * y - s * z);",
        "jacobian[u][w] = this->Angle * slope * (c * y + s * z);",
        kernels("FunctionalDeformations")),
    Mutant(
        "direct manipulation: constraints that share control points are not separated",
        "term",
        "missing -= amounts.leftCols(rank) * parts;",
        "missing -= 0.0 * amounts.leftCols(rank) * parts;",
        kernels("DirectManipulation", "LatticeEditor")),
    Mutant(
        "cached bounds of the inverse map outlive a change of the lattice",
        "term",
        "this->BoundsAreCurrent[0] = this->BoundsAreCurrent[1] = false;",
        "this->BoundsAreCurrent[0] = false;",
        kernels("Lattice"),
        survives="the bounds of the forward map are found when they are asked for, from the field that "
        "is the same object: none are kept that could be out of date"),
    # Volumes, filters, files and physics.
    Mutant(
        "empty boxes reach into the visible block",
        "bound",
        "box.Min = glm::dvec3((block - (distance - 1)) * MinMaxBlocks::BlockSize);",
        "box.Min = glm::dvec3((block - distance) * MinMaxBlocks::BlockSize);",
        kernels("DistanceMap", "RayCaster")),
    Mutant(
        "blocks do not hold the voxels that they share with the next ones",
        "bound",
        "Window window{ block * size, std::min((block + 1) * size, end) };",
        "Window window{ block * size, std::min((block + 1) * size - 1, end) };",
        kernels("MinMaxBlocks", "DistanceMap", "PacketCaster")),
    Mutant(
        "transfer table: the entry behind an interval does not count",
        "index",
        "const std::size_t end = static_cast<double>(below) < to ? below + 2 : below + 1;",
        "const std::size_t end = below + 1;",
        kernels("TransferTable", "DistanceMap")),
    Mutant(
        "distance of voxels: a diagonal neighbor is left out",
        "bound",
        "n <= std::min(dimensions.y - 1, j + 1); ++n)",
        "n <= std::min(dimensions.y - 1, j); ++n)",
        kernels("VoxelDistance") + cxx("FFDDistanceMap")),
    Mutant(
        "region to resample: points of first order are forgotten",
        "term",
        "return Union(rest, Moved(deformed, atDeformed, -1.0));",
        "return rest;",
        kernels("Resampler") + cxx("FFDResampleVolume") + python("VolumeFilters")),
    Mutant(
        "rows that run down their axis begin at the wrong control point",
        "index",
        "const std::size_t first = std::min(this->Runs.front().Node, this->Runs.back().Node);",
        "const std::size_t first = this->Runs.front().Node;",
        kernels("SplineRows") + cxx("FFDJacobian", "FFDResampleVolume")),
    Mutant(
        "files: a matrix is flipped on one side only",
        "term",
        "step.Matrix[column] *= flip * flip[column];",
        "step.Matrix[column] *= flip;",
        kernels("TransformFile") + python("TransformReader", "TransformWriter")),
    Mutant(
        "files: the origin of a reversed axis is one node off",
        "bound",
        "grid.Origin[b] -= (old.Size[a] - 1) * old.Spacing[a];",
        "grid.Origin[b] -= old.Size[a] * old.Spacing[a];",
        kernels("TransformFile") + python("TransformReader", "TransformWriter")),
    Mutant(
        "cell scalars lie half a data unit, not half a voxel, from the corner",
        "term",
        "view.FirstVoxel += view.IndexToData * glm::dvec3(0.5);",
        "view.FirstVoxel += glm::dvec3(0.5);",
        cxx("CellScalars", "VTKScenes.CellData")),
    Mutant(
        "fold mask: what is not a number is no fold",
        "bound",
        "const bool folded = !(determinant > threshold);",
        "const bool folded = determinant <= threshold;",
        cxx("FFDJacobian") + python("Filters", "VolumeFilters")),
    Mutant(
        "springs: the pull of a pinned neighbor has the other sign",
        "sign",
        "right(b, c) -= pull[c] - (a < 0 ? spring.Stiffness * fixed[spring.A][c] : 0.0);",
        "right(b, c) -= pull[c] + (a < 0 ? spring.Stiffness * fixed[spring.A][c] : 0.0);",
        cxx("MassSpring") + python("MassSpring")),
    # The ray caster, a ray at a time, and what prepares a frame.
    Mutant(
        "material opacity: lengths are those of index coordinates",
        "term",
        ": interval * glm::length(this->Frame->IndexToData * segment.Curve.Velocity(s));",
        ": interval * glm::length(segment.Curve.Velocity(s));",
        kernels("RayCaster", "PacketCaster")),
    Mutant(
        "local lights: quadratic attenuation is linear",
        "term",
        "light.Attenuation.z * distance * distance);",
        "light.Attenuation.z * distance);",
        kernels("SampleClassifier", "PacketCaster") + python("Lighting")
        + cxx("VTKScenes.PositionalLights")),
    Mutant(
        "gradient magnitudes ignore the spacing",
        "term",
        "this->MagnitudeScale = (edges.x + edges.y + edges.z) / (3.0 * edges);",
        "this->MagnitudeScale = glm::dvec3(1.0);",
        kernels("SampleClassifier", "PacketCaster") + cxx("GradientOpacity")),
    Mutant(
        "frame: rays do not begin at a whole tile",
        "term",
        "region.Origin -= region.Origin % ffd::RayCaster::GroupSize;",
        "region.Origin -= glm::ivec2(0);",
        python("ClipBox") + cxx("MapperWindow")),
    Mutant(
        "boxes of tiles: first-order pull-backs go the other way",
        "sign",
        "map.GetKind() == PullBackKind::FirstOrder ? -1.0 : 1.0);",
        "map.GetKind() == PullBackKind::FirstOrder ? 1.0 : 1.0);",
        kernels("TileBounds")),
    Mutant(
        "boxes that are turned over: the determinant is the same all over them",
        "term",
        "change += glm::dot(glm::abs(slope), half) + 1e-9;",
        "change += 1e-9;",
        kernels("TileBounds")),
    Mutant(
        "gaps along rays: the last boxes of the volume are not anywhere",
        "bound",
        "ForIndices(glm::ivec3(0), boxes.Count, 1, [&]",
        "ForIndices(glm::ivec3(0), boxes.Count - 1, 1, [&]",
        kernels("TileBounds")),
    # The vector kernels.
    Mutant(
        "gaps along rays: they are followed as if there were none",
        "term",
        "const Mf inGap = hn::Not(IsMarked(*this->Cells, p));",
        "const Mf inGap = hn::FirstN(Df(), 0);",
        python("Folds")),
    Mutant(
        "windows of numbers: the upper pair of rows is a row too low",
        "index",
        "this->High[k] = slabs[k].GetPair(rows + 3);",
        "this->High[k] = slabs[k].GetPair(rows + 2);",
        PACKETS),
    Mutant(
        "vectors: headlights see the back of surfaces",
        "sign",
        "hn::Neg(hn::Mul(Dot(gradient, toEye), inverse))));",
        "hn::Mul(Dot(gradient, toEye), inverse)));",
        PACKETS + cxx("NormalsAndSurfaces")),
    Mutant(
        "vectors: leaps down are limited by the way up",
        "index",
        "this->Down[a] = Splat(1.0f / std::max(down[a], Slowest));",
        "this->Down[a] = Splat(1.0f / std::max(up[a], Slowest));",
        PACKETS + kernels("PositionError")),
    Mutant(
        "vectors: boxes are asked about as if they ended in their first block",
        "bound",
        "const Vi last = Truncate(hn::Min(high, this->LastBlock[a]));",
        "const Vi last = Truncate(hn::Min(low, this->LastBlock[a]));",
        PACKETS),
    Mutant(
        "vectors: the last voxel of a row is not repeated in windows",
        "index",
        "_mm512_cmpeq_epi32_mask(cells.X.raw, _mm512_set1_epi32(window.Volume.Dimensions[0] - 2)));",
        "_mm512_cmpeq_epi32_mask(cells.X.raw, _mm512_set1_epi32(-1)));",
        PACKETS),
    Mutant(
        "vectors: gradients at faces are not rescaled",
        "term",
        "return hn::Div(Splat(2.0f), hn::Sub(after, hn::Max(hn::Sub(x, one), hn::Zero(Df()))));",
        "return hn::Min(after, one);",
        PACKETS),
    Mutant(
        "vectors: a gradient is taken from the wrong column of voxels",
        "index",
        "hn::Sub(middle(2, 1), rows.M01)),",
        "hn::Sub(middle(2, 1), rows.M11)),",
        PACKETS),
    Mutant(
        "vectors: the inverse keeps solutions that are turned inside out",
        "term",
        "return hn::And(solved, kept);",
        "return hn::And(solved, hn::Or(kept, solved));",
        PACKETS + python("Folds") + kernels("PositionError")),
    Mutant(
        "vectors: segments are called empty without their error",
        "term",
        "const float margin = (close ? 0.0f : segment.Error + tolerance) + PositionRounding + before;",
        "const float margin = PositionRounding + before;",
        PACKETS,
        survives="The hull of a tile's segment and the blocks it is compared with are larger than the "
                 "error of an interpolant that is not split yet: in 160 scenes of one visible voxel "
                 "under random deformations no picture and no number of samples changed. The margin "
                 "makes it a proof."),
    Mutant(
        "segments: nodes of quarters lie in steps of one pixel less",
        "index",
        "at[i] = (static_cast<float>(part * half) + NodeAt[i] * static_cast<float>(half - 1)) /",
        "at[i] = (static_cast<float>(part * (half - 1)) + NodeAt[i] * static_cast<float>(half - 1)) /",
        PACKETS),
    Mutant(
        "vectors: gradients of components from the wrong corner",
        "index",
        "return this->Rows[dy + 2 * dz].Of[Component];",
        "return this->Rows[2 * dy + dz].Of[Component];",
        PACKETS + cxx("Components", "VTKScenes.FourComponentsIndependent")),
    Mutant(
        "vectors: the second of two wide components is the first one",
        "index",
        "_mm256_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14), _mm256_set1_epi32(component));",
        "_mm256_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14), _mm256_set1_epi32(component & 0));",
        PACKETS + cxx("Components")),
    Mutant(
        "vectors: a mask of its own grid ends half a voxel too early",
        "bound",
        "hn::Or(hn::Lt(x, hn::Neg(half)), hn::Gt(x, hn::Add(last, half))));",
        "hn::Or(hn::Lt(x, hn::Neg(half)), hn::Gt(x, last)));",
        PACKETS + cxx("Masks", "VTKScenes.BinaryMask")),
    Mutant(
        "hidden cells: differences end behind samples where the cell before them is hidden",
        "index",
        "high = hn::IfThenElse(behind[a], hn::Min(high, end), high);",
        "high = hn::IfThenElse(before[a], hn::Min(high, end), high);",
        PACKETS),
    Mutant(
        "window: what other props draw before the volume does not hide it",
        "term",
        "if (prop != volume && prop->GetVisibility())",
        "if (prop == volume && !prop->GetVisibility())",
        cxx("MapperWindow")),
    Mutant(
        "rays far apart: a leap goes a sample too far",
        "index",
        "number = hn::Add(number, steps);",
        "number = hn::Add(number, hn::Add(steps, one));",
        python("PacketLooks")),
    Mutant(
        "light: gradients beside values far beyond the functions have no direction",
        "bound",
        "(ofValues && !scene.Ranges) || wide || most > NearRange * range };",
        "(ofValues && !scene.Ranges) || wide };",
        python("Lighting")),
    Mutant(
        "light: gradients within functions that reach to no data have no direction",
        "bound",
        "(ofValues && !scene.Ranges) || wide || most > NearRange * range };",
        "(ofValues && !scene.Ranges) || most > NearRange * range };",
        python("Scales")),
    Mutant(
        "blocks: what is far from all others takes the steps of codes",
        "bound",
        "inner.Min - range.Min > width ? inner.Min : range.Min;",
        "range.Min;",
        python("Scales")),
    Mutant(
        "normals of opacity: level pieces have a slope",
        "term",
        "line.Slope[0] = isLevel ? 0.0 : std::min(line.Slope[0], toOpaque);",
        "line.Slope[0] = std::min(line.Slope[0], toOpaque);",
        python("PacketLooks")),
    Mutant(
        "labels: blocks of several are taken for one",
        "bound",
        "hn::AllFalse(di, hn::Eq(labels, hn::Set(di, LabelBlocks::Mixed)))",
        "hn::AllFalse(di, hn::Eq(labels, hn::Set(di, LabelBlocks::Mixed + 1)))",
        cxx("Masks") + python("PacketLooks")),
    Mutant(
        "bounds of a pull-back by T itself: its domain is forgotten",
        "bound",
        "const Box known = this->Domain ? Intersect(box, *this->Domain) : box;",
        "const Box known = box;",
        python("VolumeFilters")),
    # Widgets.
    Mutant(
        "drag along an axis: the line of sight is not projected",
        "sign",
        "return (ad * glm::dot(line.Direction, between) - glm::dot(axis, between)) / sine2;",
        "return (ad * glm::dot(line.Direction, between) + glm::dot(axis, between)) / sine2;",
        kernels("DragGeometry") + cxx("LatticeWidget")),
    Mutant(
        "frame coherence: the picture moves by half as many tiles",
        "term",
        "shift = moved / tile;",
        "shift = moved / (2 * tile);",
        cxx("FrameCoherence")),
    Mutant(
        "still pictures: geometry that has moved is not looked for",
        "term",
        "if (isSame(first, end))",
        "if (true)",
        cxx("FrameCoherence")),
    Mutant(
        "editor: changes are not divided by the displacement scale",
        "term",
        "changes[solution.Nodes[n]] = solution.Changes[n] / scale;",
        "changes[solution.Nodes[n]] = solution.Changes[n];",
        kernels("LatticeEditor") + cxx("LatticeRepresentation")),
    Mutant(
        "gizmo: the nearest part is not sought beyond the first corner of its path",
        "bound",
        "const double here = n == 0 ? glm::length(glm::dvec2(at) - display)",
        "const double here = n <= 1 ? glm::length(glm::dvec2(at) - display)",
        cxx("LatticeWidget", "LatticeRepresentation", "LatticeLook")),
)
