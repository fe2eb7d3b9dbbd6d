"""The section `keyframe`, and the controls of a key."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import field, replace
from typing import Any, Literal

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.suggest import closest, renaming
from mjcompose.language.element import Reader, path_of
from mjcompose.language.element_schema import attribute_schema, by_name, mapping
from mjcompose.language.form import Schema, Single, kind_of, reference, shown, unknown_key
from mjcompose.language.sections import Section
from mjcompose.language.value import read_value
from mjcompose.model.grammar import GRAMMAR
from mjcompose.text.expression_values import Angle

CTRL, HOLD, JOINT = "ctrl", "hold", "joint"
Way = Literal["positions", "forces"]
WAYS: tuple[Way, ...] = ("positions", "forces")
"""What all actuators hold with: servos at the pose, or forces that balance what acts on it."""
_ALL = "write `ctrl: hold` for all actuators, `ctrl: {ACTUATOR: hold}` for one"


@dataclass(frozen=True, slots=True)
class Controls:
    """The entries of `ctrl` other than numbers by actuator.

    `hold` is how all actuators hold the pose, or None. `held` has the paths below `ctrl` of those that do so
    individually: by actuator (`("grip",)`) or by joint (`("joint", "elbow")`). `joints` has the numbers by joint.
    """

    hold: Way | None = None
    held: tuple[tuple[str, ...], ...] = ()
    joints: Mapping[str, Any] = field(default_factory=dict)


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
    """Return the entries other than `hold`. The paths of those with `hold` are added to `held`."""
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
        message = f"`{HOLD}` in `{CTRL}` of {owner} is `positions` or `forces`, got `{shown(value)}`"
        help = f"write `{HOLD}: {near[0]}`" if near else f"write `{CTRL}: {HOLD}` for the positions of servos"
        fix = renaming(value, WAYS) if isinstance(value, str) else None
        reader.faults.append(Fault("wrong-keyword", message, at, help=help, fix=fix))
    return found


def controls_schema(number: Schema, description: str) -> Schema:
    """Return the schema: `hold`, or a mapping from actuators to numbers or `hold`, with `hold` and `joint`."""
    hold: Schema = {"const": HOLD, "description": "the control that holds the pose of the key"}
    entry: Schema = {"anyOf": [number, hold]}
    return {
        "anyOf": [
            {"const": HOLD, "description": "the controls of all actuators that hold the pose of the key"},
            {
                **by_name(entry),
                "properties": {
                    HOLD: {
                        "anyOf": [{"enum": list(WAYS)}, entry],
                        "description": "what all actuators hold the pose with: servos at the pose, or forces that"
                        " balance what acts on the model there",
                    },
                    JOINT: {"anyOf": [by_name(entry), entry], "description": "numbers, or `hold`, by joint"},
                },
                "description": description,
            },
        ],
        "description": description,
    }


FROM, TIME = "from", "time"
VECTORS: Mapping[str, str] = {
    "qpos": "joint",
    "qvel": "joint",
    "act": "actuator",
    "ctrl": "actuator",
    "mpos": "mocap body",
    "mquat": "mocap body",
}
"""The vectors of a key, each with what its entries are named after."""
WIDTHS = {"mpos": 3, "mquat": 4}
KEYS = (FROM, TIME, *VECTORS)
"""What a key may have, in the order in which `fmt` writes it."""

Entry = tuple[Single, ...]


@dataclass(frozen=True, slots=True)
class Keyframe:
    """One key: which keys of parts it takes over, by the path of the part, and the entries that it sets.

    `values` has the entries of each vector by name, and `controls` the other entries of `ctrl`. `at` is the path to
    its mapping in the recipe.
    """

    name: str
    time: float | None = None
    sources: Mapping[str, str] = field(default_factory=dict)
    values: Mapping[str, Mapping[str, Entry]] = field(default_factory=dict)
    at: Path = ()
    controls: Controls = field(default_factory=Controls)


@dataclass(frozen=True, slots=True)
class Keyframes(Section):
    """Form of a mapping from the names of keys to their contents, read as a tuple of `Keyframe`."""

    def content(self, reader: Reader, value: Any) -> tuple[Keyframe, ...]:
        entries = reader.names(value, (), f"`{self.tag}`")
        read = [_keyframe(reader, name, item) for name, item in entries]
        return tuple(each for each in read if each is not None)

    def schema(self) -> Schema:
        key = self.kind.children["key"]
        sources = {
            **by_name({"type": "string", "minLength": 1}),
            "description": "a key of each part to start from, by the path of the part: `base`, `left`, `left/gripper`",
        }
        entries = {
            vector: {
                **by_name(reference(f"number-{WIDTHS[vector]}" if vector in WIDTHS else "number-1-")),
                "description": f"{key.attributes[vector].doc}: a mapping by {named}",
            }
            for vector, named in VECTORS.items()
        }
        entries[CTRL] = controls_schema(reference("number-1-"), entries[CTRL]["description"])
        return by_name(mapping({FROM: sources, TIME: attribute_schema(key.attributes[TIME]), **entries}))


def _keyframe(reader: Reader, name: str, value: Any) -> Keyframe | None:
    owner, at = f"keyframe `{name}`", (name,)
    if not isinstance(value, dict):
        help = "write what is in it by name: `qpos: {JOINT: 0.1}`" if isinstance(value, list) else None
        message = f"{owner} expects a mapping, got {kind_of(value)}"
        reader.faults.append(Fault("wrong-type", message, at, help=help))
        return None
    for key in value:
        if key not in KEYS:
            fault = unknown_key(f"`{key}` is not a key of a keyframe", key, KEYS, at=(*at, key))
            if key == HOLD:
                help = f"write `{CTRL}: {HOLD}`, or `{CTRL}: {{{HOLD}: forces}}`"
                fault = replace(fault, help=help, fix=None)
            reader.faults.append(fault)
    given = dict(value)
    controls = Controls()
    if CTRL in given:
        read = read_controls(reader, given.pop(CTRL), (*at, CTRL), owner=owner)
        if read is not None:
            controls, by_actuator, by_joint = read
            joints = _entries(reader, CTRL, by_joint, at=(*at, CTRL, JOINT), owner=owner, named="joint")
            controls = replace(controls, joints=joints)
            given[CTRL] = by_actuator
    values = {
        vector: _entries(reader, vector, given[vector], at=(*at, vector), owner=owner, named=VECTORS[vector])
        for vector in VECTORS
        if vector in given
    }
    sources = _sources(reader, value[FROM], (*at, FROM), owner=owner) if FROM in value else {}
    time = _time(reader, value[TIME], (*at, TIME), owner=owner) if TIME in value else None
    return Keyframe(name, time, sources, values=values, at=path_of(value), controls=controls)


def _time(reader: Reader, value: Any, at: Path, owner: str) -> float | None:
    read = read_value(GRAMMAR.element("keyframe/key").attributes[TIME], value, at, owner=owner, faults=reader.faults)
    if isinstance(read, Angle):
        message = f"`{TIME}` of {owner} is in seconds, and {shown(str(read))} is an angle"
        reader.faults.append(Fault("wrong-type", message, at))
        return None
    return float(read) if isinstance(read, int | float) else None


def _sources(reader: Reader, value: Any, at: Path, owner: str) -> dict[str, str]:
    """Return the key of each part from which the key is made."""
    if not isinstance(value, dict):
        name = value if isinstance(value, str) else "home"
        message = f"`{FROM}` of {owner} expects a mapping from parts to their keys, got {kind_of(value)}"
        help = f"write `{FROM}: {{base: {name}}}`, or the prefix of a part in place of `base`"
        reader.faults.append(Fault("wrong-type", message, at, help=help))
        return {}
    found: dict[str, str] = {}
    for part, key in value.items():
        if isinstance(key, str) and key:
            found[part] = key
        else:
            quoted = None if isinstance(key, list | dict) or key == "" else f"quote it: '{shown(key)}'"
            message = f"`{part}` in `{FROM}` of {owner} expects the name of a key, got {kind_of(key)}"
            reader.faults.append(Fault("wrong-type", message, (*at, part), help=quoted))
    return found


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
        subject, path = f"{named} `{name}` in {owner}", (*at, name)
        if item == HOLD:
            message = f"`{vector}` of {subject} is given in numbers: what holds a pose are controls"
            help = f"give the pose in `qpos`, and write `{CTRL}: {HOLD}` beside it"
            reader.faults.append(Fault("wrong-type", message, path, help=help))
            continue
        read = read_value(attribute, item, path, owner=subject, faults=reader.faults)
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
