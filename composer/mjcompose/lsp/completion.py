"""All kinds of completion."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path as PathlibPath
from typing import Any

from mjcompose.base.diagnostic import Span
from mjcompose.base.words import counted
from mjcompose.language.expand import scope_of
from mjcompose.language.repeat import FOR
from mjcompose.lsp import mjcf
from mjcompose.lsp.analysis import Completion, Item, Known, Question
from mjcompose.lsp.cursor import Path
from mjcompose.lsp.language import KeySyntax, keys_of, words_of
from mjcompose.lsp.markup import ModelQuestion
from mjcompose.lsp.places import PART, Wanted, fitting, wanted_key
from mjcompose.lsp.subject import Settable, TurnName, of_nested, place_of, sets, settables, turn_names, wanted_as_value
from mjcompose.lsp.turns import Reading, reading_at, values_of
from mjcompose.sources.fetching import model_files
from mjcompose.sources.kinds import KINDS
from mjcompose.sources.menagerie import known_models
from mjcompose.sources.reference import FORMATS
from mjcompose.text.expression import CONSTANTS, FUNCTIONS, DataTable, with_units
from mjcompose.text.faults import quoted
from mjcompose.text.node import Mapping


def offer(question: Question) -> Iterator[Item]:
    if question.cursor.role in ("value", "either"):
        for at, (word, doc) in enumerate(words_of(question.forms).items()):
            empty = "" if word else '""'
            yield Item(word or '""', "word", "", doc=doc, rank=10 + min(at, 20), insert=empty)


_NAME = re.compile(r"[A-Za-z_]\w*\Z")
_IN_EDITS = {
    "value": "the current value, after defaults",
    "name": "the name of the element",
    "parent": "the name of its parent",
    "index": "its number among the selected elements, from 0",
}


def begun(question: Question) -> str | None:
    """Return the name that is being written inside `${…}`, or None if the cursor is not in an expression."""
    before = question.cursor.word
    opening = before.rfind("${")
    if opening < 0 or "}" in before[opening:]:
        return None
    name = _NAME.search(before)
    return name.group() if name else ""


def offer_expressions(question: Question) -> Iterator[Item]:
    if begun(question) is None:
        return
    reading = _reading(question)
    if reading is not None:
        yield from _keys_of(reading, question)
        if reading.is_dotted:
            return
    for turn in turn_names(question.tree, place_of(question)):
        values = _values_of(turn, question)
        yield Item(turn.key.name, "value", f"of `for`: {values}" if values else "of `for`", rank=5)
    for each in settables(question.data).values():
        yield Item(each.name, each.kind, each.detail, doc=each.doc, rank=10)
    if "edit" in question.path:
        yield from (Item(name, "parameter", "of the element", doc=doc, rank=15) for name, doc in _IN_EDITS.items())
    for name, function in FUNCTIONS.items():
        count = f"{function.least}" if function.most == function.least else f"{function.least} or more"
        yield Item(name, "function", f"{count} argument{'s' * (count != '1')}", rank=30, insert=f"{name}(")
    for name, value in CONSTANTS.items():
        yield Item(name, "constant", str(value), rank=30)


def _reading(question: Question) -> Reading | None:
    """Return the row or column that is being written, after `gains.` or `gains[`."""
    if not isinstance(question.tree, Mapping):
        return None
    return reading_at(question.cursor.word, question.tree, place_of(question))


def _keys_of(reading: Reading, question: Question) -> Iterator[Item]:
    quote = "'" if question.cursor.quote == '"' else '"'
    for at, key in enumerate(reading.keys):
        if not reading.is_dotted:
            insert = key if reading.is_quoted else f"{quote}{key}{quote}"
            yield Item(key, "row", "of the table", rank=min(at, 9000) / 10000, insert=insert)
        elif key.isidentifier():
            yield Item(key, "row", "of the table", rank=min(at, 9000) / 10000)


_VALUES_MOST = 8


def _values_of(name: TurnName, question: Question) -> str:
    values = values_of(name, question.tree) if isinstance(question.tree, Mapping) else []
    more = f", … ({len(values)} in all)" if len(values) > _VALUES_MOST else ""
    return f"{', '.join(map(with_units, values[:_VALUES_MOST]))}{more}"


def offer_repeated(question: Question) -> Iterator[Item]:
    """Yield the tables and lists over which a `for` can repeat its entry."""
    cursor = question.cursor
    if cursor.role not in ("value", "either") or cursor.path[-2:-1] != (FOR,) or not isinstance(question.tree, Mapping):
        return
    for name, value in scope_of(question.tree, {}).items():
        if isinstance(value, DataTable | tuple):
            text = f"${{{name}}}"
            insert = text if cursor.quote else quoted(text)
            yield Item(
                text, "parameter", "a table" if isinstance(value, DataTable) else "a list", rank=5, insert=insert
            )


def offer_keys(question: Question) -> Iterator[Item]:
    """Yield the keys that the mapping at the cursor can still have. Required keys come first."""
    cursor = question.cursor
    if cursor.role not in ("key", "either"):
        return
    there = question.at(cursor.path)
    written = set(cursor.written) | (set(there) if isinstance(there, dict) else set())
    for at, key in enumerate(keys_of(question.forms)):
        if key.name in written and key.name != cursor.whole:
            continue
        detail, rank = ("required", 10) if key.required else ("", 20 + min(at, 20))
        insert = _insert(key, question)
        again = not _is_collection(key)
        yield Item(key.name, "key", detail, doc=key.doc, rank=rank, insert=insert, again=again)


def _insert(key: KeySyntax, question: Question) -> str:
    """Return the key with its colon, followed by an indented line if its value is a mapping."""
    cursor = question.cursor
    if cursor.has_colon:
        return key.name
    if not _is_collection(key) or cursor.in_flow:
        return f"{key.name}: "
    return f"{key.name}:\n{' ' * (cursor.start + 2)}"


def _is_collection(key: KeySyntax) -> bool:
    types: set[str] = set()
    for form in key.forms:
        declared: Any = form.schema.get("type", ())
        types |= {declared} if isinstance(declared, str) else set(declared)
        if "enum" in form.schema or "const" in form.schema:
            types.add("string")
    return types == {"object"}


def offer_names(question: Question) -> Iterator[Item]:
    """Yield the names that fit at the cursor. Names of the most likely kind come first."""
    cursor = question.cursor
    analysis = question.analysis
    wanted_names: list[tuple[Wanted, bool]] = []
    if cursor.role in ("key", "either") and (key := wanted_key(cursor.path)) is not None:
        wanted_names.append((key, True))
    value = wanted_as_value(question)
    if value is not None and not value.pattern:
        wanted_names.append((value, False))
    for wanted, is_key in wanted_names:
        for at, (rank, known) in enumerate(fitting(wanted, analysis.names, analysis.plan)):
            colon = ": " if is_key and not cursor.has_colon else ""
            insert = known.name + colon if colon else ""
            nearness = min(at, 9000) / 10000
            yield Item(known.name, known.namespace, known.detail, rank=rank + nearness, insert=insert)


def offer_parameters(question: Question) -> Iterator[Item]:
    """Yield the names that can get a value at the cursor, or the possible values of the name there."""
    cursor = question.cursor
    if cursor.role in ("key", "either"):
        for settable in (_at(cursor.path, question) or {}).values():
            insert = settable.name + ("" if cursor.has_colon else ": ")
            again = bool(settable.values)
            yield Item(
                settable.name, settable.kind, settable.detail, doc=settable.doc, rank=15, insert=insert, again=again
            )
    if cursor.role in ("value", "either") and cursor.path:
        yield from _values_of_parameter(cursor.path, question)
        if cursor.path[0] == "randomize" and cursor.path[-1] == "param":
            for settable in settables(question.data).values():
                if settable.kind == "parameter":
                    yield Item(settable.name, settable.kind, settable.detail, settable.doc)


def _values_of_parameter(path: Path, question: Question) -> Iterator[Item]:
    """Yield the possible values of the parameter at a path, or of the list of values at it."""
    if isinstance(path[-1], int):
        path = path[:-1]
    settable = (_at(path[:-1], question) or {}).get(str(path[-1])) if path else None
    if settable is not None:
        for at, value in enumerate(settable.values):
            yield Item(value, "word", settable.detail, rank=10 + at)


def _at(path: Path, question: Question) -> dict[str, Settable] | None:
    """Return the parameters and variants that the mapping at a path can set, or None for other mappings."""
    if path[-1:] == ("with",):
        return of_nested(path[:-1], question)
    return settables(question.data) if sets(path) and path not in (("params",), ("variants",)) else None


_MENAGERIE = "menagerie:"
_SCHEMES = tuple(form for kind in KINDS for form in kind.forms)


def offer_references(question: Question) -> Iterator[Item]:
    cursor = question.cursor
    is_reference = cursor.path in (("extends",), ("base",)) or (len(cursor.path) > 1 and cursor.path[-1] == "model")
    if cursor.role not in ("value", "either") or not is_reference:
        return
    only_recipes = cursor.path == ("extends",)
    if cursor.word.startswith(_MENAGERIE) and not only_recipes:
        yield from _robots(cursor.word)
        return
    yield from _files(question, only_recipes)
    if not only_recipes:
        for form in _SCHEMES:
            scheme = form.scheme
            if scheme:
                yield Item(f"{scheme}:", "scheme", form.example, doc=form.meaning, rank=30, again=scheme == "menagerie")


def _files(question: Question, only_recipes: bool) -> Iterator[Item]:
    """Yield the recipes and models in the folder of the recipe, or in the one above it that you are writing."""
    path = question.analysis.path
    word = question.cursor.word
    above = word.rpartition("/")[0] if word.startswith("../") else "."
    for at, file in enumerate(model_files(PathlibPath(os.path.normpath(path.parent / above)))):
        reference = f"{above}/{file}"
        kind = FORMATS[PathlibPath(reference).suffix.lower()]
        if (only_recipes and kind != "recipe") or reference == f"./{path.name}":
            continue
        yield Item(reference, "file", kind if kind == "recipe" else kind.upper(), rank=10 + at / 1000)


def _robots(word: str) -> Iterator[Item]:
    name, slash, _ = word.removeprefix(_MENAGERIE).partition("/")
    models = list(known_models(os.environ))
    robots = list(dict.fromkeys(robot for robot, _, _ in models))
    if slash and name in robots:
        for robot, entry, is_own in models:
            if robot == name:
                detail, rank = ("the robot's own model", 5) if is_own else ("", 10)
                yield Item(f"{_MENAGERIE}{name}/{entry}", "model", detail, rank=rank)
        return
    yield from (Item(f"{_MENAGERIE}{robot}", "model", "MuJoCo Menagerie", rank=10) for robot in robots)


def offer_selectors(question: Question) -> Iterator[Item]:
    analysis = question.analysis
    wanted = wanted_as_value(question)
    if wanted is None or not wanted.pattern:
        return
    found = [known for _, known in fitting(wanted, analysis.names, analysis.plan)]
    if wanted.namespaces != (PART,):
        yield Item("**", "pattern", f"all, unnamed ones too ({len(found)} with a name)", rank=5)
        for at, (glob, count) in enumerate(_globs(found, analysis.separator)):
            yield Item(glob, "pattern", counted(count, "element"), rank=10 + at / 1000)
    for at, known in enumerate(found):
        yield Item(known.name, known.namespace, known.detail, rank=20 + min(at, 9000) / 10000)


def _globs(found: list[Known], separator: str) -> list[tuple[str, int]]:
    deep: Counter[str] = Counter()
    flat: Counter[str] = Counter()
    for known in found:
        steps = known.name.split(separator)
        for depth in range(1, len(steps)):
            deep[separator.join(steps[:depth])] += 1
        flat[separator.join(steps[:-1])] += 1
    globs = {f"{start}{separator}*" if start else "*": count for start, count in flat.items()}
    globs |= {f"{start}{separator}**": count for start, count in deep.items() if count != flat[start]}
    return sorted(globs.items())


Offer = Callable[[Question], Iterator[Item]]
_OPENING = ("*", "&", "!", "|", ">", "%", "@", "`", '"', "'", "#", "?", "{", "}", "[", "]", ",", ":", "-")
OFFERS: tuple[Offer, ...] = (
    offer_names,
    offer_parameters,
    offer_repeated,
    offer_references,
    offer_selectors,
    offer,
    offer_keys,
)


def complete(question: Question) -> Completion:
    """Return the completions at the cursor. Inside `${…}`, only parts of expressions are offered."""
    cursor = question.cursor
    if cursor.role == "text":
        return Completion()
    if isinstance(question, ModelQuestion):
        own = sorted((item for offer in mjcf.OFFERS for item in offer(question)), key=lambda each: each.rank)
        return Completion(tuple(own), _span(question, cursor.start, cursor.end))
    name = begun(question)
    if name is not None:
        begin = cursor.start + len(cursor.word) - len(name)
        return Completion(tuple(offer_expressions(question)), _span(question, begin, question.column))
    found: dict[str, Item] = {}
    for offer in OFFERS:
        for item in offer(question):
            found.setdefault(item.label, item)
    items = sorted((_quoted(each, question) for each in found.values()), key=lambda each: each.rank)
    return Completion(tuple(items), _span(question, cursor.start, cursor.end))


def _quoted(item: Item, question: Question) -> Item:
    cursor = question.cursor
    plain = item.label[:1] not in _OPENING and not any(each in item.label for each in (": ", " #"))
    if cursor.in_flow:
        plain = plain and not any(each in item.label for each in ",[]{}")
    return item if item.insert or cursor.quote or plain else replace(item, insert=quoted(item.label))


def _span(question: Question, start: int, end: int) -> Span:
    line = question.cursor.line + 1
    return Span(question.analysis.file, line, start + 1, end_line=line, end_column=end + 1)
