"""Every pair of the corpus parsed, linked and written, against lxml alone. `python -m bench.pairs` prints all of them.

What MuJoCo measures of a part is asked once and answered from memory afterwards: that is MuJoCo's time.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import Any

from mjcompose.link.linking import AttachmentPlace, ModelMeasure
from mjcompose.link.measure import measure_with
from mjcompose.mujoco.engine import Session
from mjcompose.sources.context import Context
from mjcompose.tree.unit import Unit

from bench import ours, peers
from bench.row import Row
from bench.timing import best_times

_LIMIT = 11.0
_ROUNDS = 80
_SECONDS = 5.0
# On a busy machine few rounds are undisturbed: many are wanted, however long they take.


@dataclass(frozen=True, slots=True)
class Pair:
    """Models that are joined: each part with its prefix and its place."""

    name: str
    base: Path
    parts: tuple[tuple[Path, str, AttachmentPlace], ...]

    @property
    def files(self) -> list[str]:
        """Every file that is read, with those that are included."""
        return [file for model in (self.base, *(part[0] for part in self.parts)) for file in peers.read_with(model)]


@dataclass(frozen=True, slots=True)
class Measured:
    """How long a pair takes, in seconds, and the bytes of the model that comes out."""

    name: str
    size: int
    lxml: float
    ours: float

    @property
    def ratio(self) -> float:
        return self.ours / self.lxml


@dataclass(slots=True)
class _Remembered:
    """What MuJoCo says of the parts of one pair, in the order in which it is asked."""

    measure: ModelMeasure
    answers: list[Mapping[str, list[float]]] = field(default_factory=list)
    at: int = 0

    def __call__(self, unit: Unit, arrays: tuple[str, ...], *, attempt: bool = False) -> Mapping[str, list[float]]:
        if self.at == len(self.answers):
            self.answers.append(self.measure(unit, arrays, attempt=attempt))
        self.at += 1
        return self.answers[self.at - 1]

    def again(self) -> _Remembered:
        self.at = 0
        return self


def rows() -> list[Row]:
    corpus = os.environ.get("MJCOMPOSE_CORPUS")
    if not corpus:
        return [Row("linking a pair / lxml parse + tostring", None, _LIMIT, "MJCOMPOSE_CORPUS is not set")]
    found = sorted(measured(Path(corpus)), key=lambda each: each.ratio)
    worst = found[-1]
    note = f"of {len(found)} pairs"
    return [
        Row("linking, the median pair / lxml parse + tostring", median(each.ratio for each in found), 6.5, note),
        Row("linking, the worst pair / lxml parse + tostring", worst.ratio, _LIMIT, f"{worst.name}, {note}"),
    ]


def measured(corpus: Path) -> list[Measured]:
    """Every pair that links: others are there to be refused."""
    found = []
    with peers.quiet(), Session() as session:
        for pair in _pairs(corpus):
            remembered = _Remembered(measure_with(Context(), session=session))
            text = ours.paired(pair.base, pair.parts, remembered)
            if text is not None:
                found.append(_timed(pair, len(text), remembered))
    return found


def _timed(pair: Pair, size: int, remembered: _Remembered) -> Measured:
    files = pair.files
    best = best_times(
        {
            "lxml": lambda: peers.lxml_rewritten(*files),
            "ours": lambda: ours.paired(pair.base, pair.parts, remembered.again()),
        },
        rounds=_ROUNDS,
        seconds=_SECONDS,
        clock=time.process_time,
    )
    return Measured(pair.name, size, best["lxml"], best["ours"])


def _pairs(corpus: Path) -> list[Pair]:
    described = json.loads((corpus / "pairs.json").read_text())["pairs"]
    pairs = [
        Pair(each["id"], corpus / each["parent"], tuple(_part(corpus, given) for given in each["attachments"]))
        for each in described
        if not each["expected_failure"]
    ]
    return [pair for pair in pairs if all(file.suffix == ".xml" for file, *_ in [(pair.base,), *pair.parts])]


def _part(corpus: Path, given: dict[str, Any]) -> tuple[Path, str, AttachmentPlace]:
    offset = {name: " ".join(map(repr, map(float, given[name]))) for name in ("pos", "quat") if name in given}
    for kind in ("site", "body"):
        if kind in given["at"]:
            return corpus / given["child"], given["prefix"], AttachmentPlace(kind, given["at"][kind], offset)
    return corpus / given["child"], given["prefix"], AttachmentPlace(offset=offset)


def main() -> None:
    found = sorted(measured(Path(os.environ["MJCOMPOSE_CORPUS"])), key=lambda each: each.ratio)
    lines = ["| pair | model | lxml | mjcompose | ratio |", "|---|---|---|---|---|"]
    lines += [
        f"| {each.name.removeprefix('dev-')} | {each.size / 1000:.1f} kB | {each.lxml * 1000:.2f} ms"
        f" | {each.ours * 1000:.2f} ms | {each.ratio:.1f} |"
        for each in found
    ]
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
