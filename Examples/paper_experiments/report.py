# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The report: Markdown and CSV around the figures."""

import csv
import os

import experiments
import scene


def write_csv(folder, name, header, rows):
    with open(os.path.join(folder, name), "w", newline="", encoding="ascii") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)
    return name


def markdown_table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def table1(table, methods, shapes):
    """Header and rows of table 1: the paper's own, then ours by deformation and method."""
    header = ["opacity", "deformation", "rendered by"] + [
        "magnitude %d" % m for m in scene.TABLE_MAGNITUDES] + ["kept at 45"]
    rows = []
    for opacity in scene.OPACITIES:
        title = scene.OPACITY_TITLES[opacity]
        paper = experiments.PAPER_TABLE[opacity]
        rows.append([title, "the paper's", "the paper"] + ["%.2f" % r for r in paper] +
                    ["%.0f %%" % (100.0 * paper[-1] / paper[0])])
        for shape in shapes:
            for method in methods:
                ratios = [table.ratio(shape, m, method, opacity) for m in scene.TABLE_MAGNITUDES]
                rows.append([title, shape, method] + ["%.2f" % r for r in ratios] +
                            ["%.0f %%" % (100.0 * ratios[-1] / ratios[0])])
    return header, rows


def counts_at_table_magnitudes(table, methods, shapes):
    """What table 1 is made of."""
    header = ["opacity", "deformation", "rendered by", "magnitude", "samples, not optimized",
              "samples", "of them visible", "look-ups", "evaluations", "segment length"]
    rows = []
    for opacity in scene.OPACITIES:
        for shape in shapes:
            for method in methods:
                for magnitude in scene.TABLE_MAGNITUDES:
                    c = table.get(shape, magnitude, method, opacity)
                    u = table.get_unoptimized(shape, magnitude, method)
                    rows.append([opacity, shape, method, magnitude, "%.1f" % u.samples,
                                 "%.2f" % c.samples, "%.2f" % c.visible_samples,
                                 "%.2f" % c.lookups, "%.2f" % c.evaluations,
                                 "%.2f" % c.segment_length])
    return header, rows


def check_rows(checks):
    return ["check", "wanted", "measured", "result"], [
        [c.name, c.wanted, c.measured, "met" if c.met else "**missed**"] for c in checks]


def figure8_rows(rows):
    header = ["rays", "segments a ray", "evaluations a ray", "mean color difference (of 255)",
              "pixels beyond 8 of 255", "mean distance (voxels)", "95 % below (voxels)",
              "roughness (voxels)"]
    return header, [
        [experiments.FIGURE8[name], "%.1f" % r.segments, "%.1f" % r.evaluations,
         "%.2f" % r.mean_color, "%.2f %%" % (100.0 * r.changed), "%.3f" % r.mean_depth,
         "%.3f" % r.depth_95, "%.3f" % r.roughness] for name, r in rows.items()]


SETTINGS = """\
## What was rendered

The paper gives the volume (engine, 256 x 256 x 113), the limits of the segments (0.5 and 8 voxels),
the angle (5 degrees) and what is counted. The rest had to be chosen:

- **Sample distance {distance} voxel**, as dense as the shortest segment, which the paper derives from
  the sampling theorem. With the segments and with them the leaps at most 8 voxels long, a ray through
  empty space gets a speed-up of at most 8 / distance: the 14.16 of table 1 needs a distance well
  below one voxel. (Table 1 with one voxel, the default of the mapper, is at the end.)
- **Transfer functions**: opacity ramps, scalar: opacity, {ramps}.
  They are chosen so that the paper's method, undeformed, gets about the speed-ups of the paper's first
  column. So the first column of "paper" rows is a calibration, not a result; everything to the right
  of it is a result.
- **Camera**: perspective, view angle 28 degrees, sees three sides; {size} x {size} rays. "Per ray" is
  per ray that meets the bounds of the deformed volume.
- **Deformation**: the paper's is not known. *magnitude* is the largest displacement of a control point
  along an axis, in voxels.
  {shapes}
- **Termination**: a ray ends when less than 1/255 of the light passes (the default of the mapper).
- **Distances** are kept for blocks of 4 x 4 x 4 voxels, the paper's for single voxels. So ours are
  shorter by up to a block, and a transparent voxel in a block that is not empty is sampled where the
  paper looks up a distance. "of them visible", below, is about what the paper's map would leave.

Counted are, per ray: pieces that the ray was cut into and sampled on, and their length on the viewing
ray; interpolated scalars ("samples"); and positions in empty space where a distance was looked up
("look-ups"). Table 1 divides the samples without optimization (no leaping, no early termination) by
samples plus look-ups with it, so a look-up weighs as much as a sample, as in the paper.

Methods:
{methods}
"""


def settings_text(size, shapes):
    ramps = "; ".join("%s %s" % (
        scene.OPACITY_TITLES[name], ", ".join("%g: %g" % point for point in points))
        for name, points in scene.OPACITIES.items())
    return SETTINGS.format(
        distance=scene.SAMPLE_DISTANCE, ramps=ramps, size=size,
        shapes=" ".join("*%s*: %s." % (name, scene.SHAPES[name].title) for name in shapes),
        methods="\n".join("- *%s*: %s" % item for item in scene.METHODS.items()))

FIGURE8_TEXT = """\
{shape}, magnitude {magnitude}, samples every {distance} voxel, opaque. Each row is compared with a
picture whose rays have a segment for every sample, so that every sample is exactly where equation (3)
puts it. "Distance" is that of the surfaces along the view; "roughness" is the root mean square of
what the difference of the surfaces has that its four neighbors do not. The second row of the figure
is the part where fixed segments of 4 voxels differ most; the third and the fourth show differences.
"""

POSITION_TEXT = """\
Distance between where a ray is sampled and the true position Phi(P(t)) at the same t, over many rays,
in voxels: of polylines at places of each segment, of ERROR_BOUND at the samples that the fast kernels
take. Where T folds (*random 45*, EXACT) the true position is that of one branch of several.
"""

DIFFERENCES = """\
## Where these figures differ from the paper's

- The average length of segments starts at {start:.1f}, not at 8: the first segments of a ray are 1, 2
  and 4 voxels long, because the algorithm of section 4.5 starts from the minimum and doubles, and the
  last one is what is left of the ray. All others are 8 voxels long.
- Figures 6b, 6c and 7b are per ray that meets the volume *at rest*, a fixed set. Per ray that meets
  the bounds of the deformed volume, as the statistics of the mapper have it, the curves would sink,
  because those bounds grow faster than the object in them. For the ratios of table 1 the two are the
  same.
- With the *random* deformation the paper's method ends at magnitude 45 about where it does in the
  paper ({ends}),
  but it gets there more slowly: at 15 it has still lost less. With the *smooth* one it loses next to
  nothing, because its segments stay about 5 voxels long. What is lost follows the length of the
  segments, as the paper says, not the magnitude as such.
- Figure 8 needs a far more severe deformation than figures 5 to 7: where adaptive segments are 2
  voxels long, fixed ones of 2 and 4 are hardly worse. That ours look smooth even with 4 voxels is also
  due to normals: they come from the derivatives of the deformation, not from the segments. Those of
  the fast kernels come from the 4 x 4 nodes of a tile and have no proven bound: under so severe a
  deformation ERROR_BOUND is closest in position, but not in color.
"""

PACKETS = """\
- *default* looks distances up for parts of a piece and 4 x 4 rays at once: {straight:.2f} look-ups a ray
  undeformed, {bent:.2f} at 45 ({title}, smooth). All rays of a packet take a sample where one of them
  has to. Table 1 is not a table of times; Testing/Benchmarks has those.
"""


def differences(table, methods, shapes):
    """Honest words, with the figures that they are about."""
    ends = ", ".join("%.2f for %.2f" % (
        table.ratio("random", 45, "paper", opacity), experiments.PAPER_TABLE[opacity][-1])
        for opacity in scene.OPACITIES)
    start = table.get("smooth", 0, "paper", "semi").segment_length
    text = DIFFERENCES.format(start=start, ends=ends)
    title = scene.OPACITY_TITLES["sparse"]
    straight, bent = (table.get("smooth", at, "default", "sparse").lookups for at in (0, 45))
    return text + PACKETS.format(straight=straight, bent=bent, title=title)
