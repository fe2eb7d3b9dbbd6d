"""A model of one version of MuJoCo becomes one of another, with the proof."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import ExitStack
from dataclasses import field
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Cause, Note
from mjcompose.base.scratch import scratch
from mjcompose.model.files import file_attributes, join, written_path
from mjcompose.model.grammar import number_text, version_key
from mjcompose.model.history import default_of, place, unread
from mjcompose.model.parse import all_admitted, parse_file
from mjcompose.model.unit import Unit
from mjcompose.mujoco.arrays import with_trait
from mjcompose.mujoco.messages import parse
from mjcompose.sources.context import Context
from mjcompose.sources.lock import resolve
from mjcompose.sources.reference import SourceError
from mjcompose.tools.migrate.changes import ORDERED, between
from mjcompose.tools.migrate.compare import Outcome, compare
from mjcompose.tools.migrate.editing import (
    RELEASED,
    Editing,
    Markup,
    MarkupError,
    Meaning,
    Pieces,
    Source,
    Step,
    later,
    release,
)
from mjcompose.tools.migrate.environments import Compiled, Other, OtherError, make, open_python, this_python


def _own() -> str | None:
    try:
        return version("mujoco")
    except PackageNotFoundError:
        return None


def installed() -> str:
    """The release that is installed here, or the last one that the table knows."""
    own = _own()
    return (own and release(".".join(map(str, version_key(own))))) or RELEASED[-1]


def check_installed(context: Context) -> None:
    """A warning where a MuJoCo is installed that is newer than the table."""
    own = _own()
    if own is not None and version_key(own) > version_key(RELEASED[-1]):
        context.sink.warning(
            "migrate-version",
            f"MuJoCo {own} is installed, and what changed after {RELEASED[-1]} is not known",
            help="update mjcompose",
        )


def known(text: str, option: str, context: Context) -> str | None:
    """The release of a version that the user names; None where there is none, which is reported."""
    found = release(text)
    if found is None:
        context.sink.error(
            "migrate-version",
            f"`{option} {text}` is not a MuJoCo that models can be migrated from or to",
            help=f"there are {RELEASED[0]} to {RELEASED[-1]}; of `{option} 3.1` the last one is taken",
        )
    return found


def written_for(unit: Unit, after: str, others: Collection[str], context: Context) -> str | None:
    """The version that a model is written for, where nobody says it; None where it is not known, which is reported.

    `others` are the versions of the Pythons that the user names.
    """
    beside = [each for each in others if each != after]
    if len(beside) == 1:
        return known(beside[0], "--with-python", context)
    if later(installed(), after):
        return installed()
    first, last = bounds(unit.root)
    if first is None or last is None:
        says = "no MuJoCo since 3.0 reads all that is in it"
    elif last == RELEASED[-1]:
        says = f"all since {first} read it"
    else:
        says = f"those from {first} to {last} read it"
    context.sink.error(
        "migrate-version",
        f"it is not known which MuJoCo `{unit.file}` is written for: {says}",
        help=f"say it with `--from`, as in `--from {last if last and last != after else '3.3'}`;"
        " its README or the date of its last change tell",
    )
    return None


def bounds(root: Node) -> tuple[str | None, str | None]:
    """From which version to which one there is all that a tree has, as far as it shows."""
    fitting = [version for version in RELEASED if next(unread(root, version), None) is None]
    return (fitting[0], fitting[-1]) if fitting else (None, None)


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
    unit: Unit, before: str, after: str, context: Context, adopt: Collection[str] = (),
    values: Mapping[str, object] | None = None,
) -> Migrated | None:  # fmt: skip
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
                context.sink.error(
                    "migrate-cannot",
                    f"`{context.shown(path)}` is included by two of these models, and would have to be another text"
                    " for each",
                    help="make a copy of it for one of them",
                )
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


def _leave_out(editing: Editing) -> None:
    """What the other version has not: taken away where it says what it would do anyhow, else an error."""
    for found in list(unread(editing.root, editing.after)):
        node, name = found.node, found.attribute
        if node in editing.refused:
            continue
        unread_before = unread(editing.root, editing.before)
        if any(each.node is node and (each.attribute, each.value) == (name, found.value) for each in unread_before):
            continue  # the version it was written for does not read it either
        lacks = f"MuJoCo {editing.after} has no {found.called}: {found.when()}"
        if name is None:
            is_new = found.since and later(found.since, editing.after)
            help = "`mjcompose build --target plain` writes a model without frames and copies"
            editing.refuse(node, lacks, help if is_new and node.tag in ("frame", "replicate", "attach") else None)
        elif found.value is None and _says_nothing(node, name):
            editing.unset(node, name)
        elif f"{place(node)}@{name}" in _OF_THE_ENGINE:
            words = editing.lacking(place(node), name, str(node.get(name)))
            editing.warn(node, words, None, attribute=name, arrays=(f"flags.{name}",))
            editing.unset(node, name)
        else:
            editing.refuse(node, lacks, None, attribute=name)


_HARMLESS = {
    "option/flag@nativeccd": "disable", "option/flag@multiccd": "disable", "option/flag@island": "disable",
    "option@sleep_tolerance": None, "visual/global@bvactive": "true", "body/light@softness": None,
    "default/light@softness": None, "asset/texture@colorspace": "linear", "compiler@savecompiled": None,
    "compiler@savecanonical": None, "compiler@saveinertial": None,
}  # fmt: skip
"""What an attribute says that means the same as to have none; None: whatever it says."""


_OF_THE_ENGINE = frozenset(
    f"option/flag@{name}" for name in ("nativeccd", "autoreset", "diagexact", "ipc", "speculative", "sleep")
)
"""Ways to simulate that an earlier version has not: the model is the same without."""


def _says_nothing(node: Node, name: str) -> bool:
    path = place(node)
    key = f"{path}@{name}"
    if key in _HARMLESS:
        return _HARMLESS[key] is None or node.get(name) == _HARMLESS[key]
    return node.get(name) == default_of(path, name)


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


def _assets(unit: Unit) -> Iterator[Path]:
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


@dataclass(slots=True)
class Proof:
    """`before` and `after` are what each MuJoCo made of the model, None for one that is not there."""

    before: Compiled | None = None
    after: Compiled | None = None
    outcome: Outcome | None = None


@dataclass(slots=True)
class Prover:
    """Compiles in a folder of its own. `others` are the MuJoCos that there are, by version."""

    folder: Path
    others: Mapping[str, Other]
    progress: Callable[[str], None]
    known: dict[str, Compiled] = field(default_factory=dict)

    def original(self, migrated_from: str, model: Path) -> Compiled | None:
        """What the MuJoCo of the model's own version makes of it where it stands. Raises OtherError."""
        other = self.others.get(migrated_from)
        if other is None:
            return None
        if migrated_from not in self.known:
            self.progress(f"compiling {model.name} with MuJoCo {migrated_from}")
            self.known[migrated_from] = other.compile(model, self.folder / "before.npz")
        return self.known[migrated_from]

    def result(self, migrated: Migrated, model: Path) -> Compiled | None:
        """What the other MuJoCo makes of the migrated model. Raises OtherError, and OSError."""
        other = self.others.get(migrated.after)
        if other is None:
            return None
        self.progress(f"compiling the migrated {model.name} with MuJoCo {migrated.after}")
        stage = self.folder / "stage"
        stage.mkdir()
        inside = lay_out(migrated, stage, link=True)
        return other.compile(inside[model], self.folder / "after.npz")

    def prove(self, migrated: Migrated, model: Path) -> Proof:
        """Raises OtherError, and OSError."""
        proof = Proof(self.original(migrated.before, model), self.result(migrated, model))
        one, two = proof.before, proof.after
        if one is not None and two is not None and one.error is None and two.error is None:
            proof.outcome = compare(one, two)
        return proof


def measured(compiled: Compiled | None) -> dict[str, object]:
    """What a change needs to know of the model as it was: the damping of each actuator."""
    if compiled is None or compiled.arrays is None:
        return {}
    import numpy as np

    with np.load(compiled.arrays, allow_pickle=False) as stored:
        damping = stored["actuator_biasprm"][:, 2]
    names = compiled.names.get("actuator", ())
    return {"kv": {name: number_text(-float(value)) for name, value in zip(names, damping, strict=False) if name}}


def lay_out(migrated: Migrated, folder: Path, *, link: bool = False) -> dict[Path, Path]:
    """Write the migrated files and what they read into a folder, as they stand to one another; where each is.

    With `link` what is not changed is only linked to. Raises OSError.
    """
    every = [*migrated.files, *migrated.assets]
    top = os.path.commonpath([os.path.abspath(each.parent) for each in every])
    placed: dict[Path, Path] = {}
    for path in every:
        to = folder / os.path.relpath(os.path.abspath(path), top)
        if to in placed.values():
            continue
        to.parent.mkdir(parents=True, exist_ok=True)
        placed[path] = to
        if path in migrated.files:
            to.write_bytes(migrated.files[path][1])
        elif not os.path.exists(path):
            continue  # MuJoCo says so
        elif link and os.name == "posix":
            to.symlink_to(os.path.abspath(path))
        else:
            shutil.copyfile(path, to)
    return placed


_SHOWN = 20
_FOLLOW = with_trait("tree inertia", "output inertia", "subtree").union(
    "cam_poscom0 light_poscom0 geom_rbound".split(),
    "stat.meaninertia stat.meanmass stat.meansize stat.center stat.extent".split(),
)
"""What MuJoCo computes from masses and places, and is not the same where these are not."""


@dataclass(frozen=True, slots=True)
class Wish:
    """What is asked for. `pythons` have other MuJoCos; with `proves` those that lack are installed."""

    model: str
    before: str | None = None
    after: str | None = None
    adopt: tuple[str, ...] = ()
    pythons: tuple[Path, ...] = ()
    proves: bool = False


@dataclass(slots=True)
class Result:
    """`missing` are the versions that would be needed for a proof; `unexplained` the differences no change tells of."""

    model: Path
    migrated: Migrated
    proof: Proof
    missing: tuple[str, ...] = ()
    explained: list[str] = field(default_factory=list)
    unexplained: list[str] = field(default_factory=list)

    @property
    def is_proved(self) -> bool:
        return self.proof.outcome is not None and self.proof.outcome.same


def run(wish: Wish, context: Context, progress: Callable[[str], None]) -> Result | None:
    """The model as it is to be; None where it cannot be, which is reported. Nothing is written."""
    path = _found(wish.model, context)
    unit = None if path is None else parse_file(path, context.sink, file=context.shown(path))
    if path is None or unit is None or not all_admitted(unit, context.sink, context.shown):
        return None
    check_installed(context)
    after = installed() if wish.after is None else known(wish.after, "--mujoco", context)
    before = None if wish.before is None else known(wish.before, "--from", context)
    others = _opened(wish.pythons, context)
    if context.sink.has_errors or after is None or others is None:
        return None
    before = before or written_for(unit, after, others, context=context)
    if before is None:
        return None
    others.setdefault(installed(), Other(this_python(), installed()))
    if wish.proves and not _installed(others, (before, after), context, progress=progress):
        return None
    with ExitStack() as opened:
        prover = Prover(opened.enter_context(scratch("migrate")), others, progress)
        try:
            values = measured(prover.original(before, path)) if before != after else {}
            migrated = migrate(unit, before, after, context=context, adopt=wish.adopt, values=values)
            if migrated is None:
                return None
            proof = prover.prove(migrated, path) if before != after else Proof()
        except OtherError as error:
            context.sink.error("migrate-python", str(error), help=error.help)
            return None
        missing = tuple(each for each in (before, after) if each not in others)
        result = Result(path, migrated, proof, missing=missing)
        _judge(result, context)
    return None if context.sink.has_errors else result


def _found(model: str, context: Context) -> Path | None:
    """The file that a path or a reference leads to."""
    path = context.folder / model
    if os.path.exists(path):
        return path
    try:
        return resolve(
            model, relative_to=context.folder, environment=context.environment, fetching=context.fetching
        ).path
    except SourceError as error:
        context.sink.add(error.diagnostic)
        return None


def _opened(pythons: Collection[Path], context: Context) -> dict[str, Other] | None:
    found: dict[str, Other] = {}
    for python in pythons:
        try:
            other = open_python(context.folder / python)
        except OtherError as error:
            context.sink.error("migrate-python", str(error), help=error.help)
            return None
        found[other.version] = other
    return found


def _installed(
    others: dict[str, Other], wanted: Collection[str], context: Context, progress: Callable[[str], None]
) -> bool:
    for each in wanted:
        if each in others:
            continue
        try:
            others[each] = make(each, context.environment, progress)
        except (OtherError, OSError) as error:
            context.sink.error("migrate-python", str(error), help=getattr(error, "help", None))
            return False
    return True


def _judge(result: Result, context: Context) -> None:
    migrated, proof = result.migrated, result.proof
    for compiled, whose in ((proof.before, "as it is"), (proof.after, "as it would be migrated")):
        if compiled is not None and compiled.error is not None:
            fault = parse(compiled.error)
            said = " ".join(fault.message.split())
            line = "" if fault.line is None else f" (line {fault.line})"
            named = f" (`{fault.name}`)" if fault.name else ""
            context.sink.error(
                "mujoco-rejects",
                f"MuJoCo {compiled.version} rejects `{context.shown(result.model)}` {whose}: {said}{named}{line}",
                help=f"it is not written for {migrated.before}: say another version with `--from`"
                if compiled is proof.before
                else None,
            )
    outcome = proof.outcome
    report(migrated, context, () if outcome is None else outcome.settled)
    if outcome is None:
        return
    known_arrays = {array for each in migrated.meanings for array in each.arrays}
    known_arrays |= {array for each in ORDERED if each.name in migrated.adopted for array in each.arrays}
    if any(each.array in known_arrays for each in outcome.differences):
        known_arrays |= _FOLLOW
    for each in outcome.differences:
        (result.explained if each.array in known_arrays else result.unexplained).append(each.words())
    if result.unexplained:
        several = result.unexplained
        notes = [Note(words) for words in several[:_SHOWN]]
        if len(several) > _SHOWN:
            notes.append(Note(f"and {len(several) - _SHOWN} more"))
        context.sink.warning(
            "migrate-differs",
            f"MuJoCo {migrated.after} does not compile the model that {migrated.before} did:"
            f" {len(several)} array{'s' * (len(several) != 1)} differ{'s' * (len(several) == 1)}",
            notes=notes,
        )
