"""Rules about which keys of a mapping go together, for the reader and for the JSON Schema of editors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Protocol

from mjcompose.base.diagnostic import Fault, Note
from mjcompose.base.suggest import closest, exists_note
from mjcompose.language.forms.context import Settings
from mjcompose.language.forms.definitions import Schema
from mjcompose.language.forms.model import IT, OWNER, Model
from mjcompose.language.wording import EXCLUSIVE


class Rule(Protocol):
    """A condition on the keys of a mapping. If one that is `alone` is broken, no other fault is reported."""

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        """Yield the faults of the mapping, with paths below it. `IT` is the mapping."""

    def schema(self) -> Iterator[Schema]:
        """Yield conditions for `allOf`."""


class Exclusive:
    """At most one of some keys is written. `help` replaces the usual advice."""

    def __init__(self, *names: str, help: str | None = None) -> None:
        self.names, self.help = names, help

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        first, *others = [name for name in value if name in self.names] or [""]
        if others:
            last = others[-1]
            yield Fault(
                EXCLUSIVE,
                f"{IT} has both `{first}` and `{last}`, of which only one is allowed",
                (last,),
                key=True,
                related=((f"`{first}` is written here", (first,)),),
                help=self.help or f"leave `{first}` or `{last}` out",
                names=(first, last),
            )

    def schema(self) -> Iterator[Schema]:
        for index, name in enumerate(self.names[:-1]):
            # Not with `not`, for which an editor can only say that it does not hold.
            others: Schema = dict.fromkeys(self.names[index + 1 :], False)
            message = f"`{name}` exists already, and only one of the two is allowed"
            yield {"if": {"required": [name]}, "then": {"properties": others, "errorMessage": message}}


class OneOf(Exclusive):
    """Exactly one of some keys is written, or `unless`. Without any, `lacks` names the keys, and `advice` helps.

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
        self.lacks, self.advice, self.unless, self.noun = lacks, advice, unless, noun

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
    """At least one of some keys is written. Without any, `lacks` names the missing keys, and `advice` helps."""

    exclusive = False


class Belongs:
    """A key has a meaning only together with another one."""

    def __init__(self, name: str, to: str, *, help: str | None = None) -> None:
        self.name, self.to = name, to
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
    """If one key is written, some others are not. `why` says so of the mapping."""

    def __init__(self, name: str, *others: str, why: str) -> None:
        self.name, self.others, self.why = name, others, why

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        for other in value if self.name in value else ():
            if other in self.others:
                yield Fault(
                    EXCLUSIVE,
                    f"{IT} {self.why}, and has `{other}` as well",
                    (other,),
                    key=True,
                    related=((f"`{self.name}` is written here", (self.name,)),),
                    help=f"leave `{self.name}` or `{other}` out",
                )

    def schema(self) -> Iterator[Schema]:
        others: Schema = {**dict.fromkeys(self.others, False)}
        message = f"`{self.name}` stands without {', '.join(f'`{other}`' for other in self.others)}"
        yield {"if": {"required": [self.name]}, "then": {"properties": others, "errorMessage": message}}


class Needs:
    """Some keys are required unless another one is written. `examples` has a value for each."""

    def __init__(self, examples: Mapping[str, str], *, unless: str) -> None:
        self.examples, self.unless = examples, unless

    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        known = model.key_names()
        meant = {near for key in value if key not in known for near in closest(key, (*self.examples, self.unless))}
        if self.unless in value or self.unless in meant:
            return
        for name, example in self.examples.items():
            if name not in value and name not in meant:
                help = f"write `{name}: {example}`, or `{self.unless}` in its place"
                yield Fault("missing-key", f"{IT} lacks `{name}`", key=True, help=help, lacks=name)

    def schema(self) -> Iterator[Schema]:
        message = f"write {', '.join(f'`{name}`' for name in self.examples)}, or `{self.unless}`"
        needed = {"required": [*self.examples], "errorMessage": message}
        yield {"if": {"properties": {self.unless: False}}, "then": needed}
