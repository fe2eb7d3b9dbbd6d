"""Reading the mapping of an element, with all its faults."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping as AbcMapping
from dataclasses import field
from itertools import takewhile
from typing import Any

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Fault, Fix, Path
from mjcompose.base.suggest import closest, exists_note, renaming, unknown_attribute
from mjcompose.base.words import number_text
from mjcompose.language.condition import is_item
from mjcompose.language.forms.context import Settings
from mjcompose.language.fragment import check_fragment, report_clashing, report_missing
from mjcompose.language.value import (
    RecipeElement,
    Value,
    bare_angle,
    element_instead,
    fault_at,
    is_unprintable,
    kind_of,
    name_fault,
    no_angle,
    read_value,
    unprintable,
)
from mjcompose.text.expression import Angle
from mjcompose.text.merge import is_of_elements, is_taken_out
from mjcompose.text.node import Mapping, Node, Scalar, Sequence, is_template
from mjcompose.tree.grammar import GRAMMAR, ElementType
from mjcompose.tree.values import either

_NAMES = ("attach", "sensor", "actuator", "equality", "tendon")


def lost_indentation(mapping: Mapping, at: Path) -> tuple[Fault, Iterable[str]] | None:
    """Return the fault of keys that lost their indentation, and its entries, the name first; None without such keys.

    In a mapping from names to elements, every value is a mapping. Therefore, a name without a value that is
    followed by a key with a single value or a list has lost its indentation.
    """
    if not (len(at) == 1 and at[0] in _NAMES) and not (len(at) == 2 and at[0] == "asset"):
        return None
    names = list(mapping.entries)
    values = [value for _, value in mapping.entries.values()]
    for index, name in enumerate(names, 1):
        if not _is_empty(values[index - 1]):
            continue
        below = takewhile(lambda value: not (isinstance(value, Mapping) or _is_empty(value)), values[index:])
        beside = [key for key, _ in zip(names[index:], below, strict=False)]
        if beside:
            keys = " and ".join(f"`{key}`" for key in beside)
            stand = "stands" if len(beside) == 1 else "stand"
            message = f"{keys} {stand} next to `{name}`, not below it"
            help = f"indent {keys} two spaces deeper than `{name}`"
            return Fault("wrong-type", message, (*at, beside[0]), key=True, help=help), [name, *beside]
    return None


def _is_empty(node: Node) -> bool:
    return isinstance(node, Scalar) and node.value is None


class Placed(dict[str, Any]):
    """A mapping that has its path from the top of the recipe."""

    __slots__ = ("at",)

    def __init__(self, at: Path) -> None:
        super().__init__()
        self.at = at


def path_of(value: object) -> Path:
    """Return the path of a mapping from the top of the recipe, empty for a mapping that was made in Python."""
    return value.at if isinstance(value, Placed) else ()


def raw(node: Node, faults: list[Fault], at: Path = ()) -> Any:
    """Return the tree as dicts (`Placed`), lists and values; a key without a value is a fault, and stays."""
    if isinstance(node, Scalar):
        if node.value is None and not is_taken_out(at):
            faults.append(_nothing(at))
        elif isinstance(node.value, str) and is_template(node.value) and not is_of_elements(at):
            faults.append(Fault("expression", "an expression has no value here", at))
        return node.value
    if isinstance(node, Sequence):
        return [raw(item, faults, (*at, index)) for index, item in enumerate(node.items)]
    mapping = Placed(at)
    fallen = lost_indentation(node, at)
    if fallen is not None:
        faults.append(fallen[0])
    for name, (_, value) in node.entries.items():
        path = (*at, name)
        if fallen is not None and name in fallen[1]:
            continue
        if is_template(name):
            help = _help_for_key(path)
            faults.append(Fault("expression", "an expression cannot be a key", path, key=True, help=help))
            continue
        mapping[name] = raw(value, faults, path)
    return mapping


def _help_for_key(path: Path) -> str:
    if is_item(path):
        return "write the name itself, or repeat the entry: `key_${i}: {for: {i: 3}, …}`"
    holder = next((step for step in reversed(path[:-1]) if isinstance(step, str)), "the recipe")
    return f"write each name itself: `for` cannot repeat the entries of `{holder}`"


def _nothing(at: Path) -> Fault:
    if at and isinstance(at[-1], str):
        help = "write a value behind it (`{}` for an element without attributes), or leave the key out"
        return Fault("wrong-type", f"`{at[-1]}` has no value", at, key=True, help=help)
    return Fault("wrong-type", "a value is missing here", at)


FRAGMENT = "xml"
CONFIG = "config"
NAME = "name"
_OBJECT = {"objtype", "objname"}
_OF_ENTRIES = ("for", "when")
_OWNERS = 3  # elements that a help line names


class Reader(Struct, frozen=False):
    """Reads elements by the grammar and collects their faults. The paths of faults start where the reading starts."""

    settings: Settings = field(default_factory=Settings)
    faults: list[Fault] = field(default_factory=list)

    def element(
        self,
        kind: ElementType,
        value: Any,
        at: Path,
        owner: str,
        *,
        keyed: AbcMapping[str, str] | None = None,
        own: Collection[str] = (),
        children: tuple[RecipeElement, ...] = (),
        joint: str | None = None,
    ) -> RecipeElement | None:
        """Return the element of a mapping of attributes and children, or None if it is not a mapping.

        `owner` is its name in messages. `keyed` are attributes that a key above gives, which must not be written
        again. The caller reads the keys in `own`; its `children` come before the others. `joint` is the type of a
        joint without `type`.
        """
        if not isinstance(value, dict):
            self.faults.append(_no_mapping(owner, value, at, help=element_instead(kind, value)))
            return None
        keyed = keyed or {}
        if FRAGMENT in value:
            return self.fragment({kind.tag: kind}, f"the place of {owner}", value, at=at, keyed=keyed, own=own)
        attributes: dict[str, Value] = dict(keyed)
        meant: list[str] = []
        below = list(children)
        for name, item in value.items():
            path = (*at, name)
            if name in own:
                continue
            if name in keyed:
                message = f"`{name}` of {owner} is given by its key, `{keyed[name]}`"
                help = f"leave `{name}` out; `{name}: ''` is for an element without a name"
                self.faults.append(Fault("unknown-key", message, path, key=True, help=help))
            elif name in kind.attributes:
                read = read_value(kind.attributes[name], item, path, owner=owner, faults=self.faults, tag=kind.tag)
                if read is not None:
                    attributes[name] = read
            elif name == CONFIG and name in kind.children:
                below += self.config(item, path, path_of(value), owner=owner)
            elif name in kind.children:
                below += self.children(kind.children[name], item, path, owner=owner)
            else:
                fault = self.unknown(kind, name, item, at=path, owner=owner, own=own, taken={*keyed, *value})
                meant += _meant(kind, name, item, there=value)
                self.faults.append(fault)
        # A value with a fault is not missing, and neither is a value with a misspelled key.
        present = [*keyed, *value, *meant]
        report_missing(kind, present, owner, at=at, faults=self.faults)
        report_clashing(kind.constraints, present, owner, at=at, faults=self.faults)
        self.angles(kind, attributes, at, owner=owner, joint=joint)
        return RecipeElement(kind.tag, attributes, tuple(below), at=path_of(value))

    def keyed(self, kinds: Iterable[ElementType], name: str, value: Any, at: Path, owner: str) -> AbcMapping[str, str]:
        """Return the attributes that an entry's key gives to its element, one of `kinds`: none if `name` is empty."""
        if not isinstance(value, dict) or value.get(NAME) != "":
            return {NAME: name}
        if any(kind.attributes[NAME].required for kind in kinds):
            message = f"MuJoCo has no {owner.partition(' ')[0]} without a name"
            self.faults.append(Fault("bad-name", message, (*at, NAME), help=f"leave `{NAME}` out: the key is the name"))
        return {}

    def children(self, kind: ElementType, value: Any, at: Path, owner: str) -> Iterable[RecipeElement]:
        """Return the elements with one tag: a mapping is one element, a list is several."""
        if isinstance(value, list):
            if kind.max_count is not None and len(value) > kind.max_count:
                few = "one" if kind.max_count == 1 else str(kind.max_count)
                self.faults.append(Fault("wrong-length", f"{owner} can have {few} `{kind.tag}`, got {len(value)}", at))
            read = [self.element(kind, item, (*at, i), owner=label(kind.tag, item)) for i, item in enumerate(value)]
            return [each for each in read if each is not None]
        if isinstance(value, dict) and _is_named(kind, value):
            name = next(iter(value))
            message = f"`{kind.tag}` in {owner} expects a list of elements, got a mapping of names"
            help = f"write `{kind.tag}: [{{name: {name}, …}}]`"
            self.faults.append(Fault("wrong-type", message, (*at, name), key=True, help=help))
            return ()
        element = self.element(kind, value, at, owner=label(kind.tag, value))
        return () if element is None else (element,)

    def config(self, value: Any, at: Path, above: Path, owner: str) -> Iterable[RecipeElement]:
        """Yield a plugin's settings `{key: value}` as `config` elements."""
        if not isinstance(value, dict):
            self.faults.append(_no_mapping(f"`{CONFIG}` of {owner}", value, at))
            return
        for key, setting in value.items():
            text = config_text(setting)
            if is_unprintable(key):
                self.faults.append(unprintable(f"the key of a `{CONFIG}`", (*at, key), key=True))
            elif text is None:
                message = f"`{key}` in the `{CONFIG}` of {owner} expects text or a number, got {kind_of(setting)}"
                self.faults.append(Fault("wrong-type", message, (*at, key)))
            elif (angle := _angle_in(setting)) is not None:  # plugins would read the number and ignore its unit
                self.faults.append(no_angle(f"`{key}` in the `{CONFIG}` of {owner}", angle, (*at, key)))
            elif is_unprintable(text):
                self.faults.append(unprintable(f"`{key}` in the `{CONFIG}` of {owner}", (*at, key)))
            else:
                yield RecipeElement(CONFIG, {"key": key, "value": text}, at=(*above, CONFIG, key))

    def fragment(
        self,
        kinds: AbcMapping[str, ElementType],
        place: str,
        value: dict[str, Any],
        at: Path,
        keyed: AbcMapping[str, str] | None = None,
        own: Collection[str] = (),
    ) -> RecipeElement | None:
        """Return the element of a mapping with a fragment of MJCF, `{xml: <geom …/>}`, or None after a fault."""
        keyed = keyed or {}
        for name in value:
            if name != FRAGMENT and name not in own:
                message = f"`{name}` is next to `{FRAGMENT}`, which is the whole element"
                help = "write it into the fragment"
                self.faults.append(Fault("unknown-key", message, (*at, name), key=True, help=help))
        text = value[FRAGMENT]
        path = (*at, FRAGMENT)
        if not isinstance(text, str):
            message = f"`{FRAGMENT}` expects a fragment of MJCF as text, got {kind_of(text)}"
            self.faults.append(Fault("wrong-type", message, path))
            return None
        found = check_fragment(
            text,
            kinds,
            place,
            at=path,
            bare_angles=self.settings.bare_angles,
            faults=self.faults,
            named="name" in keyed,
        )
        if found is None:
            return None
        tag, written = found
        if NAME in value and written.get(NAME):
            message = f"`{NAME}` says that the element has no name, and the fragment's is `{written[NAME]}`"
            help = "leave one of the two out"
            self.faults.append(Fault("name-clash", message, (*at, NAME), help=help))
        for name, given in keyed.items():
            if written.get(name, given) != given:
                message = f"the fragment's `{name}` is `{written[name]}`, its key says `{given}`"
                help = f"leave `{name}` out of the fragment, or write `{written[name]}` as the key"
                self.faults.append(Fault("name-clash", message, path, help=help))
        return RecipeElement(tag, dict(keyed), xml=text, at=path_of(value))

    def angles(
        self, kind: ElementType, attributes: AbcMapping[str, Value], at: Path, owner: str, joint: str | None
    ) -> None:
        """Report angles without a unit, if the recipe sets none."""
        written = attributes.get("type", joint)
        type = written if isinstance(written, str) else None
        if not self.settings.bare_angles:
            for name, value in attributes.items():
                attribute = kind.attributes.get(name)
                if attribute is not None and attribute.angle is not None:
                    fault = bare_angle(attribute, value, type, at=(*at, name), owner=owner)
                    self.faults += [fault] if fault is not None else []

    def unknown(
        self,
        kind: ElementType,
        name: str,
        value: Any,
        at: Path,
        owner: str,
        own: Collection[str],
        taken: Collection[str],
    ) -> Fault:
        """Return the fault of a key that is neither an attribute nor a child. `taken` are the written keys."""
        if name in _OF_ENTRIES:
            message = f"`{name}` is for a whole entry, and `{kind.tag}` is inside of one"
            help = f"write an entry of its own: `add: [{{{name}: …, to: BODY, {kind.tag}: {{…}}}}]`"
            return Fault("unknown-key", message, at, key=True, help=help)
        attributes = [attribute for attribute in (*own, *kind.attributes) if attribute not in taken]
        known = [*attributes, *(child for child in kind.children if child not in taken)]
        near = closest(name, known)
        help, fix = _advice_for_unknown(kind, name, value, near=near, fix=renaming(name, known))
        items = value if isinstance(value, list) else [value]
        looks_alike = any(isinstance(item, dict) for item in items) or (near and near[0] in kind.children)
        if kind.children and looks_alike:
            notes = (exists_note("element", kind.children, name),)
            message = f"`{name}` is not allowed in {owner}"
            return Fault("unknown-element", message, at, key=True, notes=notes, help=help, fix=fix)
        return fault_at(unknown_attribute(name, owner, attributes), at, key=True, help=help, fix=fix)

    def names(self, value: Any, at: Path, owner: str) -> Iterable[tuple[str, Any]]:
        """Yield the entries of a mapping from names to elements."""
        if not isinstance(value, dict):
            self.faults.append(_no_names(owner, value, at))
            return
        for name, item in value.items():
            fault = name_fault(name, owner, (*at, name))
            if fault is not None:
                self.faults.append(fault)
            else:
                yield name, item


def _advice_for_unknown(
    kind: ElementType, name: str, value: Any, near: list[str], fix: Fix | None
) -> tuple[str, Fix | None]:
    """Return the help for an unknown key and its fix: another place if there is one, else a similar name."""
    if kind.attributes.keys() >= _OBJECT and name in GRAMMAR.objtypes and isinstance(value, str):
        return f"write `objtype: {name}, objname: {value}`", None
    is_section = name in GRAMMAR.root.children
    groups = [tag for tag, child in kind.children.items() if name in child.attributes]
    if 0 < len(groups) <= _OWNERS and not near:
        place = f"`{groups[0]}: {{…}}`" if len(groups) == 1 else either(groups)
        return f"write it in {place}", None if is_section else fix
    if is_section:
        return f"write it in the section `{name}`", None
    if near:
        return f"write `{near[0]}`", fix
    siblings = GRAMMAR.element("body").children
    if not groups and kind.tag in siblings:
        owners = [tag for tag, sibling in siblings.items() if name in sibling.attributes]
        if 0 < len(owners) <= _OWNERS:
            return f"it is an attribute of {either(owners)}", fix
    return f"take `{name}` out", fix


def label(tag: str, value: Any) -> str:
    """Return the description of an element in messages: `geom `pad``, or just `geom` without a name."""
    name = value.get("name") if isinstance(value, dict) else None
    return f"{tag} `{name}`" if isinstance(name, str) and name else f"`{tag}`"


def _angle_in(setting: Any) -> Angle | None:
    """Return the first angle of a plugin's setting."""
    if isinstance(setting, list):
        return next(filter(None, map(_angle_in, setting)), None)
    return Angle.read(setting) if isinstance(setting, str) else None


def config_text(value: Any) -> str | None:
    """Return a plugin's setting as text, or None for no setting. The items of a list are separated by spaces."""
    if isinstance(value, list):
        texts = [config_text(item) for item in value if not isinstance(item, list)]
        known = [text for text in texts if text is not None]
        return " ".join(known) if len(known) == len(value) else None
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return number_text(value)
    return value if isinstance(value, str) else None


def _meant(kind: ElementType, name: str, value: Any, there: Collection[str]) -> list[str]:
    """Return the attributes that an unknown key stands for, which are not reported as missing too."""
    if kind.attributes.keys() >= _OBJECT and name in GRAMMAR.objtypes and isinstance(value, str):
        return [*_OBJECT]
    head = name.partition(":")[0]
    missing = [each for each, attribute in kind.attributes.items() if attribute.required and each not in there]
    return [head] if head in missing else closest(name, missing)


def _no_mapping(owner: str, value: Any, at: Path, help: str | None = None) -> Fault:
    return Fault("wrong-type", f"{owner} expects a mapping, got {kind_of(value)}", at, help=help)


def _no_names(owner: str, value: Any, at: Path) -> Fault:
    help = None
    if isinstance(value, list):
        name = next((item for item in value if isinstance(item, dict)), {}).get("name")
        shown = name if isinstance(name, str) else "NAME"
        help = f"the key is the name: write `{shown}: {{…}}` instead of a list"
    return Fault("wrong-type", f"{owner} expects a mapping from names to elements, got {kind_of(value)}", at, help=help)


def _is_named(kind: ElementType, value: dict[str, Any]) -> bool:
    known = {*kind.attributes, *kind.children, FRAGMENT}
    return bool(value) and all(isinstance(item, dict) and name not in known for name, item in value.items())
