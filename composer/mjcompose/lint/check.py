"""The check `lint`: rules that most models should keep."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from mjcompose.base.diagnostic import Fault
from mjcompose.base.extensions import check_rows
from mjcompose.base.report import with_rest
from mjcompose.language.checks.lint import (
    RULES,
    InertiaImplausible,
    JointUnactuated,
    KeyOutOfRange,
    Lint,
    RuleSettings,
    ShapeOffMesh,
)
from mjcompose.lint.rule import Subject, rules, subject_of
from mjcompose.mujoco.arrays import HINGE, SLIDE
from mjcompose.mujoco.solids import Shapes, faults, largest_volume
from mjcompose.verify.checks.check import (
    CheckEnds,
    Scope,
    ShapeErrors,
    at_keys,
    check_globs,
    failed,
    keys_named,
    names_nothing,
)

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

Globs = Sequence[str]


def chosen(scope: Scope, kind: str, globs: Globs, ignored: Globs, usual: Iterable[int]) -> list[int]:
    """Return the elements that the globs of a setting name, by default the usual ones, without ignored ones."""
    check_globs(scope, (kind,), globs, at=(kind,))
    named = dict.fromkeys(each for glob in globs for each in scope.matching(kind, glob)) if globs else usual
    left_out = elements_ignored(scope, (kind,), ignored)
    return [each for each in named if (kind, each) not in left_out]


def elements_ignored(scope: Scope, kinds: Sequence[str], ignored: Globs) -> set[tuple[str, int]]:
    """Return the elements of these kinds that `except` names. Raises CheckEnds for a glob that matches nothing."""
    check_globs(scope, kinds, ignored, at=("except",))
    return {(kind, each) for glob in ignored for kind in kinds for each in scope.matching(kind, glob)}


def listed(lines: Sequence[str], expected: str, actual: str, *at: str | int) -> list[Fault]:
    """Return one finding for lines, the first of them as its message; nothing without lines."""
    if not lines:
        return []
    first, *more = with_rest(lines)
    return [failed(first, expected, actual, *at, more=more)]


def inertia_implausible(scope: Scope, rule: InertiaImplausible, ignored: Globs) -> list[Fault]:
    """Report masses and inertias that the geoms of a body cannot have."""
    shapes = Shapes(scope.mujoco, scope.model)
    named = chosen(scope, "body", rule.body, ignored, usual=scope.own("body"))
    bodies = [each for each in named if each and scope.model.body_mass[each] > 0 and shapes.welded(each)]
    wrong = [
        f"{scope.called('body', body)}: {fault}" for body in bodies for fault in _faults(scope, shapes, body, rule)
    ]
    scope.found("bodies", len(bodies))
    scope.found("implausible", len(wrong))
    actual = f"{len(wrong)} fault{'s' * (len(wrong) > 1)} in {len(bodies)} bodies"
    return listed(wrong, "masses and inertias that the geoms could have", actual)


def _faults(scope: Scope, shapes: Shapes, body: int, rule: InertiaImplausible) -> Iterator[str]:
    yield from faults(shapes, body, gyration=rule.gyration, outside=rule.outside)
    own = shapes.own(body)
    if rule.density is None or not own:
        return
    mass = float(scope.model.body_mass[body])
    volume = largest_volume(scope.mujoco, scope.model, own)
    low, high = rule.density
    weighs = f"it weighs {mass:.4g} kg, which is {{:.4g}} kg/m³ of the volume of its geoms, {{}}"
    if volume.most > 0 and mass / volume.most > high:
        yield weighs.format(mass / volume.most, f"above {high:g}")
    elif volume.least > 0 and mass / volume.least < low:
        yield weighs.format(mass / volume.least, f"below {low:g}")


def joint_unactuated(scope: Scope, rule: JointUnactuated, ignored: Globs) -> list[Fault]:
    """Report joints that no actuator moves."""
    model = scope.model
    single = (joint for joint in scope.own("joint") if int(model.jnt_type[joint]) in (HINGE, SLIDE))
    joints = chosen(scope, "joint", rule.joint, ignored, usual=single)
    moved = _moved(scope.mujoco, model)
    without = [joint for joint in joints if joint not in moved]
    scope.found("joints", len(joints))
    lines = [f"{scope.called('joint', joint)} has no actuator" for joint in without]
    return listed(lines, f"{len(joints)} joints moved", f"{len(joints) - len(without)}")


def _moved(mujoco: Any, model: MjModel) -> set[int]:
    """Return the joints that an actuator moves in the reference configuration, directly or through an equality."""
    import numpy as np

    data = mujoco.MjData(model)
    mujoco.mj_fwdPosition(model, data)
    dofs = set(np.asarray(data.moment_colind[: int(np.sum(data.moment_rownnz))]).tolist())
    moved = {int(model.dof_jntid[dof]) for dof in dofs}
    is_joint = (model.eq_type == int(mujoco.mjtEq.mjEQ_JOINT)) & (model.eq_obj2id >= 0)
    coupled = list(zip(model.eq_obj1id[is_joint].tolist(), model.eq_obj2id[is_joint].tolist(), strict=True))
    for _ in coupled:
        for one, other in coupled:
            if one in moved or other in moved:
                moved |= {one, other}
    return moved


def key_out_of_range(scope: Scope, rule: KeyOutOfRange, ignored: Globs) -> list[Fault]:
    """Report positions, controls and activations of keyframes that are outside their ranges."""
    from mjcompose.mujoco.index import index, ranged

    keys = keys_named(scope, rule.key)
    left_out = elements_ignored(scope, rule.kinds, ignored)
    outside: list[str] = []
    count = 0
    compiled = index(scope.model, scope.mujoco)
    for name, data in at_keys(scope, keys):
        for value in ranged(compiled, {"qpos": data.qpos, "ctrl": data.ctrl, "act": data.act}):
            if (value.kind, value.number) in left_out or not scope.owns(value.kind, value.number):
                continue
            count += 1
            if not value.is_within(rule.margin):
                low, high = value.range
                unit = f" {value.unit}" if value.kind == "joint" else ""
                where = f"`{value.vector}` of {scope.called(value.kind, value.number)} in `{name}`"
                number = f"{value.value:.6g}{unit}"
                outside.append(f"{where} is {number}, and its range is from {low:.6g} to {high:.6g}")
    scope.found("values", count)
    ends = f", {rule.margin:g} from both ends" if rule.margin else ""
    return listed(outside, f"all within their ranges{ends}", f"{len(outside)} outside")


_LENGTHS = {
    "hausdorff": "is {} m off",
    "beyond": "reaches {} m out of the mesh",
    "short": "leaves the mesh {} m outside",
}
Named = tuple[str, ShapeErrors]
"""The errors of the shapes of a mesh, with its name as the recipe writes it."""


def shape_off_mesh(scope: Scope, rule: ShapeOffMesh, ignored: Globs) -> list[Fault]:
    """Report shapes that are farther off their meshes than the rule allows."""
    meant = _meant(scope, rule, ignored)
    if not meant:
        return [failed("no `collision` or `simplify` made anything of a mesh", "at least one mesh", "none")]
    scope.found("meshes", len(meant))
    findings: list[Fault] = []
    for measure, words in _LENGTHS.items():
        lengths = [(float(getattr(errors, measure)), name) for name, errors in meant]
        scope.found(measure, max(lengths)[0])
        most = rule.shortfall if measure == "short" else getattr(rule, measure)
        if most is not None:
            wrong = [each for each in lengths if each[0] > most]
            findings += _failed(wrong, words, f"at most {most:g} m", measure=measure)
    covered = [(errors.uncovered, name) for name, errors in meant if errors.uncovered is not None]
    if covered:
        scope.found("uncovered", max(covered)[0])
    if rule.uncovered is not None:
        wrong = [each for each in covered if each[0] > rule.uncovered]
        findings += _failed(
            wrong, "leaves {} of the surface outside", f"at most {rule.uncovered:g}", measure="uncovered"
        )
    if rule.volume is not None:
        findings += _volumes(meant, *rule.volume)
    return findings


def _meant(scope: Scope, rule: ShapeOffMesh, ignored: Globs) -> list[Named]:
    """Return the meshes that the rule is about. Raises CheckEnds for a glob of which nothing was made."""
    made = [
        (errors.mesh.removeprefix(scope.prefix), errors)
        for errors in scope.facts.shapes
        if errors.mesh.startswith(scope.prefix)
    ]
    names = [name for name, _ in made]
    fitting: dict[str, set[str]] = {}
    for key, globs in (("mesh", rule.mesh), ("except", ignored)):
        fitting[key] = set()
        for at, glob in enumerate(globs):
            fits = scope.fitting(glob, names)
            if not fits:
                message = f"nothing was made of a mesh `{glob}`"
                raise names_nothing(message, glob, "mesh", known=sorted(set(names)), at=(key, at))
            fitting[key] |= fits
    wanted = fitting["mesh"] or set(names)
    return [each for each in made if each[0] in wanted and each[0] not in fitting["except"]]


def _volumes(meant: list[Named], low: float, high: float) -> list[Fault]:
    expected = f"{low:g} to {high:g}"
    open_ones = [name for name, errors in meant if errors.volume is None]
    if open_ones:
        message = f"the mesh `{open_ones[0]}` is open: it has no volume to compare with"
        more = [f"so is `{name}`" for name in open_ones[1:8]]
        help = "close the meshes, or name the others by `mesh`"
        return [failed(message, expected, "unknown", "volume", more=more, help=help)]
    volumes = [(errors.volume, name) for name, errors in meant if errors.volume is not None]
    wrong = [each for each in volumes if not low <= each[0] <= high]
    return _failed(wrong, "has {} of the volume", expected, measure="volume")


def _failed(wrong: list[tuple[float, str]], words: str, expected: str, measure: str) -> list[Fault]:
    ranked = sorted(wrong, reverse=True)
    lines = [f"the shape of `{name}` {words.format(f'{value:.4g}')}" for value, name in ranked]
    return listed(lines, expected, f"{ranked[0][0]:.4g}" if ranked else "", measure)


_EFFECTS: Mapping[type[RuleSettings], Callable[[Scope, Any, Globs], list[Fault]]] = {
    InertiaImplausible: inertia_implausible,
    JointUnactuated: joint_unactuated,
    KeyOutOfRange: key_out_of_range,
    ShapeOffMesh: shape_off_mesh,
}
"""How to carry out each rule with settings. It gets the rule's form, and the globs of elements that it ignores."""
check_rows("the rules with settings that composer/mjcompose/lint/check.py carries out", _EFFECTS, RULES.values())


def check(scope: Scope, lint: Lint) -> list[Fault]:
    """Report the findings of the selected rules, each at its rule."""
    findings: list[Fault] = []
    subject = subject_of(scope.facts.text, scope.mujoco, scope.model)
    ignored = lint.ignored
    for word, rule in lint.selected.items():
        globs = ignored.get(word, ())
        if globs is None:
            continue
        values = dict(scope.values)
        try:
            found = _plain(word, subject, scope) if rule is None else _EFFECTS[type(rule)](scope, rule, globs)
        except CheckEnds as end:
            found = [end.fault]
        findings += [_at_rule(fault, word, has_settings=rule is not None) for fault in found]
        named = {key if key in values else f"{word} {key}": value for key, value in scope.values.items()}
        scope.values.clear()
        scope.values.update(named)
    return findings


def _at_rule(fault: Fault, word: str, has_settings: bool) -> Fault:
    """Return a finding of a rule with its place in the check and, if the model breaks the rule, with a help."""
    key, *below = fault.at if fault.at[:1] == ("except",) else ("select", *fault.at)
    fault = replace(fault, at=(key, word, *below))
    if fault.code != "check-failed":
        return fault
    accepts = f"{{{word}: [NAME]}}" if has_settings else f"[{word}]"
    help = fault.help or f"fix it, or write `except: {accepts}` to accept it"
    return replace(fault, message=f"{fault.message} ({word})", help=help)


def _plain(code: str, subject: Subject, scope: Scope) -> list[Fault]:
    """Return the finding of a rule of the linter about the elements of the recipe."""
    lines = []
    for finding in rules()[code].run(subject):
        near = finding.element if finding.element is not None else subject.root
        name = next((str(each.get("name")) for each in (near, *near.iterancestors()) if each.get("name")), "")
        if scope.whole or (name.startswith(scope.prefix) and not name.startswith(tuple(scope.others))):
            lines.append(finding.message)
    scope.found("findings", len(lines))
    return listed(lines, "no findings", str(len(lines)))
