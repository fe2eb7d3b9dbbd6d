"""Pass: a flex that is turned by a `quat` of another length than 1.

Right below a body or the world MuJoCo takes such a `quat` as it is, which stretches the flex, and normalises it below
a frame, as parts have one around them: that is told, from a per mille on as an error.
"""

from __future__ import annotations

import math

from composer.link import numbers
from composer.link.linking import Linking
from composer.numerics.pose import normalise

_ROUNDING = 1e-9
_TOLERABLE = 1e-3


def flex_turns(linking: Linking) -> None:
    """Tell what frames change of the flexes in the world of the parts."""
    for flex in linking.notes.flexes:
        parent = flex.element.getparent()
        if flex.part is None or parent is None or parent.tag != "worldbody":
            continue
        quat = numbers.read(str(flex.element.get("quat") or "1 0 0 0"))
        length = math.hypot(*quat)
        if len(quat) != 4 or not length or abs(length - 1) < _ROUNDING:
            continue
        report = linking.sink.error if abs(length - 1) > _TOLERABLE else linking.sink.warning
        w, x, y, z = quat
        report(
            "not-supported",
            f"the flex of `{flex.part.called}` is turned by a `quat` of length {length:.6g}: MuJoCo stretches it "
            "alone, and not below a frame",
            linking.span(flex.unit, flex.element, "quat"),
            help=f'write `quat="{numbers.text(normalise((w, x, y, z)))}"`, which only turns',
        )
