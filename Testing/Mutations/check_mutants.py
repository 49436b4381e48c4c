#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Break the code in the places that mutants.py lists, one at a time: does a test notice?

  check_mutants.py --places                   do all texts still occur exactly once? (a test)
  check_mutants.py --work FOLDER              build and test each mutant in a copy of the tree
  check_mutants.py --work FOLDER --only 3,7   some of them (--list prints the numbers)

FOLDER gets a copy of the tree, its build, and results.txt, to which runs append. A run first checks
that the tests pass without any mutant; it needs the X display of Module/CMake/with-xvfb.sh. The exit
status is 1 where a mutant survives that mutants.py does not give a reason for, or where a test
notices one that it says survives.
"""

import argparse
import collections
import pathlib
import re
import shutil
import subprocess
import sys
import time

from mutants import MUTANTS

ROOT = pathlib.Path(__file__).resolve().parents[2]
SOURCES = ("Module", "Filters", "Rendering")
KINDS = ("sign", "bound", "index", "term")
BUILD_LIMIT = 3600  # seconds
TEST_LIMIT = 900


def pattern_of(text):
    """The text with any white space between its words."""
    return re.compile(r"\s+".join(re.escape(word) for word in text.split()))


def read_sources(root):
    """Text of every source by its path."""
    return {
        path: path.read_text(encoding="utf-8")
        for folder in SOURCES
        for path in sorted((root / folder).rglob("*"))
        if path.suffix in (".h", ".cxx")
    }


def find_place(mutant, sources):
    """Path of the only source that holds the mutant's text, once; or what is wrong, as a string."""
    pattern = pattern_of(mutant.text)
    counts = {path: len(pattern.findall(text)) for path, text in sources.items()}
    found = [path for path, count in counts.items() if count]
    total = sum(counts.values())
    if total == 1:
        return found[0]
    names = ", ".join(path.name for path in found)
    return f"its text occurs {total} times" + (f" ({names})" if found else "")


def check_places():
    """Problems of the list, as lines."""
    sources = read_sources(ROOT)
    problems = []
    times = collections.Counter(m.name for m in MUTANTS)
    problems += [f"{name}: {n} mutants have this name." for name, n in times.items() if n > 1]
    known = set()
    for file in ROOT.glob("Testing/*/CMakeLists.txt"):
        kind = file.parent.name
        known.update(f"{kind}.{n}" for n in re.findall(r"\b(Test\w+)", file.read_text("utf-8")))
    for mutant in MUTANTS:
        place = find_place(mutant, sources)
        if isinstance(place, str):
            problems.append(
                f"{mutant.name}: {place}. Where the code has changed, change the mutant with it.")
        if mutant.text.split() == mutant.by.split() or mutant.kind not in KINDS:
            problems.append(f"{mutant.name}: it changes nothing, or its kind is unknown.")
        for test in mutant.tests:
            if ".".join(test.split(".")[:2]) not in known:
                problems.append(f"{mutant.name}: there is no test {test}.")
        if not mutant.tests:
            problems.append(f"{mutant.name}: it names no test.")
    return problems


def copy_tree(target):
    """The files that git knows or does not ignore; what has not changed keeps its time."""
    listed = subprocess.run(
        ["git", "ls-files", "-coz", "--exclude-standard"], cwd=ROOT, check=True,
        stdout=subprocess.PIPE).stdout.decode()
    names = {name for name in listed.split("\0") if name and (ROOT / name).is_file()}
    for name in names:
        to = target / name
        data = (ROOT / name).read_bytes()
        if not to.is_file() or to.read_bytes() != data:
            to.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, to)
    for folder in SOURCES + ("Testing",):
        for path in (target / folder).rglob("*"):
            if path.is_file() and str(path.relative_to(target)) not in names:
                path.unlink()


def target_of(test):
    """What has to be built for a test of ctest."""
    kind, name = test.split(".")[:2]
    return {"Kernels": name, "Cxx": "FFDCxxTests", "Python": "ffd_python_package"}[kind]


class Run:
    """A copy of the tree with its build, and the results."""

    def __init__(self, work, jobs):
        self.tree = work / "tree"
        self.build_folder = self.tree / "build"
        self.log = work / "last.log"
        self.results = work / "results.txt"
        self.jobs = jobs

    def execute(self, command, limit):
        """Whether a command succeeds in time; what it prints goes to the log."""
        with self.log.open("ab") as log:
            log.write(("\n$ " + " ".join(command) + "\n").encode())
            log.flush()
            try:
                return subprocess.run(
                    command, cwd=self.tree, stdin=subprocess.DEVNULL, stdout=log,
                    stderr=subprocess.STDOUT, timeout=limit, check=False).returncode == 0
            except subprocess.TimeoutExpired:
                log.write(b"\ntimed out\n")
                return False

    def build(self, targets):
        return self.execute(
            ["cmake", "--build", str(self.build_folder), "-j", str(self.jobs), "--target"]
            + sorted(set(targets)), BUILD_LIMIT)

    def passes(self, test):
        return self.execute(
            ["ctest", "--test-dir", str(self.build_folder), "-R", f"^{re.escape(test)}$",
             "--no-tests=error", "--output-on-failure", "--timeout", str(TEST_LIMIT)],
            TEST_LIMIT + 60)

    def report(self, line):
        print(line, flush=True)
        with self.results.open("a", encoding="utf-8") as file:
            file.write(line + "\n")

    def prepare(self, mutants):
        """Builds the tree as it is; False unless all tests pass."""
        self.tree.mkdir(parents=True, exist_ok=True)
        copy_tree(self.tree)
        self.log.write_bytes(b"")
        tests = sorted({test for mutant in mutants for test in mutant.tests})
        if not self.execute(["cmake", "--preset", "release"], BUILD_LIMIT):
            self.report(f"The copy cannot be configured, see {self.log}.")
            return False
        if not self.build([target_of(test) for test in tests]):
            self.report(f"The copy cannot be built, see {self.log}.")
            return False
        wrong = [test for test in tests if not self.passes(test)]
        if wrong:
            self.report("These fail without any mutant: " + ", ".join(wrong))
        return not wrong

    def try_mutant(self, mutant):
        """Name of the test that notices a mutant, "" if none does, None if it cannot be tried."""
        path = find_place(mutant, read_sources(self.tree))
        if isinstance(path, str):
            self.report(f"{mutant.name}: {path}.")
            return None
        original = path.read_text(encoding="utf-8")
        self.log.write_bytes(b"")
        try:
            path.write_text(
                pattern_of(mutant.text).sub(lambda _: mutant.by, original), encoding="utf-8")
            for test in mutant.tests:
                if not self.build([target_of(test)]):
                    self.report(f"{mutant.name}: the mutant cannot be built, see {self.log}.")
                    return None
                if not self.passes(test):
                    return test
            return ""
        finally:
            path.write_text(original, encoding="utf-8")


def try_mutants(run, numbers):
    """Exit status."""
    chosen = [(n, MUTANTS[n]) for n in numbers]
    if not run.prepare([mutant for _, mutant in chosen]):
        return 1
    noticed = explained = wrong = 0
    for number, mutant in chosen:
        start = time.monotonic()
        test = run.try_mutant(mutant)
        took = f"{time.monotonic() - start:.0f} s"
        if test is None:
            wrong += 1
        elif test:
            noticed += 1
            stale = " (mutants.py says that it survives)" if mutant.survives else ""
            wrong += 1 if stale else 0
            run.report(f"{number:2d} noticed   {mutant.name}: {test}, {took}{stale}")
        else:
            explained += 1 if mutant.survives else 0
            wrong += 0 if mutant.survives else 1
            reason = f": {mutant.survives}" if mutant.survives else ""
            run.report(f"{number:2d} SURVIVES  {mutant.name}, {took}{reason}")
    run.report(f"{noticed} of {len(chosen)} mutants noticed, {explained} survive for a reason, "
               f"{wrong} to be looked at.")
    return 1 if wrong else 0


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    action = parser.add_mutually_exclusive_group(required=True)
    action.add_argument("--places", action="store_true", help="check the list alone")
    action.add_argument("--list", action="store_true", help="print the mutants with their numbers")
    action.add_argument("--work", type=pathlib.Path, help="folder for the copy and its build")
    parser.add_argument("--only", help="numbers of mutants, separated by commas")
    parser.add_argument("--jobs", type=int, default=2, help="of the build")
    arguments = parser.parse_args()
    if arguments.list:
        for number, mutant in enumerate(MUTANTS):
            print(f"{number:2d} {mutant.kind:5s} {mutant.name}")
        return 0
    problems = check_places()
    for line in problems:
        print(line)
    if problems or arguments.places:
        print(f"{len(MUTANTS)} mutants checked")
        return 1 if problems else 0
    numbers = range(len(MUTANTS))
    if arguments.only:
        numbers = [int(number) for number in arguments.only.split(",")]
    work = arguments.work.resolve()
    if ROOT in work.parents:
        parser.error("FOLDER must not lie in the tree.")
    return try_mutants(Run(work, arguments.jobs), numbers)


if __name__ == "__main__":
    sys.exit(main())
