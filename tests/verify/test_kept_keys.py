"""Keys that are not what is meant are errors, whatever goes wrong with the layout."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from pathlib import Path

import mujoco
import pytest
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.link import key_layout, keyframes, numbers
from mjcompose.link.key_layout import KeyLayout
from mjcompose.link.unit_keys import MARK
from mjcompose.mujoco.compare import key_rows
from mjcompose.mujoco.engine import Session
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

pytestmark = pytest.mark.mujoco4("it refuses keys beside joints in a replicate, and short ones")
POSTS = """
<mujoco model="posts"><worldbody>
  <replicate count="2" offset="0 1 0"><body name="post"><joint name="pj"/><geom size=".05"/><site name="hook" pos="0 0 .2"/>
    </body></replicate>
  <body name="last" pos="3 0 0"><joint name="lj"/><geom size=".05"/></body></worldbody>
  <actuator><motor name="pm" joint="pj"/><general name="lm" joint="lj" dyntype="filter"/></actuator>
  <keyframe><key name="k" qpos=".1 .2 .3" ctrl=".11 .22 .33" act=".5"/></keyframe></mujoco>
"""
TOOL = """
<mujoco model="tool"><worldbody><body name="a" pos="0 0 1"><joint name="j"/><geom size=".1"/>
  <body><joint type="ball"/><geom size=".1"/></body></body>
  <body name="loose" pos="1 2 3"><freejoint name="free"/><geom size=".1"/></body><body name="goal" mocap="true" pos="0 0 2"/>
  </worldbody><actuator><motor name="m" joint="j"/><muscle joint="j" lengthrange="0 1"/></actuator>
  <keyframe><key name="k" qpos=".4 2 0 0 0 4 5 6 1 1 0 0" qvel="1 2 3 4 5 6 7 8 9 10" ctrl=".7 .8" act=".9"
    mpos="7 8 9" mquat="0 3 0 4"/><key name="short" qpos=".4"/></keyframe></mujoco>
"""
ROD = """
<mujoco model="rod"><worldbody><body name="holder" pos="0 0 1"><geom size=".05"/>
  <flexcomp name="rod" type="grid" count="4 1 1" spacing=".1 .1 .1" dim="1" mass=".1" radius=".01">
    <edge equality="true"/><elasticity young="1e5" poisson="0"/><contact selfcollide="none"/></flexcomp>
  <body name="in"><joint name="ij"/><geom size=".05"/></body></body></worldbody>
  <keyframe><key name="k" qpos="1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16"/></keyframe></mujoco>
"""
SOURCES = {"posts.xml": POSTS, "tool.xml": TOOL, "rod.xml": ROD}
Wrong = Callable[[str], list[Diagnostic]]


@pytest.fixture(scope="module")
def session() -> object:
    with Session() as session:
        yield session


@pytest.fixture
def wrong(tmp_path: Path, session: Session) -> Wrong:
    for name, text in SOURCES.items():
        (tmp_path / name).write_text(text)

    def wrong(recipe: str) -> list[Diagnostic]:
        (tmp_path / "recipe.yaml").write_text("recipe: 1\n" + recipe)
        context = Context(environment={}, folder=tmp_path)
        build(ModelRequest(tmp_path / "recipe.yaml"), context, session=session)
        found = context.sink.errors
        assert all(each.code == "keyframe-wrong" for each in found), found
        return list(found)

    return wrong


IN_REPLICATE = "base: ./posts.xml\nattach: {t: {model: ./posts.xml, drop: [actuator], site: hook, keys: prefix}}"
EVERYTHING = """
base: ./posts.xml
attach:
  t: {model: ./tool.xml, pos: [1, 2, 3], euler: [10deg, 20deg, 30deg]}
  u: {model: {base: ./tool.xml, attach: {v: {model: ./tool.xml, pos: [0, 1, 0]}}}, pos: [0, 0, 5], keys: prefix}
  w: {model: ./tool.xml, euler: [0deg, 0deg, 90deg], drop: [key]}
add: [{to: post, body: {name: flag, joint: {name: new, type: ball}, geom: {size: 0.02}}}]
edit:
  - {select: {actuator: t/m}, convert: {to: position, kp: 4}}
  - {select: {joint: u/j}, rename: turned}
  - {select: {body: last}, move: {to: t/a}}
  - {select: {key: u/short}, set: {qpos: 0}}
keyframe:
  mine: {from: {base: k, t: k}, qpos: {u/v/j: 0.2rad, u/free: [1, 2, 3, 2, 0, 0, 0]}, ctrl: {t/m: hold}, act: {lm: 3}}
  held: {qpos: {t/j: 0.3rad}, ctrl: {hold: forces, t/m: 0.1rad}}
  k: {from: {w: k}}
"""


NESTED = """
attach:
  t:
    keys: prefix
    model:
      base: ./tool.xml
      edit: [{select: {actuator: m}, convert: {to: position, kp: 4}}]
      keyframe: {held: {qpos: {j: 0.3rad}, ctrl: {m: hold}}, k: {ctrl: {hold: forces}}}
keyframe: {mine: {from: {t: held}}, other: {from: {t: k}, qpos: {t/j: 0.1rad}}}
"""
IN_ROWS = """
attach:
  r: {model: {base: ./posts.xml, attach: {t: {model: ./posts.xml, drop: [actuator], site: hook}}}, keys: prefix}
  s: {model: ./posts.xml, pos: [9, 0, 0], replicate: [{count: 2, offset: [0, 5, 0]}]}
"""
# The key `short` says nothing of this body.
MOVED = "base: ./tool.xml\nedit: [{select: {body: loose}, set: {pos: [7, 7, 7]}}]"
IN_A_POST = """
base: ./posts.xml
attach: {t: {model: ./rod.xml, pos: [0, 2, 0]}}
edit:
  - {select: {flexcomp: t/rod}, rename: t/wire}
  - {select: {body: t/holder}, move: {to: world}}
  - {select: {joint: pj}, set: {type: slide}}
keyframe: {mine: {from: {t: k}}}
"""


@pytest.mark.parametrize("recipe", [IN_REPLICATE, EVERYTHING, NESTED, IN_ROWS, MOVED, IN_A_POST])
def test_keys_that_are_right_are_no_error(wrong: Wrong, recipe: str) -> None:
    assert wrong(recipe) == []


CONVERTED = "base: ./tool.xml\nedit: [{select: {actuator: m}, convert: {to: position, kp: 4}}]\nkeyframe: "


@pytest.mark.parametrize(
    ("key", "line"),
    [("new: {ctrl: {m: 0.3rad}}", 4), ("new: {qpos: {j: 0.3rad}, ctrl: hold}", 4), ("k: {ctrl: {m: 0.3rad}}", 4)],
)
def test_edits_that_empty_newer_keys_are_found(
    wrong: Wrong, monkeypatch: pytest.MonkeyPatch, key: str, line: int
) -> None:
    row = keyframes.KeyFiller.row

    def emptying(self: keyframes.KeyFiller, vector: str, final: KeyLayout, values: object, void: object) -> object:
        return row(self, vector, final, values, self.linking.keys.void_keys)  # type: ignore[arg-type]

    assert wrong(f"{CONVERTED}{{{key}}}") == []
    monkeypatch.setattr(keyframes.KeyFiller, "row", emptying)
    (found,) = wrong(f"{CONVERTED}{{{key}}}")
    assert found.message.startswith("`ctrl` of the actuator `m` is 0, not 0.3, in the key ")
    assert found.span is not None
    assert (found.span.file, found.span.line) == ("recipe.yaml", line)


def _as_a_block(self: object, child: object, within: object, layout: KeyLayout, twists: KeyLayout) -> None:
    """Lay a replicate out as it was before: joint by joint of its first copy, then of the second."""
    inner = _as_is(self, child, within, layout, twists)  # type: ignore[arg-type]
    if child.tag == "replicate":  # type: ignore[attr-defined]
        joints = sorted(layout.joints.items(), key=lambda each: getattr(each[0], "element", each[0]).get("name"))
        layout.joints.clear()
        layout.joints.update(joints)
    return inner


_as_is = key_layout._Reader._inner


def test_another_order_inside_of_a_replicate_is_found(wrong: Wrong, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(key_layout._Reader, "_inner", _as_a_block)
    found = wrong("base: ./posts.xml\nadd: [{to: post, body: {name: flag, joint: {name: new}, geom: {size: 0.02}}}]")
    assert [each.message for each in found] == [
        "`qpos` of the joint `pj0` is 0, not 0.1, in the key `k` of the finished model"
    ]
    assert found[0].span is not None and found[0].span.file == "posts.xml"


def test_twists_that_stand_with_their_rod_are_found(wrong: Wrong, monkeypatch: pytest.MonkeyPatch) -> None:
    recipe = "base: ./posts.xml\nattach: {t: {model: ./rod.xml}}\nadd: [{to: t/in, body: {name: x, joint: {name: xj}, geom: {size: 1}}}]"
    assert wrong(recipe) == []

    def beside(self: object, child: object, within: object, layout: KeyLayout, twists: KeyLayout) -> None:
        _as_is(self, child, within, layout, layout)  # type: ignore[arg-type]

    monkeypatch.setattr(key_layout._Reader, "_inner", beside)
    found = wrong(recipe)
    assert found
    assert "_twist_" in found[0].message + str(found[0].notes)


@pytest.mark.parametrize(
    ("vector", "damage"),
    [
        *product(("qpos", "qvel", "act", "ctrl", "mpos", "mquat"), ("lost", "reversed")),
        *product(("qpos", "qvel", "act", "ctrl", "mpos"), ("negated",)),  # a negative quaternion is the same turn
    ],
)
def test_a_damage_to_any_vector_is_found(
    wrong: Wrong, monkeypatch: pytest.MonkeyPatch, vector: str, damage: str
) -> None:
    row = keyframes.KeyFiller.row

    def damaged(self: keyframes.KeyFiller, which: str, final: KeyLayout, values: object, void: object) -> object:
        found = row(self, which, final, {} if which == vector and damage == "lost" else values, void)  # type: ignore[arg-type]
        if which == vector and damage == "negated":
            return [each._replace(text=numbers.text([-float(each.text)])) for each in found]
        return found[::-1] if which == vector and damage == "reversed" else found

    monkeypatch.setattr(keyframes.KeyFiller, "row", damaged)
    found = wrong(
        "base: ./posts.xml\nattach: {t: {model: ./tool.xml, pos: [1, 2, 3]}}\nkeyframe: {mine: {from: {t: k}}}"
    )
    assert found
    assert all(f"`{vector}` of the " in each.message for each in found)
    tool = [each.span for each in found if "in the key `k`" in each.message]
    assert all(span is not None and span.file in SOURCES for span in tool)


@pytest.mark.parametrize("names", ["ab", "ba", "a", "abc"])
def test_only_a_bare_model_with_the_same_names_is_a_measure(names: str) -> None:
    texts = [
        "<mujoco><worldbody>"
        + "".join(f'<body><joint name="{each}"/><geom size="1"/></body>' for each in joints)
        + "</worldbody></mujoco>"
        for joints in (names, "ab")
    ]
    whole = mujoco.MjModel.from_xml_string(texts[1])
    found = key_rows(mujoco, whole, {"texts": texts[:1], "mark": MARK, "held": []})
    assert ("unlike" in found) == (names != "ab")


def test_a_layout_that_reads_sources_wrongly_is_found(wrong: Wrong, monkeypatch: pytest.MonkeyPatch) -> None:
    cut = KeyLayout.holders
    monkeypatch.setattr(KeyLayout, "holders", lambda layout, vector: cut(layout, vector)[::-1])
    assert wrong("base: ./posts.xml\nattach: {t: {model: {base: ./posts.xml}, pos: [0, 0, 5]}}")
