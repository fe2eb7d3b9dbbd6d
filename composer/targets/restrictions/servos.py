"""Limit of a target that knows servos by their tags: actuators get the tag of the servo whose work they do."""

from __future__ import annotations

from composer.targets.draft import Draft
from composer.targets.limit import Limit, Outcome
from composer.targets.plain.actuators import simple_actuators


def servos(*tags: str, of: tuple[str, ...] = ("joint",)) -> Limit:
    """Return a limit that keeps actuators with these tags that act on one of `of`, and removes the others."""

    def apply(draft: Draft) -> None:
        simple_actuators(draft.root, any_input=True)
        for actuator in list(draft.root.iterfind("actuator/*")):
            if actuator.tag not in tags:
                draft.lose(
                    "actuators",
                    actuator,
                    f"it is none of {', '.join(tags)}" if tags else "it has no actuators",
                )
            elif not any(actuator.get(each) for each in of):
                draft.lose("actuators", actuator, f"it acts on something else than a {' or a '.join(of)}")
            else:
                continue
            draft.remove(actuator)

    return Limit("actuators", Outcome.PARTLY if tags else Outcome.LEFT_OUT, apply)
