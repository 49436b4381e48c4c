#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Names, comments and messages are spelled as VTK's: American English.

usage: check_spelling.py [SOURCE]     check the tree SOURCE (default: the one this file lies in)
       check_spelling.py --fix        spell British words the American way, in contents and names of files;
                                      for branches that began before a rename
       check_spelling.py --self-test  check that each British word is found
"""

import os
import pathlib
import re
import subprocess
import sys

# Beginnings of words (or what follows another word in a name), each with its American spelling.
WORDS = {
    "colo" + "ur": "color",
    "cent" + "re": "center",
    "neighb" + "our": "neighbor",
    "gr" + "ey": "gray",
    "behavi" + "our": "behavior",
    "fav" + "our": "favor",
    "lic" + "ence": "license",
    "arte" + "fact": "artifact",
    "label" + "led": "labeled",
    "millim" + "etre": "millimeter",
    "centim" + "etre": "centimeter",
}
WORDS.update({stem + "is" + end: stem + "iz" + end for stem in (
    "normal", "optim", "initial", "minim", "maxim", "organ", "recogn", "raster", "serial", "synchron",
    "visual", "general", "summar", "quant")
    for end in ("e", "ing", "ation")})
WORDS["cent" + "red"] = "centered"
WORDS["m" + "etre"] = "meter"
BRITISH = re.compile("|".join(sorted(WORDS, key=len, reverse=True)), re.I)
SUFFIXES = (".h", ".cxx", ".py", ".cmake", ".txt", ".md", ".sh", ".xml", ".json", ".yml", ".in", ".supp", ".dict")


def american(match):
    """The word in the case of the match."""
    word = WORDS[match.group().lower()]
    if match.group().isupper():
        return word.upper()
    return word[0].upper() + word[1:] if match.group()[0].isupper() else word


def tree(root):
    """Text files of the tree that are ours."""
    try:
        listed = subprocess.run(
            ["git", "-C", str(root), "ls-files"], capture_output=True, text=True, check=True)
        names = listed.stdout.split("\n")
    except (OSError, subprocess.CalledProcessError):
        # No checkout of git, or no git.
        names = [str(path.relative_to(root)) for path in root.rglob("*") if path.is_file()]
    for name in names:
        if (name.endswith(SUFFIXES) and not name.startswith(("Testing/Data/", "build", "output"))
                and (root / name).exists()):
            yield name


def problems(root):
    for name in tree(root):
        if BRITISH.search(name):
            yield "%s: the name of the file" % name
        text = (root / name).read_text(encoding="utf-8", errors="replace")
        for number, line in enumerate(text.split("\n"), 1):
            for match in BRITISH.finditer(line):
                yield "%s:%d: '%s' is spelled '%s'" % (name, number, match.group(), american(match))


def fix(root):
    for name in list(tree(root)):
        path = root / name
        text = path.read_text(encoding="utf-8")
        fixed = BRITISH.sub(american, text)
        if fixed != text:
            path.write_text(fixed, encoding="utf-8")
        if BRITISH.search(name):
            subprocess.run(["git", "-C", str(root), "mv", name, BRITISH.sub(american, name)], check=True)


def main():
    root = pathlib.Path(__file__).resolve().parents[1]
    if sys.argv[1:] == ["--fix"]:
        fix(root)
    elif sys.argv[1:] == ["--self-test"]:
        for word, right in WORDS.items():
            for written in (word, word.capitalize(), "Get" + word.capitalize() + "s", word.upper()):
                assert BRITISH.search(written), written
            assert not BRITISH.search(right), right
        assert BRITISH.sub(american, "Find" + "Cent" + "res") == "FindCenters"
    else:
        found = list(problems(pathlib.Path(sys.argv[1]).resolve() if sys.argv[1:] else root))
        for problem in found:
            print(problem)
        sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
