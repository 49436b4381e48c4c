# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""What tests of random scenes share."""

import numpy


class RandomScene:
    """A scene that `number` decides; `words` tell what was drawn."""

    def __init__(self, number):
        self.number = number
        self.random = numpy.random.default_rng(number)
        self.words = []

    def chance(self, part, word=None):
        taken = self.random.random() < part
        if taken and word:
            self.words.append(word)
        return taken

    def choose(self, options, weights=None):
        taken = options[self.random.choice(len(options), p=weights)]
        self.words.append(str(taken))
        return taken
