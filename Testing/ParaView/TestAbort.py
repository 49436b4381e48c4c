#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""A long frame shows its progress in ParaView's window; the mouse, its wheel and keys abort it; one that
the user asked for is preceded by a coarse one: where ParaView renders itself and where its server
does, of one process or two. ParaView gets its input from outside, as from a user."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import ffdparaview as ffd
import ffdprocess
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.append(os.path.join(HERE, "..", "Python"))
import ffdinput  # noqa: E402

# A pixel of ParaView's window, which is in the upper left corner: a place of the view beside the volume.
BACKGROUND = (500, 300)
RIGHT = (950, 300)  # in the right one of two views
RESTING_TIME = 1.5  # of the pointer, seconds, after which ParaView has asked for the value below it


def find_children(process):
    with open("/proc/{0}/task/{0}/children".format(process.pid), encoding="ascii") as file:
        return [int(number) for number in file.read().split()]


@contextlib.contextmanager
def paused(process):
    """Meanwhile a process, or those that mpiexec has started, stand still: then a frame is as far as it was,
    however fast the machine is, and all input of the time comes at once."""
    numbers = find_children(process) if process.args[0] == "mpiexec" else [process.pid]
    for number in numbers:
        os.kill(number, signal.SIGSTOP)
    try:
        yield
    finally:
        for number in numbers:
            os.kill(number, signal.SIGCONT)


class TestAbort(unittest.TestCase):
    def setUp(self):
        self.processes = []

    def begin(self):
        self.folder = tempfile.mkdtemp(prefix="abort.", dir=ffd.TEMPORARY)
        os.chmod(self.folder, 0o700)
        self.log = os.path.join(self.folder, "log")
        self.seen = 0
        self.whole = None  # messages of the progress of a whole frame

    def tearDown(self):
        for process in reversed(self.processes):
            # mpiexec passes on that it is to end, and could not pass on that it is killed.
            if process.args[0] == "mpiexec":
                ffdprocess.stop(process)
            else:
                process.kill()
                process.wait()
        self.processes.clear()

    def start(self, *command, stdout=None, stderr=None, **environment):
        self.processes.append(subprocess.Popen(
            command, stdout=stdout, stderr=stderr,
            env={**os.environ, "HOME": self.folder, "XDG_RUNTIME_DIR": self.folder,
                 "PV_PLUGIN_PATH": os.path.dirname(ffd.PLUGIN), "FFD_ABORT_LOG": self.log,
                 **environment}))

    def start_server(self, port, ranks):
        path = os.path.join(self.folder, "server")
        with open(path, "w", encoding="utf-8") as output:
            self.start(*(["mpiexec", "-np", str(ranks)] if ranks > 1 else []), "pvserver",
                       "--server-port=%d" % port, stdout=output, stderr=subprocess.STDOUT)
        end = time.monotonic() + 1000.0
        while time.monotonic() < end:
            with open(path, encoding="utf-8") as output:
                text = output.read()
            if "Accepting" in text:
                return
            self.assertIsNone(self.processes[-1].poll(), text)
            time.sleep(0.1)
        self.fail("The server does not accept connections.")

    def next(self, event, seconds=1000.0, **wanted):
        """The next line of the log of such an event, those before it are left out."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            for process in self.processes:
                self.assertIsNone(process.poll())
            if os.path.exists(self.log):
                with open(self.log, encoding="ascii") as file:
                    lines = file.read().split("\n")[:-1]
                while self.seen < len(lines):
                    line = json.loads(lines[self.seen])
                    self.seen += 1
                    if line["event"] == event and all(line[k] == wanted[k] for k in wanted):
                        return line
            time.sleep(0.02)
        self.fail("There was no %s with %s." % (event, wanted))

    def wait_until_idle(self):
        """Until no frame has begun for a second."""
        while True:
            time.sleep(1.0)
            with open(self.log, encoding="ascii") as file:
                lines = [json.loads(line) for line in file.read().split("\n")[:-1]]
            rendering = lines[-1]["event"] in ("begin", "progress")
            if not rendering and time.monotonic() - lines[-1]["time"] > 1.0:
                self.seen = len(lines)
                return

    def abort_by(self, act, **frame):
        """Act when the next still frame shows that it has begun; it must end soon, without a picture."""
        self.next("progress", still=True, **frame)
        # The first of them renders.
        with paused(self.processes[0]):
            act()
            if len(self.processes) > 1:
                time.sleep(0.5)  # for the client, which goes on, to say so to its server
        line = self.next("end", still=True, **frame)
        self.assertTrue(line["aborted"])
        self.assertLess(len(line["progress"]), 0.5 * self.whole)

    def check_aborts(self):
        self.whole = len(self.next("end", still=True, aborted=False)["progress"])
        self.assertGreaterEqual(self.whole, 3)
        # A screenshot is not a coarse picture, whatever the user did before.
        self.assertFalse(self.next("screenshot")["swaps"])
        # What the window's first events bring about.
        self.next("ready")
        self.wait_until_idle()

        # A turn of the camera, and the still frame after it.
        ffdinput.move(*BACKGROUND)
        ffdinput.press(ffdinput.LEFT)
        time.sleep(0.2)
        ffdinput.move(BACKGROUND[0] + 40, BACKGROUND[1] + 10)
        self.next("begin", still=False)
        self.next("end", still=False)
        ffdinput.release(ffdinput.LEFT)
        self.abort_by(lambda: ffdinput.click(ffdinput.WHEEL_DOWN))
        self.abort_by(lambda: ffdinput.strike("Left"))
        # The button is held for a while: the frame is made when it is up. A turn, as a click would
        # leave nothing to take back: the picture would be shown again.
        self.abort_by(lambda: ffdinput.press(ffdinput.LEFT))
        ffdinput.move(BACKGROUND[0] + 10, BACKGROUND[1] + 30)
        self.next("end", still=False)
        ffdinput.release(ffdinput.LEFT)
        self.next("end", still=True, aborted=False)

        # Not after a moving frame, but a still one: by the key that takes the turn of the camera back.
        self.wait_until_idle()
        ffdinput.strike("Control_L", "b")
        coarse = self.next("begin")
        self.assertFalse(coarse["still"])
        self.abort_by(lambda: ffdinput.click(ffdinput.WHEEL_UP))
        self.next("end", still=True, aborted=False)

    def test_abort(self):
        pictures = {}
        for name, ranks in (("local", 0), ("server", 1), ("servers", 2)):
            with self.subTest(name):
                self.begin()
                options = []
                if ranks > 0:
                    port = ffdprocess.find_port()
                    self.start_server(port, ranks)
                    options = ["--server-url=cs://localhost:%d" % port]
                self.start("paraview", "--dr", *options,
                           "--script=" + os.path.join(HERE, "AbortScene.py"))
                self.check_aborts()
                pictures[name] = ffd.read_picture(self.log + ".png")
            self.tearDown()
        # Progress that is shown while the client waits for the picture does not spoil that.
        self.assertGreater(np.ptp(pictures["local"]), 100)
        for name in ("server", "servers"):
            self.assertLess(ffd.differ(pictures["local"], pictures[name])[1], 0.5, name)

    def test_lost_server(self):
        """The server is lost while a key is held, which the value below the pointer is asked of:
        ParaView's question, and one message, behind which the still frame that was to come is not asked
        for, which would end ParaView. Where the client still waits for the end of the aborted frame
        there is the question alone: an answer that never comes is no error of the socket."""
        self.begin()
        port = ffdprocess.find_port()
        self.start_server(port, 1)
        output = os.path.join(self.folder, "output")
        with open(output, "w", encoding="utf-8") as file:
            self.start("paraview", "--dr", "--server-url=cs://localhost:%d" % port,
                       "--script=" + os.path.join(HERE, "AbortScene.py"), stdout=file,
                       stderr=subprocess.STDOUT)
        self.whole = len(self.next("end", still=True)["progress"])
        self.next("ready")
        self.wait_until_idle()
        ffdinput.move(*BACKGROUND)
        ffdinput.press(ffdinput.LEFT)
        time.sleep(0.2)
        ffdinput.move(BACKGROUND[0] + 40, BACKGROUND[1] + 10)
        self.next("end", still=False)
        ffdinput.release(ffdinput.LEFT)
        self.addCleanup(ffdinput.press_key, "F7", False)  # no test after a failure is to find it held
        self.abort_by(lambda: ffdinput.press_key("F7"))
        time.sleep(1.0)  # mostly the client has heard of the end of the frame then
        server, window = self.processes
        server.kill()
        server.wait()
        # The pointer moves and rests, as the value below it is asked for when it has rested, until the
        # question comes, and a little longer: ParaView may have no time for the first motions, which Qt
        # drops then. It takes some seconds; what never comes is not to take all of the time that there
        # is for the tests.
        end = time.monotonic() + 240.0
        step = 0
        while time.monotonic() < end and not ffdinput.find_window("Server disconnected"):
            step += 1
            ffdinput.move(BACKGROUND[0] + 60 + step % 20, BACKGROUND[1] + 20)
            time.sleep(RESTING_TIME)
        self.assertTrue(ffdinput.find_window("Server disconnected"))
        for more in range(3):
            ffdinput.move(BACKGROUND[0] + 90 + more, BACKGROUND[1] + 20)
            time.sleep(0.2)
        time.sleep(2.0)
        ffdinput.press_key("F7", False)
        # More messages would soon follow.
        time.sleep(3.0)
        with open(output, encoding="utf-8") as file:
            text = file.read()
        self.assertIsNone(window.poll(), text)
        self.assertLessEqual(text.count("ERR|"), 1, text)

    def test_views(self):
        """Two views show a coarse picture of what the user does; both are finished. The wheel in one aborts
        the frame of the other, too."""
        self.begin()
        self.start("paraview", "--dr", "--script=" + os.path.join(HERE, "TwoViewsScene.py"))
        self.next("ready")
        self.wait_until_idle()
        window = ffdinput.find_window("ParaView 5")
        ffdinput.move(100, 600)
        # Qt drops a motion that it has not handled when another one comes.
        time.sleep(1.0)
        with paused(self.processes[0]):
            ffdinput.focus(window)
            ffdinput.strike("F8")
            ffdinput.move(*BACKGROUND)
        for view in range(2):
            self.next("end", view=view, still=False)
        finished = self.next("end", still=True, aborted=False)
        first = finished["view"]
        self.whole = len(finished["progress"])

        def turn_wheel():
            ffdinput.move(*(BACKGROUND, RIGHT)[first])
            ffdinput.click(ffdinput.WHEEL_DOWN)

        self.abort_by(turn_wheel, view=1 - first)
        self.next("end", view=1 - first, still=True, aborted=False)

    def test_size(self):
        """Widgets that are painted to show the progress do not take the frame away: the view itself,
        where its size has changed and all its frames take long."""
        self.begin()
        output = os.path.join(self.folder, "output")
        with open(output, "w", encoding="utf-8") as file:
            self.start("paraview", "--dr", "--script=" + os.path.join(HERE, "AbortScene.py"),
                       stdout=file, stderr=subprocess.STDOUT, FFD_ABORT_ALL="1")
        self.next("ready")
        self.wait_until_idle()
        window = ffdinput.find_window("ParaView ")
        ffdinput.resize(window, 1000, 800)
        moving = self.next("end", still=False)
        self.assertGreaterEqual(len(moving["progress"]), 1)
        self.wait_until_idle()
        with open(self.log, encoding="ascii") as file:
            frames = [line for line in map(json.loads, file) if line["event"] == "end"]
        self.assertNotEqual(frames[0]["size"], frames[-1]["size"])
        background = [82, 87, 110]
        self.assertGreater(max(np.abs(np.subtract(frames[0]["color"], background))), 6)
        for frame in frames:
            self.assertLess(max(np.abs(np.subtract(frame["color"], frames[0]["color"]))), 3, frames)
        with open(output, encoding="utf-8") as file:
            self.assertNotIn("WARN|", file.read())


if __name__ == "__main__":
    unittest.main()
