# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""What several examples do with their options."""

import argparse
import math
import os
import sys

LARGEST_SIDE = 16384


def pixels(text):
    """The type of options that are numbers of pixels."""
    if not text.isdecimal() or not 1 <= int(text) <= LARGEST_SIDE:
        raise argparse.ArgumentTypeError(
            "%r is no number of pixels from 1 to %d" % (text, LARGEST_SIDE))
    return int(text)


def number(least, most=math.inf):
    """The type of options that are numbers from `least` to `most`."""
    def read(text):
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not (least <= value <= most and math.isfinite(value)):
            raise argparse.ArgumentTypeError("%r is no number of %g or more" % (text, least)
                                             if math.isinf(most) else
                                             "%r is no number from %g to %g" % (text, least, most))
        return value
    return read


def make_folder(path):
    """Make a folder for pictures, or end the program with a line that says why there is none."""
    try:
        os.makedirs(path, exist_ok=True)
    except OSError as error:
        sys.exit("cannot make the folder %s: %s" % (path, error.strerror))
