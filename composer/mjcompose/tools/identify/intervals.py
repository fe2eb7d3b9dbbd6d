"""How well a fit knows its numbers: covariance, profiles of the cost, and a verdict for each number.

Dry friction makes cliffs in the cost. Near a cliff, the curvature at the minimum says nothing about the width of the
valley, so each number is also moved by one, two and four standard deviations, where the others follow. Runs in MuJoCo's
process.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from mjcompose.base.dataclass import Struct
from mjcompose.language.measured import DELAY
from mjcompose.tools.identify.fit import Solution, correlation_times, fit, polish, solve
from mjcompose.tools.identify.problem import Problem
from mjcompose.tools.identify.recording import Signal
from mjcompose.tools.identify.tables import Series

LITTLE = 0.75
"""Below this information, half of the standard deviation of the range is left: the number is not identified."""
_PARTNER = 0.8
_DISTANCES = (1.0, 2.0, 4.0)
"""The distances of the profile, in standard deviations."""
_FLAT = 0.125
"""A rise of the cost below this share of a parabola's is flat."""
_STEEP = 2.5
"""A rise of more than this many times a parabola's, on one side or on both, is a cliff."""
_REFITS = (-12.0, -6.0, 6.0, 12.0)
"""The distances from which a number at a cliff is fitted again, in standard deviations."""
_MOST_MOVES = 4
"""How often a fit goes on from a better place near its minimum."""
_AS_GOOD = 4.0
"""A difference of the cost that noise explains: two standard deviations of one number."""


class Knowledge(Struct, frozen=False):
    """The covariance of the unknowns, and over how many samples the errors of each signal are correlated.

    `rises` is the rise of the cost relative to a parabola, `(unknowns, 2, distances)`: below and above. `jumps`
    has the factor by which the interval of a number near a cliff was widened.
    """

    covariance: Series
    times: Mapping[Signal, float]
    rises: Series
    jumps: dict[int, float]

    @property
    def std(self) -> Series:
        return np.sqrt(np.diag(self.covariance))


class Verdict(Struct):
    """The verdict on a number: `word` is a key of the file of measurements, or empty for a measured number."""

    word: str = ""
    reason: str = ""


class _Weights(Struct, eq=False):
    """The weight of each residual: signals whose errors are correlated know less than they have samples."""

    weights: Series

    @classmethod
    def of(cls, problem: Problem, times: Mapping[Signal, float]) -> _Weights:
        parts = []
        for piece in problem.pieces:
            one = np.array([1 / times[signal] for signal in piece.recording.signals])
            parts.append(np.tile(one, piece.rows.stop - piece.rows.start))
        parts.append(np.ones(problem.count + len(problem.free)))
        return cls(np.concatenate(parts))

    def cost(self, residual: Series) -> float:
        return float(self.weights @ residual**2)

    def covariance(self, jacobian: Series) -> Series:
        hessian = jacobian.T @ (jacobian * self.weights[:, None])
        scale = 1 / np.sqrt(np.diag(hessian))
        scaled = np.linalg.pinv(hessian * scale[:, None] * scale, hermitian=True)
        covariance: Series = scale[:, None] * scaled * scale
        return covariance


def fit_and_know(problem: Problem) -> tuple[Problem, Solution, Knowledge]:
    """Return the problem with its noise, the best fit near the first one, and the knowledge of it."""
    found, solution = fit(problem)
    for again in range(_MOST_MOVES + 1):
        knowledge, better = know(found, solution, may_move=again < _MOST_MOVES)
        if better is None:
            break
        solution = polish(found, better)
    return found, solution, knowledge


def know(problem: Problem, solution: Solution, *, may_move: bool) -> tuple[Knowledge, Solution | None]:
    """Return the knowledge of a fit, or a better place from which it can begin again, if it `may_move`."""
    problem.settings.progress("how far each number may be off")
    times = correlation_times(problem, problem.errors(solution.values, solution.starts))
    weights = _Weights.of(problem, times)
    whole = weights.covariance(problem.jacobian(solution.point, is_central=True))
    cost = weights.cost(problem.residual(solution.point))
    rises, better = _profile(problem, solution, whole, weights, cost=cost)
    covariance = whole[: problem.count, : problem.count].copy()
    _round_delays(problem, covariance)
    knowledge = Knowledge(covariance, times, rises, {})
    if better is not None and may_move:
        return knowledge, better
    better = _look_behind_cliffs(problem, solution, knowledge, whole, weights, cost=cost)
    return knowledge, better if may_move else None


def _round_delays(problem: Problem, covariance: Series) -> None:
    """Add to the variance of delays: a command acts at whole steps of the simulation, however exact the fit is."""
    step = float(problem.model.opt.timestep)
    for index, unknown in enumerate(problem.unknowns):
        if unknown.attribute == DELAY:
            covariance[index, index] += step**2 / 12


def _profile(
    problem: Problem, solution: Solution, whole: Series, weights: _Weights, *, cost: float
) -> tuple[Series, Solution | None]:
    """Return the rises of the cost along the column of each number, and the best place if one is better."""
    count = problem.count
    points = []
    reached = []
    for index in range(count):
        std = math.sqrt(whole[index, index])
        for side in (-1, 1):
            for distance in _DISTANCES:
                point = solution.point + side * distance * whole[:, index] / std
                point[:count] = np.clip(point[:count], problem.low, problem.high)
                points.append(point)
                reached.append(abs(point[index] - solution.values[index]) / std)
    rises = np.ones(len(points))
    best = -1
    least = cost - 1.0
    for number, residual in enumerate(problem.residuals(points)):
        rise = weights.cost(residual) - cost
        if reached[number] > 0.1:  # a bound may be nearer
            rises[number] = rise / reached[number] ** 2
        if cost + rise < least:
            best = number
            least = cost + rise
    better = None
    if best >= 0:
        better = Solution(points[best][:count], points[best][count:], solution.steps)
    return rises.reshape(count, 2, len(_DISTANCES)), better


def _look_behind_cliffs(
    problem: Problem, solution: Solution, knowledge: Knowledge, whole: Series, weights: _Weights, *, cost: float
) -> Solution | None:
    """Widen the intervals of numbers at a cliff until they cover other places that explain the recordings as well.

    Return the best of these places if it is better.
    """
    count = problem.count
    least = cost - _AS_GOOD / 2
    better = None
    factors = np.ones(count)
    for index in range(count):
        rises = knowledge.rises[index, :, 1:]
        lowest = float(rises.min())
        if lowest < 1:  # flatter than a parabola: the interval ends where the cost has risen enough
            factors[index] = 1 / math.sqrt(max(lowest, 1 / 16))
        if rises.max() < _STEEP:
            continue
        std = math.sqrt(whole[index, index])
        problem.settings.progress(f"the errors jump around {problem.unknowns[index].word}")
        for distance in _REFITS:
            begin = solution.point + distance * whole[:, index] / std
            values = np.clip(begin[:count], problem.low, problem.high)
            tried = solve(problem, Solution(values, begin[count:]), 4, "behind a cliff")
            reached = weights.cost(problem.residual(tried.point))
            moved = abs(tried.values[index] - solution.values[index]) / std
            if reached < cost + _AS_GOOD:
                factors[index] = max(factors[index], moved)
            if reached < least:
                least = reached
                better = Solution(tried.values, tried.starts, solution.steps)
        factors[index] = max(factors[index], 2.0)
        knowledge.jumps[index] = float(factors[index])
    knowledge.covariance = knowledge.covariance * factors[:, None] * factors
    return better


def verdicts(problem: Problem, solution: Solution, knowledge: Knowledge) -> list[Verdict]:
    """Return for each number whether it is measured, or the reason against it."""
    std = knowledge.std
    information = 1 - (std / problem.prior) ** 2
    correlation = knowledge.covariance / np.outer(std, std)
    return [
        _verdict(problem, solution, knowledge, index, float(information[index]), correlation[index])
        for index in range(problem.count)
    ]


def _verdict(
    problem: Problem, solution: Solution, knowledge: Knowledge, index: int, information: float, correlation: Series
) -> Verdict:
    unknown = problem.unknowns[index]
    if information < LITTLE:
        others = np.abs(correlation)
        others[index] = 0
        partner = int(others.argmax())
        if others[partner] > _PARTNER:
            word = problem.unknowns[partner].word
            return Verdict("not_identified", f"only together with {word} (correlation {correlation[partner]:+.3f})")
        return Verdict("not_identified", "the recordings do not depend on it enough")
    lowest = knowledge.rises[index, :, 1].min(initial=1.0)
    if lowest < _FLAT:
        side = "below" if knowledge.rises[index, 0, 1] == lowest else "above"
        return Verdict("one_sided", f"numbers {side} it explain the recordings as well")
    value = float(solution.values[index])
    width = unknown.high - unknown.low
    at_zero = unknown.low == 0 and value < 1e-3 * unknown.high
    if min(value - unknown.low, unknown.high - value) < 1e-3 * width and value != unknown.nominal and not at_zero:
        return Verdict("at_its_bound", f"the range [{unknown.low:g}, {unknown.high:g}] may be too narrow")
    if index in knowledge.jumps:
        factor = knowledge.jumps[index]
        return Verdict("beside_a_jump", f"the errors jump around it, so its interval is {factor:.1f} times as wide")
    return Verdict()


def not_white(times: Mapping[Signal, float], most: float = 3.0) -> Sequence[Signal]:
    """Return the signals whose errors are correlated: the model lacks something that the robot has."""
    return [signal for signal, time in times.items() if time > most]
