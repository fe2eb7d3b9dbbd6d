"""The key of a model in the build cache: everything that determines the result besides the contents of files.

The cache is searched twice. The first key, before anything is read, has the path of the recipe, the options and the
versions, and the recipe is one of the files that must be unchanged. This takes a quarter of the time for reading
and planning the recipe. The second key, after planning, is `of_plan`, with the concrete recipe instead of the path
and the given values; it still matches if the recipe file changed in ways that do not matter.

Files of `--set-file` are in the key with their contents, so messages can name the changed value.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import stat
import sys
import time
from collections.abc import Iterator, Mapping
from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING

from mjcompose.base import __version__, files
from mjcompose.base.dataclass import Struct
from mjcompose.base.files import open_regular
from mjcompose.language.target_names import CONSUMERS
from mjcompose.sources import blobs
from mjcompose.sources.blobs import key_of
from mjcompose.sources.kinds import KINDS
from mjcompose.sources.license import license_names
from mjcompose.sources.reference import Source

if TYPE_CHECKING:
    from mjcompose.plan.plan import Plan
    from mjcompose.text.node import Node

_PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))


def tool_version(store: Path) -> str:
    """Return the version and a hash of all files of the package, which is kept by their sizes and times."""
    stamp = hashlib.sha256(repr(list(_files())).encode()).hexdigest()
    known = blobs.get(store, "asked", stamp)
    if known is not None:
        return known.decode()
    whole = hashlib.sha256()
    for path, *_ in _files():
        whole.update(os.path.relpath(path, _PACKAGE).encode())
        with open(path, "rb") as stream:
            whole.update(hashlib.sha256(stream.read()).digest())
    version = f"{__version__} ({whole.hexdigest()[:16]})"
    with contextlib.suppress(OSError):  # reported when a model is stored
        blobs.put(store, "asked", stamp, content=version.encode())
    return version


def _files() -> Iterator[tuple[str, int, int]]:
    """Yield path, size and time of each file that affects builds."""
    yield from _below(_PACKAGE)
    with contextlib.suppress(OSError):
        # The grammar's place in a checkout.
        yield _stamped(os.path.join(os.path.dirname(_PACKAGE), "schemas", "mjcf.json"))


def _below(folder: str) -> Iterator[tuple[str, int, int]]:
    entries: list[os.DirEntry[str]] = []
    with contextlib.suppress(OSError):
        entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
    for entry in entries:
        if entry.is_dir():
            if entry.name != "__pycache__":
                yield from _below(entry.path)
        elif entry.name.endswith((".py", ".json", ".yaml")):
            yield _stamped(entry.path)


def _stamped(path: str) -> tuple[str, int, int]:
    status = os.stat(path)
    return path, status.st_size, status.st_mtime_ns


Stamp = tuple[int, int, int, int]
"""Data that changes with a file as far as `stat` shows: size, times of the last change of content and of the inode
in ns, and inode.
"""

ABSENT = ""
# A file that changed this recently may change again without a new stamp, so its content is compared.
_SETTLED = 2_000_000_000


class FileState(Struct):
    """The state of a path: the sha256 of a file, the names of a folder's licenses, or `ABSENT`."""

    path: str
    state: str
    stamp: Stamp | None

    def as_data(self) -> list[object]:
        return [self.path, self.state, self.stamp]


def file_state(data: list[object]) -> FileState:
    """Parse the result of `as_data`. Raises TypeError and ValueError for anything else."""
    path, state, stamp = data
    if not isinstance(path, str) or not isinstance(state, str):
        raise TypeError(data)
    return FileState(path, state, tuple(stamp) if isinstance(stamp, list) else None)


class FileStates(Struct, frozen=False):
    """Looks at every file once until `forget`, and reads it again only if its stamp changed."""

    _stamps: dict[str, tuple[Stamp, bool] | None] = field(default_factory=dict)
    _states: dict[tuple[str, Stamp], str] = field(default_factory=dict)

    def look(self, path: str) -> FileState:
        stamped = self._stamp(path)
        if stamped is None:
            return FileState(path, ABSENT, None)
        stamp, is_folder = stamped
        key = path, stamp
        if key not in self._states:
            try:
                self._states[key] = license_names(path) if is_folder else _sha256(path)
            except OSError:
                self._states[key] = ABSENT
        settled = max(stamp[1], stamp[2]) + _SETTLED < time.time_ns()
        return FileState(path, self._states[key], stamp if settled else None)

    def forget(self) -> None:
        """Look at files again from now on."""
        self._stamps.clear()

    def is_same(self, before: FileState) -> bool:
        stamped = self._stamp(before.path)
        if stamped is None or before.stamp is None or stamped[0] != before.stamp:
            return self.look(before.path).state == before.state
        return True

    def changed_since(self, path: str, moment: int) -> bool:
        """Return whether a file was written after a moment, in ns since 1970."""
        stamped = self._stamp(path)
        return stamped is not None and not stamped[1] and max(stamped[0][1:3]) > moment

    def _stamp(self, path: str) -> tuple[Stamp, bool] | None:
        if path not in self._stamps:
            self._stamps[path] = None
            with contextlib.suppress(OSError, ValueError):
                status = os.stat(path)
                self._stamps[path] = stamp_of(status), stat.S_ISDIR(status.st_mode)
                if not stat.S_ISDIR(status.st_mode):
                    files.current().note((path,))
        return self._stamps[path]


def stamp_of(status: os.stat_result) -> Stamp:
    return status.st_size, status.st_mtime_ns, status.st_ctime_ns, status.st_ino


def now() -> int:
    """Return the file system's time in ns since 1970: later writes are not older."""
    coarse = getattr(time, "CLOCK_REALTIME_COARSE", None)
    return time.time_ns() if coarse is None else time.clock_gettime_ns(coarse)


def _sha256(path: str) -> str:
    with open_regular(path) as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


class CacheKey(Struct):
    """The key of a model: its `parts`, by their names for the user, and the `subject`, independent of them."""

    subject: str
    parts: Mapping[str, str]

    @property
    def digest(self) -> str:
        return key_of([self.subject, sorted(self.parts.items())])

    @property
    def subject_digest(self) -> str:
        return key_of([self.subject])

    def of_cell(self, name: str, values: Mapping[str, str]) -> CacheKey:
        return CacheKey(f"{self.subject}: {name}", {**self.parts, **values})

    def of_plan(self, plan: Plan, cell: str | None, choices: Mapping[str, str]) -> CacheKey:
        """Return the key of a plan, independent of the recipe file; `choices` are part of the plan already."""
        parts = {name: value for name, value in self.parts.items() if name not in choices}
        planned = {"cell": cell or "", "sample": str(plan.sample), "plan": key_of(plan_content(plan))}
        return CacheKey("", {**parts, **planned})


class BuildOptions(Struct):
    """The options of builds. `text_beside` is the folder of a text; `choices` are values by names for the user."""

    verified: bool = True
    deduplicated: bool = False
    text_beside: Path | None = None
    choices: Mapping[str, str] = field(default_factory=dict)
    locked: bool = False
    offline: bool = False
    pictured: bool = False
    target: str | None = None
    worlds: bool = False

    def key(self, recipe: Path, folder: Path, environment: Mapping[str, str], store: Path) -> CacheKey:
        """Return the key of the model of a recipe file, with these options."""
        flags = {
            "`--no-compile`": not self.verified,
            "`--dedup`": self.deduplicated,
            "`--locked`": self.locked,
            "`--offline`": self.offline,
            "`--picture`": self.pictured,
            "`--as worlds`": self.worlds,
        }
        parts = {name: GIVEN for name, given in flags.items() if given}
        if self.target is not None:
            parts["`--target`"] = self.target
        if self.text_beside is not None:
            parts["the folder of the text"] = os.fspath(self.text_beside)
        # Variables that decide which file a model reference names, or which program reads a model back.
        variables = sorted({CONSUMERS, *(name for kind in KINDS for name in kind.variables)})
        parts |= {
            "the current folder": os.fspath(folder),
            "mjcompose": tool_version(store),
            "Python": f"{sys.version.split()[0]} in {sys.prefix}",
            **{f"the variable `{name}`": environment[name] for name in variables if name in environment},
            **self.choices,
        }
        return CacheKey(os.path.abspath(folder / recipe), parts)


def plan_content(plan: Plan) -> list[object]:
    """Return the inputs that determine the result of a plan, without contents of files and places, as JSON. No I/O."""
    found: list[object] = []
    for each in plan.plans():
        scope = [[name, repr(value)] for name, value in sorted(each.scope.items())]
        values = list(_values(each.document, ""))
        read = [[file, settings.angle, settings.eulerseq] for file, settings in each.angle_context.others.items()]
        found.append([each.name, str(each.path), scope, values, read, [_source(part.model) for part in each.members]])
    return found


def _source(model: Plan | Source | None) -> object:
    if not isinstance(model, Source):
        return model is None
    licenses, packages = [map(str, model.licenses), ((name, str(path)) for name, path in model.packages)]
    about = [str(model.path), model.kind.name, model.reference, model.package, model.version]
    origin = model.origin.id if model.origin else None
    return [
        *about,
        list(licenses),
        list(packages),
        repr(model.urdf),
        list(model.compiler),
        origin,
        list(model.door.roots),
    ]


def _values(node: Node, file: str) -> Iterator[object]:
    from mjcompose.text.node import Mapping, Scalar, Sequence  # a model that is known has no use for it

    if node.span.file != file:
        file = node.span.file
        yield ["in", file]
    if isinstance(node, Scalar):
        yield [node.text, node.plain, repr(node.value)]
        return
    yield "{" if isinstance(node, Mapping) else "["
    if isinstance(node, Sequence):
        for item in node.items:
            yield from _values(item, file)
    if isinstance(node, Mapping):
        for name, (_, value) in node.entries.items():
            yield name
            yield from _values(value, file)
    yield "."


GIVEN = "yes"
"""The value of an option without a value."""

_OPTION = "`--set-file "
_MOST = 1 << 16
_TEXT = "text:"


def differences(before: Mapping[str, str], after: Mapping[str, str]) -> tuple[str, ...]:
    """Return one line for each changed part of a key, sorted by name. No I/O.

    >>> differences({"`payload`": "1", "mjcompose": "a"}, {"`payload`": "2", "`--dedup`": "yes", "mjcompose": "a"})
    ('`--dedup` is given', '`payload` was 1, is 2')
    """
    changes: list[str] = []
    for name in sorted({*before, *after}):
        was = before.get(name)
        now = after.get(name)
        if was == now:
            continue
        if name.startswith(_OPTION):
            changes += value_changes(name, was, now)
        elif was is None:
            changes.append(f"{name} is given" if now == GIVEN else f"{name} is {now}")
        elif now is None:
            changes.append(f"{name} is no longer given" if was == GIVEN else f"{name} was {was}")
        else:
            changes.append(f"{name} was {was}, is {now}")
    return tuple(changes)


def name_of(file: object) -> str:
    """Return the name of a file of values in a key. No I/O."""
    return f"{_OPTION}{file}`"


def content_of(data: bytes) -> str:
    """Return the content of such a file for a key: its text, or its sha256 if it is large or not text. No I/O."""
    if len(data) <= _MOST:
        with contextlib.suppress(UnicodeDecodeError):
            return _TEXT + data.decode()
    return hashlib.sha256(data).hexdigest()


def value_changes(name: str, was: str | None, now: str | None) -> Iterator[str]:
    r"""Yield one line for each changed value of such a file. No I/O.

    >>> list(value_changes("`--set-file a.yaml`", "text:load: 1\npose: [1, 2]\n", "text:load: 2\npose: [1, 2]\n"))
    ['`load` in `a.yaml` was 1, is 2']
    """
    if was is None or now is None:
        yield f"{name} is {'no longer ' if now is None else ''}given"
        return
    file = f"`{name.removeprefix(_OPTION)}"
    before = _values_by_name(was)
    after = _values_by_name(now)
    if before is None or after is None:
        yield f"{file} changed, but it is unknown which of its values"
    elif before == after:
        yield f"{file} changed, but none of its values"
    else:
        for each in sorted({*before, *after}):
            old = before.get(each)
            new = after.get(each)
            if new is None:
                yield f"`{each}` in {file} was {old} and does not exist now"
            elif old != new:
                yield f"`{each}` in {file} " + (f"is {new}, is new" if old is None else f"was {old}, is {new}")


def _values_by_name(content: str) -> dict[str, str] | None:
    """Return the values by name as written, or None if they are unknown."""
    if not content.startswith(_TEXT):
        return None
    from mjcompose.base.sink import Sink
    from mjcompose.text.load import load
    from mjcompose.text.node import Mapping, Scalar, to_python

    node = load(content.removeprefix(_TEXT), "", Sink())
    if not isinstance(node, Mapping):
        return None
    return {
        name: value.text if isinstance(value, Scalar) else json.dumps(to_python(value), ensure_ascii=False)
        for name, (_, value) in node.entries.items()
    }
