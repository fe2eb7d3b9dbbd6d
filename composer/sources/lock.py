"""The lock of a recipe: what every source was when it was locked, so that it is the same again."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints, ValidationError

from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.document import Mapping, Scalar, load, locate, to_python

FORMAT = 1
_MERGE = re.compile(r"^<<<<<<<( |$)", re.MULTILINE)
SourceKind = Literal["path", "package", "menagerie", "descriptions", "git", "archive"]
_Sha256 = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")]
_GitHash = Annotated[str, StringConstraints(pattern=r"^([0-9a-f]{40}|[0-9a-f]{64})$")]


# What a source of a kind has not.
_OTHERS: dict[str, tuple[str, ...]] = {
    "path": ("commit", "tree", "sha256", "package", "version"),
    "package": ("commit", "tree", "sha256"),
    "menagerie": ("sha256",),
    "descriptions": ("sha256",),
    "git": ("sha256", "package", "version"),
    "archive": ("commit", "tree", "package", "version"),
}


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Locked(_Part):
    """One source: a repository, an archive, a robot, a package, a file beside the recipe."""

    kind: SourceKind
    commit: _GitHash | None = None
    tree: _GitHash | None = None
    sha256: _Sha256 | None = None
    package: str | None = None
    version: str | None = None
    files: dict[str, _Sha256]
    licences: list[str] = Field(default_factory=list)
    used_by: list[str] = Field(default_factory=list)

    @property
    def pin(self) -> str | None:
        """What fetches the same bytes again."""
        return self.commit or self.sha256

    @property
    def foreign(self) -> list[str]:
        """What it says and no source of its kind has."""
        return [name for name in _OTHERS[self.kind] if getattr(self, name) is not None]

    @property
    def is_local(self) -> bool:
        """Whether its files are the user's own, who may change them."""
        return self.kind == "path"


class Lock(_Part):
    """All sources of a recipe and of the recipes in it, by their id; files are named relative to the source.

    `mjcompose` and `mujoco` are the versions that the lock was made with.
    """

    lock: Literal[1] = 1
    mjcompose: str
    mujoco: str | None
    sources: dict[str, Locked]


def lock_path(recipe: Path) -> Path:
    """Where the lock of a recipe is: beside it, `arm.lock` for `arm.yaml`. No I/O.

    >>> lock_path(Path("robots/recipe.yaml")).as_posix()
    'robots/recipe.lock'
    """
    return recipe.with_suffix(".lock")


def to_text(lock: Lock) -> str:
    """The lock as its file has it: the same lock is the same text. No I/O."""
    told = lock.model_dump(exclude_defaults=True)
    told["sources"] = {
        id: {**source, "files": dict(sorted(source["files"].items()))}
        for id, source in sorted(told["sources"].items())
    }
    return json.dumps({"lock": FORMAT, **told}, indent=2, ensure_ascii=False) + "\n"


Disputed = dict[str, tuple[str, str]]
"""Sources that the two sides of a merge pin otherwise, and how each does in words."""


def read_lock(path: Path, shown: str, sink: Sink, disputes: Disputed | None = None) -> Lock | None:
    """The lock in a file; None where there is none, or where it cannot be read, which goes to `sink`.

    Where `disputes` is given, a lock in the middle of a merge is what the two sides pin together; what they pin
    otherwise goes there.
    """
    try:
        text = path.read_bytes()
    except FileNotFoundError:
        return None
    except OSError as error:
        sink.error(
            "lock-invalid", f"the lock `{shown}` cannot be read: {(error.strerror or str(error)).lower()}"
        )
        return None
    return from_text(text, shown, sink, disputes)


def from_text(text: bytes | str, shown: str, sink: Sink, disputes: Disputed | None = None) -> Lock | None:
    """The lock that a text is; one fault of it at its place goes to `sink`. No I/O."""
    plain = text.decode("utf-8", "replace") if isinstance(text, bytes) else text
    if (mark := _MERGE.search(plain)) is not None:
        return _in_a_merge(plain, mark.start(), shown, sink, disputes)
    own = Sink()
    node = load(text, shown, own)
    if own.errors:
        first = own.sorted()[0]
        sink.error("lock-invalid", f"`{shown}` is not a lock: {first.message}", first.span, help=_HELP)
        return None
    if not isinstance(node, Mapping):
        sink.error(
            "lock-invalid", f"`{shown}` is not a lock", None if node is None else node.span, help=_HELP
        )
        return None
    version = node.entries.get("lock")
    number = version[1] if version is not None else None
    if isinstance(number, Scalar) and isinstance(number.value, int) and number.value > FORMAT:
        sink.error(
            "lock-invalid",
            f"`{shown}` was written by a newer mjcompose: its format is {number.value}, this one knows {FORMAT}",
            number.span,
            help="update mjcompose, or remove the lock and run `mjcompose lock`",
        )
        return None
    try:
        lock = Lock.model_validate(to_python(node))
    except ValidationError as error:
        fault = error.errors()[0]
        _tell(fault["type"], tuple(fault["loc"]), node, shown, sink)
        return None
    if (
        version is None or not isinstance(number, Scalar) or type(number.value) is not int
    ):  # `true` is 1 to Python
        _tell("missing" if version is None else "", ("lock",), node, shown, sink)
        return None
    return lock


def _in_a_merge(text: str, start: int, shown: str, sink: Sink, disputes: Disputed | None) -> Lock | None:
    """What both sides pin, where that is asked for; else the fault, at the first mark."""
    from composer.sources.lock_merge import disputed, joined, sides

    if disputes is not None:
        ours, theirs = (from_text(side, shown, Sink()) for side in sides(text))
        if ours is not None and theirs is not None:
            disputes.update(disputed(ours, theirs))
            return joined(ours, theirs)
    line = text.count("\n", 0, start) + 1
    help = "run `mjcompose lock`, which keeps what both sides pin"
    if disputes is not None:
        help = "take one side of the merge, and run `mjcompose lock`"
    message = f"`{shown}` has the marks of a merge in it"
    sink.error("lock-invalid", message, Span(shown, line, 1, line, 8), help=help)
    return None


_HELP = "take the lock from version control, or remove it and run `mjcompose lock`"


def _tell(fault: str, path: tuple[str | int, ...], node: Mapping, shown: str, sink: Sink) -> None:
    key = fault in ("missing", "extra_forbidden")
    where = " / ".join(f"`{step}`" for step in path)
    said = {
        "missing": "is missing",
        "extra_forbidden": "is not a key of a lock",
        "string_pattern_mismatch": "is not a hash",
    }.get(fault, "is not what it must be")
    sink.error(
        "lock-invalid", f"`{shown}` is not a lock: {where} {said}", locate(node, path, key=key), help=_HELP
    )
