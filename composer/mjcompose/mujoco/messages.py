"""MuJoCo's error messages as diagnostics for the author of the element."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from enum import Enum
from pathlib import PurePath
from typing import TYPE_CHECKING, NamedTuple

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Cause, Diagnostic, Note, Span
from mjcompose.base.suggest import did_you_mean, exists_note, unknown_attribute as no_attribute
from mjcompose.sources.context import Context
from mjcompose.sources.reference import FORMATS
from mjcompose.tree.classes import Level, levels, own
from mjcompose.tree.grammar import GRAMMAR, ElementType, version_key
from mjcompose.tree.history import Span as HistorySpan, place, spans
from mjcompose.tree.unit import Unit

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

_UNKNOWN_ATTRIBUTE = re.compile(r"unrecognized attribute: '(?P<name>[^']*)'")
_UNKNOWN_ELEMENT = re.compile(r"unrecognized (?:model )?element")
_ATTRIBUTE = re.compile(r"attribute '(?P<name>[^']*)'")
_MISSING = re.compile(r"missing element: '(?P<tag>[^']*)'|attribute missing: '(?P<name>[^']*)'")
_SIZE = re.compile(r"^size (?P<index>\d) must be positive")
_PLUGIN = re.compile(r"failed for plugin id (?P<id>\d+)")
_ARRAY = re.compile(r"^Invalid model: (?P<name>[a-z]+_\w+)")
_WORD = re.compile(r"\w+")
_QUOTED = re.compile(r"'([^'\n]+)'")
# Messages about settings of the whole model, for which MuJoCo knows no line.
_SECTIONS = {"size": re.compile(r"<size |arena memory|mj_stackAlloc"), "option": re.compile(r"\bintegrator='")}


class Topic(Enum):
    """The topic of a message of MuJoCo; the value is the pattern that recognizes it."""

    MASS = r"mass and inertia of moving bodies"
    GEOM_SIZE = r"^size \d must be positive in geom"
    SIZE = r"^size \d must be positive"
    NEGATIVE = r"are negative in geom"
    FREE_JOINT = r"^free joint can only be used on top level"
    MOCAP = r"^mocap body .* is not a fixed child of world"
    SLEEP = r"^sleep policy only allowed for movable root bodies"
    WRAP = r"is not sphere or cylinder"
    VERTICES = r"vertices required"
    MESH_FILE = r"^invalid header in|^stl_decoder: |^obj_decoder: "
    PICTURE = r"PNG"
    TRANSMISSION = r"^missing transmission target"
    MESH_FORMAT = r"no decoder found"
    FLEX_UNPINNED = r"has joints but no flex vertices/nodes are pinned"
    PLUGIN_INSTANCE = r"actuator not found for plugin instance"
    DOFS = r"^more than 6 dofs"
    FLAT = r"has coplanar vertices|^qhull error"
    FORMAT = r"^bad format in attribute"
    INERTIA = r"A \+ B >= C|^error 'inertia must have positive eigenvalues'"
    FRAMEBUFFER = r"framebuffer"
    OPENGL = r"^an OpenGL platform library has not been loaded"
    URDF_GEOMETRY = r"geometry specification"
    URDF_REPEATED = r"^repeated URDF name|^repeated name '.*' in joint"
    URDF_RING = r"^URDF body not found$"
    URDF_PARENTS = r"has multiple parents"
    URDF_LINK = r"^URDF joint parent or child missing$"
    URDF_JOINT_TYPE = r"^invalid joint type"
    URDF_EQUAL_LIMITS = r"has equal lower and upper limits"


class Sentence(Struct):
    """A parsed message of MuJoCo; no other code in this package parses messages.

    `attribute` is the attribute that it names, `unknown_attribute` an attribute that MJCF does not have there,
    `missing_attribute` and `missing_element` are required ones; `names` are the names in quotes. `size_index` is the
    size that must be positive, `plugin` the number of the plugin that failed, `section` the section with the faulty
    setting, `array` the faulty array of the compiled model.
    """

    topic: Topic | None = None
    attribute: str | None = None
    unknown_attribute: str | None = None
    is_unknown_element: bool = False
    missing_attribute: str | None = None
    missing_element: str | None = None
    names: tuple[str, ...] = ()
    words: frozenset[str] = frozenset()
    size_index: int | None = None
    plugin: int | None = None
    section: str | None = None
    array: str | None = None


def read_sentence(message: str) -> Sentence:
    """Parse a message of MuJoCo.

    >>> read_sentence("required attribute missing: 'pos'").missing_attribute
    'pos'
    """

    def first(pattern: re.Pattern[str], group: str) -> str | None:
        found = pattern.search(message)
        return None if found is None else found[group]

    size = first(_SIZE, "index")
    plugin = first(_PLUGIN, "id")
    return Sentence(
        next((topic for topic in Topic if re.search(topic.value, message)), None),
        first(_ATTRIBUTE, "name"),
        first(_UNKNOWN_ATTRIBUTE, "name"),
        is_unknown_element=_UNKNOWN_ELEMENT.search(message) is not None,
        missing_attribute=first(_MISSING, "name"),
        missing_element=first(_MISSING, "tag"),
        names=tuple(_QUOTED.findall(message)),
        words=frozenset(_WORD.findall(message)),
        size_index=None if size is None else int(size),
        plugin=None if plugin is None else int(plugin),
        section=next((section for section, pattern in _SECTIONS.items() if pattern.search(message)), None),
        array=first(_ARRAY, "name"),
    )


CRASHES = {"timeout": "mujoco-timeout", "missing": "mujoco-missing"}
"""The diagnostic codes for a `crash` of `engine.Compiled`; every other crash is `mujoco-crash`."""

CRASH_HELP = {
    "mujoco-timeout": "give it more time with `--timeout`, or look for huge counts in `replicate` and `flexcomp`",
    "mujoco-missing": "install it: `python -m pip install 'mujoco>=3.11'`, in an environment of its own if another "
    "package needs an older MuJoCo; or do without it: `--no-compile`",
    "mujoco-crash": "load each part alone in MuJoCo to find the one at fault",
}
"""Advice for the case that MuJoCo gave no verdict."""

_PREFIX = re.compile(r"^(?:(?:XML )?Error: |ParseXML: )+")
# "Element name 'left/X', id 0, line 38": from the compiler, about an object of the model
_OBJECT = re.compile(r"(?ms)\s*^Element name '(?P<name>.*)', id (?P<id>-?\d+)(?:, line (?P<line>-?\d+))?[ \t]*$")
# "Element 'geom', line 3, column 7": from the reader, about an element of the file
_ELEMENT = re.compile(
    r"(?m)\s*^Element '(?P<element>[^'\n]*)', line (?P<line>-?\d+)(?:, column (?P<column>-?\d+))?\s*\Z"
)
# precedes that line if a `<flexcomp>` cannot be created: there is no object yet
_NO_OBJECT = re.compile(r"^Element name '', id -1[ \t]*\n(?=Element ')", re.M)
# TinyXML's message about a file that is not well-formed
_XML = re.compile(
    r"(?s)^XML parse error \d+:\s*Error=(?P<error>\w+).*?Line number=(?P<line>\d+)(?::\s*(?P<rest>.*))?\Z"
)


class EngineMessage(Struct):
    """One message of MuJoCo, split into its parts.

    `message` is its text without the other fields, which are None if MuJoCo does not name them. `line` (and
    `column`) count from 1, in the bundle's MJCF. `element` is the tag, and `name` is the object's name.
    """

    message: str
    line: int | None = None
    column: int | None = None
    element: str | None = None
    name: str | None = None


def parse(text: str) -> EngineMessage:
    r"""Split one message of MuJoCo into its parts.

    >>> parse("Error: size 0 must be positive in geom\nElement name 'left/pad', id 3, line 38")
    EngineMessage(message='size 0 must be positive in geom', line=38, column=None, element=None, name='left/pad')
    """
    text = _NO_OBJECT.sub("", text.strip())
    broken = _XML.match(text)
    if broken:
        fault = broken["error"].removeprefix("XML_ERROR_").replace("_", " ").lower()
        detail = " ".join((broken["rest"] or "").split())
        element = re.fullmatch(r"XMLElement name=(\S+)", detail)
        message = f"not well-formed XML: {fault}" + (f": {detail}" if detail and not element else "")
        return EngineMessage(message, _positive(broken["line"]), element=element[1] if element else None)
    trailer = _OBJECT.search(text) or _ELEMENT.search(text)
    if trailer is None:
        return EngineMessage(_PREFIX.sub("", text).strip())
    fields = trailer.groupdict()
    message = _PREFIX.sub("", text[: trailer.start()]).strip()
    rest = text[trailer.end() :].strip()
    if rest:  # MuJoCo 3.12 puts the reason why a file cannot be read last
        message = f"{message}: {rest}"
    return EngineMessage(
        message,
        line=_positive(fields["line"]),
        column=_positive(fields.get("column")),
        element=fields.get("element") or None,
        name=fields.get("name") or None,
    )


def _positive(number: str | None) -> int | None:
    """Return a line or column from MuJoCo, which writes 0 or -1 for an unknown one."""
    return int(number) if number is not None and int(number) > 0 else None


Unread = tuple["Node", str | None]
"""An element, or an attribute of it, that this MuJoCo does not read."""


def version_of(found: Iterable[Unread]) -> str | None:
    """Return a version that reads all of these, if one is known: the last one before the first of them was removed."""
    known = [span for element, name in found if (span := _span(element, name)) is not None]
    ended = [until for _, until in known if until is not None]
    begun = [since for since, _ in known if since is not None]
    return min(ended, key=version_key) if ended else max(begun, key=version_key, default=None)


def of_other_version(
    element: Node, name: str | None, file: str | None, version: str | None = None
) -> Diagnostic | None:
    """Return the error for an attribute or an element that another version of MuJoCo has in this place, or None.

    `file` is the model in which it is written, and `version` a MuJoCo that reads the whole file. `mjcompose migrate`
    writes it for this MuJoCo.

    >>> from lxml import etree
    >>> option = etree.fromstring('<mujoco><option mpr_iterations="20"/></mujoco>')[0]
    >>> found = of_other_version(option, "mpr_iterations", "old.xml")
    >>> found.message, found.notes[0].message
    ('this MuJoCo has no attribute `mpr_iterations` of `<option>`', 'it existed up to MuJoCo 3.2.2')
    """
    known = _span(element, name)
    if known is None:
        return None
    subject = f"`<{element.tag}>`" if name is None else f"attribute `{name}` of `<{element.tag}>`"
    help = None
    if file is not None and not _is_recipe(file):
        reader = version or known[1] or known[0]
        help = f"`mjcompose migrate {file} --from {reader} -o NEW` writes the model for this MuJoCo"
    code = "unknown-element" if name is None else "unknown-attribute"
    return Diagnostic(code, f"this MuJoCo has no {subject}", notes=_versions(*known), help=help)


def _span(element: Node, name: str | None) -> HistorySpan | None:
    return spans().get(place(element) + ("" if name is None else f"@{name}"))


def _is_recipe(file: str) -> bool:
    return FORMATS.get(PurePath(file).suffix.lower()) == "recipe"


_ADVICE = {
    Topic.MASS: "give the body a geom that has mass, or an `inertial`",
    Topic.GEOM_SIZE: "a sphere has one size, a capsule or cylinder two, a box or ellipsoid three",
    Topic.NEGATIVE: "write a number above 0, or 0 for a geom without mass",
    Topic.FREE_JOINT: "put a body with a free joint into the world: `to: world`",
    Topic.MOCAP: "put a mocap body into the world, without joints: `to: world`",
    Topic.SLEEP: "only a moving body in the world can have `sleep`: remove it, or in a part write"
    " `edit: [{select: {body: NAME}, set: {sleep: null}}]`",
    Topic.WRAP: "a tendon wraps around spheres and cylinders only",
    Topic.VERTICES: "a mesh file needs at least four points that do not lie in one plane",
    Topic.MESH_FILE: "export the file again, as binary STL or OBJ",
    Topic.PICTURE: "export the picture again, as PNG",
    Topic.TRANSMISSION: "name the moved element: `joint: NAME`, or `tendon`, `site` or `body`",
    Topic.MESH_FORMAT: "a mesh is a file that ends in .stl, .obj or .msh",
    Topic.FLEX_UNPINNED: "attach the flex to a fixed body, or give it a `<pin>`",
    Topic.PLUGIN_INSTANCE: "give it to an actuator: `type: plugin, plugin: …, instance: …`, or remove the instance",
    Topic.DOFS: "spread the joints over several bodies, one inside the other",
    Topic.FORMAT: "write numbers separated by spaces",
}


class Translation(Struct):
    """A diagnostic without its place, and facts about the place.

    `attribute` is the element's faulty attribute, if it is known; with `key`, the fault is in its name. `topic` is
    the topic of MuJoCo's message.
    """

    diagnostic: Diagnostic
    attribute: str | None = None
    key: bool = False
    topic: Topic | None = None


def translate(message: str, element: Node | None) -> Translation:
    """Return the diagnostic to report if MuJoCo refuses a model with `message`, which is about `element`."""
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
    help = _not_positive(said, element) or advice
    message = f"MuJoCo rejects {subject}: {message}"
    rejected = Diagnostic("mujoco-rejects", message, notes=_keywords(element, attribute), help=help)
    return Translation(rejected, attribute, topic=said.topic)


def unknown_attribute(element: Node, name: str, file: str | None = None, version: str | None = None) -> Translation:
    """Return the translation for an unknown attribute in a `file` that a MuJoCo of `version` reads, if known."""
    translation = of_other_version(element, name, file, version=version)
    if translation is None:
        kind = kind_of(element)
        known = list(kind.attributes) if kind is not None else []
        help = instead_of_old(str(element.tag), name, str(element.get(name)))
        translation = no_attribute(name, f"`<{element.tag}>`", known, help=help, otherwise=f"remove `{name}`")
    return Translation(translation, name, key=True)


_COLLIDING = {
    "all": "remove `collision`: since 3.0, MuJoCo always collides as with `all`",
    "dynamic": "remove `collision` and every `<pair>`: `dynamic` ignored pairs",
    "predefined": "remove `collision`, and every `contype` and `conaffinity`, so only pairs collide, and write\n"
    '<default><geom contype="0" conaffinity="0"/></default>',
}
_OLD = {("option", "collision"): _COLLIDING}
"""Attributes that MuJoCo read before 3.0, and for each value the change that keeps its effect."""


def instead_of_old(tag: str, attribute: str, value: str) -> str | None:
    """Return what to write instead of an attribute that MuJoCo removed before 3.0, or None for any other.

    >>> instead_of_old("option", "collision", "dynamic")
    'remove `collision` and every `<pair>`: `dynamic` ignored pairs'
    """
    return _OLD.get((tag, attribute), {}).get(value.strip())


def unknown_element(element: Node, file: str | None = None, version: str | None = None) -> Translation:
    """Return the translation for an element that MJCF does not have in that place."""
    other = of_other_version(element, None, file, version=version)
    if other is not None:
        return Translation(other)
    parent = element.getparent()
    tag = str(element.tag)
    kind = None if parent is None else kind_of(parent)
    known = [] if kind is None else list(kind.children)
    holder = f"`<{parent.tag}>`" if parent is not None else "a model"
    notes = (exists_note("element", known, tag),) if known else ()
    message = f"`<{tag}>` cannot be in {holder}"
    help = did_you_mean(tag, known, "<{}>")
    return Translation(Diagnostic("unknown-element", message, notes=notes, help=help))


def _versions(since: str | None, until: str | None) -> tuple[Note, ...]:
    """Return the versions of MuJoCo that have a word that this version lacks."""
    note = f"it existed up to MuJoCo {until}" if until else f"it exists since MuJoCo {since}"
    return (Note(note),) if since or until else ()


def kind_of(element: Node) -> ElementType | None:
    """Return the element type at the element's place in MJCF, or None if its tag is not allowed there."""
    found: ElementType | None = GRAMMAR.root
    for node in [element, *element.iterancestors()][-2::-1]:
        found = found.children.get(str(node.tag)) if found is not None else None
    return found


def _attribute(said: Sentence, element: Node) -> str | None:
    named = said.attribute or said.missing_attribute
    if named is not None:
        return named if element.get(named) is not None else None
    holders = [str(name) for name, value in element.items() if name != "name" and value in said.names]
    if len(holders) == 1:
        return holders[0]
    kind = kind_of(element)
    mentioned = said.words.intersection(kind.attributes if kind is not None else ())
    return next(iter(mentioned)) if len(mentioned) == 1 else None


def _keywords(element: Node, attribute: str | None) -> tuple[Note, ...]:
    kind = kind_of(element)
    known = kind.attributes.get(attribute) if kind is not None and attribute is not None else None
    if known is None or known.type not in ("keyword", "keywords") or element.get(known.name) is None:
        return ()
    text = str(element.get(known.name))
    versions = known.keyword_versions.get(text)
    if versions is not None:
        return _versions(*versions)
    return () if text in known.keywords else (exists_note("keyword", known.keywords, text),)


def _not_positive(said: Sentence, element: Node) -> str | None:
    """Return the advice for a size that is written and not positive; a missing size has different advice."""
    index = said.size_index
    if index is None:
        return None
    sizes = str(element.get("size") or "").split()
    return f"`{sizes[index]}` is not above 0: sizes are lengths in meters" if index < len(sizes) else None


_MASSES = {"inertial": ("mass", "diaginertia", "fullinertia"), "geom": ("mass", "density")}


class FaultLocation(NamedTuple):
    """The place to show, and notes about other places."""

    span: Span
    notes: tuple[Note, ...] = ()


def locate_fault(said: Translation, element: Node, model: Unit) -> FaultLocation:
    """Return the place of a fault; a value from the recipe comes first, because its author can change it."""
    span = model.origins.span(element, model.file, said.attribute, key=said.key)
    if said.attribute is None:
        holders = own(element, "inertial") or own(element, "geom") if said.topic is Topic.MASS else ()
        places = ((child, name) for child in holders for name in _MASSES[str(child.tag)] if child.get(name) is not None)
        masses = (model.origins.span(child, model.file, name) for child, name in places)
        written = next((each for each in masses if _is_recipe(each.file)), None)
        return FaultLocation(span) if written is None else FaultLocation(written, (Note("the body is here", span),))
    level = _class_level(said.attribute, element, model)
    if level is None or level.writer is None:
        return FaultLocation(span)
    there = model.origins.span(level.writer, model.file, said.attribute)
    if _is_recipe(there.file):
        return FaultLocation(there, (Note(f"the default class `{level.name}` gives it to this {element.tag}", span),))
    return FaultLocation(span, (Note(f"`{said.attribute}` comes from the default class `{level.name}`", there),))


def _class_level(attribute: str, element: Node, model: Unit) -> Level | None:
    kind = kind_of(element)
    known = kind.attributes.get(attribute) if kind is not None else None
    if kind is None or known is None or element.get(attribute) is not None:
        return None
    every = levels(element, kind, known, classes=model.classes)
    nearest = next((level for level in every if level.taken or level.text), None)
    return nearest if nearest is not None and nearest.kind == "class" else None


def report(
    said: Translation,
    element: Node | None,
    model: Unit,
    context: Context,
    cause: Cause | None = None,
    at: Span | None = None,
) -> None:
    """Report an error at the element, or at its faulty attribute; without an element, at the place `at`."""
    if element is None:
        context.sink.add(replace(said.diagnostic, span=at))
        return
    found = locate_fault(said, element, model)
    notes = (*found.notes, *said.diagnostic.notes)
    context.sink.add(replace(said.diagnostic, span=found.span, notes=notes), cause)
