"""MJCF in the programs, tests and data of other packages: read and written, it compiles to the same model."""

from __future__ import annotations

import ast
import re
import tomllib
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import mujoco
from fidelity.roundtrip import unlike
from mjcompose import mjcf

LIST = Path(__file__).with_name("strings.toml")
_MODEL = re.compile(r"<mujoco\b.*</mujoco\s*>", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Source:
    """A text of MJCF by where it stands, `brax/base_test.py:31`; one of a file has no `text`."""

    id: str
    path: Path
    text: str | None = None


@dataclass(frozen=True, slots=True)
class Verdict:
    """What came of it; where MuJoCo does not load the text there is nothing to compare, and `loads` is False."""

    id: str
    loads: bool
    said: str = ""


def found_in(package: Path, name: str) -> list[Source]:
    """Every file of MJCF below a package, and every text in a program."""
    sources = []
    for path in sorted(package.rglob("*")):
        place = f"{name}/{path.relative_to(package).as_posix()}"
        if path.suffix == ".xml":
            sources.append(Source(place, path))
        elif path.suffix == ".py":
            texts = in_program(path.read_text(encoding="utf-8"))
            sources += [Source(f"{place}:{line}", path, text) for line, text in texts]
    return sources


def in_program(program: str) -> list[tuple[int, str]]:
    """The models in the literals of a program, with the line that each literal begins in, each text once."""
    found: dict[str, int] = {}
    for node in _literals(ast.parse(program)):
        # A literal may hold a model among other words.
        for text in _MODEL.findall(str(node.value)):
            found.setdefault(text, node.lineno)
    return sorted((line, text) for text, line in found.items())


def _literals(node: ast.AST) -> Iterator[ast.Constant]:
    """All but the pieces of f-strings, which are no texts of their own."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node
    if not isinstance(node, ast.JoinedStr):
        for child in ast.iter_child_nodes(node):
            yield from _literals(child)


def judge(source: Source) -> Verdict:
    """Read, write, compile, and compare every array, size, name and setting bit for bit."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            before = _load(source)
        except (ValueError, mujoco.FatalError):
            return Verdict(source.id, False)
        try:
            root = mjcf.from_path(source.path) if source.text is None else mjcf.from_xml_string(source.text)
            after = mujoco.MjModel.from_xml_string(root.to_xml_string(), root.assets)
        except (ValueError, mujoco.FatalError) as error:
            return Verdict(source.id, True, "refused: " + " ".join(str(error).split()))
        return Verdict(source.id, True, ", ".join(unlike(before, after)))


def failed(source: Source, error: str) -> Verdict:
    """The verdict on a text on which the comparison itself failed."""
    return Verdict(source.id, True, f"failed: {error}")


def _load(source: Source) -> mujoco.MjModel:
    if source.text is None:
        return mujoco.MjModel.from_xml_path(str(source.path))
    return mujoco.MjModel.from_xml_string(source.text)


def intended(kind: str = "group", path: Path = LIST) -> Mapping[str, str]:
    """Why a text is refused, or compiles to another model, by its place; of `turned` ones, why a copy of it does."""
    groups = tomllib.loads(path.read_text(encoding="utf-8")).get(kind, [])
    return {place: group["reason"] for group in groups for place in group["places"]}


def surprises(verdicts: list[Verdict], expected: Mapping[str, str]) -> list[str]:
    """Every text that does not do what the list says, and every line of the list that is of no text."""
    told = [f"{each.id}: {each.said}" for each in verdicts if each.loads and each.said and each.id not in expected]
    for verdict in verdicts:
        if verdict.id in expected and not (verdict.loads and verdict.said):
            told.append(f"{verdict.id} compiles to the same model, and is listed as an intended difference")
    missing = sorted(expected.keys() - {each.id for each in verdicts})
    return told + [f"{place} is listed as an intended difference, and does not exist" for place in missing]
