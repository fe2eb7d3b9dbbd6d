"""A recording in the model's names and units, and everything about it that must be right before a fit.

Runs in MuJoCo's process.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from mjcompose.base.dataclass import Struct
from mjcompose.base.suggest import closest, did_you_mean
from mjcompose.base.words import with_article
from mjcompose.mujoco.attributes import names
from mjcompose.tools.identify.files import ReadingKeys, RecordedFile, read_file
from mjcompose.tools.identify.tables import RecordedTable, RecordingFault, Series, SizeLimits
from mjcompose.tree.pattern import fitter

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

_KINDS = {"qpos": "joint", "qvel": "joint", "ctrl": "actuator", "sensor": "sensor"}
"""The first word of a column, and the kind of element that it names."""
_CODE = "recording-column"
_TIME = "recording-time"
_SHORTEST = 0.2
"""Seconds that a recording has at least."""
_SLOWEST = 0.5
"""Seconds between samples above which the unit of the time must be written: motion is too fast for such samples."""
_SLOWEST_WITH_UNIT = 10.0
_AGAINST = -0.5
"""The correlation of a joint with its command below which its sign is probably wrong."""


class Signal(NamedTuple):
    """One number that is recorded and simulated: `qpos`, `qvel` or `sensor`, its element, and which of its numbers."""

    kind: str
    name: str
    component: int = 0

    @property
    def word(self) -> str:
        index = f"[{self.component}]" if self.component else ""
        return f"{self.kind} {self.name}{index}"


class Command(NamedTuple):
    """The commands of an actuator: each value holds from its time to the next."""

    times: Series
    values: Series


class Recording(Struct):
    """A recording of motion: signals on one clock, which starts at 0, and commands by actuator."""

    file: str
    sha256: str
    times: Series
    signals: Mapping[Signal, Series]
    commands: Mapping[str, Command]

    @property
    def seconds(self) -> float:
        return float(self.times[-1])


def read_recording(
    mujoco: Any, model: MjModel, path: Path, file: str, keys: dict[str, Any], limits: SizeLimits
) -> Recording:
    """Return the recording of a file, which messages call `file`. Raises RecordingFault with its name."""
    try:
        return _Reader(mujoco, model, keys).read(path, file, limits)
    except RecordingFault as fault:
        fault.file = file
        raise


class _Reader:
    """Reads columns by the keys of `recording`."""

    def __init__(self, mujoco: Any, model: MjModel, keys: dict[str, Any]) -> None:
        self.mujoco = mujoco
        self.model = model
        self.keys = keys
        self.known = {kind: [name for name in names(model, kind) if name] for kind in set(_KINDS.values())}

    def read(self, path: Path, file: str, limits: SizeLimits) -> Recording:
        self._check_sign_names()
        self._check_percent_names()
        recorded = read_file(path, self._reading_keys(), limits)
        table = self._without_empty_rows(recorded.table)
        times = self._times(table)
        signals: dict[Signal, Series] = {}
        commands: dict[str, Command] = {}
        for signal, column, source in self._signals(replace(recorded, table=table)):
            clock = times if source is table else self._times(source, is_steady=False)
            values = self._in_mujoco_units(signal, source.columns[column])
            self._check_unit(signal, column, values, source)
            if signal.kind == "ctrl":
                _check_finite(source, clock, column, values, may_lack=True)
                known = np.isfinite(values)
                commands[signal.name] = Command(clock[known] - times[0], values[known])
            else:
                _check_finite(source, clock, column, values)
                signals[signal] = values
        self._check_contents(signals, commands, recorded)
        recording = Recording(file, recorded.sha256, times - times[0], signals, commands)
        if recording.seconds < _SHORTEST:
            message = f"it is {recording.seconds * 1e3:.0f} ms long"
            raise RecordingFault(_TIME, message, "record some seconds of motion; the time is in seconds")
        self._check_signs(recording, table)
        return recording

    def _reading_keys(self) -> ReadingKeys:
        keys = self.keys
        joints = tuple(keys["command_joints"])
        return ReadingKeys(keys["state"], keys["command"], joints, keys["clock"], keys["episode"], self._ignores)

    def _times(self, table: RecordedTable, *, is_steady: bool = True) -> Series:
        """Return the times of a table in seconds. Raises RecordingFault if they are not those of one motion."""
        has_unit = "time" in self.keys["dimensions"]
        if table.timed and has_unit:
            help = "remove `units: {time: …}`"
            raise RecordingFault("recording-unit", "the times of the file have their unit in the file", help)
        times: Series = table.times * self.keys["factors"]["time"]
        _check_clock(table, times, has_unit=has_unit or table.timed, is_steady=is_steady)
        return times

    def _without_empty_rows(self, table: RecordedTable) -> RecordedTable:
        """Return the rows with a number: in a topic, messages may have the numbers of ignored joints alone."""
        if not table.sparse:
            return table
        columns = [column for column in table.columns if not self._leaves_out(column)]
        is_known = np.zeros(len(table.times), bool)
        for column in columns:
            is_known |= np.isfinite(table.columns[column])
        if is_known.all() or is_known.sum() < 2:
            return table
        return replace(
            table,
            times=table.times[is_known],
            columns={column: values[is_known] for column, values in table.columns.items()},
        )

    def _leaves_out(self, column: str) -> bool:
        """Whether the recipe ignores a column, by its name in the recording or in the model."""
        written, _ = _without_index(column.partition(" ")[2])
        name = self.keys["prefix"] + self.keys["names"].get(written, written)
        return any(self._ignores(each) for each in (column, written, name))

    def _signals(self, recorded: RecordedFile) -> list[tuple[Signal, str, RecordedTable]]:
        """Return the signal of each column that counts. Raises RecordingFault with the line of the header."""
        found: list[tuple[Signal, str, RecordedTable]] = []
        columns: dict[Signal, str] = {}
        try:
            for table in recorded.tables:
                for column in table.columns:
                    signal = self._signal(column)
                    if signal is None:
                        continue
                    self._check_component(signal, column)
                    first = columns.setdefault(signal, column)
                    if first != column:
                        message = f"`{first}` and `{column}` are both `{signal.word}`"
                        raise RecordingFault(_CODE, message, f"remove one of them, or `ignore: [{column}]`")
                    found.append((signal, column, table))
            self._check_units(columns)
        except RecordingFault as fault:
            fault.line = recorded.table.header
            raise
        return found

    def _check_component(self, signal: Signal, column: str) -> None:
        """Refuse a number that the element does not have, and joints whose position is several numbers."""
        if signal.kind == "sensor":
            count = int(self.model.sensor(signal.name).dim[0])
            if signal.component >= count:
                numbers = "1 number" if count == 1 else f"{count} numbers"
                raise RecordingFault(
                    _CODE, f"`{column}` does not exist: the sensor has {numbers}", "`[0]` is the first"
                )
            return
        if signal.component:
            raise RecordingFault(
                _CODE, f"`{column}` does not exist: `{signal.name}` has 1 number", "leave out the index"
            )
        if signal.kind != "ctrl" and self._dimension(signal) is None:
            help = f"only hinges and slides are compared; `ignore: [{signal.name}]` leaves the joint out"
            raise RecordingFault(_CODE, f"joint `{signal.name}` of `{column}` is neither a hinge nor a slide", help)

    def _check_sign_names(self) -> None:
        """Refuse signs of elements that the model does not have."""
        prefix = self.keys["prefix"]
        for written in self.keys["sign"]:
            kind, _, name = written.partition(" ")
            kinds = [_KINDS[kind]] if kind in _KINDS and name else list(self.known)
            known = [each for kind in kinds for each in self.known[kind]]
            if prefix + written in known or (len(kinds) == 1 and prefix + name in known):
                continue
            meant = did_you_mean(written, [self._without_prefix(each) for each in known])
            message = f"`recording: {{sign: …}}` has `{written}`, which names no element of the model"
            help = meant or "write the name of the model, not of the recording"
            raise RecordingFault("unknown-name", message, help, at=("recording", "sign", written))

    def _check_percent_names(self) -> None:
        """Refuse percent of joints that the model does not have, or that have no range."""
        joints = self.known["joint"]
        for written in self.keys["percent"]:
            name = self.keys["prefix"] + written
            at = ("recording", "percent")
            if name not in joints:
                help = did_you_mean(written, [self._without_prefix(joint) for joint in joints])
                message = f"`recording: {{percent: …}}` has `{written}`, which names no joint of the model"
                raise RecordingFault("unknown-name", message, help or "write the name of the model", at=at)
            if not self.model.jnt_limited[self.model.joint(name).id]:
                message = f"joint `{written}` has no range, so a percentage of it has no meaning"
                raise RecordingFault("recording-unit", message, "give the joint a `range`", at=at)

    def _check_units(self, signals: Collection[Signal]) -> None:
        """Refuse units that are the unit of no column."""
        for kind, dimension in self.keys["dimensions"].items():
            of_kind = [signal for signal in signals if signal.kind == kind]
            if of_kind and not any(self._dimension(signal) == dimension for signal in of_kind):
                message = f"the unit of `{kind}` is {with_article(dimension)}, and no column `{kind}` has one"
                help = "an angle is the unit of hinges, a length the unit of slides, and motors have neither"
                raise RecordingFault("recording-unit", message, help)

    def _dimension(self, signal: Signal) -> str | None:
        """Return the dimension of a signal, `angle` or `length`; None if it is neither, as the command of a motor."""
        name: str | None = signal.name
        if signal.kind == "sensor":
            return None
        if signal.kind == "ctrl":
            name = self._joint_of(signal.name) if self._is_servo(signal.name) else None
        if name is None:
            return None
        types = self.mujoco.mjtJoint
        dimensions = {int(types.mjJNT_HINGE): "angle", int(types.mjJNT_SLIDE): "length"}
        return dimensions.get(int(self.model.joint(name).type[0]))

    def _is_servo(self, actuator: str) -> bool:
        """Whether the command is a position or a speed."""
        index = self.model.actuator(actuator).id
        gain = self.model.actuator_gainprm[index, 0]
        _, stiffness, damping = self.model.actuator_biasprm[index, :3]
        return bool(stiffness or (damping and damping == -gain))

    def _factor(self, signal: Signal) -> float:
        """Return the factor that turns a column into MuJoCo's units."""
        dimension = self.keys["dimensions"].get(signal.kind)
        is_meant = dimension is None or dimension == self._dimension(signal)
        return float(self.keys["factors"][signal.kind]) if is_meant else 1.0

    def _in_mujoco_units(self, signal: Signal, values: Series) -> Series:
        sign = self._sign(signal)
        joint = self._percent_joint(signal)
        if joint is None:
            return values * self._factor(signal) * sign
        low, high = map(float, self.model.jnt_range[self.model.joint(joint).id])
        if signal.kind == "qvel":
            return values * sign * (high - low) / 100
        start = low if sign > 0 else high  # a joint that counts down is at its upper end at 0 percent
        return start + values * sign * (high - low) / 100

    def _percent_joint(self, signal: Signal) -> str | None:
        """Return the joint of a column in percent; None for a column with a unit."""
        name: str | None = signal.name
        if signal.kind == "ctrl":
            # Only the command of a position servo is a position.
            stiffness = self.model.actuator_biasprm[self.model.actuator(signal.name).id, 1]
            name = self._joint_of(signal.name) if stiffness else None
        is_percent = signal.kind != "sensor" and name is not None and self._without_prefix(name) in self.keys["percent"]
        return name if is_percent else None

    def _signal(self, column: str) -> Signal | None:
        """Return the signal of a column, or None for a column to ignore."""
        if self._leaves_out(column):
            return None
        kind, _, written = column.partition(" ")
        if kind not in _KINDS or not written:
            help = "`qpos arm/elbow` is a position, `ctrl arm/elbow` a command"
            words = ", ".join(f"`{word}`" for word in _KINDS)
            raise RecordingFault(_CODE, f"column `{column}` begins with none of {words}", help)
        name, component = _without_index(written)
        name = self.keys["prefix"] + self.keys["names"].get(name, name)
        if name in self.known[_KINDS[kind]]:
            return Signal(kind, name, component)
        if kind == "ctrl" and len(actuators := self._actuators_of(name)) == 1:
            return Signal(kind, actuators[0], component)
        near = closest(name, self.known[_KINDS[kind]])
        some = near[0] if near else "NAME"
        help = f"`recording: {{names: {{{name}: {some}}}}}` maps names, `ignore: [{name}]` leaves it out"
        if near:
            help = f"did you mean `{near[0]}`? {help}"
        message = f"`{column}` names no {_KINDS[kind]} of the model"
        raise RecordingFault(_CODE, message, help)

    def _actuators_of(self, joint: str) -> list[str]:
        """Return the actuators of a joint: controllers send commands to joints."""
        return [actuator for actuator in self.known["actuator"] if self._joint_of(actuator) == joint]

    def _sign(self, signal: Signal) -> int:
        """Return the sign of a column: its own, or else the sign of its name."""
        signs: dict[str, int] = self.keys["sign"]
        name = self._without_prefix(signal.name)
        return signs.get(f"{signal.kind} {name}", signs.get(name, 1))

    def _without_prefix(self, name: str) -> str:
        return name.removeprefix(self.keys["prefix"])

    def _says_sign(self, joint: str, actuator: str) -> bool:
        joint = self._without_prefix(joint)
        actuator = self._without_prefix(actuator)
        keys = (joint, actuator, f"qpos {joint}", f"ctrl {actuator}")
        return any(key in self.keys["sign"] for key in keys)

    def _ignores(self, name: str) -> bool:
        return any(fitter(glob, lambda: [name], "/")(name) for glob in self.keys["ignore"])

    def _check_unit(self, signal: Signal, column: str, values: Series, table: RecordedTable) -> None:
        """Refuse positions and commands far outside of the model's range: they are in another unit."""
        limit = self._limit(signal)
        if limit is None or self._factor(signal) != 1.0 or self._percent_joint(signal) is not None:
            return
        known = values[np.isfinite(values)]
        reach = float(np.abs(known).max(initial=0))
        if reach > 3 * limit + 0.5:
            message = f"`{column}` reaches {reach:.4g}, and the model allows {limit:.4g}"
            help = f"are these degrees? write `recording: {{units: {{{signal.kind}: deg}}}}`"
            raise RecordingFault("recording-unit", message, help, line=table.header)

    def _limit(self, signal: Signal) -> float | None:
        model = self.model
        if signal.kind == "qpos":
            joint = model.joint(signal.name)
            if joint.type[0] != self.mujoco.mjtJoint.mjJNT_HINGE:
                return None
            is_limited = model.jnt_limited[joint.id]
            return float(np.abs(model.jnt_range[joint.id]).max()) if is_limited else 4 * math.pi
        if signal.kind == "ctrl":
            actuator = model.actuator(signal.name).id
            is_limited = model.actuator_ctrllimited[actuator]
            return float(np.abs(model.actuator_ctrlrange[actuator]).max()) if is_limited else None
        return None

    def _check_contents(
        self, signals: Mapping[Signal, Series], commands: Mapping[str, Command], recorded: RecordedFile
    ) -> None:
        line = recorded.table.header
        if not signals:
            help = "record `qpos JOINT`, `qvel JOINT` or `sensor NAME`"
            raise RecordingFault(_CODE, "it has no column that the model could be compared with", help, line=line)
        missing = [name for name in self.known["actuator"] if name not in commands and self._drives(name, signals)]
        if missing and not self.keys["hold"]:
            more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
            help = recorded.advice or (
                "the simulation needs the commands of the robot: record `ctrl NAME`; `recording: {hold: true}` keeps"
                " the control of the keyframe"
            )
            raise RecordingFault(_CODE, f"it has no commands of actuator `{missing[0]}`{more}", help, line=line)
        empty = next((name for name, command in commands.items() if len(command.times) < 1), None)
        if empty is not None:
            raise RecordingFault("recording-value", f"`ctrl {empty}` has no number", "remove the column", line=line)

    def _drives(self, actuator: str, signals: Mapping[Signal, Series]) -> bool:
        joint = self._joint_of(actuator)
        return joint is not None and Signal("qpos", joint) in signals

    def _joint_of(self, actuator: str) -> str | None:
        model = self.model
        index = model.actuator(actuator).id
        if model.actuator_trntype[index] != self.mujoco.mjtTrn.mjTRN_JOINT:
            return None
        return str(model.joint(int(model.actuator_trnid[index, 0])).name)

    def _check_signs(self, recording: Recording, table: RecordedTable) -> None:
        """Refuse a joint that moves against its position servo, unless the recipe says its sign."""
        for actuator, command in recording.commands.items():
            joint = self._joint_of(actuator)
            if joint is None or self._says_sign(joint, actuator):
                continue
            moved = recording.signals.get(Signal("qpos", joint))
            is_servo = self.model.actuator_biasprm[self.model.actuator(actuator).id, 1] != 0
            if moved is None or not is_servo:
                continue
            told = np.interp(recording.times, command.times, command.values)
            if min(moved.std(), told.std()) > 1e-3 and (r := float(np.corrcoef(moved, told)[0, 1])) < _AGAINST:
                message = f"joint `{joint}` moves against its command (correlation {r:.2f})"
                help = f'write `recording: {{sign: {{"qpos {joint}": -1}}}}`, or `1` if the sign is right'
                raise RecordingFault("recording-sign", message, help, line=table.header)


def _without_index(written: str) -> tuple[str, int]:
    """Return a name and the index behind it.

    >>> _without_index("wrist[2]"), _without_index("elbow")
    (('wrist', 2), ('elbow', 0))
    """
    name, bracket, index = written.rpartition("[")
    if bracket and index.endswith("]") and index[:-1].isdigit():
        return name, int(index[:-1])
    return written, 0


def _check_finite(table: RecordedTable, times: Series, column: str, values: Series, *, may_lack: bool = False) -> None:
    """Refuse values that are no numbers; commands may lack some, and hold the last one."""
    bad = np.flatnonzero(np.isinf(values) if may_lack else ~np.isfinite(values))
    if bad.size:
        first = int(bad[0])
        rows = "1 row" if bad.size == 1 else f"{bad.size} rows"
        message = f"`{column}` has no number in {rows}, first at {times[first]:.3f} s"
        raise RecordingFault("recording-value", message, "remove these rows, or this column", line=table.line(first))


def _check_clock(table: RecordedTable, times: Series, has_unit: bool, is_steady: bool = True) -> None:
    if not np.isfinite(times).all():
        row = int(np.flatnonzero(~np.isfinite(times))[0])
        raise RecordingFault(_TIME, "a row has no time", "remove it", line=table.line(row))
    steps = np.diff(times)
    backward = np.flatnonzero(steps <= 0)
    if backward.size:
        row = int(backward[0]) + 1
        message = f"the time goes back or does not pass: {times[row]:.15g} s after {times[row - 1]:.15g} s"
        help = "sort the rows; if the clock was set during the recording, cut it into two"
        raise RecordingFault(_TIME, message, help, line=table.line(row))
    if not is_steady:
        return
    usual = float(np.median(steps))
    if usual > (_SLOWEST_WITH_UNIT if has_unit else _SLOWEST):
        help = "is the time in milliseconds? write `recording: {units: {time: ms}}`, or `time: s` if it is right"
        raise RecordingFault(_TIME, f"{usual:g} s pass between samples", help)
    gaps = np.flatnonzero(steps > max(20 * usual, 0.1))
    if gaps.size:
        row = int(gaps[0])
        message = f"nothing for {steps[row]:.2f} s from {times[row]:.3f} s on, {steps[row] / usual:.0f} usual steps"
        raise RecordingFault(_TIME, message, "cut the recording there into two", line=table.line(row + 1))


def all_signals(recordings: Sequence[Recording]) -> Iterator[Signal]:
    """Yield each signal of the recordings once."""
    yield from dict.fromkeys(signal for recording in recordings for signal in recording.signals)
