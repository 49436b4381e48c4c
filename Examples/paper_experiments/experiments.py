# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The measurements of section 5 of the paper, and what must show in them."""

from dataclasses import dataclass

import numpy

import scene

#: Table 1 of the paper, by opacity setting, for the magnitudes 0, 15, 30 and 45.
PAPER_TABLE = {
    "semi": (4.43, 3.29, 3.13, 3.23),
    "opaque": (13.70, 7.11, 6.23, 6.20),
    "sparse": (14.16, 5.10, 4.67, 4.52),
}

#: Part of the undeformed speed-up that ours must keep at magnitude 45, smooth deformation.
KEEP = 0.75


class CountTable:
    """Counts of all pictures of figures 6 and 7 and of table 1, rendered when first asked for."""

    def __init__(self, image, size, sample_distance=scene.SAMPLE_DISTANCE, progress=None):
        self.image = image
        self.size = size
        self.sample_distance = sample_distance
        self.progress = progress or (lambda text: None)
        self.lattices = {}
        self.counts = {}

    def get(self, shape, magnitude, method, opacity):
        """With space leaping and early ray termination."""
        return self._get(shape, magnitude, method, opacity, True)

    def get_unoptimized(self, shape, magnitude, method, opacity="opaque"):
        """With neither: then the opacities change nothing, and one stands for all."""
        return self._get(shape, magnitude, method, opacity, False)

    def ratio(self, shape, magnitude, method, opacity):
        """Samples without optimization over samples and look-ups with it: an entry of table 1."""
        optimized = self.get(shape, magnitude, method, opacity).operations
        return self.get_unoptimized(shape, magnitude, method).samples / optimized

    def samples(self, counts):
        """
        Samples for each ray that meets the volume at rest. The bounds of the deformed volume grow,
        and with them the number of rays that meet them but not the object; an average over those
        would sink only because there are more of them.
        """
        return counts.samples * self._rays_scale(counts)

    def lookups(self, counts):
        return counts.lookups * self._rays_scale(counts)

    def _rays_scale(self, counts):
        return counts.rays / self.get_unoptimized("smooth", 0, "paper").rays

    def _get(self, shape, magnitude, method, opacity, optimized):
        if magnitude == 0:
            shape = next(iter(scene.SHAPES))  # all the same
        key = (shape, magnitude, method, opacity, optimized)
        if key not in self.counts:
            at = (shape, magnitude)
            if at not in self.lattices:
                self.lattices[at] = scene.make_lattice(self.image, shape, magnitude)
            self.progress("%s %d, %s, %s, %s" % (
                shape, magnitude, method, opacity,
                "optimized" if optimized else "not optimized"))
            mapper = scene.make_mapper(
                self.image, self.lattices[at], method, optimized, self.sample_distance)
            # Shading changes no count of samples; only seen pictures need it.
            prop = scene.make_property(opacity, shade=False)
            self.counts[key] = scene.render(
                self.image, mapper, prop, self.size, scene.COUNTING_DISTANCE).counts
        return self.counts[key]

    def rows(self):
        """All counts so far, for a CSV file: header and rows."""
        header = [
            "deformation", "magnitude", "method", "opacity", "optimized", "rays",
            "segments_per_ray", "average_segment_length", "samples_per_ray",
            "visible_samples_per_ray", "distance_lookups_per_ray", "evaluations_per_ray",
            "unconverged_points"]
        rows = []
        for (shape, magnitude, method, opacity, optimized), c in sorted(self.counts.items()):
            rows.append([
                shape if magnitude else "none", magnitude, method, opacity, int(optimized), c.rays,
                "%.3f" % c.segments_per_ray, "%.3f" % c.segment_length, "%.3f" % c.samples,
                "%.3f" % c.visible_samples, "%.3f" % c.lookups, "%.3f" % c.evaluations,
                c.unconverged])
        return header, rows


@dataclass(frozen=True)
class Check:
    """Something that the figures must show."""

    name: str
    wanted: str
    measured: str
    met: bool


def _list(numbers, form="%.2f"):
    return ", ".join(form % n for n in numbers)


def _falls(numbers, slack=0.03):
    """Whether a curve falls, but for ripples of a few per cent of its start."""
    return all(b <= a + slack * numbers[0] for a, b in zip(numbers, numbers[1:]))


def check_trends(table, magnitudes):
    """Figures 6 and 7 in the paper's settings, with the deformation that is closest to its own."""
    checks = []
    lengths = [table.get("random", m, "paper", "semi").segment_length for m in magnitudes]
    checks.append(Check(
        "fig6a.segment_length", "falls from nearly 8 to about 2 voxels, without end pieces",
        _list(lengths), lengths[0] > 6.0 and 1.4 <= lengths[-1] <= 2.4 and _falls(lengths)))
    lengths = [table.get_unoptimized("random", m, "paper").segment_length for m in magnitudes]
    checks.append(Check(
        "fig7a.segment_length", "the same without optimization",
        _list(lengths), lengths[0] > 6.0 and 1.4 <= lengths[-1] <= 2.4 and _falls(lengths)))

    samples = [table.samples(table.get_unoptimized("random", m, "paper")) for m in magnitudes]
    checks.append(Check(
        "fig7b.samples", "samples a ray rise steadily without optimization",
        _list(samples), all(b > a for a, b in zip(samples, samples[1:]))))
    same = [table.get_unoptimized("random", magnitudes[-1], "paper", opacity).samples
            for opacity in scene.OPACITIES]
    checks.append(Check(
        "fig7.opacity_is_irrelevant", "without optimization all opacities cost the same",
        _list(same), max(same) - min(same) < 1e-9))

    for shape in ("smooth", "random"):
        for opacity in scene.OPACITIES:
            samples = [table.samples(table.get(shape, m, "paper", opacity)) for m in magnitudes]
            most = samples[-1] / samples[0]
            checks.append(Check(
                "fig6b.samples.%s.%s" % (shape, opacity),
                "samples a ray rise only gradually: by at most a half",
                _list(samples), 1.0 <= most <= 1.5))
    for opacity in scene.OPACITIES:
        lookups = [table.lookups(table.get("random", m, "paper", opacity)) for m in magnitudes]
        checks.append(Check(
            "fig6c.lookups.%s" % opacity,
            "look-ups a ray grow as segments shorten: at least twice",
            _list(lookups), lookups[-1] >= 2.0 * lookups[0]))
    for opacity in scene.OPACITIES:
        ratios = [table.ratio("random", m, "paper", opacity) for m in scene.TABLE_MAGNITUDES]
        first = PAPER_TABLE[opacity][0]
        checks.append(Check(
            "table1.paper.%s" % opacity,
            "the paper's method starts within 15 % of its table and falls",
            _list(ratios), abs(ratios[0] / first - 1.0) <= 0.15 and _falls(ratios, 0.05)))
    return checks


def check_ours(table, method):
    """What the default settings have to reach with a smooth deformation."""
    checks = []
    for opacity in scene.OPACITIES:
        ratios = [table.ratio("smooth", m, method, opacity) for m in scene.TABLE_MAGNITUDES]
        kept = ratios[-1] / ratios[0]
        checks.append(Check(
            "table1.%s.keeps.%s" % (method, opacity),
            "at 45 at least %.0f %% of the undeformed speed-up" % (100.0 * KEEP),
            "%.0f %%" % (100.0 * kept), kept >= KEEP))
        checks.append(Check(
            "table1.%s.beats_paper.%s" % (method, opacity),
            "more than " + _list(PAPER_TABLE[opacity]),
            _list(ratios), all(r > p for r, p in zip(ratios, PAPER_TABLE[opacity]))))
    return checks


#: Voxels between samples in figure 8: packets and polylines do not take the same ones, which is to be
#: less than what tells the cuts apart.
FIGURE8_DISTANCE = 0.0625

#: PositionTolerance of ERROR_BOUND in figure 8, voxels: what it allows is less than that, too.
FIGURE8_TOLERANCE = 0.02

#: Figure 8: how rays are cut. "exact" has a segment for every sample.
FIGURE8 = {
    "undeformed": "a: undeformed",
    "adaptive": "b: adaptive, 5 degrees, 0.5 to 8 voxels",
    "fixed2": "c: fixed, 2 voxels",
    "fixed4": "d: fixed, 4 voxels",
    "bound": "ERROR_BOUND, 0.1 voxel",
    "exact": "a segment for each sample",
}


@dataclass(frozen=True)
class Figure8Row:
    """Differences from the picture of "exact"."""

    segments: float  # a ray
    evaluations: float
    mean_color: float  # of 255, over the pixels that either picture covers
    changed: float  # part of those pixels that differ by more than 8 of 255
    mean_depth: float  # voxels, over the pixels that both cover
    depth_95: float  # percentile
    roughness: float  # voxels, see depth_roughness


def depth_roughness(depths, exact):
    """
    How rough a surface is that should be as smooth as another one: root mean square of the
    difference of their depths less its mean over the four neighbors, where all of them agree to
    a few voxels, so that outlines do not count.
    """
    with numpy.errstate(invalid="ignore"):
        error = depths - exact
    fine = numpy.isfinite(error) & (numpy.abs(numpy.where(numpy.isfinite(error), error, 9e9)) < 4.0)
    error = numpy.where(fine, error, 0.0)
    inner = error[1:-1, 1:-1]
    mean = 0.25 * (error[:-2, 1:-1] + error[2:, 1:-1] + error[1:-1, :-2] + error[1:-1, 2:])
    good = (fine[1:-1, 1:-1] & fine[:-2, 1:-1] & fine[2:, 1:-1] & fine[1:-1, :-2]
            & fine[1:-1, 2:])
    return float(numpy.sqrt(numpy.mean((inner - mean)[good] ** 2))) if good.any() else 0.0


def run_figure8(image, size, sample_distance, progress=None):
    """
    Pictures by name, and a Figure8Row for each deformed one but "exact". The samples have to be
    dense: what differs between the pictures should be where the rays are, not where the samples.
    """
    progress = progress or (lambda text: None)
    shape, magnitude = scene.FIGURE8_SHAPE, scene.FIGURE8_MAGNITUDE
    pictures = {}
    for name in FIGURE8:
        progress("figure 8, %s" % name)
        lattice = scene.make_lattice(image, shape, 0 if name == "undeformed" else magnitude)
        method = "firstorder" if name == "bound" else "paper"
        mapper = scene.make_mapper(image, lattice, method, True, sample_distance)
        mapper.SetOpacityLengthToMaterial()
        if name == "bound":
            mapper.SetPositionTolerance(FIGURE8_TOLERANCE)
        fixed = {"fixed2": 2.0, "fixed4": 4.0, "exact": sample_distance}.get(name)
        if fixed:
            mapper.SetMinimumSegmentLength(fixed)
            mapper.SetMaximumSegmentLength(fixed)
        pictures[name] = scene.render(image, mapper, scene.make_property("opaque"), size)
    exact = pictures["exact"]
    rows = {}
    for name, picture in pictures.items():
        if name in ("undeformed", "exact"):
            continue
        difference = numpy.abs(picture.over((0, 0, 0)) - exact.over((0, 0, 0))).max(axis=2) * 255.0
        covered = (picture.colors[:, :, 3] > 0) | (exact.colors[:, :, 3] > 0)
        both = numpy.isfinite(picture.depths) & numpy.isfinite(exact.depths)
        apart = numpy.abs(picture.depths[both] - exact.depths[both])
        rows[name] = Figure8Row(
            picture.counts.segments_per_ray, picture.counts.evaluations,
            float(difference[covered].mean()), float((difference[covered] > 8.0).mean()),
            float(apart.mean()), float(numpy.percentile(apart, 95.0)),
            depth_roughness(picture.depths, exact.depths))
    return pictures, rows


def check_figure8(rows):
    """What figure 8 shows, in numbers."""
    order = ("bound", "adaptive", "fixed2", "fixed4")
    depths = [rows[name].mean_depth for name in order]
    rough = [rows[name].roughness for name in order]
    return [
        Check("fig8.depth", "mean distance from the exact surface grows in the order " +
              ", ".join(order), _list(depths, "%.3f"), depths == sorted(depths)),
        Check("fig8.roughness", "fixed 4 is at least 1.5 x as rough as adaptive",
              _list(rough, "%.3f"), rough[3] >= 1.5 * rough[1]),
    ]
