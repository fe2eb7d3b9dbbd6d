"""Pass: report ranges without `limited` in files that set `autolimits="false"`, which MuJoCo refuses."""

from __future__ import annotations

from lxml.etree import _Element as Node

from composer.link.compiler import model_autolimits
from composer.link.linking import Linking
from composer.link.numbers import read
from composer.tree.effective import text_in_effect
from composer.tree.kinds import kind_of
from composer.tree.unit import Unit

_LIMITED_BY = {
    "range": "limited",
    "actuatorfrcrange": "actuatorfrclimited",
    "ctrlrange": "ctrllimited",
    "forcerange": "forcelimited",
    "actrange": "actlimited",
}
_IGNORED_BY = {"range": ("free",), "actuatorfrcrange": ("free", "ball")}
"""Types of joints that these do not limit: MuJoCo (3.12 to 4.0) does not look at them there."""
_SECTIONS = ("worldbody", "tendon", "actuator")


def autolimits(linking: Linking) -> None:
    """Check the units that set `autolimits="false"` in a model that does not, where such a range would limit.

    If all units set it, the model does too, and MuJoCo (3.12 to 4.0) reports the range: "joint has `range` but not
    `limited`".
    """
    if not linking.parts or model_autolimits(linking) == "false":
        return
    for unit in linking.units:
        if unit.settings.autolimits == "false":
            for section in unit.root.iterchildren(*_SECTIONS):
                for element in section.iterdescendants("*"):
                    _check(linking, unit, element)


def _check(linking: Linking, unit: Unit, element: Node) -> None:
    kind = kind_of(element)
    joint = text_in_effect(element, kind, "type", unit.classes) if element.tag == "joint" else None
    for name, limited in _LIMITED_BY.items():
        if (
            name not in kind.attributes
            or limited not in kind.attributes
            or joint in _IGNORED_BY.get(name, ())
        ):
            continue
        if not any(read(text_in_effect(element, kind, name, unit.classes) or "")):
            continue
        if (text_in_effect(element, kind, limited, unit.classes) or "auto") == "auto":
            called = (
                f"{element.tag} `{element.get('name')}`"
                if element.get("name")
                else f"`<{element.tag}>` without a name"
            )
            linking.sink.error(
                "mujoco-rejects",
                f'{called} has `{name}` but not `{limited}`, and its file sets `autolimits="false"`',
                linking.span(unit, element, name),
                help=f'write `{limited}="true"` or `{limited}="false"` beside it',
            )
