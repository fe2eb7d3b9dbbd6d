"""Changes of a model: attributes, new names and removal, with all consequences."""

from __future__ import annotations

import dataclasses
import struct
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import field
from pathlib import Path
from typing import Generic, NamedTuple, Protocol, Self, TypeVar

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Note, Span
from mjcompose.base.files import read_regular
from mjcompose.base.suggest import renaming, unknown_name
from mjcompose.tree import journal
from mjcompose.tree.classes import ORIENTATIONS
from mjcompose.tree.files import read_settings, written_path
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.names import ALWAYS, NameIndex, declaration, is_list, word
from mjcompose.tree.select import ROOT, WORLD_SECTION, section_of
from mjcompose.tree.unit import Unit

_HEADER = struct.Struct("<4i")
_NAME_BYTES = 40
_BIND = 7 * 4


class BadSkin(ValueError):
    """The bytes are not a skin file, or a name does not fit into it."""


class BadBone(BadSkin):
    """A name does not fit into a skin file."""


class Skin(NamedTuple):
    """A skin with a file: the path under which MuJoCo looks for it, and the path as written."""

    element: Node
    path: str
    written: str


def skins(root: Node) -> Iterator[Skin]:
    """Yield every skin of a model that names a file."""
    settings = None
    for section in root.iterchildren("asset", "deformable"):
        for element in section.iterchildren("skin"):
            written = element.get("file")
            if written:
                settings = settings or read_settings(root)
                yield Skin(element, written_path(settings, element, written), str(written))


def renamed_skin(source: bytes | Path, rename: Callable[[str], str | None]) -> bytes | None:
    """Return the file with renamed bones, or None if no bone changes. Raises `BadBone`.

    `rename` returns None for a name that stays. An unreadable file stays as it is: it is reported where all files
    are read, or by MuJoCo.
    """
    try:
        before = _bytes_of(source)
        after = rename_bones(before, lambda name: rename(name) or name)
    except BadBone:
        raise
    except (OSError, BadSkin):
        return None
    return None if after == before else after


def bones(source: bytes | Path) -> list[str] | None:
    """Return the bodies that a skin file names, or None if it is unreadable."""
    found: list[str] = []

    def note(name: str) -> str:
        found.append(name)
        return name

    try:
        rename_bones(_bytes_of(source), note)
    except (OSError, BadSkin):
        return None
    return found


def _bytes_of(source: bytes | Path) -> bytes:
    return source if isinstance(source, bytes) else read_regular(source)


def rename_bones(data: bytes, rename: Callable[[str], str]) -> bytes:
    """Return the same skin with every bone's body renamed. A name has room for 39 bytes."""
    try:
        vertices, texcoords, faces, bones = _HEADER.unpack_from(data)
        at = _HEADER.size + 4 * (3 * vertices + 2 * texcoords + 3 * faces)
        pieces = [data[:at]]
        for _ in range(bones):
            name = data[at : at + _NAME_BYTES].split(b"\0", 1)[0].decode()
            new = rename(name).encode()
            if len(new) >= _NAME_BYTES:
                raise BadBone(f"the body name `{new.decode()}` is longer than the 39 bytes of a skin file")
            (count,) = struct.unpack_from("<i", data, at + _NAME_BYTES + _BIND)
            end = at + _NAME_BYTES + _BIND + 4 + 8 * count
            pieces += [new.ljust(_NAME_BYTES, b"\0"), data[at + _NAME_BYTES : end]]
            at = end
    except (struct.error, UnicodeDecodeError) as error:
        raise BadSkin("not a skin file") from error
    if at != len(data):
        raise BadSkin("not a skin file")
    return b"".join(pieces)


def attached_notes(unit: Unit, name: str) -> list[Note]:
    """Return notes on each `<attach>` that may bring a missing name."""
    reach = "to reach into that, attach it in a recipe"
    message = f"it may belong to the model that MuJoCo attaches here, and can only be referred to: {reach}"
    holders = (each for each in unit.root.iter("attach") if name.startswith(str(each.get("prefix") or "")))
    return [Note(message, unit.origins.span(attach, unit.file)) for attach in holders]


class NameLookup(Protocol):
    """Looks up names in a model and in the models attached to it."""

    def find_node(self, namespace: str, name: str) -> Node | None:
        """Return the element of that name, in this model or in a model attached to it."""

    def known_names(self, namespace: str) -> Iterable[str]:
        """Return every name of a namespace that the model can refer to."""

    def kinds_of(self, name: str) -> Iterable[str]:
        """Return the namespaces in which the name exists."""

    def may_generate(self, name: str) -> bool:
        """Return whether MuJoCo may create the name itself, as for the copies of a `<replicate>`."""


class Editable(NameLookup, Protocol):
    """One tree with its names, which edits keep up to date, and the models that it is attached to.

    A recipe edits one flat tree. `mjcompose.mjcf` edits a tree of models: in outer models, names have a prefix.
    """

    @property
    def names(self) -> NameIndex:
        """The names of its own tree."""

    def levels(self) -> Iterator[tuple[Self, str]]:
        """Yield the model, then the models that it is attached to, each with the prefix of this model's names there."""

    def names_of(self, node: Node) -> Iterable[tuple[str, str]]:
        """Return namespace and name of everything that belongs to an element."""

    def forget(self, node: Node) -> None:
        """Drop the names of a node before it changes."""

    def note(self, node: Node) -> None:
        """Add the names of a node after it has changed."""


M = TypeVar("M", bound=Editable)


class NameReference(NamedTuple, Generic[M]):
    """An element of `model` that refers to a name by an attribute, as that model writes it."""

    model: M
    node: Node
    attribute: str
    namespace: str
    name: str


def referrers(model: M, namespace: str, name: str) -> Iterator[NameReference[M]]:
    """Yield the references to a name, here and in the models above. A `<flex>` that is a rod refers to its twists."""
    for here, _, kind, used in uses_of(model, namespace, name):
        for node, attribute in here.names.users(kind, used):
            yield NameReference(here, node, attribute, namespace=kind, name=used)
    rod = model.find_node("flex", twisted_by(name)) if namespace == "joint" and twisted_by(name) else None
    if rod is not None and is_rod(rod):
        yield NameReference(model, rod, "name", namespace=namespace, name=name)


def uses_of(model: M, namespace: str, name: str) -> Iterator[tuple[M, str, str, str]]:
    """Yield the texts by which models refer to a name: each model, the prefix there, the namespace and the whole text.

    These are the name itself, the names of the copies that MuJoCo makes, and the names of the bodies and joints that it
    makes from a `<flexcomp>`.
    """
    node = model.find_node(namespace, name)
    has_copies = node is not None and multiplies(node)
    kinds = (namespace, "body", "joint") if node is not None and node.tag == "flexcomp" else (namespace,)
    for here, prefix in model.levels():
        full = prefix + name
        yield here, prefix, namespace, full
        if has_copies:
            for kind in kinds:
                for used in list(here.names.uses.get(kind, ())):
                    of_it = is_copy(used, full) if kind == namespace else _is_of_flex(here, used, full)
                    if of_it and here.find_node(kind, used) is None:
                        yield here, prefix, kind, used


def _is_of_flex(model: Editable, used: str, flex: str) -> bool:
    """Return whether MuJoCo makes the name of a body or joint for this `<flexcomp>`."""
    # It calls them `cloth_0`, `rod_twist_0` and `rod_twist`; in a `<replicate>` the number of the copy follows.
    end = used.removeprefix(f"{flex}_")
    longer = (other for other in model.names.declared.get("flex", ()) if len(other) > len(flex))
    is_made = end != used and (end == "twist" or end[-1:].isdigit())
    return is_made and not any(used.startswith(f"{other}_") for other in longer)


def twisted_by(joint: str) -> str:
    """Return the name of the rod that a joint twists according to its name, or an empty text.

    >>> twisted_by("rope_twist_0"), twisted_by("rope_twist"), twisted_by("twist")
    ('rope', 'rope', '')
    """
    # MuJoCo 4.0 finds the joints in which a `<flex name="rope" dim="1">` is twisted by these names alone.
    start, _, end = joint.rpartition("_twist")
    return start if not end or end[1:].isdigit() else ""


def is_rod(flex: Node) -> bool:
    """Return whether this is a `<flex>` of one dimension."""
    return flex.tag == "flex" and str(flex.get("dim") or "").strip() == "1"


def multiplies(node: Node) -> bool:
    """Return whether MuJoCo creates several names from the element's own."""
    return node.tag in ("flexcomp", "composite") or next(node.iterancestors("replicate"), None) is not None


def is_copy(other: str, name: str) -> bool:
    """Return whether MuJoCo makes a name from another one by appending numbers.

    >>> is_copy("pad_012", "pad"), is_copy("pad3_0", "pad3"), is_copy("padding", "pad")
    (True, True, False)
    """
    return other.startswith(name) and len(other) > len(name) and other[-1].isdigit()


def resolves(model: NameLookup, namespace: str, name: str) -> bool:
    """Return whether a name exists in the model; names that MuJoCo may create itself count."""
    is_declared = (namespace, name) in ALWAYS or model.find_node(namespace, name) is not None
    return is_declared or model.may_generate(name)


def unresolved(
    model: NameLookup,
    namespace: str,
    name: str,
    span: Span | None,
    *,
    written: str = "{}",
    typed_by: str = "",
    purpose: str = "",
    message: str | None = None,
    help: str | None = None,
    notes: Iterable[Note] = (),
) -> Diagnostic:
    """Return the error for a missing name: existing names, the likely one, and other kinds with the name.

    `written` is the format of a name in the file, and `typed_by` is the attribute next to it that sets the kind.
    `purpose`, `message` and `help` are as in `unknown_name`; `notes` come first.
    """
    others = [kind for kind in model.kinds_of(name) if kind != namespace]
    # A name that exists with another kind is hardly misspelled.
    fix = None if help is not None or others else renaming(name, model.known_names(namespace))
    types = [kind for kind in others if GRAMMAR.objtypes.get(kind) == kind]
    if help is None and typed_by and types:
        help = f"`{name}` is {word(types[0], article=True)}: write `{typed_by}: {types[0]}`"
    found = unknown_name(
        word(namespace),
        name,
        model.known_names(namespace),
        span=span,
        purpose=purpose,
        message=message,
        written=written,
        help=help,
    )
    if found.help is None:
        notes = (*notes, *(Note(f"`{name}` is {word(kind, article=True)}") for kind in others[:1]))
    return dataclasses.replace(found, notes=(*notes, *found.notes), fix=fix)


@contextmanager
def changing(model: Editable, node: Node) -> Iterator[None]:
    """Update the names of the model after a change of one element in the block."""
    model.forget(node)
    try:
        yield
    finally:
        model.note(node)


def assign(model: Editable, node: Node, texts: Mapping[str, str | None]) -> None:
    """Write attributes of an element of the model; None removes an attribute."""
    with changing(model, node):
        replace(node, texts)


def replace(node: Node, texts: Mapping[str, str | None]) -> None:
    """Write attributes that hold no names; None removes an attribute.

    There are five attributes for an orientation; each replaces the others.

    >>> from lxml import etree
    >>> geom = etree.fromstring('<geom size="1" euler="0 0 90"/>')
    >>> replace(geom, {"size": None, "quat": "1 0 0 0"})
    >>> etree.tostring(geom)
    b'<geom quat="1 0 0 0"/>'
    """
    for name, text in texts.items():
        gone = ORIENTATIONS if name in ORIENTATIONS and text is not None else (name,) if text is None else ()
        for each in gone:
            journal.drop(node, each)
        if text is not None:
            journal.write(node, name, text)


class NewName(NamedTuple, Generic[M]):
    """A name of a model, by namespace, and its new name."""

    model: M
    namespace: str
    old: str
    new: str


class Renaming(Struct, Generic[M]):
    """Old and new texts of references to renamed elements, by model and namespace.

    It is created before the first name changes, and applied after all names have changed, so two names can be swapped.
    """

    followed: dict[tuple[M, str], dict[str, str]] = field(default_factory=dict)

    @classmethod
    def of(cls, names: Iterable[NewName[M]]) -> Renaming[M]:
        """Return the references to these names, including references to elements that MuJoCo makes from them."""
        renaming: Renaming[M] = cls()
        for model, namespace, old, new in names:
            for here, prefix, kind, used in uses_of(model, namespace, old):
                renaming._note(here, kind, used, old=prefix + old, new=prefix + new)
        return renaming

    @classmethod
    def of_prefix(cls, model: M, old: str, new: str) -> Renaming[M]:
        """Return the references to everything with a prefix in a model that is not its own."""
        renaming: Renaming[M] = cls()
        for here, prefix in model.levels():
            for namespace, uses in here.names.uses.items():
                own = here.names.declared.get(namespace, {})
                for used in uses:
                    if used.startswith(prefix + old) and used not in own:
                        renaming._note(here, namespace, used, old=prefix + old, new=prefix + new)
        return renaming

    def _note(self, model: M, namespace: str, used: str, old: str, new: str) -> None:
        self.followed.setdefault((model, namespace), {})[used] = new + used[len(old) :]

    def unlistable(self) -> Iterator[tuple[NameReference[M], str]]:
        """Yield references in lists of names whose new name has a space, which a list cannot hold."""
        for (model, namespace), names in self.followed.items():
            for old, new in names.items():
                if len(new.split()) != 1:
                    for node, attribute in model.names.users(namespace, old):
                        if is_list(node, attribute, section_of(node)):
                            yield NameReference(model, node, attribute, namespace=namespace, name=old), new

    def carry_out(self) -> None:
        """Write the new names into all references."""
        for (model, namespace), names in self.followed.items():
            model.names.follow(namespace, names)


def unlistable_message(reference: NameReference[M], new: str, called: str) -> str:
    """Return the message about a new name that a list of names in this element cannot hold."""
    cannot = f"`{reference.name}` cannot be called `{new}`"
    return f"{cannot}: {called} has it in a list of names, which cannot hold one with a space"


class Removal(Struct, Generic[M]):
    """The outermost removed elements, each with its model, and the remaining references to them."""

    going: tuple[tuple[M, Node], ...]
    references: tuple[NameReference[M], ...]

    @classmethod
    def of(cls, nodes: Iterable[tuple[M, Node]]) -> Removal[M]:
        """Return the removal of these elements alone."""
        going = _outermost(nodes)
        inside = {element for _, node in going for element in node.iter("*")}
        references: dict[NameReference[M], None] = {}
        for model, node in going:
            for namespace, name in model.names_of(node):
                owner = model.names.find(namespace, name)
                if owner is None or owner in inside:  # else another element of that name keeps its references
                    references |= dict.fromkeys(
                        reference for reference in referrers(model, namespace, name) if reference.node not in inside
                    )
        return cls(going, tuple(references))

    def with_referrers(self) -> Removal[M]:
        """Return the removal with all elements that depend on removed ones; the remaining references can be dropped."""
        removal = self
        while needing := [each for each in removal.references if not can_do_without(each.node, each.namespace)]:
            removal = Removal.of([*removal.going, *((each.model, whole(each.node)) for each in needing)])
        return removal

    def drop_references(self) -> None:
        """Remove the attributes that refer to removed elements."""
        for model, node, attribute, *_ in self.references:
            assign(model, node, {attribute: None})


def _outermost(nodes: Iterable[tuple[M, Node]]) -> tuple[tuple[M, Node], ...]:
    models = {node: model for model, node in nodes}
    return tuple((model, node) for node, model in models.items() if models.keys().isdisjoint(node.iterancestors()))


def unused_instances(root: Node, names: Iterable[str]) -> list[Node]:
    """Return the plugin instances of these names that no element uses.

    MuJoCo 4.0 refuses the `mujoco.pid` of no actuator: "actuator not found for plugin instance 0".
    """
    sought = set(names)
    if not sought:
        return []
    sought -= {str(each.get("instance")) for each in root.iter("*") if each.get("instance")}
    return [each for each in root.iterfind("extension/plugin/instance") if each.get("name") in sought]


def whole(node: Node) -> Node:
    """Return the smallest meaningful element around a node: a section's child, or the node itself in the body tree."""
    if section_of(node) == WORLD_SECTION:
        return node
    while (parent := node.getparent()) is not None and not is_section(parent):
        node = parent
    return node


def is_section(node: Node) -> bool:
    parent = node.getparent()
    return parent is not None and parent.tag == ROOT


def can_do_without(node: Node, namespace: str) -> bool:
    """Return whether an element works without its reference to something of that namespace."""
    # Without its class or its material it still does, but not without anything else that it names.
    return namespace in ("default", "material") or section_of(node) == "default"


def names_in(node: Node) -> list[tuple[str, str]]:
    """Return namespace and name of everything that an element and its contents declare."""
    section = section_of(node)
    found = [declaration(each, section) for each in node.iter("*") if not is_section(each)]
    return [each for each in found if each is not None]
