"""Recordings as a problem of least squares: pieces with their own start, predictions, residuals and derivatives.

A piece of a recording is simulated from its own start, whose positions and speeds are unknowns, too. Commands are
averaged over each step, so a delay has a derivative. Runs in MuJoCo's process.
"""

from __future__ import annotations

import itertools
import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.base.dataclass import Struct
from mjcompose.base.suggest import did_you_mean
from mjcompose.language.measured import DELAY
from mjcompose.mujoco.attributes import names
from mjcompose.tools.identify.recording import Recording, Signal
from mjcompose.tools.identify.tables import RecordingFault, Series
from mjcompose.tools.identify.unknowns import ModelPool, UnknownNumber

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjData, MjModel

_SLOTS = 32
"""The most models that are simulated at once: each is a copy of the whole model."""
_CLIP = 1e6
"""The largest residual, in standard deviations: a robot that falls over does not outweigh everything else."""
_STEP = 3e-4
"""The step of differences, relative to the range of an unknown; below it friction and contact are not smooth."""


class RecordingPiece(Struct):
    """A part of a recording: its rows, its state at the start, and the unknowns of this state.

    `free` has for each of them its index in the state and the standard deviation of its first guess.
    """

    recording: Recording
    begin: float
    rows: slice
    state: Series
    free: tuple[tuple[int, float], ...]
    steps: int

    @property
    def measured(self) -> Series:
        """The recorded numbers, `(samples, signals)`."""
        return np.array([values[self.rows] for values in self.recording.signals.values()]).T


class FitJob(Struct, eq=False):
    """One simulation: a piece from a state, with values of the unknowns."""

    values: Series
    piece: int
    state: Series


class FitSettings(Struct):
    """The keyframe of everything that is not recorded, the length of the pieces, and a sign of life."""

    start: str | None = None
    window: float | None = None
    progress: Callable[[str], None] = lambda _: None


class FitSimulator:
    """Simulates one model with many values of its unknowns: copies of the model, states and threads to reuse.

    `steps` is the number of simulated steps so far.
    """

    def __init__(self, mujoco: Any, model: MjModel, unknowns: Sequence[UnknownNumber]) -> None:
        from mujoco import rollout

        self.pool = ModelPool(mujoco, model, unknowns)
        self.steps = 0
        threads = max(1, min(8, len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1))
        self._datas: list[MjData] = [mujoco.MjData(model) for _ in range(threads)]
        self._rollout = rollout.Rollout(nthread=threads if threads > 1 else 0)

    def run(self, models: list[MjModel], states: Series, controls: Series) -> tuple[Series, Series]:
        """Return states and sensor readings, `(runs, steps, numbers)`, from `(runs, numbers)` and controls."""
        self.steps += controls.shape[0] * controls.shape[1]
        found: tuple[Series, Series] = self._rollout.rollout(models, self._datas, states, controls)
        return found


class Problem:
    """The residual of a fit and its derivatives, for a model and recordings.

    Problems with the same model and unknowns can share a `simulator`.
    """

    def __init__(
        self,
        mujoco: Any,
        model: MjModel,
        unknowns: Sequence[UnknownNumber],
        recordings: Sequence[Recording],
        settings: FitSettings,
        simulator: FitSimulator | None = None,
    ) -> None:
        self.mujoco = mujoco
        self.model = model
        self.unknowns = unknowns
        self.recordings = recordings
        self.settings = settings
        self.simulator = simulator or FitSimulator(mujoco, model, unknowns)
        self.low = np.array([unknown.low for unknown in unknowns])
        self.high = np.array([unknown.high for unknown in unknowns])
        self.nominal = np.array([unknown.nominal for unknown in unknowns])
        self.prior = np.array([unknown.prior for unknown in unknowns])
        self._start_controls = self.start_data().ctrl
        self.pieces = [piece for recording in recordings for piece in self._pieces(recording)]
        self.noise: dict[Signal, float] = {}
        for signal in dict.fromkeys(signal for recording in recordings for signal in recording.signals):
            runs = [each.signals[signal] for each in recordings if signal in each.signals]
            self.noise[signal] = noise_of(runs)
        self.free = np.array([std for piece in self.pieces for _, std in piece.free])
        self.offsets = np.cumsum([0, *(len(piece.free) for piece in self.pieces)])

    @property
    def count(self) -> int:
        return len(self.unknowns)

    # ------------------------------------------------------------------------------------------------------- pieces

    def start_data(self) -> MjData:
        """Return a state with the keyframe of the recipe, or else with the first one of the model."""
        data: MjData = self.mujoco.MjData(self.model)
        key = 0
        if self.settings.start is not None:
            key = self.mujoco.mj_name2id(self.model, self.mujoco.mjtObj.mjOBJ_KEY, self.settings.start)
            if key < 0:
                message = f"the model has no keyframe `{self.settings.start}`"
                keys = [name for name in names(self.model, "key") if name]
                help = did_you_mean(self.settings.start, keys) or "write the name of a keyframe of the model"
                raise RecordingFault("unknown-name", message, help, at=("start",))
        if self.model.nkey:
            self.mujoco.mj_resetDataKeyframe(self.model, data, key)
        return data

    def _pieces(self, recording: Recording) -> Iterator[RecordingPiece]:
        times = recording.times
        for begin, end in _intervals(recording.seconds, self.settings.window):
            first, last = (int(index) for index in np.searchsorted(times, (begin, end)))
            if last - first < 4:
                continue
            data = self.start_data()
            free = self._guess_start(recording, data, first)
            self._start_activations(recording, data, float(times[first]))
            full = self.mujoco.mjtState.mjSTATE_FULLPHYSICS
            state = np.empty(self.mujoco.mj_stateSize(self.model, full))
            self.mujoco.mj_getState(self.model, data, state, full)
            steps = math.ceil((times[last - 1] - times[first]) / self.model.opt.timestep) + 2
            yield RecordingPiece(recording, float(times[first]), slice(first, last), state, tuple(free), steps)

    def _guess_start(self, recording: Recording, data: MjData, first: int) -> list[tuple[int, float]]:
        """Write position and speed of each recorded joint, and return their places in the state with their errors."""
        free = []
        for signal, values in recording.signals.items():
            if signal.kind != "qpos":
                continue
            joint = self.model.joint(signal.name)
            place = int(joint.qposadr[0])
            dof = int(joint.dofadr[0])
            position, speed, position_std, speed_std = local_motion(recording.times, values, first)
            speeds = recording.signals.get(Signal("qvel", signal.name))
            data.qpos[place] = position
            data.qvel[dof] = speed if speeds is None else speeds[first]
            free += [(1 + place, position_std), (1 + self.model.nq + dof, speed_std)]
        data.time = 0
        return free

    def _start_activations(self, recording: Recording, data: MjData, at: float) -> None:
        """Filtered servos start at their command."""
        for actuator in range(self.model.nu):
            address = self.model.actuator_actadr[actuator]
            command = recording.commands.get(self.model.actuator(actuator).name)
            if address >= 0 and command is not None:
                data.act[address] = np.interp(at, command.times, command.values)

    def states(self, starts: Series) -> list[Series]:
        """Return the state at the start of each piece, changed by the unknowns of the starts."""
        found = []
        for index, piece in enumerate(self.pieces):
            state = piece.state.copy()
            changes = starts[self.offsets[index] : self.offsets[index + 1]]
            for (place, _), change in zip(piece.free, changes, strict=True):
                state[place] += change
            found.append(state)
        return found

    # --------------------------------------------------------------------------------------------------- simulation

    def controls(self, piece: RecordingPiece, values: Series) -> Series:
        """Return the mean of the held, delayed command over each step: continuous in the delay."""
        step = self.model.opt.timestep
        controls = np.tile(self._start_controls, (piece.steps, 1))
        delays = {
            name: float(value)
            for unknown, value in zip(self.unknowns, values, strict=True)
            if unknown.attribute == DELAY
            for name in unknown.names
        }
        edges = piece.begin + np.arange(piece.steps + 1) * step
        for name, command in piece.recording.commands.items():
            integral = np.concatenate(([0.0], np.cumsum(command.values[:-1] * np.diff(command.times))))
            at = edges - delays.get(name, 0.0)
            total = np.interp(at, command.times, integral)
            total += np.minimum(at - command.times[0], 0) * command.values[0]
            total += np.maximum(at - command.times[-1], 0) * command.values[-1]
            controls[:, self.model.actuator(name).id] = np.diff(total) / step
        return controls

    def simulate(self, jobs: Sequence[FitJob]) -> list[Series]:
        """Return the prediction of each job, `(samples, signals)`; jobs with the same number of steps go together."""
        predictions: list[Series] = [np.empty(0)] * len(jobs)
        by_steps: dict[int, list[int]] = {}
        for index, job in enumerate(jobs):
            by_steps.setdefault(self.pieces[job.piece].steps, []).append(index)
        for indices in by_steps.values():
            for batch in _batches(jobs, indices):
                self._simulate_together(jobs, batch, predictions)
        return predictions

    def _simulate_together(self, jobs: Sequence[FitJob], batch: Sequence[int], predictions: list[Series]) -> None:
        written: dict[int, MjModel] = {}
        controls: dict[tuple[int, int], Series] = {}
        has_delays = any(unknown.attribute == DELAY for unknown in self.unknowns)
        models = []
        for index in batch:
            job = jobs[index]
            values = id(job.values)
            if values not in written:
                written[values] = self.simulator.pool.write(job.values, len(written))
            models.append(written[values])
            key = (job.piece, values if has_delays else 0)
            if key not in controls:
                controls[key] = self.controls(self.pieces[job.piece], job.values)
        told = np.stack([controls[jobs[n].piece, id(jobs[n].values) if has_delays else 0] for n in batch])
        initial = np.stack([jobs[index].state for index in batch])
        states, readings = self.simulator.run(models, initial, told)
        for index, state, reading in zip(batch, states, readings, strict=True):
            job = jobs[index]
            predictions[index] = self._prediction(self.pieces[job.piece], job.state, state, reading)

    def _prediction(self, piece: RecordingPiece, initial: Series, states: Series, readings: Series) -> Series:
        at = piece.recording.times[piece.rows] - piece.begin
        grid = np.arange(len(states) + 1) * self.model.opt.timestep
        columns = []
        for signal in piece.recording.signals:
            if signal.kind == "sensor":  # MuJoCo 4.0 gives the readings of the state before each step
                column = int(self.model.sensor(signal.name).adr[0]) + signal.component
                series = np.append(readings[:, column], readings[-1, column])
            else:
                joint = self.model.joint(signal.name)
                places = {"qpos": 1 + int(joint.qposadr[0]), "qvel": 1 + self.model.nq + int(joint.dofadr[0])}
                column = places[signal.kind]
                series = np.concatenate(([initial[column]], states[:, column]))
            columns.append(np.interp(at, grid, series))
        return np.array(columns).T

    # ---------------------------------------------------------------------------------------------------- residuals

    def errors(self, values: Series, starts: Series) -> list[Series]:
        """Return prediction minus recording for each piece."""
        jobs = [FitJob(values, index, state) for index, state in enumerate(self.states(starts))]
        return [prediction - piece.measured for prediction, piece in zip(self.simulate(jobs), self.pieces, strict=True)]

    def residuals(self, points: Sequence[Series]) -> list[Series]:
        """Return the residual at each point: a point has the unknowns, then the unknowns of the starts."""
        jobs = []
        for point in points:
            values = point[: self.count].copy()
            jobs += [FitJob(values, index, state) for index, state in enumerate(self.states(point[self.count :]))]
        predictions = self.simulate(jobs)
        size = len(self.pieces)
        return [
            self._residual(point, predictions[index * size : (index + 1) * size]) for index, point in enumerate(points)
        ]

    def residual(self, point: Series) -> Series:
        return self.residuals([point])[0]

    def _residual(self, point: Series, predictions: Sequence[Series]) -> Series:
        parts = [
            self._weighed(index, prediction - self.pieces[index].measured)
            for index, prediction in enumerate(predictions)
        ]
        parts.append((point[: self.count] - self.nominal) / self.prior)
        parts.append(point[self.count :] / self.free)
        whole = np.concatenate(parts)
        return np.where(np.isfinite(whole), np.clip(whole, -_CLIP, _CLIP), _CLIP)

    def _weighed(self, piece: int, difference: Series) -> Series:
        noise = [self.noise[signal] for signal in self.pieces[piece].recording.signals]
        return np.asarray(difference / noise, float).reshape(-1)

    def jacobian(self, point: Series, *, is_central: bool = False) -> Series:
        """Return the derivatives of the residual. The starts of all pieces are moved at the same time."""
        values = point[: self.count].copy()
        states = self.states(point[self.count :])
        sides = (1, -1) if is_central else (1,)
        jobs = [FitJob(values, index, state) for index, state in enumerate(states)]
        moved = self._moved_values(values, sides)
        for changed, _ in moved:
            jobs += [FitJob(changed, index, state) for index, state in enumerate(states)]
        starts = list(self._moved_starts(values, states, sides))
        jobs += [job for _, _, _, job in starts]
        predictions = self.simulate(jobs)
        return self._assembled(predictions, moved, starts, len(sides))

    def _moved_values(self, values: Series, sides: Sequence[int]) -> list[tuple[Series, float]]:
        """Return the unknowns with one of them moved, and by how much, for each unknown and each side."""
        moved = []
        for index in range(self.count):
            for side in sides:
                step = side * _STEP * (self.high[index] - self.low[index])
                if not self.low[index] <= values[index] + step <= self.high[index]:
                    step = 0.0 if len(sides) > 1 else -step
                changed = values.copy()
                changed[index] += step
                moved.append((changed, step))
        return moved

    def _moved_starts(
        self, values: Series, states: Sequence[Series], sides: Sequence[int]
    ) -> Iterator[tuple[int, int, float, FitJob]]:
        for index, piece in enumerate(self.pieces):
            for column, (place, std) in enumerate(piece.free):
                for side in sides:
                    step = side * 0.03 * std
                    state = states[index].copy()
                    state[place] += step
                    yield index, column, step, FitJob(values, index, state)

    def _assembled(
        self,
        predictions: Sequence[Series],
        moved: Sequence[tuple[Series, float]],
        starts: Sequence[tuple[int, int, float, FitJob]],
        sides: int,
    ) -> Series:
        size = len(self.pieces)
        rows = np.cumsum([0, *(piece.measured.size for piece in self.pieces)])
        free = int(self.offsets[-1])
        whole = np.zeros((rows[-1] + self.count + free, self.count + free))
        for index in range(self.count):
            ends = moved[index * sides : (index + 1) * sides]
            first = size * (1 + index * sides)
            for piece in range(size):
                after = predictions[first + piece]
                before = predictions[first + size + piece] if sides > 1 else predictions[piece]
                width = ends[0][1] - (ends[1][1] if sides > 1 else 0.0)
                part = slice(rows[piece], rows[piece + 1])
                whole[part, index] = self._weighed(piece, (after - before) / width)
        first = size * (1 + self.count * sides)
        for number in range(0, len(starts), sides):
            piece, column, step, _ = starts[number]
            after = predictions[first + number]
            before = predictions[first + number + 1] if sides > 1 else predictions[piece]
            width = step - (starts[number + 1][2] if sides > 1 else 0.0)
            part = slice(rows[piece], rows[piece + 1])
            whole[part, self.count + self.offsets[piece] + column] = self._weighed(piece, (after - before) / width)
        diagonal = np.concatenate((1 / self.prior, 1 / self.free))
        whole[rows[-1] + np.arange(len(diagonal)), np.arange(len(diagonal))] = diagonal
        return np.nan_to_num(whole, nan=0.0, posinf=_CLIP, neginf=-_CLIP)

    # ------------------------------------------------------------------------------------------------------- errors

    def by_signal(self, errors: Sequence[Series]) -> dict[Signal, list[Series]]:
        """Return the errors of each signal, piece by piece."""
        found: dict[Signal, list[Series]] = {}
        for piece, error in zip(self.pieces, errors, strict=True):
            for column, signal in enumerate(piece.recording.signals):
                found.setdefault(signal, []).append(error[:, column])
        return found

    def root_mean_squares(self, errors: Sequence[Series]) -> dict[Signal, float]:
        by_signal = self.by_signal(errors)
        return {signal: float(np.sqrt(np.mean(np.concatenate(parts) ** 2))) for signal, parts in by_signal.items()}


def _batches(jobs: Sequence[FitJob], indices: Sequence[int]) -> Iterator[list[int]]:
    """Yield jobs in batches with few different models."""
    batch: list[int] = []
    models: set[int] = set()
    for index in indices:
        if len(models) >= _SLOTS and id(jobs[index].values) not in models:
            yield batch
            batch = []
            models = set()
        models.add(id(jobs[index].values))
        batch.append(index)
    if batch:
        yield batch


def _intervals(seconds: float, window: float | None) -> list[tuple[float, float]]:
    """Return the pieces of a recording; the last one takes a rest of less than half a piece."""
    edges = [0.0]
    while window and edges[-1] + 1.5 * window < seconds:
        edges.append(edges[-1] + window)
    edges.append(seconds + 1e-9)
    return list(itertools.pairwise(edges))


def noise_of(runs: Sequence[Series]) -> float:
    """Return the noise of a signal from its third differences; at least the noise of its resolution."""
    found = []
    for values in runs:
        third = np.diff(values, 3)
        noise = 1.4826 * float(np.median(np.abs(third))) / math.sqrt(20) if third.size else 0.0
        steps = np.abs(np.diff(values))
        if (steps > 0).any():
            noise = max(noise, float(steps[steps > 0].min()) / math.sqrt(12))
        found.append(noise)
    return max(float(np.median(found)), 1e-7)


def local_motion(times: Series, values: Series, first: int, span: float = 0.06) -> tuple[float, float, float, float]:
    """Return position and speed at a row from a cubic through its neighbors, and ten times their errors.

    The errors are wide because the piece itself says best where it starts.
    """
    half = max(4, int(span / float(np.median(np.diff(times)))))
    rows = slice(max(0, first - half), min(len(times), first + half + 1))
    at = times[rows] - times[first]
    scale = float(np.abs(at).max())
    design = np.vander(at / scale, 4, increasing=True)
    solution = np.linalg.lstsq(design, values[rows], rcond=None)[0]
    left = values[rows] - design @ solution
    noise = math.sqrt(float(left @ left) / max(1, len(at) - 4)) + 1e-9
    covariance = np.linalg.pinv(design.T @ design) * noise**2
    position_std = 10 * math.sqrt(covariance[0, 0]) + 1e-7
    speed_std = 10 * math.sqrt(covariance[1, 1]) / scale + 1e-6
    return float(solution[0]), float(solution[1]) / scale, position_std, speed_std


Errors = Mapping[Signal, float]
