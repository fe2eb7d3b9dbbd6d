"""`ctrl` of a key: numbers by actuator or joint, and controls that hold the pose of the key."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any, Literal

from composer.dataclass import dataclass
from composer.diagnostics.suggest import closest, renaming
from composer.recipe.element_schema import by_name
from composer.recipe.fault import Fault, Path
from composer.recipe.reader import Reader
from composer.recipe.reference import Schema
from composer.recipe.shown import shown

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
    reader: Reader,
    value: Mapping[str, Any],
    at: Path,
    owner: str,
    path: tuple[str, ...],
    held: list[tuple[str, ...]],
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
