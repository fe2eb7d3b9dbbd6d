"""Random edits of a composition, right and wrong: after an error nothing has changed, and it can always be written."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np
import pytest
from hypothesis import settings, strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule
from lxml import etree
from mjcompose import mjcf
from mjcompose.mjcf import Element, MjcfError, Physics, RootElement
from mjcompose.mjcf.model import ModelState
from mjcompose.tree.names import NameIndex

START = """
<mujoco model="{name}">
  <default><default class="red"><geom rgba="1 0 0 1"/></default></default>
  <asset><material name="steel"/></asset>
  <worldbody>
    <body name="a"><joint name="a"/><geom name="a" size="0.1" material="steel"/><site name="a"/>
      <body name="b" pos="0 0 1"><joint name="b"/><geom name="b" size="0.1" class="red"/></body>
    </body>
  </worldbody>
  <contact><exclude body1="a" body2="b"/></contact>
  <tendon><fixed name="a"><joint joint="a" coef="1"/><joint joint="b" coef="2"/></fixed></tendon>
  <actuator><motor name="a" joint="a"/><motor name="b" tendon="a"/></actuator>
  <sensor><framepos name="a" objtype="site" objname="a"/></sensor>
</mujoco>
"""

# What can be added where, with values that MuJoCo takes.
_ADDED: dict[str, tuple[str, dict[str, object]]] = {
    "body": ("body", {"pos": [0, 0, 1]}),
    "geom": ("body", {"size": [0.1]}),
    "site": ("body", {}),
    "camera": ("body", {"fovy": 40}),
    "joint": ("body", {"damping": 1}),
    "frame": ("body", {"euler": [0, 0, 90]}),
    "material": ("asset", {"rgba": np.ones(4)}),
    "default": ("default", {}),
}
_REFERRING: dict[str, tuple[str, str, str]] = {
    "motor": ("actuator", "joint", "joint"),
    "jointpos": ("sensor", "joint", "joint"),
    "touch": ("sensor", "site", "site"),
}
_WRONG: list[tuple[str, Any]] = [
    ("pos", [1, 2]),
    ("pos", [0, 0, float("nan")]),
    ("pos", [0, 0, float("inf")]),
    ("pos", np.zeros((3, 1))),
    ("pos", np.array(["x", "y", "z"])),
    ("pos", 1j),
    ("pos", object()),
    ("poss", [1, 2, 3]),
    ("name", 3),
    ("name", "a\x00"),
    ("type", "spere"),
    ("rgba", "red"),
    ("material", "steel\x01"),
    ("dclass", 7),
]
_NAMES = st.sampled_from(["a", "b", "c", "d", "one/a", "red", "x y", ""])


def _state(model: ModelState) -> Any:
    """Everything that an edit can change, names as they are looked up included."""
    return (
        etree.tostring(model.unit.root),
        sorted(model.unit.contents),
        _index(model, model.names),
        [
            (prefix, each.host, etree.tostring(each.frame), each.child.hung is each, _state(each.child))
            for prefix, each in model.attachments.items()
        ],
    )


def _index(model: ModelState, index: NameIndex) -> Any:
    declared = {(space, name, node) for space, names in index.declared.items() for name, node in names.items()}
    uses = {
        (space, name, *use) for space, names in index.uses.items() for name, users in names.items() for use in users
    }
    return declared, uses


def _rebuilt(model: ModelState) -> NameIndex:
    index = NameIndex.of(model.unit.root)
    for attachment in model.attachments.values():
        for joint in attachment.frame:
            index.note(joint, "worldbody", declares=False)
    return index


class Edits(RuleBasedStateMachine):
    """Three models that hang on one another in changing ways."""

    @initialize()
    def begin(self) -> None:
        self.models = [mjcf.from_xml_string(START.format(name=name)) for name in ("one", "two", "three")]
        self.removed = self.models[0].worldbody.add("site", name="removed")
        self.removed.remove()
        self.bound: list[tuple[Physics, Element, int]] = []

    def _try(self, edit: Callable[[], object], *, wrong: bool = False) -> None:
        before = [_state(model._model) for model in self.models]
        try:
            edit()
        except MjcfError as error:
            assert [_state(model._model) for model in self.models] == before, error
            assert error.diagnostics and all(each.message and each.span for each in error.diagnostics)
        else:
            assert not wrong, "an edit that is wrong went through"

    def _any(self, data: st.DataObject, tag: str) -> Element | None:
        found = data.draw(st.sampled_from(self.models)).find_all(tag)
        return data.draw(st.sampled_from(found)) if found else None

    @rule(data=st.data(), tag=st.sampled_from(sorted(_ADDED)), name=_NAMES)
    def add(self, data: st.DataObject, tag: str, name: str) -> None:
        place, attributes = _ADDED[tag]
        root = data.draw(st.sampled_from(self.models))
        parent = self._any(data, "body") if place == "body" else getattr(root, place)
        if parent is not None:
            naming = "dclass" if tag == "default" else "name"
            position = data.draw(st.sampled_from([None, 0, -1, 7]))
            values = {naming: name or "unnamed" if tag == "default" else name, **attributes}
            if position is None:
                self._try(lambda: parent.add(tag, **values))
            else:
                self._try(lambda: parent.insert(tag, position, **values))

    @rule(data=st.data(), tag=st.sampled_from(sorted(_REFERRING)), name=_NAMES)
    def add_what_refers(self, data: st.DataObject, tag: str, name: str) -> None:
        section, attribute, kind = _REFERRING[tag]
        target = self._any(data, kind)
        if target is not None:
            root = data.draw(st.sampled_from(self.models))
            self._try(lambda: getattr(root, section).add(tag, name=name, **{attribute: target}))

    @rule(data=st.data(), tag=st.sampled_from(["geom", "site", "body", "motor", "frame"]))
    def set_something_wrong(self, data: st.DataObject, tag: str) -> None:
        element = self._any(data, tag)
        attribute, value = data.draw(st.sampled_from(_WRONG))
        if element is not None and element.name != "":
            known = attribute in element._kind.attributes or attribute == "dclass"
            values = {"name": "fresh", attribute: value} if data.draw(st.booleans()) else {attribute: value}
            self._try(lambda: element.set_attributes(**values), wrong=True)
            if known and tag != "frame":
                parent = element.parent
                assert parent is not None
                self._try(lambda: parent.add(tag, **values), wrong=True)

    @rule(data=st.data(), tag=st.sampled_from(["worldbody", "sensor", "geom", "default"]))
    def add_something_wrong(self, data: st.DataObject, tag: str) -> None:
        element = self._any(data, tag)
        if element is not None:
            self._try(lambda: element.add("goem", name="x"), wrong=True)
            self._try(lambda: element.add("mujoco"), wrong=True)

    @rule(data=st.data(), tag=st.sampled_from(["body", "geom", "joint", "site", "material", "actuator"]), name=_NAMES)
    def rename(self, data: st.DataObject, tag: str, name: str) -> None:
        element = self._any(data, tag)
        if element is not None and name:
            self._try(lambda: setattr(element, "name", name))

    @rule(data=st.data(), attribute=st.sampled_from(["material", "dclass"]))
    def refer(self, data: st.DataObject, attribute: str) -> None:
        geom = self._any(data, "geom")
        target = self._any(data, {"dclass": "default"}.get(attribute, attribute))
        if geom is not None and target is not None:
            self._try(lambda: setattr(geom, attribute, target))

    @rule(data=st.data(), tag=st.sampled_from(["geom", "site", "body"]), number=st.sampled_from([0.5, -1, "x"]))
    def change_in_place(self, data: st.DataObject, tag: str, number: Any) -> None:
        element = self._any(data, tag)
        if element is not None and element.get("size" if tag == "geom" else "pos") is not None:
            array = element.size if tag == "geom" else element.pos
            self._try(lambda: array.__setitem__(0, number), wrong=number == "x")
            self._try(lambda: array.__imul__(1.5))

    @rule(data=st.data(), name=_NAMES, length=st.integers(0, 4))
    def add_a_key(self, data: st.DataObject, name: str, length: int) -> None:
        """Of the right length or not: that is told when the model is written."""
        keyframe = data.draw(st.sampled_from(self.models)).keyframe
        self._try(lambda: keyframe.add("key", name=name, qpos=[0.1] * length or None, ctrl=[0.2, 0.3]))

    @rule(data=st.data(), name=_NAMES, content=st.sampled_from([b"a", b"b"]))
    def change_a_file(self, data: st.DataObject, name: str, content: bytes) -> None:
        """Of one file name, whatever is in it; nothing shows it, so that it need not be a picture."""
        root = data.draw(st.sampled_from(self.models))
        asset = mjcf.Asset(content, ".png", "picture")
        found = root.asset.texture
        if found:
            self._try(lambda: setattr(found[0], "file", asset))
            assert found[0].file.contents == content
        else:
            self._try(lambda: root.asset.add("texture", name=name, type="2d", file=asset))

    @rule(data=st.data())
    def compile_and_bind(self, data: st.DataObject) -> None:
        """What is compiled is what is written; and it stays what it was through later edits."""
        root = data.draw(st.sampled_from([each for each in self.models if each.parent_model is None]))
        for texture in root.find_all("texture"):
            texture.remove(cascade=True)
        text = _text(root)
        if text is None:
            return
        try:
            written = mujoco.MjModel.from_xml_string(text, root.assets)
        except ValueError:  # a moving body may have lost its mass
            with pytest.raises(MjcfError):
                root.compile_model(conflict="mujoco")
            return
        physics = root.compile_model(conflict="mujoco")
        for name in ("body_pos", "geom_size", "geom_rgba", "jnt_dofadr", "actuator_trnid", "key_qpos", "sensor_objid"):
            np.testing.assert_array_equal(getattr(physics.model, name), getattr(written, name))
        again = mujoco.MjModel.from_xml_string(mjcf.from_xml_string(text).to_xml_string())
        assert (again.nq, again.nbody, again.nkey) == (written.nq, written.nbody, written.nkey)
        for element in root.find_all("geom") + root.find_all("joint") + root.find_all("sensor"):
            if element.full_identifier:
                kind = "geom" if element.tag == "geom" else "joint" if element.tag == "joint" else "sensor"
                row = physics.bind(element).element_id
                assert getattr(physics.model, kind)(element.full_identifier).id == row
                self.bound.append((physics, element, row))

    @invariant()
    def what_was_compiled_stays_bound(self) -> None:
        for physics, element, row in getattr(self, "bound", [])[-8:]:
            if not element._removed:
                assert physics.bind(element).element_id == row

    @rule(data=st.data())
    def refer_to_what_was_removed(self, data: st.DataObject) -> None:
        sensor = self._any(data, "framepos")
        if sensor is not None:
            self._try(lambda: setattr(sensor, "objname", self.removed), wrong=True)
        self._try(lambda: setattr(self.removed, "pos", [0, 0, 0]), wrong=True)

    @rule(
        data=st.data(),
        tag=st.sampled_from(["body", "geom", "joint", "site", "default", "material", "sensor", "tendon"]),
    )
    def remove(self, data: st.DataObject, tag: str) -> None:
        element = self._any(data, tag)
        if element is not None:
            self._try(lambda: element.remove(cascade=True))

    @rule(data=st.data(), tag=st.sampled_from(["body", "site", "worldbody", "joint", "geom"]))
    def attach(self, data: st.DataObject, tag: str) -> None:
        host = self._any(data, tag)
        child = data.draw(st.sampled_from(self.models))
        if host is not None:
            wrong = tag in ("joint", "geom") or child is host.root or child.parent_model is not None
            self._try(lambda: host.attach(child), wrong=wrong)

    @rule(data=st.data(), name=_NAMES, tag=st.sampled_from(["joint", "geom", "body"]))
    def add_to_a_frame(self, data: st.DataObject, name: str, tag: str) -> None:
        frame = mjcf.get_attachment_frame(data.draw(st.sampled_from(self.models)))
        if frame is not None:
            self._try(lambda: frame.add(tag, name=name), wrong=tag != "joint")
            self._try(frame.remove, wrong=True)

    @rule(data=st.data())
    def detach(self, data: st.DataObject) -> None:
        """What the others refer to in it goes with it: here all is to stay whole."""
        child = data.draw(st.sampled_from(self.models))
        prefix = child._model.prefix
        referred = False
        for model in child._model.ancestors():
            referred |= any(name.startswith(prefix) for names in model.names.uses.values() for name in names)
            prefix = model.prefix + prefix
        if not referred:
            self._try(child.detach, wrong=child.parent_model is None)

    @rule(data=st.data(), name=st.sampled_from(["one", "two", "new", "", "a\x00", 3]))
    def rename_a_model(self, data: st.DataObject, name: Any) -> None:
        self._try(lambda: setattr(data.draw(st.sampled_from(self.models)), "model", name), wrong=name in ("a\x00", 3))

    @rule(data=st.data())
    def include(self, data: st.DataObject) -> None:
        first, second = (data.draw(st.sampled_from(self.models)) for _ in range(2))
        self._try(lambda: first.include_copy(second))

    @rule(data=st.data())
    def commit(self, data: st.DataObject) -> None:
        mjcf.commit_defaults(data.draw(st.sampled_from(self.models)))

    @rule(data=st.data())
    def copy_is_equal(self, data: st.DataObject) -> None:
        model = data.draw(st.sampled_from([each for each in self.models if each.parent_model is None]))
        text = _text(model)
        assert _text(copy.deepcopy(model)) == _text(pickle.loads(pickle.dumps(model))) == text

    @invariant()
    def names_are_as_they_are_written(self) -> None:
        for model in getattr(self, "models", ()):
            assert _index(model._model, model._model.names) == _index(model._model, _rebuilt(model._model))

    @rule()
    def it_can_be_written_and_read(self) -> None:
        before = [_state(model._model) for model in self.models]
        for model in self.models:
            text = _text(model)
            if text is not None:
                again = mjcf.from_xml_string(text)
                assert again.to_xml_string() == text
        assert before == [_state(model._model) for model in self.models]

    def teardown(self) -> None:
        for model in getattr(self, "models", ()):
            text = _text(model)
            if text is not None:
                mujoco.MjSpec.from_string(text)  # a moving body may have lost its mass: it is not compiled


def _text(model: RootElement) -> str | None:
    """None where the linker tells what MuJoCo cannot have: two things of one meaning, or no place for them."""
    try:
        return model.to_xml_string(conflict="mujoco")
    except MjcfError as error:
        # A model alone has nothing of the models around it, and what it refers to may have been detached.
        told = {
            each.code for each in error.diagnostics if "`../" not in each.message and "not attached" not in each.message
        }
        assert not told & {"unknown-name", "name-clash", "wrong-type"}, error
        return None


TestEdits = Edits.TestCase
TestEdits.settings = settings(max_examples=40, stateful_step_count=20, deadline=None)


def test_references_to_copies_that_a_replicate_makes_follow_a_new_name() -> None:
    scene = mjcf.RootElement("scene")
    rack = mjcf.RootElement("rack")
    pads = rack.worldbody.add("replicate", count=3, offset=[1, 0, 0])
    pad = pads.add("site", name="pad")
    scene.attach(rack)
    own = rack.sensor.add("framepos", objtype="site", objname="pad1")
    above = scene.sensor.add("framepos", objtype="site", objname="rack/pad2")
    pad.name = "tip"
    assert (own.objname, above.objname) == ("tip1", "rack/tip2")
    scene.compile_model()
