"""The addresses of everything in a compiled model, by name."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property

from composer.bundle.manifest import Actuator, Joint
from composer.bundle.manifest import Index as Listed
from composer.compiled.joints import BY_WORD
from composer.loading.numbers import Lookup, Numbers
from composer.loading.vector import UNLIMITED, Entry, Range, Vector


class Index:
    """The vectors and elements of a model by name, so that programs need not depend on their order.

    `qpos`, `qvel`, `ctrl`, `act` and `sensordata` have the addresses in the vectors of that name; `camera`, `key`,
    `joint`, `actuator`, `sensor`, `body`, `geom`, `site` and `tendon` have the ids of elements. `qvel` serves every
    vector of `nv` numbers: `qacc`, `qfrc_applied`, ….
    """

    def __init__(self, listed: Listed, names: Callable[[str], Sequence[str]], separator: str = "/") -> None:
        """Create the index; `names` returns the names of a kind in the order of the model."""
        self._listed, self._names, self._separator = listed, names, separator

    @cached_property
    def qpos(self) -> Vector:
        """Positions of joints: rad, m, and quaternions (w x y z)."""
        return self._vector("qpos", "joint", [_position(joint) for joint in self._listed.joints])

    @cached_property
    def qvel(self) -> Vector:
        """Velocities of joints: rad/s, m/s. MuJoCo does not limit them."""
        return self._vector("qvel", "joint", [_velocity(joint) for joint in self._listed.joints])

    @cached_property
    def ctrl(self) -> Vector:
        """Controls of actuators, with their limits."""
        entries = [
            Entry(
                each.name,
                each.ctrl,
                (each.unit,) * each.ctrl_size,
                limits=tuple(map(_limits, each.ranges)),
                origin=each.origin,
            )
            for each in self._listed.actuators
        ]
        return self._vector("ctrl", "actuator", entries)

    @cached_property
    def act(self) -> Vector:
        """Activations of the actuators that have some."""
        entries = list(_activations(self._listed.actuators))
        return self._vector("act", "activation", entries)

    @cached_property
    def sensordata(self) -> Vector:
        """Sensor values; limits are their cutoff."""
        entries = [
            Entry(
                each.name,
                each.address,
                (each.unit,) * each.size,
                limits=((-each.cutoff, each.cutoff) if each.cutoff is not None else UNLIMITED,) * each.size,
                origin=each.origin,
            )
            for each in self._listed.sensors
        ]
        return self._vector("sensordata", "sensor", entries)

    @cached_property
    def camera(self) -> Numbers:
        """Ids of cameras."""
        return self._numbers("camera")

    @cached_property
    def key(self) -> Numbers:
        """Ids of keyframes, for `mj_resetDataKeyframe`."""
        return self._numbers("key", "keyframe")

    @cached_property
    def joint(self) -> Numbers:
        """Ids of joints."""
        return self._numbers("joint")

    @cached_property
    def actuator(self) -> Numbers:
        """Ids of actuators."""
        return self._numbers("actuator")

    @cached_property
    def sensor(self) -> Numbers:
        """Ids of sensors."""
        return self._numbers("sensor")

    @cached_property
    def body(self) -> Numbers:
        """Ids of bodies; `world` is 0."""
        return self._numbers("body")

    @cached_property
    def geom(self) -> Numbers:
        """Ids of geoms."""
        return self._numbers("geom")

    @cached_property
    def site(self) -> Numbers:
        """Ids of sites."""
        return self._numbers("site")

    @cached_property
    def tendon(self) -> Numbers:
        """Ids of tendons."""
        return self._numbers("tendon")

    def _vector(self, name: str, kind: str, entries: Sequence[Entry]) -> Vector:
        return Vector(name, kind, entries, separator=self._separator)

    def _numbers(self, kind: str, word: str | None = None) -> Numbers:
        return Numbers(Lookup(word or kind, self._names(kind), self._separator))

    def __repr__(self) -> str:
        vectors = (self.qpos, self.qvel, self.ctrl, self.act, self.sensordata)
        return f"<Index: {', '.join(f'{each.name} {each.size}' for each in vectors)}>"


def _limits(pair: tuple[float | None, float | None] | None) -> Range:
    low, high = pair or (None, None)
    return (UNLIMITED[0] if low is None else low, UNLIMITED[1] if high is None else high)


def _position(joint: Joint) -> Entry:
    units = BY_WORD[joint.type].position_units
    scalar = joint.qpos_size == 1  # the range of a ball joint is an angle, not one of its numbers
    limits = (_limits(joint.range) if scalar else UNLIMITED,) * joint.qpos_size
    return Entry(joint.name, joint.qpos, units, limits=limits, body=joint.body, origin=joint.origin)


def _velocity(joint: Joint) -> Entry:
    units = BY_WORD[joint.type].velocity_units
    return Entry(
        joint.name,
        joint.dof,
        units,
        limits=(UNLIMITED,) * joint.dof_size,
        body=joint.body,
        origin=joint.origin,
    )


def _activations(actuators: Sequence[Actuator]) -> Iterator[Entry]:
    for each in actuators:
        if each.act is not None:
            limits = (_limits(each.act_range),) * each.act_size
            yield Entry(each.name, each.act, (None,) * each.act_size, limits=limits, origin=each.origin)
