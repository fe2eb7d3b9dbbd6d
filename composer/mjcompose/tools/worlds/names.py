"""The ids and addresses of everything in a compiled model, by name."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property
from itertools import chain
from typing import Any, TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Note
from mjcompose.base.report import MjcomposeError
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.bundle.manifest import ManifestIndex as Listed
from mjcompose.mujoco.arrays import BY_WORD
from mjcompose.tree.pattern import BadPattern, fitter, is_pattern


class LoadError(MjcomposeError):
    """A bundle that cannot be loaded, or does not match its manifest."""


def failure(code: str, message: str, help: str | None = None, notes: Sequence[str] = ()) -> LoadError:
    """Return an exception with one diagnostic."""
    return LoadError([Diagnostic(code, message, notes=tuple(map(Note, notes)), help=help)])


class UnknownNameError(MjcomposeError, KeyError):
    """A name that a model does not have; the message lists the existing names. Also a KeyError."""


class BundleWarning(UserWarning):
    """A possible problem of a bundle, for instance that another version of MuJoCo verified the model."""


Several: TypeAlias = tuple[str, ...] | list[str]
Names: TypeAlias = str | Several
"""One name or glob, or several of them."""


def unknown(kind: str, name: str, known: Iterable[str]) -> UnknownNameError:
    """Return the error for a name or a glob that matches nothing."""
    known = [each for each in known if each]
    message = f"the model has no {kind} `{name}`"
    notes = (exists_note(kind, known, name),)
    return UnknownNameError([Diagnostic("unknown-name", message, notes=notes, help=did_you_mean(name, known))])


class _Named:
    """Elements of one kind in the order of the model, and their look-up by name or glob.

    `*` and `?` stop at the separator, `**` does not, `{a,b}` is a choice, `/…/` a regular expression over the whole
    name. An existing name always matches itself, whatever characters it has.
    """

    def __init__(self, kind: str, names: Sequence[str], separator: str) -> None:
        self._kind = kind
        self._separator = separator
        self.names = tuple(names)
        """All names in the order of the model; unnamed elements are ""."""
        self._by_name: dict[str, int] = {}
        for row, name in enumerate(self.names):
            if name:
                self._by_name.setdefault(name, row)

    def _row(self, name: str) -> int | None:
        """Return the row of one name, or None for a glob. Raises UnknownNameError."""
        found = self._by_name.get(name)
        if found is None and not is_pattern(name):
            raise unknown(self._kind, name, self._by_name)
        return found

    def _rows(self, names: Names) -> list[int]:
        """Return the rows of all names, in their order; a glob has the order of the model."""
        if not isinstance(names, Iterable):
            raise TypeError(f"give one or several names, not {names!r}")
        found: list[int] = []
        several = [names] if isinstance(names, str) else names
        for name in several:
            row = self._row(name)
            if row is not None:
                found.append(row)
                continue
            try:
                fits = fitter(name, self._by_name.keys, self._separator)
            except BadPattern as bad:
                raise UnknownNameError([Diagnostic("selector", bad.message, help=bad.help)]) from None
            matched = [row for known, row in self._by_name.items() if fits(known)]
            if not matched:
                raise unknown(self._kind, name, self._by_name)
            found += matched
        return found

    def __contains__(self, name: object) -> bool:
        return name in self._by_name

    def __iter__(self) -> Iterator[str]:
        return iter(self._by_name)

    def __len__(self) -> int:
        return len(self.names)


class Numbers(_Named):
    """The id of each element of a kind in `mjModel`: `index.camera["overview"]`.

    One name gives an int; several names, or a glob, give an array of shape (n,).
    """

    @overload
    def __getitem__(self, names: str) -> int: ...
    @overload
    def __getitem__(self, names: Several) -> NDArray[np.intp]: ...
    def __getitem__(self, names: Names) -> int | NDArray[np.intp]:
        """Return the id for a name, or the ids for several names or a glob. Raises UnknownNameError.

        For a glob the declared type is int, as for a name, although the result is an array.
        """
        if isinstance(names, str) and (row := self._row(names)) is not None:
            return row
        return np.array(self._rows(names), dtype=np.intp)

    def __repr__(self) -> str:
        return f"<{len(self)} × {self._kind}>"


Place: TypeAlias = int | slice | NDArray[np.intp]
"""An index into a vector or a batch of vectors: `qpos[place]`, `qpos[..., place]`."""

Range: TypeAlias = tuple[float, float]
UNLIMITED: Range = (-np.inf, np.inf)


class VectorEntry(Struct):
    """One element of the model in a vector: `units` and `limits` have an item for each of its numbers.

    `body` is its body, and `origin` is the place where it is written; each is None if it does not apply or is unknown.
    """

    name: str
    start: int
    units: tuple[str | None, ...]
    limits: tuple[Range, ...]
    body: str | None = None
    origin: str | None = None

    @property
    def size(self) -> int:
        """The number of its values."""
        return len(self.units)


class Vector(_Named):
    """One vector of MuJoCo (`qpos`, `ctrl`, …), by name.

    `index.qpos["elbow"]` is an int if the element has one number, else a slice; `index.qpos["a", "b"]` and globs
    (`index.qpos["left/*"]`) are an array of all their numbers, shape (n,). All three index a single vector,
    `data.qpos[place]`, and the last axis of a batch, `qpos[..., place]`.
    """

    def __init__(self, name: str, kind: str, entries: Sequence[VectorEntry], separator: str) -> None:
        self.name = name
        self.entries = tuple(entries)
        super().__init__(kind, [each.name for each in entries], separator)

    @property
    def size(self) -> int:
        """The length of the vector."""
        return sum(each.size for each in self.entries)

    def __getitem__(self, names: Names) -> Place:
        """Return the addresses of the elements with these names or globs. Raises UnknownNameError, a KeyError."""
        if isinstance(names, str) and (row := self._row(names)) is not None:
            entry = self.entries[row]
            return entry.start if entry.size == 1 else slice(entry.start, entry.start + entry.size)
        return self.array(names)

    def array(self, names: Names) -> NDArray[np.intp]:
        """Return the addresses as an array of shape (n,), even for one name."""
        places = (range(each.start, each.start + each.size) for each in self._entries(names))
        return np.array([*chain.from_iterable(places)], dtype=np.intp)

    def on(self, body: str) -> Place:
        """Return the addresses of the elements of a body, including unnamed joints. Raises UnknownNameError."""
        found = [each for each in self.entries if each.body == body]
        if not found:
            raise unknown(f"body with a {self._kind}", body, [each.body for each in self.entries if each.body])
        start = found[0].start
        end = found[-1].start + found[-1].size
        return start if end - start == 1 else slice(start, end)

    def limits(self, names: Names = "**") -> NDArray[np.float64]:
        """Return the smallest and largest value of each number in its unit, shape (n, 2), infinite without a limit."""
        limits = [pair for each in self._entries(names) for pair in each.limits]
        return np.array(limits, dtype=np.float64).reshape(-1, 2)

    def units(self, names: Names = "**") -> tuple[str | None, ...]:
        """Return the unit of each number: `rad`, `m`, `quaternion`, `N m`, …; None if it depends on the model."""
        return tuple(unit for each in self._entries(names) for unit in each.units)

    def origin(self, name: str) -> str | None:
        """Return the place where an element is written, as FILE:LINE."""
        (entry,) = self._entries(name)[:1]
        return entry.origin

    def _entries(self, names: Names) -> list[VectorEntry]:
        if names == "**":
            return list(self.entries)
        return [self.entries[row] for row in self._rows(names)]

    def __repr__(self) -> str:
        return f"<{self.name}: {self.size} numbers of {len(self)} × {self._kind}>"


def _ids(kind: str, word: str = "") -> cached_property[Numbers]:
    def ids(index: Index) -> Numbers:
        return Numbers(word or kind, index._names(kind), index._separator)

    ids.__doc__ = f"Ids of {word or kind}s."
    return cached_property(ids)


class Index:
    """The vectors and elements of a model by name: programs need not depend on their order.

    `qpos`, `qvel`, `ctrl`, `act` and `sensordata` have the addresses in the vectors of that name; `camera`, `key`,
    `joint`, `actuator`, `sensor`, `body`, `geom`, `site` and `tendon` have the ids of elements. `qvel` serves every
    vector of `nv` numbers: `qacc`, `qfrc_applied`, ….
    """

    def __init__(self, listed: Listed, names: Callable[[str], Sequence[str]], separator: str = "/") -> None:
        """Create the index; `names` returns the names of a kind in the order of the model."""
        self._listed = listed
        self._names = names
        self._separator = separator

    @cached_property
    def qpos(self) -> Vector:
        """Positions of joints: rad, m, and quaternions (w x y z)."""
        # The range of a ball joint is an angle, not one of its numbers.
        return self._vector(
            "qpos",
            "joint",
            (
                (
                    each,
                    each.qpos,
                    BY_WORD[each.type].position_units,
                    (_limits(each.range) if each.qpos_size == 1 else UNLIMITED,) * each.qpos_size,
                )
                for each in self._listed.joints
            ),
        )

    @cached_property
    def qvel(self) -> Vector:
        """Velocities of joints: rad/s, m/s. MuJoCo does not limit them."""
        return self._vector(
            "qvel",
            "joint",
            (
                (each, each.dof, BY_WORD[each.type].velocity_units, (UNLIMITED,) * each.dof_size)
                for each in self._listed.joints
            ),
        )

    @cached_property
    def ctrl(self) -> Vector:
        """Controls of actuators, with their limits."""
        return self._vector(
            "ctrl",
            "actuator",
            (
                (each, each.ctrl, (each.unit,) * each.ctrl_size, tuple(map(_limits, each.ranges)))
                for each in self._listed.actuators
            ),
        )

    @cached_property
    def act(self) -> Vector:
        """Activations of the actuators that have some."""
        return self._vector(
            "act",
            "activation",
            (
                (each, each.act, (None,) * each.act_size, (_limits(each.act_range),) * each.act_size)
                for each in self._listed.actuators
                if each.act is not None
            ),
        )

    @cached_property
    def sensordata(self) -> Vector:
        """Sensor values; limits are their cutoff."""
        return self._vector(
            "sensordata",
            "sensor",
            (
                (
                    each,
                    each.address,
                    (each.unit,) * each.size,
                    (UNLIMITED if each.cutoff is None else (-each.cutoff, each.cutoff),) * each.size,
                )
                for each in self._listed.sensors
            ),
        )

    camera = _ids("camera")
    """Ids of cameras."""
    key = _ids("key", "keyframe")
    """Ids of keyframes, for `mj_resetDataKeyframe`."""
    joint = _ids("joint")
    """Ids of joints."""
    actuator = _ids("actuator")
    """Ids of actuators."""
    sensor = _ids("sensor")
    """Ids of sensors."""
    body = _ids("body")
    """Ids of bodies; `world` is 0."""
    geom = _ids("geom")
    """Ids of geoms."""
    site = _ids("site")
    """Ids of sites."""
    tendon = _ids("tendon")
    """Ids of tendons."""

    def _vector(
        self, name: str, kind: str, found: Iterable[tuple[Any, int, tuple[str | None, ...], tuple[Range, ...]]]
    ) -> Vector:
        """Return a vector of the elements, each with its first address, its units and its limits."""
        entries = [
            VectorEntry(each.name, start, units, limits=limits, body=getattr(each, "body", None), origin=each.origin)
            for each, start, units, limits in found
        ]
        return Vector(name, kind, entries, separator=self._separator)

    def __repr__(self) -> str:
        vectors = (self.qpos, self.qvel, self.ctrl, self.act, self.sensordata)
        return f"<Index: {', '.join(f'{each.name} {each.size}' for each in vectors)}>"


def _limits(pair: tuple[float | None, float | None] | None) -> Range:
    low, high = pair or (None, None)
    return (UNLIMITED[0] if low is None else low, UNLIMITED[1] if high is None else high)
