"""Servos of a compiled model as linear springs and dampers, the steps that they need, and their forces.

Does not import MuJoCo: functions take the module.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from itertools import accumulate
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.base.dataclass import Struct
from mjcompose.mujoco.controls import AFFINE, FIXED, NO_BIAS, is_by_plugin, sparse_arms
from mjcompose.mujoco.references import ON_JOINTS

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

_GROWS = 1e-3
_LEAST = 1e-6


class Mode(Struct):
    """A motion that should not grow but grows from step to step: its largest degree of freedom, the factor of each
    step, and the longest time step (s) with which it would not grow, or None.
    """

    dof: int
    factor: float
    timestep: float | None


class Servos:
    """The springs and dampers that act on each degree of freedom, linear around the state of `data`."""

    def __init__(self, mujoco: Any, model: MjModel, data: Any) -> None:
        self.mujoco = mujoco
        self.model = model
        self.data = data

    @cached_property
    def arms(self) -> list[dict[int, float]]:
        """The moment arms of each actuator by degree of freedom."""
        return sparse_arms(self.model, self.data)

    @cached_property
    def _actuators(self) -> dict[int, list[int]]:
        """The actuators that act on each degree of freedom."""
        found: dict[int, list[int]] = {}
        for actuator, arms in enumerate(self.arms):
            for dof in arms:
                found.setdefault(dof, []).append(actuator)
        return found

    def gains(self, actuator: int) -> tuple[float, float]:
        """Return the stiffness and the damping of an actuator along its length; zeros if they are not constant."""
        model = self.model
        if is_by_plugin(model, actuator) or int(model.actuator_biastype[actuator]) != AFFINE:
            return 0.0, 0.0
        return -float(model.actuator_biasprm[actuator, 1]), -float(model.actuator_biasprm[actuator, 2])

    def stiffness(self, dofs: slice) -> np.ndarray:
        """Return the stiffness of the actuators and joints at some degrees of freedom, a square matrix."""
        found = self._by_actuators(0, dofs)
        for at, dof in enumerate(range(dofs.start, dofs.stop)):
            joint = int(self.model.dof_jntid[dof])
            if int(self.model.jnt_type[joint]) >= int(self.mujoco.mjtJoint.mjJNT_SLIDE):
                found[at, at] += float(np.ravel(self.model.jnt_stiffness[joint])[0])
        return found

    def damping(self, dofs: slice) -> np.ndarray:
        """Return the damping of the actuators at some degrees of freedom, a square matrix."""
        return self._by_actuators(1, dofs)

    def _by_actuators(self, gain: int, dofs: slice) -> np.ndarray:
        count = dofs.stop - dofs.start
        found = np.zeros((count, count))
        for actuator in sorted({each for dof in range(dofs.start, dofs.stop) for each in self.of_dof(dof)}):
            arms = np.zeros(count)
            for dof, arm in self.arms[actuator].items():
                if dofs.start <= dof < dofs.stop:
                    arms[dof - dofs.start] = arm
            found += self.gains(actuator)[gain] * np.outer(arms, arms)
        return found

    def inertia(self, dofs: slice) -> np.ndarray:
        """Return the joint-space inertia of some degrees of freedom, a square matrix."""
        found = np.zeros((dofs.stop - dofs.start, self.model.nv))
        for dof, row in zip(range(dofs.start, dofs.stop), found, strict=True):
            unit = np.zeros(self.model.nv)
            unit[dof] = 1
            self.mujoco.mj_mulM(self.model, self.data, row, unit)
        return found[:, dofs]

    @cached_property
    def coupled(self) -> set[int]:
        """The trees that an equality constraint couples: their degrees of freedom do not move alone."""
        model = self.model
        kinds = self.mujoco.mjtEq
        found: set[int] = set()
        by_body = {int(kinds.mjEQ_CONNECT), int(kinds.mjEQ_WELD)}
        for number in range(model.neq):
            kind = int(model.eq_type[number])
            ids = (int(model.eq_obj1id[number]), int(model.eq_obj2id[number]))
            if kind == int(kinds.mjEQ_JOINT):
                found |= {int(model.dof_treeid[model.jnt_dofadr[each]]) for each in ids if each >= 0}
            elif kind in by_body and int(model.eq_objtype[number]) == int(self.mujoco.mjtObj.mjOBJ_BODY):
                found |= {int(model.body_treeid[each]) for each in ids if each >= 0}
            else:
                return set(range(model.ntree))
        return found

    def unstable(self) -> Iterator[Mode]:
        """Yield, for each tree that no equality couples, the servos that are too stiff or too damped for the time step.

        The integrator `discrete` is implicit in positions, so it is skipped.
        """
        model = self.model
        for tree in sorted(set(range(model.ntree)) - self.coupled):
            first = int(model.tree_dofadr[tree])
            dofs = slice(first, first + int(model.tree_dofnum[tree]))
            stiffness = self.stiffness(dofs)
            damping = self.damping(dofs)
            is_passive = (np.diag(stiffness) >= 0).all() and (np.diag(damping) >= 0).all()
            if is_passive and (stiffness.any() or damping.any()):
                yield from self._unstable(dofs)

    def _unstable(self, dofs: slice) -> Iterator[Mode]:
        timestep = float(self.model.opt.timestep)
        count = dofs.stop - dofs.start
        step = self._step(dofs, timestep)
        if step is None:
            return
        values, vectors = np.linalg.eig(step)
        wrong = np.abs(values) > 1 + _GROWS
        seen = set()
        for at in np.flatnonzero(wrong)[np.argsort(-np.abs(values[wrong]))].tolist():
            weights = np.abs(vectors[count:, at]) ** 2 * np.diag(self.inertia(dofs))
            dof = dofs.start + int(np.argmax(weights))
            if dof not in seen and not self.model.dof_frictionloss[dof]:  # friction holds small motions
                seen.add(dof)
                yield Mode(dof, float(np.abs(values[at])), self._longest(dofs))

    def _longest(self, dofs: slice) -> float | None:
        low = 0.0
        high = float(self.model.opt.timestep)
        for _ in range(12):
            middle = (low + high) / 2
            grows = bool((np.abs(np.linalg.eigvals(self._step(dofs, middle))) > 1 + _GROWS).any())
            low, high = (low, middle) if grows else (middle, high)
        return low if low > _LEAST else None

    def _step(self, dofs: slice, timestep: float) -> Any:
        """Return the matrix by which a step multiplies positions and velocities; None for other integrators."""
        integrators = self.mujoco.mjtIntegrator
        model = self.model
        kind = int(model.opt.integrator)
        mass = self.inertia(dofs)
        spring = self.stiffness(dofs)
        passive = np.diag(np.reshape(model.dof_damping, (model.nv, -1))[dofs, 0])
        damping = passive + self.damping(dofs)
        unit = np.eye(len(mass))
        if kind == int(integrators.mjINT_RK4):
            change = timestep * np.block(
                [[0 * unit, unit], [-np.linalg.solve(mass, spring), -np.linalg.solve(mass, damping)]]
            )
            terms = accumulate(range(1, 5), lambda term, number: term @ change / number, initial=np.eye(2 * len(mass)))
            return sum(terms)
        if kind == int(integrators.mjINT_EULER):
            off = int(self.mujoco.mjtDisableBit.mjDSBL_EULERDAMP)
            ahead = 0 * passive if model.opt.disableflags & off else passive
        elif kind in (int(integrators.mjINT_IMPLICIT), int(integrators.mjINT_IMPLICITFAST)):
            ahead = damping
        else:
            return None
        solved = np.linalg.solve(mass + timestep * ahead, np.hstack([spring, damping]))
        from_position = timestep * solved[:, : len(mass)]
        from_speed = timestep * solved[:, len(mass) :]
        speed = [-from_position, unit - from_speed]
        return np.block([[unit + timestep * speed[0], timestep * speed[1]], speed])

    # Forces

    def of_dof(self, dof: int) -> list[int]:
        """Return the actuators that act on a degree of freedom."""
        return self._actuators.get(dof, [])

    def strongest(self, dof: int) -> tuple[float, float] | None:
        """Return the smallest and the largest force on a hinge or slide (N m, N), or None."""
        model = self.model
        joint = int(self.model.dof_jntid[dof])
        low = high = 0.0
        for actuator in self.of_dof(dof):
            ends = self._forces(actuator)
            if ends is None or len(self.arms[actuator]) > 1:
                return None
            ends = sorted(self.arms[actuator][dof] * each for each in ends)
            low = low + ends[0]
            high = high + ends[1]
        if not self.of_dof(dof):
            return None
        if model.jnt_actfrclimited[joint]:
            least, most = map(float, model.jnt_actfrcrange[joint])
            low = max(low, least)
            high = min(high, most)
        return low, high

    def _forces(self, actuator: int) -> list[float] | None:
        model = self.model
        if int(model.actuator_trntype[actuator]) not in ON_JOINTS or is_by_plugin(model, actuator):
            return None
        if model.actuator_forcelimited[actuator]:
            return [float(each) for each in model.actuator_forcerange[actuator]]
        control = int(getattr(model, "actuator_ctrladr", range(model.nu))[actuator])
        kinds = int(model.actuator_gaintype[actuator]), int(model.actuator_biastype[actuator])
        simple = kinds == (FIXED, NO_BIAS) and int(model.actuator_dyntype[actuator]) == 0
        if not simple or control < 0 or not model.actuator_ctrllimited[control]:
            return None
        return [float(model.actuator_gainprm[actuator, 0]) * float(each) for each in model.actuator_ctrlrange[control]]
