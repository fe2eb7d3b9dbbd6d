"""A composed model becomes a bundle with its manifest."""

from __future__ import annotations

import os
import posixpath
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Span
from mjcompose.base.files import Refused, real_path
from mjcompose.bundle import manifest as entries
from mjcompose.bundle.bundle import MODEL, TERRAIN, Bundle, BundleError, Licenses, license_files, picture_of
from mjcompose.link.collect import collect
from mjcompose.link.linking import FileUse
from mjcompose.plan.plan import PartRecord, Plan
from mjcompose.plan.read import packages_of
from mjcompose.sources.blobs import remembered_sha256
from mjcompose.sources.context import Context, as_text
from mjcompose.sources.license import UNKNOWN, license_of
from mjcompose.sources.reference import Origin as Fetched, Source
from mjcompose.text.expression import number_of
from mjcompose.text.node import spans
from mjcompose.tree.classes import through_frames
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.merged_settings import ReadRow
from mjcompose.tree.select import kind_of, naming_attribute
from mjcompose.tree.unit import Unit
from mjcompose.tree.xml_text import write

if TYPE_CHECKING:
    from pydantic import BaseModel

    from mjcompose.bundle.bundle import CheckOutcome
    from mjcompose.compose.compose import Composed
    from mjcompose.mujoco.engine import Compiled
    from mjcompose.mujoco.index import CompiledIndex

_Model = TypeVar("_Model", bound="BaseModel")
_OF_BODIES = {"joint": ("joint", "freejoint"), "camera": ("camera",)}
_SECTIONS = {"actuator": "actuator", "sensor": "sensor", "key": "keyframe"}


def written_in(
    model: Unit, index: CompiledIndex, place: Callable[[Span], str]
) -> dict[tuple[str, int], tuple[str, str]]:
    """Return the tag and the place by kind and number, without copies that MuJoCo made."""
    kinds = {
        "joint": index.joints,
        "actuator": index.actuators,
        "sensor": index.sensors,
        "camera": index.cameras,
        "key": index.keyframes,
    }
    found: dict[tuple[str, int], tuple[str, str]] = {}
    for kind, compiled in kinds.items():
        names = [each.name for each in compiled]  # type: ignore[attr-defined]  # each kind has names
        for number, node in _matching_elements(list(_elements(model.root, kind)), names):
            found[kind, number] = (str(node.tag), place(model.origins.span(node, model.file)))
    return found


def _matching_elements(elements: Sequence[Node], names: Sequence[str]) -> Iterator[tuple[int, Node]]:
    """Yield elements by number: in order if each became one element, by name if some became several."""
    if [str(each.get("name") or "") for each in elements] == list(names):
        yield from enumerate(elements)
        return
    by_name = {str(each.get("name")): each for each in elements if each.get("name")}
    yield from ((number, by_name[name]) for number, name in enumerate(names) if name in by_name)


def _elements(root: Node, kind: str) -> Iterator[Node]:
    if kind in _SECTIONS:
        for section in root.iterchildren(_SECTIONS[kind]):
            yield from section.iterchildren("*")
        return
    for world in root.iterchildren("worldbody"):
        yield from _of_body(world, _OF_BODIES[kind])


def _of_body(body: Node, tags: tuple[str, ...]) -> Iterator[Node]:
    """Yield the elements of a body, including those in frames, before the elements of child bodies: MuJoCo's order."""
    inner = list(through_frames(body))
    yield from (each for each in inner if each.tag in tags)
    for each in inner:
        if each.tag == "body":
            yield from _of_body(each, tags)


Renamed = Mapping[str, Mapping[str, Mapping[str, str]]]
"""By part and kind of name: own names mapped to names in the model."""


def renamed_in(model: Unit, members: Iterable[PartRecord]) -> Renamed:
    """Return the elements that edits renamed, traced back through later prefixes, without those removed later."""
    by_prefix = {member.prefix: member.part for member in reversed(list(members))}
    found: dict[str, dict[str, dict[str, str]]] = {}
    for node, steps in model.origins.renamed.items():
        naming = naming_attribute(kind_of(node)) if node.getroottree().getroot() is model.root else None
        final = None if naming is None else node.get(naming.name)
        if naming is None or naming.declares is None or not final:
            continue
        name = str(final)
        for old, new in reversed(steps):
            name = name.removesuffix(new) + old
        prefix = max((each for each in by_prefix if name.startswith(each)), key=len, default=None)
        if prefix is not None and name != final:
            names = found.setdefault(by_prefix[prefix], {}).setdefault(naming.declares, {})
            names[name[len(prefix) :]] = str(final)
    return {
        part: {kind: dict(sorted(names.items())) for kind, names in sorted(kinds.items())}
        for part, kinds in found.items()
    }


class Portable:
    """Names the files of one composition: the recipe, its `sources`, and the `fetched` origins of its recipes."""

    def __init__(
        self, recipe: Path, sources: Iterable[Source], fetched: Iterable[Fetched | None], model: Unit, context: Context
    ) -> None:
        self.folder = Path(real_path(recipe.parent))
        self.sources = tuple(sources)
        origins = (*fetched, *(each.origin for each in self.sources))
        found = {each.id: each for each in origins if each is not None}
        self.origins = [(Path(real_path(each.root)), each) for each in found.values()]
        self.context = context
        self.texts = model.origins.texts
        self.named: dict[Path, str] = {}
        self.models = dict.fromkeys(
            (each.path.parent, posixpath.dirname(each.reference.replace("\\", "/")))
            for each in self.sources
            if each.origin is None
        )

    def name(self, path: Path) -> str:
        """Return the name of a file, such as `models/arm.xml` or `menagerie:panda/panda.xml`."""
        if path not in self.named:
            real = Path(real_path(path))
            if (origin := self.origin_of(real)) is not None:
                name = origin[1].named(real.relative_to(origin[0]).as_posix())
            elif real.is_relative_to(self.folder):
                name = real.relative_to(self.folder).as_posix()
            else:  # through the nearest model with a path reference
                ways = [(Path(os.path.relpath(real, real_path(folder))).as_posix(), at) for folder, at in self.models]
                way, at = min(ways, key=lambda each: each[0].count("../"), default=(real.name, ""))
                name = posixpath.normpath(posixpath.join(at, way))
            self.named[path] = as_text(name)
        return self.named[path]

    def origin_of(self, real: Path) -> tuple[Path, Fetched] | None:
        """Return the origin of a file; the innermost if origins are nested."""
        around = [each for each in self.origins if real.is_relative_to(each[0])]
        return max(around, key=lambda each: len(str(each[0])), default=None)

    def place(self, span: Span) -> str:
        """Return a place in a source or a recipe as FILE:LINE."""
        return f"{self.name(self.context.folder / span.file)}:{span.line}"

    def text(self, message: str) -> str:
        """Return a message with portable names for its files."""
        for shown in sorted(self.texts, key=len, reverse=True):
            if shown in message:
                message = message.replace(shown, self.name(self.context.folder / shown))
        return message


_OF_THE_LOCK = ("lock-stale", "source-changed")
"""Warnings that do not affect the model: it is the same with an old lock and without one."""


def assemble(
    plan: Plan, model: Unit, uses: Iterable[FileUse], context: Context, *, terrain: bytes | None = None
) -> Bundle | None:
    """Return the bundle without its manifest, or None if a file is missing."""
    before = context.sink.error_count
    uses = tuple(uses)
    files = collect(model, uses, context.sink, shown=context.shown)
    try:
        files.update(_licenses(sources(plan)).files)
        if terrain is not None:
            files[TERRAIN] = terrain
        if context.sink.error_count > before:
            return None
        return Bundle({**files, MODEL: write(model.root)})
    except Refused as refused:
        refused.report(context.sink, None, shown=context.shown)
        return None
    except (OSError, BundleError) as error:
        file = getattr(error, "filename", None) or getattr(error, "path", None)
        called = "a file of the model" if file is None else f"`{context.shown(Path(file))}`"
        why = getattr(error, "strerror", None)
        context.sink.error("file-unreadable", f"{called} cannot be bundled: {why.lower() if why else error}")
        return None


def _parts_by_license(plan: Plan, inputs: Sequence[entries.Input]) -> dict[str, tuple[str, ...]]:
    by_license: dict[str, list[str]] = {}
    parts = [place.part for place in plan.places() if isinstance(place.model, Source)]
    for source, part in zip(inputs, parts, strict=True):
        by_license.setdefault(source.license or UNKNOWN, []).append(part)
    return {license: tuple(parts) for license, parts in sorted(by_license.items())}


def _index(compiled: Compiled | None, model: Unit, names: Portable) -> entries.ManifestIndex | None:
    if compiled is None or compiled.index is None:
        return None
    return entries.index_of(compiled.index, written_in(model, compiled.index, names.place))


def add_manifest(
    bundle: Bundle,
    plan: Plan,
    composed: Composed,
    compiled: Compiled | None,
    context: Context,
    *,
    checks: Iterable[CheckOutcome],
    cell: str | None,
    has_picture: bool,
    deduplicated: bool,
) -> Bundle:
    """Return the bundle with its manifest. Without MuJoCo, `compiled` is None, and the manifest has no index."""
    model = composed.model
    named = list(sources(plan))
    names = portable(plan, model, context)
    licenses = _licenses(named)
    inputs = tuple(
        _input(source, licenses.of[label], names, table=composed.tables.get(source.read_as, ()))
        for label, source in named
    )
    renamed = renamed_in(model, composed.members)
    manifest = entries.Manifest(
        name=plan.name,
        description=plan.description,
        mujoco=compiled.mujoco_version if compiled else None,
        grammar=GRAMMAR.versions[-1],
        extensions=packages_of(plan),
        recipe=entries.RecipeFile(path=as_text(plan.path.name), sha256=remembered_sha256(plan.path)),
        separator=plan.separator,
        cell=cell,
        variants=dict(plan.variants),
        params={name: number_of(value) for name, value in plan.scope.items() if name not in plan.variants},
        seed=plan.randomize.seed if plan.randomize else None,
        sample=plan.sample if plan.randomize else None,
        draws=tuple(_as(entries.Draw, each, component=each.start) for each in composed.drawn),
        inputs=inputs,
        parts=tuple(_part(member, number, renamed) for number, member in enumerate(composed.members)),
        adopted=tuple(
            _as(entries.AdoptedSetting, each, origin=names.place(each.span))
            for each in model.adopted
            if each.is_written
        ),
        read=tuple(entries.Read(path=path, sha256=digest) for path, digest in _read(bundle, plan, composed, names)),
        licenses=_parts_by_license(plan, inputs),
        files=entries.files_of(bundle),
        merged=composed.merged,
        deduplicated=deduplicated,
        picture=picture_of(plan.name) if has_picture else None,
        made=tuple(
            _as(entries.GeneratedShape, each, geom=each.of, origin=names.place(each.span), **each.error)
            for each in composed.shapes
        ),
        checks=tuple(_as(entries.PassedCheck, each, origin=names.place(each.span)) for each in checks),
        index=_index(compiled, model, names),
        warnings=tuple(
            f"{each.code}: {names.text(each.message)}"
            for each in context.sink.diagnostics
            if each.code not in _OF_THE_LOCK
        ),
    )
    return entries.with_manifest(bundle, manifest)


def portable(plan: Plan, model: Unit, context: Context) -> Portable:
    """Return the names of a plan's files for its manifest."""
    recipes = [source for each in plan.plans() for source in (each.source, *(source for source, _ in each.extended))]
    origins = (None if source is None else source.origin for source in recipes)
    return Portable(plan.path, plan.sources(), origins, model=model, context=context)


def _read(bundle: Bundle, plan: Plan, composed: Composed, portable: Portable) -> list[tuple[str, str]]:
    """Return every file that was read, with its hash; each is hashed once."""
    known = {
        real_path(where): bundle.digest(path)
        for path, where in composed.model.contents.items()
        if isinstance(where, Path) and path in bundle.files
    }
    recipes: set[str] = set()  # and the recipes that they extend, as messages name them
    for recipe in plan.plans():
        recipes.update(os.fspath(source.path) for source, _ in recipe.extended)
        recipes.update(span.file for span in spans(recipe.document))
    files = {
        *(path for shown in portable.texts if os.path.isfile(path := portable.context.folder / shown)),
        *(portable.context.folder / file for file in recipes),
        *(path for _, source in sources(plan) for path in (source.path, *source.licenses)),
        *(Path(use.source) for use in composed.files if use.content is None),
    }
    found: dict[str, str] = {}
    for path in files:
        if (name := portable.name(path)) not in found:
            found[name] = known.get(real_path(path)) or remembered_sha256(path)
    return sorted(found.items())


def sources(plan: Plan) -> Iterator[tuple[str, Source]]:
    """Yield every source file of a plan and its nested recipes, with the prefix of its part (or the base's name)."""
    for place in plan.places():
        if isinstance(place.model, Source):
            yield place.prefix.strip(plan.separator) or place.model.path.stem, place.model


def _licenses(named: Iterable[tuple[str, Source]]) -> Licenses:
    """Return the licenses by label; a base may have the same label as a part."""
    found: dict[str, list[Path]] = {}
    for label, source in named:
        found.setdefault(label, []).extend(source.licenses)
    return license_files(found)


def _as(of: type[_Model], record: object, **changed: Any) -> _Model:
    """Return an entry of the manifest: the attributes of a record with the names of its fields, after some changes."""
    return of(**{name: getattr(record, name) for name in of.model_fields if name not in changed}, **changed)


def _input(source: Source, licenses: tuple[str, ...], portable: Portable, table: tuple[ReadRow, ...]) -> entries.Input:
    if source.origin is None:
        origin = None
        path = portable.name(source.path)
    else:
        origin = _as(entries.InputOrigin, source.origin)
        path = Path(os.path.relpath(real_path(source.path), real_path(source.origin.root))).as_posix()
    urdf = (
        _as(entries.UrdfElements, row, became=row.became or None, why=row.why or None, origin=portable.place(row.span))
        for row in table
    )
    return _as(
        entries.Input,
        source,
        path=as_text(path),
        kind=source.kind.name,
        sha256=remembered_sha256(source.path),
        origin=origin,
        license=license_of(source),
        licenses=licenses,
        urdf=tuple(urdf),
        compiler=dict(source.compiler),
    )


def _part(member: PartRecord, number: int, renamed: Renamed) -> entries.ManifestPart:
    pose = member.pose
    return _as(
        entries.ManifestPart,
        member,
        input=number,
        pos=pose and pose.pos,
        quat=pose and pose.quat,
        stands=member.is_fixed_in_world,
        obscure=member.obscure or member.reduced,
        renamed={kind: dict(names) for kind, names in renamed.get(member.part, {}).items()},
    )
