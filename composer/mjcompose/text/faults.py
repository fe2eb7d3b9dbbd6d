"""What an error of the YAML parser means, and how to fix it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from typing import Any

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Diagnostic, Fix, Note, Span
from mjcompose.text.decode import position

_OPENING = {"[": "]", "{": "}", "(": ")"}

_PLAIN = re.compile(r"[A-Za-z_./][\w./ -]*\w|\w|[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


def word(text: str) -> str:
    """Return text as YAML, quoted if it would otherwise be something else.

    Text that looks like a number stays unquoted.
    """
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
    """Return where the text from `start` was probably meant to end, at the latest at the end of its line.

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
        elif not closing:
            if flow and character in ",]}":
                break
            if character == ":" and text[index + 1 : index + 2] in ("", " ", "\n", "\r"):
                break
            if character == "#" and text[index - 1 : index] in (" ", "\t"):
                break
        index += 1
    return start + len(text[start:index].rstrip())


def unquoted_start(text: str, index: int) -> int:
    """Return where the text around `index`, which is in `[ ]` or `{ }`, was probably meant to begin."""
    start = index
    while start > 0 and text[start - 1] not in ",[{\r\n" and text[start - 2 : start] not in (": ", "- "):
        start -= 1
    while start < index and text[start] in " \t":
        start += 1
    return start


def in_flow(text: str, index: int, outer: bool) -> bool:
    """Return whether `index` is in `[ ]` or `{ }`; `outer` says whether the start of its line is."""
    depth, quote = int(outer), ""
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


_LINE = re.compile(r"[^\r\n]*")
_WORD = re.compile(r"[\w${*/.-]+|\S")


@dataclass(frozen=True, slots=True)
class SyntaxFault:
    """A syntax fault as a diagnostic.

    `hide` is the stretch of text that was meant as a plain value: once it is hidden from the reader, reading can
    continue and find further faults. It is None if reading ends here.
    """

    diagnostic: Diagnostic
    hide: tuple[int, int] | None = None


@dataclass(frozen=True, slots=True)
class ParserStop:
    """Where the parser stopped, and its message (`context`, `problem`).

    `at` and `since` are indices into `text`: where it stopped, and the start of what it was reading. `outer` says
    whether it is inside `[ ]` or `{ }` that began on an earlier line.
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
        self, message: str, span: Span, help: str | None = None, *, notes: Iterable[Note] = (),
        code: str = "yaml-syntax",
    ) -> SyntaxFault:  # fmt: skip
        """Return a fault after which nothing can be read."""
        return SyntaxFault(Diagnostic(code, message, span, notes=tuple(notes), help=help))

    def unquoted(self, start: int, end: int, message: str, code: str = "yaml-syntax") -> SyntaxFault:
        """Return the fault for a text that only lacks its quotes."""
        text = quoted(self.text[start:end])
        found = Diagnostic(code, message, self.span(start, end), help=f"quote it: {text}", fix=Fix(text))
        return SyntaxFault(found, (start, end))

    @property
    def flow(self) -> bool:
        """Whether the parser stopped inside `[ ]` or `{ }`."""
        return in_flow(self.text, self.at, self.outer)

    @property
    def line(self) -> str:
        """The line where the parser stopped."""
        return self.line_of(self.at)

    def line_start(self, index: int) -> int:
        return max(self.text.rfind("\n", 0, index), self.text.rfind("\r", 0, index)) + 1

    def line_of(self, index: int) -> str:
        found = _LINE.match(self.text, self.line_start(index))
        return found.group() if found else ""

    @property
    def same_line(self) -> bool:
        """Whether the parser stopped on the line where the current token began."""
        return self.line_start(self.since) == self.line_start(self.at)

    @property
    def shown(self) -> str:
        """The text where the parser stopped."""
        if self.at >= len(self.text):
            return "the end of the file"
        found = _WORD.match(self.text, self.at)
        return f"`{found.group()[:40]}`" if found else "the end of the line"


_NUMBER = re.compile(r"[-+(]*(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?:deg|rad)?\)*")
_TIGHT = re.compile(r"([A-Za-z_][\w.-]*):([^\s:/\\].*)")
_WORDS = re.compile(r"([A-Za-z_][\w.-]*)\s+(?:=\s*)?(\S.*)")


def advice(text: str, is_quoted: bool, before: str | None) -> str:
    """Return what to write instead of `text`; `before` is the key of the preceding pair, if any.

    >>> advice("size 0.03", False, None)
    'put a colon between them: `size: 0.03`'
    >>> advice("0", False, "pos")
    'put brackets around the numbers: `pos: […]`'
    """
    if not is_quoted:
        parts = text.split()
        if parts and all(map(_NUMBER.fullmatch, parts)):
            numbers = "…" if len(parts) < 2 else ", ".join(parts)
            return f"put brackets around the numbers: `{before + ': ' if before and len(parts) < 2 else ''}[{numbers}]`"
        if found := _TIGHT.fullmatch(text):
            return f"put a space behind the colon: `{found[1]}: {found[2]}`"
        if found := _WORDS.fullmatch(text):
            return f"put a colon between them: `{found[1]}: {found[2]}`"
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
    for rule in _RULES:
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
    shown = it.text[start:end]
    return it.unquoted(
        start, end, f"`{shown}` inside `[ ]` or `{{ }}` must be in quotes", code="yaml-template-unquoted"
    )


def _alias(it: ParserStop) -> SyntaxFault | None:
    if "scanning an a" not in it.context or it.text[it.since : it.since + 1] not in ("*", "&"):
        return None
    end = max(unquoted_end(it.text, it.since, in_flow(it.text, it.since, it.outer)), it.since + 1)
    sign = it.text[it.since]
    shown = it.text[it.since : end]
    if sign == "*":
        message = f"`{shown}` begins with `*`, which is an alias in YAML"
        return it.unquoted(it.since, end, message, code="yaml-alias")
    return it.unquoted(it.since, end, f"`{shown}` begins with `&`, which is an anchor in YAML")


def _tab(it: ParserStop) -> SyntaxFault | None:
    if it.text[it.at : it.at + 1] != "\t" or not ("cannot start" in it.problem or "tab" in it.problem):
        return None
    end = it.at
    while it.text[end : end + 1] == "\t":
        end += 1
    if it.text[it.line_start(it.at) : it.at].strip():
        return it.fault("a tab cannot stand here", it.span(it.at, end), "write spaces instead")
    count = sum(line.startswith("\t") for line in it.text.splitlines())
    notes = [Note(f"{count} lines of this file begin with a tab")] if count > 1 else []
    return it.fault(
        "a tab cannot indent YAML", it.span(it.at, end), "indent with spaces, two for each level", notes=notes
    )


def _reserved_start(it: ParserStop) -> SyntaxFault | None:
    reserved = "cannot start" in it.problem or "mapping keys are not allowed" in it.problem
    if not reserved or it.at >= len(it.text):
        return None
    end = max(unquoted_end(it.text, it.at, it.flow), it.at + 1)
    sign = it.text[it.at]
    message = f"an unquoted value cannot begin with {'a backquote' if sign == '`' else f'`{sign}`'}"
    return it.unquoted(it.at, end, message)


def _colon_in_flow(it: ParserStop) -> SyntaxFault | None:
    if "plain scalar" not in it.context or "unexpected ':'" not in it.problem:
        return None
    # The scalar may span several lines; the fault is on the line of the colon.
    start = max(it.since, it.line_start(it.at))
    start += len(it.text[start : it.at]) - len(it.text[start : it.at].lstrip())
    end = max(unquoted_end(it.text, start, True), it.at + 1)
    key, _, value = it.text[start:end].partition(":")
    if _KEY.fullmatch(key) and value[:1] in ("[", "{", '"', "'"):
        colon = it.span(start, start + len(key) + 1)
        return it.fault(f"a space is missing behind the colon of `{key}`", colon, f"write `{key}: {value}`")
    message = f"`{it.text[start:end]}` has a colon, and inside `[ ]` or `{{ }}` must be in quotes"
    return it.unquoted(start, end, message)


def _glob_choice(it: ParserStop) -> SyntaxFault | None:
    """Handle `{left,right}/*_link`, which YAML reads as a list or mapping with text behind it."""
    before, after = it.text[it.at - 1 : it.at], it.text[it.at : it.at + 1]
    if before not in ("]", "}") or not before or not after or after in "[]{},:# \t\r\n":
        return None
    opening = "[" if before == "]" else "{"
    start = it.text.rfind(opening, it.line_start(it.at), it.at)
    if start < 0 or not _GLOB_CHOICE.fullmatch(it.text, start + 1, it.at - 1):
        return None
    end = unquoted_end(it.text, start, in_flow(it.text, start, it.outer))
    shown = it.text[start:end]
    kind = "list" if opening == "[" else "mapping"
    return it.unquoted(start, end, f"`{shown}` begins with `{opening}`, which is a {kind} in YAML")


def _mapping_not_allowed(it: ParserStop) -> SyntaxFault | None:
    if "mapping values are not allowed" not in it.problem:
        return None
    begin = it.line_start(it.at)
    above_begin = it.line_start(begin - 1) if begin else 0
    above = it.line_of(above_begin) if begin else ""
    lead = it.text[begin : it.at]
    span = it.span(it.at)
    for where, line in ((begin, it.line), (above_begin, above)):
        tight = _TIGHT_COLON.match(line)
        if tight and where + tight.end(2) < it.at:
            colon = where + tight.end(2)
            key, value = tight.group(2), tight.group(3).rstrip()
            return it.fault(
                f"the colon after `{key}` needs a space after it", it.span(colon), f"write `{key}: {value}`"
            )
    first = re.match(r"[ \t]*(?:- +)*([^:\r\n]*[^:\s]): +(?=\S)", lead)
    if first:
        value = it.text[begin + first.end() :]
        value = value[: len(_LINE.match(value).group())].rstrip()  # type: ignore[union-attr]
        return it.fault(
            "a second `: ` in one line: the value itself cannot be a mapping here",
            span,
            f"if it is text, quote it: {first.group(1)}: {quoted(value)}",
        )
    if above.strip() and not lead.lstrip().startswith("-"):
        return _below_value(it, lead, above_begin, above=above)
    return it.fault("a key cannot stand here", span, "quote the text if the colon is part of it")


def _below_value(it: ParserStop, lead: str, above_begin: int, above: str) -> SyntaxFault:
    """Report a key in the continuation of the value on the line above."""
    key = lead.strip()
    first = above_begin + len(above) - len(above.lstrip())
    place = Note("the line above is this", it.span(first, above_begin + len(above.rstrip())))
    begin = it.line_start(it.at)
    span = it.span(begin + len(lead) - len(lead.lstrip()), it.at)
    holder = re.match(r"[ \t]*(?:- +)*([^:\r\n]*[^:\s]): +(\S.*)", above)
    if holder:
        return it.fault(
            f"`{key}` is indented as if it belonged to `{holder.group(1)}`, which already has a value", span,
            f"put `{key}` in the column of `{holder.group(1)}`, or remove that value", notes=(place,),
        )  # fmt: skip
    return it.fault(
        f"`{key}` cannot be a key here, because the line above is neither a key nor complete", span,
        "a line of a mapping has the form `key: value`", notes=(place,),
    )  # fmt: skip


def _no_colon(it: ParserStop) -> SyntaxFault | None:
    if "could not find expected ':'" not in it.problem:
        return None
    end = max(unquoted_end(it.text, it.since, False), it.since + 1)
    key = it.text[it.since : end]
    tight = _TIGHT_COLON.match(key)
    if tight:
        help = f"put a space after the colon: {tight.group(2)}: {tight.group(3)}"
    else:
        help = "a line among the keys of a mapping has the form `key: value`"
    return it.fault(f"`{key[:60]}` is neither a key nor part of a value", it.span(it.since, end), help)


def _list_in_line(it: ParserStop) -> SyntaxFault | None:
    if "sequence entries are not allowed" not in it.problem:
        return None
    help = "begin it on a line of its own, or write it as `[a, b]`"
    return it.fault("a list with `-` cannot begin on the line of its key", it.span(it.at), help)


def _open_quote(it: ParserStop) -> SyntaxFault | None:
    if "quoted scalar" not in it.context or not re.search("end of stream|document indicator", it.problem):
        return None
    sign = it.text[it.since : it.since + 1]
    return it.fault(f"the quote `{sign}` is never closed", it.span(it.since), f"add the closing `{sign}`")


def _escape(it: ParserStop) -> SyntaxFault | None:
    if "quoted scalar" not in it.context:
        return None
    start = it.text.rfind("\\", 0, it.at + 1)
    if start < it.since:
        return None
    shown = it.text[start : start + 2]
    if shown.endswith(("x", "u", "U")):
        digits = {"x": 2, "u": 4, "U": 8}[shown[1]]
        return it.fault(
            f"`{shown}` must be followed by the {digits} hexadecimal digits of a character",
            it.span(start, start + 2),
            f"for a backslash that is meant as such, write `\\{shown}`, or use single quotes",
        )
    return it.fault(
        f"`{shown}` is not an escape that YAML has" if shown.strip() == shown else "a lone backslash",
        it.span(start, start + 2),
        "in single quotes a backslash is itself: write '…' instead of \"…\", or double the backslash",
    )


def _flow(it: ParserStop) -> SyntaxFault | None:
    if "flow sequence" not in it.context and "flow mapping" not in it.context:
        return None
    if it.text[it.since : it.since + 1] not in ("[", "{"):
        return None
    opening = it.text[it.since]
    closing = "]" if opening == "[" else "}"
    if it.at >= len(it.text) or not it.same_line:
        place = Note("it was expected before this", it.span(it.at)) if it.at < len(it.text) else None
        return it.fault(
            f"this `{opening}` has no `{closing}`", it.span(it.since),
            f"add the `{closing}`, or a comma where one is missing", notes=(place,) if place else (),
        )  # fmt: skip
    return it.fault(
        f"expected `,` or `{closing}` before {it.shown}", it.span(it.at),
        "if both are one text, quote it as a whole", notes=(Note(f"the `{opening}` is here", it.span(it.since)),),
    )  # fmt: skip


def _block(it: ParserStop) -> SyntaxFault | None:
    if "block mapping" not in it.context and "block collection" not in it.context:
        return None
    begin = it.line_start(it.at)
    lead = it.text[begin : it.at]
    if lead.strip():
        quote = lead.rstrip()[-1:]
        if quote in ("'", '"') and lead.count(quote) % 2 and quote in it.text[:begin]:
            opening = it.text.rindex(quote, 0, begin)
            return it.fault(
                "this quote is not closed on its line", it.span(opening), f"close it with another `{quote}`",
                notes=(Note("it ends here, at the next one", it.span(begin + lead.rindex(quote))),),
            )  # fmt: skip
        if quote in ("'", '"'):
            help = "put the whole value in one pair of quotes"
            return it.fault(f"{it.shown} follows a closing quote", it.span(it.at), help)
        return it.fault(f"{it.shown} cannot follow a complete value", it.span(it.at), "quote the value")
    in_mapping = "block mapping" in it.context
    opened = Note(f"the {'mapping' if in_mapping else 'list'} is here", it.span(it.since))
    if len(lead) > it.since - it.line_start(it.since):
        message = "the indentation of this line is that of no line above"
        help = "indent keys of one mapping, and items of one list, alike"
    elif in_mapping:
        what = "a list item" if it.shown[1] == "-" else f"{it.shown} is not a key, and"
        message = f"{what} stands among the keys of a mapping"
        help = "give the list a key of its own, or write `key: value`"
    elif it.text.startswith("-", it.at):
        message = "the `-` of a list item needs a space behind it"
        help = "write `- ` and then the item"
    else:
        message = "a line without `-` stands among the items of a list"
        help = "begin it with `- `, or indent it so that it belongs to the item above"
    return it.fault(message, it.span(it.at), help, notes=(opened,))


def _no_content(it: ParserStop) -> SyntaxFault | None:
    if "node content" not in it.problem:
        return None
    return it.fault(f"a value is missing before {it.shown}", it.span(it.at))


def _after_end(it: ParserStop) -> SyntaxFault | None:
    if "document start" not in it.problem:
        return None
    return it.fault(f"{it.shown} stands after the end of the document", it.span(it.at))


def _tag(it: ParserStop) -> SyntaxFault | None:
    if "tag" not in it.context and "tag" not in it.problem:
        return None
    start = it.since if it.text[it.since : it.since + 1] == "!" else it.at
    found = re.compile(r"[^\s,\[\]{}]*").match(it.text, start)
    end = found.end() if found else start + 1
    return it.fault(
        f"`{it.text[start:end]}` begins with `!`, which is a tag in YAML", it.span(start, end),
        "the language has no tags; if it is text, quote it", code="yaml-tag",
    )  # fmt: skip


def _directive(it: ParserStop) -> SyntaxFault | None:
    if "directive" not in it.context and "YAML document" not in it.problem:
        return None
    message = "a line that begins with `%` is a YAML directive, and this one is not known"
    return it.fault(message, it.span(it.since), "remove the line")


def _block_text(it: ParserStop) -> SyntaxFault | None:
    if "block scalar" not in it.context:
        return None
    sign = it.text[it.since : it.since + 1]
    message = f"`{sign}` begins a text block, and its text begins on the next line"
    return it.fault(message, it.span(it.at), f"if the value is text that begins with `{sign}`, quote it")


_RULES: tuple[Callable[[ParserStop], SyntaxFault | None], ...] = (
    _long_key, _template, _alias, _tab, _reserved_start, _colon_in_flow, _glob_choice, _mapping_not_allowed, _no_colon,
    _list_in_line, _open_quote, _escape, _flow, _block_text, _block, _no_content, _after_end, _tag, _directive,
)  # fmt: skip
