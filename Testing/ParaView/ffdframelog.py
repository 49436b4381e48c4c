# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""What scenes that run in ParaView's graphical client tell TestAbort.py of their frames: how they begin, go
on and end, as lines of JSON in the file FFD_ABORT_LOG."""

import time

import ffdlog
from paraview import servermanager

log = ffdlog.open_log("FFD_ABORT_LOG")


def write(event, **more):
    log({"event": event, "time": time.monotonic(), **more})


class FrameLog:
    """Of one window; lines hold what is given by name. `describe` is called at the end of a frame for
    more of that."""

    def __init__(self, window, describe=dict, **names):
        self.window = window
        self.names = names
        self.describe = describe
        self.progress = None  # of the frame, the parts that were told
        self.handler = servermanager.ActiveConnection.Session.GetProgressHandler()
        self.handler.AddObserver("ProgressEvent", self.go_on)
        # After the plugin's observers at the beginning, before them at the end.
        window.AddObserver("StartEvent", self.begin, -1.0)
        window.AddObserver("EndEvent", self.end, 1.0)

    def write(self, event, **more):
        # Still frames are wanted at less than one a second.
        still = self.window.GetDesiredUpdateRate() < 1.0
        write(event, still=still, **self.names, **more)

    def begin(self, *_):
        self.progress = []
        self.write("begin")

    def go_on(self, *_):
        if self.progress is not None and self.handler.GetLastProgressText() == "FFD Volume":
            self.progress.append(self.handler.GetLastProgress() / 100.0)
            self.write("progress", progress=self.progress[-1])

    def end(self, *_):
        self.write("end", aborted=bool(self.window.GetAbortRender()), progress=self.progress,
                   **self.describe())
        self.progress = None
