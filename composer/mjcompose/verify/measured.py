"""Compare a model with the files of measurements that it uses: was the robot measured with this version of it?"""

from __future__ import annotations

from mjcompose.base.diagnostic import Note
from mjcompose.base.sink import Sink
from mjcompose.mujoco import engine
from mjcompose.mujoco.fingerprint import fingerprints
from mjcompose.mujoco.messages import CRASH_HELP, CRASHES
from mjcompose.plan.measured import Measurements
from mjcompose.plan.plan import Plan
from mjcompose.verify.compile import WHOLE

_CODE = "measured-stale"


def check_measured(plan: Plan, session: engine.Session, sink: Sink) -> None:
    """Report each file that was measured with another model. Samples that draw other numbers differ on purpose."""
    randomize = plan.randomize
    if plan.sample and randomize is not None and len(randomize.of_measured) < len(randomize.fields):
        return
    for place in plan.walk():
        inner = place.model
        if isinstance(inner, Plan) and inner.measured is not None:
            measurements = inner.measured
            if measurements.topics and measurements.use.stale == "refuse":
                _compare(measurements, place.prefix, session, sink)


def _compare(measurements: Measurements, prefix: str, session: engine.Session, sink: Sink) -> None:
    numbers = [
        {"kind": value.kind, "names": list(value.names), "attribute": value.attribute} for value in measurements.values
    ]
    question = {"prefix": prefix, "numbers": numbers}
    answer = engine.call(session, fingerprints, [WHOLE], argument=question)
    shown = measurements.shown
    span = measurements.span
    accept = "or accept the numbers: `measured: {file: …, stale: accept}`"
    if not answer.ok:
        code = CRASHES.get(answer.crash or "", "mujoco-crash")
        sink.error(code, answer.error or str(answer.crash), span, help=CRASH_HELP.get(code))
        return
    if "missing" in answer.value:
        message = f"`{shown}` cannot be compared with the model: it has no {answer.value['missing']}"
        sink.error(_CODE, message, span, help=f"`measured: {{rename: …}}` maps names, {accept}")
        return
    now = answer.value["topics"]
    changed = [topic for topic, known in measurements.topics.items() if now[topic] != known]
    if changed:
        notes = [Note(f"{topic}: {_TOPICS[topic]}") for topic in changed]
        message = f"`{shown}` was measured with other {' and '.join(changed)} than this recipe has"
        help = f"fit the recordings again: `mjcompose identify RECIPE RECORDING -o {shown}`, {accept}"
        sink.error(_CODE, message, span, notes=notes, help=help)


_TOPICS = {
    "links": "poses of bodies, axes and types of joints",
    "inertia": "masses, centers of mass, inertias and armatures that were not measured",
    "friction": "dampings, dry frictions and stiffnesses of joints that were not measured",
    "actuators": "gains, gears and limits of actuators that were not measured",
    "options": "time step, integrator and gravity",
}
