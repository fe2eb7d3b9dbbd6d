"""The lock of a recipe as data and as a file, and sources that are resolved by it."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping as AbcMapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, StringConstraints, ValidationError

from mjcompose.base.access import Door
from mjcompose.base.diagnostic import DiagnosticError, Span
from mjcompose.base.files import CODE, Refused, read_regular
from mjcompose.base.limits import in_force
from mjcompose.base.naming import checked_name
from mjcompose.base.sink import Sink
from mjcompose.sources.fetching import Fetching, Lookup
from mjcompose.sources.kinds import EXTENDED, kind_called, parse
from mjcompose.sources.reference import PINS, Source, SourceError, SourceKind, check_reach
from mjcompose.text.load import load
from mjcompose.text.node import Mapping, Scalar, locate, to_python

FORMAT = 1
_Sha256 = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")]
_GitHash = Annotated[str, StringConstraints(pattern=r"^([0-9a-f]{40}|[0-9a-f]{64})$")]
_Name = Annotated[str, AfterValidator(checked_name)]
_Package = Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]*$")]
"""The name of a Python package, which messages put into commands to paste."""
_Version = Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9][A-Za-z0-9.+!_-]*$")]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, defer_build=True)


class Locked(_Part):
    """One source: a repository, an archive, a robot, a package, a file next to the recipe."""

    kind: _Name
    commit: _GitHash | None = None
    tree: _GitHash | None = None
    sha256: _Sha256 | None = None
    package: _Name | None = None
    version: _Name | None = None
    files: dict[str, _Sha256]
    licenses: list[str] = Field(default_factory=list)
    used_by: list[str] = Field(default_factory=list)

    @property
    def pin(self) -> str | None:
        """The commit or sha256 that fetches the same bytes again."""
        return self.commit or self.sha256


missing = {*PINS} - Locked.model_fields.keys()
if missing:
    raise TypeError(f"kinds of source pin {sorted(missing)}, and a lock has no such field")


class LockedName(_Part):
    """A joint, an actuator, a sensor or a key of the interface: its numbers in `qpos`, `ctrl` and so on, and ranges."""

    name: str
    type: str | None = None
    unit: str | None = None
    sizes: list[int] = Field(default_factory=list)
    ranges: list[list[float] | None] = Field(default_factory=list)


class Lock(_Part):
    """All sources of a recipe and its nested recipes, by id; file names are relative to the source.

    `mjcompose` and `mujoco` are the versions that made the lock. `shapes` has the sha256 of the result for
    each mesh that is kept next to the recipe, by its key. `extensions` has the versions of the other packages whose
    words the recipe uses, by their names.
    """

    lock: Literal[1] = 1
    mjcompose: _Version
    mujoco: _Version | None
    sources: dict[str, Locked]
    extensions: dict[_Package, _Version] = Field(default_factory=dict)
    shapes: dict[_Sha256, _Sha256] = Field(default_factory=dict)
    interface: dict[str, list[LockedName]] = Field(default_factory=dict)


def lock_path(recipe: Path) -> Path:
    """Return the path of a recipe's lock: next to it, `arm.lock` for `arm.yaml`. No I/O."""
    return recipe.with_suffix(".lock")


def shapes_folder(lock: Path) -> Path:
    """Return the folder of the shapes made from meshes: next to the lock, `arm.shapes` for `arm.lock`. No I/O."""
    return lock.with_suffix(".shapes")


_MERGE = re.compile(r"^<<<<<<<( |$)", re.MULTILINE)


def to_text(lock: Lock) -> str:
    """Return the lock as text; equal locks have equal texts. No I/O."""
    data = lock.model_dump(exclude_defaults=True)
    data["sources"] = {
        id: {**source, "files": dict(sorted(source["files"].items()))} for id, source in sorted(data["sources"].items())
    }
    if lock.shapes:
        data["shapes"] = dict(sorted(lock.shapes.items()))
    return json.dumps({"lock": FORMAT, **data}, indent=2, ensure_ascii=False) + "\n"


def kind_of(locked: Locked) -> SourceKind:
    """Return the row of a source's kind, which exists: a lock with an unknown kind is not read. No I/O."""
    kind = kind_called(locked.kind)
    assert kind is not None, locked.kind
    return kind


Disputed = dict[str, tuple[str, str]]
"""Sources that the two sides of a merge pin differently, with both pins in words."""


def read_lock(path: Path, shown: str, sink: Sink, disputes: Disputed | None = None) -> Lock | None:
    """Return the lock in a file, or None if it does not exist or cannot be read, which is reported to `sink`.

    If `disputes` is given, a lock with merge conflicts becomes the union of both sides; sources that they pin
    differently go into `disputes`.
    """
    try:
        text = read_regular(path, in_force().recipe_size)
    except FileNotFoundError:
        return None
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        sink.error("lock-invalid", f"the lock `{shown}` cannot be read: {why}")
        return None
    return from_text(text, shown, sink, disputes=disputes)


def from_text(text: bytes | str, shown: str, sink: Sink, disputes: Disputed | None = None) -> Lock | None:
    """Parse a lock; the first fault goes to `sink` with its place. No I/O."""
    plain = text.decode("utf-8", "replace") if isinstance(text, bytes) else text
    mark = _MERGE.search(plain)
    if mark is not None:
        return _in_a_merge(plain, mark.start(), shown, sink=sink, disputes=disputes)
    node = _mapping(text, shown, sink)
    if node is None:
        return None
    version = node.entries.get("lock")
    number = version[1] if version is not None else None
    if isinstance(number, Scalar) and isinstance(number.value, int) and number.value > FORMAT:
        message = f"`{shown}` was written by a newer mjcompose: its format is {number.value}, this one knows {FORMAT}"
        help = "update mjcompose, or remove the lock and run `mjcompose lock`"
        sink.error("lock-invalid", message, number.span, help=help)
        return None
    try:
        lock = Lock.model_validate(to_python(node))
    except ValidationError as error:
        fault = error.errors()[0]
        _report(fault["type"], tuple(fault["loc"]), node, shown=shown, sink=sink)
        return None
    if not _has_known_kinds(lock, node, shown, sink=sink):
        return None
    if version is None or not isinstance(number, Scalar) or type(number.value) is not int:  # in Python, `True == 1`
        _report("missing" if version is None else "", ("lock",), node, shown=shown, sink=sink)
        return None
    return lock


def _mapping(text: bytes | str, shown: str, sink: Sink) -> Mapping | None:
    """Return the keys of a lock, or None after an error."""
    own = Sink()
    node = load(text, shown, own)
    if own.errors:
        first = own.sorted()[0]
        sink.error("lock-invalid", f"`{shown}` is not a lock: {first.message}", first.span, help=_HELP)
        return None
    if not isinstance(node, Mapping):
        sink.error("lock-invalid", f"`{shown}` is not a lock", None if node is None else node.span, help=_HELP)
        return None
    return node


def _has_known_kinds(lock: Lock, node: Mapping, shown: str, sink: Sink) -> bool:
    """Return whether the kinds of all sources exist; if not, report the first unknown one and its package."""
    unknown = next((id for id, locked in lock.sources.items() if not _is_known(locked.kind)), None)
    if unknown is None:
        return True
    if not lock.extensions:
        _report("", ("sources", unknown, "kind"), node, shown=shown, sink=sink)
        return False
    packages = ", ".join(f"{name}=={version}" for name, version in lock.extensions.items())
    span = locate(node, ("sources", unknown, "kind"))
    message = f"`{shown}` needs the source kind `{lock.sources[unknown].kind}` of a package that is not installed"
    sink.error("lock-invalid", message, span, help=f"pip install {packages}")
    return False


def _is_known(kind: str) -> bool:
    try:
        return kind_called(kind) is not None or EXTENDED[kind] is not None
    except (KeyError, DiagnosticError):
        return False


def _in_a_merge(text: str, start: int, shown: str, sink: Sink, disputes: Disputed | None) -> Lock | None:
    if disputes is not None:
        ours, theirs = (from_text(side, shown, Sink()) for side in _sides(text))
        if ours is not None and theirs is not None:
            disputes.update(_disputed(ours, theirs))
            return _both(ours, theirs)
    line = text.count("\n", 0, start) + 1
    choice = "which keeps the pins of both sides" if disputes is None else "after you choose one side of the merge"
    help = f"run `mjcompose lock`, {choice}"
    message = f"`{shown}` contains the marks of a merge"
    sink.error("lock-invalid", message, Span(shown, line, 1, end_line=line, end_column=8), help=help)
    return None


_HELP = "take the lock from version control, or remove it and run `mjcompose lock`"


def _report(fault: str, path: tuple[str | int, ...], node: Mapping, shown: str, sink: Sink) -> None:
    key = fault in ("missing", "extra_forbidden")
    where = " / ".join(f"`{step}`" for step in path)
    problem = _PROBLEMS.get(fault, "has a wrong value")
    sink.error("lock-invalid", f"`{shown}` is not a lock: {where} {problem}", locate(node, path, key=key), help=_HELP)


_PROBLEMS = {
    "missing": "is missing",
    "extra_forbidden": "is not a key of a lock",
    "string_pattern_mismatch": "is not a hash",
}


def _sides(text: str) -> tuple[str, str]:
    r"""Return the text of each side of a file with conflict markers. No I/O.

    >>> _sides("a\n<<<<<<< HEAD\nb\n||||||| base\nc\n=======\nd\n>>>>>>> x\ne\n")
    ('a\nb\ne\n', 'a\nd\ne\n')
    """
    ours: list[str] = []
    theirs: list[str] = []
    writing: tuple[list[str], ...] = (ours, theirs)
    for line in text.splitlines(keepends=True):
        if line.startswith("<<<<<<<"):
            writing = (ours,)
        elif line.startswith("|||||||"):
            writing = ()
        elif line.startswith("======="):
            writing = (theirs,)
        elif line.startswith(">>>>>>>"):
            writing = (ours, theirs)
        else:
            for each in writing:
                each.append(line)
    return "".join(ours), "".join(theirs)


def _both(ours: Lock, theirs: Lock) -> Lock:
    sources = {**theirs.sources, **ours.sources}
    for id in ours.sources.keys() & theirs.sources.keys():
        mine = ours.sources[id]
        other = theirs.sources[id]
        joined = {name: sorted({*getattr(mine, name), *getattr(other, name)}) for name in ("licenses", "used_by")}
        sources[id] = mine.model_copy(update={"files": {**other.files, **mine.files}, **joined})
    return ours.model_copy(update={"sources": sources, "shapes": {**theirs.shapes, **ours.shapes}})


def _disputed(ours: Lock, theirs: Lock) -> dict[str, tuple[str, str]]:
    """Return the sources that the two sides pin differently, with both pins in words, except the user's own files."""
    found = {}
    for id, mine in ours.sources.items():
        other = theirs.sources.get(id)
        if other is None or kind_of(mine).is_local:
            continue
        if mine.pin != other.pin or mine.version != other.version:
            found[id] = (mine.pin or f"version {mine.version}", other.pin or f"version {other.version}")
        elif any(other.files.get(name, digest) != digest for name, digest in mine.files.items()):
            found[id] = ("some bytes", "other bytes")
    return found


def resolve(
    reference: str,
    *,
    relative_to: Path,
    environment: AbcMapping[str, str],
    fetching: Fetching | None = None,
    runs_code: bool = True,
) -> Source:
    """Find the file of a model reference and its licenses; fetch it if necessary.

    `relative_to` is the folder of the file that contains the reference, `environment` replaces the environment of the
    process, and `fetching` has the rules and the memory of the run. A reference in a fetched file must not name
    anything on this machine. Without `runs_code`, kinds that run code are refused. Raises SourceError.
    """
    fetching = Fetching() if fetching is None else fetching
    asking = fetching.around(relative_to)
    is_confined = asking is not None and asking.is_fetched
    is_confined = is_confined and not fetching.trust.allows(reference)
    parsed = parse(reference, asking.id if asking is not None and is_confined else None)
    kind = kind_called(parsed.kind.name)
    assert kind is not None, "what is parsed is of a kind"
    if kind.runs_code and not runs_code:
        message = f"`{reference}` runs code, which a recipe that MJCF attaches may not do"
        raise SourceError("source-outside", message, help="name the model in your own recipe")
    if not kind.is_fetched:  # another variable could change the result without the build cache noticing
        environment = {name: environment[name] for name in kind.variables if name in environment}
    if asking is not None and is_confined:  # `check_reach` admits trusted references
        check_reach(parsed, kind, asking, trust=fetching.trust, offline=fetching.offline)
    source = kind.resolve(parsed, Lookup(relative_to, environment, fetching, is_confined=is_confined))
    if source.origin is not None:
        fetching.origins[source.origin.id] = source.origin
        fetching.first.setdefault(source.origin.id, source)
        return _with_door(source, fetching.door_of_origin(source.origin))
    return _with_door(source, fetching.door_of_model(source.path))


def _with_door(source: Source, door: Door) -> Source:
    """Return the source with its door, after the door has admitted its file and its licenses, which may be links."""
    try:
        door.admit(source.path)
        for license in source.licenses:
            if license.is_symlink():
                door.admit(license)
    except Refused as refused:
        raise SourceError(CODE, refused.message(), refused.help) from None
    return replace(source, door=door)
