"""Names, globs, regular expressions, and selectors as data.

In a glob, `*` and `?` stop at the separator, `**` does not, and `{a,b}` is a choice. Matching tracks the set of
reachable positions in the name, as bits of an integer, and never backtracks, so no glob takes long for any name. A
regular expression may take exponential time, and Python's `re` cannot be interrupted; the package `regex` can.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Collection, Iterator, Mapping
from enum import Enum
from functools import cache, lru_cache, reduce
from operator import or_

from mjcompose.base.dataclass import Struct
from mjcompose.base.words import value_text
from mjcompose.tree.grammar import GRAMMAR

_TOKENS = r"\*\*|\*|\?|\{[^{}]*\}|[^*?{]+|."
_ONE = ord("1")


class _Wild(Enum):
    ONE = "?"
    LEVEL = "*"
    ALL = "**"
    LEVELS = "**/"


_Token = _Wild | str | list[list["_Token"]]
"""A wildcard, literal text, or a choice."""


def is_glob(name: str) -> bool:
    """Return whether a text is a glob: plain names do not have these characters."""
    return any(character in name for character in "*?{")


def stray_brace(glob: str) -> int | None:
    """Return the position of a brace that is not part of a choice; choices cannot be nested.

    >>> stray_brace("{a,b}/*"), stray_brace("x{a"), stray_brace("a}"), stray_brace("{a,{b}}")
    (None, 1, 1, 0)
    """
    found = re.search(r"[{}]", re.sub(r"\{[^{}]*\}", lambda choice: "-" * len(choice[0]), glob))
    return found.start() if found else None


@lru_cache(maxsize=256)
def matcher(glob: str, separator: str = "/") -> Callable[[str], bool]:
    """Return a function that says whether a name matches a glob.

    >>> pads = matcher("gripper/*_pad?")
    >>> pads("gripper/left_pad1"), pads("gripper/left/pad1"), matcher("**/{pad,tip}")("a/b/tip")
    (True, False, True)
    """
    if not is_glob(glob):
        return glob.__eq__
    tokens = _tokens(glob, separator)
    texts = [token for token in tokens if isinstance(token, str)]
    stops = separator if _makes_levels(separator) else ""

    def fits(name: str) -> bool:
        # Most names lack a literal part of the glob, which is quick to see.
        return all(text in name for text in texts) and bool(_Name(name, stops).reached(tokens, 1) & 1 << len(name))

    return fits


class Literals(Struct):
    """The literal text that a pattern requires: a name begins with one of `starts`, and contains `part` behind it."""

    starts: tuple[str, ...] = ("",)
    part: str = ""


_MOST_STARTS = 64


@lru_cache(maxsize=256)
def literals_of(pattern: str, separator: str = "/") -> Literals:
    """Return the literal text that a glob or a regular expression requires.

    >>> literals_of("arm{1,2}_*").starts, literals_of("**/pad?").part, literals_of("/left_[0-9]+/").starts
    (('arm1_', 'arm2_'), 'pad', ('left_',))
    """
    if is_regular(pattern):
        return Literals((_literal_start(pattern[1:-1]),))
    rest = _tokens(pattern, separator)
    starts = [""]
    while rest:
        choices = _literal_choices(rest[0])
        if choices is None or len(starts) * len(choices) > _MOST_STARTS:
            break
        starts = [start + choice for start in starts for choice in choices]
        rest = rest[1:]
    part = max((token for token in rest if isinstance(token, str)), key=len, default="")
    return Literals(tuple(dict.fromkeys(starts)), part)


def _literal_choices(token: _Token) -> list[str] | None:
    """Return the texts that a token matches, or None if it has a wildcard."""
    if isinstance(token, str):
        return [token]
    if isinstance(token, _Wild) or any(isinstance(each, _Wild) for choice in token for each in choice):
        return None
    return ["".join(map(str, choice)) for choice in token]


def _literal_start(expression: str) -> str:
    """Return literal text with which every match of an expression begins, perhaps less than there is.

    >>> _literal_start("link[0-9]+"), _literal_start("links?"), _literal_start("left|right"), _literal_start("(?i)left")
    ('link', 'link', '', '')
    """
    # `|` allows other beginnings, and flags change the meaning of letters and spaces.
    if "|" in expression or "(?" in expression:
        return ""
    literal = re.match(r"[\w/ -]*", expression)
    assert literal is not None
    text = literal[0]
    is_repeated = expression[len(text) : len(text) + 1] in ("*", "?", "{", "+")
    return text[:-1] if is_repeated else text


def _tokens(glob: str, separator: str) -> list[_Token]:
    levels = f"**{separator}" if _makes_levels(separator) else None
    wild = {levels: _Wild.LEVELS, **{each.value: each for each in (_Wild.ONE, _Wild.LEVEL, _Wild.ALL)}}
    found: list[_Token] = []
    for token in re.findall(rf"{re.escape(levels)}|{_TOKENS}" if levels else _TOKENS, glob, re.DOTALL):
        is_choice = token[0] == "{" and len(token) > 1
        choice = [_tokens(each, separator) for each in token[1:-1].split(",")] if is_choice else []
        found.append(choice or wild.get(token, token))
    return found


def _makes_levels(separator: str) -> bool:
    """Return whether `*` stops at the separator: `_` is also part of names."""
    return separator not in ("_", "__")


class _Name:
    """The name to match. Positions are bits: the lowest is before its first character."""

    def __init__(self, name: str, stops: str) -> None:
        self.name = name
        self.end = 1 << len(name)
        self.stops = reduce(or_, map(self._at, stops), 0)
        self.within = (self.end - 1) & ~self.stops

    def _at(self, text: str) -> int:
        """Return the positions before a text, without an integer for each, because a name may be long."""
        found = bytearray(b"0" * (len(self.name) + 1))
        place = self.name.find(text)
        while place >= 0:
            found[~place] = _ONE
            place = self.name.find(text, place + 1)
        return int(found, 2)

    def reached(self, tokens: list[_Token], places: int) -> int:
        """Return the positions after matching the tokens from each of these positions."""
        for token in tokens:
            if isinstance(token, str):
                places = (places & self._at(token)) << len(token)
            elif isinstance(token, list):
                places = reduce(or_, (self.reached(each, places) for each in token), 0)
            else:
                places = self._behind(token, places)
            if not places:
                break
        return places

    def _behind(self, token: _Wild, places: int) -> int:
        from_first = -(places & -places)
        if token is _Wild.ONE:
            return (places & self.within) << 1
        if token is _Wild.LEVEL:  # the carry of the sum runs from each position to the end of its level
            return (((places & self.within) + self.within) ^ self.within) | places
        if token is _Wild.ALL:
            return from_first & (2 * self.end - 1)
        return places | (self.stops & from_first) << 1


SECONDS = 2.0
"""How much of the processor's time the names of a model may take with one expression."""
_LONGEST = 10_000
# Python's `re` reads these as text, and `regex` as errors in a name (`{e<=1}`) or a POSIX class.
_MEANT_AS_TEXT = re.compile(r"(\\N\{[^}]*\}|\\.)|(\{(?!\d*,?\d*\})|(?<=\[)\[(?=:))", re.DOTALL)


class BadPattern(Exception):
    """An unusable pattern: `message` is the reason, and `help` says what to write; `is_slow` if it took too long."""

    def __init__(self, message: str, help: str | None = None, *, is_slow: bool = False) -> None:
        super().__init__(message)
        self.message = message
        self.help = help
        self.is_slow = is_slow


def is_regular(pattern: str) -> bool:
    """Return whether it is written as a regular expression, `/…/`."""
    return len(pattern) > 2 and pattern.startswith("/") and pattern.endswith("/")


def is_pattern(text: str) -> bool:
    """Return whether a text is a glob or a regular expression, not a single name."""
    return is_glob(text) or is_regular(text)


def fitter(pattern: str, names: Callable[[], Collection[str]], separator: str) -> Callable[[str], bool]:
    """Return a function that says whether a name matches a pattern. Raises `BadPattern`.

    A regular expression is matched with all the `names` at once, which share its time limit.

    >>> pads = fitter("*/pad?", list, "/")
    >>> pads("left/pad1"), pads("pad1")
    (True, False)
    """
    wrong = length_fault(pattern)
    if wrong is not None:
        raise BadPattern(wrong)
    return fitting(pattern[1:-1], names()).__contains__ if is_regular(pattern) else matcher(pattern, separator)


def length_fault(pattern: str) -> str | None:
    """Return the error that a pattern is too long, or None if it is short enough.

    >>> length_fault("{left,right}/*"), length_fault("*" * 10_001)
    (None, 'a pattern of 10001 characters is too long; 10000 are allowed')
    """
    if len(pattern) <= _LONGEST:
        return None
    return f"a pattern of {len(pattern)} characters is too long; {_LONGEST} are allowed"


def fault_of(pattern: str) -> str | None:
    """Return the error in a regular expression, given without its slashes.

    >>> fault_of("link[0-9]+"), fault_of("link[0-9")
    (None, 'unterminated character set')
    """
    try:
        re.compile(pattern)
    except (re.error, OverflowError, RecursionError) as error:
        return str(getattr(error, "msg", error))
    return None


def fitting(pattern: str, names: Collection[str], seconds: float = SECONDS) -> frozenset[str]:
    """Return the names that the whole expression matches. Raises `BadPattern` if it is invalid, or after `seconds`.

    >>> sorted(fitting("link[0-9]+|pad{e}", ["link1", "link12", "pad", "pad{e}"]))
    ['link1', 'link12', 'pad{e}']
    """
    called = f"the regular expression `/{pattern}/`"
    wrong = fault_of(pattern)
    if wrong is not None:
        raise BadPattern(f"{called} is not valid: {wrong}")
    import regex  # takes 40 ms

    end = time.process_time() + seconds  # which `regex` measures, too
    try:
        fits = regex.compile(_MEANT_AS_TEXT.sub(lambda found: found[1] or f"\\{found[2]}", pattern)).fullmatch
        return frozenset(name for name in names if fits(name, timeout=max(end - time.process_time(), 1e-6)))
    except regex.error as error:
        raise BadPattern(f"{called} is not valid: {error.msg}") from None
    except (TimeoutError, MemoryError, RecursionError):
        message = f"{called} takes longer than {seconds:g} seconds"
        help = "write it without repetitions inside repetitions, or use a glob"
        raise BadPattern(message, help, is_slow=True) from None


EVERYTHING = "**"
# If a tag has elements in several sections, it selects those in the body tree and the assets.
_USUAL = ("worldbody", "asset")


class Selector(Struct):
    """A tag with a glob for the names, and further conditions. `tag` is a path, a tag or a family.

    `pattern` is a glob, or `/…/` for a regular expression. `where` compares effective values by attribute
    (`friction[0]` for one number), or is one boolean `${…}`. `at` is the path of the selector in the recipe.
    """

    tag: str
    pattern: str
    parent: Selector | None = None
    inside: Selector | None = None
    part: str | None = None
    dclass: str | None = None
    where: Mapping[str, object] | str | None = None
    at: tuple[str | int, ...] = ()

    @property
    def is_one_name(self) -> bool:
        """Whether it is a single name without further conditions."""
        narrowed = any((self.parent, self.inside, self.part, self.dclass, self.where))
        return not (narrowed or is_pattern(self.pattern))

    def all(self) -> Iterator[Selector]:
        """Yield this selector and its parents'."""
        yield self
        for outer in (self.parent, self.inside):
            if outer is not None:
                yield from outer.all()

    def __str__(self) -> str:
        conditions = {"parent": self.parent, "in": self.inside, "part": self.part, "class": self.dclass}
        narrowed = [f"{name}: {condition}" for name, condition in conditions.items() if condition]
        if isinstance(self.where, str):
            narrowed.append(f"where: {self.where}")
        elif self.where:
            narrowed.append(f"where: {{{', '.join(f'{name}: {value_text(v)}' for name, v in self.where.items())}}}")
        return f"{{{', '.join([f'{self.tag}: {self.pattern}', *narrowed])}}}"


@cache
def paths_of(tag: str) -> frozenset[str]:
    """Return the grammar paths that a tag, a family or a path selects; none if MJCF has no such element.

    >>> sorted(paths_of("joint")), sorted(paths_of("equality/joint")), sorted(paths_of("weld"))
    (['freejoint', 'joint'], ['equality/joint'], ['equality/weld'])
    """
    family = GRAMMAR.families.get(tag)
    if family is not None:
        return frozenset(path for path in family if not path.startswith("default/"))
    if "/" in tag:
        return frozenset({tag}) if tag in GRAMMAR.paths else frozenset()
    usual = frozenset(kind.path for section in _USUAL for name, kind in GRAMMAR.within(section).items() if name == tag)
    if usual:
        return usual
    fitting = [path for path in GRAMMAR.paths if path.rpartition("/")[2] == tag]
    return frozenset(path for path in fitting if not path.startswith("default/") and path != "mujoco")


@cache
def known_tags() -> tuple[str, ...]:
    """Return every tag, family and path that a selector may have, for suggestions."""
    tags = {path.rpartition("/")[2] for path in GRAMMAR.paths} | GRAMMAR.families.keys()
    return tuple(sorted(tags - {"mujoco", "include"}))
