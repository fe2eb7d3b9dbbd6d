"""Numbers, values, counts and elements in the words of messages and models: one form of each for all of them."""

from __future__ import annotations

from collections.abc import Iterable


def number_text(number: float) -> str:
    """Return a number that MuJoCo and Python re-read exactly: the shortest digits, without `.0`.

    >>> number_text(0.1 + 0.2), number_text(1e22), number_text(2.0), number_text(-0.0), number_text(3)
    ('0.30000000000000004', '1e+22', '2', '-0', '3')
    """
    if isinstance(number, int):  # MuJoCo refuses an integer with `.0`; and it may be too large for a float
        return str(number)
    text = repr(number)
    return text[:-2] if text.endswith(".0") else text


def numbers_text(numbers: Iterable[float]) -> str:
    """Return numbers as the value of an attribute of MJCF.

    >>> numbers_text((1, 0.5, 2.0))
    '1 0.5 2'
    """
    return " ".join(map(number_text, numbers))


def value_text(value: object) -> str:
    """Return a value as YAML on one line.

    >>> value_text([0, "90deg", 1.5, True])
    '[0, 90deg, 1.5, true]'
    """
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(value_text, value))}]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return number_text(value) if isinstance(value, int | float) else str(value)


def with_article(noun: str) -> str:
    """Return a noun with its indefinite article.

    >>> with_article("inertial"), with_article("body")
    ('an inertial', 'a body')
    """
    return f"{'an' if noun[:1] in 'aeiou' else 'a'} {noun}"


def plural(noun: str) -> str:
    """Return the plural of a noun. A plural remains as it is.

    >>> [plural(noun) for noun in ("body", "key", "mesh", "flex", "axis", "contacts", "default class")]
    ['bodies', 'keys', 'meshes', 'flexes', 'axes', 'contacts', 'default classes']
    """
    if noun.endswith("is"):
        return f"{noun[:-2]}es"
    if noun.endswith("s") and not noun.endswith("ss"):
        return noun
    if noun.endswith("y") and noun[-2:-1] not in "aeiou":
        return f"{noun[:-1]}ies"
    return f"{noun}{'es' if noun.endswith(('ss', 'x', 'sh', 'ch')) else 's'}"


def counted(number: int, noun: str) -> str:
    """Return a number with its noun.

    >>> counted(1, "entry"), counted(2, "entry"), counted(0, "geom")
    ('1 entry', '2 entries', '0 geoms')
    """
    return f"{number} {noun if number == 1 else plural(noun)}"


def after_noun(name: str | None) -> str:
    """Return a name as it follows its noun; nothing for an element without a name.

    >>> f"the geom{after_noun('pad')}", f"the geom{after_noun(None)}"
    ('the geom `pad`', 'the geom')
    """
    return f" `{name}`" if name else ""


def element_text(kind: str, name: str | None, *, definite: bool = False) -> str:
    """Return an element in a sentence. `definite` puts `the` in front of an element with a name.

    >>> element_text("geom", "pad"), element_text("geom", "pad", definite=True), element_text("actuator", None)
    ('geom `pad`', 'the geom `pad`', 'an actuator without a name')
    """
    if not name:
        return f"{with_article(kind)} without a name"
    return f"{'the ' if definite else ''}{kind}{after_noun(name)}"


def tag_text(tag: str, name: str | None) -> str:
    """Return an element as its file has it.

    >>> tag_text("geom", "pad"), tag_text("geom", None)
    ('`<geom>` `pad`', '`<geom>`')
    """
    return f"`<{tag}>`{after_noun(name)}"
