"""Models in the place of older forms, and these side by side, until the last of them has become a model."""

from __future__ import annotations

from typing import Any

from pydantic import ValidationError

from mjcompose.language.form import Settings
from mjcompose.language.forms.json_schema import schema_of
from mjcompose.language.forms.rows import first_line
from mjcompose.language.forms.translate import faults
from mjcompose.language.verb import Verb
from mjcompose.language.verbs import values as verbs


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
