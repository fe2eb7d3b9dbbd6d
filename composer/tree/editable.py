"""The interface of a model for edits, and references to its names."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Generic, NamedTuple, Protocol, Self, TypeVar

from lxml.etree import _Element as Node

from composer.tree.name_index import NameIndex


class Lookup(Protocol):
    """Looks up names in a model and in what is attached to it."""

    def find_node(self, namespace: str, name: str) -> Node | None:
        """Return the element of that name, in this model or in what is attached to it."""

    def known_names(self, namespace: str) -> Iterable[str]:
        """Return every name of a namespace that the model can refer to."""

    def kinds_of(self, name: str) -> Iterable[str]:
        """Return the namespaces in which the name exists."""

    def may_generate(self, name: str) -> bool:
        """Return whether MuJoCo may create the name itself, as for the copies of a `<replicate>`."""


class Editable(Lookup, Protocol):
    """One tree with its names, which edits keep up to date, and the models that it is attached to.

    A recipe edits one flat tree. `composer.mjcf` edits a tree of models: in outer models, names have a prefix.
    """

    @property
    def names(self) -> NameIndex:
        """The names of its own tree."""

    def levels(self) -> Iterator[tuple[Self, str]]:
        """Yield the model, then those it is attached to, each with the prefix that this model's names have there."""

    def names_of(self, node: Node) -> Iterable[tuple[str, str]]:
        """Return namespace and name of everything that belongs to an element."""

    def forget(self, node: Node) -> None:
        """Drop the names of a node before it changes."""

    def note(self, node: Node) -> None:
        """Add the names of a node after it has changed."""


M = TypeVar("M", bound=Editable)


class Reference(NamedTuple, Generic[M]):
    """An element of `model` that refers to a name by an attribute, as that model writes it."""

    model: M
    node: Node
    attribute: str
    namespace: str
    name: str


def referrers(model: M, namespace: str, name: str) -> Iterator[Reference[M]]:
    """Yield the references to a name of the model: in its own tree, and in the models that it is attached to.

    A rod, a `<flex>` of one dimension, refers to its twists by their names.
    """
    for here, _, kind, used in uses_of(model, namespace, name):
        for node, attribute in here.names.users(kind, used):
            yield Reference(here, node, attribute, namespace=kind, name=used)
    rod = model.find_node("flex", twisted_by(name)) if namespace == "joint" and twisted_by(name) else None
    if rod is not None and is_rod(rod):
        yield Reference(model, rod, "name", namespace=namespace, name=name)


def uses_of(model: M, namespace: str, name: str) -> Iterator[tuple[M, str, str, str]]:
    """Yield the texts by which models refer to a name: each model, the prefix there, the namespace and the whole text.

    Besides the name itself these are the names of the copies that MuJoCo makes, and of the bodies and joints that it
    makes of a `<flexcomp>`.
    """
    node = model.find_node(namespace, name)
    has_copies = node is not None and multiplies(node)
    kinds = (namespace, "body", "joint") if node is not None and node.tag == "flexcomp" else (namespace,)
    for here, prefix in model.levels():
        full = prefix + name
        yield here, prefix, namespace, full
        for kind in kinds if has_copies else ():
            for used in list(here.names.uses.get(kind, ())):
                of_it = is_copy(used, full) if kind == namespace else _is_of_flex(here, used, full)
                if of_it and here.find_node(kind, used) is None:
                    yield here, prefix, kind, used


def _is_of_flex(model: Editable, used: str, flex: str) -> bool:
    """Return whether MuJoCo makes the name of a body or joint for a `<flexcomp>`, and not for another one."""
    # It calls them `cloth_0`, `rod_twist_0` and `rod_twist`; in a `<replicate>` the number of the copy follows.
    end = used.removeprefix(f"{flex}_")
    if end == used or not (end == "twist" or end[-1:].isdigit()):
        return False
    return not any(
        len(other) > len(flex) and used.startswith(f"{other}_")
        for other in model.names.declared.get("flex", ())
    )


def twisted_by(joint: str) -> str:
    """Return the name of the rod that a joint twists if there is such a rod, judged by its name, or an empty text.

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
