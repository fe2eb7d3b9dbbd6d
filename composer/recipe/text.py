"""Text in a recipe: free text, and the keywords of the language's own keys."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, get_args

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidatorFunctionWrapHandler
from pydantic_core import CoreSchema, core_schema

from composer.dataclass import dataclass
from composer.diagnostics.fix import Fix
from composer.diagnostics.suggest import closest, exists_note, renaming
from composer.recipe.fault import Fault, Path, validation_error
from composer.recipe.form import Form
from composer.recipe.reference import Schema
from composer.recipe.settings import Settings
from composer.recipe.shown import kind_of, shown

# Characters that no XML file can contain, not even escaped.
_UNPRINTABLE = frozenset(
    map(chr, (*range(9), 11, 12, *range(14, 32), 0xFFFE, 0xFFFF, *range(0xD800, 0xE000)))
)


def is_unprintable(text: str) -> bool:
    """Return whether a text has a character that XML cannot contain."""
    return not _UNPRINTABLE.isdisjoint(text)


def unprintable(subject: str, at: Path, *, key: bool = False, name: bool = True) -> Fault:
    """Return the fault of a text with such a character."""
    return Fault(
        "bad-name" if name else "wrong-type", f"{subject} has a character that XML cannot hold", at, key=key
    )


@dataclass(frozen=True, slots=True)
class Text(Form):
    """Form of a text of at least one character. `key` is its name in messages.

    `check` may find further faults.
    """

    key: str
    empty: bool = False
    check: Callable[[str], Fault | None] | None = None

    def schema(self) -> Schema:
        return {"type": "string"} if self.empty else {"type": "string", "minLength": 1}

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> str:
        fault = self.fault(value)
        faults += [] if fault is None else [fault]
        return str(value)

    def fault(self, value: Any) -> Fault | None:
        if not isinstance(value, str):
            help = None if isinstance(value, list | dict) or value is None else f"quote it: '{shown(value)}'"
            return Fault("wrong-type", f"`{self.key}` expects text, got {kind_of(value)}", help=help)
        if not value and not self.empty:
            return Fault("wrong-type", f"`{self.key}` is empty")
        if is_unprintable(value):
            return unprintable(f"`{self.key}`", ())
        return None if self.check is None else self.check(value)


@dataclass(frozen=True, slots=True)
class Choice:
    """Form of a `Literal` of keywords. `key` is its name in messages.

    If it is `chosen`, it may also be a `${…}`, for editors too. `former` has keywords that are no more, each with the
    one to write instead.
    """

    key: str
    chosen: bool = False
    former: tuple[tuple[str, str], ...] = ()

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        words = _words(source)

        def read(value: Any, handler: ValidatorFunctionWrapHandler) -> str:
            if isinstance(value, str) and value in words:
                return value
            raise validation_error([self.fault(value, words)], value)

        # The inner schema is only used for the JSON Schema.
        return core_schema.no_info_wrap_validator_function(read, core_schema.literal_schema(list(words)))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> Schema:
        words = handler(schema)
        return words if not self.chosen else {"anyOf": [words, {"type": "string", "pattern": r"\$\{"}]}

    def fault(self, value: Any, words: tuple[str, ...]) -> Fault:
        if not isinstance(value, str):
            return Fault(
                "wrong-type", f"`{self.key}` expects a keyword, got {kind_of(value)}", help=_one_of(words)
            )
        instead = dict(self.former).get(value)
        near = [instead] if instead else closest(value, words)
        near = near or [word for word in words if len(value) > 1 and word.startswith(value)]
        return Fault(
            "wrong-keyword",
            f"`{self.key}` cannot be `{value}`",
            notes=(exists_note("keyword", words, value),),
            help=f"write `{self.key}: {near[0]}`" if near else None,
            fix=Fix(instead, value) if instead else renaming(value, words),
        )


def _words(source: Any) -> tuple[str, ...]:
    """Return the keywords of `Literal[…]`, or of `Literal[…] | None`."""
    return tuple(
        word for each in get_args(source) for word in ([each] if isinstance(each, str) else get_args(each))
    )


def _one_of(words: tuple[str, ...]) -> str:
    return f"write one of {', '.join(f'`{word}`' for word in words)}"
