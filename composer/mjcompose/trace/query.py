"""A query about a model, the recipe's text for its result, and the report if nothing matches."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from functools import cache
from itertools import takewhile
from pathlib import Path

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.files import read_regular
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean, exists_note, unknown_attribute
from mjcompose.language.keyframe import HOLD, WAYS
from mjcompose.mujoco.attributes import KINDS
from mjcompose.trace.explanation import Reason
from mjcompose.trace.trace_words import derived_names
from mjcompose.tree.grammar import GRAMMAR, ElementType
from mjcompose.tree.names import WORLD
from mjcompose.tree.pattern import EVERYTHING, fitter, is_pattern
from mjcompose.tree.select import kind_of, naming_attribute, query, tags_of

_COMPARED = {path: kind for kind in KINDS if kind != "plugin" for path in query(kind, None).paths}


class RecipeLines:
    """The lines of recipes in a folder, read on first use."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.lines: dict[str, list[str]] = {}

    def text_of(self, span: Span) -> str | None:
        if span.end_column is None or span.end_line != span.line:
            return None
        if span.file not in self.lines:
            self.lines[span.file] = []
            with suppress(OSError, UnicodeDecodeError):
                self.lines[span.file] = read_regular(self.folder / span.file).decode("utf-8").splitlines()
        lines = self.lines[span.file]
        if span.line > len(lines):
            return None
        text = lines[span.line - 1][span.column - 1 : span.end_column - 1]
        if not text.startswith("- "):
            return text
        dash = " " * (span.column - 1) + "- "  # a list with an item on each line
        items = takewhile(lambda line: line.startswith(dash), lines[span.line - 1 :])
        return f"[{', '.join(line[len(dash) :].strip() for line in items)}]"

    def in_own_form(self, span: Span | None, text: str | None) -> Reason:
        """Return the place of a value in a recipe, with the recipe's own text if that is not the value itself."""
        if span is None or self.has(span, text):
            return Reason("", span)
        written = self.text_of(span)
        if written in (HOLD, *WAYS):
            return Reason("computed to hold the pose of the key", span)
        if written == "keys":
            return Reason(MIRRORED, span)
        return Reason(f"`{written}` in the recipe's own unit or form", span)

    def has(self, span: Span | None, text: str | None) -> bool:
        recipe = None if span is None else self.text_of(span)
        return recipe is None or text is None or same_words(recipe, text)


def same_words(recipe: str, text: str) -> bool:
    """Return whether a recipe and MJCF write the same value, each in its own syntax."""
    return same_value(re.sub(r"""[][,"']""", " ", recipe), text)


def same_value(a: str, b: str) -> bool:
    """Return whether two MJCF texts are the same value: word by word the same text or the same number.

    >>> same_value("1 0.50 x", "1.0 .5 x")
    True
    """
    ours = a.split()
    theirs = b.split()
    with suppress(ValueError):
        return all(one == other or float(one) == float(other) for one, other in zip(ours, theirs, strict=True))
    return False


MIRRORED = "computed: the mirror image of a keyframe"
_NUMBERED = re.compile(r"(.+)#(\d+)")
_LINE = re.compile(r"(.+\.\w+):(\d+)(?::\d+)?")
# Words that people use for the elements of a section.
_SYNONYMS = {"keyframe": "key", "class": "default"}


class ExplainQuery(Struct):
    """A parsed query: `kinds` are the grammar paths that match (None: all), and the other fields narrow them down."""

    text: str
    kinds: frozenset[str] | None
    name: str | None = None
    number: int | None = None
    line: tuple[str, int] | None = None
    attribute: str | None = None

    @property
    def tags(self) -> frozenset[str] | None:
        """The tags of the elements that match; None: all."""
        return None if self.kinds is None else frozenset(path.rpartition("/")[2] for path in self.kinds)


def read(text: str, attribute: str | None, sink: Sink) -> ExplainQuery | None:
    """Parse a query; report it and return None if it has no meaning."""
    words = text.split()
    if not words:
        help = "write for example `geom gripper/pad`, or `option timestep`"
        sink.error("unknown-name", "the query is empty", help=help)
        return None
    asked, rest, unknown = _target(text, words)
    if unknown is not None:
        sink.error("unknown-element", f"MJCF has no element `{unknown}`", help=did_you_mean(unknown, tags_of()))
        return None
    if attribute is not None:
        rest = [*rest, attribute]
    if len(rest) > 1:
        help = "write KIND NAME ATTRIBUTE in one pair of quotes: 'geom gripper/pad friction'"
        sink.error("unknown-name", f"`{' '.join(rest)}` is more than the name of one attribute", help=help)
        return None
    return replace(asked, attribute=rest[0] if rest else None)


def _target(text: str, words: list[str]) -> tuple[ExplainQuery, list[str], str | None]:
    """Return the query for elements, the words after it, and the first word if it names a kind that MJCF lacks."""
    numbered = _NUMBERED.fullmatch(words[0])
    line = _LINE.fullmatch(words[0])
    kinds = _kinds(numbered[1] if numbered else words[0])
    unknown = numbered[1] if numbered and kinds is None else None
    if numbered and kinds is not None:
        return ExplainQuery(text, kinds, number=int(numbered[2])), words[1:], unknown
    if line and kinds is None:
        return ExplainQuery(text, None, line=(line[1], int(line[2]))), words[1:], unknown
    if kinds is None:
        if _is_meant_as_kind(words):
            unknown = words[0]
        return ExplainQuery(text, None, name=words[0]), words[1:], unknown
    if _is_one(kinds):
        asked, rest = _inside(text, words)
        return asked, rest, unknown
    if len(words) > 1:
        return ExplainQuery(text, kinds, name=words[1]), words[2:], unknown
    return ExplainQuery(text, kinds), [], unknown


def _is_meant_as_kind(words: list[str]) -> bool:
    """Return whether the first word can only be a kind: it looks like one, and no attribute follows."""
    if len(words) < 2 or not re.fullmatch(r"[a-z_]+", words[0]):
        return False
    return not any(words[1] in GRAMMAR.element(path).attributes for path in GRAMMAR.paths)


def find(asked: ExplainQuery, root: Node, separator: str) -> list[Node]:
    """Return the elements that a query matches, in the order of the model; it does not handle queries that name a line.

    Raises `BadPattern`.
    """
    found = [node for node in ordered(root) if asked.kinds is None or _counts(kind_of(node)) in asked.kinds]
    if asked.number is not None:
        return found[asked.number : asked.number + 1]
    if asked.name is None:
        return found
    if asked.name == WORLD and (asked.kinds is None or "body" in asked.kinds):
        return list(root.iterchildren("worldbody"))
    if not is_pattern(asked.name):
        return [node for node in found if name_of(node) == asked.name]
    if asked.name == EVERYTHING:
        return found
    names = {name for node in found if (name := name_of(node))}
    meant = set(filter(fitter(asked.name, lambda: names, separator), names))
    return [node for node in found if name_of(node) in meant]


def _counts(kind: ElementType) -> str:
    """Return the path under which an element is counted: the world is the first body."""
    return "body" if kind.path == "worldbody" else kind.path


def ordered(root: Node) -> Iterator[Node]:
    """Yield every element, with elements in bodies in MuJoCo's order, body by body."""
    yield root
    for section in root.iterchildren("*"):
        if section.tag != "worldbody":
            yield from section.iter("*")
    worlds = list(root.iterchildren("worldbody"))
    for world in worlds:
        yield from _own(world)
    for world in worlds:
        for body in world.iter("body"):
            yield from _own(body)


def kinds_in_order(root: Node) -> Iterator[tuple[str, Node]]:
    """Yield the elements of a model in MuJoCo's order, each with its kind. Only the first of several worlds counts."""
    worlds = 0
    for node in ordered(root):
        kind = "body" if node.tag == "worldbody" else _COMPARED.get(kind_of(node).path)
        worlds += node.tag == "worldbody"
        if kind is not None and (node.tag != "worldbody" or worlds == 1):
            yield kind, node


def _own(holder: Node) -> Iterator[Node]:
    """Yield a body and everything in it except bodies. No recursion: frames may be nested deeply."""
    waiting = [holder]
    while waiting:
        node = waiting.pop()
        yield node
        waiting += [child for child in node.iterchildren("*", reversed=True) if child.tag != "body"]


def name_of(node: Node) -> str | None:
    naming = naming_attribute(kind_of(node))
    value = None if naming is None else node.get(naming.name)
    return str(value) if value else None


def labels(root: Node) -> dict[Node, str]:
    """Return for each element a query that matches it and no other."""
    counts: Counter[str] = Counter()
    found: dict[Node, str] = {}
    for node in ordered(root):
        kind = kind_of(node)
        word = _word(kind)
        name = name_of(node)
        if kind.path == "worldbody":
            found[node] = "body world"
        elif node.getparent() is root and kind.path != "default":
            found[node] = kind.tag  # a section
        elif name is not None and name.split() == [name]:
            found[node] = f"{word} {name}"
        elif _is_one(frozenset({kind.path})):
            found[node] = word
        else:
            found[node] = f"{word}#{counts[word]}"
        for alike in _words(kind):
            counts[alike] += 1
    return found


@cache
def _word(kind: ElementType) -> str:
    """Return the tag, or the whole path if the tag alone refers to other elements."""
    wanted = _kinds(kind.tag)
    return kind.tag if wanted is not None and kind.path in wanted else kind.path


@cache
def _words(kind: ElementType) -> tuple[str, ...]:
    """Return every word under which an element is counted: `joint` also counts free joints."""
    words = ("body",) if kind.path == "worldbody" else (_word(kind), kind.family)
    return tuple(word for word in dict.fromkeys(words) if word and _counts(kind) in (_kinds(word) or ()))


def _kinds(word: str) -> frozenset[str] | None:
    """Return the grammar paths that a word stands for: a tag, a family, a section, or a path."""
    word = _SYNONYMS.get(word, word)
    if "/" in word and word in GRAMMAR.paths:
        return frozenset({word})
    is_path = word in GRAMMAR.paths and GRAMMAR.families.get(word) is None
    return query(word, None).paths or (frozenset({word}) if is_path else None)


def _is_one(kinds: frozenset[str]) -> bool:
    """Return whether a model has only one of these: a section of settings, or an element in it."""
    tops = ("mujoco", "compiler", "option", "size", "statistic", "visual")
    settings = (path for path in kinds if path.split("/")[0] in tops and path != "mujoco/include")
    return len(kinds) == sum(GRAMMAR.element(path).family is None for path in settings)


def _inside(text: str, words: list[str]) -> tuple[ExplainQuery, list[str]]:
    """Follow the words into a section of settings as far as there are elements, as in `option flag gravity`."""
    path = words[0]
    rest = words[1:]
    while rest and f"{path}/{rest[0]}" in GRAMMAR.paths:
        path = f"{path}/{rest[0]}"
        rest = rest[1:]
    return ExplainQuery(text, _kinds(path) or frozenset({path})), rest


def not_found(asked: ExplainQuery, root: Node, sink: Sink, notes: Iterable[Note] = ()) -> None:
    notes = tuple(notes)
    word = asked.text.split()[0].split("#")[0] if asked.kinds is not None else "element"
    if asked.line is not None:
        file, line = asked.line
        sink.error("unknown-name", f"nothing in the model comes from `{file}:{line}`", notes=notes)
    elif asked.number is not None:
        count = len(find(ExplainQuery(asked.text, asked.kinds), root, "/"))
        existing = f"there are {count}, the first is `{word}#0`" if count else "there are none"
        sink.error("unknown-name", f"`{word}#{asked.number}` does not exist: {existing}", notes=notes)
    elif asked.name is None:
        sink.error("unknown-name", f"the model has no {word}", notes=notes)
    else:
        _no_such_name(asked, asked.name, word, root=root, sink=sink, notes=notes)


def _no_such_name(asked: ExplainQuery, name: str, word: str, root: Node, sink: Sink, notes: tuple[Note, ...]) -> None:
    fitting = find(ExplainQuery("", asked.kinds), root, "/")
    names = [found for node in fitting if (found := name_of(node)) is not None]
    other = next((node for node in ordered(root) if name_of(node) == name), None)
    help = did_you_mean(name, names, f"{f'{word} ' if asked.kinds else ''}{{}}")
    if other is not None:
        help = f"did you mean `{labels(root)[other]}`?"
    unnamed = len(fitting) - len(names) if asked.kinds else 0
    if unnamed:
        count = "there is 1" if unnamed == 1 else f"there are {unnamed}"
        notes = (*notes, Note(f"{count} without a name: write `{word}#0`, …"))
    if names or not unnamed:
        notes = (*notes, exists_note(word, names, name))
    missing = f"nothing in the model is called `{name}`"
    message = missing if asked.kinds is None else f"the {word} `{name}` does not exist"
    sink.error("unknown-name", message, notes=notes, help=help)


def no_attribute(node: Node, name: str, sink: Sink) -> None:
    known = sorted({*kind_of(node).attributes, *derived_names(kind_of(node))})
    sink.add(unknown_attribute(name, f"`<{node.tag}>`", known))
