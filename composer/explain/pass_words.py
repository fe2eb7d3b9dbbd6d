"""Describe what a pass of the linker did to an element, with the place that is the reason."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from composer.bundle.collect import collect
from composer.compose.elements import settle_joints
from composer.compose.holding import hold_poses
from composer.compose.reference_check import check_names
from composer.diagnostics.span import Span
from composer.explain.explanation import Reason
from composer.explain.step_words import of_step, owned
from composer.explain.trace import Cause, Change, Function, Life, Trace
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
from composer.link.names import names
from composer.link.part import Part
from composer.link.replicates import replicates
from composer.link.root_rules import roots
from composer.link.sections import sections
from composer.link.submodel_options import submodel_options
from composer.link.submodels import submodels
from composer.tree.classes import MAIN, ORIENTATIONS, Classes
from composer.tree.effective import class_in_force
from composer.tree.settings import Settings

if TYPE_CHECKING:
    from composer.tree.unit import Unit

_DEFAULT = Settings()
_FOLDERS = ("meshdir", "texturedir", "assetdir", "strippath")
_COMPUTED = {
    "mate": "computed, so that what `mate` names lies on the place",
    "replicate": "computed: the place of this copy",
}


class PassWords:
    """Words for the changes that passes made in one trace."""

    def __init__(self, trace: Trace) -> None:
        self.trace = trace

    def setting(self, unit: Unit, name: str) -> Span | None:
        """Return where a unit writes a compiler setting."""
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
        return Reason(words, of_step(cause, life.owner, None).span)

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
            return Reason(f"{words}, where nothing is attached to what the muscle moves", None)
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
        path = "/".join([*(str(each.tag) for each in reversed([*life.node.iterancestors()][:-1])), life.tag])
        for adopted in linking.base.adopted:
            if adopted.path == f"{path}/{change.attribute}" and adopted.value == change.after:
                return Reason(
                    f"adopted from {', '.join(adopted.parts)}: neither base nor recipe writes it",
                    adopted.span,
                )
        for part in linking.parts:
            for node in part.unit.root.iter(life.tag):
                asked = self.trace.lives.get(node)
                if asked is not None and asked.attributes.get(change.attribute) == change.after:
                    span = asked.span(part.unit.origins, change.attribute)
                    return Reason(f"asked for by the part `{part.called}`", span)
        return Reason("room for what the parts have")

    def _agreement_made(self, life: Life, cause: Cause) -> Reason:
        for name, value in life.attributes.items():
            reason = self._agreement(Change(name, None, value, cause=cause, owner=life.owner), life)
            if reason is not None:
                return reason
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
        """Return where a unit begins to write its default classes."""
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
        change = Change(attribute, None, life.attributes.get(attribute), cause=cause, owner=life.owner)
        return self._agreement(change, life)

    def _compiler_value(self, life: Life, cause: Cause, attribute: str) -> Reason | None:
        for source in life.sources:
            if source.attributes.get(attribute) == life.attributes.get(attribute):
                return Reason("", source.span(cause.unit.origins, attribute))
        return self._compiler(Change(attribute, None, None, cause=cause, owner=life.owner), life)

    def _defaults_value(self, life: Life, cause: Cause, attribute: str) -> Reason | None:
        if attribute == "class" and cause.part is not None:
            return Reason("named after the part", cause.part.span)
        return None

    def _bodies_value(self, life: Life, cause: Cause, attribute: str) -> Reason | None:
        """Return the reason for a value on the attachment of a part: the recipe's pose and joints, or the place."""
        part = cause.part
        if part is None:
            return None
        span = cause.unit.origins.set_at(life.node, attribute)
        if span is None and cause.linking is not None:
            span = cause.linking.base.origins.set_at(life.node, attribute)
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
            return Reason("computed: where that place is in the world", hung_at(part))
        if is_pose:
            return Reason(f"the pose of the {part.place.kind} `{part.place.name}`", hung_at(part))
        return Reason(f"for the part `{part.called}`", part.span)

    def _bodies_made(self, life: Life, cause: Cause) -> Reason:
        part = cause.part
        if part is None:
            return Reason("holds what the parts bring")
        if life.tag == "frame" and life.attributes.get("childclass") == part.top_class:
            return Reason(
                f"carries the part `{part.called}` {place(part)}, and its default class", hung_at(part)
            )
        if life.tag == "frame":
            return Reason(
                f"the pose of the {part.place.kind} that the part `{part.called}` is attached to",
                hung_at(part),
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
            return Reason("written in the recipe, laid out for the whole model", owned(life.owner, None))
        if len(life.sources) > 1:
            return Reason(f"{len(life.sources)} keys of that name made one, laid out for the whole model")
        return Reason("laid out anew for the whole model")

    def _keyframes(self, change: Change, life: Life) -> Reason | None:
        return Reason("laid out anew for the whole model")

    def _settled(self, change: Change, life: Life) -> Reason | None:
        span = owned(change.owner, change.attribute)
        return Reason("written in the recipe, in the model's unit of angle", span)

    def _held(self, change: Change, life: Life) -> Reason | None:
        span = owned(change.owner, change.attribute)
        return Reason("computed: what holds the pose of the key", span)

    def _main(self, change: Change, life: Life) -> Reason | None:
        return Reason("`main` is called that here: the top class of the base")


def place(part: Part) -> str:
    """Return the place of a part in words."""
    where = part.place
    found = "in the world" if where.kind == "world" else f"on the {where.kind} `{where.name}`"
    return f"{found}, with an offset" if where.offset else found


def hung_at(part: Part) -> Span | None:
    return part.place.span or part.span


def _file(unit: Unit) -> str:
    """Return the file name of a unit; its folder is shown beside it."""
    return f"`{unit.file.rpartition('/')[2]}`"


def _sequence(cause: Cause) -> str | None:
    return None if cause.linking is None else cause.linking.base.settings.eulerseq


CHANGES: dict[Function | None, Callable[[PassWords, Change, Life], Reason | None]] = {
    names: PassWords._names,
    body_reduction: PassWords._reductions,
    angles: PassWords._angles,
    inertia: PassWords._inertia,
    fitting: PassWords._fitting,
    lengthranges: PassWords._lengthranges,
    submodel_options: PassWords._adopted,
    agreement: PassWords._agreement,
    files: PassWords._files,
    submodels: PassWords._files,
    add_file: PassWords._files,
    collect: PassWords._same_file,
    defaults: PassWords._defaults,
    compiler: PassWords._compiler,
    keyframes: PassWords._keyframes,
    settle_joints: PassWords._settled,
    hold_poses: PassWords._held,
    check_names: PassWords._main,
}

MADE: dict[Function | None, Callable[[PassWords, Life, Cause], Reason]] = {
    replicates: PassWords._unrolled,
    body_reduction: PassWords._reduced,
    inertia: PassWords._inertia_made,
    submodel_options: PassWords._adopted_made,
    agreement: PassWords._agreement_made,
    defaults: PassWords._defaults_made,
    bodies: PassWords._bodies_made,
    compiler: PassWords._compiler_made,
    keyframes: PassWords._keyframes_made,
    sections: PassWords._section_made,
}

VALUES: dict[Function | None, Callable[[PassWords, Life, Cause, str], Reason | None]] = {
    agreement: PassWords._agreement_value,
    bodies: PassWords._bodies_value,
    compiler: PassWords._compiler_value,
    defaults: PassWords._defaults_value,
}

GONE: dict[Function | None, Callable[[PassWords, Life, Cause], Reason]] = {
    body_reduction: PassWords._reduced,
    inertia: PassWords._inertia_made,
    roots: PassWords._weld,
}
