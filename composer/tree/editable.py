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
    """Yield the references to a name of the model: in its own tree, and in the models that it is attached to."""
    for here, _, used in uses_of(model, namespace, name):
        for node, attribute in here.names.users(namespace, used):
            yield Reference(here, node, attribute, namespace, used)


def uses_of(model: M, namespace: str, name: str) -> Iterator[tuple[M, str, str]]:
    """Yield the texts by which models refer to a name: each model, the prefix there, and the whole text.

    Besides the name itself these are the names of the copies that MuJoCo makes.
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
    """Return whether MuJoCo creates several names from the element's own."""
    return node.tag in ("flexcomp", "composite") or next(node.iterancestors("replicate"), None) is not None


def is_copy(other: str, name: str) -> bool:
    """Return whether MuJoCo makes a name from another one by appending numbers.

    >>> is_copy("pad_012", "pad"), is_copy("pad3_0", "pad3"), is_copy("padding", "pad")
    (True, True, False)
    """
    return other.startswith(name) and len(other) > len(name) and other[-1].isdigit()
