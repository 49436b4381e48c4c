#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the plugin's help pages, from the documentation in its XML files, for qhelpgenerator.

usage: help_pages.py FOLDER XML...

FOLDER gets a page for each source and filter, and for the representation, one that leads to them, and
FFDVolume.qhp, which lists them. ParaView makes such pages with a program of Qt 5, and with Qt 6 none (its issue 19742).
"""

import html
import os
import re
import sys
import xml.etree.ElementTree as ElementTree

# The panel's question mark opens the page whose name is this.
PAGE = "%s.%s.html"
INDEX = "index.html"

PROJECT = """<?xml version="1.0" encoding="UTF-8"?>
<QtHelpProject version="1.0">
  <namespace>FFDVolume.org</namespace>
  <virtualFolder>FFDVolume</virtualFolder>
  <filterSection>
    <toc><section title="FFDVolume" ref="%s">%s</section></toc>
    <keywords/>
    <files>%s</files>
  </filterSection>
</QtHelpProject>
"""

HEAD = "<tr bgcolor=\"#9acd32\"><th>Property</th><th width=\"70%\">Description</th><th>Default</th></tr>"


def label_of(element):
    """As ParaView labels it: by its name, cut where words begin."""
    return element.get("label") or re.sub(
        r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", " ", element.get("name"))


def text_of(documentation):
    return html.escape(" ".join((documentation.text or "").split()))


def row_of(prop, documentation):
    """A property: what it is for, its choices or its range, and its default."""
    description = text_of(documentation)
    default = (prop.get("default_values") or "").replace("none", "")
    choices = {entry.get("value"): entry.get("text") for entry in prop.findall("EnumerationDomain/Entry")}
    bounds = prop.find("DoubleRangeDomain")
    bounds = prop.find("IntRangeDomain") if bounds is None else bounds
    if choices:
        default = choices.get(default, default)
        description += "<br/><i>%s</i>" % html.escape(", ".join(choices.values()))
    elif prop.find("BooleanDomain") is not None:
        default = {"0": "off", "1": "on"}.get(default, default)
    elif bounds is not None and bounds.get("min") and bounds.get("max"):
        description += "<br/><i>%s to %s</i>" % (bounds.get("min").split()[0], bounds.get("max").split()[0])
    return "<tr><td><b>%s</b></td><td>%s</td><td>%s</td></tr>" % (
        html.escape(label_of(prop)), description, html.escape(default))


def page_of(proxy):
    """The page of a proxy; ParaView's browser knows HTML 4."""
    documentation = proxy.find("Documentation")
    title = html.escape(label_of(proxy))
    rows = [row_of(prop, prop.find("Documentation")) for prop in proxy
            if prop.find("Documentation") is not None and prop.get("panel_visibility") != "never"]
    return ("<html><head><title>%s</title></head><body><h2>%s</h2><p><i>%s</i></p><p>%s</p>"
            "<table width=\"97%%\" border=\"1\" cellspacing=\"0\" cellpadding=\"4\">%s%s</table>"
            "</body></html>\n" % (title, title, html.escape(documentation.get("long_help") or ""),
                                  text_of(documentation), HEAD, "".join(rows)))


def main(folder, files):
    """Write the pages of the proxies in these files."""
    pages = {}
    for file in files:
        for group in ElementTree.parse(file).getroot().iter("ProxyGroup"):
            for proxy in group:
                if proxy.tag in ("SourceProxy", "FFDVolumeRepresentationProxy"):
                    name = PAGE % (group.get("name"), proxy.get("name"))
                    pages[name] = label_of(proxy)
                    with open(os.path.join(folder, name), "w", encoding="utf-8") as page:
                        page.write(page_of(proxy))
    ordered = sorted(pages, key=pages.get)
    # ParaView's window of help begins with this page where ParaView has none of its own, as on Debian 13.
    with open(os.path.join(folder, INDEX), "w", encoding="utf-8") as page:
        page.write("<html><head><title>FFDVolume</title></head><body><h2>FFDVolume</h2><ul>%s</ul></body></html>\n"
                   % "".join("<li><a href=\"%s\">%s</a></li>" % (name, html.escape(pages[name]))
                             for name in ordered))
    sections = ["<section title=\"%s\" ref=\"%s\"/>" % (html.escape(pages[name]), name)
                for name in ordered]
    with open(os.path.join(folder, "FFDVolume.qhp"), "w", encoding="utf-8") as project:
        project.write(PROJECT % (INDEX, "".join(sections),
                                 "".join("<file>%s</file>" % name for name in [INDEX, *pages])))


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
