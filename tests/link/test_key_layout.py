"""The layout of a key is MuJoCo's: every joint, actuator and mocap body is where its compiled model has it.

The order of multiplied actuators is MuJoCo's.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import mujoco
import pytest
from hypothesis import given, settings, strategies as st
from link.workshop import OLDER, told
from lxml import etree
from mjcompose.base.sink import Sink
from mjcompose.link.expansion import Copy, actuators_in_order, suffixes
from mjcompose.link.key_layout import BLOCK, Holder, Slot
from mjcompose.link.linking import Linking
from mjcompose.link.measure import measure_with
from mjcompose.link.unit_keys import layout_of
from mjcompose.mujoco.engine import Session
from mjcompose.sources.context import Context
from mjcompose.tree.parse import parse_file, parse_text
from mjcompose.tree.unit import Unit


def ends(holder: Holder) -> str:
    within = holder.within if isinstance(holder, Copy) else ()
    return "".join(suffixes(replicate)[number] for replicate, number in within)


def called(holder: Holder) -> str:
    element = holder.element if isinstance(holder, Copy) else holder
    name = str(element.get("name") or "")
    return name + ends(holder) if name else ""


def is_of(model: mujoco.MjModel, joint: int, holder: Holder, slot: Slot) -> bool:
    """Whether a joint of MuJoCo's is the holder's, or one of the holder's."""
    body = model.body(model.jnt_bodyid[joint]).name
    if slot.kind != BLOCK:
        return model.joint(joint).name == called(holder) and (
            ("free", "ball", "slide", "hinge")[model.jnt_type[joint]] == slot.kind
        )
    element = holder.element if isinstance(holder, Copy) else holder
    if isinstance(holder, Copy) and holder.twists:
        return body.startswith(f"{element.get('name')}_twist")
    if element.tag != "flexcomp":
        return body.startswith(str(element.get("prefix") or ""))
    return (
        body.startswith(f"{element.get('name')}_")
        and body.endswith(ends(holder))
        and model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_SLIDE
    )


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    with Session() as session:
        yield session


def wrong(unit: Unit, model: mujoco.MjModel, session: Session) -> Iterator[str]:
    """Yield what the layout has elsewhere than MuJoCo."""
    sink = Sink()
    linking = Linking(unit, [], sink, measure=measure_with(Context(sink, {}, unit.directory), session=session))
    layout = layout_of(linking, unit)
    if layout is None:  # an `<attach>` in a `<replicate>`, or of a frame of the same model: its keys are refused
        assert "cannot be laid out" in told(sink) and next(unit.root.iter("attach"), None) is not None
        return
    joint = 0
    for holder, slot in layout.joints.items():
        end = joint
        while end < model.njnt and model.jnt_qposadr[end] < model.jnt_qposadr[joint] + slot.widths[0]:
            end += 1
        if not slot.widths[0]:
            continue
        yield from (
            f"{model.joint(each).name or model.body(model.jnt_bodyid[each]).name} is not of {called(holder)}"
            for each in range(joint, end)
            if not is_of(model, each, holder, slot)
        )
        joint = end
    if joint != model.njnt or layout.total("qvel") != model.nv:
        yield f"{joint} of {model.njnt} joints"
    for at, holder in enumerate(layout.actuators):
        if getattr(holder, "tag", "") == "attach":
            break
        if model.actuator(at).name != called(holder):
            yield f"actuator {model.actuator(at).name} is not {called(holder)}"
    if (layout.total("act"), layout.total("ctrl")) != (model.na, model.nu):
        yield "another number of activations or controls"
    mocaps = [model.body(body).name for body in range(model.nbody) if model.body_mocapid[body] >= 0]
    found = [
        "" if getattr(holder, "tag", "") == "attach" else called(holder)
        for holder, count in layout.mocaps.items()
        for _ in range(count)
    ]
    if len(found) != len(mocaps) or any(name not in ("", there) for name, there in zip(found, mocaps, strict=True)):
        yield f"mocap bodies {found}, not {mocaps}"


class World:
    """A random world; its elements have names of their own."""

    def __init__(self, draw: st.DrawFn) -> None:
        self.draw = draw
        self.count = 0
        self.joints = 0

    def name(self) -> str:
        self.count += 1
        return f"b{self.count}x"

    def inside(self, depth: int, *, world: bool, bare: bool = False) -> str:
        """Elements in the world or elsewhere; a `<flexcomp>` in a `<replicate>` needs a body around it: not `bare`."""
        kinds = ["body", "body", "frame", "replicate", *(() if OLDER else ("rod",)), "cloth"]
        kinds += ["free", "mocap"] if world else []
        found = []
        for kind in self.draw(st.lists(st.sampled_from(kinds), max_size=3 if depth else 2)):
            if kind in ("rod", "cloth"):
                found.append("" if bare else self.flex(kind))
            elif depth and kind == "frame":
                found.append(f"<frame>{self.inside(depth - 1, world=world, bare=bare)}</frame>")
            elif depth and kind == "replicate":
                count = self.draw(st.integers(1, 3))
                sep = self.draw(st.sampled_from(["", "_"]))
                inner = self.inside(depth - 1, world=world, bare=True)
                found.append(f'<replicate count="{count}" offset="0 1 0" sep="{sep}">{inner}</replicate>')
            elif depth:
                found.append(self.body(kind, depth))
        return "".join(found)

    def body(self, kind: str, depth: int) -> str:
        name = self.name()
        joint = f'<freejoint name="j{name}"/>' if kind == "free" else ""
        inner = ""
        if kind != "mocap":
            inner = self.inside(depth - 1, world=False)
        # A joint above a flex is only allowed where a vertex is pinned, as they are here.
        if kind == "body":
            joint = "".join(
                f'<joint name="j{name}{at}" type="{type}"/>'
                for at, type in enumerate(self.draw(st.lists(st.sampled_from(("hinge", "slide")), max_size=2)))
            )
        mocap = ' mocap="true"' if kind == "mocap" else ""
        # The joint is written last: it comes first all the same.
        return f'<body name="{name}"{mocap}><geom size=".1"/>{inner}{joint}</body>'

    def flex(self, kind: str) -> str:
        pins = '<pin id="0"/>'
        shape = 'dim="1" count="4 1 1"'
        young = '<elasticity young="1e5"/>'
        if kind == "cloth":
            young = ""
            shape = self.draw(
                st.sampled_from(
                    ['dim="2" count="2 3 1"', 'dim="3" count="2 2 2"', 'dim="2" count="3 2 1" rigid="true"']
                )
            )
        return (
            f'<flexcomp name="{self.name()}" type="grid" {shape} spacing=".1 .1 .1" mass=".1" radius=".01">{pins}'
            f'<edge equality="true"/><contact selfcollide="none"/>{young}</flexcomp>'
        )


@st.composite
def models(draw: st.DrawFn) -> str:
    world = World(draw)
    return f"<mujoco><worldbody>{world.inside(3, world=True)}</worldbody></mujoco>"


@given(text=models())
@settings(max_examples=40, deadline=None)
def test_random_worlds_are_laid_out_as_in_mujoco(session: Session, text: str) -> None:
    try:
        model = mujoco.MjModel.from_xml_string(text)
    except ValueError:
        return
    unit = parse_text(text.encode(), Sink(), file="m.xml", directory=Path(), label="m")
    assert unit is not None
    assert list(wrong(unit, model, session)) == []


@pytest.mark.slow
def test_all_models_of_the_corpus_are_laid_out_as_in_mujoco(corpus: Path, session: Session) -> None:
    checked = 0
    for path in sorted(corpus.rglob("*.xml")):
        try:
            model = mujoco.MjModel.from_xml_path(str(path))
        except ValueError:
            continue
        sink = Sink()
        unit = parse_file(path, sink)
        if unit is not None:
            checked += 1
            assert list(wrong(unit, model, session)) == [], path
    assert checked > 100


def body(name: str, inside: str = "") -> str:
    return f'<body name="{name}"><joint name="{name}j"/><site name="{name}s"/><geom size=".1"/>{inside}</body>'


def replicate(count: int, inside: str, sep: str = "") -> str:
    return f'<replicate count="{count}" offset="1 0 0" sep="{sep}">{inside}</replicate>'


WORLDS = {
    "none": body("a") + body("r") + body("s"),
    "one": body("a") + replicate(2, body("r")) + body("s"),
    "two": body("a") + replicate(3, body("s")) + replicate(2, body("r"), "-"),
    "nested": replicate(2, replicate(3, body("r"), "_") + body("s")) + body("a"),
    "deep": body("a", replicate(2, body("r", replicate(2, body("s"))))),
    "many": body("a") + replicate(12, body("r")) + replicate(1, body("s")),
    "in a frame": f"<frame>{replicate(2, body('r'))}</frame>{body('a', body('s'))}",
}


@pytest.mark.parametrize("world", WORLDS.values(), ids=WORLDS.keys())
@pytest.mark.parametrize("tendons", [False, True], ids=["", "tendons"])
def test_order(world: str, tendons: bool) -> None:
    actuators = "".join(f'<motor name="m{n}" joint="{j}"/>' for n, j in enumerate(("rj", "aj", "sj", "rj")))
    sites = ""
    if tendons:
        sites = (
            '<fixed name="t"><joint joint="rj" coef="1"/></fixed><fixed name="u"><joint joint="sj" coef="1"/></fixed>'
        )
        actuators += '<motor name="mt" tendon="t"/><motor name="mu" tendon="u"/><motor name="ms" site="rs"/>'
    text = f"<mujoco><worldbody>{world}</worldbody><tendon>{sites}</tendon><actuator>{actuators}</actuator></mujoco>"
    model = mujoco.MjModel.from_xml_string(text)
    count = model.nactuator if hasattr(model, "nactuator") else model.nu
    names = [model.actuator(index).name for index in range(count)]
    found = []
    for holder in actuators_in_order(etree.fromstring(text)):
        element = holder.element if isinstance(holder, Copy) else holder
        found.append(
            (str(element.get("name")), tuple(number for _, number in holder.within) if isinstance(holder, Copy) else ())
        )
    assert len(found) == len(names)
    for (name, numbers), compiled in zip(found, names, strict=True):
        assert compiled.startswith(name)
        digits = "".join(filter(str.isdigit, compiled.removeprefix(name)))
        assert digits.lstrip("0") == "".join(map(str, numbers)).lstrip("0")
