"""The key of a model in the build cache: everything that determines the result besides the contents of files.

A model is looked up twice. The first key, before anything is read, has the path of the recipe, the options and the
versions, and the recipe is one of the files that must be unchanged; this takes a quarter of the time for reading
and planning the recipe. The second key, after planning, is `of_plan`, with the concrete recipe in place of the path
and the given values; it still matches if the recipe file changed in ways that do not matter.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING

from composer.cache.environment import environment_parts, python_version, tool_version
from composer.cache.reasons import GIVEN
from composer.dataclass import dataclass
from composer.sources.blobs import key_of

if TYPE_CHECKING:
    from composer.document.node import Node
    from composer.plan.plan import Plan
    from composer.sources.source import Source


@dataclass(frozen=True, slots=True)
class CacheKey:
    """The key of a model in the build cache.

    `subject` is the thing being built, whatever its inputs: its last build shows why a new one is needed. `parts`
    are all values that count, by their names for the user.
    """

    subject: str
    parts: Mapping[str, str]

    @property
    def digest(self) -> str:
        return key_of([self.subject, sorted(self.parts.items())])

    @property
    def subject_digest(self) -> str:
        return key_of([self.subject])

    def of_cell(self, name: str, values: Mapping[str, str]) -> CacheKey:
        """Return the key of one cell of the recipe's matrix."""
        return CacheKey(f"{self.subject}: {name}", {**self.parts, **values})

    def of_plan(self, plan: Plan, cell: str | None, choices: Mapping[str, str]) -> CacheKey:
        """Return the key of a plan, independent of the recipe file; `choices` are part of the plan already."""
        parts = {name: value for name, value in self.parts.items() if name not in choices}
        planned = {"cell": cell or "", "sample": str(plan.sample), "plan": key_of(concrete(plan))}
        return CacheKey("", {**parts, **planned})


@dataclass(frozen=True, slots=True)
class BuildOptions:
    """The options of builds.

    `text_beside` is the folder from which a model's text refers to its files, if only text is wanted. `choices` are
    the given values of parameters and variants, by their names for the user; `locked` and `offline` limit how
    sources are fetched.
    """

    verified: bool = True
    deduplicated: bool = False
    text_beside: Path | None = None
    choices: Mapping[str, str] = field(default_factory=dict)
    locked: bool = False
    offline: bool = False
    pictured: bool = False
    target: str | None = None

    def key(self, recipe: Path, folder: Path, environment: Mapping[str, str], store: Path) -> CacheKey:
        """Return the key of the model of a recipe file, with these options."""
        flags = {
            "`--no-verify`": not self.verified,
            "`--dedup`": self.deduplicated,
            "`--locked`": self.locked,
            "`--offline`": self.offline,
            "`--picture`": self.pictured,
        }
        parts = {name: GIVEN for name, given in flags.items() if given}
        if self.target is not None:
            parts["`--target`"] = self.target
        if self.text_beside is not None:
            parts["the folder of the text"] = os.fspath(self.text_beside)
        parts |= {
            "the current folder": os.fspath(folder),
            "mjcompose": tool_version(store),
            "Python": python_version(),
            **environment_parts(environment),
            **self.choices,
        }
        return CacheKey(os.path.abspath(folder / recipe), parts)


def concrete(plan: Plan) -> list[object]:
    """Return everything that determines the result of a plan besides the contents of files, as JSON data. No I/O.

    Lines and columns in recipes are left out, but not the files, because paths are relative to them.
    """
    found: list[object] = []
    for each in plan.plans():
        scope = [[name, repr(value)] for name, value in sorted(each.scope.items())]
        values = list(_values(each.document, ""))
        read = [
            [file, settings.angle, settings.eulerseq] for file, settings in each.angle_context.others.items()
        ]
        sources = [_source(each.base.model), *(_source(part.model) for part in each.parts)]
        found.append([each.name, str(each.path), scope, values, read, sources])
    return found


def _source(model: Plan | Source | None) -> object:
    from composer.sources.source import Source

    if not isinstance(model, Source):
        return model is None
    licences, packages = [map(str, model.licences), ((name, str(path)) for name, path in model.packages)]
    about = [str(model.path), model.kind.name, model.reference, model.package, model.version]
    origin = model.origin.id if model.origin else None
    return [*about, list(licences), list(packages), repr(model.urdf), origin, list(model.door.roots)]


def _values(node: Node, file: str) -> Iterator[object]:
    from composer.document.node import Mapping, Scalar, Sequence  # a model that is known has no use for it

    if node.span.file != file:
        file = node.span.file
        yield ["in", file]
    if isinstance(node, Scalar):
        yield [node.text, node.plain, repr(node.value)]
        return
    yield "{" if isinstance(node, Mapping) else "["
    if isinstance(node, Sequence):
        for item in node.items:
            yield from _values(item, file)
    else:
        for name, (_, value) in node.entries.items():
            yield name
            yield from _values(value, file)
    yield "."
