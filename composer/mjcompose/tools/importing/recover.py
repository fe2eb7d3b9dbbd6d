"""Recover a recipe, build it, and compare it with the merged model."""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from functools import partial
from itertools import groupby
from pathlib import Path

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct, dataclass
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.base.files import unsaved
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import closest
from mjcompose.base.words import counted
from mjcompose.bundle.bundle import MODEL, Bundle
from mjcompose.bundle.staging import sibling
from mjcompose.contrast.changes import Contrast, FieldChange, Value
from mjcompose.contrast.models import contrast, contrast_of
from mjcompose.contrast.text import sentences, shown, subject
from mjcompose.link.corrections import Correction, keep_first, without_attribute, without_reference
from mjcompose.link.names import referring_attribute, rename
from mjcompose.link.source_check import check_source
from mjcompose.mujoco.engine import Session, call, compile
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.text.dump import Data, to_yaml
from mjcompose.text.faults import word
from mjcompose.tools.importing import elements
from mjcompose.tools.importing.folding import folded
from mjcompose.tools.importing.propose import Proposal, in_order, propose, recipe_text
from mjcompose.tools.importing.search import Instance, parent_body
from mjcompose.tree.classes import MAIN
from mjcompose.tree.names import may_be_generated
from mjcompose.tree.parse import all_admitted, parse_file
from mjcompose.tree.unit import Unit
from mjcompose.verify.compile import WHOLE

_TOLERANCE = 1e-7
_MERGED = "merged"


class RecoveryDifferences(Struct):
    """The differences of the recipe's model, B, from the merged model, A, with the recipe's names.

    `rounded` are numbers that are equal to six digits only: MuJoCo writes six when it saves a model.
    """

    changes: tuple[FieldChange, ...] = ()
    rounded: tuple[FieldChange, ...] = ()

    @property
    def same(self) -> bool:
        return not self.changes


def _lost_without_name(seen: Contrast, proposal: Proposal) -> list[FieldChange]:
    """Return the removals of unnamed keys, which `contrast` cannot match."""
    keys = [each.what for each in seen.changes if each.kind == "key"]
    before, after = seen.elements["key"]
    lost = (before - keys.count("removed")) - (after - keys.count("added"))
    numbers = proposal.nameless_keys[: max(lost, 0)]
    return [FieldChange("removed", "key", f"#{number}", index=(number, -1)) for number in numbers]


def _only_name(change: FieldChange, proposal: Proposal) -> bool:
    """Return whether only names or signs differ.

    That is an equal asset under another name, or an additional one, or a negated quaternion.
    """
    ours = elements.numbers_likeness(change.before)
    theirs = elements.numbers_likeness(change.after)
    if change.field.endswith("quat") and ours and theirs:
        return all(abs(a + b) <= _TOLERANCE for a, b in zip(ours, theirs, strict=True))
    if change.what == "added":
        return change.kind in ("texture", "material", "mesh", "hfield", "skin") and change.name in proposal.alike
    wanted = change.before
    there = change.after
    if not isinstance(wanted, str) or not isinstance(there, str):
        return False
    own = proposal.alike.get(there)
    names = [wanted, *(each.out + wanted for each in proposal.found)]
    return there in names or (own is not None and any(proposal.alike.get(name) == own for name in names))


def changed(facts: tuple[elements.ChangedAttribute, ...]) -> Iterator[str]:
    """Yield one line for each changed attribute: ``mesh `elbow`: scale 1 1 1 → 1.1 1.1 1.1``."""
    alike: dict[elements.ChangedAttribute, list[elements.ChangedAttribute]] = defaultdict(list)
    for each in facts:
        alike[replace(each, name="")].append(each)
    for each, several in alike.items():
        unit = f" {each.unit}" if each.unit else ""
        before, after = ("none" if value is None else f"{value}{unit}" for value in (each.before, each.after))
        of = subject(each.kind, [one.name for one in several])
        alone = f" ({each.count} elements)" if each.count > 1 else ""
        yield f"{of}: {each.attribute} {before} → {after}{alone}"


def _one_sided(changes: Iterable[FieldChange], merged: str) -> Iterator[str]:
    """Yield one line for the elements of a kind that only one of the models has."""

    def by_kind(change: FieldChange) -> tuple[str, str]:
        return change.what, change.kind

    for (what, kind), group in groupby(sorted(changes, key=by_kind), key=by_kind):
        names = [change.name for change in group]
        verb = "is" if len(names) == 1 else "are"
        yield f"{subject(kind, names)} {verb} {'missing' if what == 'removed' else f'not in {merged}'}"


def left(outcome: RecoveryDifferences, merged: str) -> Iterator[str]:
    """Yield one line for each remaining difference between the recipe's model and the merged one.

    Differences that follow from others are only counted.
    """

    def between(wanted: Value, there: Value, unit: str) -> str:
        digits = None if shown(there) == shown(wanted) else 6
        ours, theirs = (
            f"{shown(value, digits)}{f' {unit}' if unit and value is not None else ''}" for value in (there, wanted)
        )
        return f"{ours}, in {merged} it is {theirs}"

    follows = [change for change in outcome.changes if change.follows]
    others = [change for change in outcome.changes if not change.follows]
    if not others:
        others = follows
        follows = []
    yield from _one_sided((change for change in others if change.what != "changed"), merged)
    yield from sentences((change for change in others if change.what == "changed"), between)
    if follows:
        verb = "differs" if len(follows) == 1 else "differ"
        yield f"{counted(len(follows), 'number')} that MuJoCo computes from these {verb} too"


_ROUNDS = 20


class Recovered(Struct):
    """A recovered recipe.

    `text` is the recipe. `bundle` is None if it does not build, for the reasons in `faults`. `outcome` is None if the
    models could not be compared. `refused` is MuJoCo's message if it rejects the merged model.
    """

    text: str
    proposal: Proposal
    bundle: Bundle | None
    faults: tuple[Diagnostic, ...]
    outcome: RecoveryDifferences | None
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
    named = (unit for unit in read if unit is not None)
    admitted = (unit for unit in named if all_admitted(unit, context.sink, context.shown))  # MuJoCo opens these files
    units = [unit for unit in admitted if check_source(unit, context.sink)]
    if context.sink.error_count > before or len(units) < len(read):
        return None
    with Session() as session:
        recovery = _Recovery(
            merged, parts, out, context=context, session=session, units=units, references=references or {}
        )
        return recovery.recovered(progress)


def whole_recipe(merged: Path, out: Path) -> str:
    """Return a recipe with the merged model as base, for a model whose parts are unknown."""
    return f"recipe: 1\nname: {word(out.stem)}\nbase: {word(_reference(merged, out.parent))}\n"


def corrections_of(file: Path, context: Context) -> list[Correction]:
    """Return the entries of a part that correct a file which is not valid alone. Without them, the file is as it is."""
    sink = Sink()
    unit = parse_file(file, sink, file=context.shown(file))
    if unit is None:
        return []  # which is reported where the file is read
    unknown: list[tuple[Node, str]] = []
    check_source(unit, sink, later=unknown)
    names = rename(unit, "", top_class=MAIN)
    found = [without_attribute(node, name) for node, name in unknown]
    found += [keep_first(node, name) for namespace, name, node in names.repeated if namespace != "default"]
    for namespace, name, node in names.dangling():
        attribute = referring_attribute(node, name)
        is_misspelt = bool(closest(name, names.declared[namespace]))
        if attribute is not None and not is_misspelt and not may_be_generated(name, unit.root):
            found.append(without_reference(node, attribute, namespace))
    return list({each.text: each for each in found if each is not None}.values())


def corrected_recipe(file: Path, out: Path, corrections: Iterable[Correction]) -> str:
    """Return a recipe that is the file with these corrections."""
    base: dict[str, Data] = {"model": _reference(file, out.parent)}
    for key in ("drop", "edit"):
        entries = [each.entry for each in corrections if each.key == key]
        if entries:
            base[key] = [*entries]
    return to_yaml({"recipe": 1, "name": out.stem, "base": base})


@dataclass
class _Recovery:
    """Compiles the merged model and its parts once, and compares models of recipes with the merged one."""

    merged: Path
    parts: list[Path]
    out: Path
    context: Context
    session: Session
    units: list[Unit]
    references: Mapping[Path, str]
    refused: str | None = None
    compared: bool = False
    _compiled: dict[int, bool] = field(default_factory=dict)

    def recovered(self, progress: Callable[[str], None]) -> Recovered:
        progress(f"compiling {self.context.shown(self.merged)} and its parts")
        compiled = compile(self.merged.absolute().parent, self.merged.name, keep=_MERGED, session=self.session)
        self.refused = None if compiled.ok else compiled.error
        proposal = self.proposal(self.likeness)
        found = self.settled(proposal, progress)
        if self.compared and (found.outcome is None or not found.outcome.same):
            # An element that counted as the same may still be the reason.
            other = self.settled(self.proposal(lambda _, __: elements.Likeness()), progress)
            first = found.outcome
            second = other.outcome
            if second is not None and (first is None or len(second.changes) < len(first.changes)):
                found = other
        for number, part in enumerate(self.parts):
            if not any(each.part == number for each in proposal.found):
                missing = self.context.shown(part)
                merged = self.context.shown(self.merged)
                message = f"`{merged}` has no body with the names of `{missing}`"
                help = "mjcompose finds only parts that keep their names, with a prefix or without"
                self.context.sink.warning("unknown-name", message, help=help)
        return self.shortened(found)

    def shortened(self, found: Recovered) -> Recovered:
        """Return the recipe with `for` instead of similar entries, if its model stays the same to the last byte."""
        entries = in_order(found.proposal.entries)
        proposal = replace(found.proposal, entries=folded(entries))
        if found.bundle is None or len(proposal.entries) == len(entries):
            return found
        text, _ = recipe_text(proposal)
        bundle, faults = self.built(text)
        if bundle is None or bundle.files[MODEL] != found.bundle.files[MODEL]:
            return found
        return replace(found, text=text, proposal=proposal, bundle=bundle, faults=tuple(faults))

    def likeness(self, each: Instance, names: elements.Names) -> elements.Likeness:
        """Return the equal elements of the part and the merged model; empty if MuJoCo rejects one of them."""
        if self.refused is not None:
            return elements.Likeness()
        name = f"part {each.part}"
        if each.part not in self._compiled:
            path = self.parts[each.part].absolute()
            self._compiled[each.part] = compile(path.parent, path.name, keep=name, session=self.session).ok
        above = parent_body(each.body)
        body = None if above is None else above.get("name")
        if not self._compiled[each.part] or (above is not None and body is None):
            return elements.Likeness()
        given: dict[str, object] = {"prefix": each.prefix, "names": names, "body": body}
        answer = call(self.session, elements.unchanged, [name, _MERGED], argument=given)
        self.compared = self.compared or answer.ok
        return elements.likeness_of(answer.value) if answer.ok else elements.Likeness()

    def outcome(self, proposal: Proposal, bundle: Bundle | None) -> RecoveryDifferences | None:
        """Return the differences of the last built model from the merged model, or None if they cannot be compared."""
        if bundle is None or self.refused is not None:
            return None
        given = {"tolerance": _TOLERANCE, "names": proposal.renamed}
        answer = call(self.session, contrast, [_MERGED, WHOLE], argument=given)
        if not answer.ok:
            return None
        seen = contrast_of(answer.value)
        found = [each for each in seen.changes if not _only_name(each, proposal)]
        found += _lost_without_name(seen, proposal)
        rounded = [each for each in found if each.what == "changed" and elements.is_rounding(each)]
        return RecoveryDifferences(tuple(each for each in found if each not in rounded), tuple(rounded))

    def proposal(self, likeness: Callable[[Instance, elements.Names], elements.Likeness]) -> Proposal:
        relative = partial(_reference, folder=self.out.parent)
        references = [self.references.get(path) or relative(path) for path in self.parts]
        return propose(self.units[0], self.units[1:], references, relative=relative, likeness=likeness)

    def without_failing(
        self, proposal: Proposal, progress: Callable[[str], None]
    ) -> tuple[Bundle | None, Sequence[Diagnostic]]:
        """Build the proposal, and turn each entry that does not build into a comment, until the others build."""
        shown = self.context.shown(self.out)
        for number in range(_ROUNDS):
            progress(f"trying the recipe{f' without the failed entries ({number})' if number else ''}")
            text, places = recipe_text(proposal)
            bundle, faults = self.built(text)
            lines = [fault.span.line if fault.span and fault.span.file == shown else 0 for fault in faults]
            guilty = [(places[line], fault) for line, fault in zip(lines, faults, strict=True) if line in places]
            if bundle is not None or not guilty:
                break
            for entry, fault in guilty:
                entry.note = " ".join(fault.message.split())
        return bundle, faults

    def settled(self, proposal: Proposal, progress: Callable[[str], None]) -> Recovered:
        """Return the proposal without the entries that do not build, and with the keys that it lacked."""
        bundle, faults = self.without_failing(proposal, progress)
        outcome = self.outcome(proposal, bundle)
        missing = [key.name for key in _lost_keys(outcome) if _has_name(key)]
        if missing:  # with a key of that name, its values can be compared
            blank = [elements.SectionEntry("keyframe", f"{word(name)}: {{}}") for name in missing]
            bundle, _ = self.built(recipe_text(replace(proposal, entries=[*proposal.entries, *blank]))[0])
            outcome = self.outcome(proposal, bundle)
        keys = keyframes(outcome.changes if outcome is not None else (), proposal, missing)
        note = "a key without a name, which a recipe cannot write"
        numbers = [key.index[0] for key in _lost_keys(outcome) if not _has_name(key)]
        proposal.entries += [
            elements.SectionEntry("keyframe", f"key_{number}: {{}}", note) for number in numbers
        ] + keys
        text, _ = recipe_text(proposal)
        if keys:
            progress("trying the recipe with its keyframes")
            bundle, faults = self.built(text)
            outcome = self.outcome(proposal, bundle)
        return Recovered(text, proposal, bundle, faults=tuple(faults), outcome=outcome, refused=self.refused)

    def built(self, text: str) -> tuple[Bundle | None, list[Diagnostic]]:
        """Build the text as if it were at `out`."""
        out = self.out
        context = self.context
        trial = sibling(out, "trial")  # which is never written
        own = Context(environment=context.environment, folder=context.folder)
        with unsaved({os.path.realpath(trial): text.encode()}):
            result = build(ModelRequest(trial), own, session=self.session)
        faults = []
        for each in own.sink.errors:
            is_here = each.span is not None and each.span.file == own.shown(trial)
            span = replace(each.span, file=own.shown(out)) if each.span is not None and is_here else each.span
            faults.append(replace(each, span=span, others=(), cells=()))
        return (None if result is None else result.bundle), faults


def _reference(path: Path, folder: Path) -> str:
    relative = os.path.relpath(os.path.abspath(path), os.path.abspath(folder)).replace(os.sep, "/")
    return relative if relative.startswith(".") else f"./{relative}"


def _lost_keys(outcome: RecoveryDifferences | None) -> list[FieldChange]:
    changes = outcome.changes if outcome is not None else ()
    return [change for change in changes if change.kind == "key" and change.what == "removed"]


def _has_name(key: FieldChange) -> bool:
    return not key.name.startswith("#")


def keyframes(
    changes: Collection[FieldChange], proposal: Proposal, missing: Collection[str] = ()
) -> list[elements.SectionEntry]:
    """Return entries for keys of the merged model that the parts' keys do not produce, with the differing values.

    No part has numbers for the keys in `missing`.
    """
    rows: dict[str, dict[str, dict[str, str]]] = {name: {} for name in missing}
    for each in changes:
        if each.kind == "key" and each.entry and _has_name(each) and not each.entry.startswith("#"):
            given = each.before if isinstance(each.before, tuple) else (each.before,)
            values = [value for value in given if isinstance(value, float)]
            unit = "rad" if len(values) == 1 and "angle: degree" in proposal.head else ""
            numbers = f"[{', '.join(f'{value:.9g}{unit}' for value in values)}]"
            rows.setdefault(each.name, {}).setdefault(each.field.removeprefix("key_"), {})[each.entry] = numbers
    entries = []
    for name, row in rows.items():
        sources = [] if name in missing else proposal.keys.get(name, [])
        parts = {"from": elements.flow(dict.fromkeys(sources, word(name)))} if sources else {}
        fields = {field: elements.flow(values) for field, values in row.items()}
        entries.append(elements.SectionEntry("keyframe", f"{word(name)}: {elements.flow(parts | fields)}"))
    return entries
