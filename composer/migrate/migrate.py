"""A model of one version of MuJoCo as one of another: its files with the changes, and what is not the same."""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping
from dataclasses import field
from pathlib import Path

from composer.context import Context
from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Cause
from composer.grammar.history import default_of, place, unread
from composer.grammar.version import version_key
from composer.migrate.attached import Pieces
from composer.migrate.changes import between
from composer.migrate.editing import Editing, Meaning, Step, called
from composer.migrate.markup import Markup, MarkupError, Source
from composer.tree.files import file_attributes, join, written_path
from composer.tree.parse import parse_file
from composer.tree.unit import Unit

from lxml.etree import _Element as Node  # isort: skip

_MARK = b"\xef\xbb\xbf"


@dataclass(slots=True)
class Migrated:
    """`files` are the texts before and after of all XML of the model, by path; `assets` what else it reads.

    `adopted` are the changes that were left out because the new behaviour is wanted.
    """

    before: str
    after: str
    files: dict[Path, tuple[bytes, bytes]] = field(default_factory=dict)
    assets: tuple[Path, ...] = ()
    steps: tuple[Step, ...] = ()
    meanings: tuple[Meaning, ...] = ()
    adopted: tuple[str, ...] = ()

    @property
    def changed(self) -> dict[Path, tuple[bytes, bytes]]:
        return {path: texts for path, texts in self.files.items() if texts[0] != texts[1]}


def read(model: Path, context: Context) -> Unit | None:
    """The tree of a model that the user names; None where there is none, which is reported."""
    return parse_file(context.folder / model, context.sink, file=context.shown(model))


def migrate(
    unit: Unit,
    before: str,
    after: str,
    context: Context,
    adopt: Collection[str] = (),
    values: Mapping[str, object] | None = None,
) -> Migrated | None:
    """The model for another version, with the models that it attaches; None where it cannot be one, which is reported.

    The unit is changed. `values` has what the MuJoCo of `before` measured of the model, where that is known.
    """
    pieces = Pieces.of(unit, context)
    whole = [
        Editing(each.unit, context.sink, before, after=after, values=pieces.measured(each, values or {}))
        for each in pieces.every
    ]
    sources = [_sources(editing.unit, context) for editing in whole]
    if context.sink.has_errors:
        return None
    assets = tuple(dict.fromkeys(path for editing in whole for path in _assets(editing.unit)))
    adopted = _carried_out(whole, adopt)
    if adopted is None:
        return None
    result = Migrated(before, after, assets=assets, adopted=tuple(adopted))
    for editing, files in zip(whole, sources, strict=True):
        assert files is not None
        for path, (source, data) in files.items():
            try:
                text = source.rewritten(editing.root, editing.renamed)
            except MarkupError:
                _cannot_edit(path, context)
                return None
            mark = _MARK if data.startswith(_MARK) else b""
            new = mark + text.encode("utf-8", "surrogateescape")
            if result.files.setdefault(path, (data, new))[1] != new:
                _two_texts(path, context)
                return None
    result.steps = tuple(step for editing in whole for step in editing.steps)
    result.meanings = (*pieces.left, *(each for editing in whole for each in editing.meanings))
    return result


def _carried_out(whole: list[Editing], adopt: Collection[str]) -> list[str] | None:
    """Change all models, one change after the other; the changes that were left out, or None after errors."""
    adopted = []
    for change, act in between(whole[0].before, whole[0].after):
        if act is None:
            continue
        if change.name in adopt:
            adopted.append(change.name)
            continue
        for editing in whole:
            editing.change = change
            editing.whole = whole
            editing.unit.forget_classes()
        for editing in whole:
            act(editing)
    for editing in whole:
        editing.change = None
        _leave_out(editing)
    return None if whole[0].sink.has_errors else adopted


def _two_texts(path: Path, context: Context) -> None:
    context.sink.error(
        "migrate-cannot",
        f"`{context.shown(path)}` is included by two of these models, and would have to be another text for each",
        help="make a copy of it for one of them",
    )


def _leave_out(editing: Editing) -> None:
    """What the other version has not: taken away where it says what it would do anyhow, else an error."""
    for found in list(unread(editing.root, editing.after)):
        node, name = found.node, found.attribute
        if node in editing.refused:
            continue
        if next(unread_in(node, editing.before, name, value=found.value), False):
            continue  # the version it was written for does not read it either
        if name is None and not (found.since and version_key(found.since) > version_key(editing.after)):
            editing.refuse(node, f"MuJoCo {editing.after} has no {found.called}: {found.when()}")
        elif name is None:
            editing.refuse(
                node, f"MuJoCo {editing.after} has no {found.called}: {found.when()}",
                "`mjcompose build --target plain` writes a model without frames and copies"
                if node.tag in ("frame", "replicate", "attach") else None,
            )  # fmt: skip
        elif found.value is None and _says_nothing(editing, node, name):
            editing.unset(node, name)
        elif f"{place(node)}@{name}" in _OF_THE_ENGINE:
            words = editing.lacking(place(node), name, str(node.get(name)))
            editing.warn(node, words, None, attribute=name, arrays=(f"flags.{name}",))
            editing.unset(node, name)
        else:
            editing.refuse(
                node, f"MuJoCo {editing.after} has no {found.called}: {found.when()}", None, attribute=name
            )


_HARMLESS = {
    "option/flag@nativeccd": "disable",
    "option/flag@multiccd": "disable",
    "option/flag@island": "disable",
    "option@sleep_tolerance": None,
    "visual/global@bvactive": "true",
    "body/light@softness": None,
    "default/light@softness": None,
    "asset/texture@colorspace": "linear",
    "compiler@savecompiled": None,
    "compiler@savecanonical": None,
    "compiler@saveinertial": None,
}
"""What an attribute says that means the same as to have none; None: whatever it says."""


_OF_THE_ENGINE = frozenset(
    f"option/flag@{name}" for name in ("nativeccd", "autoreset", "diagexact", "ipc", "speculative", "sleep")
)
"""Ways to simulate that an earlier version has not: the model is the same without."""


def _says_nothing(editing: Editing, node: Node, name: str) -> bool:
    path = place(node)
    key = f"{path}@{name}"
    if key in _HARMLESS:
        return _HARMLESS[key] is None or node.get(name) == _HARMLESS[key]
    return node.get(name) == default_of(path, name)


def unread_in(node: Node, version: str, name: str | None, value: str | None):  # type: ignore[no-untyped-def]
    """Whether that is not read by this version either, once."""
    for each in unread(node.getroottree().getroot(), version):
        if each.node is node and each.attribute == name and each.value == value:
            yield True
            return


def _sources(unit: Unit, context: Context) -> dict[Path, tuple[Source, bytes]] | None:
    """The files of a unit with the nodes that stand in each; None where their text has another form."""
    nodes: dict[str, list[Node]] = {}
    for node in unit.root.iter("*"):
        owner = unit.origins.owner(node, unit.file)
        nodes.setdefault(str(owner), []).append(node)
    result: dict[Path, tuple[Source, bytes]] = {}
    for file in dict.fromkeys((unit.file, *unit.origins.texts)):
        inside = os.path.relpath(file, os.path.dirname(unit.file) or ".")
        path = Path(os.path.normpath(unit.directory / inside))
        data = unit.door.read(path)
        try:
            markup = Markup.read(data.removeprefix(_MARK).decode("utf-8", "surrogateescape"))
            result[path] = Source(markup, _matched(markup, nodes.get(file, []), file != unit.file)), data
        except MarkupError:
            _cannot_edit(path, context)
            return None
    return result


def _matched(markup: Markup, nodes: list[Node], is_included: bool) -> list[Node | None]:
    """For each element of a text its node: `<include>` and the root of an included file have none."""
    waiting = iter(nodes)
    found: list[Node | None] = []
    for index, element in enumerate(markup.elements):
        if element.tag == "include" or (is_included and not index):
            found.append(None)
            continue
        node = next(waiting, None)
        if node is None or node.tag != element.tag:
            raise MarkupError(element.tag)
        found.append(node)
    if next(waiting, None) is not None:
        raise MarkupError("")
    return found


def _cannot_edit(path: Path, context: Context) -> None:
    context.sink.error(
        "migrate-cannot",
        f"`{context.shown(path)}` is written in a form that cannot be edited in place",
        help="`mjcompose build` of a recipe with this model as its `base` writes it anew; migrate that",
        cause=Cause("form", str(path)),
    )


def _assets(unit: Unit):  # type: ignore[no-untyped-def]
    """The files that the model reads beside its XML."""
    for element, _, name in file_attributes(unit.root):
        yield Path(join(str(unit.directory), written_path(unit.settings, element, name)))
    for element in unit.root.iterfind("asset/model"):
        if element.get("file"):
            yield Path(join(str(unit.directory), str(element.get("file"))))


def report(migrated: Migrated, context: Context, settled: Collection[str] = ()) -> None:
    """The warnings of what is not the same; those about arrays that a proof has found to be equal are left out."""
    for each in migrated.meanings:
        if each.arrays and set(each.arrays) <= set(settled):
            continue
        cause = Cause(f"{each.change} {each.help}", each.message)
        context.sink.warning("migrate-changed", each.message, each.span, help=each.help, cause=cause)


__all__ = ["Migrated", "called", "migrate", "read", "report"]
