#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""A client and a server of two processes give the picture of one process; the volume stays on the
server."""

import os
import subprocess
import unittest

import numpy as np
from paraview import servermanager, simple

import ffdparaview as ffd

ffd.load()


def show(view):
    lattice = simple.FFDLattice(Input=ffd.make_wavelet(), Shape="Twist", Strength=1.5)
    simple.Show(lattice, view)
    ffd.set_functions()
    return lattice


class TestServer(unittest.TestCase):
    def test_two_processes(self):
        view = ffd.make_view()
        show(view)
        local = ffd.picture(view, "local")
        port = 21000 + os.getpid() % 9000
        server = subprocess.Popen(
            ["mpiexec", "-np", "2", "pvserver", "--server-port=%d" % port],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            env=os.environ)
        try:
            for line in server.stdout:
                if "Accepting" in line:
                    break
            simple.Disconnect()
            simple.Connect("localhost", port)
            ffd.load(remote=True)
            view = ffd.make_view()
            lattice = show(view)
            remote = ffd.picture(view, "remote")
            self.assertEqual(
                servermanager.ActiveConnection.GetNumberOfDataPartitions(), 2)
            self.assertLess(np.abs(remote - local).mean(), 0.5)
            self.assertLessEqual(ffd.differ(remote, local)[0], 8)
            # An edit comes through.
            lattice.Strength = 0.2
            self.assertGreater(
                np.abs(ffd.picture(view, "edited") - remote).mean(), 1.0)
        finally:
            server.terminate()
            server.wait()
            server.stdout.close()


if __name__ == "__main__":
    unittest.main()
