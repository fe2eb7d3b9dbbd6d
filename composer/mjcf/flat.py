"""Turn a composition into one flat model. The linker works on copies of all units; the models do not change."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import get_args

from composer.bundle.collect import collect, read
from composer.context import Context
from composer.dataclass import dataclass
from composer.diagnostics.call_site import call_site
from composer.diagnostics.diagnostic import Cause, Diagnostic
from composer.diagnostics.sink import Sink
from composer.diagnostics.text import render
from composer.engine import Session
from composer.link.defaults import choose_classes
from composer.link.key_layouts import layouts
from composer.link.link import finish, link, link_alone
from composer.link.linking import FileUse, Linking, Measure
from composer.link.measure import measure_with
from composer.link.request import Policy, Request
from composer.mjcf.detach_external import without_outward
from composer.mjcf.errors import MjcfError, MjcfWarning, failure, raise_errors
from composer.mjcf.loose_ends import check_references
from composer.mjcf.model import UNNAMED, Model
from composer.mjcf.mounting import Mounting
from composer.mjcf.pruning import prune
from composer.mjcf.relocated import relocated_text
from composer.mjcf.unique_names import is_inner, rename_file, with_unique_names
from composer.tree.name_index import UP
from composer.tree.unit import Unit
from composer.tree.write import as_it_is, to_text

# The linker speaks to the writers of recipes; this is what a Python user can do.
_RENAME = "rename one of the two, or the attached model: `child.model = '…'`"
_HELP = {
    "option-conflict": "make the two agree, or pass `conflict='warning'`, which lets the model's own "
    "value stand and says so, or `conflict='merge'`",
    "freejoint-on-body": "remove the free joint, or attach the model to the worldbody",
    "mocap-on-body": "attach the model to the worldbody",
    "plane-on-body": "remove the plane, or attach the model to something that does not move",
    "name-clash": _RENAME,
    "class-clash": _RENAME,
    "keyframe-conflict": "a key has the numbers of its own model; what is attached has its own keys",
    "not-supported": None,
}


@dataclass(frozen=True, slots=True)
class Flat:
    """One model without attachments, the files it names, and the warnings from linking.

    `is_measured` says that MuJoCo was asked for values, which depend on the bytes of files.
    """

    unit: Unit
    files: list[FileUse]
    warnings: list[Diagnostic]
    is_measured: bool


def copied(model: Model) -> Unit:
    """Return a copy of the model's unit, which the linker may change."""
    unit = model.unit.copied()
    unit.label = label(model)
    if unit.file == UNNAMED:
        unit.file = model.name
    return unit


def label(model: Model) -> str:
    """Return the name of the folder for a model's files."""
    known = model.unit.label
    return re.sub(r"[^\w.-]+", "_", model.name) if known == UNNAMED or not known else known


def flatten(model: Model, conflict: Policy, copy: Callable[[Model], Unit] = copied) -> Flat:
    """Link a model and everything attached to it into one model. Raises `MjcfError` with the faults found.

    `copy` is called for each model and returns the unit to link.
    """
    _check(model, conflict)
    return linked(model, conflict, copy, check_keys=True)


def linked(model: Model, conflict: Policy, copy: Callable[[Model], Unit], *, check_keys: bool) -> Flat:
    """Link a model whose references have been checked. See `flatten`.

    With `check_keys`, the keyframes of a model without attachments are laid out too, to report those that do not fit.
    """
    sink = _NamesChecked()
    mounting = Mounting(model, copy)
    prefixes = (
        UP,
        *(part.prefix for part in mounting.parts),
        *(name for part in mounting.parts for name in part.outward.values()),
    )
    for unit in (mounting.base, *(part.unit for part in mounting.parts)):
        prune(unit)
    with ExitStack() as ending:
        started: list[Measure] = []
        measure = _measure(sink, prefixes, ending, started) if mounting.parts else None
        linking = Linking(mounting.base, mounting.parts, sink, Request(conflict=conflict), measure)
        if not mounting.parts:
            if check_keys:
                layouts(linking)
            link_alone(linking)
            if check_keys:
                finish(linking)
        else:
            choose_classes(linking)
            mounting.add_joints(linking)
            linking.notes.nameless.update(mounting.named)
            link(linking)
            if not sink.has_errors:
                finish(linking)
            mounting.clear_up()
            prune(linking.base)
    if sink.has_errors:
        raise MjcfError(map(_for_python, sink.errors))
    return Flat(linking.base, linking.files, list(map(_for_python, sink.diagnostics)), bool(started))


def _check(model: Model, conflict: Policy) -> None:
    """Raise `MjcfError` if `conflict` is not a policy, or if a reference names nothing."""
    if conflict not in get_args(Policy):
        words = ", ".join(f"`{word}`" for word in get_args(Policy))
        raise failure("wrong-keyword", f"`conflict` is one of {words}, got `{conflict}`", call_site())
    names = Sink()
    check_references(model, names)
    raise_errors(names)


def issue_warnings(flat: Flat) -> None:
    """Issue the warnings from linking as `MjcfWarning`s, at the line of the caller's program."""
    _issue(flat.warnings)


def _issue(told: list[Diagnostic]) -> None:
    for each in told:
        place = call_site()
        warnings.warn_explicit(render(each), MjcfWarning, place.file, place.line)


def text(model: Model, conflict: Policy) -> str:
    """Return the composition as MJCF text. See `RootElement.to_xml_string`."""
    state = _state(model, conflict) if model.attachments else None
    if model.written is not None and model.written[0] == state:
        _, found, told = model.written
        _issue(told)
        return found
    _check(model, conflict)
    known = relocated_text(model, label(model))
    if known is not None:
        return known
    flat = linked(model, conflict, copied, check_keys=False)
    name_files(flat)
    issue_warnings(flat)
    found = to_text(flat.unit.root)
    model.written = None if state is None or flat.is_measured else (state, found, flat.warnings)
    return found


def _state(model: Model, conflict: Policy) -> list[object] | None:
    """Return everything on which the text of a composition depends; None if it also depends on what is on disk.

    The text of a tree takes a tenth of the time of linking it.
    """
    state: list[object] = [conflict]
    folders: dict[str, Path] = {}
    for each in model.composition():
        unit, root = each.unit, each.unit.root
        # Files of one path are the same where links say so, and a skin is read to give its bodies other names.
        if folders.setdefault(label(each), unit.directory) != unit.directory or unit.contents:
            return None
        if next(root.iter("skin", "model", "attach"), None) is not None:
            return None
        hung = [
            (prefix, root.getroottree().getelementpath(to.host), as_it_is(to.frame))
            for prefix, to in each.attachments.items()
        ]
        awaited = [(text, *target) for target, text in each.awaited.values()]
        state.append((as_it_is(root), unit.file, label(each), unit.directory, unit.door, hung, awaited))
    return state


def name_files(flat: Flat) -> None:
    """Write the file names of `contents` into the model. If no file name repeats, keep the linker's paths."""
    bases = {use.path[use.path.rfind("/") :].lower() for use in flat.files}
    if len(bases) == len(flat.files):
        return
    for use, name in with_unique_names(flat.files):
        if name != use.path and not is_inner(use, flat.files):
            rename_file(use.element, use.attribute, name)


def assets(model: Model) -> dict[str, bytes]:
    """Return the bytes of the composition's files by name. See `RootElement.assets`."""
    return contents(flatten(model, "warning"))


def contents(flat: Flat) -> dict[str, bytes]:
    """Return the bytes of a model's files by the names from `name_files`. Raises `MjcfError` for unreadable files."""
    found: dict[str, bytes] = {}
    sink = Sink()
    for use, name in with_unique_names(flat.files):
        if name not in found:
            found[name] = read(flat.unit, use, sink) or b""
    raise_errors(sink)
    return found


def bundle_paths(model: Model) -> dict[bytes | Path, str]:
    """Return the path of each file in an export, by the file's source path or its bytes. Raises `MjcfError`."""
    flat = flatten(model, "warning")
    sink = Sink()
    collect(flat.unit, flat.files, sink)
    raise_errors(sink)
    found: dict[bytes | Path, str] = {}
    for use in flat.files:
        path = str(use.element.get(use.attribute))
        found.setdefault(Path(use.source), path)
        if use.content is not None:
            found.setdefault(use.content, path)
    return found


class _NamesChecked(Sink):
    """Drops errors about names: the linker checks them unit by unit, but here references cross models."""

    def add(self, diagnostic: Diagnostic, cause: Cause | None = None) -> None:
        if diagnostic.code != "unknown-name":
            super().add(diagnostic, cause)


def _measure(sink: Sink, prefixes: tuple[str, ...], ending: ExitStack, started: list[Measure]) -> Measure:
    """Return a function that measures a unit alone with MuJoCo, for values that the tree does not contain.

    MuJoCo runs in a separate process, which starts with the first call and ends with `ending`.
    """

    def measure(unit: Unit, arrays: tuple[str, ...], *, attempt: bool = False) -> Mapping[str, list[float]]:
        if not started:
            started.append(measure_with(Context(sink), session=ending.enter_context(Session())))
        return started[0](without_outward(unit, prefixes), arrays, attempt=attempt)

    return measure


def _for_python(diagnostic: Diagnostic) -> Diagnostic:
    if diagnostic.help is None:
        return diagnostic
    is_error = diagnostic.severity == "error"
    return replace(diagnostic, help=_HELP.get(diagnostic.code, diagnostic.help) if is_error else None)
