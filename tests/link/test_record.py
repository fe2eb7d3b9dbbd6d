"""What passes and steps record is all that they change: after each of them, the record leads to the model as it is."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import mujoco
import pytest
from link.audit import Audit
from lxml.etree import _Element as Node
from mjcompose.compose.compose import ComposeOptions, Composer
from mjcompose.link.collect import collect
from mjcompose.link.measure import measure_with
from mjcompose.plan.planner import make_plan
from mjcompose.sources.context import Context
from mjcompose.tree import journal
from sampling import need_robots

REPOSITORY = Path(__file__).resolve().parents[2]
CORPUS = os.environ.get("MJCOMPOSE_CORPUS")
CASES = {
    **{file.parent.name: file for file in sorted(REPOSITORY.glob("tests/golden/*/recipe.yaml"))},
    **{f"recipes/{file.stem}": file for file in sorted(REPOSITORY.glob("recipes/*.yaml"))},
    **{f"record/{file.stem}": file for file in sorted(REPOSITORY.glob("tests/link/record/*.yaml"))},
}


def audited(recipe: Path, deduplicates: bool = False, audit: Audit | None = None) -> Audit:
    root = {"MENAGERIE_ROOT": str(Path(CORPUS, "models"))} if CORPUS else {}
    context = Context(environment=root, folder=recipe.parent)
    plan = make_plan(recipe, context, None)
    assert plan is not None, [each.message for each in context.sink.diagnostics]
    audit = audit or Audit()
    options = ComposeOptions(deduplicates=deduplicates)
    with audit.recording():
        composed = Composer(context, measure_with(context), watch=audit, options=options).compose(plan)
        assert composed is not None, [each.message for each in context.sink.diagnostics]
        collect(composed.model, composed.files, context.sink, shown=context.shown)
        audit([composed.model], collect)
    return audit


def needs(case: str) -> None:
    if "menagerie" in case:
        if not CORPUS:
            pytest.skip("MJCOMPOSE_CORPUS names no corpus")
        need_robots(CASES[case], Path(CORPUS, "models"))
    if case == "urdf" and not hasattr(mujoco.MjSpec, "fuse_static"):
        pytest.skip("this MuJoCo fuses the link `tool0` without a trace")
    if case.endswith(("xacro", "xacro_arm")):
        pytest.importorskip("xacro")


@pytest.mark.parametrize(
    "case", [pytest.param(each, marks=pytest.mark.slow if "menagerie" in each else ()) for each in CASES]
)
def test_every_change_is_recorded(case: str) -> None:
    needs(case)
    audit = audited(CASES[case], deduplicates=len(case) % 2 == 0)
    assert audit.unrecorded == []
    assert audit.changes


class _Site(NamedTuple):
    """A call of the journal: the module and the line."""

    module: str
    line: int


@dataclass
class _Calls:
    """Notes which calls change an element of a model. The call at `blind` changes it without a record."""

    audit: Audit
    blind: _Site | None = None
    changed: dict[_Site, list[Node]] = field(default_factory=dict)

    @property
    def sites(self) -> list[_Site]:
        """The calls that count: a change of an element that is removed later, before anybody looks, leaves no trace."""
        return [site for site, nodes in self.changed.items() if any(map(self._counts, nodes))]

    def _counts(self, node: Node) -> bool:
        holder = node
        while (above := holder.getparent()) is not None:
            holder = above
        return holder in self.audit.roots

    def replacing(self, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        def call(node: Node, *arguments: Any, **named: Any) -> Any:
            frame = sys._getframe(1)
            while frame.f_code.co_filename == journal.__file__:
                assert frame.f_back is not None
                frame = frame.f_back
            site = _Site(Path(frame.f_code.co_filename).stem, frame.f_lineno)
            if self._changes(name, node, arguments):
                element = arguments[0] if name == "place" else node
                # Of an element that is removed, the place that it leaves stays.
                self.changed.setdefault(site, []).append(node.getroottree().getroot() if name == "remove" else element)
            with journal.unrecorded() if site == self.blind else nullcontext():
                return function(node, *arguments, **named)

        return call

    def _changes(self, name: str, node: Node, arguments: tuple[Any, ...]) -> bool:
        states = self.audit.record.states
        if not journal.is_recording(self.audit.record):
            return False
        if name == "place":
            return isinstance(arguments[0].tag, str) and node in states and arguments[0].getparent() is not node
        if name == "write":
            return node in states and node.get(arguments[0]) != arguments[1]
        if name == "drop":
            return node in states and node.get(arguments[0]) is not None
        return isinstance(node.tag, str) and node in states and node.getparent() is not None


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[str, _Site | None], _Calls]]:
    """Audit a case, and note its calls, maybe with one that is blind."""
    functions = {name: getattr(journal, name) for name in ("write", "drop", "retag", "place", "remove")}

    def run(case: str, blind: _Site | None) -> _Calls:
        found = _Calls(Audit(), blind)
        for name, function in functions.items():
            monkeypatch.setattr(journal, name, found.replacing(name, function))
        audited(CASES[case], audit=found.audit, deduplicates=True)
        return found

    yield run


@pytest.mark.slow
@pytest.mark.mujoco4("it fuses the link `tool0` without a trace")
def test_a_write_without_a_record_is_found(calls: Callable[[str, _Site | None], _Calls]) -> None:
    reached: dict[_Site, str] = {}
    for case in CASES:
        if not case.startswith("recipes/") and not case.endswith("xacro"):
            for site in calls(case, None).sites:
                reached.setdefault(site, case)
    hidden = [f"{site.module}:{site.line}" for site, case in reached.items() if not calls(case, site).audit.unrecorded]
    assert hidden == []
    assert len(reached) >= 90
