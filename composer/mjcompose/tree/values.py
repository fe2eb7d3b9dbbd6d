"""Whether a value fits an attribute, from XML, Python or YAML: the answer is a `Refusal`, or None if it fits.

In XML, C's `strtod` defines numbers, as in MuJoCo. Integers are decimal digits only and fit in 32 bits. Items
are separated by ASCII white space; a comma is never a separator. Names and sibling attributes are not considered.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Mapping, Sequence

from mjcompose.base.dataclass import Struct
from mjcompose.base.words import with_article
from mjcompose.tree.grammar import Attribute, NotMjcf

NOT_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


def code_point(character: str) -> str:
    r"""Return a message's text for an unprintable character.

    >>> code_point("\x00")
    'U+0000'
    """
    return f"U+{ord(character):04X}"


_NAMES = frozenset({"fovy", "azimuth"})
_IN_DEGREES = frozenset({("light", "cutoff"), ("global", "elevation")})


def is_in_degrees(tag: str, attribute: str) -> bool:
    """Return whether an attribute is such an angle; all others are in radians, including the cutoff of a sensor.

    >>> is_in_degrees("light", "cutoff"), is_in_degrees("camera", "fovy"), is_in_degrees("jointpos", "cutoff")
    (True, True, False)
    """
    return attribute in _NAMES or (tag, attribute) in _IN_DEGREES


# Angles of a joint, or sums of them, in radians. The joint or the tendon of the element determines whether they are
# angles.
_CONTROLS = ("ctrlrange", "lengthrange")
_READINGS = ("cutoff", "noise")
_TENDON = ("range", "springlength", "springyield", "margin")
_OF_JOINTS: Mapping[str, Collection[str]] = {
    "joint": ("margin", "polycoef"),
    **dict.fromkeys(("fixed", "tendon"), (*_TENDON, "polycoef")),  # `tendon` is the tag of an equality, and of a class
    "key": ("qpos", "qvel", "act", "ctrl"),
    "numeric": ("data",),
    "element": ("prm",),
    **dict.fromkeys(("position", "velocity", "orientation", "dcmotor"), _CONTROLS),
    **dict.fromkeys(("motor", "damper", "cylinder", "muscle"), ("lengthrange",)),
    "intvelocity": (*_CONTROLS, "actrange"),
    "general": (*_CONTROLS, "actrange", "velrange", "dynprm"),
    "plugin": (*_CONTROLS, *_READINGS, "actrange", "dynprm"),
    "pid": (*_CONTROLS, "posrange", "velrange", "slewmax"),
    **dict.fromkeys(
        (
            "jointpos", "jointvel", "tendonpos", "tendonvel", "actuatorpos", "actuatorvel", "jointlimitpos",
            "jointlimitvel", "tendonlimitpos", "tendonlimitvel", "ballquat", "ballangvel", "gyro", "framequat",
            "frameangvel", "frameangacc", "user",
        ),
        _READINGS,
    ),
}  # fmt: skip
_OF_USERS = "user"


def may_be_angle(tag: str, attribute: Attribute) -> bool:
    """Return whether an angle has a meaning there: in `pos`, `timestep` or `damping` it has none.

    >>> from mjcompose.tree.grammar import GRAMMAR
    >>> [may_be_angle("joint", GRAMMAR.element("joint").attributes[name]) for name in ("range", "pos", "damping")]
    [True, False, False]
    >>> [may_be_angle(tag, GRAMMAR.element(tag).attributes["ctrlrange"]) for tag in ("position", "motor")]
    [True, False]
    """
    if attribute.type != "real":
        return False
    return (
        attribute.angle is not None
        or attribute.name == _OF_USERS
        or is_in_degrees(tag, attribute.name)
        or attribute.name in _OF_JOINTS.get(tag, ())
    )


REAL = re.compile(
    r"[+-]?(?:0x(?:[0-9a-f]+\.?[0-9a-f]*|\.[0-9a-f]+)(?:p[+-]?[0-9]+)?"
    r"|(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[+-]?[0-9]+)?"
    r"|inf(?:inity)?|nan(?:\([0-9a-z_]*\))?)",
    re.IGNORECASE | re.ASCII,
)
INTEGER = re.compile(r"[+-]?[0-9]+", re.ASCII)
SPACE = " \t\n\r\f\v"
INT_MIN = -(2**31)
INT_MAX = 2**31 - 1


def items(text: str) -> list[str]:
    """Split a list at ASCII white space only; a no-break space separates nothing."""
    return re.split(f"[{SPACE}]+", text.strip(SPACE)) if text.strip(SPACE) else []


def parse_real(text: str) -> float | None:
    """Return the number for a single item, or `None` if MuJoCo would refuse it, even for overflow.

    >>> parse_real("1e-3"), parse_real("0x1p3"), parse_real("1,5"), parse_real("1e400")
    (0.001, 8.0, None, None)
    """
    if REAL.fullmatch(text) is None:
        return None
    lower = text.lower()
    if "nan" in lower:
        return math.nan
    try:
        value = float.fromhex(text) if "0x" in lower else float(text)
    except OverflowError:
        return None
    return None if math.isinf(value) and "inf" not in lower else value


def real(text: str) -> float:
    """Return the number for a single item. Raises NotMjcf."""
    value = parse_real(text)
    if value is None:
        raise NotMjcf(f"not a number: {text}")
    return value


def parse_int(text: str) -> int | None:
    """Return the integer for a single item, or `None` if MuJoCo would refuse it.

    >>> parse_int("010"), parse_int("1.0"), parse_int("2147483648")
    (10, None, None)
    """
    value = int(text) if INTEGER.fullmatch(text) is not None else INT_MAX + 1
    return value if INT_MIN <= value <= INT_MAX else None


class Refusal(Struct):
    """The reason why a value is not valid, and what to write instead.

    `message` is a lowercase fragment that continues "`size`…": `expects 3 numbers, got 2`. `is_length` says that
    only the number of items or characters is wrong. `unknown` is an unknown keyword. `lists_keywords` says that the
    message lists the existing ones. `instead` is the value to write, in YAML. `hint` is any other advice.

    >>> str(Refusal("expects numbers, got text", instead="[1, 2]"))
    'expects numbers, got text; write [1, 2]'
    """

    message: str
    is_length: bool = False
    unknown: str | None = None
    lists_keywords: bool = False
    instead: str | None = None
    hint: str | None = None

    @property
    def advice(self) -> str | None:
        return self.hint if self.instead is None else f"write {self.instead}"

    def __str__(self) -> str:
        return self.message if self.advice is None else f"{self.message}; {self.advice}"


SHOWN_KEYWORDS = 12
_LETTERS = {"eulerseq": "xyzXYZ"}
SHOWN_TEXT = 40


def check_value(attribute: Attribute, text: str) -> Refusal | None:
    """Check the text of an XML attribute, as MuJoCo reads it."""
    kind = attribute.type
    if kind == "bool":
        return None if text in ("true", "false") else Refusal(f"expects `true` or `false`, got `{shorten(text)}`")
    if kind == "keyword":
        return None if text in attribute.keywords else unknown_keyword(attribute, text)
    if kind == "chars":
        return check_characters(attribute, text) if text else None
    parts = items(text) if kind in ("real", "int", "keywords") else []
    if not parts:
        return None  # an empty value is the same as no attribute
    if kind == "keywords":
        return check_words(attribute, parts)
    parse = parse_int if kind == "int" else parse_real
    wrong = next((part for part in parts if parse(part) is None), None)
    return check_length(attribute, len(parts)) if wrong is None else refused_number(attribute, wrong)


def check_python(attribute: Attribute, value: object) -> Refusal | None:
    """Check a Python or YAML value, never None. The message for text instead of numbers says how to write them."""
    kind = attribute.type
    if value is None:
        return Refusal(f"expects {expected(attribute)}, got nothing")
    value = plain(value)
    if kind in ("real", "int"):
        return check_numbers(attribute, value)
    if kind == "bool":
        return None if isinstance(value, bool) else Refusal(f"expects `true` or `false`, got `{show(value)}`")
    if kind == "keyword" and (word := keyword_text(value)) is not None:
        return None if word in attribute.keywords else unknown_keyword(attribute, word)
    if kind in ("keywords", "references"):
        return check_list(attribute, value)
    if isinstance(value, bool | int | float) and kind != "keyword":
        text = show(value)
        return Refusal(f"expects {expected(attribute)}, got {article(value)} `{text}`", hint=f"quote it: '{text}'")
    if not isinstance(value, str):
        return Refusal(f"expects {expected(attribute)}, got {article(value)}")
    if attribute.required and not value and kind != "name":
        return Refusal("must not be empty")
    return check_characters(attribute, value) if kind == "chars" else None


def check_numbers(attribute: Attribute, value: object) -> Refusal | None:
    """Check a number, or a list of numbers."""
    if isinstance(value, str):
        parts = items(value.replace(",", " "))
        if len(parts) > 1 and all(parse_real(part) is not None for part in parts):
            return Refusal(f"expects {expected(attribute)}, got text", instead=f"[{', '.join(parts)}]")
        return Refusal(f"expects {expected(attribute)}, got `{shorten(value)}`")
    if isinstance(value, Sequence):
        if attribute.max_length == 1:
            return Refusal(f"expects {expected(attribute)}, got a list of {len(value)}")
        faults = (check_number(attribute, plain(item)) for item in value)
        return next(filter(None, faults), None) or check_length(attribute, len(value))
    fault = check_number(attribute, value)
    return fault or (check_length(attribute, 1) if (attribute.min_length or 1) > 1 else None)


def check_number(attribute: Attribute, value: object) -> Refusal | None:
    """Check one number, on its own or in a list."""
    is_int = attribute.type == "int"
    wanted = "expects" if attribute.max_length == 1 else "expects every item to be"
    wanted += " an integer" if is_int else " a number"
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if not is_number or (is_int and isinstance(value, float) and not value.is_integer()):
        return Refusal(f"{wanted}, got `{show(value)}`")
    assert isinstance(value, int | float)
    if is_int and not INT_MIN <= value <= INT_MAX:
        return Refusal(f"{wanted} of 32 bits, got `{show(value)}`")
    is_too_large = not is_int and isinstance(value, int) and abs(value) > 2**1023
    return Refusal(f"{wanted}, got one that is too large") if is_too_large else None


def check_list(attribute: Attribute, value: object) -> Refusal | None:
    """Check a list of keywords or names, or a single one."""
    if isinstance(value, str):
        parts = items(value)
        if len(parts) > 1:
            return Refusal(f"expects {expected(attribute)}, got text", instead=f"[{', '.join(parts)}]")
        value = [value]
    if not isinstance(value, Sequence):
        return Refusal(f"expects {expected(attribute)}, got `{show(value)}`")
    words: list[str] = []
    for item in value:
        word = keyword_text(plain(item)) if attribute.type == "keywords" else item
        if not isinstance(word, str) or not word:
            return Refusal(f"expects every item to be {'a keyword' if attribute.type == 'keywords' else 'a name'}")
        if attribute.type == "references" and len(items(word)) != 1:
            return Refusal(f"expects names without spaces, got `{shorten(word)}`")
        words.append(word)
    if not words:
        return Refusal(f"expects {expected(attribute)}, got an empty list")
    return None if attribute.type == "references" else check_words(attribute, words)


def check_words(attribute: Attribute, words: Sequence[str]) -> Refusal | None:
    """Check several keywords: whether they are unknown, repeated, or out of order."""
    unknown = next((word for word in words if word not in attribute.keywords), None)
    if unknown is not None:
        return unknown_keyword(attribute, unknown)
    again = next((word for at, word in enumerate(words) if word in words[:at]), None)
    if again is not None:
        return Refusal(f"has `{again}` twice")
    right = sorted(words, key=attribute.keywords.index)
    if attribute.ordered and right != list(words):
        return Refusal(f"expects its keywords in the order [{', '.join(right)}]")
    return check_length(attribute, len(words))


def check_characters(attribute: Attribute, text: str) -> Refusal | None:
    """Check a string with a limited number of characters."""
    if check_length(attribute, len(text)) is not None:
        return Refusal(f"expects {counted(attribute, 'character')}, got {len(text)}", is_length=True)
    letters = _LETTERS.get(attribute.name, text)
    odd = next((each for each in text if each not in letters), None)
    return None if odd is None else Refusal(f"expects letters of `{letters}`, got `{odd}`")


def check_length(attribute: Attribute, count: int) -> Refusal | None:
    low = attribute.min_length
    high = attribute.max_length
    fits = (low is None or count >= low) and (high is None or count <= high)
    if attribute.lengths is not None:
        fits = count in attribute.lengths
    return None if fits else Refusal(f"expects {expected(attribute)}, got {count}", is_length=True)


def expected(attribute: Attribute) -> str:
    """Return a noun phrase for the attribute's values: `3 numbers`, `a name`, `1 to 6 numbers`."""
    if attribute.is_number:
        return counted(attribute, "number" if attribute.type == "real" else "integer")
    return {
        "bool": "`true` or `false`",
        "keyword": "a keyword",
        "keywords": "a list of keywords",
        "file": "a file name",
        "name": "a name",
        "reference": "a name",
        "references": "a list of names",
    }.get(attribute.type, "text")


def counted(attribute: Attribute, noun: str) -> str:
    """Return a noun phrase with the number of values."""
    low = attribute.min_length
    high = attribute.max_length
    if attribute.lengths is not None:
        return f"{' or '.join(str(length) for length in attribute.lengths)} {noun}s"
    if low == high and low is not None:
        return with_article(noun) if low == 1 else f"{low} {noun}s"
    if high is None:
        return f"{noun}s" if (low or 1) <= 1 else f"at least {low} {noun}s"
    if low == 1 and high == 2:
        return f"1 or 2 {noun}s"
    return f"{low} to {high} {noun}s"


def unknown_keyword(attribute: Attribute, word: str) -> Refusal:
    """Return the refusal of an unknown keyword, with the most similar one, or all of them if they are few."""
    is_short = len(attribute.keywords) <= SHOWN_KEYWORDS
    choices = either(attribute.keywords) if is_short else "a keyword"
    if not word:
        return Refusal(f"expects {choices}, got nothing", unknown=word, lists_keywords=is_short)
    meant = next((each for each in attribute.keywords if each.lower() == word.strip().lower()), None)
    if is_short and meant is None:
        return Refusal(f"expects {choices}, got `{shorten(word)}`", unknown=word, lists_keywords=True)
    hint = None if meant is None else f"it is spelled `{meant}`"
    return Refusal(f"has no keyword `{shorten(word)}`", unknown=word, hint=hint)


def refused_number(attribute: Attribute, part: str) -> Refusal:
    """Return the refusal of one item of a list of numbers."""
    noun = expected(attribute)
    instead = None
    if attribute.type == "int":
        real = parse_real(part)
        if part.lstrip("+-").isdigit():
            noun = f"{noun} of 32 bits"
        elif real is not None and real.is_integer():
            instead = str(int(real))
    elif "," in part:
        noun = "numbers separated by spaces"
    return Refusal(f"expects {noun}, got `{shorten(part)}`", instead=instead)


def keyword_text(value: object) -> str | None:
    """Return a keyword in XML spelling: YAML's `true` and `2` are keywords of some attributes."""
    if isinstance(value, int):
        return str(value).lower()
    return value if isinstance(value, str) else None


def plain(value: object) -> object:
    """Convert a value of an array library to Python's own by its `tolist`; return anything else unchanged."""
    convert = getattr(value, "tolist", None)
    return convert() if callable(convert) else value


def either(words: Iterable[str]) -> str:
    """Return `a`, `b` or `c`, each in backquotes."""
    quoted = [f"`{word}`" for word in words]
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} or {quoted[-1]}"


_NOUNS = ((bool, "a boolean"), (int | float, "a number"), (str, "text"), (Sequence, "a list"))


def article(value: object) -> str:
    """Return the noun for a value's type, with its article."""
    return next((noun for kind, noun in _NOUNS if isinstance(value, kind)), "a mapping")


def show(value: object) -> str:
    """Return a value in YAML spelling, shortened."""
    return str(value).lower() if isinstance(value, bool) else shorten(str(value))


def shorten(text: str) -> str:
    return text if len(text) <= SHOWN_TEXT else f"{text[: SHOWN_TEXT - 1]}…"
