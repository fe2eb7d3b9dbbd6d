"""List the rows that `schemas/mjcf.json` needs for the installed MuJoCo: `python .ci/grammar_rows.py`."""

from __future__ import annotations

import json
import re
import sys
from collections import defaultdict
from collections.abc import Iterator
from typing import Any, NamedTuple

from mjcompose.tree.grammar import ElementType, Grammar, read_data, version_key

Tags = tuple[str, ...]
_ROW = re.compile(r"^( *)(\(world\))?(\w+) \(([!?*R])\)(.*)$")
_INDENT = 3
_OCCURS = {"!": "once", "?": "optional", "*": "any", "R": "any"}
_BARE = ("mujoco", "asset", "body", "worldbody", "deformable")
"""Parents whose children are called by their tag alone."""


class Printed(NamedTuple):
    """An element as MuJoCo prints it."""

    occurs: str
    attributes: set[str]


def printed(text: str) -> dict[Tags, Printed]:
    """Return the elements of a text of `mj_printSchema`, by the tags from the root."""
    elements: dict[Tags, Printed] = {}
    tags: Tags = ()
    for line in text.splitlines():
        row = _ROW.match(line)
        if row is None:  # more attributes of the element above
            elements[tags].attributes.update(line.split())
            continue
        indent, _, tag, count, attributes = row.groups()
        tags = (*tags[: len(indent) // _INDENT], tag)
        elements[tags] = Printed(_OCCURS[count], set(attributes.split()))
    return elements


def covered(grammar: Grammar, version: str) -> dict[Tags, ElementType]:
    """Return the elements of the grammar by the same tags.

    MuJoCo prints one `body` for the world, frames and replicates.
    """
    elements: dict[Tags, ElementType] = {}

    def walk(element: ElementType, tags: Tags) -> None:
        if element.tag == "worldbody":
            walk(element.children["body"], (*tags[:-1], "body"))
            return
        elements[tags] = element
        for tag, child in element.children.items():
            if tag not in ("frame", "replicate") and child is not element and child.exists_in(version):
                walk(child, (*tags, tag))

    walk(grammar.root, ("mujoco",))
    return elements


class Bounds(NamedTuple):
    """How a row says that it begins with a version, or that it ended before it."""

    begins: dict[str, str]
    ended: dict[str, str]

    @classmethod
    def of(cls, version: str, grammar: Grammar) -> Bounds:
        first, last = grammar.versions
        if version_key(version) < version_key(first):
            return cls({"until": version}, {"since": first})
        return cls({"since": version}, {"until": last if version_key(version) > version_key(last) else "…"})


def rows(version: str, text: str, read: str) -> Iterator[str]:
    """Yield what to change in the grammar `read`, so it has what MuJoCo `version` prints: `text`."""
    grammar = Grammar(lambda: read)
    data = json.loads(read)
    bounds = Bounds.of(version, grammar)
    theirs = printed(text)
    ours = covered(grammar, version)
    if grammar.versions[0] != version != grammar.versions[1] and "…" not in bounds.ended.values():
        yield f"`mujoco`: the grammar covers {_text(grammar.versions)}, and not {_text(version)}"
    yield from _elements(theirs, ours, bounds)
    lacking: dict[str, set[str]] = defaultdict(set)
    gone: dict[str, set[str]] = defaultdict(set)
    for tags in theirs.keys() & ours.keys():
        element = ours[tags]
        names = {name for name, attribute in element.attributes.items() if attribute.exists_in(version)}
        lacking[element.path] |= theirs[tags].attributes - names
        gone[element.path] |= names - theirs[tags].attributes
        if theirs[tags].occurs != data["elements"][element.path]["occurs"]:
            yield f"`{element.path}`: set {_text({'occurs': theirs[tags].occurs})[1:-1]}"
    yield from _attributes(lacking, data, bounds)
    yield from _ended(gone, data, bounds)


def _text(row: object) -> str:
    return json.dumps(row, ensure_ascii=False)


def _elements(theirs: dict[Tags, Printed], ours: dict[Tags, ElementType], bounds: Bounds) -> Iterator[str]:
    """Yield the elements that only one side has, the outermost first."""
    for tags in sorted(theirs.keys() - ours.keys()):
        above = tags[-2]
        path = tags[-1] if above in _BARE else f"{above}/{tags[-1]}"
        row: dict[str, Any] = {"occurs": theirs[tags].occurs, **bounds.begins}
        if above == "default":
            row["rows_of"] = "…"
        else:
            row["attributes"] = {name: {"type": "…"} for name in sorted(theirs[tags].attributes)}
        yield f"`elements`: add {_text(path)}: {_text(row)}, and {_text(path)} to the children of `{above}`"
    still = {ours[tags].path for tags in theirs.keys() & ours.keys()}
    for path in dict.fromkeys(ours[tags].path for tags in sorted(ours.keys() - theirs.keys())):
        if path not in still:
            yield f"`{path}`: add {_text(bounds.ended)[1:-1]}"


def _attributes(lacking: dict[str, set[str]], data: dict[str, Any], bounds: Bounds) -> Iterator[str]:
    """Yield the rows of attributes; one row is enough for an element and for its defaults in a class."""
    elements = data["elements"]
    own = {path: names for path, names in lacking.items() if "rows_of" not in elements[path]}
    for path, name in _in_groups(own, data):
        row: dict[str, Any] = {"type": "…", **bounds.begins}
        default = elements.get(path.split("`")[1], {}).get("default")
        if default is not None and name not in lacking[default]:
            row["in_default"] = False
        yield f"{path}: add {_text(name)}: {_text(row)}"
    for default, element in elements.items():
        if "rows_of" not in element:
            continue
        source = element["rows_of"]
        for name in sorted(lacking.get(default, set()) - own.get(source, set())):
            since = _text({"in_default": next(iter(bounds.begins.values()))})[1:-1]
            yield f"{_holder(source, name, data)}: add {since} to the row of `{name}`"


def _ended(gone: dict[str, set[str]], data: dict[str, Any], bounds: Bounds) -> Iterator[str]:
    """Yield the attributes that MuJoCo reads no more, and those that it reads no more in a class."""
    elements = data["elements"]
    for path, name in _in_groups({path: gone[path] for path in gone if "rows_of" not in elements[path]}, data):
        yield f"{path}: add {_text(bounds.ended)[1:-1]} to the row of `{name}`"
    for path, element in elements.items():
        for name in sorted(gone.get(path, set()) - gone.get(element.get("rows_of"), set())):
            if "rows_of" in element:
                yield f'{_holder(element["rows_of"], name, data)}: add "in_default": false to the row of `{name}`'


def _holder(path: str, name: str, data: dict[str, Any]) -> str:
    """Return the place of the row of an attribute: the element, or its group that has the row."""
    groups = data["elements"][path].get("groups", ())
    holder = next((group for group in groups if name in data["groups"][group]["attributes"]), None)
    return f"`{path}`" if holder is None else f"group `{holder}`"


def _in_groups(names: dict[str, set[str]], data: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield each place and attribute: the group instead of its elements, if all of them have the attribute."""
    elements = data["elements"]
    left = {path: set(attributes) for path, attributes in names.items()}
    for group in data["groups"]:
        members = [path for path, element in elements.items() if group in element.get("groups", ())]
        shared = set.intersection(*(left.get(member, set()) for member in members))
        for name in sorted(shared):
            yield f"group `{group}`", name
        for member in members:
            left.get(member, set()).difference_update(shared)
    for path in elements:
        for name in sorted(left.get(path, ())):
            yield f"`{path}`", name


def needed() -> list[str]:
    """Return the rows that the installed MuJoCo needs."""
    import mujoco

    return list(rows(mujoco.__version__, mujoco.mj_printSchema(False, True), read_data()))


if __name__ == "__main__":
    lines = needed()
    sys.stdout.write("\n".join(lines or ["schemas/mjcf.json has all that this MuJoCo reads"]) + "\n")
    sys.exit(bool(lines))
