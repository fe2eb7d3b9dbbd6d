"""The section `keyframe`, and the controls of a key."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import field, replace
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.suggest import closest, renaming
from mjcompose.base.words import value_text
from mjcompose.language.element import Reader
from mjcompose.language.element_schema import by_name
from mjcompose.language.forms.context import ByGrammar, Schema, Settings, computable, reference
from mjcompose.language.forms.model import OWNER, Model
from mjcompose.language.forms.scalars import Expects, Name, NumberUnit, Turns, When
from mjcompose.language.value import Single, kind_of, read_value
from mjcompose.tree.grammar import GRAMMAR

CTRL = "ctrl"
HOLD = "hold"
JOINT = "joint"
Way = Literal["positions", "forces"]
WAYS: tuple[Way, ...] = ("positions", "forces")
"""How all actuators hold the pose: servos at the pose, or forces that balance the model."""
_ALL = "write `ctrl: hold` for all actuators, `ctrl: {ACTUATOR: hold}` for one"


class Controls(Struct):
    """The entries of `ctrl`.

    `hold` is the way in which all actuators hold the pose, or None. `held` has the paths below `ctrl` of actuators that
    hold it individually: by actuator (`("grip",)`) or by joint (`("joint", "elbow")`). `joints` has the numbers by
    joint, and `numbers` has the numbers by actuator.
    """

    hold: Way | None = None
    held: tuple[tuple[str, ...], ...] = ()
    joints: Mapping[str, Any] = field(default_factory=dict)
    numbers: Mapping[str, Any] = field(default_factory=dict)


def read_controls(
    reader: Reader, value: Any, at: Path, owner: str
) -> tuple[Controls, dict[str, Any], dict[str, Any]] | None:
    """Return the controls, and the mappings that are still to be read as numbers by actuator and by joint, or None."""
    if isinstance(value, str):
        if value == HOLD:
            return Controls("positions"), {}, {}
        near = f"write `{CTRL}: {HOLD}`" if closest(value, (HOLD,)) else _ALL
        message = f"`{CTRL}` of {owner} is `{HOLD}` or a mapping by actuator, got `{value}`"
        reader.faults.append(Fault("wrong-keyword", message, at, help=near, fix=renaming(value, (HOLD,))))
        return None
    if not isinstance(value, dict):
        return Controls(), value, {}
    way: Way | None = None
    held: list[tuple[str, ...]] = []
    left: dict[str, Any] = {}
    joints: dict[str, Any] = {}
    for name, item in value.items():
        if name == HOLD and isinstance(item, str | bool):
            way = _way(reader, item, (*at, name), owner=owner)
        elif name == JOINT and isinstance(item, dict):
            joints = _numbers(reader, item, (*at, name), owner=owner, path=(JOINT,), held=held)
        elif name == JOINT and isinstance(item, str) and item[:1].isalpha():
            message = f"`{JOINT}` in `{CTRL}` of {owner} is a mapping by joint, got `{item}`"
            help = f"write `{JOINT}: {{{item}: 30deg}}`, or `{JOINT}: {{{item}: {HOLD}}}`"
            reader.faults.append(Fault("wrong-type", message, (*at, name), help=help))
        else:
            left.update(_numbers(reader, {name: item}, at, owner=owner, path=(), held=held))
    return Controls(way, tuple(held)), left, joints


def _numbers(
    reader: Reader, value: Mapping[str, Any], at: Path, owner: str, path: tuple[str, ...], held: list[tuple[str, ...]]
) -> dict[str, Any]:
    """Return the entries other than `hold`. The paths of entries with `hold` are added to `held`."""
    left: dict[str, Any] = {}
    for name, item in value.items():
        if item == HOLD:
            held.append((*path, name))
        elif isinstance(item, str) and closest(item, (HOLD,)):
            message = f"{JOINT if path else 'actuator'} `{name}` in {owner} expects a number or `{HOLD}`, got `{item}`"
            help = f"write `{name}: {HOLD}`, which holds the pose of the key"
            reader.faults.append(Fault("wrong-type", message, (*at, name), help=help))
        else:
            left[name] = item
    return left


def _way(reader: Reader, value: str | bool, at: Path, owner: str) -> Way | None:
    found = next((way for way in WAYS if way == value), None)
    if found is None:
        near = closest(value, WAYS) if isinstance(value, str) else ["positions"] * value
        message = f"`{HOLD}` in `{CTRL}` of {owner} is `positions` or `forces`, got `{value_text(value)}`"
        help = f"write `{HOLD}: {near[0]}`" if near else f"write `{CTRL}: {HOLD}` for the positions of servos"
        fix = renaming(value, WAYS) if isinstance(value, str) else None
        reader.faults.append(Fault("wrong-keyword", message, at, help=help, fix=fix))
    return found


def controls_schema(number: Schema, description: str) -> Schema:
    """Return the schema: `hold`, or a mapping from actuators to numbers or `hold`, with `hold` and `joint`."""
    hold: Schema = {"const": HOLD, "description": "the control that holds the pose of the key"}
    entry: Schema = {"anyOf": [number, hold]}
    about = "the hold of all actuators: servos at the pose, or forces that balance the model there"
    own = {
        HOLD: {"anyOf": [{"enum": list(WAYS)}, entry], "description": about},
        JOINT: {"anyOf": [by_name(entry), entry], "description": "numbers, or `hold`, by joint"},
    }
    whole = computable({"const": HOLD, "description": "the controls of all actuators that hold the pose of the key"})
    each = {**by_name(entry), "properties": own, "description": description}
    return {"anyOf": [whole, each], "description": description}


FROM = "from"
TIME = "time"
VECTORS: Mapping[str, str] = {
    "qpos": "joint",
    "qvel": "joint",
    "act": "actuator",
    "ctrl": "actuator",
    "mpos": "mocap body",
    "mquat": "mocap body",
}
"""The vectors of a key, each with the kind of its entries."""
WIDTHS = {"mpos": 3, "mquat": 4}

Entry = tuple[Single, ...]


class _Entries(ByGrammar):
    def __init__(self, vector: str) -> None:
        self.vector = vector

    def schema(self) -> Schema:
        about = f"{GRAMMAR.element('keyframe/key').attributes[self.vector].doc}: a mapping by {VECTORS[self.vector]}"
        width = WIDTHS.get(self.vector)
        number = reference("number-1-" if width is None else f"number-{width}")
        return controls_schema(number, about) if self.vector == CTRL else {**by_name(number), "description": about}

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> Any:
        reader = Reader(settings, faults)
        if self.vector != CTRL:
            return _entries(reader, self.vector, value, at=(), owner=OWNER, named=VECTORS[self.vector])
        read = read_controls(reader, value, (), owner=OWNER)
        if read is None:
            return None
        controls, by_actuator, by_joint = read
        joints = _entries(reader, CTRL, by_joint, at=(JOINT,), owner=OWNER, named=JOINT)
        numbers = _entries(reader, CTRL, by_actuator, at=(), owner=OWNER, named="actuator")
        return replace(controls, joints=joints, numbers=numbers)


_Vector = Mapping[str, Entry]
_KeyName = Annotated[str, Name(what="the name of a key")]


class Keyframe(Model):
    """A key: the keys of parts that it starts from, and the entries that it sets, by name."""

    example: ClassVar = "{qpos: {JOINT: 0.1}}"
    called: ClassVar = "keyframe `{}`"
    instead: ClassVar = {HOLD: f"write `{CTRL}: {HOLD}`, or `{CTRL}: {{{HOLD}: forces}}`"}

    sources: Annotated[dict[str, _KeyName], Expects("a mapping from parts to their keys", "{base: home}")] = Field(
        default_factory=dict, alias="from"
    )
    """A key of each part to start from, by the path of the part: `base`, `left`, `left/gripper`."""
    time: Annotated[float, NumberUnit("s")] | None = None
    """The time of the key, in seconds."""
    qpos: Annotated[_Vector, _Entries("qpos")] = Field(default_factory=dict)
    qvel: Annotated[_Vector, _Entries("qvel")] = Field(default_factory=dict)
    act: Annotated[_Vector, _Entries("act")] = Field(default_factory=dict)
    controls: Annotated[Controls, _Entries(CTRL)] = Field(default_factory=Controls, alias="ctrl")
    mpos: Annotated[_Vector, _Entries("mpos")] = Field(default_factory=dict)
    mquat: Annotated[_Vector, _Entries("mquat")] = Field(default_factory=dict)
    repeats: Turns = Field(None, alias="for")
    when: When = None

    @property
    def name(self) -> str:
        return str(self.at[-1])

    @property
    def values(self) -> dict[str, Mapping[str, Entry]]:
        """The entries of each vector that is written, by name."""
        written = {name: getattr(self, name) for name in VECTORS if name in self.model_fields_set}
        return written if "controls" not in self.model_fields_set else {**written, CTRL: self.controls.numbers}


def _entries(reader: Reader, vector: str, value: Any, at: Path, owner: str, named: str) -> dict[str, Entry]:
    """Return the entries of one vector by name. Messages call a name `named`."""
    if not isinstance(value, dict):
        help = f"write `{vector}: {{{named.upper().replace(' ', '_')}: {_EXAMPLES.get(vector, '0.1')}}}`"
        message = f"`{vector}` of {owner} expects a mapping by {named}, got {kind_of(value)}"
        reader.faults.append(Fault("wrong-type", message, at, help=help))
        return {}
    attribute = GRAMMAR.element("keyframe/key").attributes[vector]
    found: dict[str, Entry] = {}
    for name, item in value.items():
        subject = f"{named} `{name}` in {owner}"
        path = (*at, name)
        if item == HOLD:
            message = f"`{vector}` of {subject} is given in numbers: only controls hold a pose"
            help = f"give the pose in `qpos`, and write `{CTRL}: {HOLD}` next to it"
            reader.faults.append(Fault("wrong-type", message, path, help=help))
            continue
        read = read_value(attribute, item, path, owner=subject, faults=reader.faults, tag="key")
        if read is None:
            continue
        entry = read if isinstance(read, tuple) else (read,)
        width = WIDTHS.get(vector, len(entry) or 1)
        if not all(math.isfinite(each) for each in entry if isinstance(each, int | float)):
            message = f"`{vector}` of {subject} expects finite numbers"
            reader.faults.append(Fault("out-of-range", message, path))
        elif len(entry) == width:
            found[name] = entry
        else:
            message = f"`{vector}` of {subject} expects {width} numbers, got {len(entry)}"
            reader.faults.append(Fault("wrong-length", message, path))
    return found


_EXAMPLES = {"mpos": "[0, 0, 0.1]", "mquat": "[1, 0, 0, 0]"}
