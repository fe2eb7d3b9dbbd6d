"""What dm_control's tests take from dm_control beside `mjcf`, on MuJoCo alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from mjcompose.mjcf import Element, Physics, RootElement
from mjcompose.mjcf.attributed import always_there
from mjcompose.tree.grammar import ElementType
from mjcompose.tree.select import kind_of

_COLUMNS = {"x": 0, "y": 1, "z": 2}


class MjModel:
    """`dm_control.mujoco.wrapper.MjModel`: MuJoCo's own model, and its bytes."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self.model = model

    @classmethod
    def from_xml_string(cls, text: str, assets: Mapping[str, bytes] | None = None) -> MjModel:
        return cls(mujoco.MjModel.from_xml_string(text, dict(assets or {})))

    @classmethod
    def from_xml_path(cls, path: str) -> MjModel:
        return cls(mujoco.MjModel.from_xml_path(path))

    def to_bytes(self) -> bytes:
        buffer = np.empty(mujoco.mj_sizeModel(self.model), np.uint8)
        mujoco.mj_saveModel(self.model, None, buffer)
        return buffer.tobytes()


def MjData(model: MjModel) -> mujoco.MjData:  # noqa: N802
    return mujoco.MjData(model.model)


def to_native_string(text: bytes | str) -> str:
    return text.decode() if isinstance(text, bytes) else text


def files(folder: str) -> list[str]:
    """The files of a folder and of those in it, by their paths below it."""
    return [path.relative_to(folder).as_posix() for path in Path(folder).rglob("*") if path.is_file()]


def with_names(root: RootElement) -> RootElement:
    """The model, with a name for every actuator and sensor that has none."""
    for tag in ("actuator", "sensor"):
        for number, element in enumerate(root.find_all(tag)):
            element.name = element.name or f"{tag}_{number}"
    return root


def name2id(physics: Physics, names: str, kind: str) -> int:
    """The number of a named element, as MuJoCo tells it."""
    return int(getattr(physics.model, kind)(names).id)


class Spec:
    """What dm_control's `element.spec` says, by our grammar."""

    def __init__(self, kind: ElementType, above: ElementType | None = None) -> None:
        self.name = kind.tag
        self.attributes = kind.attributes
        self.kind = kind
        self.above = above
        self.repeated = kind.max_count != 1
        self.on_demand = above is not None and not always_there(above, kind)

    @property
    def children(self) -> dict[str, Spec]:
        return {tag: Spec(child, self.kind) for tag, child in self.kind.children.items()}

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Spec) and self.kind.path == other.kind.path

    __hash__ = None  # type: ignore[assignment]


def spec(element: Element) -> Spec:
    return Spec(kind_of(element._node))


class Named:
    """Rows of MuJoCo's arrays by the names of elements, found by MuJoCo's own accessors."""

    def __init__(self, physics: Physics) -> None:
        self.model = _Arrays(physics, physics.model)
        self.data = _Arrays(physics, physics.data)


class _Arrays:
    def __init__(self, physics: Physics, struct: Any) -> None:
        self.physics = physics
        self.struct = struct

    def __getattr__(self, field: str) -> _Rows:
        return _Rows(self.physics.model, getattr(self.struct, field), field)


class _Rows:
    def __init__(self, model: mujoco.MjModel, array: Any, field: str) -> None:
        self.model = model
        self.array = array
        self.field = field

    def __getitem__(self, key: Any) -> Any:
        names, columns = key if isinstance(key, tuple) else (key, None)
        rows = self._rows(names)
        if columns is None:
            return self.array[rows]
        columns = _numbers(columns)
        pairs = isinstance(rows, list) and isinstance(columns, list)
        return self.array[np.ix_(rows, columns) if pairs else (rows, columns)]

    def _rows(self, names: Any) -> Any:
        if isinstance(names, str):
            found = self._of(names)
            return found[0] if len(found) == 1 and self.array.ndim > 1 else found
        return [row for name in np.ravel(names) for row in self._of(str(name))]

    def _of(self, name: str) -> list[int]:
        model = self.model
        if self.field == "qpos":
            joint = model.joint(name)
            return list(range(joint.qposadr[0], joint.qposadr[0] + len(joint.qpos0)))
        if self.field == "sensordata":
            sensor = model.sensor(name)
            return list(range(sensor.adr[0], sensor.adr[0] + sensor.dim[0]))
        if self.field in ("act", "act_dot"):
            actuator = model.actuator(name)
            return list(range(actuator.actadr[0], actuator.actadr[0] + actuator.actnum[0]))
        if self.field.startswith("mocap_"):
            return [int(model.body(name).mocapid[0])]
        kind = self.field.partition("_")[0] if "_" in self.field else "body"
        return [int(getattr(model, {"xfrc": "body"}.get(kind, kind))(name).id)]


def _numbers(columns: Any) -> Any:
    if isinstance(columns, str):
        return _COLUMNS[columns]
    if isinstance(columns, (Sequence, np.ndarray)):
        return [_COLUMNS.get(each, each) for each in np.ravel(columns).tolist()]
    return columns
