"""Entries that differ in a pattern become one with `for`, which makes the same entries again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st
from mjcompose.base.sink import Sink
from mjcompose.language.expand import expand
from mjcompose.sources.context import Context
from mjcompose.text.load import load
from mjcompose.text.node import Mapping, to_python
from mjcompose.tools.importing.elements import SectionEntry
from mjcompose.tools.importing.folding import folded
from mjcompose.tools.importing.recover import recover


def texts(section: str, *entries: str) -> list[str]:
    return [each.text for each in folded([SectionEntry(section, text) for text in entries])]


def expanded(section: str, entries: list[str]) -> Any:
    """The data that the entries make, judged by the language itself."""
    dash = "- " if section in ("add", "edit") else ""
    tree = load(f"{section}:\n" + "".join(f"  {dash}{each}\n" for each in entries), "recipe.yaml", sink := Sink())
    assert isinstance(tree, Mapping) and not sink.diagnostics
    made = to_python(expand(tree, {}, sink).document)
    assert not sink.diagnostics
    return list(made[section].items()) if dash == "" else made[section]


CASES = {
    "numbers": ("sensor", [f"s{i}: {{type: force, site: a{i + 1}/tip}}" for i in range(5)],
                '"s${i}": {for: {i: 5}, type: force, site: "a${i + 1}/tip"}'),
    "words": ("sensor", [f"{w}_at: {{type: force, site: {w}}}" for w in ("FL", "FR", "RL", "RR", "mid")],
              '"${i}_at": {for: {i: [FL, FR, RL, RR, mid]}, type: force, site: "${i}"}'),
    "two names": ("actuator", [f"{a}_{b}: {{type: motor, joint: {a}/{b}}}" for a in "LR" for b in ("x", "y", "z")],
                  '"${i}_${j}": {for: {i: [L, R], j: [x, y, z]}, type: motor, joint: "${i}/${j}"}'),
    "places in a row": ("attach", [f"c{i}: {{model: ./c.xml, pos: [{(i - 2) / 10}, 0, 1]}}" for i in range(6)],
                        '"c${i}": {for: {i: 6}, model: ./c.xml, pos: ["${(i - 2) / 10}", 0, 1]}'),
    "leading zeros": ("sensor", [f"s{i:02}: {{type: force, site: t}}" for i in range(8, 13)],
                      '"s${i}": {for: {i: ["08", "09", "10", "11", "12"]}, type: force, site: t}'),
    "lists": ("edit", [f"{{select: {{geom: g{i}}}, rename: h{i}}}" for i in range(5)],
              '{for: {i: 5}, select: {geom: "g${i}"}, rename: "h${i}"}'),
    "markup": ("sensor", [f's{i}: {{xml: "<force name=\\"s{i}\\" site=\\"t{i}\\" cutoff=\\"0.5\\"/>"}}' for i in range(5)],
               '"s${i}": {for: {i: 5}, xml: "<force name=\\"s${i}\\" site=\\"t${i}\\" cutoff=\\"0.5\\"/>"}'),
}  # fmt: skip


@pytest.mark.parametrize(("section", "entries", "one"), CASES.values(), ids=CASES)
def test_a_pattern_becomes_one_entry(section: str, entries: list[str], one: str) -> None:
    assert texts(section, *entries) == [one]
    if section != "edit":  # the elements settle its expressions
        assert expanded(section, [one]) == expanded(section, entries)


@pytest.mark.parametrize(
    "entries",
    [
        [f"s{i}: {{type: force, site: t}}" for i in range(4)],
        [f"s{i}: {{type: force, site: t, cutoff: {value}}}" for i, value in enumerate([1, 5, 3, 2, 9])],
        [f"s{i}: {{type: force, site: {'t' if i else 'u v'}}}" for i in range(5)],
        [f's{i}: {{type: force, site: "t${{x}}"}}' for i in range(5)],
        [f"s{i}: {{type: force, site: t{i * i}}}" for i in range(5)],
    ],
    ids=["few", "no steps", "other shapes", "expressions", "squares"],
)
def test_what_has_no_pattern_stays(entries: list[str]) -> None:
    assert texts("sensor", *entries) == entries


def test_comments_and_other_sections_end_a_run() -> None:
    entries = [SectionEntry("sensor", f"s{i}: {{type: force, site: t}}") for i in range(9)]
    entries[4].note = "it does not build"
    assert folded(entries) == entries
    mixed = [SectionEntry("sensor" if i < 4 else "actuator", f"s{i}: {{type: force, site: t}}") for i in range(8)]
    assert folded(mixed) == mixed


WORDS = st.text("abxyz", min_size=1, max_size=3)


@settings(max_examples=150, deadline=None)
@given(
    st.lists(WORDS | st.integers(0, 30).map(str), min_size=5, max_size=8, unique=True),
    st.lists(st.sampled_from(["t", "{}", "{}/{}", "a{}b", "1.5", "0{}"]), min_size=1, max_size=3),
    st.decimals(-3, 3, places=3),
    st.decimals(-1, 1, places=3),
)
def test_what_is_folded_makes_the_same_entries(names: list[str], forms: list[str], start: Any, step: Any) -> None:
    entries = [
        f'"k_{name}": {{p: [{start + step * at}, {at}], q: ["{"_".join(forms).replace("{}", name)}"], r: true}}'
        for at, name in enumerate(names)
    ]
    assert expanded("sensor", texts("sensor", *entries)) == expanded("sensor", entries)


ARM = """\
<mujoco><worldbody><body name="base"><geom name="g" size="0.1"/><site name="tip" pos="0 0 {height}"/></body></worldbody></mujoco>
"""


def merged(count: int) -> str:
    bodies = "".join(
        f'<body name="arm{i}/base" pos="{i / 4} 0 1"><geom name="arm{i}/g" size="0.1"/><site name="arm{i}/tip"/></body>'
        for i in range(count)
    )
    sensors = "".join(f'<framepos name="at{i}" objtype="body" objname="arm{i}/base"/>' for i in range(count))
    return f'<mujoco model="row"><worldbody>{bodies}</worldbody><sensor>{sensors}</sensor></mujoco>'


def test_import_writes_for(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(ARM.format(height=0))
    (tmp_path / "row.xml").write_text(merged(6))
    context = Context(folder=tmp_path)
    found = recover(tmp_path / "row.xml", [tmp_path / "arm.xml"], tmp_path / "row.yaml", context)
    assert found is not None and found.outcome is not None and found.outcome.same and found.bundle is not None
    assert '"arm${i}": {for: {i: 6}, model: ./arm.xml, pos: ["${25 * i / 100}", 0, 1]}' in found.text
    assert found.text.count("for:") == 2 and len(found.text.splitlines()) < 12
    (tmp_path / "row.xml").write_text(merged(4))
    few = recover(tmp_path / "row.xml", [tmp_path / "arm.xml"], tmp_path / "row.yaml", context)
    assert few is not None and "for:" not in few.text


def test_a_recipe_that_makes_another_model_is_not_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "arm.xml").write_text(ARM.format(height=0))
    (tmp_path / "row.xml").write_text(merged(6))
    monkeypatch.setattr("mjcompose.tools.importing.recover.folded", lambda entries: entries[:-1])
    found = recover(tmp_path / "row.xml", [tmp_path / "arm.xml"], tmp_path / "row.yaml", Context(folder=tmp_path))
    assert found is not None and found.outcome is not None and found.outcome.same
    assert "at5: {" in found.text and "for:" not in found.text
