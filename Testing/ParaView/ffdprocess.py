# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""How the ParaView tests start servers, and end what they have started."""

import socket
import subprocess


def find_port():
    """A port that nothing listens at, for a server: tests run side by side."""
    with socket.socket() as free:
        free.bind(("", 0))
        return free.getsockname()[1]


def stop(process):
    """Ends a server, or mpiexec. ParaView's handler of SIGTERM allocates memory: where the signal
    comes while memory is allocated, the process waits for itself."""
    process.terminate()
    try:
        process.wait(30)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
