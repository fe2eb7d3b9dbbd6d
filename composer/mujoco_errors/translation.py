"""Translate MuJoCo's messages about an element, with advice for its author."""

from __future__ import annotations

from typing import TYPE_CHECKING

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Diagnostic, Note
from composer.diagnostics.suggest import did_you_mean, exists_note
from composer.diagnostics.unknown import unknown_attribute as no_attribute
from composer.grammar import GRAMMAR
from composer.grammar.element import ElementType
from composer.mujoco_errors.other_version import of_other_version
from composer.mujoco_errors.sentence import Sentence, Topic, read_sentence

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

_ADVICE = {
    Topic.MASS: "give the body a geom that has mass, or an `inertial`",
    Topic.GEOM_SIZE: "a sphere has one size, a capsule or cylinder two, a box or ellipsoid three",
    Topic.NEGATIVE: "write a number above 0, or 0 for a geom without mass",
    Topic.FREE_JOINT: "put a body with a free joint into the world: `to: world`",
    Topic.MOCAP: "put a mocap body into the world, without joints: `to: world`",
    Topic.WRAP: "a tendon wraps around spheres and cylinders only",
    Topic.VERTICES: "a mesh file needs at least four points that do not lie in one plane",
    Topic.MESH_FILE: "export the file again, as binary STL or OBJ",
    Topic.PICTURE: "export the picture again, as PNG",
    Topic.TRANSMISSION: "say what it moves: `joint: NAME`, or `tendon`, `site` or `body`",
    Topic.MESH_FORMAT: "a mesh is a file that ends in .stl, .obj or .msh",
    Topic.FLEX_UNPINNED: "attach the flex to what does not move, or give it a `<pin>`",
    Topic.PLUGIN_INSTANCE: "let an actuator have it: `type: plugin, plugin: …, instance: …`, or take the instance out",
    Topic.DOFS: "spread the joints over several bodies, one inside the other",
    Topic.FORMAT: "write numbers, parted by spaces",
}


@dataclass(frozen=True, slots=True)
class Translation:
    """A diagnostic without its place, and facts about the place.

    `attribute` is the element's faulty attribute, if it is known; with `key` the fault is in its name. `topic` is
    the topic of MuJoCo's message.
    """

    diagnostic: Diagnostic
    attribute: str | None = None
    key: bool = False
    topic: Topic | None = None


def translate(message: str, element: Node | None) -> Translation:
    """Return what to report if MuJoCo refuses a model with `message`, which is about `element`."""
    said = read_sentence(message)
    advice = None if said.topic is None else _ADVICE.get(said.topic)
    if element is None:
        rejected = Diagnostic("mujoco-rejects", f"MuJoCo rejects the model: {message}", help=advice)
        return Translation(rejected, topic=said.topic)
    if said.unknown_attribute is not None:
        return unknown_attribute(element, said.unknown_attribute)
    if said.is_unknown_element:
        return unknown_element(element)
    subject = f"the {element.tag} `{element.get('name')}`" if element.get("name") else f"this {element.tag}"
    attribute = _attribute(said, element)
    diagnostic = Diagnostic(
        "mujoco-rejects",
        f"MuJoCo rejects {subject}: {message}",
        notes=_keywords(element, attribute),
        help=_not_positive(said, element) or advice,
    )
    return Translation(diagnostic, attribute, topic=said.topic)


def unknown_attribute(
    element: Node, name: str, file: str | None = None, version: str | None = None
) -> Translation:
    """Return the translation for an attribute that MJCF does not have in that place.

    `file` is the model in which it is written, and `version` a MuJoCo that reads it, if these are known.
    """
    found = of_other_version(element, name, file, version=version)
    if found is None:
        kind = kind_of(element)
        known = list(kind.attributes) if kind is not None else []
        found = no_attribute(name, f"`<{element.tag}>`", known, otherwise=f"take `{name}` out")
    return Translation(found, name, key=True)


def unknown_element(element: Node, file: str | None = None, version: str | None = None) -> Translation:
    """Return the translation for an element that MJCF does not have in that place."""
    if (other := of_other_version(element, None, file, version=version)) is not None:
        return Translation(other)
    parent = element.getparent()
    kind = kind_of(parent) if parent is not None else None
    known = list(kind.children) if kind is not None else []
    holder = f"`<{parent.tag}>`" if parent is not None else "a model"
    return Translation(
        Diagnostic(
            "unknown-element",
            f"`<{element.tag}>` cannot stand in {holder}",
            notes=(exists_note("element", known, str(element.tag)),) if known else (),
            help=did_you_mean(str(element.tag), known, "<{}>"),
        )
    )


def _versions(since: str | None, until: str | None) -> tuple[Note, ...]:
    """Return which versions of MuJoCo have a word that this one lacks."""
    if until is not None:
        return (Note(f"it existed up to MuJoCo {until}"),)
    return (Note(f"it exists since MuJoCo {since}"),) if since is not None else ()


def kind_of(element: Node) -> ElementType | None:
    """Return the element type at the element's place in MJCF, or None if its tag is not allowed there."""
    tags = [str(each.tag) for each in element.iterancestors()]
    found: ElementType | None = GRAMMAR.root
    for tag in [*reversed(tags), str(element.tag)][1:]:
        found = found.children.get(tag) if found is not None else None
    return found


def _attribute(said: Sentence, element: Node) -> str | None:
    named = said.attribute or said.missing_attribute
    if named is not None:
        return named if element.get(named) is not None else None
    holders = [str(name) for name, value in element.items() if name != "name" and value in said.names]
    if len(holders) == 1:
        return holders[0]
    kind = kind_of(element)
    spoken_of = {word for word in said.words if kind is not None and word in kind.attributes}
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


def _not_positive(said: Sentence, element: Node) -> str | None:
    """Return the advice for a size that is written and not positive; a missing size has another advice."""
    if (index := said.size_index) is None:
        return None
    sizes = str(element.get("size") or "").split()
    return f"`{sizes[index]}` is not above 0: sizes are lengths in metres" if index < len(sizes) else None
