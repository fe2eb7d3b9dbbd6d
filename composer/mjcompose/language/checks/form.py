"""The definition of a kind of check, and the forms of its keys."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import field
from functools import cache
from typing import Any, ClassVar, Protocol

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Fix, Note, Path
from mjcompose.base.suggest import advised, exists_note
from mjcompose.language.form import Schema, kind_of, reference, unknown_key
from mjcompose.language.select import GLOB, pattern_fault
from mjcompose.language.value import without_unit
from mjcompose.model.grammar import GRAMMAR
from mjcompose.model.selector import paths_of
from mjcompose.mujoco.attributes import ENUMERATED

_NAMING = ("geom", "site", "camera", "light", "skin", "material", "pair", "exclude", "equality", "tendon", "actuator",
           "sensor")  # fmt: skip
_NOT_COMPILED = ("default", "instance")


@cache
def keywords(tag: str) -> Mapping[str, tuple[str, ...]]:
    """Return the attributes of a tag that have keywords, with these. The keywords of a family's `type` are its tags."""
    paths = paths_of(tag)
    found: dict[str, tuple[str, ...]] = {}
    for name in sorted(ENUMERATED.get(tag, ())):
        words = {word for path in paths for word in _words(path, name)}
        found[name] = tuple(sorted(words or {GRAMMAR.element(path).tag for path in paths}))
    return found


def _words(path: str, name: str) -> tuple[str, ...]:
    attribute = GRAMMAR.element(path).attributes.get(name)
    return attribute.keywords if attribute is not None else ()


@cache
def naming(tag: str) -> Mapping[str, str | None]:
    """Return the attributes of a tag that name another element, with its kind.

    The kind is None if another attribute gives it.
    """
    if tag not in _NAMING:
        return {}
    return {
        name: attribute.refers
        for path in sorted(paths_of(tag))
        for name, attribute in GRAMMAR.element(path).attributes.items()
        if (attribute.is_reference or attribute.refers_by) and attribute.refers not in _NOT_COMPILED
    }


@dataclass(frozen=True, slots=True)
class Keys:
    """The value behind `word` in the check `name`. The paths of faults start at the section `check`."""

    name: str
    word: str
    value: Any
    faults: list[Fault]

    @property
    def owner(self) -> str:
        return f"check `{self.name}`"

    def known(self, keys: Iterable[str], noun: str = "key") -> None:
        """Report every key that is not one of these."""
        keys = list(keys)
        for key in self.value:
            if key not in keys:
                message = f"`{self.word}` of {self.owner} has no {noun} `{key}`"
                self.faults.append(unknown_key(message, key, keys, at=(self.name, self.word, key), noun=noun))

    def add(
        self,
        code: str,
        message: str,
        *at: str | int,
        key: bool = False,
        notes: tuple[Note, ...] = (),
        help: str | None = None,
        fix: Fix | None = None,
    ) -> None:
        """Add a fault at a path below this mapping."""
        path: Path = (self.name, self.word, *at)
        self.faults.append(Fault(code, message, path, key=key, notes=notes, help=help, fix=fix))

    def lacks(self, key: str, example: str) -> None:
        """Report a missing key."""
        message = f"`{self.word}` of {self.owner} lacks `{key}`"
        at = (self.name, self.word)
        self.faults.append(
            Fault("missing-key", message, at, key=True, help=f"write `{key}: {example}`", lacks=key)
        )

    def one_of(self, *keys: str) -> str | None:
        """Return which of several keys is written, or None. Two of them are a fault."""
        found = [key for key in keys if key in self.value]
        for key in found[1:]:
            message = f"`{self.word}` of {self.owner} has both `{found[0]}` and `{key}`"
            self.add("wrong-type", message, key, key=True, help="take one of them out")
        return found[0] if found else None

    def text_of(self, value: Any, what: str, *at: str | int) -> str | None:
        """Return a value that must be a text, or None after a reported fault."""
        if isinstance(value, str) and value:
            return value
        got = "nothing" if value == "" else kind_of(value)
        key = next(each for each in reversed(at) if isinstance(each, str))
        self.add("wrong-type", f"`{key}` of {self.owner} expects {what}, got {got}", *at)
        return None

    def glob_of(self, value: Any, what: str, *at: str | int) -> str | None:
        """Return a value that must be a name, a glob or a regular expression over names."""
        text = self.text_of(value, what, *at)
        if text is not None and (fault := pattern_fault(text, self.owner, (self.name, self.word, *at))):
            self.faults.append(fault)
            return None
        return text

    def number_of(
        self, value: Any, *at: str | int, least: float | None = None, above: float | None = None
    ) -> float | None:
        """Return a value that must be a finite number within bounds, or None after a reported fault."""
        number = _number(value)
        if number is None:
            noun = "a finite number" if isinstance(value, float) else "a number"
            message = f"`{at[0]}` of {self.owner} expects {noun}, got {kind_of(value)}"
            advice = without_unit(value) if isinstance(value, str) else None
            help, fix = (advice.help, advice.fix) if advice is not None else (None, None)
            self.add("wrong-type", message, *at, help=help, fix=fix)
            return None
        if (least is not None and number < least) or (above is not None and number <= above):
            wanted = f"at least {least:g}" if least is not None else f"more than {above:g}"
            message = f"`{at[0]}` of {self.owner} is {number:g}, and must be {wanted}"
            self.add("out-of-range", message, *at)
            return None
        return number


def _number(value: Any) -> float | None:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) if is_number and abs(value) <= sys.float_info.max else None


class Form(Protocol):
    """The form of a value of a key."""

    def read(self, keys: Keys, value: Any, *at: str | int) -> Any:
        """Return the value at a path below the check, or None after a reported fault."""

    def schema(self) -> Schema:
        """Return its JSON Schema."""


@dataclass(frozen=True, slots=True)
class Name:
    """A text that is not empty. `what` says in messages what it should be."""

    what: str

    def read(self, keys: Keys, value: Any, *at: str | int) -> str | None:
        return keys.text_of(value, self.what, *at)

    def schema(self) -> Schema:
        return {"type": "string", "minLength": 1}


@dataclass(frozen=True, slots=True)
class Glob:
    """A name, a glob or a regular expression over names."""

    what: str

    def read(self, keys: Keys, value: Any, *at: str | int) -> str | None:
        return keys.glob_of(value, self.what, *at)

    def schema(self) -> Schema:
        return dict(GLOB)


@dataclass(frozen=True, slots=True)
class Globs:
    """A `Glob` or a list of them, read as a tuple. `owner` is the name of the list in messages."""

    what: str

    def read(self, keys: Keys, value: Any, *at: str | int) -> tuple[str, ...]:
        if not isinstance(value, list):
            found = keys.glob_of(value, self.what, *at)
            return () if found is None else (found,)
        if not value:
            self.refuse_empty(keys, *at)
        each = [keys.glob_of(item, self.what, *at, index) for index, item in enumerate(value)]
        return tuple(item for item in each if item is not None)

    def refuse_empty(self, keys: Keys, *at: str | int) -> None:
        keys.add("wrong-type", f"`{at[-1]}` of {keys.owner} expects {self.what}, got an empty list", *at)

    def schema(self) -> Schema:
        return {"anyOf": [dict(GLOB), {"type": "array", "items": dict(GLOB), "minItems": 1}]}


LENGTH: Mapping[str, float] = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}
BYTES: Mapping[str, float] = {
    f"{prefix}{infix}B": float((1024 if infix else 1000) ** (power + 1))
    for power, prefix in enumerate("kMG")
    for infix in ("", "i")
}


@dataclass(frozen=True, slots=True)
class Number:
    """A finite number that is at least `least`, or greater than `above`.

    It may have a unit behind it: `units` are the factors to the number without a unit.

    >>> Number(units=LENGTH).read(Keys("a", "b", {}, []), "-1mm", "min")
    -0.001
    """

    least: float | None = None
    above: float | None = None
    units: Mapping[str, float] = field(default_factory=dict)

    def read(self, keys: Keys, value: Any, *at: str | int) -> float | None:
        if self.units and isinstance(value, str) and (match := _MEASURE.fullmatch(value.strip())):
            number, unit = match.groups()
            if unit in self.units:
                value = float(number) * self.units[unit]
        return keys.number_of(value, *at, least=self.least, above=self.above)

    def schema(self) -> Schema:
        bounds = {"minimum": self.least, "exclusiveMinimum": self.above}
        given = {key: each for key, each in bounds.items() if each is not None}
        if not self.units:
            return {**reference("number"), **given}
        known = "|".join(self.units)
        sign = "" if self.least is not None or self.above is not None else "-?"
        return {
            "type": ["number", "string"],
            **given,
            "pattern": rf"^{sign}(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?\s*(?:{known})$|\$\{{",
            "patternErrorMessage": f"expected a number, or one with a unit: {', '.join(self.units)}",
        }


_MEASURE = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([A-Za-z]+)")


@dataclass(frozen=True, slots=True)
class Numbers:
    """A list of this many numbers, read as a tuple."""

    count: int
    example: str

    def read(self, keys: Keys, value: Any, *at: str | int) -> tuple[float, ...] | None:
        if not isinstance(value, list) or len(value) != self.count:
            code = "wrong-length" if isinstance(value, list) else "wrong-type"
            got = f"{len(value)}" if isinstance(value, list) else kind_of(value)
            message = f"`{at[-1]}` of {keys.owner} expects a list of {self.count} numbers, got {got}"
            keys.add(code, message, *at, help=f"write for instance `{at[-1]}: {self.example}`")
            return None
        found = [keys.number_of(each, *at, index) for index, each in enumerate(value)]
        return None if None in found else tuple(each for each in found if each is not None)

    def schema(self) -> Schema:
        return reference(f"number-{self.count}")


@dataclass(frozen=True, slots=True)
class Flag:
    """`true` or `false`."""

    def read(self, keys: Keys, value: Any, *at: str | int) -> bool | None:
        if isinstance(value, bool):
            return value
        keys.add("wrong-type", f"`{at[-1]}` of {keys.owner} is `true` or `false`, got {kind_of(value)}", *at)
        return None

    def schema(self) -> Schema:
        return reference("boolean")


@dataclass(frozen=True, slots=True)
class Words:
    """One of these words or a list of them, read as a tuple. Messages call each one a `noun`."""

    known: tuple[str, ...]
    noun: str

    def read(self, keys: Keys, value: Any, *at: str | int) -> tuple[str, ...]:
        listed = isinstance(value, list)
        if not value:
            key = f"`{at[-1] if at else keys.word}` of {keys.owner}"
            message = f"{key} expects {self.noun}s, got {'an empty list' if listed else kind_of(value)}"
            keys.add("wrong-type", message, *at, help=f"write one or more of {', '.join(self.known)}")
            return ()
        found = []
        for index, each in enumerate(value if listed else [value]):
            if isinstance(each, str) and each in self.known:
                found.append(each)
                continue
            place = (*at, index) if listed else at
            if not isinstance(each, str):
                keys.add(
                    "wrong-type",
                    f"{keys.owner} expects the name of a {self.noun}, got {kind_of(each)}",
                    *place,
                )
                continue
            help, fix = advised(each, self.known)
            note = exists_note(self.noun, self.known, each)
            message = f"{keys.owner} knows no {self.noun} `{each}`"
            keys.add("wrong-keyword", message, *place, notes=(note,), help=help, fix=fix)
        return tuple(dict.fromkeys(found))

    def schema(self) -> Schema:
        words: Schema = {"enum": list(self.known)}
        return {"anyOf": [words, {"type": "array", "items": words, "minItems": 1, "uniqueItems": True}]}


@dataclass(frozen=True, slots=True)
class Key:
    """One key: its form, its description, and its value if it is not written.

    With `needed`, an example of its value, the key is required.
    """

    name: str
    form: Form
    about: str
    default: Any = None
    needed: str | None = None

    def schema(self) -> Schema:
        shown = f" (default: {self.default:g})" if isinstance(self.default, float) else ""
        return {**self.form.schema(), "description": f"{self.about}{shown}"}


@dataclass(frozen=True, slots=True)
class Keyed:
    """A mapping with these keys and no others. Messages call each one a `noun`.

    >>> from mjcompose.language.checks.form import Keys
    >>> form = Keyed("How high.", Key("height", Number(above=0), "in metres", 1.0))
    >>> form.schema()["properties"]
    {'height': {'mjcf': 'number', 'exclusiveMinimum': 0, 'description': 'in metres (default: 1)'}}
    >>> form.read(Keys("tall", "height", {}, []))
    {'height': 1.0}
    """

    about: str
    keys: tuple[Key, ...]
    noun: str
    shapes: ClassVar[tuple[type, ...]] = (dict,)

    def __init__(self, about: str, *keys: Key, noun: str = "key") -> None:
        for name, value in (("about", about), ("keys", keys), ("noun", noun)):
            object.__setattr__(self, name, value)

    def read(self, keys: Keys) -> dict[str, Any]:
        """Return the value of each key. Faults are added to `keys`."""
        keys.known([key.name for key in self.keys], self.noun)
        for key in self.keys:
            if key.needed is not None and key.name not in keys.value:
                keys.lacks(key.name, key.needed)
        return {
            key.name: key.form.read(keys, keys.value[key.name], key.name)
            if key.name in keys.value
            else key.default
            for key in self.keys
        }

    def schema(self) -> Schema:
        schema: Schema = {
            "type": "object",
            "description": self.about,
            "properties": {key.name: key.schema() for key in self.keys},
        }
        if required := [key.name for key in self.keys if key.needed is not None]:
            schema["required"] = required
        return {**schema, "additionalProperties": False}

    def alone(self, given: Any) -> str | None:
        """Return the mapping to write instead of a text that can only be the name of a keyframe, or None."""
        word = next((key.name for key in self.keys if key.name in ("key", "keys")), None)
        if word is None or any(key.needed for key in self.keys) or not isinstance(given, str):
            return None
        return f"{{{word}: {given}}}"


class Check(Protocol):
    """One check of a recipe: its kind, its name, and its path from the top of the recipe."""

    @property
    def word(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def at(self) -> Path: ...


class CheckForm(Protocol):
    """The form of a check's value: a `Keyed` mapping, or one of its `shapes`."""

    @property
    def shapes(self) -> tuple[type, ...]: ...

    def read(self, keys: Keys) -> Any:
        """Return the argument of `make`. Faults are added to `keys`."""

    def schema(self) -> Schema:
        """Return the JSON Schema of the value."""


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of check. `example` is what messages recommend to write.

    `make` makes the check from what `form` has read, and may report more faults. After a fault its result is not
    used. A check that `needs_world` is about points in the world of its recipe, and cannot run in a nested recipe
    whose place is unknown. One that is not `is_in_mujoco` has a function `run` in place of `check` in its module.
    """

    word: str
    form: CheckForm
    make: Callable[[Keys, Any, Path], Check | None]
    example: str
    needs_world: bool = False
    is_in_mujoco: bool = True
