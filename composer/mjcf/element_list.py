"""The children of an element that have one tag: a list that can also be indexed by name."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import SupportsIndex, TypeVar, overload

from composer.diagnostics.call_site import call_site
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.unknown import unknown_name
from composer.mjcf.element import Element
from composer.mjcf.errors import MjcfKeyError, failed, failure

_E = TypeVar("_E", bound=Element)


class ElementList(Sequence[_E]):
    """The value of `body.geom`: the elements, by number or by name, at the time it was read.

    `del` and `clear()` remove elements from the model. To add elements, call `add` and `insert` of their parent.

    >>> from composer import mjcf
    >>> world = mjcf.RootElement().worldbody
    >>> ball = world.add('geom', name='ball', size=[0.1])
    >>> world.geom['ball'] is world.geom[0] is ball
    True
    >>> del world.geom['ball']
    >>> world.geom
    []
    """

    __slots__ = ("_elements", "tag")

    def __init__(self, tag: str, elements: Iterable[_E]) -> None:
        """For internal use. A list of elements is read from an attribute such as `body.geom`."""
        self.tag = tag
        self._elements = tuple(elements)

    @overload
    def __getitem__(self, index: SupportsIndex | str) -> _E: ...
    @overload
    def __getitem__(self, index: slice) -> list[_E]: ...
    def __getitem__(self, index: SupportsIndex | str | slice) -> _E | list[_E]:
        """Return an element by its index or by its name in its own model, or a list of elements for a slice.

        Raises `MjcfKeyError`, which is also a `KeyError`, if no element has the name.
        """
        if isinstance(index, slice):
            return list(self._elements[index])
        if not isinstance(index, str):
            return self._elements[index]
        for element in self._elements:
            if element.name == index:
                return element
        names = self._ipython_key_completions_()
        unnamed = Note(f"none of the {len(self)} elements here has a name: take them by number")
        message = f"the {self.tag} `{index}` does not exist here"
        found = unknown_name(self.tag, index, names, call_site(), message=message)
        raise failed(found if names or not self else replace(found, notes=(unnamed,)), MjcfKeyError)

    def __contains__(self, item: object) -> bool:
        """Return whether the list contains an element, or an element with this name."""
        if isinstance(item, str):
            return any(element.name == item for element in self._elements)
        return any(element is item for element in self._elements)

    def _ipython_key_completions_(self) -> list[str]:
        return [element.name for element in self._elements if element.name]

    def __delitem__(self, index: SupportsIndex | str | slice) -> None:
        """Remove an element, or several, from the model. See `Element.remove`."""
        found = self[index]
        for element in found if isinstance(found, list) else [found]:
            element.remove()

    def __setitem__(self, index: SupportsIndex | str | slice, value: object) -> None:
        """Raise `MjcfError`: elements of the list cannot be replaced. Set their attributes, or insert another one."""
        raise failure(
            "wrong-type",
            f"a {self.tag} of a list cannot be set",
            call_site(),
            help=f"set its attributes, or remove it and `insert('{self.tag}', position, …)` another one",
        )

    def clear(self) -> None:
        """Remove all elements of the list from the model."""
        del self[:]

    def __len__(self) -> int:
        return len(self._elements)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ElementList | list) and list(self) == list(other)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return repr(list(self._elements))
