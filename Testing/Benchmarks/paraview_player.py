#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""How many frames a second ParaView's window plays: a volume and a displacement field for each phase.

    Examples/paraview.sh pvpython Testing/Benchmarks/paraview_player.py [--size 128] [--pixels 512 512]

The series is that of Examples/Python/paraview_series.py. ParaView is started with it, its button Play is pressed
some times, and each pass is told: frames a second, and the wall-clock and processor time of a frame. For
comparison `--show outline` shows the outline of the same data, and `--show nothing` a single point that changes
with time: what ParaView itself takes for a frame. Besides it is told how often ParaView found out during a pass
which filters in its toolbars can be applied (see pqFFDPlayback), and once it has ended.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(globals().get("__file__", os.environ.get("FFD_PLAYER_SCRIPT", "."))))
sys.path.append(os.path.join(HERE, "..", "..", "Examples", "Python"))

from paraview import servermanager, simple  # noqa: E402

import paraview_series  # noqa: E402


class Passes:
    """In ParaView: writes a line of JSON for each event of the player into a file."""

    def __init__(self, path, window):
        self.log = open(path, "w", encoding="ascii")  # open until the end
        self.playing, self.frames, self.menus, self.rendering = False, 0, 0, 0.0
        player = simple.GetAnimationScene().SMProxy.GetClientSideObject()
        player.AddObserver("StartEvent", self.begin)
        player.AddObserver("EndEvent", self.end)
        player.AddObserver("AnimationCueTickEvent", self.tick)
        window.AddObserver("StartEvent", self.begin_rendering)
        window.AddObserver("EndEvent", self.end_rendering)
        # ParaView tries the active source as the input of each filter.
        manager = servermanager.vtkSMProxyManager.GetProxyManager().GetActiveSessionProxyManager()
        self.filter = manager.GetPrototypeProxy("filters", "FFDLattice").GetProperty("Input")
        self.filter.AddObserver("UncheckedPropertyModifiedEvent", self.try_filter)

    def write(self, event, **values):
        self.log.write(json.dumps({"event": event, **values}) + "\n")
        self.log.flush()

    def begin(self, *_):
        self.playing, self.frames, self.menus, self.rendering = True, 0, 0, 0.0
        self.start, self.used = time.perf_counter(), time.process_time()

    def end(self, *_):
        seconds, used = time.perf_counter() - self.start, time.process_time() - self.used
        self.playing = False
        self.write("pass", frames=self.frames, seconds=seconds, used=used, rendering=self.rendering,
                   menus=self.menus)
        self.menus = 0

    def tick(self, *_):
        self.frames += 1

    def begin_rendering(self, *_):
        self.render_start = time.perf_counter()

    def end_rendering(self, *_):
        self.rendering += time.perf_counter() - self.render_start

    def try_filter(self, *_):
        self.menus += 1
        if not self.playing and self.menus == 1:
            self.write("menus")


def show(options):
    """In ParaView: the scene."""
    view = simple.GetActiveViewOrCreate("RenderView")
    view.UseFXAA = int(not options.no_fxaa)
    if options.show == "nothing":
        if options.pixels:
            view.ViewSize = options.pixels
        shown = simple.TimeSource()
        simple.Show(shown, view)
        paraview_series.set_times(list(range(options.phases)), options)
    else:
        paraview_series.show(options, view)
        shown = simple.GetActiveSource()
        if options.show == "outline":
            simple.GetRepresentation(shown, view).SetRepresentationType("Outline")
    simple.SetActiveSource(shown)
    simple.Render(view)
    return Passes(os.environ["FFD_PLAYER_LOG"], view.GetRenderWindow())


def write_events(path, passes):
    play = '<pqevent object="pqClientMainWindow/VCRToolbar/actionVCRPlay" command="activate" arguments=""/>\n'
    wait = '<pqevent object="pqClientMainWindow" command="pause" arguments="500"/>\n'
    with open(path, "w", encoding="ascii") as file:
        file.write('<?xml version="1.0" ?>\n<pqevents>\n%s</pqevents>\n' % ((play + wait) * passes))


def run(options, folder):
    """Start ParaView; returns its events."""
    log, events = os.path.join(folder, "log"), os.path.join(folder, "events.xml")
    write_events(events, options.passes)
    environment = {**os.environ, "HOME": folder, "XDG_RUNTIME_DIR": folder, "FFD_PLAYER_LOG": log,
                   "FFD_PLAYER_OPTIONS": json.dumps(vars(options)), "FFD_PLAYER_SCRIPT": os.path.abspath(__file__)}
    if "FFD_PARAVIEW_PLUGIN" in os.environ:
        environment["PV_PLUGIN_PATH"] = os.path.dirname(os.environ["FFD_PARAVIEW_PLUGIN"])
    result = subprocess.run(
        ["paraview", "--dr", "--script=" + os.path.abspath(__file__), "--test-directory=" + folder,
         "--test-script=" + events, "--exit"],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment, check=False)
    if result.returncode != 0 or not os.path.exists(log):
        raise RuntimeError("ParaView ended with %d:\n%s" % (result.returncode, result.stdout))
    with open(log, encoding="ascii") as file:
        return [json.loads(line) for line in file]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--size", type=int, default=128, help="voxels along each axis")
    parser.add_argument("--phases", type=int, default=8)
    parser.add_argument("--frames", type=int, default=4, help="pictures from phase to phase")
    parser.add_argument("--passes", type=int, default=5, help="how often it is played")
    parser.add_argument("--quality", type=float, default=0.5,
                        help="1: a ray for each pixel, and a sample for each voxel")
    parser.add_argument("--pixels", type=int, nargs=2, help="of the view; default: what the window has for it")
    parser.add_argument("--no-fxaa", action="store_true", help="without ParaView's smoothing of edges")
    parser.add_argument("--show", choices=("volume", "outline", "nothing"), default="volume")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        os.chmod(folder, 0o700)
        options.volumes, options.transforms = paraview_series.make_series(folder, options.phases, options.size)
        number = 0
        for event in run(options, folder):
            if event["event"] == "menus":
                print("toolbars updated after it")
                continue
            number += 1
            print("pass %d: %.1f frames a second; a frame takes %.1f ms (%.1f of them to render), %.1f of processor "
                  "time; toolbars updated %d times" % (
                      number, event["frames"] / event["seconds"], *(1e3 * event[name] / event["frames"]
                      for name in ("seconds", "rendering", "used")), event["menus"]))


if "FFD_PLAYER_LOG" in os.environ:
    PASSES = show(argparse.Namespace(**json.loads(os.environ["FFD_PLAYER_OPTIONS"])))
elif __name__ == "__main__":
    main()
