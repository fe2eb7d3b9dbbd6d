"""Verb `convert`: replace an actuator by another kind with the same behavior in MuJoCo, or report the losses."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, NoReturn

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Fault, Note, Path
from mjcompose.compose.actuators import INPUTS, PLUGIN, ActuatorModel, actuator_models
from mjcompose.compose.editing import Editing, is_limited_by_range
from mjcompose.compose.elements import pose_number
from mjcompose.compose.values import EntryValues, UnusableValue, report_unusable
from mjcompose.compose.verbs.values import Entry
from mjcompose.language.value import read_value
from mjcompose.language.verbs.convert import FROM, Convert
from mjcompose.link import numbers
from mjcompose.link.expansion import element_of
from mjcompose.link.keyframes import part_keys
from mjcompose.tree import journal
from mjcompose.tree.classes import levels
from mjcompose.tree.edit import unused_instances
from mjcompose.tree.grammar import GRAMMAR, Attribute, to_text
from mjcompose.tree.unit import texts

_PARAMETERS = ("gainprm", "biasprm", "dynprm")
# The meaning of an actuator's control, in words. An integrator turns a rate into the quantity that the gain is for.
_CONTROL = {"position": "a position", "velocity": "a velocity", "force": "a force"}
_CONTROL |= {f"rate of {form}": f"the rate of {words}" for form, words in _CONTROL.items()}
_PLAIN = {
    "gaintype": "fixed",
    "biastype": "none",
    "dyntype": "none",
    "gainprm": "1",
    "biasprm": "0",
    "dynprm": "1",
}
_GAINS = {"position": "kp", "pid": "kp", "velocity": "kv"}
# MuJoCo 4.0: "kv and dampratio cannot both be defined", and "ctrlrange and inheritrange cannot both be defined".
_INSTEAD = {
    "kv": ("dampratio",),
    "dampratio": ("kv",),
    "ctrlrange": ("inheritrange", "posrange"),
    "inheritrange": ("posrange",),
    "posrange": ("inheritrange",),
}
# Settings that no attribute of another kind expresses: they are lost if that kind has none of the same name.
_UNSAID = ("actrange", "actearly", "actdim")


def carry_out(verb: Convert, entry: Entry, at: Path) -> None:
    editing = entry.editing
    found = entry.found
    to = verb.to
    written = verb.written
    models = _models(editing, found)
    lost: dict[str, list[str]] = {}
    for index, node in enumerate(found):
        if (model := models.get(node)) is None:
            message = f"{editing.called(node)} cannot be converted: MuJoCo does not describe its behavior"
            report_unusable(editing, node, Fault("not-supported", message, at), it="it")
        given = _given(editing, node, index, to=to, model=model, written=written, at=at)
        was = editing.called(node)
        for loss in _converted(editing, node, to, model=model, given=given, at=at):
            lost.setdefault(loss, []).append(was)
    if lost:
        _report(editing, to, lost, at=at)


def _models(editing: Editing, found: list[Node]) -> dict[Node, ActuatorModel]:
    """Return the behavior of the actuators, which MuJoCo compiles once for consecutive conversions.

    A conversion changes the behavior of no other actuator. Raises `UnusableValue`.
    """
    known = editing.actuator_models
    if any(node not in known for node in found):
        everything: list[Node] = editing.root.findall("actuator/*")
        models = actuator_models(editing.linking, editing.sink, everything)
        if models is None:
            raise UnusableValue
        known.clear()
        known.update(models)
    return {node: model for node in found if (model := known.pop(node, None)) is not None}


def _given(
    editing: Editing, node: Node, index: int, to: str, model: ActuatorModel, written: Mapping[str, Any], at: Path
) -> dict[str, str]:
    """Return the attributes of the entry as text; the gear converts values that a recipe gives for the joint."""
    kind = GRAMMAR.element(f"actuator/{to}")
    values = EntryValues(editing, node, index, at=at)
    gear = _new_gear(values, written, model, at=at)
    found: dict[str, str] = {}
    for name, item in written.items():
        path = (*at, name)
        if name == "to":
            continue
        attribute = kind.attributes[name]
        if isinstance(item, str) and item.startswith(FROM):
            source = item.removeprefix(FROM)
            text = editing.effective(node, source)
            if not text or not any(numbers.read(text)):
                message = f"{editing.called(node)} has no `{source}`"
                help = f"write `{name}: …` with its values"
                report_unusable(editing, node, Fault("missing-key", message, path, help=help))
            found[name] = str(text)
            continue
        if name == "inheritrange" and gear != 1 and item:
            # MuJoCo 4.0 gives the range of the joint to the control, which the gear multiplies.
            message = f"the control of {editing.called(node)} is {gear:g} times the position that `inheritrange` limits"
            help = "write `ctrlrange`, with the joint's range"
            report_unusable(editing, node, Fault("not-supported", message, path, help=help))
        power = 0 if to == "general" else _POWERS.get(name, 0) or (_OF_CONTROL[to] if name == "ctrlrange" else 0)
        if power:
            _check_axes(values, written, model, at=path)
        old = GRAMMAR.element(f"actuator/{node.tag}").attributes.get(name)
        now = values.now(old) if old is not None else None
        if now is not None and power and not isinstance(now, str):
            now = _geared(now, model.gear or 1.0, -power)
        faults: list[Fault] = []
        read = read_value(
            attribute, values.of(item, path, now), path, owner=editing.called(node), faults=faults, tag=to
        )
        for fault in faults[:1]:
            report_unusable(editing, node, fault)
        found[name] = _text(attribute, read, gear, power=power)
    return found


# The numbers of an entry describe the joint, as with `datasheet`. The force of an actuator moves the joint `gear`
# times as strong, and its length is `gear` times the position of the joint: the power of the gear by which to multiply.
_POWERS = {
    "kp": -2,
    "kv": -2,
    "ki": -2,
    "forcerange": -1,
    "ffrange": -1,
    "posrange": 1,
    "velrange": 1,
    "slewmax": 1,
    "imax": 1,
}
_ROUNDING = 1e-6
_OF_CONTROL = {"position": 1, "velocity": 1, "pid": 1, "motor": -1}


def _new_gear(values: EntryValues, written: Mapping[str, Any], model: ActuatorModel, at: Path) -> float:
    """Return the gear of the new actuator, which the entry may give; 1 if none moves a joint along one axis."""
    if (given := written.get("gear")) is None or not model.gear:
        return model.gear or 1.0
    first = values.of(given, (*at, "gear"))
    first = first[0] if isinstance(first, list | tuple) else first
    return float(first) if isinstance(first, int | float) and first else 1.0


def _check_axes(values: EntryValues, written: Mapping[str, Any], model: ActuatorModel, at: Path) -> None:
    """Report a number for an actuator that acts along or about an axis with a gear that is not of length 1."""
    axes = values.of(written["gear"], (*at[:-1], "gear")) if "gear" in written and model.axes else model.axes
    axes = axes if isinstance(axes, list | tuple) else (axes,)
    if not model.axes or model.gain == "so3" or not all(isinstance(each, int | float) for each in axes):
        return
    if abs(math.hypot(*axes) - 1) > _ROUNDING:
        called = values.editing.called(values.node)
        shown = numbers.text(axes).removesuffix(" 0" * (len(axes) - 3))
        message = f"`{at[-1]}` describes a joint with one axis, and {called} acts through the gear `{shown}`"
        help = "write a `gear` of length 1 next to it, or convert it to `general`, whose numbers are the actuator's"
        report_unusable(values.editing, values.node, Fault("not-supported", message, at, help=help))


def _geared(value: Any, gear: float, power: int) -> Any:
    """Return a size, which has no sign, or the ends of a range in their order, times a power of the gear."""
    ends = value if isinstance(value, tuple) else (value,)
    by = gear if len(ends) > 1 else abs(gear)
    found = tuple(sorted(each * by**power if power > 0 else each / by**-power for each in ends))
    return found if isinstance(value, tuple) else found[0]


def _text(attribute: Attribute, value: Any, gear: float, power: int) -> str:
    if attribute.is_number:
        found = [pose_number(each) for each in (value if isinstance(value, tuple) else (value,))]
        return numbers.text(_geared(tuple(found), gear, power) if power and gear != 1 else found)
    return to_text(attribute, value)


def _converted(
    editing: Editing, node: Node, to: str, model: ActuatorModel, given: Mapping[str, str], at: Path
) -> list[str]:
    old = str(node.tag)
    kind = GRAMMAR.element(f"actuator/{to}")
    made: dict[str, str] = {}
    lost: list[str] = []
    if old != to:
        made, lost = _written_for(editing, node, to, model=model, given=given, at=at)
    before = after = model.control
    if old != to or "input" in given:
        after = _control_of(to, model, {**made, **given})
    if before != after:
        lost.append(_other_control(before, after, model, given))
    limits: dict[str, str] | None = {}
    if old != to or any(name in given for name in _POSITION_LIMITS):
        keeps = before.split("+")[0] == after.split("+")[0]
        limits = _limits(editing, node, to, model=model, keeps=keeps, written={**made, **given})
    if limits is None:
        lost.append("`ctrlrange`, which limits something else")
        # The range goes, but a class may still limit the control: with `ctrllimited="true"` and no range, MuJoCo 4.0
        # says "invalid control range for actuator".
        limits = {"ctrllimited": "false"}
        journal.drop(node, "ctrlrange")
    wrong = [name for name in map(str, node.keys()) if name not in kind.attributes]
    if "body" in wrong or "orientation" in wrong:
        message = f"{editing.called(node)} acts on a body, which a `{to}` cannot"
        report_unusable(editing, node, Fault("wrong-type", message, at))
    lost += _lost_attributes(to, model, wrong)
    if old != to and not _keeps_activation(to, {**made, **given}):
        _refuse_actrange(editing, node, to, at=at)
    limits |= _switches(editing, node, given)
    _rewrite(editing, node, to, written={**limits, **made, **given}, wrong=wrong)
    _note_places(editing, node, given, made, at)
    if before != after:
        lost += _lost_in_keys(editing, node)
        editing.linking.keys.void_keys.add(node)
    return lost


def _other_control(before: str, after: str, model: ActuatorModel, given: Mapping[str, str]) -> str:
    """Return in words that the control is another quantity now."""
    is_now = _in_words(after, "another thing")
    was = _in_words(before, "what it was")
    gear = abs(numbers.first(given["gear"])) if "gear" in given else abs(model.gear)
    if model.gear and gear != 1 and after not in ("force", "other"):
        is_now += f" ({gear:g} times the {_CONTROL[after.split('+')[0]].partition(' ')[2]} of its joint or tendon)"
    return f"the control is {is_now} now, not {was}"


def _note_places(editing: Editing, node: Node, given: Mapping[str, str], made: Mapping[str, str], at: Path) -> None:
    """Note the places in the recipe of the attributes that the entry gives, and of those that were made for it."""
    editing.write(node, {name: (*at, name) for name in given} | {name: at for name in made if name not in given})
    attributes = GRAMMAR.element(f"actuator/{node.tag}").attributes
    for name in given:
        if attributes[name].is_interval:
            editing.making.intervals[node, name] = editing.span((*at, name))


def _switches(editing: Editing, node: Node, given: Mapping[str, str]) -> dict[str, str]:
    """Return the words that turn on the limits of force and activation that the entry gives."""
    found = {}
    for name, switch in (("forcerange", "forcelimited"), ("actrange", "actlimited")):
        if name in given and any(numbers.read(given[name])) and not is_limited_by_range(editing, node, switch):
            found[switch] = "true"
    return found


def _lost_attributes(to: str, model: ActuatorModel, wrong: list[str]) -> Iterator[str]:
    """Yield in words the settings that the new kind lacks. `wrong` are the attributes that it does not have."""
    yield from (f"`{name}`" for name in wrong if name in _UNSAID and (model.act_limited or name != "actrange"))
    if to not in ("general", "pid"):
        yield from (f"`{name}range`" for name in model.limited[1:] if name)
    if model.gain == "so3" and to != "general":
        yield "that it acts about all three axes: it acts along its `gear` now"


def _rewrite(editing: Editing, node: Node, to: str, written: Mapping[str, str], wrong: list[str]) -> None:
    """Change the actuator to the new kind with these attributes, without attributes that this kind cannot have."""
    editing.forget(node)
    instance = node.get("instance")
    for name in dict.fromkeys((*wrong, *_replaced(written))):
        journal.drop(node, name)
    if node.tag == PLUGIN:
        for child in list(node):  # its `<config>`
            journal.remove(child)
        for each in unused_instances(editing.root, [str(instance)] if instance else []):
            journal.remove(each)
    journal.retag(node, to)
    journal.write_all(node, written)
    editing.note(node)


def _lost_in_keys(editing: Editing, node: Node) -> Iterator[str]:
    """Yield in words the keyframe values of a control or activation whose meaning changes."""
    found = [key for part in part_keys(editing.linking).values() for key in part.keys]
    for vector in ("ctrl", "act"):
        names = {
            f"`{key.name}`" if key.name else "without a name": None
            for key in found
            for holder, row in key.values.get(vector, {}).items()
            if element_of(holder) is node and any(numbers.read(" ".join(texts(row))))
        }
        if names:
            keys = f"the key{'s' * (len(names) > 1)} {', '.join(names)}"
            yield f"its `{vector}` in {keys}: it is zero now"


def _keeps_activation(to: str, written: Mapping[str, str]) -> bool:
    """Return whether the new kind has an activation, which an `actrange` can limit."""
    # MuJoCo 4.0 refuses the range of an activation that does not exist: "actrange specified but dyntype is 'none'".
    with_activation = {"position": ("timeconst",), "pid": ("ki", "slewmax")}.get(to, ())
    return to == "general" or any(any(numbers.read(written.get(name, "0"))) for name in with_activation)


def _refuse_actrange(editing: Editing, node: Node, to: str, at: Path) -> None:
    """Report an `actrange` of a class, which nothing undoes, for an actuator without an activation."""
    kind = GRAMMAR.element("actuator/general")
    found = levels(node, kind, kind.attributes["actrange"], classes=editing.classes)
    level = next((each for each in found if each.kind == "class" and each.text), None)
    if level is not None and any(numbers.read(str(level.text))):
        message = f"a `{to}` cannot have the `actrange` that the class `{level.name}` gives {editing.called(node)}"
        help = "write the `actrange` on the actuators, or remove it from the class with `actrange: null` in `set`"
        report_unusable(editing, node, Fault("wrong-type", message, at, help=help))


def _replaced(written: Mapping[str, str]) -> Iterator[str]:
    """Yield the attributes that are not allowed together with the written attributes."""
    for name, others in _INSTEAD.items():
        if name in written:
            yield from (other for other in others if other not in written)


def _written_for(
    editing: Editing, node: Node, to: str, model: ActuatorModel, given: Mapping[str, str], at: Path
) -> tuple[dict[str, str], list[str]]:
    """Return the attributes that give the new kind the same model, and its losses in words."""
    if to == "general":
        return _general(editing, node, model), [_gain_and_bias(model)] if model.gain == PLUGIN else []
    lost: list[str] = _lost_with(to, model)
    if to == "motor":
        return {}, [*lost, *_lost_by_motor(model)]
    if to in ("position", "pid"):
        if model.form not in ("position", "velocity", "force") and model.gain != "pid":
            lost.append(_gain_and_bias(model))
        return _position(editing, node, to, model=model, given=given, at=at), lost
    made: dict[str, str] = {}
    if "kv" not in given:
        if not (model.is_affine or model.gain == "pid") or model.kv <= 0:
            _needs(editing, node, to, gain=_GAINS[to], at=at)
        made["kv"] = numbers.text([model.kv])
    if model.kp:
        lost.append(f"its position gain, {model.kp:g}")
    elif model.form == "other":
        lost.append(_gain_and_bias(model))
    return made, lost


def _lost_with(to: str, model: ActuatorModel) -> list[str]:
    """Return in words the dynamics and the integral term that the new kind cannot have."""
    lost = []
    is_pid = model.gain == "pid"
    # A pid has its dynamics by itself; `timeconst` of a position actuator is `filterexact`.
    kept = is_pid or model.dynamics == "none" or (to == "position" and model.dynamics == "filterexact")
    if model.dynamics and not kept:
        lost.append(f"its dynamics, `{model.dynamics}`")
    if is_pid and to != "pid":
        ki = model.gainprm[0]
        slewmax = model.slewmax
        lost += [f"its integral gain, {ki:g}"] if ki else []
        lost += [f"its slew rate, {slewmax:g}"] if slewmax else []
    return lost


def _lost_by_motor(model: ActuatorModel) -> list[str]:
    """Return in words the parts of the model that a motor, whose force is its control, does not have."""
    if model.form != "force" or model.kp or model.kv:
        return [_gain_and_bias(model)]
    if model.gainprm[0] != 1 and model.gain != "pid":
        return [f"its gain of {model.gainprm[0]:g}"]
    return []


def _position(
    editing: Editing, node: Node, to: str, model: ActuatorModel, given: Mapping[str, str], at: Path
) -> dict[str, str]:
    """Return the attributes of a `position` or a `pid`, without those that are given."""
    made: dict[str, str] = {}
    if "kp" not in given:
        if not _has_kp(model, to):
            _needs(editing, node, to, gain=_GAINS[to], at=at)
        made["kp"] = numbers.text([model.kp])
    if "kv" not in given and "dampratio" not in given:
        # Written also if it is 0: a class may give another one.
        ratio = _dampratio(editing, node)
        made |= {"dampratio": ratio} if ratio else {"kv": numbers.text([max(model.kv, 0.0)])}
    if to == "position":
        return made | _timeconst(editing, model, given)
    return made | _only_of_pid(editing, model, given)


def _has_kp(model: ActuatorModel, to: str) -> bool:
    """Return whether a model has a position gain that the new kind can take over, which may be 0 for a `pid`."""
    is_pid = model.gain == "pid"
    if to == "pid" and (is_pid or model.form == "velocity"):
        return True
    return (model.is_affine or is_pid) and model.kp > 0


def _timeconst(editing: Editing, model: ActuatorModel, given: Mapping[str, str]) -> dict[str, str]:
    """Return the time constant of a `position`, which is written as 0 only if a class may give another one."""
    if "timeconst" in given:
        return {}
    text = numbers.text(model.dynprm[:1]) if model.dynamics == "filterexact" else "0"
    return {} if text == "0" and not _in_classes(editing) else {"timeconst": text}


def _only_of_pid(editing: Editing, model: ActuatorModel, given: Mapping[str, str]) -> dict[str, str]:
    """Return the attributes of a `pid` that a `position` does not have."""
    is_pid = model.gain == "pid"
    made: dict[str, str] = {}
    # Without it a pid has two controls, position and velocity: `<pid joint="j" kp="1"/>` makes `nu` 2 in MuJoCo 4.0.
    if "input" not in given and (is_pid or model.form in ("position", "velocity")):
        made["input"] = " ".join(model.inputs) or ("pos" if model.form == "position" else "vel")
    if is_pid:
        imax = model.dynprm[0] if model.dynamics == "pid" else 0.0
        whole = _in_classes(editing)
        gains = {"ki": model.gainprm[0], "imax": imax, "slewmax": model.slewmax}
        made |= {name: numbers.text([value]) for name, value in gains.items() if value or whole}
    return made


def _in_classes(editing: Editing) -> bool:
    """Return whether a class may set attributes of an actuator. All actuator tags share these settings."""
    # In MuJoCo 4.0 `<default><position kp="50"/></default>` gives a `<general joint="j"/>` a gain of 50, so an
    # attribute that is not written need not be zero.
    tags = tuple(GRAMMAR.section("actuator").children)
    return any(True for section in editing.root.iterchildren("default") for _ in section.iter(*tags))


def _dampratio(editing: Editing, node: Node) -> str | None:
    """Return the damping ratio of a servo. Its `kv` follows from the inertia in the whole model, also after `convert`.

    In MuJoCo 4.0, `biasprm="0 -30 0.7"` of a `general` is the damping ratio 0.7, since 0.7 is positive.
    """
    text = (
        editing.effective(node, "dampratio")
        if "dampratio" in GRAMMAR.element(f"actuator/{node.tag}").attributes
        else None
    )
    return text if text and numbers.first(text) > 0 else None


def _general(editing: Editing, node: Node, model: ActuatorModel) -> dict[str, str]:
    """Return all attributes of the model, without trailing zeros unless classes may set some numbers."""
    whole = _in_classes(editing)
    laws = ("fixed", "none") if model.gain == PLUGIN else (model.gain, model.bias)
    made = {"gaintype": laws[0], "biastype": laws[1], "dyntype": model.dynamics}
    ratio = _dampratio(editing, node)
    for name in _PARAMETERS:
        values = list(getattr(model, name))
        if name == "biasprm" and ratio:
            values[2] = numbers.first(ratio)
        while not whole and len(values) > 1 and values[-1] == 0:
            values.pop()
        made[name] = numbers.text(values)
    if not whole:
        made = {name: text for name, text in made.items() if _PLAIN[name] != text}
    if model.act_early:
        made["actearly"] = "true"
    if model.act_limited:
        made |= {"actlimited": "true", "actrange": numbers.text(model.actrange)}
    return made


def _limits(
    editing: Editing, node: Node, to: str, model: ActuatorModel, keeps: bool, written: Mapping[str, str]
) -> dict[str, str] | None:
    """Return the limits of the new control, or None if the old ones limit another quantity and must be removed."""
    inherits = editing.effective(node, "inheritrange") not in (None, "") and to in ("position", "pid")
    of_range = {"inheritrange": "0"} if inherits and _in_classes(editing) else {}
    limited = editing.effective(node, "ctrllimited")
    if any(any(numbers.read(written.get(name, "0"))) for name in _POSITION_LIMITS):
        return _limited_anew(editing, node, written, of_range)
    inputs = written.get("input", "").split() if to == "pid" else model.inputs if to == "general" else ()
    by_input = bool(inputs) and inputs[0] != "pos"  # MuJoCo reads `ctrlrange` for positions only
    if by_input and model.inputs[:1] == tuple(inputs[:1]):
        return {}  # `velrange` and `ffrange` say it already
    if not model.ctrl_limited:
        return _unlimited(editing, node, to, limited=limited)
    if not keeps:
        return None
    journal.drop(node, "inheritrange")
    if by_input:
        for name in ("ctrlrange", "ctrllimited"):
            journal.drop(node, name)
        # With no range of its own MuJoCo refuses a `ctrllimited` of a class, and `velrange` limits in any case.
        by_class = {"ctrllimited": "false"} if editing.effective(node, "ctrllimited") == "true" else {}
        return of_range | by_class | {f"{inputs[0]}range": numbers.text(model.ctrlrange)}
    limits = of_range
    range_now = editing.effective(node, "ctrlrange")
    if not range_now or numbers.read(range_now) != list(model.ctrlrange):
        limits["ctrlrange"] = numbers.text(model.ctrlrange)  # it came from the range of its joint
    if limited != "true" and editing.linking.flat().settings.autolimits == "false":
        limits["ctrllimited"] = "true"
    return limits


# Each of these limits the control of a position servo, unless `ctrllimited` is false.
_POSITION_LIMITS = ("ctrlrange", "posrange", "inheritrange")


def _limited_anew(editing: Editing, node: Node, written: Mapping[str, str], of_range: dict[str, str]) -> dict[str, str]:
    """Return the attributes that let the limits of the entry hold, and remove the older limit."""
    limits = {} if "inheritrange" in written else of_range
    if "ctrlrange" not in written:
        journal.drop(node, "ctrlrange")
    # In MuJoCo 4.0, `<position joint="j" inheritrange="1" ctrllimited="false"/>` has a range and no limit.
    return limits | ({} if is_limited_by_range(editing, node, "ctrllimited") else {"ctrllimited": "true"})


def _unlimited(editing: Editing, node: Node, to: str, limited: str | None) -> dict[str, str]:
    """Return attributes that keep an actuator's control unlimited if the new kind would read a range."""
    found: dict[str, str] = {}
    inherits = editing.effective(node, "inheritrange")
    if to in ("position", "pid") and inherits and any(numbers.read(inherits)):
        journal.drop(node, "inheritrange")
        found |= {"inheritrange": "0"} if _in_classes(editing) else {}
    # MuJoCo takes `inheritrange` for limits of the control as well: of a joint with `range="0 90"` in degrees,
    # `inheritrange="1"` gives a `ctrlrange` of 0 1.5708 in 4.0.
    if limited != "false" and editing.effective(node, "ctrlrange"):
        journal.drop(node, "ctrlrange")
        found |= {"ctrllimited": "false"} if _in_classes(editing) else {}
    return found


def _control_of(to: str, model: ActuatorModel, written: Mapping[str, str]) -> str:
    if to == "general":
        return model.control
    if to == "pid":
        return "+".join(INPUTS[each] for each in written.get("input", "pos vel").split())
    return "force" if to == "motor" else to


def _in_words(control: str, otherwise: str) -> str:
    return " and ".join(_CONTROL[each] for each in control.split("+")) if control != "other" else otherwise


def _gain_and_bias(model: ActuatorModel) -> str:
    if model.gain == PLUGIN:
        return "its plugin, which computes the force"
    if model.form == "position" or model.gain == "pid":
        return f"its gains, kp {model.kp:g} and kv {model.kv:g}"
    if model.form == "velocity":
        return f"its gain, kv {model.kv:g}"
    return f"its own gain and bias (`{model.gain}`, `{model.bias}`)"


def _needs(editing: Editing, node: Node, to: str, gain: str, at: Path) -> NoReturn:
    what = "position gain" if gain == "kp" else "velocity gain"
    message = f"{editing.called(node)} has no {what} that a `{to}` could take over"
    report_unusable(editing, node, Fault("missing-key", message, at, help=f"write `{gain}: …` next to `to: {to}`"))


def _report(editing: Editing, to: str, lost: Mapping[str, list[str]], at: Path) -> None:
    count = len({each for names in lost.values() for each in names})
    what = next(iter(lost.values()))[0] if count == 1 else f"{count} actuators"
    few = {loss: f" ({', '.join(names[:8])}{', …' * (len(names) > 8)})" for loss, names in lost.items()}
    notes = [Note(f"lost: {loss}{few[loss] * (len(names) != count)}") for loss, names in lost.items()]
    message = f"{what} cannot do everything that {'it' if count == 1 else 'they'} did as `{to}`"
    editing.sink.warning("convert-loss", message, editing.span(at), notes=notes)
