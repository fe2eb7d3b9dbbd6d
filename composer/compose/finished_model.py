"""Compile the finished model and keep it in a session, for steps that need its poses."""

from __future__ import annotations

from composer import engine
from composer.context import Context
from composer.link.linking import Linking
from composer.link.measure import folder_of
from composer.mujoco_errors.message import parse
from composer.mujoco_errors.report import report
from composer.mujoco_errors.translation import translate
from composer.tree.line import element_at
from composer.tree.write import write

FINISHED = "finished"


def keep_finished(linking: Linking, context: Context, session: engine.Session) -> bool:
    """Compile the model and keep it in the session as `FINISHED`.

    Return False if MuJoCo refuses it, which is reported.
    """
    unit = linking.flat()
    text = write(unit.root)
    with folder_of(unit) as folder:
        found = engine.compile(folder, text=text.decode(), keep=FINISHED, session=session)
    if not found.ok:
        fault = parse(found.error or "")
        element = None if fault.line is None else element_at(unit.root, text, fault.line)
        report(translate(" ".join(fault.message.split()), element), element, unit, context=context)
    return found.ok
