"""What MuJoCo says of an element, in the words and with the advice that its author needs."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.suggest import did_you_mean, exists_note
from composer.grammar import GRAMMAR
from composer.grammar.element import ElementType

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

_UNKNOWN_ATTRIBUTE = re.compile(r"unrecognized attribute: '(?P<name>[^']*)'")
_UNKNOWN_ELEMENT = re.compile(r"unrecognized (?:model )?element")
_NAMED_ATTRIBUTE = re.compile(r"attribute '(?P<name>[^']*)'|attribute missing: '(?P<missing>[^']*)'")
_SIZE = re.compile(r"^size (?P<index>\d) must be positive")
_WORD = re.compile(r"\w+")
_QUOTED = re.compile(r"'([^'\n]+)'")

# What to do, by what MuJoCo says; the first that fits.
_ADVICE: tuple[tuple[str, str], ...] = (
    (r"mass and inertia of moving bodies", "give the body a geom that has mass, or an `inertial`"),
    (
        r"^size \d must be positive in geom",
        "a sphere has one size, a capsule or cylinder two, a box or ellipsoid three",
    ),
    (r"are negative in geom", "write a number above 0, or 0 for a geom without mass"),
    (r"^free joint can only be used on top level", "put a body with a free joint into the world: `to: world`"),
    (r"^mocap body .* is not a fixed child of world", "put a mocap body into the world, without joints: `to: world`"),
    (r"is not sphere or cylinder", "a tendon wraps around spheres and cylinders only"),
    (r"vertices required", "a mesh file needs at least four points that do not lie in one plane"),
    (r"^invalid header in|^stl_decoder: |^obj_decoder: ", "export the file again, as binary STL or OBJ"),
    (r"PNG", "export the picture again, as PNG"),
    (r"^missing transmission target", "say what it moves: `joint: NAME`, or `tendon`, `site` or `body`"),
    (r"^no decoder found for mesh file", "a mesh is a file that ends in .stl, .obj or .msh"),
    (r"has joints but no flex vertices/nodes are pinned", "hang the flex on what does not move, or give it a `<pin>`"),
    (
        r"actuator not found for plugin instance",
        "let an actuator have it: `type: plugin, plugin: …, instance: …`, or take the instance out",
    ),
    (r"^more than 6 dofs", "spread the joints over several bodies, one inside the other"),
    (r"^bad format in attribute", "write numbers, parted by spaces"),
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Translation:
    """A diagnostic without its place.

    `attribute` is the one of the element that the fault lies in, if that is known; with `key` in its name.
    """

    code: str
    message: str
    attribute: str | None = None
    notes: tuple[Note, ...] = ()
    help: str | None = None
    key: bool = False


def translate(message: str, element: Node | None) -> Translation:
    """What to tell where MuJoCo refuses a model with `message`, which speaks of `element`."""
    if element is None:
        return Translation("mujoco-rejects", f"MuJoCo rejects the model: {message}", help=_advice(message))
    if found := _UNKNOWN_ATTRIBUTE.search(message):
        return unknown_attribute(element, found["name"])
    if _UNKNOWN_ELEMENT.search(message):
        return _unknown_element(element)
    subject = f"the {element.tag} `{element.get('name')}`" if element.get("name") else f"this {element.tag}"
    attribute = _attribute(message, element)
    return Translation(
        "mujoco-rejects",
        f"MuJoCo rejects {subject}: {message}",
        attribute,
        _keywords(element, attribute),
        _not_positive(message, element) or _advice(message),
    )


def unknown_attribute(element: Node, name: str) -> Translation:
    """An attribute that MJCF does not have in that place."""
    kind = kind_of(element)
    known = list(kind.attributes) if kind is not None else []
    if kind is not None and name in known:
        message = f"this MuJoCo has no attribute `{name}` of `<{element.tag}>`"
        attribute = kind.attributes[name]
        return Translation(
            "unknown-attribute", message, name, _versions(attribute.since, attribute.until), key=True
        )
    return Translation(
        "unknown-attribute",
        f"`{name}` is not an attribute of `<{element.tag}>`",
        name,
        (exists_note("attribute", known, name),) if known else (),
        did_you_mean(name, known) or f"take `{name}` out",
        key=True,
    )


def _unknown_element(element: Node) -> Translation:
    parent = element.getparent()
    kind = kind_of(parent) if parent is not None else None
    known = list(kind.children) if kind is not None else []
    if kind is not None and element.tag in known:
        child = kind.children[str(element.tag)]
        notes = _versions(child.since, child.until)
        return Translation("unknown-element", f"this MuJoCo has no `<{element.tag}>`", None, notes)
    return Translation(
        "unknown-element",
        f"`<{element.tag}>` cannot stand in " + (f"`<{parent.tag}>`" if parent is not None else "a model"),
        None,
        (exists_note("element", known, str(element.tag)),) if known else (),
        did_you_mean(str(element.tag), known, "<{}>"),
    )


def _versions(since: str | None, until: str | None) -> tuple[Note, ...]:
    """Which versions of MuJoCo have what this one has not."""
    if until is not None:
        return (Note(f"it was there up to MuJoCo {until}"),)
    return (Note(f"it is there since MuJoCo {since}"),) if since is not None else ()


def kind_of(element: Node) -> ElementType | None:
    """What MJCF has in the place where the element stands, or None where it has nothing of that tag."""
    tags = [str(each.tag) for each in element.iterancestors()]
    found: ElementType | None = GRAMMAR.root
    for tag in [*reversed(tags), str(element.tag)][1:]:
        found = found.children.get(tag) if found is not None else None
    return found


def _attribute(message: str, element: Node) -> str | None:
    named = _NAMED_ATTRIBUTE.search(message)
    if named is not None:
        name = named["name"] or named["missing"]
        return name if element.get(name) is not None else None
    quoted = _QUOTED.findall(message)
    holders = [str(name) for name, value in element.items() if name != "name" and value in quoted]
    if len(holders) == 1:
        return holders[0]
    kind = kind_of(element)
    spoken_of = {word for word in _WORD.findall(message) if kind is not None and word in kind.attributes}
    return spoken_of.pop() if len(spoken_of) == 1 else None


def _keywords(element: Node, attribute: str | None) -> tuple[Note, ...]:
    kind = kind_of(element)
    known = kind.attributes.get(attribute) if kind is not None and attribute is not None else None
    if known is None or known.type not in ("keyword", "keywords") or element.get(known.name) is None:
        return ()
    text = str(element.get(known.name))
    if (versions := known.keyword_versions.get(text)) is not None:
        return _versions(*versions)
    return () if text in known.keywords else (exists_note("keyword", known.keywords, text),)


def _not_positive(message: str, element: Node) -> str | None:
    """The advice for a size that is written, and is 0 or less; a size that is missing has another one."""
    if (found := _SIZE.search(message)) is None:
        return None
    sizes = str(element.get("size") or "").split()
    index = int(found["index"])
    return f"`{sizes[index]}` is not above 0: sizes are lengths in metres" if index < len(sizes) else None


def _advice(message: str) -> str | None:
    return next((advice for pattern, advice in _ADVICE if re.search(pattern, message)), None)
