# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Figures of the report: pictures and curves, as PNG."""

import os

import matplotlib

matplotlib.use("Agg")  # no window, no display

import matplotlib.pyplot as pyplot  # noqa: E402
from matplotlib.ticker import NullFormatter, ScalarFormatter  # noqa: E402
import numpy  # noqa: E402

import experiments  # noqa: E402
import scene  # noqa: E402

BACKGROUND = (0.10, 0.11, 0.13)
COLORS = {"semi": "#0072B2", "opaque": "#D55E00", "sparse": "#009E73"}
STYLES = {"paper": "-", "default": "--"}


def _save(figure, folder, name, dpi=100):
    path = os.path.join(folder, name)
    # No date and no version inside: the same figures make the same file.
    figure.savefig(path, dpi=dpi, metadata={"Software": None})
    pyplot.close(figure)
    return name


def _show(axes, pixels, title=None):
    axes.imshow(numpy.clip(pixels, 0.0, 1.0), interpolation="nearest")
    axes.set_axis_off()
    if title:
        axes.set_title(title, fontsize=10)


def draw_figure5(folder, image, shape, size, progress):
    """The engine at four magnitudes and three opacity settings, by the paper's method."""
    columns = scene.TABLE_MAGNITUDES
    figure, axes = pyplot.subplots(
        len(scene.OPACITIES), len(columns), figsize=(3.0 * len(columns), 9.3),
        gridspec_kw={"left": 0.0, "right": 1.0, "bottom": 0.0, "top": 0.96, "wspace": 0.01,
                     "hspace": 0.08})
    for row, opacity in enumerate(scene.OPACITIES):
        for column, magnitude in enumerate(columns):
            progress("figure 5, %s %d, %s" % (shape, magnitude, opacity))
            lattice = scene.make_lattice(image, shape, magnitude)
            picture = scene.render(
                image, scene.make_mapper(image, lattice, "paper"), scene.make_property(opacity),
                size)
            _show(axes[row][column], picture.over(BACKGROUND),
                  "%s, %d" % (scene.OPACITY_TITLES[opacity], magnitude))
    return _save(figure, folder, "figure5_%s.png" % shape)


def _curves(folder, name, table, magnitudes, panels, methods, opacities):
    """A row of panels for each deformation; `panels`: (title, function of counts)."""
    figure, axes = pyplot.subplots(
        len(scene.CURVE_SHAPES), len(panels), squeeze=False,
        figsize=(4.3 * len(panels), 3.3 * len(scene.CURVE_SHAPES)), constrained_layout=True)
    for row, shape in enumerate(scene.CURVE_SHAPES):
        for column, (title, value, get) in enumerate(panels):
            panel = axes[row][column]
            for method in methods:
                for opacity in opacities:
                    panel.plot(
                        magnitudes,
                        [value(get(shape, m, method, opacity)) for m in magnitudes],
                        STYLES[method], color=COLORS[opacity], marker="o", markersize=3,
                        label="%s, %s" % (
                            {"paper": "paper's method", "default": "vtkFFD"}[method],
                            {"semi": "semi-transparent", "opaque": "opaque",
                             "sparse": "opaque, much empty"}[opacity]))
            panel.set_ylim(bottom=0.0)
            panel.grid(True, alpha=0.3)
            panel.set_title("%s\n%s" % (title, scene.SHAPES[shape].title), fontsize=9)
            panel.set_xlabel("deformation magnitude (voxels)", fontsize=8)
            panel.tick_params(labelsize=8)
    handles, labels = axes[0][0].get_legend_handles_labels()
    if len(opacities) == 1:
        labels = [label.split(",")[0] for label in labels]
    figure.legend(handles, labels, loc="lower center", ncol=2, fontsize=8)
    figure.get_layout_engine().set(rect=(0.0, 0.06, 1.0, 0.94))
    return _save(figure, folder, name)


def draw_figure6(folder, table, magnitudes):
    panels = (
        ("a: average segment length (voxels)", lambda c: c.segment_length, table.get),
        ("b: samples per ray", table.samples, table.get),
        ("c: distance look-ups per ray", table.lookups, table.get),
    )
    return _curves(folder, "figure6.png", table, magnitudes, panels, ("paper", "default"),
                   tuple(scene.OPACITIES))


def draw_figure7(folder, table, magnitudes):
    panels = (
        ("a: average segment length (voxels)", lambda c: c.segment_length, table.get_unoptimized),
        ("b: samples per ray", table.samples, table.get_unoptimized),
    )
    return _curves(folder, "figure7.png", table, magnitudes, panels, ("paper", "default"),
                   ("opaque",))


def draw_table1(folder, table, curves):
    """Speed-ups by magnitude, with the paper's; `curves`: pairs of deformation and method."""
    figure, axes = pyplot.subplots(1, 3, figsize=(13.0, 4.2), constrained_layout=True)
    styles = {"paper": ("#0072B2", "the paper's method, here"),
              "default": ("#D55E00", "vtkFFD, default settings"),
              "firstorder": ("#CC79A7", "vtkFFD, FIRST_ORDER")}
    lines = {"smooth": "-", "random": ":"}
    for panel, opacity in zip(axes, scene.OPACITIES):
        panel.plot(scene.TABLE_MAGNITUDES, experiments.PAPER_TABLE[opacity], "k-", linewidth=2.5,
                   marker="s", label="the paper's table 1")
        for shape, method in curves:
            color, title = styles[method]
            panel.plot(
                scene.TABLE_MAGNITUDES,
                [table.ratio(shape, m, method, opacity) for m in scene.TABLE_MAGNITUDES],
                lines[shape], color=color, marker="o", markersize=4,
                label="%s, %s" % (title, shape))
        panel.set_ylim(bottom=0.0)
        panel.grid(True, alpha=0.3)
        panel.set_title(scene.OPACITY_TITLES[opacity], fontsize=10)
        panel.set_xlabel("deformation magnitude (voxels)", fontsize=9)
    axes[0].set_ylabel("samples without / operations with optimization", fontsize=9)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncol=3, fontsize=8)
    figure.get_layout_engine().set(rect=(0.0, 0.16, 1.0, 0.84))
    return _save(figure, folder, "table1.png")


def _find_crop(pictures, side):
    """Where fixed segments of 4 differ most from the exact picture."""
    difference = numpy.abs(
        pictures["fixed4"].over(BACKGROUND) - pictures["exact"].over(BACKGROUND)).max(axis=2)
    sums = numpy.pad(difference.cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    windows = (sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side]
               + sums[:-side, :-side])
    y, x = numpy.unravel_index(windows.argmax(), windows.shape)
    return slice(y, y + side), slice(x, x + side)


def draw_figure8(folder, pictures):
    """Pictures; the part where they differ most; differences from the exact one in color, and of
    the surface along the view."""
    names = list(experiments.FIGURE8)
    figure, axes = pyplot.subplots(
        4, len(names), figsize=(3.0 * len(names), 12.6),
        gridspec_kw={"left": 0.0, "right": 1.0, "bottom": 0.0, "top": 0.97, "wspace": 0.02,
                     "hspace": 0.08})
    crop = _find_crop(pictures, pictures["exact"].colors.shape[0] // 4)
    exact = pictures["exact"]
    for column, name in enumerate(names):
        picture = pictures[name]
        pixels = picture.over(BACKGROUND)
        _show(axes[0][column], pixels, experiments.FIGURE8[name])
        _show(axes[1][column], pixels[crop])
        if name in ("undeformed", "exact"):
            axes[2][column].set_axis_off()
            axes[3][column].set_axis_off()
            continue
        _show(axes[2][column], 8.0 * numpy.abs(pixels - exact.over(BACKGROUND)),
              "difference of colors x 8")
        both = numpy.isfinite(picture.depths) & numpy.isfinite(exact.depths)
        apart = numpy.full(both.shape, numpy.nan)
        apart[both] = numpy.abs(picture.depths[both] - exact.depths[both])
        axes[3][column].imshow(apart, vmin=0.0, vmax=0.5, cmap="viridis", interpolation="nearest")
        axes[3][column].set_axis_off()
        axes[3][column].set_title("distance of surfaces, 0 to 0.5 voxel", fontsize=10)
    return _save(figure, folder, "figure8.png")


def draw_position_error(folder, rows):
    """Largest and mean distances by segmentation; rows as the program prints them."""
    cases = []
    for row in rows:
        case = (row["deformation"], row["inverse"])
        if case not in cases:
            cases.append(case)
    deformations = sorted({case[0] for case in cases}, key=[c[0] for c in cases].index)
    figure, axes = pyplot.subplots(
        1, len(deformations), squeeze=False, figsize=(5.0 * len(deformations), 4.4),
        constrained_layout=True)
    colors = {"FIRST_ORDER": "#0072B2", "EXACT": "#D55E00", "PULL_BACK": "#009E73"}
    for panel, deformation in zip(axes[0], deformations):
        for inverse, color in colors.items():
            for kind, marker in (("ERROR_BOUND", "o"), ("GREEDY_ANGLE", "^")):
                mine = [r for r in rows if r["deformation"] == deformation
                        and r["inverse"] == inverse and r["segmentation"] == kind]
                if not mine:
                    continue
                panel.plot(
                    [float(r["segments_per_100_voxels"]) for r in mine],
                    [max(float(r["largest_error"]), 1e-6) for r in mine],
                    "-" if kind == "ERROR_BOUND" else ":", marker=marker, color=color,
                    markersize=4, label="%s, %s" % (kind, inverse))
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_xticks([10, 20, 50, 100, 200])
        panel.set_xlim(9.0, 250.0)
        panel.xaxis.set_major_formatter(ScalarFormatter())
        panel.xaxis.set_minor_formatter(NullFormatter())
        panel.grid(True, alpha=0.3)
        panel.set_title(deformation, fontsize=10)
        panel.set_xlabel("segments per 100 voxels of a ray", fontsize=9)
    axes[0][0].set_ylabel("largest distance from the true curve (voxels)", fontsize=9)
    axes[0][0].legend(fontsize=7)
    return _save(figure, folder, "position_error.png")
