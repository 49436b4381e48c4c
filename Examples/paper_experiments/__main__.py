#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reproduce section 5 of "Fast Volume Deformation Using Inverse-Ray-Deformation and FFD".

Writes a folder with figures 5 to 8 and table 1 of the paper as measured with vtkFFD, beside the
numbers that the paper prints: report.md, PNG pictures, CSV tables. Needs the built Python package
(PYTHONPATH=build/python) and matplotlib; no window and no display.
"""

import argparse
import os
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import experiments  # noqa: E402
import figures  # noqa: E402
import position_error  # noqa: E402
import report  # noqa: E402
import scene  # noqa: E402


def run(folder, size=256, quick=False, position_program=None, progress=None):
    """Measure and write everything; returns the list of experiments.Check."""
    progress = progress or (lambda text: None)
    os.makedirs(folder, exist_ok=True)
    image = scene.read_engine()
    magnitudes = scene.TABLE_MAGNITUDES if quick else scene.CURVE_MAGNITUDES
    shapes = ("smooth", "random") if quick else scene.CURVE_SHAPES
    table = experiments.CountTable(image, size, progress=progress)
    text = ["# The paper's experiments, measured with vtkFFD\n"]
    body = []

    # Table 1.
    methods = ("paper", "default") if quick else tuple(scene.METHODS)
    header, rows = report.table1(table, methods, ("smooth",))
    for shape in shapes[1:]:
        more = ("paper",) if quick else methods
        rows += [row for row in report.table1(table, more, (shape,))[1] if row[1] == shape]
    order = [scene.OPACITY_TITLES[name] for name in scene.OPACITIES]
    rows.sort(key=lambda row: order.index(row[0]))
    report.write_csv(folder, "table1.csv", header, rows)
    body += ["## Table 1: samples without optimization over samples and look-ups with it\n",
             report.markdown_table(header, rows),
             "![Table 1](%s)\n" % figures.draw_table1(folder, table, (
                 ("random", "paper"), ("smooth", "paper"), ("smooth", "default")))]

    # Figures 5 to 7.
    body += ["## Figure 5: the engine by magnitude and opacity, the paper's method\n"]
    for shape in shapes:
        name = figures.draw_figure5(folder, image, shape, 96 if quick else size, progress)
        body += ["![Figure 5, %s](%s)\n" % (shape, name)]
    if not quick:
        body += ["## Figure 6: with optimization\n",
                 "![Figure 6](%s)\n" % figures.draw_figure6(folder, table, magnitudes),
                 "## Figure 7: without optimization\n",
                 "![Figure 7](%s)\n" % figures.draw_figure7(folder, table, magnitudes)]

    # Figure 8.
    pictures, rows8 = experiments.run_figure8(
        image, 112 if quick else size, experiments.FIGURE8_DISTANCE, progress)
    header, rows = report.figure8_rows(rows8)
    report.write_csv(folder, "figure8.csv", header, rows)
    body += ["## Figure 8: how rays are cut\n", report.FIGURE8_TEXT.format(
        shape=scene.SHAPES[scene.FIGURE8_SHAPE].title, magnitude=scene.FIGURE8_MAGNITUDE,
        distance=experiments.FIGURE8_DISTANCE),
        "![Figure 8](%s)\n" % figures.draw_figure8(folder, pictures),
        report.markdown_table(header, rows)]

    # Position error, measured on the kernels themselves.
    body += ["## Position error\n"]
    errors = position_error.run(position_program, quick, progress)
    if errors is None:
        body += ["Not measured: the program ffd_position_error was not found. Build it, or name it "
                 "with --position-error.\n"]
    else:
        header, rows = position_error.table(errors)
        report.write_csv(folder, "position_error.csv", list(errors[0]), [
            list(row.values()) for row in errors])
        body += [report.POSITION_TEXT, report.markdown_table(header, rows),
                 "![Position error](%s)\n" % figures.draw_position_error(folder, errors)]

    # What must show.
    checks = experiments.check_trends(table, magnitudes)
    checks += experiments.check_ours(table, "default")
    checks += experiments.check_figure8(rows8)
    if errors is not None:
        checks += position_error.check(errors)
    header, rows = report.check_rows(checks)
    report.write_csv(folder, "checks.csv", header, rows)
    missed = sum(not c.met for c in checks)
    text += ["%d of %d checks are met.\n" % (len(checks) - missed, len(checks)),
             report.markdown_table(header, rows), report.differences(table, methods, shapes),
             report.settings_text(size, shapes)]

    body += ["## The counts behind table 1\n"]
    header, rows = report.counts_at_table_magnitudes(table, methods, ("smooth",))
    body += [report.markdown_table(header, rows)]
    if not quick:
        coarse = experiments.CountTable(image, size, 1.0, progress)
        header, rows = report.table1(coarse, methods, ("smooth",))
        report.write_csv(folder, "table1_one_voxel.csv", header, rows)
        body += ["## Table 1 with a sample distance of one voxel\n",
                 report.markdown_table(header, rows)]
    header, rows = table.rows()
    report.write_csv(folder, "counts.csv", header, rows)
    body += ["All counts are in counts.csv.\n"]
    with open(os.path.join(folder, "report.md"), "w", encoding="ascii") as stream:
        stream.write("\n".join(text + body))
    return checks


def main():
    parser = argparse.ArgumentParser(
        prog="paper_experiments", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", default="output/paper", help="folder of the report")
    parser.add_argument("--size", type=int, help="rays per side of a picture; default 256")
    parser.add_argument("--quick", action="store_true",
                        help="small pictures, four magnitudes, no curves: a minute or two")
    parser.add_argument("--position-error", metavar="PROGRAM",
                        help="ffd_position_error; default: that of the build tree")
    parser.add_argument("--quiet", action="store_true", help="do not say what is being rendered")
    arguments = parser.parse_args()
    size = arguments.size or (128 if arguments.quick else 256)
    if not 96 <= size <= 4096:
        parser.error("--size must be from 96 to 4096, not %d" % size)
    start = time.monotonic()

    def progress(text):
        if not arguments.quiet:
            print("%7.1f s  %s" % (time.monotonic() - start, text), flush=True)

    try:
        checks = run(arguments.output, size, arguments.quick, arguments.position_error, progress)
    except OSError as error:
        sys.exit("paper_experiments: %s" % error)
    for check in checks:
        print("%-7s %-36s %s" % ("met" if check.met else "MISSED", check.name, check.measured))
    print("report: %s" % os.path.join(arguments.output, "report.md"))


if __name__ == "__main__":
    main()
