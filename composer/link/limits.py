"""`autolimits`: under `true` every explicit `limited` still counts, so that `false` is said only where all say it."""

from __future__ import annotations

from composer.link.linking import Linking


def model_autolimits(linking: Linking) -> str:
    """What the model says.

    MuJoCo refuses a range without an explicit `limited` under `false`, so that a unit which compiles with `false`
    means the same under `true`.
    """
    return "false" if all(unit.settings.autolimits == "false" for unit in linking.units) else "true"
