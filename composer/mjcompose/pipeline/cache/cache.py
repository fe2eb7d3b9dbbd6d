"""The build cache: a model is built again, and an output written again, only if something that it depends on changed.

    asked/    by the digest of a key, the files that were read and their hashes → a record, the last key of a
              subject; the last content of an output
    built/    records of successful builds
    raw/      files without a source, such as `model.xml`, by their sha256
    packed/   compressed files, by their sha256 and compression level

All entries are single files (`composer/mjcompose/sources/blobs.py`).
"""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, field, fields, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Fix, Note, Severity, Span
from mjcompose.base.files import read_regular
from mjcompose.base.sink import Sink
from mjcompose.bundle.bundle import CheckOutcome, LicenseRow, Location, is_address
from mjcompose.pipeline.cache.cache_key import CacheKey, FileState, FileStates, differences, file_state, stamp_of
from mjcompose.sources import blobs
from mjcompose.sources.blobs import key_of
from mjcompose.sources.store import ENTRY, KINDS, Store
from mjcompose.text.expression import Value
from mjcompose.tree.merged_settings import Adopted, known

if TYPE_CHECKING:
    from mjcompose.bundle.write import Packed


def _stamps(outputs: Iterable[str]) -> list[list[object]]:
    """Return the stamps of all files of outputs; empty if one does not exist."""
    found: list[list[object]] = []
    paths: list[str] = []
    for out in outputs:
        if is_address(out):
            from mjcompose.bundle.remote import stamps

            found += stamps(out)
        elif os.path.isdir(out):
            paths += [os.path.join(at, name) for at, _, names in os.walk(out) for name in names]
        else:
            paths.append(out)
    for path in sorted(paths):
        try:
            found.append([path, *stamp_of(os.lstat(path))])
        except OSError:
            return []
    return found


class KeptFile(Struct):
    """A file of a bundle; `source` is an input file with the same bytes, or None if the bytes are in the store."""

    path: str
    sha256: str
    size: int
    source: str | None


class KeptRecipe(Struct):
    """A recipe file, its name in the manifest, and its hash at the time."""

    path: str
    name: str
    sha256: str


class Facts(Struct, kw_only=True):
    """Facts of a built model that a run reports and the cache keeps.

    `mujoco` is the version that compiled it. `draws` are the numbers drawn for a sample, by table column. `cells` is
    the number of cells of the recipe's matrix if this model is none of them, and `cells_at` the place of the first.
    `adopted` are settings that it takes from its parts, `allowed` the codes that the recipe allows at its top,
    `excluded` is the number of pairs of bodies that `exclude: auto` or `touching` keeps from colliding.
    """

    name: str
    sha256: str
    sizes: Mapping[str, int] | None
    merged: Mapping[str, Mapping[str, str]]
    mujoco: str | None = None
    licenses: tuple[LicenseRow, ...] = ()
    draws: Mapping[str, Value] | None = None
    cells: int = 0
    cells_at: Span | None = None
    adopted: tuple[Adopted, ...] = ()
    allowed: tuple[str, ...] = ()
    excluded: int = 0

    def facts(self) -> dict[str, Any]:
        return {each.name: getattr(self, each.name) for each in fields(Facts)}


class Record(Facts, kw_only=True):
    """A record of a successful build.

    `text` is the hash of the model's text, if only that was requested. `recipes` are the recipe files, the outermost
    first. `places` is a hash of all positions in them, and `mentions_positions` says whether the record contains
    positions.
    """

    model: str
    files: tuple[KeptFile, ...]
    text: str | None
    diagnostics: tuple[Diagnostic, ...]
    checks: tuple[CheckOutcome, ...]
    recipes: tuple[KeptRecipe, ...]
    places: str
    mentions_positions: bool = False


def to_json(record: Record) -> bytes:
    data = asdict(replace(record, adopted=()))
    data["adopted"] = [(*each[:3], asdict(each.span), each.is_written) for each in record.adopted]
    # `default` is for sets.
    return json.dumps(data, ensure_ascii=True, default=sorted).encode()


def from_json(text: bytes) -> Record:
    """Parse the result of `to_json`. Raises ValueError, KeyError and TypeError for anything else."""
    data: dict[str, Any] = json.loads(text)
    data["files"] = tuple(KeptFile(**each) for each in data["files"])
    data["recipes"] = tuple(KeptRecipe(**each) for each in data["recipes"])
    data["licenses"] = tuple(LicenseRow(**{**each, "files": tuple(each["files"])}) for each in data["licenses"])
    data["diagnostics"] = tuple(map(_diagnostic, data["diagnostics"]))
    data["checks"] = tuple(
        CheckOutcome(
            **{**each, "span": _place(each["span"]), "diagnostics": tuple(map(_diagnostic, each["diagnostics"]))}
        )
        for each in data["checks"]
    )
    data["cells_at"] = _span(data["cells_at"])
    data["adopted"] = tuple(
        Adopted(path, value, tuple(parts), at=partial(known, _place(span)), is_written=is_written)
        for path, value, parts, span, is_written in data["adopted"]
    )
    data["allowed"] = tuple(data["allowed"])
    return Record(**data)


def _diagnostic(data: dict[str, Any]) -> Diagnostic:
    notes: dict[str, Any] = {
        kind: tuple(Note(each["message"], _span(each["span"])) for each in data[kind]) for kind in ("notes", "others")
    }
    fix = None if data["fix"] is None else Fix(**{**data["fix"], "span": _span(data["fix"]["span"])})
    return Diagnostic(
        data["code"],
        data["message"],
        _span(data["span"]),
        severity=Severity(data["severity"]),
        help=data["help"],
        subjects=frozenset(data["subjects"]),
        fix=fix,
        **notes,
    )


def _span(data: dict[str, Any] | None) -> Span | None:
    return None if data is None else _place(data)


def _place(data: dict[str, Any]) -> Span:
    return Span(**{**data, "source": _span(data["source"])})


_ANSWERS = 4
"""How many states of its files a key remembers, for switching to another branch and back."""

LOST = "what was kept of it is damaged or was removed"

Package = tuple[str, str, str]
"""Name, version, and a file that exists only in this version."""


class CacheAnswer(Struct):
    """The name of a record, and its dependencies besides the key."""

    record: str
    inputs: tuple[FileState, ...]
    packages: tuple[Package, ...]


class CacheLookup(Struct):
    """A record and the answer that names it; or, in words, why there is none."""

    record: Record | None = None
    answer: CacheAnswer | None = None
    why: tuple[str, ...] = ()


class Cache(Struct, frozen=False):
    """The build cache. `warn` reports errors on writing once, and `on_keep` gets everything that is stored."""

    store: Store
    warn: Callable[[str], None]
    files: FileStates = field(default_factory=FileStates)
    broken: bool = False
    grown: bool = False
    on_keep: Callable[[Record, Sequence[FileState]], None] | None = None

    def find(self, key: CacheKey) -> CacheLookup:
        """Return the record for a key, or why there is none."""
        answers = self._answers(key.digest)
        for answer in answers:
            if self._changes(answer):
                continue
            record = None
            text = blobs.get(self.store.folder, "built", answer.record)
            with contextlib.suppress(TypeError, ValueError, KeyError):
                record = None if text is None else from_json(text)
            if record is None:
                return CacheLookup(why=(LOST,))
            if answer != answers[0] or any(each.state and each.stamp is None for each in answer.inputs):
                # Move the answer to the front, with the current stamps of its files.
                now = replace(answer, inputs=tuple(self.files.look(each.path) for each in answer.inputs))
                if now != answers[0]:
                    self._write(key, [now, *(each for each in answers if each is not answer)])
            self._mark_used(answer)
            return CacheLookup(record, answer)
        if answers:
            return CacheLookup(why=tuple(self._changes(answers[0])))
        before = _read(self.store.folder, key.subject_digest)
        if not isinstance(before, dict):
            return CacheLookup(why=("it was not built before, or its result was not kept",))
        with contextlib.suppress(TypeError, AttributeError):
            changes = differences(before, key.parts)
            if changes:
                return CacheLookup(why=changes)
        return CacheLookup(why=("nothing was kept of its last build",))

    def _mark_used(self, answer: CacheAnswer) -> None:
        own = os.path.join(self.store.folder, "")
        inside = (each.path.removeprefix(own).split(os.sep) for each in answer.inputs if each.path.startswith(own))
        for folder in {os.path.join(*path[:2]) for path in inside if path[0] in KINDS and len(path) > 2}:
            with contextlib.suppress(OSError):  # the store of another user may be read-only
                os.utime(self.store.folder / folder / ENTRY)

    def keep(self, key: CacheKey, record: Record, inputs: Iterable[FileState], packages: Iterable[Package]) -> None:
        text = to_json(record)
        digest = key_of([text.decode()])
        self._put("built", digest, text)
        answer = CacheAnswer(digest, tuple(inputs), tuple(packages))
        if self.on_keep is not None:
            self.on_keep(record, answer.inputs)
        self._write(key, [answer, *self._answers(key.digest)])

    def keep_raw(self, sha256: str, content: bytes) -> None:
        if not blobs.has(self.store.folder, "raw", sha256):
            self._put("raw", sha256, content)

    def raw(self, file: KeptFile) -> bytes | None:
        """Return the bytes of a file, or None if they no longer exist."""
        if file.source is None:
            return blobs.get(self.store.folder, "raw", file.sha256)
        from hashlib import sha256

        with contextlib.suppress(OSError):
            content = read_regular(file.source)
            if sha256(content).hexdigest() == file.sha256:
                return content
        return None

    def packed(self, sha256: str, level: int) -> Packed | None:
        from mjcompose.bundle.write import packed_from_bytes

        content = blobs.get(self.store.folder, "packed", packed_key(sha256, level))
        return None if content is None else packed_from_bytes(content)

    def keep_packed(self, sha256: str, level: int, packed: Packed) -> None:
        from mjcompose.bundle.write import packed_to_bytes

        self._put("packed", packed_key(sha256, level), packed_to_bytes(packed))

    def is_written(self, out: Location, content: str) -> bool:
        """Return whether an output is unchanged since `note_written` recorded this content."""
        known = _read(self.store.folder, key_of([os.fspath(out)]))
        if not isinstance(known, list) or len(known) != 3 or not isinstance(known[1], list):
            return False
        noted, beside, stamps = known
        return bool(noted == content and stamps == (_stamps([os.fspath(out), *beside]) or None))

    def note_written(self, out: Location, content: str, beside: Iterable[Path] = ()) -> None:
        """Record an output; `beside` are files elsewhere that belong to it."""
        outputs = [os.fspath(path) for path in (out, *beside)]
        self._put("asked", key_of(outputs[:1]), _dump([content, outputs[1:], _stamps(outputs)]))

    def close(self) -> None:
        """Keep the store below its limit, if anything was added to it."""
        if self.grown and not self.broken:
            self.grown = False
            with contextlib.suppress(Exception):  # another run will do it
                self.store.prune(self.store.limit)

    def _answers(self, key: str) -> list[CacheAnswer]:
        with contextlib.suppress(TypeError, ValueError, KeyError):
            return [
                CacheAnswer(each["record"], tuple(map(file_state, each["inputs"])), tuple(map(tuple, each["packages"])))
                for each in _read(self.store.folder, key) or ()
            ]
        return []

    def _changes(self, answer: CacheAnswer) -> list[str]:
        changed = [each for each in answer.inputs if not self.files.is_same(each)]
        lines = [_change(each, self.files.look(each.path)) for each in changed]
        return lines + [
            f"the package `{name}` was {version}, and its version has changed"
            for name, version, file in answer.packages
            if not os.path.isfile(file)
        ]

    def _write(self, key: CacheKey, answers: Sequence[CacheAnswer]) -> None:
        by_state: dict[tuple[str, ...], CacheAnswer] = {}
        for each in answers:
            by_state.setdefault(tuple(one.state for one in each.inputs), each)
        data = [
            {"record": each.record, "inputs": [one.as_data() for one in each.inputs], "packages": each.packages}
            for each in [*by_state.values()][:_ANSWERS]
        ]
        self._put("asked", key.digest, _dump(data))
        self._put("asked", key.subject_digest, _dump(dict(key.parts)))

    def _put(self, kind: str, key: str, content: bytes) -> None:
        if self.broken:
            return
        try:
            blobs.put(self.store.folder, kind, key, content=content)
            self.grown = True
        except OSError as error:
            self.broken = True
            self.warn(f"the built model is not kept in `{self.store.folder}`: {(error.strerror or str(error)).lower()}")


def open_cache(store: Store, sink: Sink) -> Cache:
    """Return the cache in a store; errors on writing become one warning."""

    def warn(message: str) -> None:
        help = "make room, name another folder in `MJCOMPOSE_CACHE`, or build with `--no-cache`"
        sink.warning("store-unusable", message, help=help)

    return Cache(store, warn)


def packed_key(sha256: str, level: int) -> str:
    import zlib

    return key_of([sha256, level, zlib.ZLIB_RUNTIME_VERSION])


def _change(before: FileState, now: FileState) -> str:
    below = f"{before.path}{os.sep}".startswith(os.getcwd() + os.sep)
    name = os.path.relpath(before.path) if below else before.path
    if os.path.isdir(before.path):
        return f"the licenses in `{name}` differ"
    if not before.state:
        return f"`{name}` is new"
    return f"`{name}` changed" if now.state else f"`{name}` is gone"


def _dump(data: object) -> bytes:
    return json.dumps(data, ensure_ascii=True).encode()


def _read(store: Path, key: str) -> Any:
    text = blobs.get(store, "asked", key)
    with contextlib.suppress(ValueError, RecursionError):
        return None if text is None else json.loads(text)
    return None
