"""Check the order of the lower and upper ends that the recipe writes.

MuJoCo silently takes a wrong order as no limit.
"""

from __future__ import annotations

from composer.compose.elements import ElementBuilder
from composer.diagnostics.diagnostic import Note
from composer.link import numbers
from composer.tree.select import name_of


def check_intervals(making: ElementBuilder) -> None:
    """Report ranges that end before they begin, when nothing more changes them.

    Not before: `"range[0]"` and `"range[1]"` may be set one after the other. Two zeros are how MJCF says that there is
    no range. What a source has is for MuJoCo to judge.
    """
    for (node, attribute), span in making.intervals.items():
        ends = numbers.read(str(node.get(attribute) or ""))
        # MuJoCo 4.0 compiles `<joint range="1 0"/>` to a joint without limits, and refuses it with `limited="true"`.
        if len(ends) != 2 or ends[0] < ends[1] or not any(ends):
            continue
        name = name_of(node)
        what = f"`{attribute}` of {node.tag} `{name}`" if name else f"`{attribute}` of a `{node.tag}`"
        wrong = "begins where it ends" if ends[0] == ends[1] else "has its ends in the wrong order"
        making.sink.error(
            "out-of-range",
            f"{what} {wrong}",
            span,
            notes=(Note("MuJoCo ignores such a range, or rejects the model"),),
            help="write the lower end first, then the upper one"
            if ends[0] > ends[1]
            else "write two numbers, or `[0, 0]` for no range",
            subjects=(name,),
        )
    making.intervals.clear()
