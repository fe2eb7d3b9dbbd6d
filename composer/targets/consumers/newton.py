"""Target: Newton. It merges several joints of a body into one, and does not read flexes."""

from __future__ import annotations

from composer.targets.mjcf import write_mjcf
from composer.targets.restrictions.references import NO_REFERENCES
from composer.targets.restrictions.single_joints import SINGLE_JOINTS
from composer.targets.restrictions.solver import GRAVITY
from composer.targets.restrictions.unread import NO_PLUGINS, NO_SOFT
from composer.targets.target import Target

TARGET = Target(
    "newton",
    "Newton, by its parser of MJCF",
    (NO_REFERENCES, SINGLE_JOINTS, NO_SOFT, NO_PLUGINS, GRAVITY),
    write_mjcf,
    "newton",
)
