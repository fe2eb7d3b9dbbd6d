"""What replicates make of random models, as computed and as MuJoCo compiles it: names, order, and what it drops."""

from __future__ import annotations

import random
import sys
from collections.abc import Iterator
from pathlib import Path

import mujoco
import pytest
from link.workshop import OLDER
from lxml import etree
from mjcompose.base.sink import Sink
from mjcompose.link.boundaries import crossings
from mjcompose.link.existence import WrittenElements
from mjcompose.link.expansion import Expansion, in_order, name_of_holder
from mjcompose.link.linking import Linking
from mjcompose.mujoco.attributes import all_names
from mjcompose.tree.unit import Unit

SEEDS = range(20)
AFFECTED = ("equality", "actuator", "custom")
"""The sections of which MuJoCo drops elements."""


class RandomModel:
    """A model with replicates in replicates, and elements that refer to random bodies, joints, geoms and sites.

    Names consist of letters, so no name is another one with a number.
    """

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.count = 0
        self.world = "".join(self.content(2) for _ in range(4))
        self.text = self.model(self.sections())

    def model(self, sections: str) -> str:
        return f"<mujoco><worldbody>{self.world}</worldbody>{sections}</mujoco>"

    def content(self, depth: int) -> str:
        if depth and self.random.random() < 0.45:
            count = self.random.choice((1, 2, 3, 11 if depth == 1 else 2))
            separator = self.random.choice(("", "_", "-"))
            inner = "".join(self.content(depth - 1) for _ in range(self.random.choice((1, 1, 2))))
            return f'<replicate count="{count}" offset=".1 0 0" sep="{separator}">{inner}</replicate>'
        return self.body(depth)

    def body(self, depth: int) -> str:
        letter = "abcdefghijklmnopqrstuvwxyz"[self.count]
        self.count += 1
        inner = self.content(depth - 1) if depth and self.random.random() < 0.3 and self.count < 12 else ""
        nameless = '<geom size=".01"/><site/>' if self.random.random() < 0.5 else ""
        return (
            f'<body name="{letter}b"><joint name="{letter}j"/><geom name="{letter}g" type="sphere" size=".02"/>'
            f'<site name="{letter}s"/>{nameless}{inner}</body>'
        )

    def one(self, kind: str) -> str:
        return self.random.choice("abcdefghijklmnopqrstuvwxyz"[: self.count]) + kind

    def two(self, kind: str) -> tuple[str, str]:
        first, second = self.random.sample("abcdefghijklmnopqrstuvwxyz"[: self.count], 2)
        return first + kind, second + kind

    def sections(self) -> str:
        rows: dict[str, list[str]] = {}
        for name in "pqr":
            for section, row in self.rows(name):
                if self.random.random() < 0.4 and (section in AFFECTED or self.is_accepted(section, row)):
                    rows.setdefault(section, []).append(row)
        return "".join(f"<{section}>{''.join(found)}</{section}>" for section, found in rows.items())

    def is_accepted(self, section: str, row: str) -> bool:
        """Whether MuJoCo takes it: it refuses references to an element that is written after the replicate."""
        try:
            mujoco.MjModel.from_xml_string(self.model(f"<{section}>{row}</{section}>"))
        except ValueError:
            return False
        return True

    def rows(self, name: str) -> Iterator[tuple[str, str]]:
        bodies, joints, geoms, sites = map(self.two, "bjgs")
        yield "contact", f'<pair name="{name}" geom1="{geoms[0]}" geom2="{geoms[1]}"/>'
        yield "contact", f'<exclude name="e{name}" body1="{bodies[0]}" body2="{bodies[1]}"/>'
        yield "equality", f'<weld name="w{name}" body1="{bodies[0]}" body2="{bodies[1]}"/>'
        yield "equality", f'<connect name="k{name}" body1="{bodies[0]}" body2="world" anchor="0 0 0"/>'
        yield "equality", f'<joint name="j{name}" joint1="{joints[0]}" joint2="{joints[1]}"/>'
        yield "equality", f'<connect name="c{name}" site1="{sites[0]}" site2="{sites[1]}"/>'
        yield "actuator", f'<motor name="m{name}" joint="{joints[0]}"/>'
        yield "actuator", f'<general name="g{name}" site="{sites[0]}" refsite="{sites[1]}"/>'
        yield (
            "sensor",
            f'<framepos name="f{name}" objtype="site" objname="{sites[0]}" reftype="body" refname="{bodies[1]}"/>',
        )
        yield "sensor", f'<distance name="d{name}" geom1="{geoms[0]}" geom2="{geoms[1]}"/>'
        yield "sensor", f'<jointpos joint="{joints[1]}"/>'
        if name == "p":  # once, since MuJoCo needs the name of a tendon
            path = "".join(f'<joint joint="{joint}" coef="1"/>' for joint in joints)
            yield (
                "tendon",
                f'<fixed name="T">{path}</fixed><fixed name="U"><joint joint="{joints[0]}" coef="1"/></fixed>',
            )
        if not OLDER:
            elements = "".join(f'<element objtype="body" objname="{body}"/>' for body in bodies)
            yield "custom", f'<tuple name="t{name}">{elements}</tuple>'


def linking_of(text: str) -> Linking:
    return Linking(Unit(etree.fromstring(text), "model.xml", Path(), label="model"), [], Sink())


def compiled(root: etree._Element) -> dict[str, list[str]]:
    return all_names(mujoco.MjModel.from_xml_string(etree.tostring(root).decode()))


@pytest.mark.parametrize("seed", SEEDS)
def test_everything_that_is_written_is_compiled_once(seed: int) -> None:
    linking = linking_of(RandomModel(seed).text)
    crossings(linking)
    root = linking.base.root
    names = compiled(root)
    assert list(WrittenElements.of(root).faults(names)) == []
    for section in ("actuator", "sensor"):
        assert [name_of_holder(holder) for holder in in_order(root, section)] == names[section]


def test_without_the_copies_mujoco_drops_exactly_the_crossing_elements() -> None:
    dropped = 0
    for seed in SEEDS:
        root = etree.fromstring(RandomModel(seed).text)
        try:
            faults = list(WrittenElements.of(root).faults(compiled(root)))
        except ValueError:  # an element that it does not drop refers to what it has removed
            continue
        crossing = {each.row.element for each in Expansion.of(root).crossings}
        with_world = {each for each in crossing if "world" in each.attrib.values()}
        assert crossing - with_world <= {fault.element for fault in faults} <= crossing
        assert all(fault.is_missing for fault in faults)
        dropped += len(faults)
    assert dropped


ACCIDENTS = {
    "clock": ("", '<sensor><clock name="t"/></sensor>', "sensor"),
    "numbers": (
        '<body name="b"><joint name="j1"/><joint name="j10" axis="1 0 0"/><geom size=".1"/></body>',
        '<actuator><motor name="m" joint="j1"/></actuator>',
        "actuator",
    ),
}


@pytest.mark.parametrize(("bodies", "sections", "kind"), ACCIDENTS.values(), ids=ACCIDENTS.keys())
def test_what_mujoco_multiplies_by_mistake_is_found(bodies: str, sections: str, kind: str) -> None:
    replicate = '<replicate count="2"><site name="s"/></replicate>'
    root = etree.fromstring(f"<mujoco><worldbody>{bodies}{replicate}</worldbody>{sections}</mujoco>")
    (fault,) = WrittenElements.of(root).faults(compiled(root))
    assert fault.kind == kind
    assert not fault.is_missing
    assert fault.element is root.find(f"{kind}/*")


def calls(count: int) -> int:
    """The function calls to expand a model with as many replicates, motors and sensors, and to compare it."""
    world = "".join(
        f'<replicate count="2"><body name="b{letter}"><joint name="j{letter}"/></body></replicate>'
        for letter in map(letters, range(count))
    )
    motors = "".join(f'<motor name="m{letter}" joint="j{letter}"/>' for letter in map(letters, range(count)))
    sensors = "".join(f'<actuatorpos name="s{letter}" actuator="m{letter}"/>' for letter in map(letters, range(count)))
    text = f"<mujoco><worldbody>{world}</worldbody><actuator>{motors}</actuator><sensor>{sensors}</sensor></mujoco>"
    root = etree.fromstring(text)
    counted = 0

    def count_call(frame: object, event: str, argument: object) -> None:
        nonlocal counted
        counted += event in ("call", "c_call")

    sys.setprofile(count_call)
    try:
        written = WrittenElements.of(root)
    finally:
        sys.setprofile(None)
    assert len(written.elements["sensor"]) == 2 * count
    return counted


def letters(number: int) -> str:
    return "".join("abcdefghij"[int(digit)] for digit in str(number)) + "x"


def test_twice_the_replicates_and_sensors_take_twice_the_work() -> None:
    assert calls(200) < 2.2 * calls(100)
