"""Recover a recipe from a merged model and its parts, build it, and list the remaining differences."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from pathlib import Path

from composer.bundle.bundle import Bundle
from composer.context import Context
from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.span import Span
from composer.diff.change import Change
from composer.document.quote import word
from composer.engine import Session
from composer.importing.contrasting import Outcome, Trial
from composer.importing.entries import Entry, Names
from composer.importing.likeness import Likeness
from composer.importing.match import Instance
from composer.importing.propose import Proposal, propose
from composer.importing.recipe_text import recipe_text
from composer.link.source_check import check_source
from composer.reading.unsaved import unsaved
from composer.stages import Request, build
from composer.tree.admitted import all_admitted
from composer.tree.parse import parse_file
from composer.tree.unit import Unit

_ROUNDS = 20


@dataclass(frozen=True, slots=True)
class Recovered:
    """A recovered recipe.

    `text` is the recipe; `bundle` is None if it does not build, for the reasons in `faults`. `outcome` is None if
    the models could not be compared; `refused` is MuJoCo's message if it rejects the merged model.
    """

    text: str
    proposal: Proposal
    bundle: Bundle | None
    faults: tuple[Diagnostic, ...]
    outcome: Outcome | None
    refused: str | None = None


def recover(
    merged: Path,
    parts: list[Path],
    out: Path,
    context: Context,
    progress: Callable[[str], None] = lambda _: None,
    references: Mapping[Path, str] | None = None,
) -> Recovered | None:
    """Return the recipe to write to `out`, or None if a model cannot be read, which `context.sink` reports.

    Entries that do not build become comments, one after the other, until the recipe builds. `progress` is called
    before each stage. `references` maps parts to the references that the recipe uses instead of paths.
    """
    before = context.sink.error_count
    read = [parse_file(path, context.sink, file=context.shown(path)) for path in (merged, *parts)]
    units: list[Unit] = [
        unit
        for unit in read
        if unit is not None
        and all_admitted(unit, context.sink, context.shown)  # MuJoCo opens the files that it names
        and check_source(unit, context.sink)
    ]
    if context.sink.error_count > before or len(units) < len(read):
        return None
    with Session() as session:
        recovery = _Recovery(
            merged,
            parts,
            out,
            context=context,
            session=session,
            progress=progress,
            units=units,
            references=references or {},
        )
        return recovery.recovered()


def whole_recipe(merged: Path, out: Path) -> str:
    """Return a recipe with the merged model as base, for a model whose parts are unknown."""
    return f"recipe: 1\nname: {word(out.stem)}\nbase: {word(_reference(merged, out.parent))}\n"


class _Recovery:
    def __init__(
        self,
        merged: Path,
        parts: list[Path],
        out: Path,
        context: Context,
        session: Session,
        progress: Callable[[str], None],
        units: list[Unit],
        references: Mapping[Path, str],
    ) -> None:
        self.references = references
        self.merged, self.parts, self.out, self.units = merged, parts, out, units
        self.context, self.session, self.progress = context, session, progress
        self.trial = Trial(merged, parts, session)

    def recovered(self) -> Recovered:
        self.progress(f"compiling {self.context.shown(self.merged)} and its parts")
        proposal = self.proposal(self.trial.likeness)
        found = self.settled(proposal)
        if self.trial.compared and (found.outcome is None or not found.outcome.same):
            # An element that counted as the same may still be the reason.
            other = self.settled(self.proposal(lambda _, __: Likeness()))
            if other.outcome is not None and (
                found.outcome is None or other.outcome.amount < found.outcome.amount
            ):
                found = other
        for number, part in enumerate(self.parts):
            if not any(each.part == number for each in proposal.found):
                self.context.sink.warning(
                    "unknown-name",
                    f"`{self.context.shown(part)}` is nowhere in `{self.context.shown(self.merged)}`: no body and what "
                    "stands in it have its names",
                    help="only parts whose names are kept, with a prefix or without, are found",
                )
        return found

    def proposal(self, likeness: Callable[[Instance, Names], Likeness]) -> Proposal:
        references = [self.references.get(path) or _reference(path, self.out.parent) for path in self.parts]
        return propose(
            self.units[0],
            self.units[1:],
            references,
            relative=lambda file: _reference(file, self.out.parent),
            likeness=likeness,
        )

    def settled(self, proposal: Proposal) -> Recovered:
        """Return the proposal without the entries that do not build, and with the keys that it lacked."""
        out, context = self.out, self.context
        for number in range(_ROUNDS):
            self.progress(
                "trying the recipe" if not number else f"trying the recipe without what failed ({number})"
            )
            text, places = recipe_text(proposal)
            bundle, faults = self.built(text)
            guilty = [
                (places[line], fault) for fault in faults if (line := _line(fault, out, context)) in places
            ]
            if bundle is not None or not guilty:
                break
            for entry, fault in guilty:
                entry.note = " ".join(fault.message.split())
        outcome = None if bundle is None else self.trial.outcome(proposal)
        missing = [] if outcome is None else [each.name for each in outcome.lost_keys if _has_name(each)]
        if missing:  # with a key of that name, its values can be compared
            blank = [Entry("keyframe", f"{word(name)}: {{}}") for name in missing]
            bundle, _ = self.built(recipe_text(replace(proposal, entries=[*proposal.entries, *blank]))[0])
            outcome = None if bundle is None else self.trial.outcome(proposal)
        changes = outcome.changes if outcome is not None else ()
        keys = keyframes(changes, proposal, missing)
        for each in changes:
            if each.kind == "key" and each.what == "removed" and not _has_name(each):
                note = "a key without a name; the keys of a recipe have one"
                proposal.entries.append(Entry("keyframe", f"key_{each.index[0]}: {{}}", note))
                text, _ = recipe_text(proposal)
        if keys:
            self.progress("trying the recipe with its keyframes")
            proposal.entries += keys
            text, _ = recipe_text(proposal)
            bundle, faults = self.built(text)
            outcome = None if bundle is None else self.trial.outcome(proposal)
        return Recovered(
            text, proposal, bundle, faults=tuple(faults), outcome=outcome, refused=self.trial.refused
        )

    def built(self, text: str) -> tuple[Bundle | None, list[Diagnostic]]:
        """Build the text as if it were at `out`."""
        from composer.bundle.staging import sibling

        out, context = self.out, self.context
        trial = sibling(out, "trial")  # which is never written
        own = Context(environment=context.environment, folder=context.folder)
        with unsaved({os.path.realpath(trial): text.encode()}):
            result = build(Request(trial), own, session=self.session)
        faults = [
            replace(each, span=_at(each, trial, out, context=own), others=(), cells=())
            for each in own.sink.errors
        ]
        return (None if result is None else result.bundle), faults


def _at(fault: Diagnostic, trial: Path, out: Path, context: Context) -> Span | None:
    """Return the place of a fault in the file to be written."""
    if fault.span is None or fault.span.file != context.shown(trial):
        return fault.span
    return replace(fault.span, file=context.shown(out))


def _line(fault: Diagnostic, out: Path, context: Context) -> int:
    return fault.span.line if fault.span is not None and fault.span.file == context.shown(out) else 0


def _reference(path: Path, folder: Path) -> str:
    relative = os.path.relpath(os.path.abspath(path), os.path.abspath(folder)).replace(os.sep, "/")
    return relative if relative.startswith(".") else f"./{relative}"


def _has_name(key: Change) -> bool:
    return not key.name.startswith("#")


def keyframes(changes: Collection[Change], proposal: Proposal, missing: Collection[str] = ()) -> list[Entry]:
    """Return entries for keys of the merged model that the parts' keys do not produce, with the differing values.

    No part has anything for the keys in `missing`.
    """
    rows: dict[str, dict[str, dict[str, str]]] = {name: {} for name in missing}
    for each in changes:
        if each.kind == "key" and each.entry and _has_name(each) and not each.entry.startswith("#"):
            given = each.before if isinstance(each.before, tuple) else (each.before,)
            values = [value for value in given if isinstance(value, float)]
            unit = "rad" if len(values) == 1 and "angle: degree" in proposal.head else ""
            numbers = f"[{', '.join(f'{value:.9g}{unit}' for value in values)}]"
            rows.setdefault(each.name, {}).setdefault(each.field.removeprefix("key_"), {})[each.entry] = (
                numbers
            )
    entries = []
    for name, row in rows.items():
        said = ", ".join(
            f"{field}: {{{', '.join(f'{word(k)}: {v}' for k, v in values.items())}}}"
            for field, values in row.items()
        )
        sources = [] if name in missing else proposal.keys.get(name, [])
        start = (
            f"from: {{{', '.join(f'{word(each)}: {word(name)}' for each in sources)}}}, " if sources else ""
        )
        entries.append(Entry("keyframe", f"{word(name)}: {{{start}{said}}}"))
    return entries
