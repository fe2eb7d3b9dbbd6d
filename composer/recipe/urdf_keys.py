"""`urdf`: how a URDF file is read."""

from __future__ import annotations

from typing import Annotated, Literal

from composer.recipe.model import Model
from composer.recipe.text import Choice


class UrdfKeys(Model):
    """What becomes of what MuJoCo leaves out, or leaves to others; without it, it is as the file or MuJoCo says."""

    visuals: Annotated[Literal["keep", "drop"] | None, Choice("visuals")] = None
    """Whether visuals become geoms that touch nothing; what collides is then in group 3, which viewers hide. By default
    as `discardvisual` in the file says, which MuJoCo takes for `true`."""
    fixed: Annotated[Literal["keep", "fuse"] | None, Choice("fixed")] = None
    """Whether links without a joint of their own stay bodies, or become frames of the one above. By default as
    `fusestatic` in the file says, which MuJoCo takes for `true`."""
    actuators: Annotated[Literal["declared", "all", "none"], Choice("actuators")] = "declared"
    """Which joints get an actuator: those that `<ros2_control>` and `<transmission>` command, every joint that moves by
    itself, or none."""
    inertia: Annotated[Literal["mend", "keep"] | None, Choice("inertia")] = None
    """Whether inertias that no body can have, which MuJoCo refuses, are changed as little as possible; each is a
    warning."""
