"""Explanations of the YAML parser's errors, with their fixes."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from typing import Any

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Fix, Note, Span
from mjcompose.text.node import position

_OPENING = {"[": "]", "{": "}", "(": ")"}

_PLAIN = re.compile(r"[A-Za-z_./][\w./ -]*\w|\w|[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


def word(text: str) -> str:
    """Return text as YAML, quoted if it would otherwise be something else. Numbers stay unquoted."""
    if _PLAIN.fullmatch(text) and text.lower() not in ("true", "false", "null"):
        return text
    return quoted(text)


def quoted(text: str) -> str:
    """Return text as a YAML string, in the quotes that need no escapes.

    >>> print(quoted("**/x"), quoted('${a == "b"}'))
    "**/x" '${a == "b"}'
    """
    if '"' in text or "\\" in text:
        return "'" + text.replace("'", "''") + "'"
    return f'"{text}"'


def unquoted_end(text: str, start: int, flow: bool) -> int:
    """Return the probable end of the text from `start`, at the latest the end of its line.

    Brackets are skipped to their partner. `flow` says that the text is in `[ ]` or `{ }`.

    >>> line = "{a: -${x[0]} * 2, b: 1}"
    >>> line[4:unquoted_end(line, 4, True)]
    '-${x[0]} * 2'
    """
    closing: list[str] = []
    quote = ""
    index = start
    while index < len(text) and text[index] not in "\r\n":
        character = text[index]
        if quote:
            quote = "" if character == quote else quote
        elif closing and character in "\"'":
            quote = character
        elif character in _OPENING:
            closing.append(_OPENING[character])
        elif closing and character == closing[-1]:
            closing.pop()
        elif not closing and _ends_plain_text(text, index, flow):
            break
        index += 1
    return start + len(text[start:index].rstrip())


def _ends_plain_text(text: str, index: int, flow: bool) -> bool:
    """Return whether a character ends a text without quotes: the end of a list, or a mark of a key or a comment."""
    character = text[index]
    if character == ":":
        return text[index + 1 : index + 2] in ("", " ", "\n", "\r")
    if character == "#":
        return text[index - 1 : index] in (" ", "\t")
    return flow and character in ",]}"


def unquoted_start(text: str, index: int) -> int:
    """Return the probable start of the text around `index`, which is in `[ ]` or `{ }`."""
    start = index
    while start > 0 and text[start - 1] not in ",[{\r\n" and text[start - 2 : start] not in (": ", "- "):
        start -= 1
    while start < index and text[start] in " \t":
        start += 1
    return start


def in_flow(text: str, index: int, outer: bool) -> bool:
    """Return whether `index` is in `[ ]` or `{ }`; `outer` says whether the start of its line is in brackets."""
    depth = int(outer)
    quote = ""
    begin = max(text.rfind("\n", 0, index), text.rfind("\r", 0, index)) + 1
    for character in text[begin:index]:
        if quote:
            quote = "" if character == quote else quote
        elif character in "\"'":
            quote = character
        elif character in "[{":
            depth += 1
        elif character in "]}":
            depth -= 1
    return depth > 0


_WORD = re.compile(r"[\w${*/.-]+|\S")


class SyntaxFault(Struct):
    """A fault, and the stretch of plain text to `hide` to find further faults; None ends reading."""

    diagnostic: Diagnostic
    hide: tuple[int, int] | None = None


class ParserStop(Struct):
    """The place where the parser stopped, and its message (`context`, `problem`).

    `at` and `since` are indices into `text`: the place where it stopped, and the start of the construct that it was
    reading. `outer` says whether it is inside `[ ]` or `{ }` that began on an earlier line.
    """

    text: str
    file: str
    context: str
    problem: str
    since: int
    at: int
    outer: bool

    def span(self, start: int, end: int | None = None) -> Span:
        """Return the place of the characters up to `end`, or of a single one."""
        line, column = position(self.text, start)
        length = 1 if end is None else max(end - start, 1)
        return Span(self.file, line, column, end_line=line, end_column=column + length)

    def fault(
        self,
        message: str,
        span: Span,
        help: str | None = None,
        *,
        notes: Iterable[Note] = (),
        code: str = "yaml-syntax",
    ) -> SyntaxFault:
        """Return a fault after which nothing can be read."""
        return SyntaxFault(Diagnostic(code, message, span, notes=tuple(notes), help=help))

    def unquoted(self, start: int, end: int, message: str, code: str = "yaml-syntax") -> SyntaxFault:
        """Return the fault of a text that lacks only its quotes."""
        text = quoted(self.text[start:end])
        found = Diagnostic(code, message, self.span(start, end), help=f"quote it: {text}", fix=Fix(text))
        return SyntaxFault(found, (start, end))

    @property
    def sign(self) -> str:
        return self.text[self.since : self.since + 1]

    def line_start(self, index: int) -> int:
        return max(self.text.rfind("\n", 0, index), self.text.rfind("\r", 0, index)) + 1

    def line_of(self, index: int) -> str:
        return re.split("[\r\n]", self.text[self.line_start(index) :], maxsplit=1)[0]

    @property
    def shown(self) -> str:
        if self.at >= len(self.text):
            return "the end of the file"
        found = _WORD.match(self.text, self.at)
        return f"`{found.group()[:40]}`" if found else "the end of the line"


_NUMBER = re.compile(r"[-+(]*(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?:deg|rad)?\)*")
_TIGHT = re.compile(r"([A-Za-z_][\w.-]*):([^\s:/\\].*)")
_WORDS = re.compile(r"([A-Za-z_][\w.-]*)\s+(?:=\s*)?(\S.*)")


def for_lone_key(text: str, is_quoted: bool, before: str | None) -> str:
    """Return what to write instead of `text`; `before` is the key of the preceding pair, if any.

    >>> for_lone_key("size 0.03", False, None)
    'put a colon between them: `size: 0.03`'
    >>> for_lone_key("0", False, "pos")
    'put brackets around the numbers: `pos: […]`'
    """
    if not is_quoted:
        parts = text.split()
        if parts and all(map(_NUMBER.fullmatch, parts)):
            numbers = "…" if len(parts) < 2 else ", ".join(parts)
            return f"put brackets around the numbers: `{before + ': ' if before and len(parts) < 2 else ''}[{numbers}]`"
        pair = _TIGHT.fullmatch(text)
        if pair:
            return f"put a space after the colon: `{pair[1]}: {pair[2]}`"
        pair = _WORDS.fullmatch(text)
        if pair:
            return f"put a colon between them: `{pair[1]}: {pair[2]}`"
    shown = quoted(text) if is_quoted else text
    return f"write `{shown}: …` with its value, or `[{shown}]` for a list"


_TIGHT_COLON = re.compile(r"([ \t]*(?:- +)*)([A-Za-z_][\w.-]*):([^\s:/\\][^\r\n]*)")
_GLOB_CHOICE = re.compile(r"[\w,*?/.:\- ]*")
_FLOW_TEXT = re.compile(r""" *("(?:[^"\\]|\\.)*"|'[^']*'|[^,\[\]{}"'\r\n]+)""")
MAX_KEY = 1024
_KEY = re.compile(r"[A-Za-z_][\w-]*")


def explain(error: Any, text: str, file: str, outer: bool) -> SyntaxFault:
    """Return the fault for a parser's `MarkedYAMLError`; `outer` is as in `in_flow`."""
    mark = error.problem_mark or error.context_mark
    at = min(mark.index, len(text)) if mark else 0
    since = min(error.context_mark.index, len(text)) if error.context_mark else at
    stop = ParserStop(text, file, error.context or "", problem=error.problem or "", since=since, at=at, outer=outer)
    for context, problem, rule in _RULES:
        if re.search(context, stop.context) and re.search(problem, stop.problem):
            fault = rule(stop)
            if fault is not None:
                return fault
    return stop.fault(f"this is not YAML: {stop.problem} at {stop.shown}", stop.span(at))


def _long_key(it: ParserStop) -> SyntaxFault | None:
    """Readers look for the colon of a key within 1024 characters, as in the specification."""
    if "simple key" in it.context:
        length = it.line_of(it.since).find(":") - (it.since - it.line_start(it.since))
        starts = [it.since] if length > MAX_KEY else []
    elif it.text.startswith(":", it.at):
        texts = _FLOW_TEXT.finditer(it.text, it.line_start(it.at), it.at)
        starts = [each.start(1) for each in texts if each.end() == it.at and len(each.group(1)) > MAX_KEY]
    else:
        return None
    return it.fault(f"a key has more than {MAX_KEY} characters", it.span(starts[0])) if starts else None


def _template(it: ParserStop) -> SyntaxFault | None:
    if it.at == 0 or not it.text.startswith("${", it.at - 1):
        return None
    start = unquoted_start(it.text, it.at - 1)
    end = unquoted_end(it.text, start, True)
    message = f"`{it.text[start:end]}` inside `[ ]` or `{{ }}` must be in quotes"
    return it.unquoted(start, end, message, code="yaml-template-unquoted")


def _alias(it: ParserStop) -> SyntaxFault | None:
    if it.sign not in ("*", "&"):
        return None
    end = max(unquoted_end(it.text, it.since, in_flow(it.text, it.since, it.outer)), it.since + 1)
    kind, code = ("an alias", "yaml-alias") if it.sign == "*" else ("an anchor", "yaml-syntax")
    message = f"`{it.text[it.since : end]}` begins with `{it.sign}`, which is {kind} in YAML"
    return it.unquoted(it.since, end, message, code=code)


def _tab(it: ParserStop) -> SyntaxFault | None:
    end = it.at + len(it.text[it.at :]) - len(it.text[it.at :].lstrip("\t"))
    if end == it.at:
        return None
    if it.text[it.line_start(it.at) : it.at].strip():
        return it.fault("a tab is not allowed here", it.span(it.at, end), "write spaces instead")
    count = sum(line.startswith("\t") for line in it.text.splitlines())
    notes = [Note(f"{count} lines of this file begin with a tab")] if count > 1 else []
    help = "indent with spaces, two for each level"
    return it.fault("a tab cannot indent YAML", it.span(it.at, end), help, notes=notes)


def _reserved_start(it: ParserStop) -> SyntaxFault | None:
    if it.at >= len(it.text):
        return None
    sign = "a backquote" if it.text[it.at] == "`" else f"`{it.text[it.at]}`"
    end = max(unquoted_end(it.text, it.at, in_flow(it.text, it.at, it.outer)), it.at + 1)
    return it.unquoted(it.at, end, f"an unquoted value cannot begin with {sign}")


def _colon_in_flow(it: ParserStop) -> SyntaxFault:
    # The scalar may span several lines; the fault is on the line of the colon.
    start = max(it.since, it.line_start(it.at))
    start += len(it.text[start : it.at]) - len(it.text[start : it.at].lstrip())
    end = max(unquoted_end(it.text, start, True), it.at + 1)
    key, _, value = it.text[start:end].partition(":")
    if _KEY.fullmatch(key) and value[:1] in ("[", "{", '"', "'"):
        colon = it.span(start, start + len(key) + 1)
        return it.fault(f"a space is missing after the colon of `{key}`", colon, f"write `{key}: {value}`")
    message = f"`{it.text[start:end]}` has a colon, and inside `[ ]` or `{{ }}` must be in quotes"
    return it.unquoted(start, end, message)


def _glob_choice(it: ParserStop) -> SyntaxFault | None:
    """Handle `{left,right}/*_link`, which YAML reads as a list or mapping with text after it."""
    before = it.text[it.at - 1 : it.at]
    after = it.text[it.at : it.at + 1]
    if before not in ("]", "}") or not after or after in "[]{},:# \t\r\n":
        return None
    opening, kind = ("[", "list") if before == "]" else ("{", "mapping")
    start = it.text.rfind(opening, it.line_start(it.at), it.at)
    if start < 0 or not _GLOB_CHOICE.fullmatch(it.text, start + 1, it.at - 1):
        return None
    end = unquoted_end(it.text, start, in_flow(it.text, start, it.outer))
    return it.unquoted(start, end, f"`{it.text[start:end]}` begins with `{opening}`, which is a {kind} in YAML")


def _mapping_not_allowed(it: ParserStop) -> SyntaxFault:
    begin = it.line_start(it.at)
    above_begin = it.line_start(begin - 1) if begin else 0
    above = it.line_of(above_begin) if begin else ""
    lead = it.text[begin : it.at]
    for where, line in ((begin, it.line_of(it.at)), (above_begin, above)):
        tight = _TIGHT_COLON.match(line)
        if tight and where + tight.end(2) < it.at:
            key = tight.group(2)
            value = tight.group(3).rstrip()
            colon = it.span(where + tight.end(2))
            return it.fault(f"the colon after `{key}` needs a space after it", colon, f"write `{key}: {value}`")
    first = re.match(r"[ \t]*(?:- +)*([^:\r\n]*[^:\s]): +(?=\S)", lead)
    if first:
        value = it.line_of(it.at)[first.end() :].rstrip()
        message = "a second `: ` in one line: the value itself cannot be a mapping here"
        return it.fault(message, it.span(it.at), f"if it is text, quote it: {first.group(1)}: {quoted(value)}")
    if not above.strip() or lead.lstrip().startswith("-"):
        return it.fault("a key is not allowed here", it.span(it.at), "quote the text if the colon is part of it")
    # A key in the continuation of the value on the line above.
    key = lead.strip()
    first_above = above_begin + len(above) - len(above.lstrip())
    notes = [Note("the line above is this", it.span(first_above, above_begin + len(above.rstrip())))]
    span = it.span(begin + len(lead) - len(lead.lstrip()), it.at)
    holder = re.match(r"[ \t]*(?:- +)*([^:\r\n]*[^:\s]): +(\S.*)", above)
    if holder:
        name = holder.group(1)
        message = f"`{key}` is indented as if it belonged to `{name}`, which already has a value"
        return it.fault(message, span, f"put `{key}` in the column of `{name}`, or remove that value", notes=notes)
    message = f"`{key}` cannot be a key here, because the line above is neither a key nor complete"
    return it.fault(message, span, "a line of a mapping has the form `key: value`", notes=notes)


def _no_colon(it: ParserStop) -> SyntaxFault:
    end = max(unquoted_end(it.text, it.since, False), it.since + 1)
    key = it.text[it.since : end]
    help = "a line among the keys of a mapping has the form `key: value`"
    tight = _TIGHT_COLON.match(key)
    if tight:
        help = f"put a space after the colon: {tight.group(2)}: {tight.group(3)}"
    return it.fault(f"`{key[:60]}` is neither a key nor part of a value", it.span(it.since, end), help)


def _escape(it: ParserStop) -> SyntaxFault | None:
    start = it.text.rfind("\\", 0, it.at + 1)
    if start < it.since:
        return None
    shown = it.text[start : start + 2]
    if shown.endswith(("x", "u", "U")):
        digits = {"x": 2, "u": 4, "U": 8}[shown[1]]
        message = f"`{shown}` must be followed by the {digits} hexadecimal digits of a character"
        help = f"for a literal backslash, write `\\{shown}`, or use single quotes"
    else:
        message = f"`{shown}` is not an escape in YAML" if shown.strip() == shown else "a lone backslash"
        help = "in single quotes a backslash is itself: write '…' instead of \"…\", or double the backslash"
    return it.fault(message, it.span(start, start + 2), help)


def _flow(it: ParserStop) -> SyntaxFault | None:
    if it.sign not in ("[", "{"):
        return None
    closing = "]" if it.sign == "[" else "}"
    if it.at >= len(it.text) or it.line_start(it.since) != it.line_start(it.at):
        notes = [Note("it was expected before this", it.span(it.at))] if it.at < len(it.text) else []
        help = f"add the `{closing}`, or a comma where one is missing"
        return it.fault(f"this `{it.sign}` has no `{closing}`", it.span(it.since), help, notes=notes)
    notes = [Note(f"the `{it.sign}` is here", it.span(it.since))]
    message = f"expected `,` or `{closing}` before {it.shown}"
    return it.fault(message, it.span(it.at), "if this is one text, quote all of it", notes=notes)


def _block(it: ParserStop) -> SyntaxFault:
    begin = it.line_start(it.at)
    lead = it.text[begin : it.at]
    if lead.strip():
        quote = lead.rstrip()[-1:]
        if quote in ("'", '"') and lead.count(quote) % 2 and quote in it.text[:begin]:
            opening = it.span(it.text.rindex(quote, 0, begin))
            notes = [Note("it ends here, at the next one", it.span(begin + lead.rindex(quote)))]
            help = f"close it with another `{quote}`"
            return it.fault("this quote is not closed on its line", opening, help, notes=notes)
        if quote in ("'", '"'):
            help = "put the whole value in one pair of quotes"
            return it.fault(f"{it.shown} follows a closing quote", it.span(it.at), help)
        return it.fault(f"{it.shown} cannot follow a complete value", it.span(it.at), "quote the value")
    in_mapping = "block mapping" in it.context
    if len(lead) > it.since - it.line_start(it.since):
        message = "the indentation of this line is that of no line above"
        help = "indent keys of one mapping, and items of one list, alike"
    elif in_mapping:
        message = "a list item is" if it.shown[1] == "-" else f"{it.shown} is not a key, and is"
        message += " among the keys of a mapping"
        help = "give the list a key of its own, or write `key: value`"
    elif it.text.startswith("-", it.at):
        message = "the `-` of a list item needs a space after it"
        help = "write `- ` and then the item"
    else:
        message = "a line without `-` is among the items of a list"
        help = "begin it with `- `, or indent it so that it belongs to the item above"
    opened = Note(f"the {'mapping' if in_mapping else 'list'} is here", it.span(it.since))
    return it.fault(message, it.span(it.at), help, notes=[opened])


def _tag(it: ParserStop) -> SyntaxFault:
    start = it.since if it.sign == "!" else it.at
    end = start + len(re.split(r"[\s,\[\]{}]", it.text[start:], maxsplit=1)[0])
    message = f"`{it.text[start:end]}` begins with `!`, which is a tag in YAML"
    help = "the language has no tags; if it is text, quote it"
    return it.fault(message, it.span(start, end), help, code="yaml-tag")


def _directive(it: ParserStop) -> SyntaxFault:
    message = "a line that begins with `%` is a YAML directive, and this one is not known"
    return it.fault(message, it.span(it.since), "remove the line")


def _block_text(it: ParserStop) -> SyntaxFault:
    message = f"`{it.sign}` begins a text block, and its text begins on the next line"
    return it.fault(message, it.span(it.at), f"if the value is text that begins with `{it.sign}`, quote it")


_RULES: tuple[tuple[str, str, Callable[[ParserStop], SyntaxFault | None]], ...] = (
    ("", "", _long_key), ("", "", _template), ("scanning an a", "", _alias), ("", "cannot start|tab", _tab),
    ("", "cannot start|mapping keys are not allowed", _reserved_start),
    ("plain scalar", "unexpected ':'", _colon_in_flow), ("", "", _glob_choice),
    ("", "mapping values are not allowed", _mapping_not_allowed), ("", "could not find expected ':'", _no_colon),
    ("", "sequence entries are not allowed", lambda it: it.fault(
        "a list with `-` cannot begin on the line of its key", it.span(it.at),
        "begin it on a line of its own, or write it as `[a, b]`")),
    ("quoted scalar", "end of stream|document indicator", lambda it: it.fault(
        f"the quote `{it.sign}` is never closed", it.span(it.since), f"add the closing `{it.sign}`")),
    ("quoted scalar", "", _escape),
    ("flow sequence|flow mapping", "", _flow), ("block scalar", "", _block_text),
    ("block mapping|block collection", "", _block),
    ("", "node content", lambda it: it.fault(f"a value is missing before {it.shown}", it.span(it.at))),
    ("", "document start", lambda it: it.fault(f"{it.shown} is after the end of the document", it.span(it.at))),
    ("tag", "", _tag), ("", "tag", _tag), ("directive", "", _directive), ("", "YAML document", _directive),
)  # fmt: skip
"""Patterns for the context and the problem in the parser's message, and the rule for them; the first one counts."""
