"""Rows of tables that other packages bring, by entry points.

A lookup starts with our own table. If the table lacks the word, the lookup searches the installed packages, and imports
only the module that the entry point names. A package registers a module like one of ours::

    [project.entry-points."mjcompose.checks"]
    height = "mjcompose_lab.height"
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, TypeVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import DiagnosticError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

Row = TypeVar("Row")
GROUPS = {
    "sources": "source kind",
    "checks": "check",
    "verbs": "verb",
    "targets": "target",
    "commands": "command",
    "datasheets": "data sheet",
}
"""The kind of a group's entry points, by the end of its name: `mjcompose.checks` are checks."""

CLASH = "extension-clash"
BROKEN = "extension-broken"
REFUSED = "extension-refused"


@dataclass(frozen=True, slots=True)
class Extension:
    """A row that was loaded: the package that brings it, the version of the package, and the files of its code."""

    package: str
    version: str
    files: tuple[str, ...]


LOADED: dict[tuple[str, str], Extension] = {}
"""The extensions that this process has loaded, by group and word."""


def names(group: str) -> dict[str, str]:
    """Return the words that installed packages register in a group, each with the packages. Nothing is imported."""
    return {name: ", ".join(map(_owner, entries)) for name, entries in sorted(_installed(group).items())}


def is_registered(group: str, word: str) -> bool:
    """Return whether an installed package registers the word. Nothing is imported."""
    return word in _installed(group)


def load(group: str, word: str) -> Any | None:
    """Import an extension, or return None if there is none. Raises DiagnosticError if it is ambiguous or broken."""
    entries = _installed(group).get(word)
    if entries is None:
        return None
    if len(entries) > 1:
        owners = " and ".join(f"`{_owner(each)}`" for each in entries)
        message = f"the {GROUPS[group]} `{word}` is registered by {owners}"
        raise DiagnosticError(CLASH, message, help="uninstall all of them except one")
    try:
        loaded = entries[0].load()
    except (Exception, SystemExit) as error:
        raise _broken(group, word, f"{type(error).__name__}: {' '.join(str(error).split())}") from error
    package = entries[0].dist
    assert package is not None
    LOADED[group, word] = Extension(package.name, package.version, tuple(_files(entries[0].module)))
    return loaded


class ExtensionTable(dict[str, Row]):
    """Our rows by their words; `[]` adds the row of another package if we have none.

    `in` and `get` load nothing, so a recipe loads nothing by itself. `attribute` is the name of the row in the module
    of an extension, or empty if the entry point names the row itself. `kind` is the class of the row. Our rows may also
    be `modules`, in which the row has the same name; `[]` imports the module. If the row is the form of something, the
    module of an extension has its effect, too: a function with one of the names in `effects`.

    >>> table = ExtensionTable("checks", {"mass": 1}, "KIND", kind=int)
    >>> table["mass"], "height" in table
    (1, False)
    >>> ExtensionTable("checks", {}, "__name__", modules={"mass": "decimal"})["mass"]
    'decimal'
    """

    def __init__(
        self,
        group: str,
        rows: Mapping[str, Row],
        attribute: str,
        *,
        kind: type | None = None,
        modules: Mapping[str, str] | None = None,
        effects: Sequence[str] = (),
    ) -> None:
        super().__init__(rows)
        self.modules = modules or {}
        self.own = (*rows, *self.modules)
        self._group = group
        self._attribute = attribute
        self._kind = kind
        self._effects = effects

    def __contains__(self, word: object) -> bool:
        return super().__contains__(word) or word in self.modules

    def __iter__(self) -> Iterator[str]:
        return iter(dict.fromkeys((*self.own, *super().__iter__())))

    def __missing__(self, word: str) -> Row:
        if word in self.modules:
            ours: Row = getattr(import_module(self.modules[word]), self._attribute)
            self[word] = ours
            return ours
        loaded = load(self._group, word)
        if loaded is None:
            raise KeyError(word)
        row: Any = getattr(loaded, self._attribute, None) if self._attribute else loaded
        if not self._fits(row):
            what = f"`{self._attribute}` in its module" if self._attribute else "its object"
            expected = "a function" if self._kind is None else f"of the class `{self._kind.__name__}`"
            raise _broken(self._group, word, f"{what} is not {expected}")
        if self._effects and not any(callable(getattr(loaded, name, None)) for name in self._effects):
            names = " or ".join(f"`{name}`" for name in self._effects)
            raise _broken(self._group, word, f"its module has no function {names}")
        called = getattr(row, "word", None) or getattr(row, "name", None)
        if self._group != "commands" and called not in (None, word):
            raise _broken(self._group, word, f"its row calls itself `{called}`")
        fitting: Row = row
        self[word] = fitting
        return fitting

    def _fits(self, row: Any) -> bool:
        """Return whether an object is a row: a function, or an object or a subclass of the kind of the table."""
        if self._kind is None:
            return callable(row)
        return isinstance(row, self._kind) or (isinstance(row, type) and issubclass(row, self._kind))

    def load_all(self) -> Iterator[DiagnosticError]:
        """Add the rows of all installed packages, and yield the errors of those that cannot be loaded."""
        for word in _installed(self._group):
            try:
                self[word]
            except DiagnosticError as error:
                yield error


def versions(words: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Return the packages that brought the rows for words of groups, with their versions, sorted."""
    return dict(sorted({(each.package, each.version) for word in words if (each := LOADED.get(word))}))


def refuse(group: str, word: str, origin: str) -> DiagnosticError:
    """Return the error for a word of another package in a recipe that was fetched with `origin`."""
    owner = names(group)[word]
    help = "a fetched recipe loads no code: copy the part that you need into your own recipe"
    message = f"the {GROUPS[group]} `{word}` is code of `{owner}`, and `{origin}`, whose recipe names it, was fetched"
    return DiagnosticError(REFUSED, message, help=help)


def _broken(group: str, word: str, why: str) -> DiagnosticError:
    owner = names(group)[word]
    message = f"the {GROUPS[group]} `{word}` of the package `{owner}` cannot be loaded: {why}"
    return DiagnosticError(BROKEN, message, help=f"update or uninstall `{owner.partition(' ')[0]}`")


def _owner(entry: EntryPoint) -> str:
    return "?" if entry.dist is None else f"{entry.dist.name} {entry.dist.version}"


def _installed(group: str) -> Mapping[str, list[EntryPoint]]:
    path = tuple(sys.path)
    return _entries(group, path) if _are_there(path) else {}


@cache
def _are_there(path: tuple[str, ...]) -> bool:
    """Return whether a package on a path may have entry points of ours, without importing Python's own reader."""
    for folder in path:
        if os.path.isfile(folder):
            return True  # an archive, which that reader knows
        try:
            inside = os.listdir(folder or ".")
        except OSError:
            continue
        for name in inside:
            if name.endswith((".dist-info", ".egg-info")):
                with suppress(OSError), open(os.path.join(folder, name, "entry_points.txt"), "rb") as stream:
                    if b"[mjcompose." in stream.read().replace(b" ", b""):
                        return True
    return False


@cache
def _entries(group: str, path: tuple[str, ...]) -> dict[str, list[EntryPoint]]:
    from importlib.metadata import entry_points

    found: dict[str, list[EntryPoint]] = {}
    for each in entry_points(group=f"mjcompose.{group}"):
        found.setdefault(each.name, []).append(each)
    return found


def _files(module: str) -> Iterator[str]:
    """Yield the Python files next to an imported module, which may import them."""
    file = getattr(sys.modules.get(module), "__file__", None)
    if file is None:
        return
    if "." not in module:
        yield file
        return
    for folder, _, inside in os.walk(os.path.dirname(file)):
        yield from (os.path.join(folder, name) for name in sorted(inside) if name.endswith(".py"))


def check_rows(table: str, rows: Iterable[object], members: Iterable[object]) -> None:
    """Raise TypeError if the rows of a table are not exactly the members.

    >>> check_rows("words", ["set", "scale"], ["set", "scale"])
    >>> check_rows("words", ["set"], ["set", "scale"])
    Traceback (most recent call last):
    TypeError: words: no row for scale
    """
    rows = list(rows)
    members = list(members)
    missing = [_name(each) for each in members if each not in rows]
    unknown = [_name(each) for each in rows if each not in members]
    faults = [f"no row for {', '.join(missing)}"] if missing else []
    faults += [f"a row for {', '.join(unknown)}, which does not exist"] if unknown else []
    if faults:
        raise TypeError(f"{table}: {'; '.join(faults)}")


def _name(member: object) -> str:
    return member.__name__ if isinstance(member, type) else str(member)
