"""Memory for the simulation: what a part asks for itself never takes memory from the whole model."""

from __future__ import annotations

import pytest
from link.workshop import BASE, Workshop

from composer.diagnostics import Severity
from composer.link.room import bytes_of

MEGABYTE = 2**20


def moving(size: str, count: int = 1) -> str:
    bodies = '<body><freejoint/><geom size=".1"/></body>' * count
    return f"<mujoco>{size}<worldbody>{bodies}</worldbody></mujoco>"


def test_a_part_does_not_starve_the_whole_model(workshop: Workshop) -> None:
    base = moving("", 30)
    linked = workshop.link(base, moving('<size memory="1M"/>'))
    alone, whole = linked.alone(0), linked.model()
    assert whole.narena >= alone.narena > MEGABYTE
    (warning,) = linked.sink.diagnostics
    assert (warning.code, warning.severity) == ("option-conflict", Severity.WARNING)
    assert "`size.memory` of `part/` is 1M" in warning.message
    assert f"{whole.narena // MEGABYTE}M" in str(warning.help)
    assert warning.span is not None and warning.span.line == 1
    assert "<size" not in linked.xml


def test_neither_does_the_base(workshop: Workshop) -> None:
    linked = workshop.link(moving('<size memory="1M" nuserdata="3"/>'), moving("", 30))
    assert linked.model().narena > MEGABYTE
    assert "of the base is 1M" in linked.sink.diagnostics[0].message
    assert '<size nuserdata="3"/>' in linked.xml


def test_nor_two_that_say_it_both(workshop: Workshop) -> None:
    linked = workshop.link(moving('<size memory="1M"/>'), moving('<size memory="2M"/>', 30))
    assert linked.model().narena > 2 * MEGABYTE
    (warning,) = linked.sink.diagnostics
    assert [note.message for note in warning.notes] == ["`part/` asks for `memory` 2M"]


@pytest.mark.parametrize("older", ["njmax", "nstack"])
def test_nor_an_older_spelling(workshop: Workshop, older: str) -> None:
    linked = workshop.link(moving("", 30), moving(f'<size {older}="10"/>'))
    assert linked.codes == ["option-conflict"]
    assert linked.model().narena >= linked.alone(0).narena


@pytest.mark.parametrize("size", ['memory="900M"', 'njmax="9000"', 'memory="-1"'])
def test_what_is_enough_for_all_stays(workshop: Workshop, size: str) -> None:
    linked = workshop.link(moving(""), moving(f"<size {size}/>"))
    assert not linked.sink.diagnostics
    assert linked.model().narena >= linked.alone(1).narena


def test_what_moves_alone_keeps_its_own(workshop: Workshop) -> None:
    linked = workshop.link(BASE, moving('<size memory="1M"/>'))
    assert not linked.sink.diagnostics
    assert linked.model().narena == MEGABYTE


def test_what_the_recipe_sets_holds(workshop: Workshop) -> None:
    """It is written after the sources have been joined."""
    linked = workshop.link(
        moving("", 30), moving('<size memory="1M"/>'), overridden_options=frozenset({"size/memory"})
    )
    assert not linked.sink.diagnostics


def test_a_model_that_does_not_compile_is_left_as_it_is(workshop: Workshop) -> None:
    broken = '<mujoco><size memory="1M"/><worldbody><body><freejoint/></body></worldbody></mujoco>'
    linked = workshop.link(moving(""), broken)
    assert not linked.sink.diagnostics
    assert 'memory="1M"' in linked.xml


@pytest.mark.parametrize(("text", "count"), [("7", 7), ("1K", 1024), (" 2m ", 2 * MEGABYTE), ("", 0)])
def test_amounts(text: str, count: float) -> None:
    assert bytes_of(text) == count
