"""Small changes to a case that keep most of its structure, so that what reads it gets past its first lines."""

from __future__ import annotations

import contextlib
import io
import json
import struct
import zipfile
from collections.abc import Callable, Sequence
from copy import deepcopy
from random import Random
from typing import Any

import yaml
from lxml import etree
from lxml.etree import _Element as Node
from mjcompose.tree.grammar import GRAMMAR

ODD: tuple[Any, ...] = (
    "",
    " ",
    "0",
    "-1",
    "1e999",
    "nan",
    "inf",
    ".inf",
    "world",
    "main",
    "base",
    "/",
    "//",
    "**",
    "*",
    "{a,b}",
    "/(a+)+$/",
    "é",
    "\t",
    "\0",
    "\x1b[2J",
    "\ud800",
    "\ufffe",
    "a b",
    "${x}",
    "${1/0}",
    "90deg",
    "1 2 3",
    "1,2",
    "true",
    "x" * 300,
    "../..",
    "./model.xml",
    "package:os/x.xml",
    "https://[::1/a.zip#x",
    "git+https://h/r@v#x",
    "<",
    "&",
    "1_000",
    "0x10",
    0,
    1,
    -1,
    2**31,
    2**63,
    10**400,
    1e308,
    5e-324,
    float("inf"),
    float("nan"),
    True,
    False,
    None,
    [],
    {},
    [[]],
    [{}],
    [0, 0, 0],
    [1, 2],
    {"a": 1},
    {"model": 1},
)
ODD_TEXT = tuple(str(each) for each in ODD)
Mutate = Callable[[bytes, Random, Sequence[bytes]], bytes]


def _odd(random: Random) -> Any:
    """A copy of an odd value. Changes made to a shared list would stay, until it holds itself and no walk through it ends."""
    return deepcopy(random.choice(ODD))


def flipped(data: bytes, random: Random, pool: Sequence[bytes] = ()) -> bytes:
    """Bytes changed, taken out, repeated, or put in the place of others, wherever they are."""
    made = bytearray(data)
    for _ in range(random.choice((1, 1, 2, 4))):
        at = random.randrange(len(made) + 1)
        end = min(len(made), at + random.choice((1, 1, 2, 4, 16)))
        kind = random.randrange(5)
        if kind == 0:
            made[at:end] = bytes(random.randrange(256) for _ in range(end - at))
        elif kind == 1:
            del made[at:end]
        elif kind == 2:
            made[at:at] = made[at:end] * random.choice((1, 2, 50))
        elif kind == 3:
            made[at:end] = random.choice(ODD_TEXT).encode("utf-8", "surrogatepass")
        else:
            number = random.choice((0, 1, -1, 2**31 - 1, -(2**31), 0x7F800000, 0x7FC00000))
            made[at : at + 4] = struct.pack("<i", number)
    return bytes(made)


def _places(tree: Any) -> list[tuple[Any, Any]]:
    """Every key and index of a tree, with the mapping or list that it is in."""
    found: list[tuple[Any, Any]] = []
    waiting = [tree]
    while waiting:
        each = waiting.pop()
        keys = list(each) if isinstance(each, dict) else range(len(each)) if isinstance(each, list) else ()
        for key in keys:
            found.append((each, key))
            waiting.append(each[key])
    return found


def tree_changed(tree: Any, random: Random, others: Sequence[Any] = ()) -> Any:
    """Plain data with values, keys and branches changed; `others` give branches."""
    for _ in range(random.choice((1, 1, 2, 3))):
        places = _places(tree)
        if not places:
            return _odd(random)
        holder, key = random.choice(places)
        kind = random.randrange(6)
        if kind == 0:
            del holder[key]
        elif kind == 1 and isinstance(holder, dict):
            new = random.choice([*ODD_TEXT, *(str(name) for _, name in places)])
            holder[new] = holder.pop(key)
        elif kind == 2 and isinstance(holder, list):
            holder.insert(random.randrange(len(holder) + 1), holder[key])
        elif kind == 3:
            branches = _places(random.choice(others)) if others else places
            there, name = random.choice(branches or places)
            holder[key] = json.loads(json.dumps(there[name], default=str))
        elif kind == 4 and isinstance(holder[key], str) and holder[key]:
            holder[key] = flipped(holder[key].encode("utf-8", "surrogatepass"), random).decode("utf-8", "replace")
        else:
            holder[key] = _odd(random)
    return tree


def yaml_changed(data: bytes, random: Random, pool: Sequence[bytes]) -> bytes:
    """A YAML file with branches changed, those of other files among them."""
    if random.random() < 0.15:
        return flipped(data, random)
    try:
        tree = yaml.safe_load(data)
        other = yaml.safe_load(random.choice(pool)) if pool else tree
        changed = tree_changed(tree, random, [other])
        text = yaml.dump(changed, sort_keys=False, allow_unicode=True, default_flow_style=random.random() < 0.3)
    except (yaml.YAMLError, UnicodeError, ValueError, RecursionError):
        return flipped(data, random)
    return text.encode("utf-8", "surrogatepass")


def json_changed(data: bytes, random: Random, pool: Sequence[bytes]) -> bytes:
    """A JSON file with branches changed."""
    if random.random() < 0.15:
        return flipped(data, random)
    try:
        return json.dumps(tree_changed(json.loads(data), random), indent=2).encode()
    except ValueError:  # no JSON, or a branch that was put into itself
        return flipped(data, random)


def xml_changed(data: bytes, random: Random, pool: Sequence[bytes]) -> bytes:
    """An XML file with elements and attributes changed, moved, repeated, wrapped, or taken from other files."""
    if random.random() < 0.1:
        return flipped(data, random)
    try:
        root = etree.fromstring(data)
        other = etree.fromstring(random.choice(pool)) if pool else root
    except etree.XMLSyntaxError:
        return flipped(data, random)
    for _ in range(random.choice((1, 1, 2, 3))):
        _change(root, random, other)
    return etree.tostring(root)


def _change(root: Node, random: Random, other: Node) -> None:
    nodes = [each for each in root.iter("*") if each is not root] or [root]
    node = random.choice(nodes)
    kind = random.randrange(9)
    parent = node.getparent()
    if kind == 0 and parent is not None:
        parent.remove(node)
    elif kind == 1 and parent is not None:
        parent.insert(random.randrange(len(parent) + 1), deepcopy(node))
    elif kind == 2:
        taken = random.choice(list(other.iter("*")))
        node.append(deepcopy(taken))
    elif kind == 3 and parent is not None:
        wrap = etree.Element(random.choice(("frame", "replicate", "body", "worldbody", "default", "include")))
        parent.replace(node, wrap)
        wrap.append(node)
    elif kind == 4:
        node.append(etree.Comment("c"))
    elif kind == 5:
        node.tag = str(random.choice([each.tag for each in nodes] + ["geom", "joint", "flag", "general"]))
    else:
        _set(node, random, other)


def _set(node: Node, random: Random, other: Node) -> None:
    """An attribute that is there, or that some element has, with a value that it has elsewhere or an odd one."""
    known = [str(name) for name in node.keys()]  # noqa: SIM118 (an element is no mapping)
    every = [name for path in (node.tag, random.choice(GRAMMAR.paths)) for name in _attributes(str(path))]
    name = random.choice(known) if known and random.random() < 0.6 else random.choice(every or ["name"])
    values = [str(each.get(name)) for each in other.iter("*") if each.get(name)] + list(ODD_TEXT)
    with contextlib.suppress(ValueError):  # what XML cannot hold
        node.set(name, random.choice(values))


def _attributes(path: str) -> list[str]:
    try:
        kind = GRAMMAR.element(path)
    except KeyError:
        return []
    words = [word for each in kind.attributes.values() for word in each.keywords[:1]]
    return [*kind.attributes, *words[:2]]


def zip_changed(data: bytes, random: Random, pool: Sequence[bytes]) -> bytes:
    """An archive with other names, contents, ways of packing and broken bytes."""
    if random.random() < 0.3:
        return flipped(data, random)
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            files = {each.filename: archive.read(each) for each in archive.infolist()}
    except Exception:
        return flipped(data, random)
    names = list(files)
    for _ in range(random.choice((1, 1, 2))):
        name = random.choice(names)
        kind = random.randrange(5)
        if kind == 0:
            files.pop(name, None)
        elif kind == 1:
            files[random.choice(("", "/a", "../x", "a//b", "C:\\x", "model.xml/", "é", "\0", "x" * 300))] = files.get(
                name, b""
            )
        elif name.endswith(".json"):
            files[name] = json_changed(files.get(name, b"{}"), random, ())
        elif name.endswith(".xml"):
            files[name] = xml_changed(files.get(name, b"<mujoco/>"), random, ())
        else:
            files[name] = flipped(files.get(name, b""), random)
    made = io.BytesIO()
    packing = random.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA))
    with zipfile.ZipFile(made, "w", packing) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name or " "), content)
    return made.getvalue() if random.random() < 0.8 else flipped(made.getvalue(), random)
