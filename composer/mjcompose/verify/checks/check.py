"""The common code of checks: scope, keyframes, words, failures."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, field, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any

from mjcompose import homes
from mjcompose.base.dataclass import Struct, dataclass
from mjcompose.base.diagnostic import Fault, Note, Path
from mjcompose.base.extensions import ExtensionTable
from mjcompose.base.suggest import did_you_mean, exists_note, unknown_name
from mjcompose.language.check import KINDS
from mjcompose.language.checks.expect import SUBTREE_MASS, Number, naming
from mjcompose.language.forms.context import Settings
from mjcompose.mujoco.arrays import JOINT_TYPES, words
from mjcompose.mujoco.attributes import ANGLES, ENUMERATED, ON_BODIES, NameTable, array_of, holder, name_table
from mjcompose.tree.name_order import NameOrder
from mjcompose.tree.pattern import BadPattern, fitter, is_pattern, literals_of
from mjcompose.tree.values import is_in_degrees

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel


def failed(
    message: str, expected: str, actual: str, *at: str | int, more: Iterable[str] = (), help: str | None = None
) -> Fault:
    """Return a finding with the expected and the actual value; `at` is the value's place below the check's kind."""
    notes = (f"expected: {expected}", f"actual: {actual}", *more)
    return Fault("check-failed", message, at, notes=tuple(map(Note, notes)), help=help)


def beside(value: float, *bounds: float, digits: int = 4) -> str:
    """Return a number with enough digits to distinguish it from the bounds, but at least `digits`.

    >>> beside(0.05, 0.001), beside(0.00100002, 0.001), beside(0.001, 0.001)
    ('0.05', '0.00100002', '0.001')
    """
    for count in range(digits, 17):
        text = f"{value:.{count}g}"
        if all(float(text) != bound for bound in bounds if bound != value):
            return text
    return repr(value)


class CheckEnds(Exception):
    def __init__(self, fault: Fault) -> None:
        super().__init__(fault.message)
        self.fault = fault


def unknown(kind: str, name: str, known: Iterable[str], *at: str | int) -> Fault:
    """Return a finding for an unknown name. `known` are the existing names as the recipe would write them."""
    found = unknown_name(kind, name, [each for each in known if each])
    return Fault(found.code, found.message, at, notes=found.notes, help=found.help)


def to_json(fault: Fault) -> dict[str, Any]:
    """Return the fields that a check may set; the recipe's side fills in the others."""
    return {name: value for name, value in asdict(fault).items() if name in _FIELDS}


def from_json(data: dict[str, Any]) -> Fault:
    """Return the fault that `to_json` turned into data."""
    return Fault(**{**data, "at": tuple(data["at"]), "notes": tuple(Note(each["message"]) for each in data["notes"])})


_FIELDS = ("code", "message", "at", "notes", "help")


class WorldPlace(Struct):
    """The place of a recipe's world in the model: a body, or None for the world of the model, and the pose in it."""

    body: str | None
    pos: Sequence[float]
    quat: Sequence[float]


class ShapeErrors(Struct):
    """How far the shapes that were made of a mesh are off it, as `mjcompose.mujoco.fit` measures it."""

    mesh: str
    hausdorff: float
    beyond: float
    short: float
    uncovered: float | None
    volume: float | None

    @classmethod
    def of(cls, mesh: str, error: Mapping[str, Any]) -> ShapeErrors:
        """Return the errors of a mesh by their names, of which there may be more."""
        return cls(mesh, **{field.name: error[field.name] for field in fields(cls) if field.name != "mesh"})


class RecipeFacts(Struct):
    """Facts about the recipe and the files of a compiled model, which the model lacks.

    `angle` is the unit of numbers without one in the check, `size` the bytes of all files, and `text` the model.
    """

    angle: str | None = None
    world: WorldPlace | None = None
    size: int = 0
    shapes: Sequence[ShapeErrors] = ()
    text: str = ""

    @classmethod
    def of(cls, data: Mapping[str, Any]) -> RecipeFacts:
        """Return the facts that `asdict` turned into data."""
        world = data["world"] and WorldPlace(**data["world"])
        shapes = [ShapeErrors(**errors) for errors in data["shapes"]]
        return cls(data["angle"], world, data["size"], shapes=shapes, text=data["text"])


SOLVED = 4
"""Digits kept of simulated or solved values."""


class OwnNames(Struct, eq=False):
    """The names of elements of one kind as a recipe writes them: their ids by name, and the names in order."""

    ids: Mapping[str, Sequence[int]]
    order: NameOrder


@dataclass
class Scope:
    """The names of a recipe in a compiled model, where each of them starts with `prefix`.

    `others` are longer prefixes that do not belong to the recipe. `keys` is the prefix of its keyframes, or None if
    they were left out. `whole` says that the whole model is the recipe's. `facts` are what else is known of the recipe.
    `values` are those that a check found.
    """

    mujoco: Any
    model: MjModel
    prefix: str = ""
    others: Sequence[str] = ()
    separator: str = "/"
    keys: str | None = ""
    whole: bool = True
    facts: RecipeFacts = RecipeFacts()
    values: dict[str, Any] = field(default_factory=dict, init=False)

    @cached_property
    def roster(self) -> NameTable:
        return name_table(self.model)

    def before(self, kind: str) -> str:
        return (self.keys or "") if kind == "key" else self.prefix

    def own(self, kind: str) -> Iterator[int]:
        return (index for index in range(self.roster.count(kind)) if self.owns(kind, index))

    def owns(self, kind: str, index: int) -> bool:
        """Return whether an element belongs to the recipe, by its name or else by its body or target."""
        if self.whole:
            return True
        name = self.roster.names[kind][index]
        if kind == "key":  # keys of several recipes merge into one
            return self.keys is not None and name.startswith(self.keys)
        if name and not (kind == "body" and index == 0):
            # The body and joint that carry a part are named by its prefix alone. They do not belong to the part.
            return name.startswith(self.prefix) and name != self.prefix and not name.startswith(tuple(self.others))
        if kind == "body":
            return index > 0 and self.owns("body", holder(self.model, kind, index))
        if kind in ON_BODIES:
            return self.owns("body", holder(self.model, kind, index))
        from mjcompose.mujoco.references import links

        return any(self.owns(each.kind, each.index) for each in links(self.model, kind, index) if each.index >= 0)

    def called(self, kind: str, index: int) -> str:
        """Return an element's name for messages: geom `pad`, or geom #2 of body `hand`."""
        name = self.written(kind, index)
        return f"{kind} `{name}`" if self.roster.names[kind][index] else f"{kind} {name}"

    def written(self, kind: str, index: int) -> str:
        """Return the name of an element in the recipe, or the place of an unnamed one."""
        return self.roster.describe(kind, index).removeprefix(self.before(kind))

    def names(self, kind: str) -> list[str]:
        """Return the names of a kind as the recipe writes them."""
        found = [self.roster.names[kind][index] for index in self.own(kind)]
        return [name.removeprefix(self.before(kind)) for name in found if name]

    def find(self, kind: str, name: str, *at: str | int) -> int:
        """Return the id of the element of that name; every recipe may name the world. Raises CheckEnds."""
        if kind == "body" and name == "world":
            return 0
        index = self.roster.ids[kind].get(self.prefix + name)
        if index is None:
            raise CheckEnds(unknown(kind, name, self.names(kind), *at))
        return index

    def matching(self, kind: str, glob: str) -> list[int]:
        """Return the ids of elements that a pattern matches; `**` also matches unnamed ones. Raises BadPattern."""
        if glob == "**":
            return list(self.own(kind))
        own = self._own_names(kind)
        if not is_pattern(glob):
            return list(own.ids.get(glob, ()))
        literals = literals_of(glob, self.separator)
        fitting = self.fitting(glob, own.order.narrowed(literals.starts, literals.part))
        return sorted(index for name in fitting for index in own.ids[name])

    def _own_names(self, kind: str) -> OwnNames:
        """Return the names that many checks of one recipe look up."""
        key = "own names", kind, self.prefix, tuple(self.others), self.keys, self.whole
        if key not in self.roster.kept:
            before = self.before(kind)
            ids: dict[str, list[int]] = {}
            for index in self.own(kind):
                name = self.roster.names[kind][index].removeprefix(before)
                if name:
                    ids.setdefault(name, []).append(index)
            self.roster.kept[key] = OwnNames(ids, NameOrder(ids))
        own: OwnNames = self.roster.kept[key]
        return own

    def fitting(self, glob: str, names: Collection[str]) -> frozenset[str]:
        """Return the `names`, as the recipe writes them, that a pattern matches. Raises BadPattern."""
        return frozenset(filter(fitter(glob, lambda: names, self.separator), names))

    def at_key(self, key: str | None, *at: str | int) -> Any:
        """Return an mjData at a keyframe or the reference configuration, before `mj_forward`. Raises CheckEnds."""
        at = at or ("key",)
        data = self.mujoco.MjData(self.model)
        if key is None:
            return data
        if self.keys is None:
            message = f"the keyframe `{key}` does not exist: this recipe drops its keyframes"
            notes = (Note("the recipe around it leaves them out: `drop: [key]`"),)
            raise CheckEnds(Fault("unknown-name", message, at, notes=notes))
        index = self.roster.ids["key"].get(self.keys + key)
        if index is None:
            raise CheckEnds(unknown("keyframe", key, self.names("key"), *at))
        self.mujoco.mj_resetDataKeyframe(self.model, data, index)
        return data

    def found(self, name: str, value: float, digits: int = 9) -> None:
        """Note a value that a check found. Simulated values keep only `digits`, which machines agree on."""
        exact = isinstance(value, int) or not math.isfinite(value)
        self.values[name] = value if exact else float(f"{round(value, digits):.{digits}g}")

    @cached_property
    def joints(self) -> frozenset[int]:
        return frozenset(self.own("joint"))


def keys_named(scope: Scope, globs: Sequence[str]) -> list[str]:
    """Return the names of the keyframes that the globs match; all of them without globs. Raises CheckEnds."""
    known = [] if scope.keys is None else scope.names("key")
    if not globs:
        return known
    if scope.keys is None:
        scope.at_key(globs[0])
    found: list[str] = []
    for at, glob in enumerate(globs):
        fitting = scope.fitting(glob, known)
        if not fitting:
            place = ("key", at) if len(globs) > 1 else ("key",)
            raise names_nothing(f"`{glob}` names no keyframe", glob, "keyframe", known=known, at=place)
        found += [name for name in known if name in fitting and name not in found]
    return found


def at_keys(scope: Scope, names: Iterable[str]) -> Iterator[tuple[str, Any]]:
    """Yield an mjData at each keyframe. The caller still calls `mj_forward`."""
    return ((name, scope.at_key(name)) for name in names)


def check_globs(scope: Scope, kinds: Sequence[str], globs: Sequence[str], at: Path) -> None:
    """Raise CheckEnds for the first glob that matches nothing of these kinds."""
    for index, glob in enumerate(globs):
        if not any(scope.matching(kind, glob) for kind in kinds):
            known = sorted(name for kind in kinds for name in scope.names(kind))
            place = (*at, index) if len(globs) > 1 else at
            raise names_nothing(f"`{glob}` names no {' and no '.join(kinds)}", glob, "name", known=known, at=place)


def names_nothing(message: str, glob: str, what: str, known: Sequence[str], at: Path) -> CheckEnds:
    """Return the end of a check because a glob matches none of the known names of a kind, `what`."""
    notes = (exists_note(what, known, glob),)
    help = did_you_mean(glob, known)
    return CheckEnds(Fault("unknown-name", message, at, notes=notes, help=help))


ROUNDING = {4: 1e-6, 8: 1e-9}
"""Rounding tolerance by the bytes of a number, relative to the larger of 1 and the value."""
_SECOND = ("refsite", "slidersite", "refname")


def words_of(scope: Scope, tag: str, index: int, attr: str) -> Iterator[str]:
    """Yield the value of an attribute: two if MuJoCo does not store which one it is, none if it is not set."""
    if attr in ENUMERATED.get(tag, ()):
        array = array_of(tag, attr)
        values = getattr(scope.model, array, None)
        if values is not None:
            yield words(scope.mujoco, array)[int(values[index])]
        return
    from mjcompose.mujoco.references import links

    kind = naming(tag)[attr]
    for link in links(scope.model, tag, index):
        if link.index >= 0 and (kind is None or link.kind == kind) and _is_meant(link.field, tag, attr):
            yield scope.written(link.kind, link.index)


def _is_meant(field: str, tag: str, attr: str) -> bool:
    """Return whether the attribute writes the reference that the field of mjModel stores."""
    if attr == "target":
        return "target" in field
    if tag == "sensor":
        return field == ("sensor_refid" if attr in _SECOND or attr.endswith("2") else "sensor_objid")
    if tag == "equality":
        return field == ("eq_obj2id" if attr.endswith("2") else "eq_obj1id")
    if tag == "actuator":
        return field == f"actuator_trnid[{int(attr in _SECOND)}]"
    return True


class Quantity(Struct):
    """A number with its unit as written; `per_unit` is one such unit in the unit of the compiled model."""

    number: float
    unit: str | None
    per_unit: float

    @property
    def value(self) -> float:
        """The number in the compiled model's unit."""
        return self.number * self.per_unit

    def __str__(self) -> str:
        if isinstance(self.number, bool):
            return str(self.number).lower()
        return f"{self.number:.9g}{self.unit or ''}"

    def like(self, value: float) -> str:
        """Return a value of the compiled model as text, in the unit of this quantity."""
        if isinstance(value, bool):
            return str(value).lower()
        return str(Quantity(value / self.per_unit, self.unit, self.per_unit))


def values_of(scope: Scope, tag: str, index: int, attr: str, subscript: int | None) -> Any:
    """Return the numbers of an attribute as a flat array, or only the number of a subscript. Raises CheckEnds."""
    import numpy as np

    from mjcompose.mujoco.addresses import rows_of

    name = "body_subtreemass" if attr == SUBTREE_MASS else array_of(tag, attr)
    array = getattr(scope.model, name, None)
    if array is None:
        raise CheckEnds(Fault("unknown-attribute", f"this MuJoCo has no `{attr}` of a {tag}", ("attr",)))
    row = rows_of(scope.model, tag, name, index=index).start  # a joint has one value; for an actuator the first counts
    numbers = np.atleast_1d(array[row]).ravel()
    if subscript is None:
        return numbers
    if subscript >= numbers.size:
        message = f"`{attr}` of {scope.called(tag, index)} has {numbers.size} numbers"
        raise CheckEnds(Fault("wrong-length", message, ("attr",), notes=(Note(f"the first is `{attr}[0]`"),)))
    return numbers[subscript][None]


def quantities_of(scope: Scope, tag: str, index: int, attr: str, numbers: Sequence[Number]) -> list[Quantity]:
    """Return the expected numbers in the unit of the compiled model. Raises CheckEnds."""
    joint = JOINT_TYPES[int(scope.model.jnt_type[index])].word if tag == "joint" else ""
    angular = attr in ANGLES.get(joint, ())
    quantities: list[Quantity] = []
    for number, unit in numbers:
        if unit is None and angular and number != 0:
            unit = {"degree": "deg", "radian": "rad", None: None}[scope.facts.angle]
            if unit is None:
                help = f"write `{number:.9g}deg` or `{number:.9g}rad`, or `angle: degree` at the top of the recipe"
                message = f"`{attr}` of {joint} {scope.called(tag, index)} is an angle, and `{number:.9g}` has no unit"
                raise CheckEnds(Fault("bare-angle", message, help=help))
        quantities.append(quantity(number, unit, unit_of(tag, attr)))
    return quantities


def unit_of(tag: str, attr: str) -> str:
    return "deg" if is_in_degrees(tag, attr) else "rad"


def quantity(number: float, unit: str | None, own: str) -> Quantity:
    if unit in (None, own):
        return Quantity(number, unit, 1.0)
    return Quantity(number, unit, math.radians(1) if own == "rad" else math.degrees(1))


def equal(actual: Any, expected: Sequence[Quantity], tol: float | None) -> bool:
    import numpy as np

    meant = np.array([each.value for each in expected], dtype=np.float64)
    apart = np.abs(actual.astype(np.float64) - meant)
    if tol is None:
        part = ROUNDING[4 if actual.dtype == np.float32 else 8]
        return bool(np.all(apart <= part * np.maximum(1.0, np.abs(meant))))
    return bool(np.all(apart <= tol))


def plain(numbers: Any) -> Any:
    """Return one number or a list of numbers for JSON; single-precision numbers are rounded to six digits."""
    plain = [
        float(f"{each:.6g}") if numbers.dtype.itemsize == 4 and numbers.dtype.kind == "f" else each
        for each in numbers.tolist()
    ]
    return plain[0] if len(plain) == 1 else plain


def like(quantities: Sequence[Quantity], numbers: Sequence[float]) -> list[str]:
    """Return numbers as text, each in the unit of its quantity, or all in the first number's unit."""
    if len(quantities) != len(numbers):
        quantities = [quantities[0]] * len(numbers)
    return [each.like(number) for each, number in zip(quantities, numbers, strict=True)]


CHECKS: ExtensionTable[Callable[[Scope, Any], list[Fault]]] = ExtensionTable(
    "checks", {}, "check", modules=homes.CHECKS
)
"""How to carry out each check that reads the compiled model. It gets the check's form."""


def ask(mujoco: Any, model: MjModel, question: dict[str, Any]) -> dict[str, Any]:
    """Return the findings and values of a check in a scope; runs under `engine.call`.

    The check is sent as the recipe writes it. Its form reads it here as it did there.
    """
    scope = Scope(mujoco, model, **question["scope"], facts=RecipeFacts.of(question["facts"]))
    word = question["word"]
    form = KINDS[word].model_validate(question["written"], context=Settings(separator=scope.separator))
    try:
        found = CHECKS[word](scope, form)
    except BadPattern as bad:
        found = [Fault("selector", bad.message, help=bad.help)]
    except CheckEnds as end:
        found = [end.fault]
    return {"findings": list(map(to_json, found)), "values": scope.values}
