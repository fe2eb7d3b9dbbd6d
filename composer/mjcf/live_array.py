"""Arrays for the numbers of an attribute; changes to an array are written to the element."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from composer.diagnostics.call_site import call_site
from composer.mjcf.errors import failure


class Owner(Protocol):
    """The interface of an element that its arrays use."""

    def get(self, attribute: str) -> Any: ...
    def set_attributes(self, **attributes: object) -> None: ...
    def _described(self) -> str: ...


class LiveArray(np.ndarray[Any, Any]):
    """The value of an attribute with several numbers.

    Assigned items, and `+=` and the like, are set on the element and checked like any value; an error is an
    `MjcfError` and changes nothing. Results computed from it, and its copies, are plain arrays. It has the numbers
    of the time it was read; slices of it (`pos[:2]`) are read-only.
    """

    _owner: tuple[Owner, str] | None

    @classmethod
    def of(cls, array: NDArray[Any], element: Owner, attribute: str) -> LiveArray:
        """Return a live array for an element's attribute that shares the memory of `array`."""
        live = array.view(cls)
        live._owner = element, attribute
        live.flags.writeable = False
        return live

    def __array_finalize__(self, source: object) -> None:
        self._owner = None

    def __array_wrap__(self, array: Any, context: Any = None, return_scalar: bool = False) -> Any:
        return array.view(np.ndarray) if array.ndim else array[()]

    def __setitem__(self, key: Any, value: Any) -> None:
        if self._owner is None:
            try:
                super().__setitem__(key, value)
            except ValueError:
                if self.flags.writeable:
                    raise
                raise failure(
                    "wrong-type",
                    "a part of an attribute's array cannot be written to by itself",
                    call_site(),
                    help="write to the whole array, `element.pos[:2] = …`, or to a `copy()`",
                ) from None
            return
        element, attribute = self._owner
        now = element.get(attribute)
        changed = np.array(self if np.shape(now) != self.shape else now, dtype=np.float64)
        try:
            changed[key] = value
        except (TypeError, ValueError) as fault:
            raise self._refused(fault) from None
        element.set_attributes(**{attribute: changed})
        self.flags.writeable = True
        super().__setitem__(..., changed)
        self.flags.writeable = False

    def _refused(self, fault: Exception) -> Exception:
        element, attribute = self._owner or (None, "")
        what = "an array" if element is None else f"`{attribute}` of {element._described()}"
        return failure("wrong-type", f"{what} cannot take this: {fault}", call_site())

    def __repr__(self) -> str:
        return repr(self.view(np.ndarray))

    def __str__(self) -> str:
        return str(self.view(np.ndarray))

    def copy(self, order: Any = "C") -> Any:
        """Return a plain, writable array. Changes to it do not reach the element."""
        return np.array(self, order=order)

    def __copy__(self) -> Any:
        return np.array(self)

    def __deepcopy__(self, memo: dict[int, Any] | None, /) -> Any:
        return np.array(self)

    def __reduce__(self) -> Any:
        return np.array(self).__reduce__()


def _in_place(name: str) -> Callable[[LiveArray, Any], LiveArray]:
    compute = getattr(operator, name)

    def method(array: LiveArray, other: Any) -> LiveArray:
        try:
            changed = compute(array.view(np.ndarray), other)
        except (TypeError, ValueError) as fault:
            raise array._refused(fault) from None
        array[...] = changed
        return array

    return method


for _name in ("add", "sub", "mul", "truediv", "floordiv", "mod", "pow"):
    setattr(LiveArray, f"__i{_name}__", _in_place(_name))
