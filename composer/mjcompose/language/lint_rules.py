"""The names of the rules of the linter that a check can run: those that read no files. `lint` has the rules.

`lint.rule` compares its rules with these tables when it first reads them.
"""

from __future__ import annotations

FAMILY_RULES = {
    "dead": (
        "dead-actuator",
        "unused-class",
        "unused-hfield",
        "unused-material",
        "unused-mesh",
        "unused-tendon",
        "unused-texture",
    ),
    "ranges": (
        "control-misses-range",
        "key-out-of-range",
        "quat-not-unit",
        "range-ignored",
        "range-inverted",
        "reference-out-of-range",
        "sides-differ",
        "solref-below-timestep",
    ),
    "order": (
        "actuator-order",
        "key-breaks-equality",
        "key-does-not-hold",
    ),
    "physics": (
        "armature-missing",
        "density-impossible",
        "free-joint-damped",
        "friction-exceeds-motor",
        "inertia-balanced",
        "inertia-implausible",
        "inertial-ignored",
        "inertial-missing",
        "mass-guessed",
        "motor-too-weak",
        "servo-undamped",
        "simulation-diverges",
        "timestep-too-long",
    ),
    "contact": (
        "collides-with-nothing",
        "exclude-needless",
        "frictionless-foot",
        "geom-twice",
        "hull-too-fine",
        "overlap",
        "plane-hidden",
        "visual-collides",
    ),
    "units": (
        "control-in-degrees",
        "gravity-unit",
        "mesh-in-millimeters",
        "range-in-degrees",
        "range-in-radians",
        "timestep-extreme",
    ),
    "names": (
        "awkward-name",
        "names-differ-by-case",
        "side-mismatch",
        "unnamed-actuator",
        "unnamed-joint",
        "unnamed-key",
        "unnamed-model",
        "unnamed-sensor",
    ),
    "portable": (
        "newer-mujoco",
        "unread-by-drake",
        "unread-by-genesis",
        "unread-by-isaac",
        "unread-by-mjx",
        "unread-by-newton",
        "unread-by-pinocchio",
        "unread-by-pybullet",
        "unread-by-ros2",
        "unread-by-urdf",
        "unread-by-warp",
    ),
    "files": (
        "absolute-path",
        "floor-in-model",
        "section-order",
    ),
}
"""The rules of each family, both in the order in which they run."""
SELECTED_BY_NAME = frozenset(
    {
        "armature-missing",
        "inertial-missing",
        "gravity-unit",
        "unnamed-model",
        *FAMILY_RULES["portable"],
        "floor-in-model",
        "section-order",
    }
)
"""The rules that run only if their names, or the names of their families, are selected."""
