"""The names that are allowed at a place, and the matches of a selector."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any

from mjcompose.base.dataclass import Struct
from mjcompose.language.datasheets import library
from mjcompose.language.forms.translate import name_scopes
from mjcompose.language.keyframe import FROM, VECTORS
from mjcompose.language.recipe import Recipe
from mjcompose.language.select import NARROWING, read_selector
from mjcompose.lsp.analysis import Known, ModelNames, Question
from mjcompose.lsp.cursor import Path
from mjcompose.lsp.language import ValueForm, kinds_of
from mjcompose.plan.plan import BASE, AttachPart, Plan, part_name
from mjcompose.text.node import is_template
from mjcompose.tree.grammar import GRAMMAR, Attribute
from mjcompose.tree.names import WORLD
from mjcompose.tree.pattern import BadPattern, paths_of
from mjcompose.tree.select import Selection, name_of

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from mjcompose.lsp.analysis import Analysis


def selector_around(question: Question) -> tuple[Path, dict[str, Any]] | None:
    path = question.path
    for length in range(len(path), 0, -1):
        written = question.at(path[:length])
        if isinstance(written, dict) and is_selector(path[:length], written):
            return path[:length], written
    return None


def is_selector(path: Path, written: dict[str, Any]) -> bool:
    if not path:
        return False
    is_place = path[-1] in ("select", "parent", "in") or (len(path) > 1 and path[-2] == "drop")
    tags = [name for name in written if name not in NARROWING]
    return is_place and len(tags) == 1 and bool(paths_of(tags[0]))


def matches(path: Path, written: dict[str, Any], analysis: Analysis) -> list[Node] | None:
    """Return the elements that a selector matches, or None if that is not known. `where` is not evaluated."""
    if any(isinstance(value, str) and is_template(value) for value in written.values()):
        return None
    selector = read_selector({**written, **({"where": {}} if "where" in written else {})}, path, "", [])
    if selector is None:
        return None
    own = own_part(without_variant(path))
    model = analysis.model
    if own:
        unit = analysis.names.sources.get(part_called(own, analysis.plan))
        separator = "/"
    else:
        unit = None if model is None else model.unit
        separator = analysis.separator
    parts = model.parts if model is not None and not own else {}
    try:
        return None if unit is None else Selection(unit.root, unit.classes, separator, parts).of(selector)
    except BadPattern:
        return None


def label(node: Node) -> str:
    name = name_of(node)
    return f"`{name}`" if name else f"an unnamed `<{node.tag}>`"


ANY = "*"
PART = "part"
KEY = "key"
DATASHEET = "datasheet"


class Wanted(Struct):
    """The names that are allowed at a place, by namespace, the most likely one first.

    With `tags`, only elements with these tags are allowed. Names come from the part at the path `of` or with the name
    `part`; `not_of` is the path of a part that is not allowed. With `pattern`, a pattern is allowed too.
    """

    namespaces: tuple[str, ...]
    tags: frozenset[str] = frozenset()
    of: Path = ()
    not_of: Path = ()
    part: str | None = None
    pattern: bool = False


@cache
def _rows() -> tuple[tuple[Path, Wanted], ...]:
    rows: dict[Path, Wanted] = {}
    for at, name in name_scopes(Recipe).items():
        rows[at] = Wanted(name.scope, pattern=name.glob)
        if at[-1] == ANY:
            rows.setdefault(at[:-1], rows[at])
    return tuple(rows.items())


@cache
def _rows_inside_parts() -> tuple[Path, ...]:
    declared = (at for at, name in name_scopes(Recipe).items() if name.inside is not None)
    return (*declared, *((*part, key) for part in (("attach", ANY), (BASE,)) for key in ("edit", "drop")))


_PLACES = ("site", "body", "frame")


def wanted_value(path: Path, forms: list[ValueForm], around: Any) -> Wanted | None:
    """Return the names that a value can have.

    `forms` are the forms of the mapping around it, and `around` are its data.
    """
    path = without_variant(path)
    if not path:
        return None
    inner = _in_place(path)
    if inner is not None:
        found = wanted_value(inner[1], forms, around)
        return None if found is None or found.of else replace(found, of=inner[0], not_of=())
    found = next((wanted for row, wanted in _rows() if _fits(row, path)), None)
    if found is None and len(path) > 2 and path[-2] == FROM and path[0] == "keyframe":
        return Wanted((KEY,), part=str(path[-1]))
    found = found or _selector(path, forms) or _of_mjcf(path, forms, around)
    if found is None:
        return None
    # A part cannot be attached to itself.
    itself = path[:2] if len(path) == 3 and path[0] == "attach" and path[2] in _PLACES else ()
    return replace(found, of=own_part(path), not_of=itself)


def wanted_key(path: Path) -> Wanted | None:
    path = without_variant(path)
    inner = _in_place(path)
    if inner is not None:
        found = wanted_key(inner[1])
        return None if found is None else replace(found, of=inner[0])
    if len(path) == 3 and path[0] == "keyframe":
        if path[2] == FROM:
            return Wanted((PART,))
        kind = VECTORS.get(str(path[2]))
        return None if kind is None else Wanted((kind.removeprefix("mocap "),), pattern=True)
    is_joint = len(path) == 4 and path[0] == "keyframe" and path[3] == "joint"
    return Wanted(("joint",), pattern=True) if is_joint else None


def fitting(wanted: Wanted, names: ModelNames, plan: Plan | None) -> Iterator[tuple[int, Known]]:
    """Yield the names that are allowed, each with a rank. The most likely come first."""
    if wanted.of or wanted.part is not None:
        names = names.own(part_called(wanted.of, plan) if wanted.part is None else wanted.part)
    step = part_at(wanted.not_of, plan)
    itself = step.prefix if step is not None else None
    for rank, namespace in enumerate(wanted.namespaces):
        if namespace == PART:
            yield from ((rank, Known(part, PART, PART)) for part in names.parts)
            continue
        if namespace == DATASHEET:
            sheets = {**library(), **(plan.datasheets if plan is not None else {})}
            yield from ((rank, Known(sheet, DATASHEET, DATASHEET)) for sheet in sheets)
            continue
        for name, known in names.known.get(namespace, {}).items():
            if itself and name.startswith(itself):
                continue
            if not wanted.tags or known.tag in wanted.tags or known.name == WORLD:
                yield rank, replace(known, name=name)


def without_variant(path: Path) -> Path:
    """Return the path inside a variant's piece of recipe, or the path itself outside variants."""
    return path[3:] if path[:1] == ("variants",) and len(path) > 3 else path


def _in_place(path: Path) -> tuple[Path, Path] | None:
    """Return the part whose in-place recipe contains a path, and the path inside that recipe, or None."""
    length = 2 if path[:2] == ("base", "model") else 3 if path[:1] == ("attach",) and path[2:3] == ("model",) else 0
    return (path[: length - 1], path[length:]) if length and len(path) > length else None


def own_part(path: Path) -> Path:
    """Return the path of the part whose own names a place uses, or an empty path where final names are used."""
    row = next((row for row in _rows_inside_parts() if _fits(row, path[: len(row)])), None)
    return () if row is None else path[: len(row) - 1]


def part_called(at: Path, plan: Plan | None) -> str:
    """Return the name of the part at a path, as keyframes and selectors write it."""
    step = part_at(at, plan)
    return part_name(step, plan.separator) if step is not None and plan is not None else str(at[-1])


def part_of_reference(path: Path, plan: Plan) -> str | None:
    """Return the path of the part whose `model` is at a path, or None for any other place."""
    path = without_variant(path)
    if path in (("base",), ("base", "model")):
        return BASE
    if len(path) == 3 and path[0] == "attach" and path[2] == "model" and part_at(path[:2], plan) is not None:
        return part_called(path[:2], plan)
    return None


def part_at(at: Path, plan: Plan | None) -> AttachPart | None:
    return next((step for step in (plan.members if plan is not None else ()) if step.at == at), None)


def _fits(row: Path, path: Path) -> bool:
    return len(row) == len(path) and all(a in (ANY, b) for a, b in zip(row, path, strict=True))


def _selector(path: Path, forms: list[ValueForm]) -> Wanted | None:
    """Return the names that fit after a tag of a selector, or after a key that narrows it down; None elsewhere."""
    last = str(path[-1])
    if not any(form.role in ("selector", "Drop") or form.role.endswith("@select") for form in forms):
        return None
    if last == "part":
        return Wanted((PART,), pattern=True)
    if last == "class":
        return Wanted(("default",), pattern=True)
    if last in NARROWING or not paths_of(last):
        return None
    families = {GRAMMAR.element(path).family for path in paths_of(last)}
    tags = frozenset(path.rpartition("/")[2] for path in paths_of(last))
    return Wanted(tuple(sorted(name for name in families if name)), tags, pattern=True)


def _of_mjcf(path: Path, forms: list[ValueForm], around: Any) -> Wanted | None:
    name = str(path[-2]) if isinstance(path[-1], int) and len(path) > 1 else str(path[-1])
    for kind in kinds_of(forms):
        attribute = kind.attributes.get(name)
        wanted = None if attribute is None else _referred(attribute, around)
        if wanted is not None:
            return wanted
    if name == "parent" and len(path) == 3 and path[0] == "default":
        return Wanted(("default",))
    for (tendon, key), namespace in _PATHS_OF_TENDONS.items():
        if key == name and any(form.role.startswith(f"step.tendon.{tendon}") for form in forms):
            return Wanted((namespace,))
    return None


# The names that fit as a key of a tendon's path. The path of a spatial tendon is a list of elements.
_PATHS_OF_TENDONS = {
    ("spatial", "site"): "site",
    ("spatial", "geom"): "geom",
    ("spatial", "sidesite"): "site",
    ("fixed", "joint"): "joint",
}


def _referred(attribute: Attribute, around: Any) -> Wanted | None:
    """Return the names that fit as the value of an attribute, given the other keys of its mapping."""
    if attribute.refers_by:
        # A sibling such as `objtype` names the namespace.
        sibling = around.get(attribute.refers_by) if isinstance(around, dict) else ""
        family = GRAMMAR.objtypes.get(str(sibling))
        return Wanted((family,) if family else tuple(dict.fromkeys(GRAMMAR.objtypes.values())))
    if attribute.refers and not attribute.refers.startswith("attached:"):
        return Wanted((attribute.refers,))
    return None
