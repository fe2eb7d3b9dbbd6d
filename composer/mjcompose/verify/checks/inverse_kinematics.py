"""Find joint positions that bring a site to a point.

The method is damped least squares with joint limits, from several starts. `mujoco.minimize.least_squares` (3.12 to 4.0)
finds the same solutions for arms of hinges and slides in about the same time. Its bounds are boxes, and the range of a
ball joint is not a box: of 19 targets that two ball joints reach with one of them at its limit, it found 10.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.mujoco.addresses import span
from mjcompose.mujoco.arrays import BALL, FREE, HINGE, SLIDE

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjData, MjModel

STARTS = 32
_STEPS = 150
_FIRST_DAMPING = 1e-3
_LEAST_DAMPING = 1e-9
_MOST_DAMPING = 1e6
_LONGEST_STEP = 0.5
"""The greatest change of a joint in one step, in radians or meters; the linearization does not hold beyond it."""
_LOOSE = 1e-3
"""How far equality constraints, which are soft in MuJoCo, may be violated in a solution, in meters or radians."""
_CLOSED = 100.0
"""The weight of constraint violations relative to the distance of the site."""
_NEAR = 1e-6


class Solver:
    """Searches for positions of the joints between the world and the site. Deterministic.

    Free joints above the site stay where they are, or every point would be in reach. Equality constraints
    stay closed, and the joints that they move follow. `tolerance` is in meters.
    """

    def __init__(self, mujoco: Any, model: MjModel, data: MjData, site: int, target: Any, tolerance: float) -> None:
        self.mujoco = mujoco
        self.model = model
        self.data = data
        self.site = site
        self.target = target
        self.tolerance = tolerance
        self.chain = self._chain()
        # Other joints move only if a constraint couples them.
        moving = {dof for joint in self.chain for dof in span(model, "qvel", joint)}
        self.moving = np.array(sorted(moving | self._tied()), dtype=int)
        self.lower, self.upper = self._limits()
        self.start = data.qpos.copy()
        self.at_limits: list[int] = []
        self._slack = 0.0
        self._slack = max(_LOOSE, self._open(self._look()[0]))
        self.distance = float(np.linalg.norm(self._look()[0][:3]))

    def solve(self) -> float:
        """Return the smallest distance found, in meters, and leave the data at the positions found."""
        random = np.random.default_rng(0)
        best = np.inf
        best_qpos = self.start
        for number in range(STARTS):
            self.data.qpos[:] = self.start
            if number:
                self._scatter(random, number)
            distance = self._descend()
            if distance < best:
                best = distance
                best_qpos = self.data.qpos.copy()
            if best <= self.tolerance:
                break
        self.data.qpos[:] = best_qpos
        self.at_limits = [joint for joint in self.chain if self._is_at_limit(joint)]
        self.distance = float(best)
        return self.distance

    def _descend(self) -> float:
        """Descend from the positions in the data; return the distance, infinite if constraints stay violated."""
        damping = _FIRST_DAMPING
        error, jacobian = self._look()
        for _ in range(_STEPS):
            if np.linalg.norm(error[:3]) <= 0.5 * self.tolerance and self._open(error) <= self._slack:
                break
            before = self.data.qpos.copy()
            velocity = np.zeros(self.model.nv)
            velocity[self.moving] = self._step(error, jacobian, damping)
            self.mujoco.mj_integratePos(self.model, self.data.qpos, velocity, 1.0)
            self._clamp()
            new_error, new_jacobian = self._look()
            if new_error @ new_error < error @ error:
                gain = 1 - (new_error @ new_error) / (error @ error)
                error = new_error
                jacobian = new_jacobian
                damping = max(damping / 4, _LEAST_DAMPING)
                if gain < 1e-9:
                    break
            else:
                self.data.qpos[:] = before
                damping *= 8
                if damping > _MOST_DAMPING:
                    break
        error, _ = self._look()
        return float(np.linalg.norm(error[:3])) if self._open(error) <= self._slack else np.inf

    def _look(self) -> tuple[Any, Any]:
        """Return the residual, the site's three numbers first, and its Jacobian for the moving joints."""
        mujoco = self.mujoco
        model = self.model
        data = self.data
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        jacobian = np.zeros((3, model.nv))
        mujoco.mj_jacSite(model, data, jacobian, None, self.site)
        error = self.target - data.site_xpos[self.site]
        if model.neq:
            rows, residuals = self._equalities()
            jacobian = np.vstack([jacobian, _CLOSED * rows])
            error = np.concatenate([error, -_CLOSED * residuals])
        return error, jacobian[:, self.moving]

    def _equalities(self) -> tuple[Any, Any]:
        """Return the Jacobian rows of equality constraints, and how far they are violated."""
        mujoco = self.mujoco
        model = self.model
        data = self.data
        if model.nflex:
            mujoco.mj_flex(model, data)
        mujoco.mj_tendon(model, data)
        option = model.opt
        kept = int(option.jacobian), int(option.disableflags)
        option.jacobian = int(mujoco.mjtJacobian.mjJAC_DENSE)
        # The solver keeps limits itself and does not look at contacts.
        option.disableflags = int(mujoco.mjtDisableBit.mjDSBL_LIMIT) | int(mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS)
        data.ncon = 0
        try:
            mujoco.mj_makeM(model, data)
            mujoco.mj_factorM(model, data)
            mujoco.mj_makeConstraint(model, data)
        finally:
            option.jacobian, option.disableflags = kept
        count = int(data.ne)
        rows = np.array(data.efc_J, dtype=np.float64).reshape(-1, model.nv)[:count]
        return rows, np.array(data.efc_pos[:count], dtype=np.float64)

    @staticmethod
    def _open(error: Any) -> float:
        return float(np.abs(error[3:]).max(initial=0.0)) / _CLOSED

    def _step(self, error: Any, jacobian: Any, damping: float) -> Any:
        """Return the step of the moving joints. Joints that would leave their range stay; the others compensate."""
        able = np.ones(len(self.moving), dtype=bool)
        joints = self.model.dof_jntid[self.moving]
        single = np.isin(self.model.jnt_type[joints], (SLIDE, HINGE))
        here = np.where(single, self.data.qpos[self.model.jnt_qposadr[joints]], 0.0)
        for _ in range(len(self.moving) + 1):
            part = jacobian[:, able]
            square = part @ part.T
            square[np.diag_indices_from(square)] += damping
            step = np.zeros(len(self.moving))
            step[able] = part.T @ np.linalg.solve(square, error)
            longest = np.abs(step).max(initial=0.0)
            if longest > _LONGEST_STEP:
                step *= _LONGEST_STEP / longest
            stuck = able & (((here >= self.upper - _NEAR) & (step > 0)) | ((here <= self.lower + _NEAR) & (step < 0)))
            if not stuck.any():
                break
            able &= ~stuck
        return step

    def _clamp(self) -> None:
        model = self.model
        qpos = self.data.qpos
        for joint in set(model.dof_jntid[self.moving].tolist()):
            if not model.jnt_limited[joint]:
                continue
            at = int(model.jnt_qposadr[joint])
            low, high = model.jnt_range[joint]
            if model.jnt_type[joint] in (SLIDE, HINGE):
                qpos[at] = min(max(qpos[at], low), high)
            elif model.jnt_type[joint] == BALL:
                turn = np.zeros(3)
                self.mujoco.mju_quat2Vel(turn, qpos[at : at + 4], 1.0)
                angle = float(np.linalg.norm(turn))
                if angle > high:
                    turned = np.zeros(4)
                    self.mujoco.mju_axisAngle2Quat(turned, turn / angle, high)
                    qpos[at : at + 4] = turned

    def _scatter(self, random: Any, number: int) -> None:
        """Move to another start: first the middle of all ranges, then random positions within them."""
        model = self.model
        qpos = self.data.qpos
        for joint in self.chain:
            at = int(model.jnt_qposadr[joint])
            kind = int(model.jnt_type[joint])
            if kind == BALL:
                self.mujoco.mju_quatIntegrate(qpos[at : at + 4], random.uniform(-np.pi / 2, np.pi / 2, 3), 1.0)
                continue
            reach = np.pi if kind == HINGE else 1.0
            low = qpos[at] - reach
            high = qpos[at] + reach
            if model.jnt_limited[joint]:  # a bound may still be infinite
                ends = model.jnt_range[joint]
                low, high = np.where(np.isfinite(ends), ends, (low, high))
            drawn = random.uniform(low, high)
            qpos[at] = (low + high) / 2 if number == 1 else drawn
        self._clamp()

    def _chain(self) -> list[int]:
        """Return the joints between the world and the site, except free joints."""
        model = self.model
        found = []
        body = int(model.site_bodyid[self.site])
        while body:
            first = int(model.body_jntadr[body])
            joints = range(first, first + int(model.body_jntnum[body]))
            found += [joint for joint in joints if model.jnt_type[joint] != FREE]
            body = int(model.body_parentid[body])
        return found

    def _tied(self) -> set[int]:
        """Return the degrees of freedom in equality constraints, except those of free joints above the site."""
        if not self.model.neq:
            return set()
        self.mujoco.mj_kinematics(self.model, self.data)
        self.mujoco.mj_comPos(self.model, self.data)
        rows, _ = self._equalities()
        fixed = int(self.model.body_rootid[self.model.site_bodyid[self.site]])
        return {
            dof
            for dof in np.flatnonzero(np.abs(rows).max(axis=0, initial=0.0)).tolist()
            if not (self.model.jnt_type[self.model.dof_jntid[dof]] == FREE and self.model.dof_bodyid[dof] == fixed)
        }

    def _limits(self) -> tuple[Any, Any]:
        """Return the bounds of each moving degree of freedom; infinite for ball joints and joints without limits."""
        joints = self.model.dof_jntid[self.moving]
        bounded = (self.model.jnt_limited[joints] != 0) & np.isin(self.model.jnt_type[joints], (SLIDE, HINGE))
        ends = self.model.jnt_range[joints]
        return np.where(bounded, ends[:, 0], -np.inf), np.where(bounded, ends[:, 1], np.inf)

    def _is_at_limit(self, joint: int) -> bool:
        if not self.model.jnt_limited[joint] or self.model.jnt_type[joint] not in (SLIDE, HINGE):
            return False
        here = self.data.qpos[self.model.jnt_qposadr[joint]]
        low, high = self.model.jnt_range[joint]
        return bool(here <= low + _NEAR or here >= high - _NEAR)
