"""Give a part or parameter a new name wherever it is used."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from fnmatch import fnmatchcase

from mjcompose.base.diagnostic import Span
from mjcompose.base.files import read_regular
from mjcompose.base.sink import Sink
from mjcompose.language.attach import RESERVED
from mjcompose.language.parameters import is_usable
from mjcompose.lsp import mjcf, subject
from mjcompose.lsp.analysis import Analysis, Question
from mjcompose.lsp.cursor import Path
from mjcompose.lsp.markup import ModelQuestion
from mjcompose.lsp.mjcf import RenameRefused
from mjcompose.lsp.navigation import name_there
from mjcompose.lsp.places import PART, part_at, part_called
from mjcompose.plan.plan import Plan
from mjcompose.text.faults import quoted, word
from mjcompose.text.load import load
from mjcompose.text.node import Key, Mapping, Scalar, TextChange, find, is_template, locate, walk
from mjcompose.tree.unit import Unit

_CHOICE = re.compile(r"\{([^{}]*)\}")


class NotSure(Exception):
    """Raised for a pattern that would match other names under the new key, and that cannot be rewritten."""


def renamed(text: str, old: str, new: str, separator: str, pattern: bool) -> str | None:
    """Return a name or pattern with the new prefix, or None if it stays as it is.

    `old` and `new` have no separator at the end. Raises NotSure.

    >>> renamed("left/tip", "left", "arm", "/", False), renamed("{left,right}/*", "left", "arm", "/", True)
    ('arm/tip', '{arm,right}/*')
    """
    if not pattern:
        return new + text[len(old) :] if text == old or text.startswith(old + separator) else None
    if text.startswith("/") and text.endswith("/") and len(text) > 1:
        if re.search(rf"(?<!\w){re.escape(old)}(?!\w)", text):
            raise NotSure(text)
        return None
    before = old.split(separator)
    after = new.split(separator)
    if len(before) != len(after):  # a prefix that is half written
        raise NotSure(text)
    steps = text.split(separator)
    for at, (was, now) in enumerate(zip(before, after, strict=True)):
        if at >= len(steps) or steps[at] == "**":
            break
        try:
            step = _renamed_step(steps[at], was, now)
        except NotSure:
            raise NotSure(text) from None
        if step is None:
            return None
        steps[at] = step
    result = separator.join(steps)
    return None if result == text else result


def _renamed_step(step: str, was: str, now: str) -> str | None:
    """Return a step of a pattern for the name `now`, or None if it does not match the name `was`.

    Raises NotSure for a step that matches only one of them and cannot be rewritten.
    """
    if step == was:
        return now
    if "{" not in step:
        if _fits(step, was) != _fits(step, now):
            raise NotSure(step)
        return step if _fits(step, was) else None
    if not _fits(step, was):
        return None
    changed = _CHOICE.sub(lambda choice: _choice(choice[1], was, now), step)
    if not _fits(changed, now):
        raise NotSure(step)
    return changed


def _choice(options: str, was: str, now: str) -> str:
    return "{" + ",".join(now if each == was else each for each in options.split(",")) + "}"


def _fits(step: str, name: str) -> bool:
    found = _CHOICE.search(step)
    if found is None:
        return fnmatchcase(name, step.replace("[", "[[]"))
    head = step[: found.start()]
    tail = step[found.end() :]
    return any(_fits(head + option + tail, name) for option in found[1].split(","))


_USABLE = re.compile(r"[A-Za-z_]\w*")


def renameable(question: Question) -> Span | None:
    """Return the word at the cursor that can be renamed: a part, a parameter of this recipe, or a name in MJCF."""
    if isinstance(question, ModelQuestion):
        return mjcf.renameable(question)
    at = _part_at(question)
    parameter = subject.parameter_at(question)
    if not question.analysis.is_current:
        return None
    if at is not None:
        return question.word
    turn = subject.turn_name_at(question, question.analysis.tree)
    if turn is not None:
        return _at_cursor(turn.uses, question)
    if parameter is None or parameter[1] is not None or parameter[0] not in subject.settables(question.data):
        return None
    return _at_cursor(subject.parameter_uses(parameter[0], question.analysis.tree), question)


def _part_at(question: Question) -> Path | None:
    """Return the path of the own part that the cursor names, but not inside an expression in its name."""
    at = subject.part_named_at(question)
    return None if at is None or len(at) != 2 or subject.is_in_expression(question) else at


def _at_cursor(uses: Iterable[Span], question: Question) -> Span | None:
    line = question.line + 1
    column = question.column + 1
    return next((at for at in uses if at.line == line and at.column <= column <= (at.end_column or 0)), None)


def rename(
    question: Question, new: str, others: Iterable[Analysis], models: Iterable[tuple[Unit, str]] = ()
) -> list[TextChange]:
    """Return all changes that a new name needs. Raises RenameRefused.

    `others` are the recipes that may include this one or this model, `models` the models that include or attach
    this one, with the prefix of its names there.
    """
    if isinstance(question, ModelQuestion):
        return _rename_in_model(question, new, others, models=models)
    at = _part_at(question)
    parameter = subject.parameter_at(question)
    if renameable(question) is None:
        raise RenameRefused(
            "only parts, parameters, variants and names of `for` can be renamed, if the recipe has no YAML errors"
        )
    try:
        if at is not None:
            changes = _rename_part(str(at[1]), new, question.analysis, others)
        elif (turn := subject.turn_name_at(question, question.analysis.tree)) is not None:
            changes = _rename_turn_name(turn, new, question)
        else:
            assert parameter is not None
            changes = _rename_parameter(parameter[0], new, question, others)
    except NotSure as pattern:
        raise RenameRefused(f"`{pattern}` would match other names afterwards: change it first") from None
    return list(dict.fromkeys(changes))


def _rename_in_model(
    question: ModelQuestion, new: str, others: Iterable[Analysis], models: Iterable[tuple[Unit, str]]
) -> list[TextChange]:
    known, changes = mjcf.rename(question, new, models)
    path = os.path.realpath(question.analysis.path)
    for other in others:
        for part, unit in other.names.sources.items():
            if all(each.path is None or os.path.realpath(each.path) != path for each in unit.origins.texts.values()):
                continue
            final = replace(known, name=other.names.prefixes.get(part, "") + known.name)
            for use in subject.uses_in(other.tree):
                there = name_there(final, use, other)
                text = use.text
                if there is None or known.namespace not in use.wanted.namespaces or use.wanted.part is not None:
                    continue
                now = there.removesuffix(known.name) + new
                changed = None
                try:
                    if use.wanted.pattern:
                        changed = renamed(text, there, now, separator=other.separator, pattern=True)
                except (NotSure, ValueError):
                    raise RenameRefused(
                        f"`{text}` in `{other.file}` would match other names: change it first"
                    ) from None
                if changed is not None or text == there:
                    changes.append(_written(use.span, changed or now, other))
    return list(dict.fromkeys(changes))


def _rename_part(old: str, new: str, analysis: Analysis, others: Iterable[Analysis]) -> list[TextChange]:
    lower = _extended_with(("attach", old), analysis)
    if lower is not None:
        raise RenameRefused(f"`{old}` is a part of `{lower}`, which this recipe extends: rename it there")
    step = part_at(("attach", old), analysis.plan)
    if is_template(old) or (step is not None and step.span.turn is not None):
        raise RenameRefused(f"a `for` makes `{old}`: change the key of its entry")
    tree = analysis.mapping
    attach = None if tree is None else find(tree, ("attach",))
    if not new or new == RESERVED or any(each.isspace() for each in new) or analysis.separator in new:
        raise RenameRefused(f"`{new}` cannot be the key of a part")
    if isinstance(attach, Mapping) and new in attach.entries:
        raise RenameRefused(f"there is a part `{new}` already")
    changes = list(_in_recipe(analysis, "", "", old, new))
    for other in others:
        for outer, prefix in _inclusions(other, analysis):
            changes += _in_recipe(other, outer, prefix, old, new)
    return changes


def _inclusions(other: Analysis, analysis: Analysis) -> Iterator[tuple[str, str]]:
    """Yield path and prefix of the parts that include this recipe, both empty for a recipe that extends it."""
    plan = other.plan
    if other.path == analysis.path:
        return
    if plan is None or not other.is_current or other.plan_of != other.text:
        raise RenameRefused(f"`{other.file}` may use it and has errors: fix these first")
    if any(source.path == analysis.path for source, _ in plan.extended):
        yield "", ""
    for place in plan.walk():
        if isinstance(place.model, Plan) and place.part and place.model.path == analysis.path and not place.model.at:
            yield place.part, place.prefix


def _in_recipe(analysis: Analysis, outer: str, prefix: str, old: str, new: str) -> Iterator[TextChange]:
    """Yield the changes in one recipe that includes this one as the part `outer`, with names after `prefix`."""
    tree = analysis.mapping
    separator = analysis.separator
    if tree is None:
        return
    has_names = True
    if not outer:
        part = find(tree, ("attach", old))
        if part is not None:
            yield _written(locate(tree, ("attach", old), key=True), new, analysis)
        has_names = not (isinstance(part, Mapping) and "prefix" in part.entries)
    above = f"{outer}/" if outer else ""
    for use in subject.uses_in(tree):
        pattern = use.wanted.pattern
        changed = None
        if PART in use.wanted.namespaces:
            changed = renamed(use.text, above + old, above + new, separator="/", pattern=pattern)
        elif has_names:
            own = analysis.names.prefixes.get(part_called(use.wanted.of, analysis.plan)) if use.wanted.of else ""
            if own is not None and prefix.startswith(own):
                inner = prefix[len(own) :]
                changed = renamed(use.text, inner + old, inner + new, separator=separator, pattern=pattern)
        if changed is not None:
            yield _written(use.span, changed, analysis)
    if has_names:
        for path, _, node in walk(tree):
            if path[-1:] == ("xml",) and isinstance(node, Scalar):
                yield from _in_fragment(node, prefix + old + separator, prefix + new + separator)


def _in_fragment(node: Scalar, old: str, new: str) -> Iterator[TextChange]:
    for number, line in enumerate(node.text.split("\n")):
        for found in re.finditer(rf"""(?<=["'\s]){re.escape(old)}""", line):
            if node.block is not None:
                row = node.block[0] + number
                column = node.block[1] + found.start()
            elif number == 0 and node.span.end_line == node.span.line:
                row = node.span.line
                column = node.span.column + (0 if node.plain else 1) + found.start()
            else:
                raise NotSure(old)
            yield TextChange(Span(node.span.file, row, column, end_line=row, end_column=column + len(old)), new)


def _written(span: Span, text: str, analysis: Analysis) -> TextChange:
    """Return the change that replaces a name. It keeps the quotes, or adds quotes if the new name needs them."""
    lines = analysis.lines if span.file == analysis.file else []
    before = lines[span.line - 1][span.column - 1 :] if span.line <= len(lines) else ""
    return TextChange(span, quoted(text) if before[:1] in ("'", '"') else word(text))


def _rename_turn_name(turn: subject.TurnName, new: str, question: Question) -> list[TextChange]:
    fault = Sink()
    if not is_usable(Key(new, turn.key.span), "a name of `for`", fault):
        raise RenameRefused(fault.errors[0].message)
    if new in subject.settables(question.data):
        raise RenameRefused(f"there is a parameter or variant `{new}` already")
    tree = question.analysis.tree
    entry = None if tree is None else find(tree, turn.path)
    places = [turn.path, *(() if entry is None else (path for path, _, _ in walk(entry, turn.path)))]
    if any(each.key.name == new for path in places for each in subject.turn_names(tree, path)):
        raise RenameRefused(f"`for` has a name `{new}` already")
    return [TextChange(span, new) for span in turn.uses]


def _rename_parameter(old: str, new: str, question: Question, others: Iterable[Analysis]) -> list[TextChange]:
    analysis = question.analysis
    for section in ("params", "variants"):
        lower = _extended_with((section, old), analysis)
        if lower is not None:
            raise RenameRefused(f"`{old}` is set in `{lower}`, which this recipe extends: rename it there")
    if not _USABLE.fullmatch(new):
        raise RenameRefused(f"`{new}` cannot be the name of a parameter")
    if new in subject.settables(question.data):
        raise RenameRefused(f"there is a parameter or variant `{new}` already")
    changes = [TextChange(span, new) for span in subject.parameter_uses(old, analysis.tree)]
    for other in others:
        for part, _ in _inclusions(other, analysis):
            if not part:
                changes += [TextChange(span, new) for span in subject.parameter_uses(old, other.tree)]
                continue
            key = _value_for(part, old, other)
            if key is not None:
                changes.append(TextChange(key, new))
    return changes


def _value_for(part: str, parameter: str, analysis: Analysis) -> Span | None:
    """Return the key with which a recipe sets a parameter of one of its parts."""
    tree = analysis.mapping
    if tree is None:
        return None
    at: Path | None = (RESERVED,)
    if part != RESERVED:
        own = analysis.plan.parts if analysis.plan is not None else ()  # without the parts of parts
        at = next((step.at for step in own if part_called(step.at, analysis.plan) == part), None)
    if at is None or find(tree, (*at, "with", parameter)) is None:
        return None
    return locate(tree, (*at, "with", parameter), key=True)


def _extended_with(path: Path, analysis: Analysis) -> str | None:
    if analysis.plan is not None:
        for source, _ in analysis.plan.extended:
            try:
                tree = load(read_regular(source.path), source.path.name, Sink())
            except OSError:
                continue
            if tree is not None and find(tree, path) is not None:
                return source.path.name
    return None
