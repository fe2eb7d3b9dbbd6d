"""What the grammar says against what MuJoCo does with small models."""

from __future__ import annotations

import runpy
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from mjcompose.tree.grammar import GRAMMAR, Attribute, ElementType, to_text
from tree.keywords import keywords_in

pytestmark = pytest.mark.since("3.12", "`schemas/mjcf.json` begins with 3.12")

VERSION = mujoco.__version__
OLDER = VERSION.startswith("3.")
MINIMAL: dict[str, Any] = runpy.run_path(str(Path(__file__).with_name("minimal.py")))
PLACES = MINIMAL["PLACES"]
NAMES = MINIMAL["NAMES"]
LEFT_OUT = MINIMAL["LEFT_OUT"]
model = MINIMAL["model"]
needed = MINIMAL["needed"]

# What MuJoCo 3 refuses or reads in another way, though it has the element.
OTHERWISE = {"equality/flexstrain", "actuator/pid", "visual/headlight", "custom/text"}
PLACED = [
    path
    for path in GRAMMAR.paths
    if path in PLACES and GRAMMAR.element(path).exists_in(VERSION) and not (OLDER and path in OTHERWISE)
]
OUTSIDE_DEFAULT = [path for path in PLACED if not path.startswith("default/")]

NOT_ALONE = {
    # legal only together with other attributes, so that their default or an angle cannot be tried alone
    "cranklength",
    "builtin",
    "fullinertia",
    "focal",
    "focalpixel",
    "principal",
    "principalpixel",
    "controller",
    "thermal",
    "delay",
    "interval",
    "cutoff",
    "actrange",
    "lmax",
    "actuatorfrcrange",
}

Arrays = dict[str, np.ndarray[Any, Any]]


@pytest.fixture(autouse=True)
def quiet() -> Iterator[None]:
    """MuJoCo warns of the cloth of the base, which nothing holds."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def refusal(xml: str, *, compiled: bool = False) -> str | None:
    """Why MuJoCo does not read (or compile) a model."""
    try:
        spec = mujoco.MjSpec.from_string(xml)
        if compiled:
            spec.compile()
    except ValueError as error:
        return str(error).partition("\n")[0]
    return None


def arrays(xml: str) -> Arrays:
    """Every number of a compiled model; no names."""
    compiled = mujoco.MjSpec.from_string(xml).compile()
    structs = {"": compiled, "opt": compiled.opt, "stat": compiled.stat, "global": compiled.vis.global_}
    structs |= {name: getattr(compiled.vis, name) for name in ("quality", "headlight", "map", "scale", "rgba")}
    found = {}
    for prefix, struct in structs.items():
        for name in dir(struct):
            if name.startswith("_") or name in ("names", "names_map", "paths", "text_data"):
                continue
            value = getattr(struct, name)
            if isinstance(value, np.ndarray | int | float):
                found[f"{prefix}.{name}"] = np.array(value)
    return found


def differences(left: Arrays, right: Arrays) -> list[str]:
    return [
        name
        for name, value in left.items()
        if not np.array_equal(value, right[name], equal_nan=value.dtype.kind == "f")
    ]


def ones(count: int, number: str = "1") -> str:
    return " ".join([number] * count)


def attributes_of(path: str) -> tuple[ElementType, dict[str, str], list[Attribute]]:
    element = GRAMMAR.element(path)
    present = [attribute for attribute in element.attributes.values() if attribute.exists_in(VERSION)]
    return element, needed(element), present


@pytest.mark.mujoco4("it has elements whose place is not tried")
def test_every_element_has_a_place() -> None:
    with_attributes = {
        path for path in GRAMMAR.paths if GRAMMAR.element(path).exists_in(VERSION) and GRAMMAR.element(path).attributes
    }
    assert with_attributes - set(PLACES) == set(LEFT_OUT) - {"worldbody", "visual"}


@pytest.mark.parametrize("path", PLACED)
def test_place_compiles(path: str) -> None:
    assert refusal(model(GRAMMAR.element(path)), compiled=True) is None


@pytest.mark.parametrize("path", PLACED)
def test_required(path: str) -> None:
    element, base, present = attributes_of(path)
    for attribute in present:
        if attribute.required:
            without = {name: text for name, text in base.items() if name != attribute.name}
            assert refusal(model(element, without), compiled=True) is not None, attribute.name


@pytest.mark.parametrize("path", PLACED)
def test_only_the_required_are_asked_for_by_name(path: str) -> None:
    element, base, _ = attributes_of(path)
    for name in base:
        if not element.attributes[name].required:
            fault = refusal(model(element, {other: text for other, text in base.items() if other != name}))
            assert fault is None or "required attribute" not in fault, name


@pytest.mark.parametrize("path", PLACED)
def test_lengths(path: str) -> None:
    element, base, present = attributes_of(path)

    def amount(attribute: Attribute, count: int) -> str | None:
        return refusal(model(element, {**base, attribute.name: ones(count)}))

    for attribute in present:
        if not attribute.is_number or (path, attribute.name) == ("hfield", "elevation"):
            continue
        low = attribute.min_length or 1
        high = attribute.max_length
        for count in {low, high or low}:
            fault = amount(attribute, count)
            assert fault is None or not any(word in fault for word in ("data", "must have", "keyword")), attribute.name
        if low > 1:
            assert amount(attribute, low - 1) is not None, attribute.name
        if high is not None:
            assert amount(attribute, high + 1) is not None, attribute.name
        if attribute.lengths is not None:
            for count in set(range(low, (high or low) + 1)) - set(attribute.lengths):
                assert amount(attribute, count) is not None, attribute.name


@pytest.mark.parametrize("path", PLACED)
def test_integers(path: str) -> None:
    element, base, present = attributes_of(path)
    for attribute in present:
        if attribute.is_number:
            text = ones(attribute.min_length or 1, "1.5")
            fault = refusal(model(element, {**base, attribute.name: text}))
            refused = fault is not None and ("format" in fault or "problem" in fault)
            assert refused == (attribute.type == "int"), attribute.name


@pytest.mark.parametrize("path", PLACED)
@pytest.mark.mujoco4("some unknown keywords are fatal, and the next model with a NaN hangs")
def test_keywords(path: str) -> None:
    element, base, present = attributes_of(path)
    partner = {"reftype": {"refname": NAMES["site"]}}
    for attribute in present:
        words = ("false", "true") if attribute.type == "bool" else keywords_in(attribute, VERSION)
        if not words:
            continue
        others = {**base, **partner.get(attribute.name, {})}
        for word in words:
            fault = refusal(model(element, {**others, attribute.name: word}))
            assert fault is None or "keyword" not in fault, (attribute.name, word)
        assert refusal(model(element, {**others, attribute.name: "nonsense"})) is not None, attribute.name


@pytest.mark.parametrize("path", PLACED)
@pytest.mark.mujoco4("some unknown keywords are fatal, and the next model with a NaN hangs")
def test_keywords_of_other_versions(path: str) -> None:
    element, base, present = attributes_of(path)
    for attribute in present:
        for word in set(attribute.keywords) - set(keywords_in(attribute, VERSION)):
            assert refusal(model(element, {**base, attribute.name: word})) is not None, attribute.name


@pytest.mark.parametrize("path", OUTSIDE_DEFAULT)
def test_defaults(path: str) -> None:
    """Writing what is the default anyway changes nothing."""
    element, base, present = attributes_of(path)
    plain = arrays(model(element))
    for attribute in present:
        if attribute.default is None or attribute.name in base or attribute.name in NOT_ALONE:
            continue
        text = to_text(attribute, attribute.default)
        written = arrays(model(element, {**base, attribute.name: text}))
        changed = differences(plain, written)
        if (path, attribute.name) == ("actuator/position", "timeconst"):
            changed.remove(".actuator_dynprm")  # which nothing reads, as there are no dynamics
        assert changed == [], attribute.name


@pytest.mark.parametrize("path", OUTSIDE_DEFAULT)
def test_angles(path: str) -> None:
    """The unit of angles matters to the attributes marked so, and to no other."""
    element, base, present = attributes_of(path)
    others = {
        ("frame", "scale"): {"scaling": "geometry"},
        ("geom", "fromto"): {"pos": "", "type": "capsule"},
        ("site", "fromto"): {"pos": "", "type": "capsule"},
    }
    for attribute in present:
        length = attribute.max_length
        if attribute.type != "real" or length is None or attribute.name in NOT_ALONE:
            continue
        text = " ".join(f"{0.31 + 0.1 * index:.2f}" for index in range(length))
        written = {**base, **others.get((path, attribute.name), {}), attribute.name: text}
        written = {name: value for name, value in written.items() if value}
        degree = model(element, written, extra='<compiler angle="degree"/>')
        if refusal(degree, compiled=True) is not None:
            assert attribute.angle is None, attribute.name
            continue
        radian = model(element, written, extra='<compiler angle="radian"/>')
        matters = differences(arrays(degree), arrays(radian)) != []
        assert matters == (attribute.angle is not None), attribute.name


@pytest.mark.parametrize(
    ("kind", "name", "text", "angular"),
    [
        ("hinge", "range", "-0.5 0.5", True),
        ("ball", "range", "0 0.5", True),
        ("slide", "range", "-0.5 0.5", False),
        ("hinge", "ref", "0.5", True),
        ("slide", "ref", "0.5", False),
        ("ball", "ref", "0.5", False),
        ("hinge", "springref", "0.5", True),
        ("slide", "springref", "0.5", False),
        ("ball", "springref", "0.5", False),
        ("hinge", "springyield", "0.5", True),
        ("ball", "springyield", "0.5", True),
        ("slide", "springyield", "0.5", False),
    ],
)
def test_angles_of_joints(kind: str, name: str, text: str, angular: bool) -> None:
    joint = GRAMMAR.element("joint")
    assert joint.attributes[name].angle == "joint"
    if not joint.attributes[name].exists_in(VERSION):
        pytest.skip(f"MuJoCo {VERSION} has no {name}")
    written = {"type": kind, name: text, "stiffness": "1"}
    degree = arrays(model(joint, written, extra='<compiler angle="degree"/>'))
    radian = arrays(model(joint, written, extra='<compiler angle="radian"/>'))
    assert (differences(degree, radian) != []) == angular


def test_what_mujoco_ignores_has_no_effect() -> None:
    """Attributes that models write and MuJoCo passes over: that it goes on doing so is the reason for the data."""
    found = [(path, name) for path in GRAMMAR.paths for name in GRAMMAR.element(path).ignored]
    assert found == [("replicate", "prefix")]
    for path, name in found:
        element = GRAMMAR.element(path)
        assert name not in element.attributes
        assert differences(arrays(model(element)), arrays(model(element, {**needed(element), name: "x"}))) == []


@pytest.mark.parametrize("path", PLACED)
def test_only_frames_and_replicates_take_what_mjcf_does_not_have(path: str) -> None:
    """Nothing else can hide an attribute without effect: what the data calls ignored is all that could be."""
    element, base, _ = attributes_of(path)
    fault = refusal(model(element, {**base, "nonsense": "1"}))
    assert (fault is None) == (path in ("frame", "replicate"))


@pytest.mark.parametrize("path", PLACED)
def test_exclusive_attributes(path: str) -> None:
    """Two that exclude each other are refused together, where each alone is taken."""
    element, base, _ = attributes_of(path)
    for rule in element.constraints:
        names = [name for bundle in rule.bundles for name in bundle]
        if rule.kind != "exclusive" or any(len(bundle) > 1 for bundle in rule.bundles):
            continue
        bare = {name: text for name, text in base.items() if name not in names}
        values = {name: MINIMAL["some_value"](element.attributes[name], base) for name in names}
        values |= {"xyaxes": "1 0 0 0 1 0", "memory": "1M", "file": "x.obj", "builtin": "cone"}
        for index, first in enumerate(names):
            for second in names[index + 1 :]:
                pair = {**bare, first: values[first], second: values[second]}
                assert refusal(model(element, pair), compiled=True) is not None, (first, second)


FILES = [
    (path, attribute.name, attribute.folder)
    for path in ("mesh", "hfield", "skin", "texture", "flexcomp", "model")
    for attribute in GRAMMAR.element(path).attributes.values()
    if attribute.type == "file"
]


@pytest.mark.parametrize(("path", "name", "folder"), FILES)
def test_folders(path: str, name: str, folder: str) -> None:
    """MuJoCo looks for the file in the folder the grammar says; all folders are missing here."""
    written = {
        "mesh": '<asset><mesh file="f.stl"/></asset>',
        "hfield": '<asset><hfield file="f.png" size="1 1 1 1"/></asset>',
        "skin": '<asset><skin file="f.skn"/></asset>',
        "texture": f'<asset><texture name="t" type="cube" {name}="f.png"/></asset>',
        "flexcomp": '<worldbody><body name="b">'
        '<flexcomp name="x" type="mesh" dim="2" file="f.stl"/></body></worldbody>',
        "model": '<asset><model name="m" file="f.xml"/></asset>',
    }[path]
    xml = f'<mujoco><compiler meshdir="of_mesh" texturedir="of_texture"/>{written}</mujoco>'
    fault = refusal(xml, compiled=True)
    assert fault is not None
    try:
        mujoco.MjSpec.from_string(xml).compile()
    except ValueError as error:
        fault = str(error)
    suffix = {"mesh": ".stl", "hfield": ".png", "skin": ".skn", "texture": ".png", "flexcomp": ".stl"}
    if folder == "model":
        assert "'f.xml'" in fault
    else:
        assert f"of_{folder}/f{suffix[path]}" in fault
