"""What a pass or a step did to an element, in words, and the place that is the reason."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import TYPE_CHECKING

from composer.bundle.collect import collect
from composer.compose.elements import settle_joints
from composer.compose.reference_check import check_names
from composer.diagnostics.span import Span
from composer.document.node import find, locate
from composer.explain.explanation import Reason
from composer.explain.trace import Cause, Change, Function, Life, Move, Trace
from composer.link.agreement import agreement
from composer.link.angles import angles, model_angle
from composer.link.bodies import bodies
from composer.link.body_reduction import body_reduction
from composer.link.compiler import compiler, model_autolimits
from composer.link.defaults import defaults
from composer.link.files import add_file, files
from composer.link.fitting import fitting
from composer.link.inertia import MEASURED, inertia
from composer.link.keyframes import keyframes
from composer.link.lengthranges import lengthranges
from composer.link.link import row_of
from composer.link.names import names
from composer.link.part import Part
from composer.link.replicates import replicates
from composer.link.root_rules import roots
from composer.link.sections import sections
from composer.link.submodel_options import submodel_options
from composer.link.submodels import submodels
from composer.plan.plan import DropElements, Plan
from composer.plan.steps.draw_values import DrawValues
from composer.plan.steps.edit_elements import EditElements
from composer.plan.steps.step import Step
from composer.recipe.shown import shown
from composer.tree.classes import MAIN, ORIENTATIONS, Classes
from composer.tree.effective import class_in_force
from composer.tree.settings import Settings

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from composer.tree.unit import Unit

_DEFAULT = Settings()
_FOLDERS = ("meshdir", "texturedir", "assetdir", "strippath")


def rewrites(cause: Cause) -> bool:
    """Whether it writes a value in another way, or under another name: the value comes from where it came from."""
    row = row_of(cause.done)
    return row.rewrites if row is not None else cause.function in (add_file, collect, check_names)


class Causes:
    """The words of the changes that one trace has."""

    def __init__(self, trace: Trace) -> None:
        self.trace = trace

    def change(self, change: Change, life: Life) -> Reason:
        """Why an attribute changed."""
        cause = change.cause
        known = _CHANGES.get(cause.function)
        if known is not None:
            told = known(self, change, life)
            if told is not None:
                return told
        return self._step(cause, change.owner, change.attribute, life.node)

    def made(self, life: Life) -> Reason:
        """Why there is an element that was read from no file."""
        cause = life.made_by
        assert cause is not None
        known = _MADE.get(cause.function)
        if known is not None:
            return known(self, life, cause)
        return self._step(cause, life.owner, None)

    def value(self, life: Life, attribute: str) -> Reason:
        """Why an element that a pass made has the value of an attribute."""
        cause = life.made_by
        assert cause is not None
        known = _VALUES.get(cause.function)
        told = None if known is None else known(self, life, cause, attribute)
        return told or self.made(life)

    def gone(self, life: Life) -> Reason:
        """Why there is an element no more."""
        cause = life.gone
        assert cause is not None
        known = _GONE.get(cause.function)
        return known(self, life, cause) if known is not None else self._step(cause, None, None)

    def move(self, move: Move, life: Life) -> Reason | None:
        """Why an element stands elsewhere; None where that means nothing, as in a section that was joined."""
        cause = move.cause
        if cause.function in (sections, defaults, compiler, keyframes):
            return None
        if cause.function is bodies:
            return None if cause.part is None else Reason(f"hung {place(cause.part)}", _hung_at(cause.part))
        if (
            move.before is not None
            and move.after is not None
            and move.before.tag == move.after.tag == "mujoco"
        ):
            return None
        return self._step(cause, None, None)

    def _step(self, cause: Cause, owner: object, attribute: str | None, node: Node | None = None) -> Reason:
        done = cause.done
        if isinstance(done, Plan):
            return _by_plan(done, attribute)
        span = _owned(owner, attribute) or getattr(done, "span", None)
        if isinstance(done, EditElements | DropElements):
            written_by_it = span is not None and span.file == done.span.file
            return Reason(done.words, span if written_by_it else done.span)
        if isinstance(done, DrawValues):
            drawn = None if node is None else _drawn(cause, node, done.field.name)
            value = "" if drawn is None else f": {shown(drawn)} is drawn"
            return Reason(f"{done.reason}{value}", done.span)
        if isinstance(done, Step):
            return Reason(done.reason, span)
        return Reason(_summary(done), span if isinstance(span, Span) else None)

    # -- what the linker's passes do ---------------------------------------------------------------------------

    def setting(self, unit: Unit, name: str) -> Span | None:
        """Where a unit writes a compiler setting."""
        life = self.trace.written(unit, "compiler", name)
        return None if life is None else life.span(unit.origins, name)

    def _names(self, change: Change, life: Life) -> Reason | None:
        part = change.cause.part
        if change.after is not None and change.before is None and change.attribute == "name":
            return Reason("named after its file, with the prefix of the part", part.span if part else None)
        if part is not None and change.after == part.prefix + (change.before or ""):
            return Reason(f"prefix of the part `{part.called}`", part.span)
        if change.before == MAIN and change.attribute in ("class", "childclass"):
            return Reason(f"the top class of {_file(change.cause.unit)} is called that here")
        return Reason(
            f"names of the part `{part.called}`" if part else "names of the base", part.span if part else None
        )

    def _angles(self, change: Change, life: Life) -> Reason | None:
        unit = change.cause.unit
        if change.attribute in ORIENTATIONS and unit.settings.eulerseq != _sequence(change.cause):
            words = (
                f"{_file(unit)} reads angles in the sequence `{unit.settings.eulerseq}`, the model does not"
            )
            return Reason(words, self.setting(unit, "eulerseq"))
        span = self.setting(unit, "angle")
        degrees = f"{_file(unit)} is in degrees" + ("" if span else ", MJCF's default")
        if change.before is None:
            given = Classes(life.node.getroottree().getroot()).get(class_in_force(life.node).name)
            found = given.lookup("joint", change.attribute)
            span = None if found is None else self.trace.life(found[1]).span(unit.origins, change.attribute)
            return Reason(f"its class gives it to joints that slide too; in radians here, {degrees}", span)
        return Reason(f"degrees → radians: {degrees}, the model in radians", span)

    def _inertia(self, change: Change, life: Life) -> Reason | None:
        return self._inertia_rule(change.cause)

    def _inertia_made(self, life: Life, cause: Cause) -> Reason:
        return self._inertia_rule(cause)

    def _inertia_rule(self, cause: Cause) -> Reason:
        settings, unit = cause.unit.settings, cause.unit
        measured = [name for name in MEASURED if getattr(settings, name) != getattr(_DEFAULT, name)]
        if measured:
            names = " and ".join(f"`{name}`" for name in measured)
            return Reason(
                f"measured by MuJoCo on {_file(unit)} alone, for its {names}", self.setting(unit, measured[0])
            )
        for name in ("inertiagrouprange", "inertiafromgeom"):
            value = getattr(settings, name)
            if value != getattr(_DEFAULT, name):
                return Reason(f'`{name}="{value}"` of {_file(unit)}, made explicit', self.setting(unit, name))
        return Reason(f"the inertia rules of {_file(unit)}, made explicit")

    def _reductions(self, change: Change, life: Life) -> Reason | None:
        return self._reduced(life, change.cause)

    def _reduced(self, life: Life, cause: Cause) -> Reason:
        unit = cause.unit
        spans = {name: self.setting(unit, name) for name in ("fusestatic", "discardvisual")}
        names = " and ".join(f"`{name}`" for name, span in spans.items() if span is not None)
        first = next((span for span in spans.values() if span is not None), None)
        return Reason(f"as MuJoCo has it in {_file(unit)} alone, by its {names}", first)

    def _unrolled(self, life: Life, cause: Cause) -> Reason:
        words = f"a copy by the `<replicate>` of {_file(cause.unit)}, written out"
        return Reason(words, self._step(cause, life.owner, None).span)

    def _fitting(self, change: Change, life: Life) -> Reason | None:
        unit = change.cause.unit
        words = f"fitted by MuJoCo to the mesh's bounding box: `fitaabb` of {_file(unit)}"
        return Reason(words, self.setting(unit, "fitaabb"))

    def _lengthranges(self, change: Change, life: Life) -> Reason | None:
        unit = change.cause.unit
        rule = next(
            (
                each
                for each in self.trace.lives.values()
                if each.tag == "lengthrange" and each.root is unit.root
            ),
            None,
        )
        words = f"measured by MuJoCo on {_file(unit)} alone"
        if rule is None:
            return Reason(f"{words}, where nothing hangs on what the muscle moves", None)
        return Reason(f"{words}, by its own `<lengthrange>`", rule.span(unit.origins))

    def _adopted(self, change: Change, life: Life) -> Reason | None:
        return self._adopted_made(life, change.cause)

    def _adopted_made(self, life: Life, cause: Cause) -> Reason:
        words = f'asked for by a model that {_file(cause.unit)} attaches, under its `conflict="merge"`'
        return Reason(words, self.setting(cause.unit, "conflict"))

    def _agreement(self, change: Change, life: Life) -> Reason | None:
        linking = change.cause.linking
        if linking is None or change.after is None:
            return Reason("only one of these settings may be written")
        for part in linking.parts:
            for node in part.unit.root.iter(life.tag):
                asked = self.trace.lives.get(node)
                if asked is not None and asked.attributes.get(change.attribute) == change.after:
                    span = asked.span(part.unit.origins, change.attribute)
                    return Reason(f"asked for by the part `{part.called}`", span)
        return Reason("room for what the parts have")

    def _agreement_made(self, life: Life, cause: Cause) -> Reason:
        for name, value in life.attributes.items():
            told = self._agreement(Change(name, None, value, cause, life.owner), life)
            if told is not None:
                return told
        return Reason("what the parts ask for")

    def _files(self, change: Change, life: Life) -> Reason | None:
        if change.attribute == "name":
            return Reason("named after its file")
        return Reason("where the bundle has the file")

    def _same_file(self, change: Change, life: Life) -> Reason | None:
        if change.attribute == "name":
            return Reason("named after its file")
        return Reason("a file with the same bytes is in the bundle already")

    def _defaults(self, change: Change, life: Life) -> Reason | None:
        if change.before is None:
            return Reason(f"what has no class of its own is of the top class of {_file(change.cause.unit)}")
        return Reason(f"the top class of {_file(change.cause.unit)} is called that here")

    def _defaults_made(self, life: Life, cause: Cause) -> Reason:
        if life.tag == "default" and "class" in life.attributes:
            return Reason(f"the top class of {_file(cause.unit)}", self._top(cause.unit))
        return Reason("holds the default classes of the parts")

    def _top(self, unit: Unit) -> Span | None:
        """Where a unit begins to write its default classes."""
        for life in self.trace.lives.values():
            if (
                life.root is unit.root
                and life.parent is unit.root
                and life.tag == "default"
                and not life.made_by
            ):
                return life.span(unit.origins)
        return None

    def _agreement_value(self, life: Life, cause: Cause, attribute: str) -> Reason | None:
        change = Change(attribute, None, life.attributes.get(attribute), cause, life.owner)
        return self._agreement(change, life)

    def _compiler_value(self, life: Life, cause: Cause, attribute: str) -> Reason | None:
        for source in life.sources:
            if source.attributes.get(attribute) == life.attributes.get(attribute):
                return Reason("", source.span(cause.unit.origins, attribute))
        return self._compiler(Change(attribute, None, None, cause, life.owner), life)

    def _defaults_value(self, life: Life, cause: Cause, attribute: str) -> Reason | None:
        if attribute == "class" and cause.part is not None:
            return Reason("named after the part", cause.part.span)
        return None

    def _bodies_value(self, life: Life, cause: Cause, attribute: str) -> Reason | None:
        """What hangs a part: the pose and the joints that the recipe writes, the pose of the place."""
        part = cause.part
        if part is None:
            return None
        span = cause.unit.origins.settings.get(life.node, {}).get(attribute)
        if span is None and cause.linking is not None:
            span = cause.linking.base.origins.settings.get(life.node, {}).get(attribute)
        is_pose = attribute == "pos" or attribute in ORIENTATIONS
        if span is not None and attribute == "name":
            return Reason(f"named there, with the prefix of the part `{part.called}`", span)
        if span is not None:
            computed = part.place.computed if is_pose else ""
            return Reason(_COMPUTED.get(computed, ""), span)
        if attribute in ("class", "childclass") and life.attributes[attribute] == part.top_class:
            return Reason(f"the top class of the part `{part.called}`", part.span)
        if attribute == "name":
            return Reason(f"named after the part `{part.called}`", part.span)
        if is_pose and part.floats:
            return Reason("computed: where that place is in the world", _hung_at(part))
        if is_pose:
            return Reason(f"the pose of the {part.place.kind} `{part.place.name}`", _hung_at(part))
        return Reason(f"for the part `{part.called}`", part.span)

    def _bodies_made(self, life: Life, cause: Cause) -> Reason:
        part = cause.part
        if part is None:
            return Reason("holds what the parts bring")
        if life.tag == "frame" and life.attributes.get("childclass") == part.top_class:
            return Reason(
                f"carries the part `{part.called}` {place(part)}, and its default class", _hung_at(part)
            )
        if life.tag == "frame":
            return Reason(
                f"the pose of the {part.place.kind} that the part `{part.called}` hangs on", _hung_at(part)
            )
        if life.tag == "body":
            return Reason(f"a body for the joint between the part `{part.called}` and its place", part.span)
        return Reason(f"joins the part `{part.called}` to its place", part.span)

    def _weld(self, life: Life, cause: Cause) -> Reason:
        part = cause.part
        return Reason("left out: `joint: weld` fixes the part in its place", part.span if part else None)

    def _section_made(self, life: Life, cause: Cause) -> Reason:
        return Reason("holds what the parts bring")

    def _compiler(self, change: Change, life: Life) -> Reason | None:
        linking = change.cause.linking
        if change.attribute in _FOLDERS:
            return Reason("every file is named by its path in the bundle")
        if change.attribute == "angle" and linking is not None:
            return Reason(f"one unit for all parts: {model_angle(linking)}s")
        if change.attribute == "autolimits" and linking is not None and model_autolimits(linking) == "true":
            return Reason("made explicit where it matters")
        return Reason("made explicit in what it governs, so that it does not reach other parts")

    def _compiler_made(self, life: Life, cause: Cause) -> Reason:
        if len(life.sources) == 1:
            return Reason("the base's settings, as they hold for every part")
        return Reason("the settings that hold for every part")

    def _keyframes_made(self, life: Life, cause: Cause) -> Reason:
        if not isinstance(life.owner, str):
            return Reason("written in the recipe, laid out for the whole model", _owned(life.owner, None))
        if len(life.sources) > 1:
            return Reason(f"{len(life.sources)} keys of that name made one, laid out for the whole model")
        return Reason("laid out anew for the whole model")

    def _keyframes(self, change: Change, life: Life) -> Reason | None:
        return Reason("laid out anew for the whole model")

    def _settled(self, change: Change, life: Life) -> Reason | None:
        span = _owned(change.owner, change.attribute)
        return Reason("written in the recipe, in the model's unit of angle", span)

    def _main(self, change: Change, life: Life) -> Reason | None:
        return Reason("`main` is called that here: the top class of the base")


def place(part: Part) -> str:
    """Where a part hangs, in words."""
    where = part.place
    found = "in the world" if where.kind == "world" else f"on the {where.kind} `{where.name}`"
    return f"{found}, with an offset" if where.offset else found


def _hung_at(part: Part) -> Span | None:
    return part.place.span or part.span


def _file(unit: Unit) -> str:
    """A unit by the name of its file; where that is stands beside it."""
    return f"`{unit.file.rpartition('/')[2]}`"


def _sequence(cause: Cause) -> str | None:
    return None if cause.linking is None else cause.linking.base.settings.eulerseq


def _owned(owner: object, attribute: str | None) -> Span | None:
    if isinstance(owner, Span):
        return owner
    if callable(owner):
        span = owner(attribute)
        return span if isinstance(span, Span) else None
    return None


def _drawn(cause: Cause, node: Node, field: str) -> object | None:
    """What a field drew for an element, or for the body whose mass the element gives."""
    if cause.linking is None:
        return None
    for each in (node, *node.iterancestors("body")):
        if field in (found := cause.linking.notes.drawn.get(each, {})):
            return found[field]
    return None


def _by_plan(plan: Plan, attribute: str | None) -> Reason:
    if attribute == "model":
        named = find(plan.document, ("name",)) is not None
        words = "`name` of the recipe" if named else "the name of the recipe's file"
        return Reason(words, locate(plan.document, ("name",)) if named else None)
    return Reason("the recipe leaves it out", locate(plan.document, ("base", "keyframes")))


def _summary(done: object) -> str:
    """What a pass says of itself in its row, another function in the first line of its docstring."""
    if (row := row_of(done)) is not None:
        return row.words
    module = inspect.getmodule(done)
    text = (inspect.getdoc(done) or getattr(module, "__doc__", None) or type(done).__name__).strip()
    return text.splitlines()[0].removeprefix("Pass: ").rstrip(".")


_CHANGES: dict[Function | None, Callable[[Causes, Change, Life], Reason | None]] = {
    names: Causes._names,
    body_reduction: Causes._reductions,
    angles: Causes._angles,
    inertia: Causes._inertia,
    fitting: Causes._fitting,
    lengthranges: Causes._lengthranges,
    submodel_options: Causes._adopted,
    agreement: Causes._agreement,
    files: Causes._files,
    submodels: Causes._files,
    add_file: Causes._files,
    collect: Causes._same_file,
    defaults: Causes._defaults,
    compiler: Causes._compiler,
    keyframes: Causes._keyframes,
    settle_joints: Causes._settled,
    check_names: Causes._main,
}
_MADE: dict[Function | None, Callable[[Causes, Life, Cause], Reason]] = {
    replicates: Causes._unrolled,
    body_reduction: Causes._reduced,
    inertia: Causes._inertia_made,
    submodel_options: Causes._adopted_made,
    agreement: Causes._agreement_made,
    defaults: Causes._defaults_made,
    bodies: Causes._bodies_made,
    compiler: Causes._compiler_made,
    keyframes: Causes._keyframes_made,
    sections: Causes._section_made,
}
_VALUES: dict[Function | None, Callable[[Causes, Life, Cause, str], Reason | None]] = {
    agreement: Causes._agreement_value,
    bodies: Causes._bodies_value,
    compiler: Causes._compiler_value,
    defaults: Causes._defaults_value,
}
_COMPUTED = {
    "mate": "computed, so that what `mate` names lies on the place",
    "replicate": "computed: the place of this copy",
}
_GONE: dict[Function | None, Callable[[Causes, Life, Cause], Reason]] = {
    body_reduction: Causes._reduced,
    inertia: Causes._inertia_made,
    roots: Causes._weld,
}
