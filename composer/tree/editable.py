"""A model as edits see it, and who refers to a name in it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Generic, NamedTuple, Protocol, Self, TypeVar

from lxml.etree import _Element as Node

from composer.tree.name_index import NameIndex


class Lookup(Protocol):
    """Where names are looked up: a model, with what is attached to it."""

    def find_node(self, namespace: str, name: str) -> Node | None:
        """The element that a name means, of this model or of what is attached to it."""

    def known_names(self, namespace: str) -> Iterable[str]:
        """Every name of a namespace that the model can refer to."""

    def kinds_of(self, name: str) -> Iterable[str]:
        """The namespaces in which something has a name."""

    def may_generate(self, name: str) -> bool:
        """Whether MuJoCo may make the name itself, as it does for the copies of a `<replicate>`."""


class Editable(Lookup, Protocol):
    """One tree with its names, which edits keep up to date, and the models it is attached to.

    A recipe edits one flat tree. `composer.mjcf` edits a tree of models: in those above a name has a prefix.
    """

    @property
    def names(self) -> NameIndex:
        """The names of its own tree."""

    def levels(self) -> Iterator[tuple[Self, str]]:
        """The model, then those it is attached to, each with what stands before this model's names there."""

    def names_of(self, node: Node) -> Iterable[tuple[str, str]]:
        """Namespace and name of everything that goes with an element."""

    def forget(self, node: Node) -> None:
        """Drop the names of a node that is about to change."""

    def note(self, node: Node) -> None:
        """Take up the names of a node that has changed."""


M = TypeVar("M", bound=Editable)


class Reference(NamedTuple, Generic[M]):
    """An element of `model` that refers by an attribute to a name, as that model writes it."""

    model: M
    node: Node
    attribute: str
    namespace: str
    name: str


def referrers(model: M, namespace: str, name: str) -> Iterator[Reference[M]]:
    """Who refers to a name of the model: in its own tree, and in the models it is attached to."""
    for here, _, used in uses_of(model, namespace, name):
        for node, attribute in here.names.users(namespace, used):
            yield Reference(here, node, attribute, namespace, used)


def uses_of(model: M, namespace: str, name: str) -> Iterator[tuple[M, str, str]]:
    """The texts by which models refer to a name: each model, the prefix there, and the whole text.

    Beside the name itself these are the names of the copies that MuJoCo makes.
    """
    node = model.find_node(namespace, name)
    has_copies = node is not None and multiplies(node)
    for here, prefix in model.levels():
        full = prefix + name
        yield here, prefix, full
        if has_copies:
            for used in list(here.names.uses.get(namespace, ())):
                if is_copy(used, full) and here.find_node(namespace, used) is None:
                    yield here, prefix, used


def multiplies(node: Node) -> bool:
    """Whether MuJoCo makes several names of the element's own."""
    return node.tag in ("flexcomp", "composite") or next(node.iterancestors("replicate"), None) is not None


def is_copy(other: str, name: str) -> bool:
    """Whether a name is what MuJoCo makes of another one, with numbers behind it.

    >>> is_copy("pad_012", "pad"), is_copy("pad3_0", "pad3"), is_copy("padding", "pad")
    (True, True, False)
    """
    return other.startswith(name) and len(other) > len(name) and other[-1].isdigit()
