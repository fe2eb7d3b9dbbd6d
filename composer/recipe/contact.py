"""The section `contact`: pairs and excludes as in MJCF, and those that follow from parts and bodies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from composer.dataclass import dataclass
from composer.diagnostics.suggest import closest, exists_note
from composer.recipe.by_tag import Lists
from composer.recipe.element import Element
from composer.recipe.element_schema import mapping
from composer.recipe.fault import Fault, Path, unknown_key
from composer.recipe.pattern import GLOB, pattern_fault
from composer.recipe.raw import path_of
from composer.recipe.reader import Reader
from composer.recipe.reference import Schema, reference
from composer.recipe.shown import kind_of

EXCLUDE: Literal["exclude"] = "exclude"
COLLIDE: Literal["collide"] = "collide"
BETWEEN, TOUCHING, AUTO = "between", "touching", "auto"
SAMPLES = 1000
_MOST_SAMPLES = 1_000_000


@dataclass(frozen=True, slots=True)
class Collisions:
    """Bodies that must not collide (`exclude`), or geoms that may (`collide`).

    The two `sides` are names of parts or globs over bodies. They are empty for bodies that already touch, and for
    bodies that are found with random configurations, of which `samples` are drawn with a `seed`. `at` is the path
    of the entry from the top of the recipe.
    """

    what: Literal["exclude", "collide"]
    sides: tuple[tuple[str, ...], ...]
    at: Path
    samples: int | None = None
    seed: int = 0


@dataclass(frozen=True, slots=True)
class Contacts(Lists):
    """Form of `contact` with `exclude` and `collide`, read as a tuple of `Element` and `Collisions`."""

    def content(self, reader: Reader, value: Any) -> tuple[Any, ...]:
        if not isinstance(value, dict):
            return Lists.content(self, reader, value)
        top: Path = path_of(value) or (self.tag,)
        found: list[Element | Collisions] = []
        rest = dict(value)
        if COLLIDE in rest:
            items = rest.pop(COLLIDE)
            for at, item in _items(items, (COLLIDE,)):
                found += _between(reader, COLLIDE, item, at=at, top=top)
        excludes = rest.get(EXCLUDE)
        if excludes in (TOUCHING, AUTO) or (isinstance(excludes, Mapping) and "body1" not in excludes):
            found += _exclude(reader, rest.pop(EXCLUDE), (EXCLUDE,), top=top)
        elif isinstance(excludes, str):
            reader.faults.append(_no_word(rest.pop(EXCLUDE), (EXCLUDE,)))
        elif isinstance(excludes, list):
            own = [(index, item) for index, item in enumerate(excludes) if not _is_element(item)]
            for index, item in own:
                found += _exclude(reader, item, (EXCLUDE, index), top=top)
            if own:
                kind = self.kind.children[EXCLUDE]
                rest.pop(EXCLUDE)
                for index, item in enumerate(excludes):
                    if _is_element(item):
                        read = reader.element(kind, item, (EXCLUDE, index), f"`{EXCLUDE}`")
                        found += [] if read is None else [read]
        return (*Lists.content(self, reader, rest), *found)

    def schema(self) -> Schema:
        schema = Lists.schema(self)
        between, found = _schema(), _found_schema()
        words: Schema = {
            "enum": [TOUCHING, AUTO],
            "description": "bodies of different parts that touch, or all that need not collide",
        }
        exclude = schema["properties"][EXCLUDE]
        exclude["items"] = {"anyOf": [exclude["items"], found, words]}
        about = exclude.pop("description", "")
        schema["properties"][EXCLUDE] = {"anyOf": [exclude, found, words], "description": about}
        schema["properties"][COLLIDE] = {
            "anyOf": [between, {"type": "array", "items": between}],
            "description": "a contact pair for every two geoms between parts that could not touch otherwise",
        }
        return schema


def _schema() -> Schema:
    side: Schema = {"anyOf": [dict(GLOB), {"type": "array", "items": dict(GLOB), "minItems": 1}]}
    sides = {
        "type": "array", "items": side, "minItems": 2, "maxItems": 2,
        "description": "the two sides: parts by name, or globs over names of bodies",
    }  # fmt: skip
    return {**mapping({BETWEEN: sides}), "required": [BETWEEN]}


def _found_schema() -> Schema:
    """Return the schema of an `exclude` that does not name each pair."""
    samples = {
        **reference("integer"), "minimum": 1, "maximum": _MOST_SAMPLES,
        "description": f"in how many random poses nothing may touch (default: {SAMPLES})",
    }  # fmt: skip
    seed = {**reference("integer"), "minimum": 0, "description": "of the poses (default: 0)"}
    auto = {
        **mapping({"samples": samples, "seed": seed}),
        "description": "bodies that need not collide; `plan` has the reason of each pair",
    }
    return {**mapping({**_schema()["properties"], AUTO: auto}), "minProperties": 1, "maxProperties": 1}


def _is_element(item: Any) -> bool:
    return isinstance(item, Mapping) and not any(key == AUTO or closest(key, (BETWEEN,)) for key in item)


def _items(value: Any, at: Path) -> list[tuple[Path, Any]]:
    return (
        [((*at, index), item) for index, item in enumerate(value)]
        if isinstance(value, list)
        else [(at, value)]
    )


def _exclude(reader: Reader, value: Any, at: Path, top: Path) -> list[Collisions]:
    if value == TOUCHING:
        return [Collisions(EXCLUDE, (), (*top, *at))]
    if value == AUTO:
        return [Collisions(EXCLUDE, (), (*top, *at), samples=SAMPLES)]
    if isinstance(value, str):
        reader.faults.append(_no_word(value, at))
        return []
    if isinstance(value, Mapping) and AUTO in value:
        return _auto(reader, value, at, top=top)
    return _between(reader, EXCLUDE, value, at=at, top=top)


def _auto(reader: Reader, value: Mapping[str, Any], at: Path, top: Path) -> list[Collisions]:
    """Return the entry of one `{auto: {samples: 5000, seed: 1}}`, or None after a reported fault."""
    before = len(reader.faults)
    for key in value:
        if key != AUTO:
            message = f"`{key}` is not a key of `{EXCLUDE}`"
            note = exists_note("key", (AUTO,), key)
            reader.faults.append(Fault("unknown-key", message, (*at, key), key=True, notes=(note,)))
    given = value[AUTO]
    if not isinstance(given, Mapping):
        message = f"`{AUTO}` expects a mapping, got {kind_of(given)}"
        help = f"write `{AUTO}: {{samples: {SAMPLES}}}`"
        reader.faults.append(Fault("wrong-type", message, (*at, AUTO), help=help))
        return []
    for key, number in given.items():
        path = (*at, AUTO, key)
        if key not in ("samples", "seed"):
            reader.faults.append(
                unknown_key(f"`{key}` is not a key of `{AUTO}`", key, ("samples", "seed"), at=path)
            )
        elif isinstance(number, bool) or not isinstance(number, int):
            message = f"`{key}` expects a whole number, got {kind_of(number)}"
            reader.faults.append(Fault("wrong-type", message, path))
        elif not (key == "samples") <= number <= (_MOST_SAMPLES if key == "samples" else 2**63):
            message = f"`{key}` is {int(key == 'samples')} to {_MOST_SAMPLES}, got {number}"
            reader.faults.append(Fault("out-of-range", message, path))
    if len(reader.faults) > before:
        return []
    return [
        Collisions(EXCLUDE, (), (*top, *at), samples=given.get("samples", SAMPLES), seed=given.get("seed", 0))
    ]


def _no_word(word: str, at: Path) -> Fault:
    message = f"`{EXCLUDE}` is a list of pairs, `{TOUCHING}`, `{AUTO}` or `{BETWEEN}`, got `{word}`"
    near = closest(word, (TOUCHING, AUTO))
    help = f"write `{EXCLUDE}: {near[0]}`" if near else f"write `{EXCLUDE}: {{{BETWEEN}: [ARM, TABLE]}}`"
    return Fault("wrong-keyword", message, at, help=help)


def _between(
    reader: Reader, what: Literal["exclude", "collide"], value: Any, at: Path, top: Path
) -> list[Collisions]:
    """Return the entry of one `{between: [ARM, TABLE]}`, or None after a reported fault."""
    example = f"write `{what}: {{{BETWEEN}: [ARM, TABLE]}}`, with names of parts or globs over bodies"
    before = len(reader.faults)
    if not isinstance(value, Mapping):
        message = f"`{what}` expects `{BETWEEN}`, got {kind_of(value)}"
        reader.faults.append(Fault("wrong-type", message, at, help=example))
        return []
    for key in value:
        if key != BETWEEN:
            note = exists_note("key", (BETWEEN,), key)
            message = f"`{key}` is not a key of `{what}`"
            near = f"write `{BETWEEN}`" if closest(key, (BETWEEN,)) else None
            reader.faults.append(
                Fault("unknown-key", message, (*at, key), key=True, notes=(note,), help=near)
            )
    if BETWEEN not in value:
        if len(reader.faults) == before:
            reader.faults.append(Fault("missing-key", f"`{what}` lacks `{BETWEEN}`", at, help=example))
        return []
    sides = value[BETWEEN]
    if not isinstance(sides, list) or len(sides) != 2:
        code = "wrong-length" if isinstance(sides, list) else "wrong-type"
        got = f"{len(sides)}" if isinstance(sides, list) else kind_of(sides)
        message = f"`{BETWEEN}` of `{what}` expects two sides, got {got}"
        reader.faults.append(Fault(code, message, (*at, BETWEEN), help=example))
        return []
    read = [_side(reader, side, what, at=(*at, BETWEEN, index)) for index, side in enumerate(sides)]
    return [] if len(reader.faults) > before else [Collisions(what, tuple(read), (*top, *at))]


def _side(reader: Reader, value: Any, what: str, at: Path) -> tuple[str, ...]:
    names = value if isinstance(value, list) else [value]
    for index, name in enumerate(names):
        place = (*at, index) if isinstance(value, list) else at
        if not isinstance(name, str) or not name:
            message = f"a side of `{BETWEEN}` in `{what}` is a name or a glob, got {kind_of(name)}"
            reader.faults.append(Fault("wrong-type", message, place))
        elif (fault := pattern_fault(name, f"`{what}`", place)) is not None:
            reader.faults.append(fault)
    if not names:
        reader.faults.append(Fault("wrong-type", f"a side of `{BETWEEN}` in `{what}` is empty", at))
    return tuple(str(name) for name in names)
