"""The base class of every mapping of the language, its rules on keys, and the reports of its validation.

A message is written by `translate.py`, which knows the place of a value. Therefore the faults of rules and validators
have marks for facts that they cannot know: `IT` is the value itself, `OWNER` is the mapping around it, and `KEY` is its
key.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, Final, Literal, Protocol, get_args, get_origin

from pydantic import (
    BaseModel,
    ConfigDict,
    GetJsonSchemaHandler,
    PrivateAttr,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic_core import CoreSchema

from mjcompose.base.diagnostic import Fault, Note, Path
from mjcompose.base.suggest import closest, exists_note
from mjcompose.base.words import value_text
from mjcompose.language.element import path_of
from mjcompose.language.forms.context import Schema, Settings, settings, validated_with, validation_error
from mjcompose.language.value import exclusive

if TYPE_CHECKING:
    from mjcompose.language.forms.context import Rows


# Characters for private use, which no recipe can contain: a name with braces in it is never taken for a mark.
IT = "\ue001"
OWNER = "\ue002"
KEY = "\ue003"
WHOLE: Final = "<value>"
"""The alias of a model's only field, if you write the value itself instead of a mapping."""


def is_hidden(step: str | int) -> bool:
    """Return whether a step of pydantic's path is not in the recipe: an alternative of a union, or a hidden key.

    >>> is_hidden("<value>"), is_hidden("value"), is_hidden(0)
    (True, False, False)
    """
    return isinstance(step, str) and step.startswith("<") and step.endswith(">")


class Model(BaseModel):
    """A mapping with fixed keys, in the order in which `fmt` writes them; the text below a field describes its key.

    `rules` say which keys exclude or need one another. `short` is the key of a value that is written without a mapping:
    a text, or a value of `short_type`. Messages recommend `example`, in which `…` is the written text, and call a key
    by its `noun`. `instead` maps wrong words to the right key, or to a help line. `called` is the mapping's name in
    messages, with `{}` for the last step of its path, and `owned` the owner of its keys, if it is not the mapping. One
    that `keeps_written` has the value from which it was made as `_written`.

    No key accepts null. Values are not converted, except whole numbers where any number is accepted.
    """

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        allow_inf_nan=False,
        protected_namespaces=(),
        # Most models are never validated on their own. Building their validators would be most of the import time.
        defer_build=True,
        hide_input_in_errors=True,
    )
    rules: ClassVar[tuple[KeyRule, ...]] = ()
    short: ClassVar[str | None] = None
    short_type: ClassVar[type | tuple[type, ...]] = str
    example: ClassVar[str] = ""
    noun: ClassVar[str] = "key"
    instead: ClassVar[Mapping[str, str]] = {}
    called: ClassVar[str | None] = None
    owned: ClassVar[str | None] = None
    keeps_written: ClassVar[bool] = False
    _at: Path = PrivateAttr(())

    @property
    def at(self) -> Path:
        return self._at

    @classmethod
    def subject(cls, at: Path) -> str:
        """Return how messages call the mapping at a path."""
        if not at:
            return "the recipe"
        if cls.called is not None:
            return cls.called.format(at[-1])
        return f"`{at[-1]}`" if isinstance(at[-1], str) or len(at) < 2 else f"an entry of `{at[-2]}`"

    @classmethod
    def owner(cls, at: Path) -> str:
        """Return the owner of a key in messages; empty for nothing."""
        return cls.subject(at) if cls.owned is None else cls.owned.format(*at[-1:])

    @classmethod
    def key_names(cls) -> list[str]:
        names: list[str] = []
        for key, info in fields_of(cls).items():
            rows = rows_of(info)
            names += rows.table().own if rows is not None else [] if is_hidden(key) else [key]
        return names

    @classmethod
    def listed(cls) -> list[str]:
        """Return the keys in the order in which messages list them; messages cut off the end."""
        return cls.key_names()

    def contradictions(self, context: Settings) -> Iterable[Fault]:
        """Yield faults of values that are right alone but wrong together, only if there are no other faults."""
        return ()

    @model_validator(mode="wrap")
    @classmethod
    def _with_rules(cls, value: Any, handler: ValidatorFunctionWrapHandler, info: ValidationInfo) -> Any:
        at = path_of(value)
        written = value
        context = settings(info.context)
        faults: list[Fault] = []
        if is_whole(cls):
            value = {WHOLE: value}
        elif cls.short is not None and isinstance(value, cls.short_type):
            value = {cls.short: value}
        if isinstance(value, dict):
            value = _with_exact_words(cls, value)
            for rule in cls.rules:
                faults += rule.faults(value, cls, context)
                if faults and getattr(rule, "alone", False):
                    raise validation_error(faults, value)
            faults += [
                Fault("wrong-type", f"`{key}` of {OWNER} has no value", (key,))
                for key in (cls.key_names() if any(each is None for each in value.values()) else ())
                if value.get(key, ...) is None
            ]
            value = _with_rows(cls, value)
        made = validated_with(handler, value, faults)
        if at:
            made._at = at
        if cls.keeps_written:
            made._written = written
        if contradictions := list(made.contradictions(context)):
            raise validation_error(contradictions, value)
        return made

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> Schema:
        from mjcompose.language.forms.json_schema import of_model  # which most runs do not need

        return of_model(cls, schema, handler)


def fields_of(model: type[BaseModel]) -> dict[str, FieldInfo]:
    """Return the fields of a model by their keys; the key of a field without a key is in angle brackets."""
    return {info.alias or name: info for name, info in model.model_fields.items()}


@cache
def is_whole(model: type[Model]) -> bool:
    return any(info.alias == WHOLE for info in model.model_fields.values())


def rows_of(info: FieldInfo) -> Rows | None:
    return next((each for each in info.metadata if getattr(each, "is_rows", False)), None)


@cache
def _inexact(model: type[BaseModel]) -> dict[str, tuple[Any, ...]]:
    words = {key: _words(info.annotation) for key, info in fields_of(model).items()}
    return {key: each for key, each in words.items() if not all(isinstance(word, str) for word in each)}


def _words(annotation: Any) -> tuple[Any, ...]:
    if get_origin(annotation) is Literal:
        return get_args(annotation)
    return tuple(word for each in get_args(annotation) for word in _words(each))


def _with_exact_words(model: type[Model], value: dict[str, Any]) -> dict[str, Any]:
    """Return the mapping with values as texts that only equal a word: for pydantic, 1 is the word `true`."""
    for key, words in _inexact(model).items():
        written = value.get(key)
        same = [type(word) for word in words if word == written]
        if same and type(written) not in same:
            value = {**value, key: value_text(written)}
    return value


class Rest:
    """A mark of a field with an alias in angle brackets that reads the whole mapping, for keys without a field."""


def rest_of(model: type[BaseModel]) -> str | None:
    return next(
        (key for key, info in fields_of(model).items() if any(isinstance(m, Rest) for m in info.metadata)), None
    )


def _with_rows(model: type[Model], value: dict[str, Any]) -> dict[str, Any]:
    """Return the mapping with the keys that are words of a table put into the field for these."""
    if (rest := rest_of(model)) is not None and model.short not in value:
        own = model.key_names()
        return {**{key: each for key, each in value.items() if key in own}, rest: value}
    for alias, rows in _tables(model):
        table = rows.table()
        words = {key: each for key, each in value.items() if key in table}
        value = {key: each for key, each in value.items() if key not in words}
        if words:
            value[alias] = words
    return value


@cache
def _tables(model: type[Model]) -> list[tuple[str, Rows]]:
    hidden = [info for info in model.model_fields.values() if info.alias is not None and is_hidden(info.alias)]
    return [(str(info.alias), rows) for info in hidden if (rows := rows_of(info)) is not None]


class KeyRule(Protocol):
    """A condition on the keys of a mapping. If a rule that is `alone` is broken, no other fault is reported."""

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        """Yield the faults of the mapping, with paths below it. `IT` is the mapping."""

    def schema(self) -> Iterator[Schema]:
        """Yield conditions for `allOf`."""


class Exclusive:
    """At most one of several keys is written. `help` replaces the usual advice."""

    def __init__(self, *names: str, help: str | None = None) -> None:
        self.names = names
        self.help = help

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        first, *others = [name for name in value if name in self.names] or [""]
        if others:
            message = f"{IT} has both `{first}` and `{others[-1]}`, of which only one is allowed"
            yield exclusive(message, (first, others[-1]), help=self.help)

    def schema(self) -> Iterator[Schema]:
        for index, name in enumerate(self.names[:-1]):
            # Not with `not`, for which an editor can only say that it does not hold.
            others: Schema = dict.fromkeys(self.names[index + 1 :], False)
            message = f"`{name}` exists already, and only one of the two is allowed"
            yield {"if": {"required": [name]}, "then": {"properties": others, "errorMessage": message}}


class OneOf(Exclusive):
    """Exactly one of several keys is written, or `unless`. Without any, `lacks` names the keys, and `advice` helps.

    `noun` is a note's word for the keys that exist; without it there is no note.
    """

    exclusive = True

    def __init__(
        self,
        *names: str,
        lacks: str,
        advice: str,
        help: str | None = None,
        unless: str | None = None,
        noun: str | None = None,
    ) -> None:
        super().__init__(*names, help=help)
        self.lacks = lacks
        self.advice = advice
        self.unless = unless
        self.noun = noun

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        if self.exclusive:
            yield from super().faults(value, model, context)
        if any(name in value for name in (*self.names, self.unless)):
            return
        unknown = [key for key in value if key not in model.key_names()]
        if not any(closest(key, self.names) or model.instead.get(key) in self.names for key in unknown):
            notes: tuple[Note, ...] = (exists_note(self.noun, self.names),) if self.noun else ()
            yield Fault("missing-key", f"{IT} {self.lacks}", key=True, notes=notes, help=self.advice)

    def schema(self) -> Iterator[Schema]:
        if self.exclusive:
            yield from super().schema()
        # Not with `anyOf`, whose errors an editor cannot explain.
        none: Schema = dict.fromkeys((*self.names, *([self.unless] if self.unless else [])), False)
        yield {"if": {"properties": none}, "then": {"required": [self.names[0]], "errorMessage": self.advice}}


class AnyOf(OneOf):
    """At least one of several keys is written. Without any, `lacks` names the missing keys, and `advice` helps."""

    exclusive = False


class Belongs:
    """A key has a meaning only together with another key."""

    def __init__(self, name: str, to: str, *, help: str | None = None) -> None:
        self.name = name
        self.to = to
        self.help = help or f"write `{to}` next to it, or omit `{name}` out"

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        choices = [
            rule.names
            for rule in model.rules
            if isinstance(rule, OneOf) and self.to in rule.names and rule.unless not in value
        ]
        is_open = any(value.keys().isdisjoint(names) for names in choices)  # which is said already
        if self.name in value and self.to not in value and not is_open:
            message = f"`{self.name}` of {OWNER} belongs to `{self.to}`"
            yield Fault("unknown-key", message, (self.name,), key=True, help=self.help)

    def schema(self) -> Iterator[Schema]:
        refused = {"properties": {self.name: False}, "errorMessage": f"`{self.name}` belongs to `{self.to}`"}
        yield {"if": {"not": {"required": [self.to]}}, "then": refused}


class Bars:
    """If one key is written, certain other keys must not be written. `why` says this about the mapping."""

    def __init__(self, name: str, *others: str, why: str) -> None:
        self.name = name
        self.others = others
        self.why = why

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        if self.name in value:
            for other in value:
                if other in self.others:
                    yield exclusive(f"{IT} {self.why}, and has `{other}` as well", (self.name, other))

    def schema(self) -> Iterator[Schema]:
        others: Schema = {**dict.fromkeys(self.others, False)}
        message = f"`{self.name}` stands without {', '.join(f'`{other}`' for other in self.others)}"
        yield {"if": {"required": [self.name]}, "then": {"properties": others, "errorMessage": message}}


class Needs:
    """Some keys are required unless another one is written, such as the first of `unless`, which messages name.

    `examples` has a value for each required key.
    """

    def __init__(self, examples: Mapping[str, str], *, unless: tuple[str, ...]) -> None:
        self.examples = examples
        self.unless = unless

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        known = model.key_names()
        meant = {near for key in value if key not in known for near in closest(key, (*self.examples, *self.unless))}
        if any(name in value or name in meant for name in self.unless):
            return
        for name, example in self.examples.items():
            if name not in value and name not in meant:
                help = f"write `{name}: {example}`, or `{self.unless[0]}` in its place"
                yield Fault("missing-key", f"{IT} lacks `{name}`", key=True, help=help, lacks=name)

    def schema(self) -> Iterator[Schema]:
        message = f"write {', '.join(f'`{name}`' for name in self.examples)}, or `{self.unless[0]}`"
        needed = {"required": [*self.examples], "errorMessage": message}
        yield {"if": {"properties": dict.fromkeys(self.unless, False)}, "then": needed}
