#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every test that the feature table of Module/Documentation/features.md names must be a registered one.

usage: check_feature_table.py [ROOT]
"""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parents[1]
page = "Module/Documentation/features.md"
readme = (root / page).read_text(encoding="utf-8")
section = readme.split("## What it can do, next to VTK's mappers", 1)[1].split("\n## ", 1)[0]
rows = [line.strip("|").split("|") for line in section.splitlines() if line.startswith("| ")][1:]
registered = (root / "Testing/Cxx/CMakeLists.txt").read_text(encoding="utf-8")
tests = set(re.findall(r"ffd_add_cxx_test\((\w+)", registered))
python = (root / "Testing/Python/CMakeLists.txt").read_text(encoding="utf-8")
tests.update(re.findall(r"ffd_add_python_test\((\w+)\.py", python))
scenes = set(re.findall(r"ffd_add_scene_tests\(TestVTKScenes([^)]*)\)", registered)[0].split())

wrong = []
for row in rows:
    names = re.findall(r"\b(Scene\.\w+|Test\w+)", row[-1])
    if not names:
        wrong.append(f"'{row[0].strip()}' names no test")
    for name in names:
        known = name[6:] in scenes if name.startswith("Scene.") else name in tests
        if not known:
            wrong.append(f"'{row[0].strip()}' names {name}, which is not registered")
for line in wrong:
    print(f"{page}: {line} in Testing/Cxx or Testing/Python.")
if len(rows) < 20:
    wrong.append("table")
    print(f"{page}: the feature table has {len(rows)} rows; has it been moved?")
print(f"{len(rows)} rows checked")
sys.exit(1 if wrong else 0)
