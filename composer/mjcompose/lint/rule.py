"""Rules of the linter: their form, the model that they read, and their findings.

A rule is a function with a decorator, in the file of its family. Its docstring is the summary, and `docs/rules/CODE.md`
its page. It gets a `Subject` and yields findings. A rule that needs MuJoCo runs next to the compiled model in a child
process; any other rule reads only the elements.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any

from lxml.etree import _Element as Node

from mjcompose.base.codes import CODES, RULES
from mjcompose.base.dataclass import Struct
from mjcompose.base.extensions import check_rows
from mjcompose.base.suggest import did_you_mean
from mjcompose.language.lint_rules import FAMILY_RULES, SELECTED_BY_NAME
from mjcompose.tree.classes import Classes, class_in_force, text_in_effect
from mjcompose.tree.names import NameIndex
from mjcompose.tree.select import kind_of

if TYPE_CHECKING:
    from mjcompose.mujoco.attributes import NameTable
    from mjcompose.mujoco.model_types import MjModel
    from mjcompose.mujoco.servos import Servos
    from mjcompose.mujoco.solids import Shapes
    from mjcompose.tree.unit import Unit

FAMILIES = tuple(FAMILY_RULES)
"""The modules of rules, in this folder."""


class ElementEdit(Struct):
    """An exact change of an element: attributes to set or, with None, to remove; or the removal of the element."""

    attributes: tuple[tuple[str, str | None], ...] = ()
    removes: bool = False


class Finding(Struct):
    """A finding of a rule about an element, or about the model as a whole with the element None.

    `attribute` is the attribute that the message is about, if it is written there. `help` says what to write. `edit`
    is the exact change that `help` describes, if it keeps the meaning of the model or restores the intended one.
    """

    element: Node | None
    message: str
    attribute: str | None = None
    help: str | None = None
    edit: ElementEdit | None = None


Found = Iterator[Finding]


class Rule(Struct):
    """A rule. It runs next to the model if `in_mujoco`, on files if `in_files`, and by default if `usual`."""

    code: str
    family: str
    run: Callable[[Subject], Found]
    summary: str
    in_mujoco: bool
    in_files: bool
    usual: bool
    profiles: Mapping[str, str]


_RULES: dict[str, Rule] = {}


def rule(
    code: str,
    summary: str,
    *,
    in_mujoco: bool = False,
    in_files: bool = False,
    usual: bool = True,
    profiles: Mapping[str, str] | None = None,
) -> Callable[[Callable[[Subject], Found]], Callable[[Subject], Found]]:
    """Return a decorator that makes a function the rule `code`; `summary` describes its findings.

    `profiles` quote the sources that require it.
    """

    def decorate(function: Callable[[Subject], Found]) -> Callable[[Subject], Found]:
        if code in CODES:
            raise ValueError(f"the code `{code}` exists already")
        family = function.__module__.rpartition(".")[2]
        _RULES[code] = Rule(
            code,
            family,
            function,
            summary=summary,
            in_mujoco=in_mujoco,
            in_files=in_files,
            usual=usual,
            profiles=profiles or {},
        )
        CODES[code] = summary[:1].lower() + summary[1:]
        RULES.add(code)
        return function

    return decorate


@cache
def rules() -> Mapping[str, Rule]:
    """Return all rules by code, family by family."""
    for family in FAMILIES:
        importlib.import_module(f"mjcompose.lint.{family}")
    ordered = dict(sorted(_RULES.items(), key=lambda each: (FAMILIES.index(each[1].family), each[0])))
    _check_names(ordered.values())
    return ordered


def _check_names(every: Iterable[Rule]) -> None:
    """Raise TypeError if the language knows other rules than these, in other families, or selects others by itself."""
    known = [(family, code) for family, codes in FAMILY_RULES.items() for code in codes]
    in_models = [each for each in every if not each.in_files]
    table = "composer/mjcompose/language/lint_rules.py"
    check_rows(table, known, [(each.family, each.code) for each in in_models])
    check_rows(f"SELECTED_BY_NAME in {table}", SELECTED_BY_NAME, [each.code for each in in_models if not each.usual])


class UnknownRuleError(ValueError):
    """There is no rule, family or profile of that name; `help` suggests a similar name."""

    def __init__(self, name: str, known: Iterable[str]) -> None:
        super().__init__(f"there is no rule or family `{name}`")
        self.name = name
        self.help = did_you_mean(name, known)


def chosen(select: Collection[str] = (), ignore: Collection[str] = (), profile: str | None = None) -> list[Rule]:
    """Return the rules that codes, families and `all` select: the usual, or a profile's. Raises UnknownRuleError."""
    every = rules()
    for name in (*select, *ignore):
        if name not in every and name not in FAMILIES and name != "all":
            raise UnknownRuleError(name, [*every, *FAMILIES, "all"])

    def named(each: Rule, names: Collection[str]) -> bool:
        return each.code in names or each.family in names or "all" in names

    def starts(each: Rule) -> bool:
        if select:
            return named(each, select)
        return each.usual if profile is None else profile in each.profiles

    return [each for each in every.values() if starts(each) and not (each.code in ignore or each.family in ignore)]


class Subject:
    """The model that rules read.

    `root` is its tree without includes. `unit` is the model with its files; None in the child process, where `mujoco`
    and `model` are the module and the compiled model. `is_part` is False if nothing else completes it.
    """

    def __init__(
        self,
        root: Node,
        unit: Unit | None = None,
        mujoco: Any = None,
        model: MjModel | None = None,
        is_part: bool = True,
    ) -> None:
        self.root = root
        self.unit = unit
        self.mujoco = mujoco
        self._model = model
        self.is_part = is_part

    @property
    def model(self) -> MjModel:
        """The compiled model, which only rules in the child process have."""
        assert self._model is not None
        return self._model

    @cached_property
    def classes(self) -> Classes:
        return Classes(self.root)

    @cached_property
    def names(self) -> NameIndex:
        return NameIndex.of(self.root)

    @property
    def is_complete(self) -> bool:
        """Whether programs load the model as it is: it has a floor or a light, or it is a bundle or a recipe."""
        shapes = {self.value(each, "type") for each in self.root.iterfind("worldbody/geom")}
        return not self.is_part or self.root.find("worldbody/light") is not None or bool(shapes & {"plane", "hfield"})

    def is_own(self, element: Node) -> bool:
        """Return whether the element is written in the file itself, not in an included file."""
        return self.unit is None or self.unit.origins.owner(element, self.unit.file) == self.unit.file

    def each(self, *tags: str) -> Iterator[Node]:
        """Yield the elements with these tags, except those in `<default>`, in document order."""
        for element in self.root.iter(*tags):
            if next(element.iterancestors("default"), None) is None and element.tag != "default":
                yield element

    def value(self, element: Node, attribute: str) -> str | None:
        """Return the value in effect: of the element, its classes or MuJoCo's default; None if nothing sets it."""
        return text_in_effect(element, kind_of(element), attribute, classes=self.classes)

    def given(self, element: Node, attribute: str) -> str | None:
        """Return the value of the element or of its classes; None for MuJoCo's default."""
        own = element.get(attribute)
        if own is not None:
            return str(own)
        found = self.classes.get(class_in_force(element).name).lookup(str(element.tag), attribute)
        return None if found is None else found[0]

    def numbers(self, element: Node, attribute: str) -> list[float] | None:
        """Return the numbers in effect of an attribute; None if there are none."""
        try:
            return [float(word) for word in (self.value(element, attribute) or "").split()] or None
        except ValueError:
            return None

    def setting(self, section: str, attribute: str) -> str | None:
        """Return the value that the last element of a section, such as `compiler`, writes; None if there is none."""
        written = [each.get(attribute) for each in self.root.iterfind(section) if each.get(attribute)]
        return str(written[-1]) if written else None

    @staticmethod
    def called(element: Node) -> str:
        """Return an element in words: joint `elbow`, or an unnamed geom of body `arm`."""
        name = element.get("name")
        if name:
            return f"{element.tag} `{name}`"
        around = next((each for each in element.iterancestors("body") if each.get("name")), None)
        return f"an unnamed {element.tag}" + (f" of body `{around.get('name')}`" if around is not None else "")

    # In the child process

    @cached_property
    def roster(self) -> NameTable:
        from mjcompose.mujoco.attributes import NameTable

        return NameTable(self.model)

    @cached_property
    def rows(self) -> dict[Node, int]:
        """The number of every element among the compiled elements of its kind, as far as it is certain."""
        from mjcompose.mujoco.index import compiled_order, rows

        return rows(compiled_order(self.root), self.roster)

    @cached_property
    def nodes(self) -> dict[tuple[str, int], Node]:
        from mjcompose.mujoco.index import compiled_kind

        return {(compiled_kind(node) or "", row): node for node, row in self.rows.items()}

    def node(self, kind: str, row: int) -> Node | None:
        """Return the element that became this row of a kind, such as `joint`; None if that is not certain."""
        return self.nodes.get((kind, row))

    def name(self, kind: str, row: int) -> str:
        """Return a compiled element in words: joint `elbow`, or geom #2 of body `hand`."""
        described = self.roster.describe(kind, row)
        word = "keyframe" if kind == "key" else kind
        return f"{word} `{described}`" if self.roster.names[kind][row] else f"{word} {described}"

    @cached_property
    def data(self) -> Any:
        """An mjData after `mj_forward` at the reference configuration. A rule does not change it."""
        data = self.mujoco.MjData(self.model)
        self.mujoco.mj_forward(self.model, data)
        return data

    @cached_property
    def servos(self) -> Servos:
        """The servos at the reference configuration."""
        from mjcompose.mujoco.servos import Servos

        return Servos(self.mujoco, self.model, self.data)

    @cached_property
    def shapes(self) -> Shapes:
        """The geoms of bodies at the reference configuration."""
        from mjcompose.mujoco.solids import Shapes

        return Shapes(self.mujoco, self.model)

    def at_keys(self) -> Iterator[tuple[int, str, Any]]:
        """Yield number, name and an mjData after `mj_forward` of each keyframe."""
        for row in range(self.model.nkey):
            data = self.mujoco.MjData(self.model)
            self.mujoco.mj_resetDataKeyframe(self.model, data, row)
            self.mujoco.mj_forward(self.model, data)
            yield row, self.name("key", row), data


def found(subject: Subject, selected: Iterable[Rule]) -> Iterator[tuple[Rule, Finding]]:
    """Yield the findings of rules, each with its rule."""
    yield from ((each, finding) for each in selected for finding in each.run(subject))


def subject_of(text: str, mujoco: Any, model: MjModel, is_part: bool = False) -> Subject:
    """Return a compiled model with the text that it was compiled from."""
    from lxml import etree

    parser = etree.XMLParser(remove_blank_text=True, resolve_entities=False, no_network=True, huge_tree=True)
    return Subject(etree.fromstring(text.encode(), parser), mujoco=mujoco, model=model, is_part=is_part)


class LintQuestion(Struct):
    """A question to the child process: the rules to run, by code, and the text that the model was compiled from."""

    text: str
    codes: Sequence[str]
    is_part: bool


class PlacedFinding(Struct):
    """A finding of the child process: `place` is the number of its element in document order, from 0."""

    code: str
    place: int | None
    message: str
    attribute: str | None
    help: str | None
    edit: ElementEdit | None

    @classmethod
    def of(cls, data: Mapping[str, Any]) -> PlacedFinding:
        """Return the finding that `asdict` turned into data."""
        edit = data["edit"]
        if edit is not None:
            edit = ElementEdit(tuple((name, value) for name, value in edit["attributes"]), edit["removes"])
        return cls(**{**data, "edit": edit})

    def finding(self, elements: Sequence[Node]) -> Finding:
        """Return the finding about one of the elements of the model, in document order."""
        element = None if self.place is None else elements[self.place]
        return Finding(element, self.message, self.attribute, help=self.help, edit=self.edit)


def in_child(mujoco: Any, model: MjModel, asked: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Answer a `LintQuestion` with the data of each `PlacedFinding`; runs under `mujoco.engine.call`."""
    question = LintQuestion(**asked)
    subject = subject_of(question.text, mujoco, model, is_part=question.is_part)
    places = {element: place for place, element in enumerate(subject.root.iter("*"))}
    every = rules()
    selected = [every[code] for code in question.codes]
    return [
        asdict(
            PlacedFinding(
                rule.code,
                None if finding.element is None else places[finding.element],
                finding.message,
                finding.attribute,
                help=finding.help,
                edit=finding.edit,
            )
        )
        for rule, finding in found(subject, selected)
    ]
