"""What is asked of a build besides the recipe, and the question that this is to the cache."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from composer.cache.question import GIVEN, Question
from composer.cache.surroundings import environment_parts, python_version
from composer.cache.tool import tool_version


@dataclass(frozen=True, slots=True)
class Order:
    """How models are built.

    `text_beside` is the folder from which a model's text alone names its files, where that is wanted. `choices` are the
    values that the user gives to parameters and variants, by what a person calls them; `locked` and `offline` say how
    sources may be fetched.
    """

    verified: bool = True
    deduplicated: bool = False
    text_beside: Path | None = None
    choices: Mapping[str, str] = field(default_factory=dict)
    locked: bool = False
    offline: bool = False

    def question(self, recipe: Path, folder: Path, environment: Mapping[str, str], store: Path) -> Question:
        """The question for the model of a recipe file, as the user asks for it in a folder."""
        flags = {
            "`--no-verify`": not self.verified,
            "`--dedup`": self.deduplicated,
            "`--locked`": self.locked,
            "`--offline`": self.offline,
        }
        parts = {name: GIVEN for name, given in flags.items() if given}
        if self.text_beside is not None:
            parts["the folder of the text"] = os.fspath(self.text_beside)
        parts |= {
            "the current folder": os.fspath(folder),
            "mjcompose": tool_version(store),
            "Python": python_version(),
            **environment_parts(environment),
            **self.choices,
        }
        return Question(os.path.abspath(folder / recipe), parts)


def of_cell(question: Question, name: str, values: Mapping[str, str]) -> Question:
    """The question for one cell of the recipe's matrix."""
    return Question(f"{question.subject}: {name}", {**question.parts, **values})
