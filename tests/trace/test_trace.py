"""Every number of a key is explained by the key, the entry or the edit that gives it.

What the onlooker sees is all that happens, and its looking changes nothing.
"""

from __future__ import annotations

import os
import subprocess
import sys
from copy import deepcopy
from pathlib import Path

import pytest
from mjcompose.base.sink import Sink
from mjcompose.compose.compose import Composer
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.trace.trace import TAG, AttributeChange, Life, Trace
from mjcompose.trace.traced import Traced, trace
from mjcompose.tree import journal
from mjcompose.tree.parse import parse_text
from mjcompose.tree.unit import nobody
from mjcompose.tree.xml_text import write

ARM = """<mujoco model="arm">
  <worldbody><body name="a"><joint name="j"/><geom size=".1"/>
    <body name="b"><joint name="k"/><geom size=".1"/></body></body></worldbody>
  <actuator><motor name="j" joint="j"/><motor name="k" joint="k"/></actuator>
  <keyframe>
    <key name="home" time="3" qpos="0.3 1.6"
         ctrl="7
               8"/>
  </keyframe>
</mujoco>
"""
CUBE = """<mujoco model="cube">
  <worldbody><body name="c"><freejoint name="c"/><geom size=".1"/></body></worldbody>
  <keyframe><key name="home" qpos="0 0 0.5 1 0 0 0"/></keyframe>
</mujoco>
"""
Found = list[tuple[str, str, str, str]]


def _explained(folder: Path, recipe: str, key: str = "home") -> Traced:
    for name, text in {"arm.xml": ARM, "cube.xml": CUBE, "recipe.yaml": f"recipe: 1\n{recipe}"}.items():
        (folder / name).write_text(text, encoding="utf-8")
    context = Context(environment={}, folder=folder)
    found = trace(Path("recipe.yaml"), context)
    assert found is not None, [each.message for each in context.sink.diagnostics]
    return found


def _rows(traced: Traced, vector: str, name: str = "home") -> Found:
    """Label, numbers, kind of origin, and place with what passed the numbers on."""
    (key,) = (each for each in traced.model.root.iter("key") if each.get("name") == name)
    return [
        (
            row.label,
            row.value,
            row.origin,
            " ".join(f"{each.span.file}:{each.span.line}" for each in (row.reason, *row.on_the_way) if each.span),
        )
        for row in traced.attribute(key, vector).rows
    ]


def test_of_an_entry_and_the_reference(tmp_path: Path) -> None:
    traced = _explained(tmp_path, "base: arm.xml\nkeyframe:\n  home:\n    qpos: {k: 1.2rad}\n")
    assert _rows(traced, "qpos") == [("joint j", "0", "reference", ""), ("joint k", "1.2", "entry", "recipe.yaml:5")]


def test_of_the_base_by_from(tmp_path: Path) -> None:
    traced = _explained(tmp_path, "base: arm.xml\nkeyframe:\n  home:\n    from: {base: home}\n    qpos: {k: 1.2rad}\n")
    assert _rows(traced, "qpos") == [
        ("joint j", "0.3", "file", "arm.xml:6 recipe.yaml:5"),
        ("joint k", "1.2", "entry", "recipe.yaml:6"),
    ]
    assert _rows(traced, "ctrl") == [
        ("motor j", "7", "file", "arm.xml:7 recipe.yaml:5"),
        ("motor k", "8", "file", "arm.xml:8 recipe.yaml:5"),
    ]
    (key,) = traced.model.root.iter("key")
    (time,) = (each for each in traced.attribute(key, "time").levels if each.wins)
    assert time.span is not None and (time.text, time.span.file, time.span.line) == ("3", "arm.xml", 6)


def test_of_a_part_by_from(tmp_path: Path) -> None:
    traced = _explained(
        tmp_path,
        "attach:\n  arm: {model: arm.xml}\nkeyframe:\n  home:\n    from: {arm: home}\n"
        "    qpos: {arm/k: 1.2rad}\n    time: 4\n",
    )
    assert _rows(traced, "qpos") == [
        ("joint arm/j", "0.3", "file", "arm.xml:6 recipe.yaml:6"),
        ("joint arm/k", "1.2", "entry", "recipe.yaml:7"),
    ]
    (key,) = traced.model.root.iter("key")
    (time,) = (each for each in traced.attribute(key, "time").levels if each.wins)
    assert time.span is not None and time.span.line == 8


def test_of_parts_that_hang_elsewhere_and_of_none(tmp_path: Path) -> None:
    traced = _explained(
        tmp_path,
        "base: arm.xml\nattach:\n  left: {model: cube.xml, pos: [0, 0, 1]}\n  more: {model: arm.xml, drop: [key]}\n",
    )
    assert _rows(traced, "qpos") == [
        ("joint j", "0.3", "file", "arm.xml:6"),
        ("joint k", "1.6", "file", "arm.xml:6"),
        ("freejoint left/c", "0 0 1.5 1 0 0 0", "file", "cube.xml:3 recipe.yaml:4"),
        ("joint more/j", "0", "reference", ""),
        ("joint more/k", "0", "reference", ""),
    ]
    assert [row[2] for row in _rows(traced, "ctrl")] == ["file", "file", "zero", "zero"]


def test_of_an_edit_of_the_model_or_of_a_part(tmp_path: Path) -> None:
    traced = _explained(
        tmp_path,
        "attach:\n  a: {model: arm.xml, edit: [{select: {key: home}, set: {qpos: [0.3, 5]}}]}\n"
        "  b: {model: arm.xml}\n"
        'edit: [{select: {key: home}, set: {"ctrl[2]": 9}}]\n',
    )
    assert _rows(traced, "qpos") == [
        ("joint a/j", "0.3", "file", "arm.xml:6"),
        ("joint a/k", "5", "edit", "recipe.yaml:3"),
        ("joint b/j", "0.3", "file", "arm.xml:6"),
        ("joint b/k", "1.6", "file", "arm.xml:6"),
    ]
    assert _rows(traced, "ctrl")[2:] == [
        ("motor b/j", "9", "edit", "recipe.yaml:5"),
        ("motor b/k", "8", "file", "arm.xml:8"),
    ]


def test_of_a_subtree_and_a_part_whose_meaning_is_edited(tmp_path: Path) -> None:
    traced = _explained(
        tmp_path,
        "attach:\n  a: {model: arm.xml, subtree: b, edit: [{select: {motor: k}, convert: {to: position, kp: 1}}]}\n",
    )
    assert _rows(traced, "qpos") == [("joint a/k", "1.6", "file", "arm.xml:6")]
    assert _rows(traced, "ctrl") == [("position a/k", "0", "zero", "arm.xml:8")]


def test_of_a_nested_recipe(tmp_path: Path) -> None:
    (tmp_path / "inner.yaml").write_text(
        "recipe: 1\nattach:\n  arm: {model: arm.xml}\nkeyframe:\n  home:\n    from: {arm: home}\n"
        "    qpos: {arm/k: 1.2rad}\n",
        encoding="utf-8",
    )
    traced = _explained(tmp_path, "attach:\n  in: {model: inner.yaml}\n  c: {model: cube.xml}\n")
    assert _rows(traced, "qpos")[:2] == [
        ("joint in/arm/j", "0.3", "file", "arm.xml:6 inner.yaml:6"),
        ("joint in/arm/k", "1.2", "entry", "inner.yaml:7"),
    ]


def test_of_a_file_alone(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(ARM, encoding="utf-8")
    traced = trace(Path("arm.xml"), Context(environment={}, folder=tmp_path))
    assert traced is not None
    (key,) = traced.model.root.iter("key")
    first, second = traced.attribute(key, "ctrl").rows
    assert first.reason.span is not None and second.reason.span is not None
    assert (first.written, first.reason.span.line, second.reason.span.line) == ("7", 7, 8)


def test_a_number_that_nobody_accounts_for_is_not_known(tmp_path: Path) -> None:
    traced = _explained(tmp_path, "base: arm.xml\n")
    (key,) = traced.model.root.iter("key")
    key.set("qpos", "0.3 4")
    assert [row.origin for row in traced.attribute(key, "qpos").rows] == ["unknown", "unknown"]


def test_a_model_is_the_same_with_an_onlooker(recipe: Path, traced: Traced) -> None:
    built = build(ModelRequest(recipe, verified=False), Context(environment={}, folder=recipe.parent))
    assert built is not None
    assert write(traced.model.root) == built.bundle.files["model.xml"]


def test_the_changes_lead_from_what_was_read_to_what_is_there(traced: Traced) -> None:
    for node in traced.model.root.iter("*"):
        life = traced.watch.life(node)
        assert _replayed(life) == (str(node.tag), {str(name): str(text) for name, text in node.items()})


def _replayed(life: Life) -> tuple[str, dict[str, str]]:
    tag = life.tag
    attributes = dict(life.attributes)
    if len(life.sources) == 1:
        tag, attributes = _replayed(life.sources[0])
    for change in life.changes:
        if not isinstance(change, AttributeChange):
            continue
        if change.attribute == TAG:
            assert tag == change.before
            tag = str(change.after)
            continue
        assert attributes.get(change.attribute) == change.before
        if change.after is None:
            del attributes[change.attribute]
        else:
            attributes[change.attribute] = change.after
    return tag, attributes


def test_a_build_has_no_onlooker() -> None:
    assert Composer(Context(), None).watch is nobody


def test_an_equal_element_in_the_place_of_another_is_another() -> None:
    text = b'<mujoco><worldbody><geom name="a" size="1"/><geom name="b" size="1"/></worldbody></mujoco>'
    unit = parse_text(text, Sink(), file="model.xml", directory=Path(), label="model")
    assert unit is not None
    watch = Trace()
    with watch.recording():
        watch([unit], "read")
        world = unit.root[0]
        old = world[0]
        journal.exchange(old, new := deepcopy(old))
        watch([unit], "replaced")
        watch([unit], "left alone")
        assert [life.node for life in watch.gone] == [old] and watch.life(new).born.done == "replaced"
        assert watch.life(world[1]).changes == []
        journal.place(world, world[0])
        watch([unit], "moved")  # nothing has changed in the element, and its parent is the same
        assert watch.life(new).changes == []
        journal.write(world[0], "size", "2")
        watch([unit], "set")
        assert [each.cause.done for each in watch.life(world[0]).of("size")] == ["set"]
        journal.remove(new)
        watch([unit], "removed")
        assert watch.life(new).gone is not None
        journal.place(world, new)
        watch([unit], "put back")
        assert watch.life(new).gone is None and [life.node for life in watch.gone] == [old]


def test_an_onlooker_does_not_look_at_what_it_did_not_record() -> None:
    text = b'<mujoco><worldbody><geom name="a" size="1"/></worldbody></mujoco>'
    unit = parse_text(text, Sink(), file="model.xml", directory=Path(), label="model")
    assert unit is not None
    watch = Trace()
    watch([unit], "read")
    with pytest.raises(RuntimeError, match="recording"):
        watch([unit], "changed")


def test_the_answer_is_the_same_in_every_process() -> None:
    """Sets of texts have another order in each process, and so have sets of elements."""
    program = (
        "from pathlib import Path; from mjcompose.sources.context import Context; from mjcompose.trace.traced import trace\n"
        "from mjcompose.trace.explanation import render; from mjcompose.trace.trace_words import removal_reason\n"
        "traced = trace(Path('recipe.yaml'), Context(environment={}, folder=Path('.')))\n"
        "for node in traced.labels: print(render(traced.element(node)))\n"
        "for life in traced.watch.gone: print(life.tag, life.items, removal_reason(life))\n"
    )
    answers = set()
    for seed in ("0", "1", "2"):
        environment = {**os.environ, "PYTHONHASHSEED": seed}
        folder = Path(__file__).resolve().parents[1] / "golden" / "compiler_of_parts"
        done = subprocess.run(
            [sys.executable, "-c", program], cwd=folder, env=environment, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
        answers.add(done.stdout)
    assert len(answers) == 1
