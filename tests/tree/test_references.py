"""Every reference of the grammar against behavior.

A name declared and referred to is renamed in both places: MuJoCo compiles the same model. Renamed only where
it is declared: MuJoCo refuses.
"""

from __future__ import annotations

import runpy
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from mjcompose.tree.grammar import GRAMMAR

pytestmark = pytest.mark.since("3.12", "`schemas/mjcf.json` begins with 3.12")

VERSION = mujoco.__version__
MINIMAL: dict[str, Any] = runpy.run_path(str(Path(__file__).with_name("minimal.py")))
PLACES = MINIMAL["PLACES"]
NAMES = MINIMAL["NAMES"]
LEFT_OUT = MINIMAL["LEFT_OUT"]
model = MINIMAL["model"]
needed = MINIMAL["needed"]

FREE = {
    # attributes to drop, and to write, so that the reference may stand
    ("geom", "hfield"): ({"size"}, {"type": "hfield"}),
    ("geom", "mesh"): ({"size"}, {"type": "mesh"}),
    ("site", "mesh"): (set(), {"type": "mesh"}),
    ("camera", "target"): (set(), {"mode": "targetbody"}),
    ("light", "target"): (set(), {"mode": "targetbody"}),
    ("light", "texture"): (set(), {"type": "image"}),
    ("flexcomp", "mesh"): ({"count", "radius"}, {"type": "mesh", "dim": "2", "radius": "0.001", "origin": "0 0 0"}),
    ("equality/joint", "joint2"): (set(), {"joint1": "other"}),
    ("equality/tendon", "tendon2"): (set(), {"tendon1": "second"}),
    ("equality/connect", "site1"): ({"body1", "anchor"}, {"site2": "other"}),
    ("equality/connect", "site2"): ({"body1", "anchor"}, {"site1": "other"}),
    ("equality/weld", "site1"): ({"body1"}, {"site2": "other"}),
    ("equality/weld", "site2"): ({"body1"}, {"site1": "other"}),
    ("sensor/rangefinder", "camera"): ({"site"}, {}),
}


def alone(path: str, name: str) -> tuple[dict[str, str], str]:
    """Attributes of an element with one reference set to the base's name, and the namespace of that name."""
    element = GRAMMAR.element(path)
    attribute = element.attributes[name]
    drop, write = FREE.get((path, name), (set(), {}))
    written = {key: text for key, text in needed(element).items() if key not in drop} | write
    transmissions = {"joint", "jointinparent", "tendon", "site", "body", "cranksite", "slidersite", "refsite"}
    if path.startswith("actuator/") and name in transmissions:
        written = {key: text for key, text in written.items() if key not in transmissions}
        written |= {
            "cranksite": {"slidersite": "other", "cranklength": "1"},
            "slidersite": {"cranksite": "other", "cranklength": "1"},
            "refsite": {"site": "other"},
            "site": {"refsite": "other"} if path == "actuator/orientation" else {},
        }.get(name, {})
    if path in ("sensor/distance", "sensor/normal", "sensor/fromto"):
        side = name[-1]
        written = {f"geom{3 - int(side)}": "other"}
    if path == "sensor/contact" and name == "site":
        written = {}
    if attribute.refers_by is not None:
        kind = attribute.refers_by
        written.setdefault(kind, "site")
        if name == "refname" and "objname" not in written:
            written |= {"objtype": "site", "objname": "other"}
        written[name] = "{" + GRAMMAR.objtypes[written[kind]] + "}"
        return written, GRAMMAR.objtypes[written[kind]]
    written[name] = "{" + str(attribute.refers) + "}"
    return written, str(attribute.refers)


REFERENCES = [
    (path, attribute.name)
    for path in GRAMMAR.paths
    for attribute in GRAMMAR.element(path).attributes.values()
    if attribute.is_reference and path in PLACES and GRAMMAR.element(path).exists_in(VERSION)
    if attribute.exists_in(VERSION) and not path.startswith("default/")  # rows of elements that are tried
]

UNTRIED = {
    ("flex", "node"): "needs a whole lattice of bodies",
    ("equality/flexstrain", "flex"): "needs an interpolated flex: the base's is none",
    ("sensor/plugin", "instance"): "needs an instance of a sensor plugin",
    ("sensor/ballquat", "joint"): "needs a ball joint: the base's is none",
    ("sensor/ballangvel", "joint"): "needs a ball joint: the base's is none",
    ("actuator/orientation", "joint"): "needs a ball joint: the base's is none",
    ("sensor/tactile", "mesh"): "needs the geom to be a mesh",
    ("sensor/tactile", "geom"): "needs the geom to be a mesh",
}


@pytest.fixture(autouse=True)
def quiet() -> Iterator[None]:
    """MuJoCo warns of the cloth of the base, which nothing holds."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def numbers(xml: str) -> dict[str, np.ndarray[Any, Any]]:
    """Every array of the compiled model but those that hold names."""
    compiled = mujoco.MjSpec.from_string(xml).compile()
    found = {name: getattr(compiled, name) for name in dir(compiled) if not name.startswith("_")}
    return {
        name: np.array(value)
        for name, value in found.items()
        if isinstance(value, np.ndarray) and name not in ("names", "names_map")
    }


def check_reference(path: str, written: dict[str, str], namespace: str) -> None:
    element = GRAMMAR.element(path)
    old = NAMES
    new = {**NAMES, namespace: NAMES[namespace].replace("the_", "new_")}
    before = numbers(model(element, written, old))
    after = numbers(model(element, written, new))
    for name, value in before.items():
        assert np.array_equal(value, after[name], equal_nan=value.dtype.kind == "f"), name
    dangling = {name: text.replace("{" + namespace + "}", old[namespace]) for name, text in written.items()}
    assert dangling != written
    with pytest.raises(ValueError):
        mujoco.MjSpec.from_string(model(element, dangling, new)).compile()


@pytest.mark.parametrize(("path", "name"), REFERENCES)
def test_reference(path: str, name: str) -> None:
    if path == "equality/flexstrain" and mujoco.__version__.startswith("3."):
        pytest.skip("MuJoCo 3 has no self-collision of what is interpolated")
    if (path, name) in UNTRIED:
        pytest.skip(UNTRIED[path, name])
    written, namespace = alone(path, name)
    check_reference(path, written, namespace)


@pytest.mark.parametrize("kind", GRAMMAR.element("sensor/framepos").attributes["objtype"].keywords)
@pytest.mark.parametrize("name", ["objname", "refname"])
def test_frame_sensors_by_type(kind: str, name: str) -> None:
    namespace = GRAMMAR.objtypes[kind]
    written = {"objtype": "site", "objname": "other", "reftype": "site", "refname": "other"}
    written |= {name.replace("name", "type"): kind, name: "{" + namespace + "}"}
    check_reference("sensor/framepos", written, namespace)


@pytest.mark.parametrize("kind", GRAMMAR.element("tuple/element").attributes["objtype"].keywords)
@pytest.mark.parametrize("path", ["tuple/element", "sensor/user"])
def test_any_type(path: str, kind: str) -> None:
    namespace = GRAMMAR.objtypes[kind]
    written = {"objtype": kind, "objname": "{" + namespace + "}"}
    if path == "sensor/user":
        written["dim"] = "1"
    check_reference(path, written, namespace)


@pytest.mark.parametrize("name", sorted(NAMES))
def test_namespace_is_declared_in_the_base(name: str) -> None:
    if name in ("model",):
        pytest.skip(LEFT_OUT["model"])
    assert NAMES[name] in model()


@pytest.mark.parametrize(
    ("namespace", "text"),
    [
        ("joint", '<worldbody><body><freejoint name="NAME"/><geom size="0.1"/></body></worldbody>'),
        ("tendon", '<tendon><fixed name="NAME"><joint joint="other" coef="1"/></fixed></tendon>'),
        ("actuator", '<actuator><position name="NAME" joint="the_joint"/></actuator>'),
        ("sensor", '<sensor><clock name="NAME"/></sensor>'),
        ("equality", '<equality><weld name="NAME" body1="the_body"/></equality>'),
    ],
)
def test_shared_namespaces(namespace: str, text: str) -> None:
    """Two elements of one family cannot have one name, whatever their tags."""
    assert len(GRAMMAR.families[namespace]) > 1
    for name, refused in (("another", False), (NAMES[namespace], True)):
        xml = model().replace("</mujoco>", text.replace("NAME", name) + "</mujoco>")
        if refused:
            with pytest.raises(ValueError, match="repeated name"):
                mujoco.MjSpec.from_string(xml).compile()
        else:
            mujoco.MjSpec.from_string(xml).compile()


def test_attached_names(tmp_path: Path) -> None:
    """`body` and `frame` of `attach` name things of the other model, `model` a model of this one."""
    attach = GRAMMAR.element("attach").attributes
    assert [attach[name].refers for name in ("model", "body", "frame")] == ["model", "attached:body", "attached:frame"]
    (tmp_path / "part.xml").write_text(
        '<mujoco><worldbody><frame name="f"><body name="b"><geom size="1"/></body></frame></worldbody></mujoco>'
    )
    for kind, name in (("body", "b"), ("frame", "f")):
        xml = (
            '<mujoco><asset><model name="part" file="part.xml"/></asset><worldbody><body name="{taken}"/>'
            f'<attach model="{{model}}" {kind}="{name}" prefix="p/"/></worldbody></mujoco>'
        )
        main = tmp_path / "main.xml"
        main.write_text(xml.format(model="part", taken=name))
        assert mujoco.MjSpec.from_file(str(main)).compile().body("p/b").id == 2
        main.write_text(xml.format(model="other", taken=name))
        with pytest.raises(ValueError):
            mujoco.MjSpec.from_file(str(main))
        main.write_text(xml.format(model="part", taken=name).replace(f'{kind}="{name}"', f'{kind}="missing"'))
        with pytest.raises(ValueError):
            mujoco.MjSpec.from_file(str(main))


@pytest.mark.parametrize("tag", ["mesh", "hfield", "texture", "skin", "model"])
def test_names_taken_from_files_are_listed(tag: str) -> None:
    assert tag in GRAMMAR._data["implicit_names"]
    assert any(attribute.type == "file" for attribute in GRAMMAR.element(tag).attributes.values())
