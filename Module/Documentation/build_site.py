#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Build the documentation as a site: <output>/index.html. Needs Doxygen 1.9.4 or later
(Module/CMake/setup-debian.sh --documentation installs it), and no build of vtkFFD.

Pages are the Markdown files of PAGES and the public headers; tables of options are made from the headers
where a page says <!-- options CLASS -->. Fails, and says why, where a public class or member is not
documented, where a page or a header refers to something that does not exist, where a class is missing
from the guide, and where README.md is longer than 150 lines.
"""

import argparse
import html.parser
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import urllib.parse

import header_options

# In the order of the navigation.
PAGES = [
    "README.md",
    "Module/Documentation/tutorial.md",
    "Module/Documentation/guide.md",
    "Module/Documentation/paraview.md",
    "Module/Documentation/wheel.md",
    "Module/Documentation/pyvista.md",
    "Module/Documentation/browser.md",
    "Module/Documentation/features.md",
    "Module/Documentation/method.md",
    "Module/Documentation/experiments.md",
    "Module/Documentation/gallery.md",
    "Testing/Benchmarks/NOTES.md",
    "CONTRIBUTING.md",
    "SECURITY.md",
    "CHANGELOG.md",
]
LONGEST_README = 150
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^()\s]+)\)")
CODE = re.compile(r"(^```.*?^```|`[^`\n]*`)", re.S | re.M)
HEADING = re.compile(r"^(#+) +(.*?) *$", re.M)
NOT_PUBLIC = re.compile(r"\n(?:protected|private):.*?(?=\n\};)", re.S)
CONVENTIONAL = {  # members whose documentation is that of VTK, where a class does not say more
    "New": "Makes an object with the default options.",
    "PrintSelf": "Writes the state, with every option.",
    "GetMTime": "Includes the modification times of everything that the result depends on.",
    "MakeTransform": "Makes another transform of this class.",
    "CircuitCheck": "Whether this transform depends on another one.",
    "ProcessRequest": "Answers the requests of the pipeline.",
    "SetEnabled": "Turns the widget on or off.",
}
MEMBER = re.compile(r"^  [\w*&<>: ]*?\b(%s)\(" % "|".join(CONVENTIONAL))


def public_headers(root):
    """The headers of the classes that the folders' CMakeLists.txt list as public, by class."""
    headers = {}
    for folder in ("Module", "Filters", "Rendering"):
        for listing in sorted((root / folder).rglob("CMakeLists.txt")):
            text = re.sub(r"#.*", "", listing.read_text(encoding="utf-8"))
            for names in re.findall(r"^set\(classes\s([^)]*)\)", text, re.M):
                for name in names.split():
                    headers[name] = listing.parent / (name + ".h")
    return headers


def document_conventional(text):
    """A header in which members that every class of VTK has are documented."""
    lines = []
    for line in text.split("\n"):
        match = MEMBER.match(line)
        if match and not (lines and re.search(r"\*/$|^ *///", lines[-1])):
            lines.append("  /// " + CONVENTIONAL[match.group(1)])
        lines.append(line)
    return "\n".join(lines)


def slug(heading):
    """The anchor of a heading, as GitHub makes it."""
    text = re.sub(r"[^\w\- ]", "", heading.strip().lower())
    return text.replace(" ", "-")


def outside_code(function, text):
    """Apply a function to what of a text is not code."""
    parts = CODE.split(text)
    return "".join(part if index % 2 else function(part) for index, part in enumerate(parts))


def anchors(text):
    return [slug(heading) for _, heading in HEADING.findall(outside_code(str, CODE.sub(
        lambda match: "" if match.group().startswith("```") else match.group(), text)))]


def markdown_files(root):
    """The Markdown files of the tree; build folders are left out."""
    for folder, folders, names in os.walk(root):
        folders[:] = [name for name in folders if not name.startswith(("build", ".git"))
                      and name not in ("output", "Fuzz")
                      and not os.path.exists(os.path.join(folder, name, "CMakeCache.txt"))]
        yield from (pathlib.Path(folder, name) for name in sorted(names) if name.endswith(".md"))


def check_links(root):
    """What is wrong with the links of all Markdown files."""
    problems = []
    for path in markdown_files(root):
        text = path.read_text(encoding="utf-8")
        for match in LINK.finditer(CODE.sub("", text)):
            target = match.group(3)
            where = "%s: the link to %s" % (path.relative_to(root), target)
            parts = urllib.parse.urlsplit(target)
            if parts.scheme or parts.netloc:
                if not (parts.scheme in ("http", "https") and parts.netloc
                        or parts.scheme == "mailto" and "@" in parts.path):
                    problems.append(where + " is no address")
                continue
            file = (path.parent / parts.path) if parts.path else path
            if not file.exists():
                problems.append(where + " leads to no file")
            elif parts.fragment and (file.suffix != ".md" or parts.fragment not in anchors(
                    file.read_text(encoding="utf-8"))):
                problems.append(where + " leads to no heading")
    return problems


def page_name(path):
    return "page_" + re.sub(r"\W", "_", str(path.with_suffix(""))).lower()


def write_page(root, path, folder, headers, files):
    """A page with anchors and links as Doxygen has them, and tables of options; returns the classes
    of these."""
    text = (root / path).read_text(encoding="utf-8")
    name = "mainpage" if str(path) == "README.md" else page_name(path)
    shown = []

    def options(match):
        shown.append(match.group(1))
        name = match.group(1)
        table = header_options.table(headers[name].read_text(encoding="utf-8"))
        return re.sub(r"^\| [\w, ]+ \|", lambda cell: re.sub(
            r"[A-Z]\w+", lambda word: "[%s](@ref %s::Set%s)" % (word.group(), name, word.group()),
            cell.group()), table, flags=re.M)

    def link(match):
        image, words, target = match.groups()
        parts = urllib.parse.urlsplit(target)
        if parts.scheme or parts.netloc:
            return match.group()
        other = pathlib.Path(os.path.normpath(path.parent / parts.path)) if parts.path else path
        if image:
            return "![%s](%s)" % (words, other.name)
        if str(other) in PAGES:
            place = "index" if str(other) == "README.md" else page_name(other)
            return "[%s](@ref %s)" % (words, place + ("_" + parts.fragment.replace("-", "_")
                                                     if parts.fragment else ""))
        files.add(other)
        return '<a href="files/%s">%s</a>' % (other, words)

    def heading(match):
        anchor = name + "_" + slug(match.group(2)).replace("-", "_")
        if len(match.group(1)) == 1:
            anchor = name
        return "%s %s {#%s}" % (match.group(1), match.group(2), anchor)

    text = re.sub(r"<!-- options (\w+) -->", options, text)
    # A class in code leads to its page, unless it is in a heading.
    text = re.sub(r"^(?!#).*$", lambda line: re.sub(
        r"`(%s)`" % "|".join(headers), r"[\1](@ref \1)", line.group()), text, flags=re.M)
    text = outside_code(lambda part: HEADING.sub(heading, LINK.sub(link, part)), text)
    (folder / (name + ".md")).write_text(text, encoding="utf-8")
    return shown


class Links(html.parser.HTMLParser):
    """Where a page of the site leads to, and its anchors."""

    def __init__(self, path):
        super().__init__()
        self.targets = set()
        self.anchors = set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        for key, value in attrs:
            if key in ("href", "src") and value:
                self.targets.add(value)
            elif key in ("id", "name") and value:
                self.anchors.add(value)


def check_site(folder):
    """What is wrong with the links of the pages of a site."""
    pages = {path: Links(path) for path in sorted(folder.glob("*.html"))}
    problems = []
    for path, page in pages.items():
        for target in page.targets:
            parts = urllib.parse.urlsplit(target)
            if parts.scheme or parts.netloc:
                continue
            other = folder / urllib.parse.unquote(parts.path) if parts.path else path
            if not other.exists():
                problems.append("%s: the link to %s leads to no file" % (path.name, target))
            elif parts.fragment and other in pages and parts.fragment not in pages[other].anchors:
                problems.append("%s: the link to %s leads to no anchor" % (path.name, target))
    return problems


def build(root, output):
    """Build the site; returns what is wrong."""
    problems = check_links(root)
    lines = len((root / "README.md").read_text(encoding="utf-8").splitlines())
    if lines > LONGEST_README:
        problems.append("README.md has %d lines, more than %d: what a newcomer does not need first "
                        "belongs into Module/Documentation" % (lines, LONGEST_README))
    headers = public_headers(root)
    shutil.rmtree(output, ignore_errors=True)
    output.mkdir(parents=True)
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        sources = scratch / "headers"
        pages = scratch / "pages"
        sources.mkdir()
        pages.mkdir()
        for path in headers.values():
            text = document_conventional(NOT_PUBLIC.sub("", path.read_text(encoding="utf-8")))
            (sources / path.name).write_text(text, encoding="utf-8")
        shown = set()
        files = set()
        for page in PAGES:
            shown.update(write_page(root, pathlib.Path(page), pages, headers, files))
        guide = (root / "Module/Documentation/guide.md").read_text(encoding="utf-8")
        for name in sorted(headers):
            has_options = header_options.table(headers[name].read_text(encoding="utf-8"))
            if name not in guide or (has_options and name not in shown):
                problems.append("guide.md does not show the options of %s" % name)
        settings = (root / "Module/Documentation/Doxyfile").read_text(encoding="utf-8")
        inputs = [pages / ("mainpage.md" if page == "README.md" else page_name(pathlib.Path(page)) + ".md")
                  for page in PAGES] + [sources]
        settings += "\nOUTPUT_DIRECTORY = \"%s\"\nHTML_OUTPUT = .\n" % output
        settings += "INPUT = %s\n" % " ".join('"%s"' % path for path in inputs)
        settings += "USE_MDFILE_AS_MAINPAGE = \"%s\"\n" % inputs[0]
        settings += "IMAGE_PATH = \"%s\"\n" % (root / "Examples/Images")
        settings += "HTML_EXTRA_STYLESHEET = \"%s\"\n" % (root / "Module/Documentation/site.css")
        settings += "STRIP_FROM_PATH = \"%s\" \"%s\"\n" % (sources, pages)
        result = subprocess.run(["doxygen", "-"], input=settings, text=True, capture_output=True)
        for line in (result.stdout + result.stderr).splitlines():
            if line.strip():
                problems.append(line.replace(str(sources) + "/", "").replace(str(pages) + "/", ""))
        if result.returncode != 0:
            problems.append("doxygen ended with status %d" % result.returncode)
    for path in files:
        if (root / path).is_file():
            (output / "files" / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(root / path, output / "files" / path)
    return problems + check_site(output)


def self_test(root):
    """Plants one of each problem in a copy of the tree; returns those that are not found."""
    planted = {
        "Member GetNothing() (function) of class vtkFFDLattice is not documented":
            ("Module/vtkFFDLattice.h", "public:", "public:\n  int GetNothing();\n"),
        "unable to resolve reference to 'vtkFFDNothing'":
            ("Module/vtkFFDLattice.h", " * @class   vtkFFDLattice", " * @class   vtkFFDLattice\n * @ref vtkFFDNothing"),
        "tutorial.md: the link to nothing.md leads to no file":
            ("Module/Documentation/tutorial.md", "# Tutorial", "# Tutorial\n\n[nothing](nothing.md)"),
        "method.md: the link to guide.md#nothing leads to no heading":
            ("Module/Documentation/method.md", "# The method", "# The method\n\n[nothing](guide.md#nothing)"),
        "gallery.md: the link to https:nothing is no address":
            ("Module/Documentation/gallery.md", "# Gallery", "# Gallery\n\n[nothing](https:nothing)"),
        "guide.md does not show the options of vtkFFDJacobian":
            ("Module/Documentation/guide.md", "<!-- options vtkFFDJacobian -->", ""),
        "README.md has":
            ("README.md", "# vtkFFD", "# vtkFFD\n" + LONGEST_README * "\n"),
    }
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        copy = scratch / "source"
        needed = {page for page in PAGES} | {"Module/Documentation/Doxyfile", "Module/Documentation/site.css",
                                            "CITATION.cff", "LICENSE"}
        needed.update(str(path.relative_to(root)) for path in public_headers(root).values())
        for folder in ("Module", "Filters", "Rendering"):
            needed.update(str(path.relative_to(root)) for path in (root / folder).rglob("CMakeLists.txt"))
        for folder in ("Examples/Images", "Examples/Python"):
            needed.update(str(path.relative_to(root)) for path in (root / folder).iterdir())
        for name in needed:
            if (root / name).is_file():
                (copy / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(root / name, copy / name)
        for file, old, new in planted.values():
            text = (copy / file).read_text(encoding="utf-8")
            assert old in text, (file, old)
            (copy / file).write_text(text.replace(old, new, 1), encoding="utf-8")
        found = "\n".join(build(copy, scratch / "site"))
    return [problem for problem in planted if problem not in found]


def main():
    root = pathlib.Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--source", type=pathlib.Path, default=root, help="default: this repository")
    parser.add_argument("--output", type=pathlib.Path, default=pathlib.Path("output/documentation"),
                        help="a folder that is replaced; default: output/documentation")
    parser.add_argument("--self-test", action="store_true",
                        help="check that each kind of problem is found, and write nothing")
    arguments = parser.parse_args()
    if shutil.which("doxygen") is None:
        sys.exit("skipped: doxygen is not installed; Module/CMake/setup-debian.sh --documentation installs it")
    if arguments.self_test:
        missed = self_test(arguments.source.resolve())
        sys.exit("not found: %s" % "; ".join(missed) if missed else 0)
    problems = build(arguments.source.resolve(), arguments.output.resolve())
    for problem in problems:
        print(problem, file=sys.stderr)
    if problems:
        sys.exit("%d problems in the documentation" % len(problems))
    print("written to %s" % (arguments.output / "index.html"))


if __name__ == "__main__":
    main()
