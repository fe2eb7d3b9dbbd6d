"""The files, packages and places that the result of a build depends on."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Collection, Iterable, Iterator
from dataclasses import field
from functools import cache
from importlib import metadata
from pathlib import Path

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Span
from mjcompose.base.extensions import LOADED
from mjcompose.compose.mesh_jobs import shapes_beside
from mjcompose.pipeline.cache.cache import Record
from mjcompose.pipeline.stages import Built
from mjcompose.plan.plan import Plan
from mjcompose.plan.read import files_of_recipe, files_of_source, packages_of
from mjcompose.sources.context import Context
from mjcompose.sources.license import LEVELS, license_folders
from mjcompose.sources.lock import shapes_folder
from mjcompose.sources.reference import Source
from mjcompose.text.node import spans


def hash_of_positions(plan: Plan) -> str:
    whole = hashlib.sha256()
    for each in plan.plans():
        for span in spans(each.document):
            place = f"{span.file}:{span.line}:{span.column}:{span.end_line}:{span.end_column}\n"
            whole.update(place.encode("utf-8", "surrogateescape"))
    return whole.hexdigest()


def mentions_positions(plan: Plan, record: Record, manifest: bytes) -> bool:
    """Return whether diagnostics or a manifest contain lines of the plan's recipes. No I/O."""
    files = {span.file for each in plan.plans() for span in spans(each.document)}
    files |= {each.file for each in plan.plans()}
    reported = [span for each in record.diagnostics for span in _spans_of(each)]
    reported += [span for check in record.checks for each in check.diagnostics for span in _spans_of(each)]
    if any(span.file in files for span in reported):
        return True
    names = "|".join(re.escape(name.replace("\\", "/").rpartition("/")[2]) for name in files)
    return re.search(rf"(?:{names}):\d".encode("utf-8", "surrogateescape"), manifest) is not None


def _spans_of(diagnostic: Diagnostic) -> Collection[Span]:
    return [span for span in [diagnostic.span, *(note.span for note in diagnostic.notes)] if span is not None]


PACKAGES = ("mujoco", "lxml", "numpy", "pydantic", "pyyaml")
"""Packages that may affect the bytes of a model, or the verdict on it."""
OF_URDF = ("xacro", "trimesh", "pycollada", "pillow")
"""Packages that they also depend on if there is URDF."""


class Inputs(Struct, frozen=False):
    """Lists the inputs of builds; the inputs of a source are looked up once."""

    _of_sources: dict[Path, tuple[str, ...]] = field(default_factory=dict)

    def recipes(self, plan: Plan) -> tuple[str, ...]:
        """Return the recipe files of a plan: its own, extended and nested ones."""
        chains = ((each.path, *(source.path for source, _ in each.extended)) for each in plan.plans())
        return tuple(dict.fromkeys(map(os.path.abspath, [path for chain in chains for path in chain])))

    def others(self, built: Built, context: Context) -> tuple[str, ...]:
        """Return all other files: models, includes, assets, licenses and folders searched for them, lock, shapes."""
        found = self._planned(built.plan, built.plan.sources(), context)
        used = [*(context.folder / name for name in built.composed.model.origins.texts)]
        used += [Path(use.source) for use in built.composed.files if use.content is None]
        if context.fetching is not None and context.fetching.lock_file is not None:
            used += [shapes_folder(context.fetching.lock_file) / f"{each.key}.json" for each in built.composed.shapes]
        found.update(dict.fromkeys(map(os.path.abspath, used)))
        recipes = self.recipes(built.plan)
        return tuple(path for path in found if path not in recipes)

    def planned(self, plan: Plan, context: Context) -> tuple[str, ...]:
        """Return the inputs that are known before composition, without the inputs of installed packages."""
        own = (each for each in plan.sources() if each.package is None or each.version is None)
        found = dict.fromkeys((*self.recipes(plan), *self._planned(plan, own, context)))
        if plan.works_on_meshes and context.fetching is not None and context.fetching.lock_file is not None:
            kept = shapes_beside(shapes_folder(context.fetching.lock_file)).values()
            found.update(dict.fromkeys(map(os.path.abspath, kept)))
        return tuple(found)

    def _planned(self, plan: Plan, sources: Iterable[Source], context: Context) -> dict[str, None]:
        found = [os.path.abspath(file) for each in plan.plans() for file in files_of_recipe(each, context)]
        found += [file for source in sources for file in self._of(source)]
        found += [file for each in LOADED.values() for file in each.files]
        if context.fetching is not None and context.fetching.lock_file is not None:
            found.append(os.path.abspath(context.fetching.lock_file))
        return dict.fromkeys(found)

    def packages(self, plan: Plan) -> Iterator[tuple[str, str, str]]:
        """Yield the packages that affect the result, and the packages that contain sources."""
        known = list(plan.sources())
        named = [each.package for each in known if each.package]
        named += [library.name for each in known for library in each.kind.libraries]
        named += packages_of(plan)
        named += OF_URDF if any(each.format == "urdf" for each in known) else ()
        for name in dict.fromkeys([*PACKAGES, *named]):
            yield from _installed(name)

    def _of(self, source: Source) -> tuple[str, ...]:
        if source.path not in self._of_sources:
            folder = Path(os.path.abspath(source.path)).parent
            searched = [os.fspath(each) for each in (folder, *folder.parents[:LEVELS])]
            read = [os.path.abspath(path) for path in files_of_source(source)]
            inside = [each for above in searched for each in license_folders(above)]
            self._of_sources[source.path] = (*read, *searched, *inside)
        return self._of_sources[source.path]


def may_move(context: Context) -> bool:
    """Return whether every build queries the network, for example for an unpinned branch."""
    fetching = context.fetching
    if fetching is None:
        return False
    if any(group == "sources" for group, _ in LOADED):
        return True  # the variables of such a kind are in no key
    fetched = [each for each in fetching.origins.values() if each.is_fetched]
    return any(fetching.pin(each.id) is None and (each.pin or "?") not in each.id for each in fetched)


@cache
def _installed(package: str) -> tuple[tuple[str, str, str], ...]:
    """Return name, version, and a file whose path contains the version; nothing if the package is not installed."""
    try:
        found = metadata.distribution(package)
    except metadata.PackageNotFoundError:
        return ()
    folder = getattr(found, "_path", None)
    return () if folder is None else ((package, found.version, str(Path(folder) / "METADATA")),)
