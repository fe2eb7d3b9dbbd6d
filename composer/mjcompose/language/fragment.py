"""A fragment of MJCF in a recipe, and the attributes that need or exclude each other."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from types import MappingProxyType
from xml.parsers import expat

from mjcompose.base.diagnostic import Fault, Note, Path
from mjcompose.base.suggest import closest, exists_note, unknown_attribute
from mjcompose.language.value import bare_angle, exclusive
from mjcompose.tree.grammar import Constraint, ElementType
from mjcompose.tree.values import check_value, items, parse_real


def report_missing(kind: ElementType, present: Collection[str], owner: str, at: Path, faults: list[Fault]) -> None:
    """Report all required attributes that are missing."""
    missing = {name: each.doc for name, each in kind.attributes.items() if each.required and name not in present}
    faults += [missing_key(owner, *missing, at=at, docs=missing)] if missing else []


def missing_key(owner: str, *names: str, at: Path, docs: Mapping[str, str] = MappingProxyType({})) -> Fault:
    """Return the fault of missing keys, which `docs` explain."""
    notes = tuple(Note(f"`{name}` is: {doc}") for name, doc in docs.items() if doc not in ("", name))
    message = f"{owner} lacks {' and '.join(f'`{name}`' for name in names)}"
    help = f"write `{', '.join(f'{name}: …' for name in names)}`"
    lacks = names[0] if len(names) == 1 else None
    return Fault("missing-key", message, at, key=True, notes=notes, help=help, lacks=lacks, names=names)


def report_clashing(
    rules: Iterable[Constraint], present: Collection[str], owner: str, at: Path, faults: list[Fault]
) -> None:
    """Report attributes that exclude or need each other."""
    for rule in rules:
        fault = _broken_rule(rule, present, owner, at)
        faults += [fault] if fault is not None else []


def _broken_rule(rule: Constraint, present: Collection[str], owner: str, at: Path) -> Fault | None:
    """Return the fault of attributes that break a rule among them, or None."""
    if rule.kind == "exclusive":
        return _exclusive(rule, present, owner, at=at)
    if rule.kind == "oneof":
        return _lacking(rule, present, owner, at)
    if rule.kind == "together" or all(name in present for name in rule.bundles[0]):
        names = [name for bundle in rule.bundles for name in bundle]
        there = [name for name in names if name in present]
        return _incomplete(there, [name for name in names if name not in present], owner, at=at)
    return None


def _lacking(rule: Constraint, present: Collection[str], owner: str, at: Path) -> Fault | None:
    """Return the fault of an element that has none of the bundles of attributes of which it needs one."""
    fewest = min(([name for name in bundle if name not in present] for bundle in rule.bundles), key=len)
    if not fewest:
        return None
    needed = " or ".join(" with ".join(f"`{name}`" for name in bundle) for bundle in rule.bundles)
    help = f"write `{', '.join(f'{name}: …' for name in fewest)}`"
    names = tuple(name for bundle in rule.bundles for name in bundle)
    return Fault("missing-key", f"{owner} needs {needed}", at, key=True, help=help, names=names)


def _exclusive(rule: Constraint, present: Collection[str], owner: str, at: Path) -> Fault | None:
    """Return the fault of the last of several exclusive keys in the file, or None."""
    bundles = {name: index for index, bundle in enumerate(rule.bundles) for name in bundle}
    there = [name for name in present if name in bundles]
    # A name is in several bundles of a rule only if the rule treats them alike. Therefore the first pair decides.
    clash = next(((a, b) for b in reversed(there) for a in there if bundles[a] != bundles[b]), None)
    if clash is None:
        return None
    return exclusive(f"{owner} has both `{clash[0]}` and `{clash[1]}`, of which only one is allowed", clash, at)


def _incomplete(there: Collection[str], missing: Collection[str], owner: str, at: Path) -> Fault | None:
    if not there or not missing:
        return None
    first = next(iter(there))
    wanted = " and ".join(f"`{name}`" for name in missing)
    help = f"write {wanted} too, or leave `{first}` out"
    message = f"{owner} has `{first}` without {wanted}"
    lacks = next(iter(missing)) if len(missing) == 1 else None
    names = (first, *missing)
    return Fault("missing-key", message, (*at, first), key=True, help=help, lacks=lacks, beside=True, names=names)


def check_fragment(
    text: str,
    kinds: Mapping[str, ElementType],
    place: str,
    at: Path,
    bare_angles: bool,
    faults: list[Fault],
    named: bool = False,
) -> tuple[str, Mapping[str, str]] | None:
    """Return tag and attributes of the one element of a fragment, or None after a reported fault.

    `kinds` are the allowed elements, and `place` says in messages where. With `bare_angles`, angles need no unit.
    With `named`, the name comes from elsewhere and is not required.
    """
    check = _Check(kinds, place, at, bare_angles=bare_angles, faults=faults, named=named)
    before = len(faults)
    check.run(text)
    return (check.root[0], check.root[1]) if check.root and len(faults) == before else None


def names_in(text: str, tags: Collection[str]) -> list[tuple[str, str]]:
    """Return tag and name of each element with one of these tags that a fragment without faults declares."""
    found: list[tuple[str, str]] = []

    def start(tag: str, attributes: dict[str, str]) -> None:
        if tag in tags and attributes.get("name"):
            found.append((tag, attributes["name"]))

    parser = expat.ParserCreate()
    parser.StartElementHandler = start
    parser.Parse(text, True)
    return found


_MEND = {
    "no element found": "close every element: `<geom …/>` or `<body …>…</body>`",
    "unclosed token": "close every element: `<geom …/>` or `<body …>…</body>`",
    "mismatched tag": "close every element: `<geom …/>` or `<body …>…</body>`",
    "not well-formed (invalid token)": "put quotes around every value, and write `&lt;` and `&amp;` for `<` and `&`",
    "duplicate attribute": "write each attribute once",
}


class _Check:
    """Receives the events of the XML parser. `stack` has the open elements, with None for unknown ones."""

    def __init__(
        self,
        kinds: Mapping[str, ElementType],
        place: str,
        at: Path,
        bare_angles: bool,
        faults: list[Fault],
        named: bool,
    ) -> None:
        self.kinds = kinds
        self.place = place
        self.at = at
        self.bare_angles = bare_angles
        self.faults = faults
        self.named = named
        self.stack: list[ElementType | None] = []
        self.root: tuple[str, dict[str, str]] | None = None
        self.opened = ""
        self.parser = expat.ParserCreate()
        self.parser.StartElementHandler = self.start
        self.parser.EndElementHandler = lambda _: self.stack.pop()
        self.parser.CharacterDataHandler = self.text
        self.parser.StartDoctypeDeclHandler = self.doctype

    def run(self, text: str) -> None:
        try:
            self.parser.Parse(text, True)
        except expat.ExpatError as error:
            what = expat.ErrorString(error.code)
            if what == "junk after document element":
                help = "write one element here, and an entry of its own for every other"
                at = (error.lineno, error.offset + 1, 1)
                self.fault("wrong-length", "a fragment is a single element, and this is a second one", at, help=help)
            else:
                lines = text.rstrip().splitlines() or [""]
                at = (error.lineno, error.offset + 1, 1)
                if error.lineno > len(lines):  # behind the end: at the last line
                    at = (len(lines), max(len(lines[-1]), 1), 1)
                said = what.removeprefix("not well-formed ").strip("()")
                self.fault("xml-syntax", f"not well-formed XML: {said}", at, help=_MEND.get(what))

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self.opened = tag
        parent = self.stack[-1] if self.stack else None
        if self.stack and parent is None:
            self.stack.append(None)  # inside of something unknown, all is unknown
            return
        if self.root is None:
            self.root = (tag, attributes)
        kinds = self.kinds if parent is None else parent.children
        kind = kinds.get(tag)
        self.stack.append(kind)
        if kind is None:
            where = self.place if parent is None else f"`{parent.tag}`"
            self.fault("unknown-element", f"`{tag}` is not allowed in {where}", names=("element", tag, kinds))
        else:
            self.attributes(kind, attributes, named=self.named and parent is None)

    def attributes(self, kind: ElementType, attributes: dict[str, str], named: bool) -> None:
        owner = f"`{kind.tag}`"
        for name, value in attributes.items():
            attribute = kind.attributes.get(name)
            if attribute is None:
                known = ("attribute", name, kind.attributes)
                found = unknown_attribute(name, owner, kind.attributes)
                self.fault(found.code, found.message, names=known)
                continue
            answer = check_value(attribute, value)
            if answer is not None:
                code = "wrong-keyword" if attribute.type in ("keyword", "keywords") else "wrong-type"
                self.fault(code, f"`{name}` of {owner} {answer.message}", help=answer.advice)
            elif attribute.angle is not None and not self.bare_angles:
                numbers = tuple(number for item in items(value) if (number := parse_real(item)) is not None)
                bare = bare_angle(attribute, numbers, attributes.get("type"), at=self.at, owner=owner)
                if bare is not None:
                    self.fault("bare-angle", bare.message, help="write `angle: degree` at the top of the recipe")
        faults: list[Fault] = []
        present = {**attributes, "name": ""} if named else attributes
        report_missing(kind, present, owner, at=(), faults=faults)
        report_clashing(kind.constraints, list(present), owner, at=(), faults=faults)
        for fault in faults:
            self.fault(fault.code, fault.message, help=fault.help)

    def text(self, text: str) -> None:
        if text.strip() and self.stack and self.stack[-1] is not None:
            lead = len(text) - len(text.lstrip())
            at = (self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber + 1 + lead, len(text.strip()))
            message = f"text in `{self.stack[-1].tag}`, where MJCF has none"
            self.fault("xml-syntax", message, at, help="remove it, or write it as a comment: `<!-- … -->`")

    def doctype(self, *_: object) -> None:
        self.fault("xml-syntax", "a fragment has no `<!DOCTYPE>`")

    def fault(
        self,
        code: str,
        message: str,
        within: tuple[int, int, int] | None = None,
        help: str | None = None,
        names: tuple[str, str, Collection[str]] | None = None,
    ) -> None:
        notes: Iterable[Note] = ()
        if names is not None:
            kind, written, known = names
            near = closest(written, known)
            help = f"write `{near[0]}`" if near else f"take `{written}` out"
            notes = (exists_note(kind, known, written),)
        if within is None:
            tag = self.opened or " "
            within = (self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber + 2, len(tag))
        self.faults.append(Fault(code, message, self.at, notes=tuple(notes), help=help, within=within))
