"""The check `exists`: the model has certain elements."""

from __future__ import annotations

from typing import ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Note, Path
from mjcompose.base.suggest import advised, exists_note
from mjcompose.language.checks.equal import Number, attribute_of, check_one, numbers_of
from mjcompose.language.checks.form import Keys, Kind, keywords, naming
from mjcompose.language.form import Schema, kind_of, shown
from mjcompose.language.select import GLOB, NARROWING
from mjcompose.mujoco.attributes import ENUMERATED, HOLDERS
from mjcompose.mujoco.attributes import TAGS as ATTRIBUTES_OF

TAGS = (
    "body", "joint", "geom", "site", "camera", "light", "flex", "skin", "mesh", "hfield", "texture", "material",
    "pair", "exclude", "equality", "tendon", "actuator", "sensor", "numeric", "text", "tuple", "plugin", "key",
)  # fmt: skip
"""What a compiled model has names for; families stand for all of their tags."""
EXPECT = "expect"
AROUND = ("parent", "in")
WHERE = "where"
_BESIDE = (EXPECT, *AROUND, WHERE)


@dataclass(frozen=True, slots=True)
class Where:
    """A condition on an attribute, or on one of its numbers. `key` is how the recipe writes it.

    `word` is the value of an attribute that is not a number. For a name, it may be a glob.
    """

    key: str
    attr: str
    index: int | None
    value: tuple[Number, ...] = ()
    word: str | None = None


@dataclass(frozen=True, slots=True)
class Selected:
    """Elements whose names match a glob. `expect` is their number, None for at least one.

    `parent` is a glob for the body that directly contains them, `inside` one for any body around them.
    """

    tag: str
    glob: str
    expect: int | None
    parent: str | None = None
    inside: str | None = None
    where: tuple[Where, ...] = ()


@dataclass(frozen=True, slots=True)
class Exists:
    """Each of the selectors matches something. The place of one is `(*at, "exists", INDEX)`."""

    word: ClassVar[str] = "exists"
    name: str
    selectors: tuple[Selected, ...]
    at: Path


def _selected(index: int, value: object, keys: Keys) -> Selected | None:
    if not isinstance(value, dict):
        message = f"a selector in {keys.owner} is a mapping from a tag to a name, got {kind_of(value)}"
        keys.add("wrong-type", message, index, help="write for instance `{site: tcp}`")
        return None
    tags = [key for key in value if key not in _BESIDE]
    for tag in tags:
        if tag not in TAGS:
            help, fix = advised(tag, (*TAGS, *_BESIDE))
            note = exists_note("tag", TAGS, tag)
            message = f"`{tag}` in {keys.owner} is not a tag whose names a compiled model has"
            if tag in NARROWING:
                message = f"`{tag}` in {keys.owner} is nothing that a compiled model knows"
                note = Note("it knows `parent`, `in` and `where`, and names with the prefixes of parts")
                help = fix = None
            keys.add("unknown-key", message, index, tag, key=True, notes=(note,), help=help, fix=fix)
            return None
    if len(tags) != 1:
        message = f"a selector in {keys.owner} has {len(tags)} tags, and needs one"
        keys.add("wrong-type", message, index, help="write one selector for each: `[{site: a}, {body: b}]`")
        return None
    glob = keys.glob_of(value[tags[0]], "a name or a glob", index, tags[0])
    if glob is None:
        return None
    expect = value.get(EXPECT)
    if EXPECT in value and (isinstance(expect, bool) or not isinstance(expect, int) or expect < 0):
        keys.add(
            "wrong-type", f"`expect` in {keys.owner} expects a count, got {kind_of(expect)}", index, EXPECT
        )
        return None
    parent, inside = (
        _around(index, key, value[key], tag=tags[0], keys=keys) if key in value else None for key in AROUND
    )
    where = _where(index, value[WHERE], tags[0], keys=keys) if WHERE in value else ()
    return Selected(tags[0], glob, expect, parent=parent, inside=inside, where=where)


def _where(index: int, value: object, tag: str, keys: Keys) -> tuple[Where, ...]:
    """Return the conditions on attributes of the compiled model."""
    if tag not in (*ATTRIBUTES_OF, *ENUMERATED) and not naming(tag):
        message = f"`{WHERE}` in {keys.owner}: a compiled model has no attributes of a {tag} that could be asked for"
        keys.add("unknown-key", message, index, WHERE, key=True, help=f"leave `{WHERE}` out")
        return ()
    if not isinstance(value, dict) or not value:
        message = f"`{WHERE}` in {keys.owner} is a mapping from attributes to values, got {kind_of(value)}"
        keys.add(
            "wrong-type", message, index, WHERE, help=f'write for instance `{WHERE}: {{"size[0]": 0.1}}`'
        )
        return ()
    found: list[Where] = []
    words = [*keywords(tag), *naming(tag)]
    for key, wanted in value.items():
        if key in words:
            word = _word(tag, key, wanted, keys=keys, index=index)
            found += [Where(key, key, None, word=word)] if word is not None else []
            continue
        attr, place = attribute_of(keys, tag, key, index, WHERE, key, others=words)
        numbers = numbers_of(keys, wanted, index, WHERE, key) if attr is not None else None
        check_one(keys, wanted, place, index, WHERE, key)
        if attr is not None and numbers is not None:
            found.append(Where(key, attr, place, value=numbers))
    return tuple(found)


def _word(tag: str, attr: str, value: object, keys: Keys, index: int) -> str | None:
    """Return the value that an attribute must have: one of its keywords, or a glob over names."""
    at = (index, WHERE, attr)
    if attr not in keywords(tag):
        return keys.glob_of(value, "a name or a glob", *at)
    word, known = str(value), keywords(tag)[attr]
    if word in known:
        return word
    help, fix = advised(word, known)
    note = exists_note("value", known, word)
    message = f"`{attr}` of a {tag} is never `{shown(value)}`"
    keys.add("wrong-keyword", message, *at, notes=(note,), help=help, fix=fix)
    return None


def _around(index: int, key: str, value: object, tag: str, keys: Keys) -> str | None:
    """Return the glob for a body around the selected elements."""
    body = value.get("body") if isinstance(value, dict) and len(value) == 1 else None
    if tag not in HOLDERS:
        keys.add("unknown-key", f"`{tag}` in {keys.owner} stands on no body", index, key, key=True,
                 help=f"leave `{key}` out")  # fmt: skip
    elif isinstance(body, str) and body:
        return keys.glob_of(body, "a name or a glob", index, key, "body")
    else:
        message = f"`{key}` in {keys.owner} is a body by its name or a glob, got {kind_of(value)}"
        keys.add("wrong-type", message, index, key, help=f'write for instance `{key}: {{body: "**/pad"}}`')
    return None


class Selectors:
    """Form of a list of selectors: a tag with a name or a glob, and what narrows it down."""

    def read(self, keys: Keys) -> tuple[Selected, ...]:
        found = [_selected(index, each, keys) for index, each in enumerate(keys.value)]
        return tuple(each for each in found if each is not None)

    def schema(self) -> Schema:
        return {
            "type": "array",
            "minItems": 1,
            "description": "Elements that must be there: selectors, a tag with a name or a glob over names.",
            "items": {
                "type": "object",
                "minProperties": 1,
                "maxProperties": 5,
                "additionalProperties": False,
                "properties": {
                    **{tag: {**GLOB, "description": f"a glob over the names: {tag}"} for tag in TAGS},
                    EXPECT: {
                        "type": ["integer", "string"],
                        "minimum": 0,
                        "pattern": r"\$\{",
                        "description": "how many there must be; without it, at least one",
                    },
                    WHERE: {
                        "type": "object",
                        "minProperties": 1,
                        "description": "only what has these values in the compiled model: `type: mesh`, `joint: elbow`",
                    },
                    **{
                        key: {
                            "type": "object",
                            "description": f"only what has a body of that name {where} it",
                            "properties": {
                                "body": {**GLOB, "description": "a glob over the names of bodies"}
                            },
                            "required": ["body"],
                            "additionalProperties": False,
                        }
                        for key, where in zip(AROUND, ("right around", "somewhere around"), strict=True)
                    },
                },
            },
        }


def make(keys: Keys, found: tuple[Selected, ...], at: Path) -> Exists:
    if not keys.value:
        message = f"`exists` of {keys.owner} asks for nothing"
        keys.add("missing-key", message, help="write `exists: [{site: tcp}]`")
    return Exists(keys.name, found, at)


KIND = Kind("exists", Selectors(), make, example="[{site: tcp}]")
