# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""How the ParaView tests end what they have started."""

import subprocess


def stop(process):
    """Ends a server, or mpiexec. ParaView's handler of SIGTERM allocates memory: where the signal
    comes while memory is allocated, the process waits for itself."""
    process.terminate()
    try:
        process.wait(30)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
