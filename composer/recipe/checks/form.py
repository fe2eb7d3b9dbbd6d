"""The forms of a check's keys: how each value is read, its JSON Schema, and its description."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any, Protocol

from composer.dataclass import dataclass
from composer.diagnostics.suggest import advised, exists_note
from composer.recipe.checks.keys import Keys
from composer.recipe.pattern import GLOB
from composer.recipe.reference import Schema, reference
from composer.recipe.shown import kind_of


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


@dataclass(frozen=True, slots=True)
class Number:
    """A finite number that is at least `least`, or greater than `above`."""

    least: float | None = None
    above: float | None = None

    def read(self, keys: Keys, value: Any, *at: str | int) -> float | None:
        return keys.number_of(value, *at, least=self.least, above=self.above)

    def schema(self) -> Schema:
        bounds = {"minimum": self.least, "exclusiveMinimum": self.above}
        return {**reference("number"), **{key: each for key, each in bounds.items() if each is not None}}


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
class Words:
    """One of these words or a list of them, read as a tuple. Messages call each one a `noun`.

    `elsewhere` has the help for words that are right in other places.
    """

    known: tuple[str, ...]
    noun: str
    elsewhere: Mapping[str, str] = field(default_factory=dict)

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
            if each in self.elsewhere:
                message, help, fix = f"{keys.owner} cannot use `{each}`", self.elsewhere[each], None
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

    >>> from composer.recipe.checks.keys import Keys
    >>> form = Keyed("How high.", Key("height", Number(above=0), "in metres", 1.0))
    >>> form.schema()["properties"]
    {'height': {'mjcf': 'number', 'exclusiveMinimum': 0, 'description': 'in metres (default: 1)'}}
    >>> form.read(Keys("tall", "height", {}, []))
    {'height': 1.0}
    """

    about: str
    keys: tuple[Key, ...]
    noun: str

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
