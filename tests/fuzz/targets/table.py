"""Every target; a new one is a file beside this one, and a row here."""

from __future__ import annotations

from fuzz.target import Target
from fuzz.targets import (
    bundle,
    command,
    expression,
    lock,
    mapping,
    mjcf,
    quantity,
    recipe,
    repeat,
    selector,
    serving,
    skin,
    urdf,
    xacro,
)

TARGETS: dict[str, Target] = {
    each.name: each
    for each in (
        recipe.TARGET,
        mapping.TARGET,
        quantity.TARGET,
        repeat.TARGET,
        expression.TARGET,
        selector.TARGET,
        mjcf.TARGET,
        urdf.TARGET,
        xacro.TARGET,
        bundle.ARCHIVE,
        bundle.MANIFEST,
        lock.TARGET,
        skin.TARGET,
        command.TARGET,
        serving.REQUEST,
        serving.FRAMES,
    )
}
