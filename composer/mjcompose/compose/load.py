"""Steps: turn a source, or one body of it, into a unit. MJCF that attaches recipes gets their models in memory."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import field, replace
from itertools import chain
from pathlib import Path as PathlibPath
from typing import TYPE_CHECKING

from lxml.etree import _Element as Node

from mjcompose.base.access import held
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note, Path, Span
from mjcompose.base.files import Refused
from mjcompose.base.limits import advice, in_force
from mjcompose.base.naming import portable_step
from mjcompose.base.sink import Sink
from mjcompose.language.edit import Drop, Edit
from mjcompose.language.placing import Mirror
from mjcompose.link.collect import collect
from mjcompose.link.files import ASSETS, path_in_assets, set_path
from mjcompose.link.linking import FileUse, ModelMeasure
from mjcompose.link.measure import folder_of
from mjcompose.link.settings import FOLDERS
from mjcompose.link.source_check import check_source
from mjcompose.mujoco import engine
from mjcompose.mujoco.engine import Session
from mjcompose.mujoco.messages import parse, report, translate
from mjcompose.plan.plan import BASE, Plan, Tables, is_fixed_in_world, part_name
from mjcompose.plan.read import read_source
from mjcompose.sources.context import Context
from mjcompose.sources.reference import CompilerSettings, Source
from mjcompose.sources.ros import UrdfChoices
from mjcompose.text.node import Mapping as Located, locate
from mjcompose.tree import journal
from mjcompose.tree.files import file_attributes, join, written_path
from mjcompose.tree.merged_settings import KeyPolicy
from mjcompose.tree.parse import all_admitted, parse_file
from mjcompose.tree.unit import Unit, Watch, element_at, nobody
from mjcompose.tree.xml_text import write

if TYPE_CHECKING:
    from mjcompose.link.excerpt import Excerpt, ExcerptSource
    from mjcompose.link.subtree import Subtree
    from mjcompose.mujoco.convert import Converted
    from mjcompose.urdf.robot import Robot

FINISHED = "finished"


def keep_finished(unit: Unit, context: Context, session: engine.Session) -> bool:
    """Compile a finished model and keep it as `FINISHED`. Return False if MuJoCo refuses it, which is reported."""
    text = write(unit.root)
    with folder_of(unit) as folder:
        found = engine.compile(folder, text=text.decode(), keep=FINISHED, session=session)
    if not found.ok:
        fault = parse(found.error or "")
        element = None if fault.line is None else element_at(unit.root, text, fault.line)
        report(translate(" ".join(fault.message.split()), element), element, unit, context=context)
    return found.ok


Key = tuple[PathlibPath, tuple[tuple[str, PathlibPath], ...], UrdfChoices, CompilerSettings, bool]
"""`Source.read_as`, and whether the part is attached to the world."""

Library = dict[Key, Unit]
"""Units as their files have them, for all that are composed with it."""


class Loader(Struct, frozen=False):
    """Loads the units of source files.

    `expect` counts the uses of each, so the last use needs no copy. The `library` has known units and receives new
    ones. With `checks`, every file must be valid MJCF. `embed` puts models of recipes into units that attach them.
    A part that is `edited` may have attributes that MJCF does not have, which its edits remove. The files that have
    some are `unchecked`: check them after the edits.
    """

    context: Context
    session: Session | None = None
    watch: Watch = nobody
    library: Library | None = None
    checks: bool = False
    embed: Callable[[Unit], bool] | None = None
    parsed: dict[Key, Unit | None] = field(default_factory=dict)
    uses: Counter[Key] = field(default_factory=Counter)
    excerpted: dict[Key, ExcerptSource | None] = field(default_factory=dict)
    edited: set[Key] = field(default_factory=set)
    unchecked: set[Key] = field(default_factory=set)

    def expect(self, model: Source, is_fixed: bool, *, is_edited: bool = False) -> None:
        key = source_key(model, is_fixed)
        self.uses[key] += 1
        if is_edited:
            self.edited.add(key)

    def unit(self, model: Source, span: Span | None, is_fixed: bool) -> Unit | None:
        """Return the unit of a source, or None if it has faults. With `is_fixed`, it is fixed in the world."""
        key = source_key(model, is_fixed)
        unit = self._parsed(key, model, span, is_fixed=is_fixed)
        self.uses[key] -= 1
        # Linking uses a unit up.
        if unit is not None and (self.uses[key] > 0 or self.excerpted.get(key) is not None):
            unit = unit.copied()
        if unit is not None:
            self.watch([unit], model)
        return unit

    def excerpt(self, model: Source, body: str, span: Span | None, is_fixed: bool) -> Excerpt | None:
        """Return an excerpt with a body of a source that is needed again; None if the part needs the whole `unit`."""
        from mjcompose.link.excerpt import ExcerptSource  # few recipes need it

        key = source_key(model, is_fixed)
        # An observer sees the dropped elements.
        if self.watch is not nobody or (self.uses[key] < 2 and key not in self.excerpted):
            return None
        unit = self._parsed(key, model, span, is_fixed=is_fixed)
        if unit is None:
            return None
        if key not in self.excerpted:
            self.excerpted[key] = ExcerptSource.of(unit)
        source = self.excerpted[key]
        excerpt = None if source is None else source.excerpt(body)
        if excerpt is not None:
            self.uses[key] -= 1
        return excerpt

    def _parsed(self, key: Key, model: Source, span: Span | None, is_fixed: bool) -> Unit | None:
        if key not in self.parsed:
            refused = self.parsed.get((*key[:-1], not key[-1]), ...) is None  # a fault of a file is reported once
            self.parsed[key] = None if refused else self._known_or_read(key, model, span, is_fixed=is_fixed)
        return self.parsed[key]

    def tables(self) -> Tables:
        return {key[:-1]: unit.table for key, unit in self.parsed.items() if unit is not None and unit.table}

    def _known_or_read(self, key: Key, model: Source, span: Span | None, is_fixed: bool) -> Unit | None:
        if self.library is None or self.embed is not None:
            return self._read(key, model, span, is_fixed)
        if (known := self.library.get(key)) is not None:
            return known.copied()
        if (unit := self._read(key, model, span, is_fixed)) is not None and key not in self.unchecked:
            self.library[key] = unit.copied()
        return unit

    def _read(self, key: Key, model: Source, span: Span | None, is_fixed: bool) -> Unit | None:
        if model.format == "urdf":
            return _urdf_unit(model, self.context, self.session, span=span, is_fixed=is_fixed)
        sink = self.context.sink
        shown = self.context.shown
        unit = read_source(model, sink, file=shown(model.path), span=span)
        if unit is None or (self.embed is not None and not self.embed(unit)) or not all_admitted(unit, sink, shown):
            return None
        later: list[tuple[Node, str]] | None = [] if key in self.edited else None
        if self.checks and not check_source(unit, sink, is_part=True, later=later):
            return None
        if later:
            self.unchecked.add(key)
        return unit

    def is_sound(self, unit: Unit, model: Source, is_fixed: bool) -> bool:
        """Return whether an edited unit has no attributes that MJCF does not have. Those that remain are reported."""
        is_unchecked = source_key(model, is_fixed) in self.unchecked
        return not is_unchecked or check_source(unit, self.context.sink, is_part=True)


def _urdf_unit(
    source: Source, context: Context, session: Session | None, span: Span | None, is_fixed: bool
) -> Unit | None:
    """Return the unit of a URDF file or xacro template that `span` names, or None after a reported error."""
    from mjcompose.urdf.read import UrdfReader  # few recipes need it

    own = _RecipeContext(context, span)
    return UrdfReader(
        source,
        context.sink,
        session,
        shown=context.shown,
        asked=span,
        is_fixed_in_world=is_fixed,
        missing=own.report_missing,
        relative=own.relative,
    ).unit()


class _RecipeContext(Struct):
    """The place where the recipe refers to a URDF, for paths and for reports of missing files."""

    context: Context
    span: Span | None

    def relative(self, folder: PathlibPath) -> str:
        """Return the path of a folder as the recipe writes it."""
        recipe = self.context.folder / (self.span.file if self.span else "")
        return PathlibPath(os.path.relpath(folder, recipe.parent)).as_posix()

    def report_missing(self, robot: Robot, converted: Converted) -> None:
        from mjcompose.mujoco.convert import PACKAGE
        from mjcompose.urdf.robot import mesh_of

        uses = []
        for file in converted.meshes:
            if not file.startswith(PACKAGE) and file not in robot.made and not os.path.isfile(file):
                found = held(join(str(robot.path.parent), join(converted.folder, file)))
                element = mesh_of(robot.root, file)
                uses.append(FileUse(element, "filename", file, source=found, content=None, shared=False))
        sink = Sink()
        collect(robot.unit, uses, sink, shown=self.context.shown)
        from_recipe = () if self.span is None else (Note("the recipe names it here", self.span),)
        for each in sink.diagnostics:
            help = each.help or "put the file there, or correct `filename`"
            self.context.sink.add(replace(each, notes=(*each.notes, *from_recipe), help=help))


def source_key(model: Source, is_fixed: bool) -> Key:
    """Return a key that is equal for sources that read the same. For MJCF, `is_fixed` does not matter."""
    return *model.read_as, is_fixed or model.format != "urdf"


class PartSource(Struct):
    """The source of the base or a part of a plan at `at`, or one `body` of it, which the recipe names at `span`."""

    model: Source | Plan | None
    body: str | None
    at: Path
    keyframes: KeyPolicy
    span: Span
    is_fixed_in_world: bool
    drop: tuple[Drop, ...] = ()
    edit: tuple[Edit, ...] = ()
    attaches_recipes: bool = False
    mirror: Mirror | None = None

    @property
    def drops_elements(self) -> bool:
        """Whether it drops more than its keys. The keys stay in the unit for keyframes that the recipe writes."""
        return not all(each.leaves_keys for each in self.drop)

    def check_dropped_keys(self, unit: Unit, document: Located, sink: Sink) -> bool:
        """Report a `drop` of keys that the unit does not have. Return whether there is no fault."""
        needless = [each for each in self.drop if each.leaves_keys and not each.optional]
        # MuJoCo adds keys, too: by `nkey`, or from models that it attaches.
        sizes = (size for size in unit.root.iterchildren("size") if size.get("nkey"))
        keys = chain(unit.root.iterfind("keyframe/key"), sizes, unit.root.iter("attach"))
        if not needless or next(keys, None) is not None:
            return True
        message = f"`{unit.label}` has no keyframes to drop"
        help = f"remove `{needless[0]}` from `drop`"
        sink.error("selector", message, locate(document, (*self.at, "drop", needless[0].index)), help=help)
        return False

    def take(self, unit: Unit, excerpt: Excerpt | None, sink: Sink, measure: ModelMeasure | None) -> Subtree | None:
        """Reduce the unit to the body. Return None after a reported error if that is impossible."""
        from mjcompose.link.subtree import take_from_excerpt, take_subtree  # few recipes need it

        assert self.body is not None
        if excerpt is None:
            subtree = take_subtree(unit, self.body, sink, span=self.span, keyframes=self.keyframes, measure=measure)
        else:
            subtree = take_from_excerpt(excerpt, sink, span=self.span, keyframes=self.keyframes, measure=measure)
        if subtree is not None and subtree.cut:
            alone = f"the {subtree.cut[0].called}, which reaches" if len(subtree.cut) == 1 else ""
            cut = alone or f"{len(subtree.cut)} elements that reach"
            message = f"the subtree `{subtree.body}` of `{unit.label}` is used without {cut} out of it"
            notes = tuple(Note(f"the {each.called} needs {each.lacks}", each.span) for each in subtree.cut)
            sink.warning("subtree-cut", message, self.span, notes=notes)
        return subtree


def part_sources(plan: Plan, is_fixed: bool) -> Iterator[PartSource]:
    """Yield the sources of the base of a plan, which is fixed in the world if it `is_fixed`, and of its parts."""
    document = plan.document
    if plan.base is None:
        yield PartSource(None, None, (BASE,), keyframes="merge", span=locate(document, ()), is_fixed_in_world=is_fixed)
    for step in plan.members:
        part = step.attachment
        is_read = part_name(step, plan.separator) in plan.key_sources
        yield PartSource(
            step.model,
            part.subtree,
            step.at,
            keyframes="merge" if is_read else part.key_policy,
            span=locate(document, (*step.at, "subtree")),
            is_fixed_in_world=is_fixed and is_fixed_in_world(part),
            drop=part.drop,
            edit=part.edit,
            attaches_recipes=bool(step.inner),
            mirror=part.mirror,
        )


class InnerModels(Struct, frozen=False):
    """Puts models that a unit attaches into its contents: `compose` makes the models of recipes from `plans`."""

    plans: Mapping[str, Plan]
    compose: Callable[[Plan], Unit | None]
    sink: Sink
    shown: Callable[[PathlibPath], str]
    count: int = 0

    def embed(self, unit: Unit, above: tuple[str, ...] = ()) -> bool:
        """Put all models that a unit attaches into its contents. Return whether there were no errors."""
        before = self.sink.error_count
        contents = dict(unit.contents)
        for element in unit.root.iterfind("asset/model"):
            file = str(element.get("file") or "")
            if file and file not in unit.contents:
                sub = self._model(unit, element, join(str(unit.directory), file), above=above)
                if sub is not None:
                    self._put(unit, element, sub, contents=contents)
        unit.contents = contents
        return self.sink.error_count == before

    def _model(self, unit: Unit, element: Node, path: str, above: tuple[str, ...]) -> Unit | None:
        span = unit.origins.span(element, unit.file, "file")
        limits = in_force()
        shown = self.shown(PathlibPath(path))
        self.count += 1
        if (plan := self.plans.get(os.path.realpath(path))) is not None:
            return self.compose(plan)
        if path in above:
            message = f"the model `{shown}` contains itself"
            self.sink.error("source-cycle", message, span, help="remove this `<model>`, or name another file")
        elif len(above) >= limits.nesting:
            message = f"models attach models more than {limits.nesting} levels deep"
            self.sink.error("limit-exceeded", message, span, help=advice("nesting"))
        elif self.count > limits.submodels:
            message = f"there are more than {limits.submodels} models that models attach"
            if self.count == limits.submodels + 1:
                self.sink.error("limit-exceeded", message, span, help=advice("submodels"))
        else:
            sub = parse_file(
                PathlibPath(path), self.sink, file=self.shown(PathlibPath(path)), span=span, door=unit.door
            )
            return sub if sub is not None and self.embed(sub, (*above, path)) else None
        return None

    def _put(self, unit: Unit, element: Node, sub: Unit, contents: dict[str, bytes | PathlibPath]) -> None:
        """Put a model and its files into the contents of the unit that attaches it."""
        above = f"{ASSETS}/{portable_step(unit.label)}/models"
        own = portable_step(sub.label)
        label = own
        number = 1
        while f"{above}/{label}.xml" in contents:
            number += 1
            label = f"{own}-{number}"
        folder = f"{above}/{label}"
        taken: dict[str, bytes | PathlibPath] = {}
        for inner in sub.root.iterfind("asset/model"):  # they and their files are in memory already
            file = str(inner.get("file") or "")
            start = file.removesuffix(".xml") + "/"
            taken.update({path: data for path, data in sub.contents.items() if path == file or path.startswith(start)})
            journal.write(inner, "file", f"{label}/{file}")
        for each, attribute, name in list(file_attributes(sub.root)):
            written = written_path(sub.settings, each, name)
            source = sub.contents.get(written)
            try:
                source = PathlibPath(sub.door.admit(join(str(sub.directory), written))) if source is None else source
            except Refused as refused:
                refused.report(self.sink, sub.origins.span(each, sub.file, attribute), shown=self.shown)
                continue
            below = path = path_in_assets(sub.settings, written)
            number = 1
            while taken.setdefault(path, source) != source:
                number += 1
                path = f"{number}/{below}"
            set_path(each, attribute, f"{label}/{path}", name)
        for compiler in sub.root.iterchildren("compiler"):
            for name in (*FOLDERS, "strippath"):
                journal.drop(compiler, name)
        contents.update({f"{folder}/{path}": data for path, data in taken.items()})
        contents[f"{folder}.xml"] = write(sub.root)
        if not element.get("name"):  # MuJoCo reads it from the file
            journal.write(element, "name", sub.model)
        journal.write(element, "file", f"{folder}.xml")
        unit.origins.texts.update(sub.origins.texts)
