from __future__ import annotations

from typing import Any

import pytest
from mjcompose.base.diagnostic import Fault
from mjcompose.language.value import bare_angle, read_value
from mjcompose.text.expression import Angle
from mjcompose.tree.grammar import GRAMMAR


@pytest.mark.parametrize(
    ("path", "name", "value", "joint", "at", "instead"),
    [
        ("site", "euler", (0, 90, 0), None, (1,), "euler: [0, 90deg, 0]"),
        ("site", "euler", (90, 0, 45), None, (), "euler: [90deg, 0, 45deg]"),
        ("site", "euler", (1.57, 0, 0), None, (0,), "euler: [1.57rad, 0, 0]"),
        ("site", "axisangle", (0, 0, 1, 90), None, (3,), "axisangle: [0, 0, 1, 90deg]"),
        ("replicate", "euler", (0, 0, 30), None, (2,), "euler: [0, 0, 30deg]"),
        ("joint", "ref", 90, "hinge", (), "ref: 90deg"),
        ("joint", "range", (-90, 90), "ball", (), "range: [-90deg, 90deg]"),
        ("joint", "springyield", 90, "ball", (), "springyield: 90deg"),
    ],
)
def test_told(path: str, name: str, value: Any, joint: str | None, at: tuple[int, ...], instead: str) -> None:
    fault = bare_angle(GRAMMAR.element(path).attributes[name], value, joint, (), "it")
    assert fault is not None
    assert (fault.code, fault.at) == ("bare-angle", at)
    assert fault.help is not None
    assert f"`{instead}`" in fault.help
    assert "`angle: " in fault.help


@pytest.mark.parametrize(
    ("path", "name", "value", "joint"),
    [
        ("site", "euler", (0, 0.0, 0), None),
        ("site", "euler", (Angle(90.0, "deg"), 0, 0), None),
        ("site", "axisangle", (0, 0, 1, Angle(90.0, "deg")), None),
        ("site", "pos", (1, 2, 3), None),
        ("joint", "range", (0, 90), None),
        ("joint", "range", (0, 90), "slide"),
        ("joint", "ref", 90, "ball"),
        ("camera", "fovy", 60, None),
    ],
)
def test_fine(path: str, name: str, value: Any, joint: str | None) -> None:
    assert bare_angle(GRAMMAR.element(path).attributes[name], value, joint, (), "it") is None


def read(path: str, name: str, value: Any) -> tuple[Any, list[Fault]]:
    faults: list[Fault] = []
    return read_value(
        GRAMMAR.element(path).attributes[name], value, ("x",), "`e`", faults, tag=path.rpartition("/")[2]
    ), faults


@pytest.mark.parametrize(
    ("path", "name", "value", "kept"),
    [
        ("geom", "euler", [1, 2.5, "90deg"], (1, 2.5, Angle(90.0, "deg"))),
        ("geom", "axisangle", [0, 0, 1, "90deg"], (0, 0, 1, Angle(90.0, "deg"))),
        ("geom", "mass", 2, 2),
        ("joint", "ref", "-1e-1rad", Angle(-0.1, "rad")),
        ("geom", "size", 0.5, 0.5),
        ("geom", "condim", 3.0, 3.0),
        ("joint", "limited", True, True),
        ("joint", "limited", "auto", "auto"),
        ("visual/headlight", "active", 1, 1),
        ("geom", "name", "a b/c", "a b/c"),
        ("geom", "name", "90deg", "90deg"),
        ("sensor/contact", "data", ["found", "force"], ("found", "force")),
        ("flex", "body", ["a", "b"], ("a", "b")),
        ("flex", "body", "a", "a"),
        ("option", "actuatorgroupdisable", [1, 2], (1, 2)),
    ],
)
def test_kept(path: str, name: str, value: Any, kept: Any) -> None:
    assert read(path, name, value) == (kept, [])


@pytest.mark.parametrize(
    ("path", "name", "value", "code", "at", "help"),
    [
        ("geom", "pos", "0 0 0.1", "wrong-type", (), "write `pos: [0, 0, 0.1]`"),
        ("geom", "pos", [0, 1], "wrong-length", (), "write `pos: [x, y, z]`"),
        ("geom", "pos", 1, "wrong-length", (), "write `pos: [x, y, z]`"),
        ("geom", "pos", [0, "a", 1], "wrong-type", (1,), None),
        ("geom", "pos", [0, [1], 1], "wrong-type", (1,), None),
        ("geom", "euler", [0, "1 deg", 1], "wrong-type", (1,), "write `1deg`"),
        ("geom", "pos", {"x": 1}, "wrong-type", (), None),
        ("geom", "mass", [1], "wrong-type", (), None),
        ("geom", "mass", "0.5", "wrong-type", (), "write `0.5` without quotes"),
        ("geom", "mass", True, "wrong-type", (), None),
        ("geom", "mass", "1e999deg", "wrong-type", (), None),
        ("geom", "condim", 2.5, "wrong-type", (), None),
        ("geom", "condim", "90deg", "wrong-type", (), None),
        ("geom", "condim", 2**31, "out-of-range", (), None),
        ("geom", "fluidcoef", [2**2000, 1, 1, 1, 1], "out-of-range", (0,), None),
        ("frame", "scale", [1, 2], "wrong-length", (), None),
        ("geom", "type", "Box", "wrong-keyword", (), "write `box`"),
        ("geom", "type", ["box"], "wrong-type", (), None),
        ("joint", "limited", "yes", "wrong-keyword", (), "write `true`"),
        ("visual/global", "orthographic", "no", "wrong-type", (), "write `false`"),
        ("geom", "name", 7, "wrong-type", (), "quote it: '7'"),
        ("geom", "name", "a\x01", "bad-name", (), None),
        ("geom", "mesh", ["a"], "wrong-type", (), None),
        ("flex", "body", "a b", "wrong-type", (), "write `body: [a, b]`"),
        ("flex", "body", ["a", "\x01"], "bad-name", (1,), None),
        ("flex", "body", [], "wrong-length", (), None),
        ("sensor/contact", "data", ["found", "forces"], "wrong-keyword", (), "write `force`"),
        ("sensor/contact", "data", ["force", "found"], "wrong-keyword", (), None),
        ("texture", "gridlayout", "." * 13, "wrong-length", (), None),
    ],
)
def test_refused(path: str, name: str, value: Any, code: str, at: tuple[int, ...], help: str | None) -> None:
    kept, (fault,) = read(path, name, value)
    assert kept is None
    assert (fault.code, fault.at, fault.help) == (code, ("x", *at), help)
    assert fault.message.startswith(f"`{name}` of `e` ")
    assert ";" not in fault.message


def test_long_list_of_keywords_is_a_note() -> None:
    _, (fault,) = read("sensor/user", "objtype", "gom")
    assert fault.message == "`objtype` of `e` has no keyword `gom`"
    assert fault.notes[0].message.startswith("keywords that exist: geom, ")
    assert fault.help == "write `geom`"
