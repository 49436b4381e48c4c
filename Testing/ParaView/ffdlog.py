# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""What scenes that run in ParaView's graphical client tell the test that started it."""

import json
import os


def open_log(variable):
    """A function that writes a value, as a line of JSON, to the file that an environment variable names."""
    log = open(os.environ[variable], "w", encoding="ascii")  # open until the end

    def write(value):
        log.write(json.dumps(value) + "\n")
        log.flush()
    return write
