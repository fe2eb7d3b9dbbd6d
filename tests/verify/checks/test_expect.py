from __future__ import annotations

import mujoco
import pytest
from mjcompose.language.checks.expect import COUNTS
from mjcompose.mujoco.attributes import TAGS, NameTable, array_of, attributes
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.verify.checks.check import Scope
from mjcompose.verify.checks.expect import _size

from tests.verify.checks.conftest import notes

MODEL = """
<mujoco>
  <worldbody>
    <light name="lamp" cutoff="30"/><camera name="eye" fovy="60"/>
    <body name="b" pos="0 0 1">
      <joint name="hinge" range="-90 180" damping="3" ref="30"/><geom name="g" size=".1" friction="1 .2 .3" rgba=".1 .2 .3 1"/>
      <body name="c"><joint name="slide" type="slide" range="-1 2"/><geom name="h" size=".1" friction=".5"/></body>
    </body>
  </worldbody>
  <sensor><jointpos name="turn" joint="hinge" cutoff="1.5707963267948966"/></sensor>
  <actuator><position name="a" joint="hinge" kp="7" ctrlrange="-1 1"/><position name="p" joint="slide" ctrlrange="-2 2"/></actuator>
</mujoco>
"""


@pytest.mark.parametrize(
    "check",
    [
        "select: {joint: hinge}, attr: damping, equals: 3",
        'select: {joint: hinge}, attr: "range[1]", equals: 180deg, tol: 1e-6',
        "select: {joint: hinge}, attr: range, equals: [-90deg, 180deg]",
        "select: {joint: hinge}, attr: range, equals: [-1.57rad, 3.14rad], tol: 0.1deg",
        "select: {joint: hinge}, attr: range, range: [-90deg, 180deg]",
        'select: {joint: "*"}, attr: damping, range: [0, 3]',
        'select: {joint: "*"}, count: 2, attr: damping, range: [0, 3]',
        "select: {joint: slide}, attr: range, equals: [-1, 2]",
        "select: {joint: hinge}, attr: ref, equals: 30deg",
        "select: {joint: hinge}, attr: limited, equals: true",
        "select: {joint: hinge}, attr: axis, equals: [0, 0, 1]",
        "select: {geom: g}, attr: rgba, equals: [0.1, 0.2, 0.3, 1]",
        'select: {geom: "*"}, attr: condim, equals: 3',
        "select: {camera: eye}, attr: fovy, equals: 60deg",
        "select: {camera: eye}, attr: fovy, equals: 1.0471975512rad",
        "select: {light: lamp}, attr: cutoff, equals: 30",
        "select: {light: lamp}, attr: cutoff, equals: 30deg",
        "select: {sensor: turn}, attr: cutoff, equals: 90deg",
        'select: {actuator: a}, attr: "gainprm[0]", equals: 7',
        "select: {actuator: p}, attr: ctrlrange, equals: [-2, 2]",
        "select: {body: b}, attr: pos, equals: [0, 0, 1]",
    ],
)
def test_holds(ask, check: str) -> None:
    assert ask(MODEL, f"expect: {{{check}}}") == []


@pytest.mark.parametrize(
    ("check", "message"),
    [
        ("select: {joint: hinge}, attr: damping, equals: 3.00001", "`damping` of joint `hinge` is 3, not 3.00001"),
        (
            'select: {joint: hinge}, attr: "range[1]", equals: 170deg',
            "`range[1]` of joint `hinge` is 180deg, not 170deg",
        ),
        ("select: {joint: hinge}, attr: limited, equals: false", "`limited` of joint `hinge` is true, not false"),
        (
            "select: {geom: g}, attr: friction, equals: [1, 0.2, 0.4], tol: 0.05",
            "`friction` of geom `g` is [1, 0.2, 0.3], not [1, 0.2, 0.4] ± 0.05",
        ),
        (
            "select: {joint: hinge}, attr: range, equals: [-1.5rad, 3.14rad], tol: 1deg",
            "`range` of joint `hinge` is [-1.57079633rad, 3.14159265rad], not [-1.5rad, 3.14rad] ± 1deg",
        ),
        ('select: {geom: "*"}, attr: "friction[0]", equals: 1', "`friction[0]` of geom `h` is 0.5, not 1"),
    ],
)
def test_does_not_hold(ask, check: str, message: str) -> None:
    (finding,) = ask(MODEL, f"expect: {{{check}}}")
    assert (finding.message, finding.at, finding.code) == (message, ("equals",), "check-failed")
    assert [note.partition(":")[0] for note in notes(finding)] == ["expected", "actual"]


@pytest.mark.parametrize(
    ("check", "code", "at"),
    [
        ("select: {joint: hing}, attr: damping, equals: 3", "unknown-name", "select.joint"),
        ("select: {joint: hinge}, attr: range, equals: 3deg", "wrong-length", "equals"),
        ('select: {joint: hinge}, attr: "range[2]", equals: 3deg', "wrong-length", "attr"),
        ('select: {joint: hinge}, attr: "range[1]", equals: 3', "bare-angle", "equals"),
    ],
)
def test_what_makes_no_sense_of_this_model(ask, check: str, code: str, at: str) -> None:
    (finding,) = ask(MODEL, f"expect: {{{check}}}")
    assert (finding.code, finding.at) == (code, tuple(at.split(".")))


def test_bare_angles_have_the_unit_of_the_recipe(ask) -> None:
    assert ask(MODEL, 'expect: {select: {joint: hinge}, attr: "range[1]", equals: 180}', head="angle: degree") == []
    assert (
        ask(MODEL, 'expect: {select: {joint: hinge}, attr: "range[1]", equals: 3.14159265359}', head="angle: radian")
        == []
    )
    assert ask(MODEL, 'expect: {select: {joint: slide}, attr: "range[1]", equals: 2}', head="angle: degree") == []


def test_names_in_a_nested_recipe(ask) -> None:
    nested = MODEL.replace('name="', 'name="left/').replace('joint="', 'joint="left/')
    assert ask(nested, "expect: {select: {joint: hinge}, attr: damping, equals: 3}", prefix="left/") == []


def test_every_attribute_is_one_of_mjcf_and_has_an_array() -> None:
    model = mujoco.MjModel.from_xml_string(MODEL)
    tags = {
        "pair": "contact/pair",
        "key": "keyframe/key",
        "equality": "equality/weld",
        "tendon": "tendon/spatial",
        "actuator": "actuator/general",
        "sensor": "sensor/user",
        "material": "asset/material",
    }
    of_others = {"diaginertia": "inertial", "mass": "inertial"}
    for tag in TAGS:
        for name in attributes(tag):
            path = of_others.get(name, tags.get(tag, tag)) if tag == "body" else tags.get(tag, tag)
            assert name in GRAMMAR.element(path).attributes, (tag, name)
            assert hasattr(model, array_of(tag, name)), (tag, name)


def test_rows_of_controls_and_outputs_are_not_those_of_actuators(ask) -> None:
    if not hasattr(mujoco.mjtGain, "mjGAIN_SO3"):
        pytest.skip("this MuJoCo has no actuator with several outputs")
    model = """<mujoco><worldbody><body><joint name="b" type="ball"/><geom size=".1"/>
      <body><joint name="j"/><geom size=".1"/></body></body></worldbody>
      <actuator><orientation name="o" joint="b" kp="2"/><position name="p" joint="j" gear="2" ctrlrange="-1 1"/></actuator>
    </mujoco>"""
    assert ask(model, 'expect: {select: {actuator: p}, attr: "gear[0]", equals: 2}') == []
    assert ask(model, "expect: {select: {actuator: p}, attr: ctrlrange, equals: [-1, 1]}") == []


@pytest.mark.parametrize(
    ("check", "expected", "have"),
    [
        ("attr: damping, range: [4, 5]", "4 to 5", "3"),
        ("attr: range, range: [-90deg, 170deg]", "-90deg to 170deg", "[-90deg, 180deg]"),
        ('attr: "range[0]", range: [-1rad, 0rad]', "-1rad to 0rad", "-1.57079633rad"),
    ],
)
def test_out_of_a_range(ask, check: str, expected: str, have: str) -> None:
    (finding,) = ask(MODEL, f"expect: {{select: {{joint: hinge}}, {check}}}")
    assert finding.at == ("range",)
    assert notes(finding) == (f"expected: {expected}", f"actual: {have}")


def test_a_count_and_a_value_are_two_findings(ask) -> None:
    count, value = ask(MODEL, 'expect: {select: {joint: "*"}, count: 3, attr: damping, equals: 3}')
    assert (count.at, value.at) == (("count",), ("equals",))


@pytest.mark.parametrize(
    ("check", "prefix"),
    [
        ('{site: "**/tcp"}', ""),
        ("{key: home}", ""),
        ('{actuator: "left/*"}', ""),
        ("{site: tcp}", "left/"),
        ('{site: "**/tcp"}', "left/"),
        ('{body: "*/base"}, count: 2', ""),
        ('{body: "*/base"}, count: [1, 2]', ""),
        ('{geom: "**"}, count: 6', ""),
        ('{geom: "*/*"}, count: 2', ""),
        ('{geom: "**"}, count: 3', "left/"),
        ("{mesh: any}, count: 0", ""),
        ('{site: "**", in: {body: "*/base"}}, count: 1', ""),
        ('{geom: "**", in: {body: world}}, count: 6', ""),
        ('{body: "**", parent: {body: base}}, count: 1', "left/"),
        ('{site: "**", in: {body: base}}, count: 1', "left/"),
        ('{joint: "**", parent: {body: "*/base"}}, count: 0', ""),
        ("{body: left/base}, attr: subtree_mass, equals: 6", ""),
        ("{body: left/base}, attr: mass, equals: 5", ""),
        ("{body: left/base}, attr: mass, equals: 5.3, tol: 0.31", ""),
        ("{body: base}, attr: subtree_mass, range: [6, 6]", "left/"),
        ("{body: world}, attr: subtree_mass, equals: 10.5", "left/"),
    ],
)
def test_selected(ask, arm: str, check: str, prefix: str) -> None:
    assert ask(arm, f"expect: {{select: {check}}}", prefix=prefix) == []


def test_keyframes_of_a_nested_recipe_are_called_as_its_policy_says(ask, arm: str) -> None:
    assert ask(arm, "expect: {select: {key: home}}", prefix="left/") == []
    assert ask(arm, "expect: {select: {key: low}}", prefix="left/", keys="left/") == []
    assert len(ask(arm, "expect: {select: {key: home}}", prefix="left/", keys=None)) == 1


def test_nothing_of_that_name(ask, arm: str) -> None:
    (finding,) = ask(arm, "expect: {select: {site: lft/tcp}}")
    assert finding.at == ("select", "site")
    assert finding.message == "the site `lft/tcp` does not exist"
    assert notes(finding) == ("expected: at least one", "actual: 0", "sites that exist: left/tcp")
    assert finding.help == "did you mean `left/tcp`?"


def test_another_number(ask, arm: str) -> None:
    (finding,) = ask(arm, 'expect: {select: {body: "*/base"}, count: 3}')
    assert finding.message == "`*/base` names 2 elements `body`, not 3"
    assert notes(finding) == ("expected: 3", "actual: 2", "they are: left/base, right/base")


def test_one_element_instead_of_several(ask, arm: str) -> None:
    (finding,) = ask(arm, 'expect: {select: {body: "left/base"}, count: 3}')
    assert finding.message == "`left/base` names 1 element `body`, not 3"
    assert notes(finding) == ("expected: 3", "actual: 1", "it is: left/base")


def test_what_is_of_another_part_is_not_found(ask, arm: str) -> None:
    (finding,) = ask(arm, "expect: {select: {site: tcp}}", prefix="right/")
    assert finding.code == "check-failed"


def test_nothing_of_that_name_there(ask, arm: str) -> None:
    (finding,) = ask(arm, 'expect: {select: {site: "**/tcp", in: {body: right/base}}}')
    assert finding.message == "the site `**/tcp` does not exist in a body `right/base`"


def test_only_what_has_the_values(ask, arm: str) -> None:
    assert ask(arm, 'expect: {select: {joint: "**", where: {"damping[0]": 100}}, count: 0}') == []
    (finding,) = ask(arm, 'expect: {select: {joint: "**", where: {"damping[0]": 100}}}')
    assert finding.message.endswith("with such `damping[0]`")


WORDS = """
<mujoco>
  <asset><material name="steel"/></asset>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body name="a">
      <joint name="turn"/>
      <geom name="g" type="box" size=".1 .1 .1" material="steel"/>
      <site name="tip"/>
      <camera name="eye" mode="targetbody" target="b"/>
    </body>
    <body name="b" pos="1 0 0"><joint name="push" type="slide"/><geom name="h" size=".1"/></body>
  </worldbody>
  <contact><pair geom1="g" geom2="h"/><exclude body1="a" body2="b"/></contact>
  <equality><connect name="c" body1="a" body2="b" anchor="0 0 0"/><joint name="j" joint1="turn" joint2="push"/></equality>
  <actuator><position name="p" joint="turn" kp="1"/><motor name="m" site="tip" refsite="tip"/></actuator>
  <sensor>
    <framepos name="f" objtype="body" objname="a" reftype="site" refname="tip"/>
    <distance name="d" geom1="g" geom2="h" cutoff="1"/>
    <jointpos name="q" joint="push"/>
  </sensor>
</mujoco>
"""


@pytest.mark.parametrize(
    ("selector", "count"),
    [
        ('{geom: "**", where: {type: box}}', 1),
        ('{geom: "**", where: {type: box, material: steel, "size[0]": 0.1}}', 1),
        ('{geom: "**", where: {material: "*"}}', 1),
        ('{joint: "**", where: {type: slide}}', 1),
        ('{camera: "**", where: {mode: targetbody, target: b}}', 1),
        ('{camera: "**", where: {target: a}}', 0),
        ('{actuator: "**", where: {joint: "/t.*/"}}', 1),
        ('{actuator: "**", where: {biastype: affine}}', 1),
        ('{actuator: "**", where: {site: tip, refsite: tip}}', 1),
        ('{equality: "**", where: {type: connect, body2: b}}', 1),
        ('{equality: "**", where: {body2: a}}', 0),
        ('{equality: "**", where: {joint1: turn}}', 1),
        ('{sensor: "**", where: {type: framepos, objname: a, refname: tip}}', 1),
        ('{sensor: "**", where: {type: distance, geom2: h}}', 1),
        ('{sensor: "**", where: {joint: push}}', 1),
        ('{pair: "**", where: {geom1: h}}', 1),
        ('{exclude: "**", where: {body1: a}}', 1),
        ('{geom: "/[gh]/"}', 2),
    ],
)
def test_kinds_and_names(ask, selector: str, count: int) -> None:
    assert ask(WORDS, f"expect: {{select: {selector}, count: {count}}}") == []


def test_names_of_a_nested_recipe_are_as_it_writes_them(ask, arm: str) -> None:
    assert ask(arm, 'expect: {select: {actuator: "**", where: {joint: shoulder}}, count: 2}', prefix="left/") == []


def test_a_slow_regular_expression(ask, arm: str) -> None:
    (finding,) = ask(arm.replace("left/tcp", "a" * 60), 'expect: {select: {site: "/(.|.)*[!?]/"}}')
    assert finding.code == "selector"
    assert "takes longer than" in finding.message


@pytest.mark.parametrize(
    ("check", "prefix"),
    [
        *(
            (f"attr: {size}, equals: {count}", "")
            for size, count in {
                "nq": 9,
                "nv": 8,
                "nu": 3,
                "nbody": 5,
                "ngeom": 6,
                "nsensor": 2,
                "nkey": 2,
                "nactuator": 3,
            }.items()
        ),
        *(
            (f"attr: {size}, equals: {count}", "left/")
            for size, count in {
                "nq": 2,
                "nv": 2,
                "nu": 2,
                "nbody": 3,
                "njnt": 2,
                "ngeom": 3,
                "nsite": 1,
                "nsensor": 1,
                "nsensordata": 1,
                "ncam": 0,
            }.items()
        ),
        *((f"attr: {size}, equals: {count}", "right/") for size, count in {"nbody": 2, "nq": 0, "ngeom": 1}.items()),
        ("attr: nkey, equals: 77", "left/"),  # keyframes that merged are of no recipe alone
        ("attr: nq, range: [9, 10]", ""),
        ("attr: mass, range: [10, 11]", ""),
        ("attr: mass, equals: 10.5", ""),
        ("attr: mass, equals: 10, tol: 0.6", ""),
        ("attr: mass, equals: 6", "left/"),
        ("attr: mass, equals: 4", "right/"),
    ],
)
def test_numbers_of_the_model(ask, arm: str, check: str, prefix: str) -> None:
    assert ask(arm, f"expect: {{{check}}}", prefix=prefix) == []


@pytest.mark.parametrize(
    ("check", "at", "message", "expected"),
    [
        ("attr: nv, equals: 7", "equals", "`nv` of the model is 8, not 7", "7"),
        ("attr: mass, range: [1, 2]", "range", "`mass` of the model is 10.5 kg, not 1 to 2 kg", "1 to 2 kg"),
        (
            "select: {body: left/base}, attr: mass, equals: 5.3, tol: 0.2",
            "equals",
            "`mass` of body `left/base` is 5 kg, not 5.3 kg ± 0.2 kg",
            "5.3 kg ± 0.2 kg",
        ),
        (
            "select: {body: left/base}, attr: subtree_mass, equals: 6.001",
            "equals",
            "`subtree_mass` of body `left/base` is 6 kg, not 6.001 kg",
            "6.001 kg",
        ),
    ],
)
def test_other_numbers(ask, arm: str, check: str, at: str, message: str, expected: str) -> None:
    (finding,) = ask(arm, f"expect: {{{check}}}")
    assert (finding.at, finding.message, finding.code) == ((at,), message, "check-failed")
    assert notes(finding)[0] == f"expected: {expected}"


def test_a_nested_base_is_all_but_the_parts(ask, arm: str) -> None:
    for size, count in {"nbody": 1, "ngeom": 1, "ncam": 1, "nu": 1, "nsensor": 0}.items():
        assert ask(arm, f"expect: {{attr: {size}, equals: {count}}}", others=["left/", "right/"]) == []


def test_every_size_is_one_of_the_model(arm: str) -> None:
    model = mujoco.MjModel.from_xml_string(arm)
    whole = Scope(mujoco, model)
    part = Scope(mujoco, model, prefix="left/", whole=False)
    for size in COUNTS:
        assert _size(whole, size) is not None, size
        assert (_size(part, size) is None) == (size == "nkey")
    assert NameTable(model).count("body") == _size(whole, "nbody")


def test_parts_and_the_rest_are_the_whole(arm: str) -> None:
    model = mujoco.MjModel.from_xml_string(arm)
    for size in set(COUNTS) - {"nkey", "nsensor", "nsensordata"}:  # the clock is about nothing
        whole = _size(Scope(mujoco, model), size)
        base = _size(Scope(mujoco, model, others=["left/", "right/"], whole=False), size)
        parts = [_size(Scope(mujoco, model, prefix=each, whole=False), size) for each in ("left/", "right/")]
        carrier = {"nbody": 1 - 2, "njnt": 1, "nq": 7, "nv": 6, "ngeom": 1}.get(size, 0)  # a world each
        assert base + sum(parts) + carrier == whole, size  # type: ignore[operator, arg-type]
