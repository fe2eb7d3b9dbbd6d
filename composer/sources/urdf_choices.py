"""How a URDF is to be read, as far as it does not say so itself."""

from __future__ import annotations

from typing import Literal

from composer.dataclass import dataclass

Visuals = Literal["keep", "drop"]
Fixed = Literal["keep", "fuse"]
Inertia = Literal["mend", "keep"]
Actuators = Literal["declared", "all", "none"]


@dataclass(frozen=True, slots=True)
class UrdfChoices:
    """What a recipe says beside a URDF: `arguments` of a xacro template, and the choices of `urdf:`.

    None leaves it to the file, and where that says nothing to MuJoCo, which drops visuals and fuses fixed links.
    """

    arguments: tuple[tuple[str, str], ...] = ()
    visuals: Visuals | None = None
    fixed: Fixed | None = None
    actuators: Actuators = "declared"
    inertia: Inertia | None = None


AS_WRITTEN = UrdfChoices()
