"""The ids of the elements of one kind, by name."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.suggest import did_you_mean, exists_note
from composer.loading.errors import UnknownNameError
from composer.tree.pattern import BadPattern, fitter, is_pattern

Several: TypeAlias = tuple[str, ...] | list[str]
Names: TypeAlias = str | Several
"""One name or glob, or several of them."""


def unknown(kind: str, name: str, known: Iterable[str]) -> UnknownNameError:
    """Return the error for a name or a glob that matches nothing."""
    known = [each for each in known if each]
    return UnknownNameError(
        [
            Diagnostic(
                "unknown-name",
                f"the model has no {kind} `{name}`",
                notes=(exists_note(kind, known, name),),
                help=did_you_mean(name, known),
            )
        ]
    )


class Lookup:
    """The names of one kind in the order of the model, and their look-up by name or glob.

    `*` and `?` stop at the separator, `**` does not, `{a,b}` is a choice, `/…/` a regular expression over the whole
    name. An existing name always matches itself, whatever characters it has.
    """

    def __init__(self, kind: str, names: Sequence[str], separator: str) -> None:
        self.kind = kind
        self.names = tuple(names)
        self.separator = separator
        self._rows: dict[str, int] = {}
        for row, name in enumerate(self.names):
            if name:
                self._rows.setdefault(name, row)

    def row(self, name: str) -> int | None:
        """Return the row of one name, or None for a glob. Raises UnknownNameError."""
        found = self._rows.get(name)
        if found is None and not is_pattern(name):
            raise unknown(self.kind, name, self._rows)
        return found

    def rows(self, names: Names) -> list[int]:
        """Return the rows of all names, in their order; a glob has the order of the model."""
        if not isinstance(names, Iterable):
            raise TypeError(f"names are asked for, one or several, not {names!r}")
        found: list[int] = []
        for name in [names] if isinstance(names, str) else names:
            row = self.row(name)
            if row is not None:
                found.append(row)
                continue
            fits = self._fitter(name)
            matched = [row for known, row in self._rows.items() if fits(known)]
            if not matched:
                raise unknown(self.kind, name, self._rows)
            found += matched
        return found

    def _fitter(self, pattern: str) -> Callable[[str], bool]:
        try:
            return fitter(pattern, self._rows.keys, self.separator)
        except BadPattern as bad:
            raise UnknownNameError([Diagnostic("selector", bad.message, help=bad.help)]) from None

    def __contains__(self, name: object) -> bool:
        return name in self._rows

    def __iter__(self) -> Iterator[str]:
        return iter(self._rows)


class Numbers:
    """The id of each element of a kind in `mjModel`: `index.camera["overview"]`.

    One name gives an int; several names, or a glob, give an array of shape (n,).
    """

    def __init__(self, lookup: Lookup) -> None:
        self._lookup = lookup

    @property
    def names(self) -> tuple[str, ...]:
        """All names in the order of the model; unnamed elements are ""."""
        return self._lookup.names

    @overload
    def __getitem__(self, names: str) -> int: ...
    @overload
    def __getitem__(self, names: Several) -> NDArray[np.intp]: ...
    def __getitem__(self, names: Names) -> int | NDArray[np.intp]:
        """Return the id for a name, or the ids for several names or a glob. Raises UnknownNameError.

        For a glob the declared type is that of a name, int, although the result is an array.
        """
        if isinstance(names, str) and (row := self._lookup.row(names)) is not None:
            return row
        return np.array(self._lookup.rows(names), dtype=np.intp)

    def __contains__(self, name: object) -> bool:
        return name in self._lookup

    def __iter__(self) -> Iterator[str]:
        return iter(self._lookup)

    def __len__(self) -> int:
        return len(self._lookup.names)

    def __repr__(self) -> str:
        return f"<{len(self)} × {self._lookup.kind}>"
