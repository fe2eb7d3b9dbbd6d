"""What is fuzzed: one row for each form in which something reaches mjcompose."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from cases import cases
from fuzz.mutation import Mutate
from mjcompose.mujoco.engine import RequestLimits, Session
from mjcompose.sources.context import Context

ROOT = Path(__file__).resolve().parents[2]
RECIPES = ROOT / "recipes"


@dataclass(frozen=True, slots=True)
class Seed:
    """A case to begin with, and the folder of what it refers to, if it does."""

    data: bytes
    beside: Path | None = None


@dataclass(frozen=True, slots=True)
class Tools:
    """What every check may use: MuJoCo in its child process."""

    session: Session


Check = Callable[[Path, Tools], str | None]
"""Runs a case, the file at a path, in a folder of its own; gives what is wrong, in a few words, or None. What it
raises is wrong too."""


@dataclass(frozen=True, slots=True)
class Target:
    """A form of input: its `suffix`, what to begin with, how a case is changed, and how it is judged.

    `beside` is what stands in the folder of every case that has no folder of its own.
    """

    name: str
    suffix: str
    seeds: Callable[[Path | None], Iterator[Seed]]
    """Takes the folder of the corpus, where there is one."""
    mutate: Mutate
    check: Check
    beside: Path | None = None


@cache
def _temporary() -> TemporaryDirectory[str]:
    """A folder that goes when the process ends."""
    return TemporaryDirectory(prefix="fuzz-")


def error_cases() -> Path:
    """A folder with those of `tests/errors`, each a folder of its files."""
    folder = Path(_temporary().name)
    for each in cases(ROOT / "tests" / "errors"):
        if not (folder / each.id).exists():
            each.lay(folder / each.id)
    return folder


def limits() -> RequestLimits:
    """Enough for every model of the project, and soon spent by what grows."""
    return RequestLimits(seconds=15, memory=2 << 30)


def without_a_place(context: Context) -> str | None:
    """The first error of a model that does not say where it is."""
    for each in context.sink.errors:
        if each.span is None and not each.code.startswith(("output-", "mujoco-missing")):
            return f"unlocated-{each.code}"
    return None
