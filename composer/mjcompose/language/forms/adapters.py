"""Models in the place of older forms, and these side by side, until the last of them has become a model."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from pydantic import ValidationError

from mjcompose.base.diagnostic import Path
from mjcompose.language.checks.form import Keys
from mjcompose.language.form import Schema, Settings
from mjcompose.language.forms.json_schema import schema_of
from mjcompose.language.forms.model import Model
from mjcompose.language.forms.rows import first_line, validated
from mjcompose.language.forms.translate import faults
from mjcompose.language.forms.walk import is_model
from mjcompose.language.verb import Verb
from mjcompose.language.verbs import values as verbs


class CheckModel(Model):
    """The value behind the word of a check: at `check.NAME.WORD`."""

    @classmethod
    def subject(cls, at: Path) -> str:
        return f"`{at[2]}` of check `{at[1]}`" if len(at) > 2 else super().subject(at)

    @classmethod
    def owner(cls, at: Path) -> str:
        return f"check `{at[1]}`" if len(at) > 1 else super().owner(at)


class CheckForm:
    """The form of a check whose value is a model, or a list of models."""

    def __init__(self, form: Any) -> None:
        self.form, self.shapes = form, (dict,) if is_model(form) else (list,)

    def read(self, keys: Keys) -> Any:
        """Return the model, or None after reported faults."""
        try:
            return validated(self.form, keys.value, Settings())
        except ValidationError as error:
            start: Path = ("check", keys.name, keys.word)
            for each in faults(error, self.form, keys.value, start=start):
                related = tuple((text, at[1:]) for text, at in each.related)
                keys.faults.append(replace(each, at=each.at[1:], related=related))
            return None

    def schema(self) -> Schema:
        """Return the JSON Schema of the value."""
        return schema_of(self.form)


def verb(name: str, form: type[Verb]) -> verbs.Verb:
    """Return the row of a verb whose value is a model."""

    def read(value: Any, selected: verbs.Selected) -> Verb | None:
        context = Settings(selected.checker.bare_angles, selected=selected.selector)
        try:
            return form.model_validate(value, context=context)
        except ValidationError as error:
            for each in faults(error, form, value, start=selected.at):
                selected.add(each)
            return None

    def words(value: Verb) -> str:
        return value.words()

    def changes(tag: str | None, value: Verb) -> verbs.Changed:
        return value.changes(tag)

    return verbs.Verb(
        name,
        first_line(form.__doc__ or ""),
        read,
        words=words,
        changes=None if form.reshapes else changes,
        schema=lambda: schema_of(form),
        alone=form.alone,
    )
