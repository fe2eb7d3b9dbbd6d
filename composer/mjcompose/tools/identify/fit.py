"""The fit: trials, then Gauss-Newton in short pieces, in whole recordings, and with the noise that they leave.

Stick and slip give the errors many minima and jumps, which no derivative sees. So a fit begins with trials, and joints
whose errors are not white are tried again from other places. Runs in MuJoCo's process.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from mjcompose.base.dataclass import Struct
from mjcompose.tools.identify.problem import FitJob, Problem
from mjcompose.tools.identify.recording import Signal
from mjcompose.tools.identify.tables import Series

_SHORT = 0.5
"""Seconds of the pieces of the first round: over a long time, friction gives the errors many minima."""
_SHORTEST = 0.2
_GROWTH = 20.0
"""How many times an error of the start may grow within a piece."""
_TRIALS = 24
_WHITE = 2.0
"""Over how many samples errors may be correlated before a joint is tried from other places."""


class Solution(Struct, frozen=False):
    """The unknowns, the unknowns of the starts, and the number of steps of Gauss-Newton."""

    values: Series
    starts: Series
    steps: int = 0

    @property
    def point(self) -> Series:
        return np.concatenate((self.values, self.starts))


def choose_window(problem: Problem) -> float | None:
    """Return the length of pieces within which an error of the start stays small; None for whole recordings."""
    window = problem.settings.window
    if window is not None:
        return window
    longest = max(recording.seconds for recording in problem.recordings)
    while (window is None or window > _SHORTEST) and _growth(problem) > _GROWTH:
        window = (window or longest) / 2
        problem = with_window(problem, window)
    return window


def with_window(problem: Problem, window: float | None) -> Problem:
    """Return the same problem in pieces of another length."""
    from dataclasses import replace

    settings = replace(problem.settings, window=window)
    simulator = problem.simulator
    again = Problem(problem.mujoco, problem.model, problem.unknowns, problem.recordings, settings, simulator)
    again.noise = problem.noise
    return again


def _growth(problem: Problem) -> float:
    """Return how many times an error of a start grows at most: 1 for a servo, many times if it tips over."""
    step = 1e-5
    states = problem.states(np.zeros(len(problem.free)))
    values = problem.nominal
    jobs = [FitJob(values, index, state) for index, state in enumerate(states)]
    for index, piece in enumerate(problem.pieces):
        for place, _ in piece.free[::2]:
            state = states[index].copy()
            state[place] += step
            jobs.append(FitJob(values, index, state))
    predictions = problem.simulate(jobs)
    most = 0.0
    for job, prediction in zip(jobs[len(states) :], predictions[len(states) :], strict=True):
        signals = problem.pieces[job.piece].recording.signals
        positions = [column for column, signal in enumerate(signals) if signal.kind == "qpos"]
        change = np.abs(prediction - predictions[job.piece])[:, positions]
        most = max(most, float(np.nan_to_num(change, nan=1e9).max(initial=0)) / step)
    return most


def fit_starts(problem: Problem, values: Series, rounds: int = 3) -> Series:
    """Return the starts of the pieces that fit best, with these values of the unknowns."""
    starts = np.zeros(len(problem.free))
    residual = problem.residual(np.concatenate((values, starts)))
    for _ in range(rounds):
        jacobian = problem.jacobian(np.concatenate((values, starts)))
        step = np.linalg.lstsq(jacobian[:, problem.count :], residual, rcond=None)[0]
        # Where contact or a fall makes it steep, a whole step can be far too long.
        shares = (1.0, 0.3, 0.1, 0.03)
        tried = problem.residuals([np.concatenate((values, starts - share * step)) for share in shares])
        costs = [float(each @ each) for each in tried]
        best = int(np.argmin(costs))
        if costs[best] >= float(residual @ residual):
            break
        starts = starts - shares[best] * step
        residual = tried[best]
    return starts


def solve(problem: Problem, solution: Solution, most: int, words: str) -> Solution:
    """Return the solution of Gauss-Newton within the ranges, from another one."""
    from mujoco import minimize

    scale = np.concatenate((problem.prior, problem.free))
    starts = np.clip(solution.starts, -30 * problem.free, 30 * problem.free)
    begin = np.concatenate((solution.values, starts))
    bounds = [
        np.concatenate((problem.low, -30 * problem.free)) / scale,
        np.concatenate((problem.high, 30 * problem.free)) / scale,
    ]

    def residual(points: Series) -> Series:
        columns = np.asarray(points, float).reshape(len(scale), -1).T
        return np.array(problem.residuals([column * scale for column in columns])).T

    def jacobian(point: Series, _: Series) -> Series:
        scaled: Series = problem.jacobian(np.asarray(point, float).reshape(-1) * scale) * scale
        return scaled

    point, log = minimize.least_squares(
        np.clip(begin / scale, bounds[0], bounds[1]),
        residual,
        bounds,
        jacobian=jacobian,
        max_iter=most,
        xtol=1e-5,
        gtol=1e-6,
        verbose=0,
        iter_callback=lambda trace: problem.settings.progress(
            f"{words}, step {len(trace)}: {2 * float(trace[-1].objective):.5g}"
        ),
    )
    found = np.asarray(point, float).reshape(-1) * scale
    values = np.clip(found[: problem.count], problem.low, problem.high)
    return Solution(values, found[problem.count :], solution.steps + len(log))


def fit(problem: Problem, begin: Series | None = None) -> tuple[Problem, Solution]:
    """Return the problem of the last round with its noise, and its solution. `begin` replaces the first trials."""
    window = problem.settings.window
    low = problem.low + 0.02 * (problem.high - problem.low)  # in a corner every derivative may lead outside
    high = problem.high - 0.02 * (problem.high - problem.low)
    short = _SHORT if window is None or window > 1.5 * _SHORT else window
    first = with_window(problem, short)
    if begin is None:
        values = screen(first, np.clip(problem.nominal, low, high), np.zeros(len(first.free)), spread=1.2, rounds=3)
    else:
        values = begin
    solution = _improve(first, Solution(values, fit_starts(first, values, 2)), 30, "round 1 of 3")
    first.noise = first.root_mean_squares(first.errors(solution.values, solution.starts))
    whole = with_window(first, window)
    if short != window:
        solution = Solution(solution.values, fit_starts(whole, solution.values, 2), solution.steps)
        solution = _improve(whole, solution, 15, "round 2 of 3")
        whole.noise = whole.root_mean_squares(whole.errors(solution.values, solution.starts))
    solution = solve(whole, solution, 8, "round 3 of 3")
    whole.noise = _noise_left(whole, solution)
    return whole, solution


def polish(problem: Problem, solution: Solution) -> Solution:
    """Return the solution next to another one, with the noise that it leaves. Short pieces would lead away from it."""
    solution = solve(problem, solution, 15, "from a better place")
    problem.noise = _noise_left(problem, solution)
    return solution


def _noise_left(problem: Problem, solution: Solution) -> dict[Signal, float]:
    left = problem.root_mean_squares(problem.errors(solution.values, solution.starts))
    return {signal: max(error, 1e-9) for signal, error in left.items()}


def _improve(problem: Problem, solution: Solution, most: int, words: str) -> Solution:
    """Solve, and try joints whose errors are not white from other places around, until nothing changes."""
    for again in range(4):
        solution = solve(problem, solution, most, words)
        errors = problem.errors(solution.values, solution.starts)
        correlated = correlation_times(problem, errors)
        flagged = {signal.name for signal, time in correlated.items() if time > _WHITE}
        if not flagged:
            break
        tried = screen(problem, solution.values, solution.starts, spread=0.7, rounds=4, only=flagged, seed=again + 1)
        if (tried == solution.values).all():
            break
        solution = Solution(tried, solution.starts, solution.steps)
    return solution


def screen(
    problem: Problem,
    values: Series,
    starts: Series,
    *,
    spread: float,
    rounds: int,
    only: set[str] | None = None,
    seed: int = 0,
) -> Series:
    """Return better unknowns by trials. Each joint keeps its numbers from the trial with the least errors of the joint.

    One trial changes all joints at once, so all trials cost less than one Jacobian. Numbers from 0 on are tried by
    factors, others by amounts.
    """
    random = np.random.default_rng(seed)
    joints = sorted({signal.name for recording in problem.recordings for signal in recording.signals})
    owners = np.array([_owner(problem, index, joints) for index in range(problem.count)])
    is_tried = np.ones(problem.count, bool)
    if only is not None:
        is_tried = np.isin(owners, [joints.index(name) for name in only])
    is_scaled = np.array([unknown.is_scaled for unknown in problem.unknowns])
    floor = np.where(problem.low == 0, 1e-3 * problem.high, problem.low)
    least = np.where(is_scaled, floor, problem.low)
    for _ in range(rounds):
        noise = random.normal(size=(_TRIALS, problem.count))
        by_factors = np.clip(values, floor, problem.high) * np.exp(spread * noise)
        by_amounts = values + spread * 0.15 * (problem.high - problem.low) * noise
        trials = np.clip(np.where(is_scaled, by_factors, by_amounts), least, problem.high)
        trials[0] = values
        trials = np.where(is_tried, trials, values)
        costs = _costs_by_joint(problem, trials, starts, joints)
        best = costs.argmin(axis=0)
        values = np.array([trials[best[owner], index] for index, owner in enumerate(owners)])
        spread *= 0.5
    return values


def _owner(problem: Problem, index: int, joints: Sequence[str]) -> int:
    """Return the joint whose signals decide about an unknown, or -1 for all signals."""
    unknown = problem.unknowns[index]
    name = unknown.names[0]
    model = problem.model
    if unknown.kind == "actuator":
        actuator = model.actuator(name).id
        if model.actuator_trntype[actuator] != problem.mujoco.mjtTrn.mjTRN_JOINT:
            return -1
        name = model.joint(int(model.actuator_trnid[actuator, 0])).name
    elif unknown.kind != "joint":
        return -1
    return joints.index(name) if name in joints and len(unknown.names) == 1 else -1


def _costs_by_joint(problem: Problem, trials: Series, starts: Series, joints: Sequence[str]) -> Series:
    """Return the cost of each trial by joint; the last column is the whole cost."""
    states = problem.states(starts)
    values = list(trials)
    jobs = [FitJob(each, index, state) for each in values for index, state in enumerate(states)]
    costs = np.zeros((len(trials), len(joints) + 1))
    for number, prediction in enumerate(problem.simulate(jobs)):
        trial, index = divmod(number, len(states))
        piece = problem.pieces[index]
        noise = [problem.noise[signal] for signal in piece.recording.signals]
        errors = np.nan_to_num(np.minimum(np.abs(prediction - piece.measured) / noise, 1e4), nan=1e4)
        for column, signal in enumerate(piece.recording.signals):
            cost = float((errors[:, column] ** 2).sum())
            costs[trial, joints.index(signal.name)] += cost
            costs[trial, -1] += cost
    return costs


def correlation_times(problem: Problem, errors: Sequence[Series]) -> dict[Signal, float]:
    """Return over how many samples the errors of each signal are correlated; 1 for noise."""
    by_signal: Mapping[Signal, list[Series]] = problem.by_signal(errors)
    return {signal: float(np.mean([correlation_time(part) for part in parts])) for signal, parts in by_signal.items()}


def correlation_time(errors: Series) -> float:
    """Return 1 + 2 times the sum of autocorrelations up to the first negative pair (Geyer 1992).

    >>> round(correlation_time(np.tile([1.0, -1.0], 50)), 1)
    1.0
    """
    centered = errors - errors.mean()
    count = len(centered)
    if count < 8 or not centered.any():
        return 1.0
    spectrum = np.fft.rfft(centered, 2 * count)
    correlation = np.fft.irfft(spectrum * spectrum.conj())[:count]
    correlation = correlation / correlation[0]
    time = 1.0
    for lag in range(1, count - 1, 2):
        pair = float(correlation[lag] + correlation[lag + 1])
        if pair <= 0:
            break
        time += 2 * pair
    return max(1.0, min(time, count / 4))
