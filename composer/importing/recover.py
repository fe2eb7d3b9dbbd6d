"""A merged model and its parts to a recipe that was built, and what still differs."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Collection
from dataclasses import dataclass, replace
from pathlib import Path

from composer.bundle.bundle import Bundle
from composer.context import Context
from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.span import Span
from composer.importing.flow import word
from composer.importing.propose import Entry, Proposal, propose
from composer.importing.recipe_text import recipe_text
from composer.pipeline import build
from composer.tree.parse import parse_file
from composer.tree.unit import Unit
from composer.verify.difference import MISSING, Difference

_ROUNDS = 20
_SIZES = "nbody njnt ngeom nsite ncam nlight ntendon neq nu nsensor nkey npair nexclude".split()
_CLOSE = 1e-6
_KEY = re.compile(r"key_(?P<row>\w+) of `(?P<name>.*)`")


@dataclass(frozen=True, slots=True)
class Recovered:
    """`text` is the recipe; `bundle` is None where it does not build, for the reasons in `faults`.

    `differences` is None where the two models could not be compared.
    """

    text: str
    proposal: Proposal
    bundle: Bundle | None
    faults: tuple[Diagnostic, ...]
    differences: list[Difference] | None


def recover(merged: Path, parts: list[Path], out: Path, context: Context) -> Recovered | None:
    """The recipe that is to stand at `out`; None where a model cannot be read, as `context.sink` tells.

    What the recipe cannot say is left out, as a comment, one after the other, until it builds.
    """
    before = context.sink.error_count
    read = [parse_file(path, context.sink, file=context.shown(path)) for path in (merged, *parts)]
    units: list[Unit] = [unit for unit in read if unit is not None]
    if context.sink.error_count > before or len(units) < len(read):
        return None
    references = [_reference(path, out.parent) for path in parts]
    proposal = propose(
        units[0],
        units[1:],
        references,
        lambda file: _reference(file, out.parent),
    )
    for number, part in enumerate(parts):
        if not any(each.part == number for each in proposal.found):
            context.sink.warning(
                "unknown-name",
                f"`{context.shown(part)}` is nowhere in `{context.shown(merged)}`: no body and what stands in it "
                "have its names",
                help="only parts whose names are kept, with a prefix or without, are found",
            )
    for _ in range(_ROUNDS):
        text, places = recipe_text(proposal)
        bundle, faults = _built(text, out, context)
        guilty = [(places[line], fault) for fault in faults if (line := _line(fault, out, context)) in places]
        if bundle is not None or not guilty:
            break
        for entry, fault in guilty:
            entry.note = " ".join(fault.message.split())
    differences = None if bundle is None else _compared(merged, bundle, proposal)
    missing = [each.name for each in differences or [] if each.kind == "key" and each.field == MISSING]
    if missing:  # with a key of that name it can be said what is in it
        blank = [Entry("keyframe", f"{word(name)}: {{}}") for name in missing]
        bundle, _ = _built(
            recipe_text(replace(proposal, entries=[*proposal.entries, *blank]))[0], out, context
        )
        differences = None if bundle is None else _compared(merged, bundle, proposal)
    keys = keyframes(differences or [], proposal, missing)
    if keys:
        proposal.entries += keys
        text, _ = recipe_text(proposal)
        bundle, faults = _built(text, out, context)
        differences = None if bundle is None else _compared(merged, bundle, proposal)
    return Recovered(text, proposal, bundle, tuple(faults), differences)


def _built(text: str, out: Path, context: Context) -> tuple[Bundle | None, list[Diagnostic]]:
    """Build the text as if it stood at `out`; nothing of it stays."""
    from composer.bundle.staging import sibling

    trial = sibling(out, "trial")
    own = Context(environment=context.environment, folder=context.folder)
    try:
        trial.write_text(text, encoding="utf-8")
        result = build(trial, own)
    finally:
        trial.unlink(missing_ok=True)
    faults = [
        Diagnostic(each.code, each.message, _at(each, trial, out, own), each.severity, each.notes, each.help)
        for each in own.sink.errors
    ]
    return (None if result is None else result.bundle), faults


def _at(fault: Diagnostic, trial: Path, out: Path, context: Context) -> Span | None:
    """The place of a fault, told for the file that is to be."""
    if fault.span is None or fault.span.file != context.shown(trial):
        return fault.span
    return replace(fault.span, file=context.shown(out))


def _line(fault: Diagnostic, out: Path, context: Context) -> int:
    return fault.span.line if fault.span is not None and fault.span.file == context.shown(out) else 0


def _reference(path: Path, folder: Path) -> str:
    relative = os.path.relpath(os.path.abspath(path), os.path.abspath(folder)).replace(os.sep, "/")
    return relative if relative.startswith(".") else f"./{relative}"


def _compared(merged: Path, bundle: Bundle, proposal: Proposal) -> list[Difference] | None:
    """What the recipe's model has not as the merged one has; names are those of the recipe."""
    from composer.engine import Session, call, compile
    from composer.verify.compiles import verify
    from composer.verify.question import Question, ask, told

    with Session() as session:
        own = compile(merged.absolute().parent, merged.name, keep="merged", session=session)
        built = verify(bundle, session=session, keep="built")
        if not own.ok or built.error is not None:
            return None
        question = Question(renamed=proposal.renamed, tolerance=1e-7)
        answer = call(session, ask, ["merged", "built"], question.to_json())
    if not answer.ok:
        return None
    counts = [
        Difference("model", merged.stem, size, own.sizes[size], built.compiled.sizes[size])
        for size in _SIZES
        if own.sizes[size] != built.compiled.sizes[size]
    ]
    return counts + [each for each in told(answer.value) if not _the_same(each, proposal)]


def _the_same(difference: Difference, proposal: Proposal) -> bool:
    """Whether it is one in name or sign only: an asset that is equal, a quaternion and its negative."""
    if difference.field == MISSING:
        return f"{difference.kind} {difference.name}" in proposal.christened
    wanted, there = difference.expected, difference.actual
    if isinstance(wanted, str) and isinstance(there, str):
        alike = proposal.alike.get(wanted)
        return there in [each.out + wanted for each in proposal.found] or (
            alike is not None and alike == proposal.alike.get(there)
        )
    if difference.array.endswith("quat") and isinstance(wanted, tuple) and isinstance(there, tuple):
        pairs = zip(wanted, there, strict=True)
        return all(
            isinstance(a, float) and isinstance(b, float) and math.isclose(a, -b, abs_tol=_CLOSE)
            for a, b in pairs
        )
    return False


def keyframes(
    differences: list[Difference], proposal: Proposal, missing: Collection[str] = ()
) -> list[Entry]:
    """The keys of the merged model that the parts' keys do not make, written with what differs.

    Of those in `missing` no part has anything.
    """
    rows: dict[str, dict[str, dict[str, str]]] = {name: {} for name in missing}
    for each in differences:
        found = _KEY.fullmatch(each.field)
        if each.kind == "key" and found and isinstance(each.expected, tuple):
            values = [value for value in each.expected if isinstance(value, float)]
            unit = "rad" if len(values) == 1 and "angle: degree" in proposal.head else ""
            numbers = f"[{', '.join(f'{value:.9g}{unit}' for value in values)}]"
            rows.setdefault(each.name, {}).setdefault(found["row"], {})[found["name"]] = numbers
    entries = []
    for name, row in rows.items():
        said = ", ".join(
            f"{field}: {{{', '.join(f'{word(k)}: {v}' for k, v in values.items())}}}"
            for field, values in row.items()
        )
        based = name not in missing and any(each.is_base for each in proposal.found)
        start = "from: {base: " + word(name) + "}, " if based else ""
        entries.append(Entry("keyframe", f"{word(name)}: {{{start}{said}}}"))
    return entries
