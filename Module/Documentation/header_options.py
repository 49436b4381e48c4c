# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""The options of a class as its header documents them: names, values, defaults, meaning."""

import re

# A documented group of members: the comment, and the code up to the next comment or group.
GROUP = re.compile(r"(?:/\*\*(?P<block>.*?)\*/|///(?![@<]) ?(?P<line>[^\n]*)\n)"
                   r"(?P<code>.*?)(?=/\*\*|///(?![<@])|///@[{}]|\Z)", re.S)
ENUM = re.compile(r"enum (\w+)\s*\{(.*?)\}", re.S)
DEFAULT = re.compile(r"\b[Dd]efaults?:? +([^;)]*?)(?=\.(?:\s|$)|[;)]|$)")
SET_MACRO = re.compile(r"vtkSet(\w*?)Macro\((\w+)(?:,\s*([^()]*(?:\([^()]*\))?[^()]*))?\)")
SETTER = re.compile(r"^ *(?:virtual )?void Set(\w+)\(([^)]*)\)( override)?", re.M)


def public_part(header_text):
    """The public members: from the class's "public:" to "protected:" or "private:"."""
    start = header_text.index("public:")
    ends = [at for at in (header_text.find("\nprotected:"), header_text.find("\nprivate:"))
            if at > start]
    return header_text[start:min(ends)] if ends else header_text[start:]


def plain(comment):
    """The text of a comment in one line."""
    text = re.sub(r"\s*\n\s*\*? ?", " ", comment)
    return re.sub(r"\s+", " ", text).strip()


def sentences(text):
    return re.split(r"(?<=\.)\s+(?=[A-Z(])", text)


def enumerators(text):
    return [re.match(r"\w+", part.strip()).group()
            for part in re.sub(r"///<[^\n]*|//[^\n]*", "", text).split(",")
            if re.match(r"\w+", part.strip())]


def values_of(name, macro, arguments, code, enums):
    """What an option takes: enumerators, on and off, a range, or a type."""
    words = [word.strip() for word in arguments.split(",")] if arguments else []
    by_name = re.findall(r"void Set%sTo\w+\(\)\s*\{\s*this->Set%s\((?:\w+::)?(\w+)\)" % (name, name), code)
    if by_name:
        return ", ".join("`%s`" % word for word in by_name)
    if "vtkBooleanMacro(%s," % name in code:
        return "on, off"
    if macro.startswith("Clamp") and len(words) == 3:
        for names in enums.values():
            if words[1] in names and words[2] in names:
                chosen = names[names.index(words[1]):names.index(words[2]) + 1]
                return ", ".join("`%s`" % word for word in chosen)
        return "%s or more" % words[1] if words[2].endswith("_MAX") else "%s to %s" % (words[1], words[2])
    for enum, names in enums.items():
        if enum.rstrip("s") == name or enum == name + "Type":
            return ", ".join("`%s`" % word for word in names)
    if macro in ("String", "FilePath"):
        return "text"
    kind = words[0] if words else ""
    size = re.match(r"Vector(\d)", macro)
    numbers = {"int": "whole number", "double": "number", "float": "number", "vtkTypeBool": "on, off",
               "bool": "on, off", "vtkIdType": "whole number", "vtkTypeInt64": "whole number"}
    if size:
        return "%s %ss" % (size.group(1), numbers.get(kind, kind))
    return numbers.get(kind, kind)


def type_in_words(parameters):
    """Of the parameters of a setter that is written out."""
    parts = [re.sub(r"\s*=.*", "", part).strip() for part in parameters.split(",")]
    count = len(parts)
    array = re.search(r"\[(\d+)\]", parts[0])
    if array:
        count = int(array.group(1))
    kind = re.sub(r"\[.*|const\s+", "", parts[0]).strip()
    pointer = re.match(r"(vtk\w+)\s*\*", kind)
    if pointer:
        return pointer.group(1)
    word = kind.split()[0] if kind else ""
    if kind.startswith("char"):
        return "text"
    noun = {"int": "whole number", "double": "number", "float": "number", "vtkTypeBool": "on, off",
            "bool": "on, off", "vtkIdType": "whole number", "vtkTypeInt64": "whole number"}.get(word, word)
    return noun if count == 1 or noun == "on, off" else "%d %ss" % (count, noun)


def initial_value(name, header_text):
    """What a member variable of an option begins with, or None."""
    match = re.search(r"^  ([\w:]+\*?) %s(?:\[\d\])? *(?:= *([^;{]+|\{[^}]*\})|(\{[^}]*\}));" % name,
                      header_text, re.M)
    if not match:
        return None
    kind, value = match.group(1), (match.group(2) or match.group(3)).strip(" {}")
    if kind in ("vtkTypeBool", "bool"):
        words = {"0": "off", "1": "on", "false": "off", "true": "on"}
        return ", ".join(words.get(part.strip(), part.strip()) for part in value.split(","))
    value = re.sub(r"(\d)f\b", r"\1", value)
    value = re.sub(r"(\d)\.0\b", r"\1", value)
    return re.sub(r"\b1 / 255\b", "1/255", {"nullptr": "none"}.get(value, value))


def options_of(code, enums, getters):
    """(name, values) of the options of a group, in the order of their setters, as which its comment
    tells their defaults."""
    found = {}
    for match in SET_MACRO.finditer(code):
        macro, name, arguments = match.groups()
        found.setdefault(name, (match.start(), values_of(name, macro, arguments, code, enums)))
    for match in SETTER.finditer(code):
        name, parameters, override = match.groups()
        one_of_many = re.match(r"int (i|index)\b", parameters)
        # The getter of a number that the superclass has, too, is there.
        inherited = override and name != "Enabled" and re.match(r"(?:double|int) \w+$", parameters)
        if (name in getters or inherited) and not one_of_many:
            values = values_of(name, "", "", code, enums) or type_in_words(parameters)
            found.setdefault(name, (match.start(), values))
    return [(name, values) for name, (_, values) in sorted(found.items(), key=lambda row: row[1][0])]


def groups_of_options(header_text):
    """(names, values, defaults, meaning) of each documented group of options, in their order: an
    option has a setter and a getter, the latter maybe in VTK's superclass."""
    text = public_part(header_text)
    enums = {name: enumerators(body) for name, body in ENUM.findall(text)}
    getters = set(re.findall(r"vtkGet\w*Macro\((\w+)", text)) | set(re.findall(r"\bGet(\w+)\(", text))
    descriptions = {}
    seen = set()
    for match in GROUP.finditer(text):
        comment = plain(match.group("block") or match.group("line"))
        code = match.group("code")
        found = [row for row in options_of(code, enums, getters) if row[0] not in seen]
        if not found:
            for name, _ in ENUM.findall(code)[:1]:
                descriptions[name] = comment
            continue
        seen.update(row[0] for row in found)
        documented = [words.split(" (")[0] for part in DEFAULT.findall(comment)
                      for words in re.split(r", | and ", part) if not part.startswith("(")]
        defaults = [initial_value(name, header_text) for name, _ in found]
        # Prose, or the name of an enumerator of another class.
        in_words = len(found) == 1 and documented and (
            " " in documented[0] or re.fullmatch(r"[A-Z][A-Z_]+", ", ".join(documented)))
        if None in defaults or in_words:
            if len(found) == 1 and documented:
                defaults = [", ".join(documented)]
            elif len(documented) == len(found):
                defaults = documented
            elif len(documented) == 1:
                defaults = documented * len(found)
        meaning = " ".join(part for part in sentences(comment) if not part.startswith("Default"))
        for enum, words in descriptions.items():
            if not meaning and enum in (found[0][0] + "s", found[0][0] + "Type"):
                meaning = words
        yield ([row[0] for row in found], [row[1] for row in found],
               [value or "" for value in defaults], meaning)


def joined(parts):
    """One of them if they are all the same."""
    return parts[0] if len(set(parts)) == 1 else "; ".join(part or "-" for part in parts)


def table(header_text):
    """The options of a class as a Markdown table; empty if there are none."""
    lines = []
    for names, values, defaults, meaning in groups_of_options(header_text):
        cells = [", ".join(names), joined(values), joined(defaults), sentences(meaning)[0]]
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    if not lines:
        return ""
    return "\n".join(["| option | values | default | meaning |", "|---|---|---|---|"] + lines) + "\n"
