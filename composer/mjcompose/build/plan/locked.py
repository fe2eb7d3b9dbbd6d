"""Create the lock of a plan, and compare a plan with an existing lock."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from pathlib import Path

from mjcompose.base import files
from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.sink import Sink
from mjcompose.base.version import __version__
from mjcompose.build.plan.extensions import packages_of
from mjcompose.build.plan.parts import is_one_choice
from mjcompose.build.plan.plan import PlacedModel, Plan
from mjcompose.build.plan.read import EXTENDS, files_of_recipe, files_of_source, read_recipe
from mjcompose.sources.blobs import differences
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.lock import Disputed, Lock, Locked, kind_of, lock_path, read_lock
from mjcompose.sources.path import KIND as PATH
from mjcompose.sources.reference import PINS, Origin, Source
from mjcompose.sources.store import Store

_SHOWN = 8


def use_lock(recipe: Path, context: Context, disputes: Disputed | None = None) -> Fetching | None:
    """Return how to fetch for a recipe, according to its lock if it has one; None if the lock is faulty.

    Read once a run. `disputes` is for a lock with merge conflicts, see `read_lock`.
    """
    fetching = context.fetching = context.fetching or Fetching()
    if fetching.lock_file is not None:
        return fetching
    before = context.sink.error_count
    path = lock_path(context.folder / recipe)
    fetching.recipe = context.shown(context.folder / recipe)
    fetching.lock = read_lock(path, context.shown(path), context.sink, disputes=disputes)
    if context.sink.error_count > before:
        return None
    if fetching.lock is None and fetching.locked:
        help = f"run `mjcompose lock {fetching.recipe}` and commit the lock"
        context.sink.error("lock-stale", f"the lock `{context.shown(path)}` does not exist", help=help)
        return None
    fetching.lock_file = path
    if fetching.lock is not None:  # what it pins is a source, also for variants that are not chosen
        local = (each.files for each in fetching.lock.sources.values() if kind_of(each).is_local)
        files.current().note(os.path.join(path.parent, name) for files in local for name in files)
    if fetching.lock is not None and fetching.locked:
        _report_versions(fetching.lock, context.shown(path), fetching.recipe, context=context)
    return fetching


def _report_versions(lock: Lock, shown: str, recipe: str, context: Context) -> None:
    """Warn that other versions made the lock, which may change the result."""
    here = {"mjcompose": __version__, "MuJoCo": _mujoco()}
    made_with = {"mjcompose": lock.mjcompose, "MuJoCo": lock.mujoco}
    others = [name for name, version in made_with.items() if version and version != here[name]]
    if others:
        was = " and ".join(f"{name} {made_with[name]}" for name in others)
        now = " and ".join(f"{name} {here[name] or 'none'}" for name in others)
        message = f"`{shown}` was made with {was}, this is {now}: what is built may be other bytes"
        help = f"install what it was made with, or run `mjcompose lock {recipe}`"
        context.sink.warning("lock-stale", message, help=help)


@dataclass(slots=True)
class _SourceUse:
    """Facts about a source while its files are gathered."""

    root: Path
    origin: Origin | None
    source: Source | None
    span: Span | None
    files: dict[str, Path] = field(default_factory=dict)
    licenses: set[str] = field(default_factory=set)
    used_by: dict[str, None] = field(default_factory=dict)


def lock_of(
    plans: Iterable[Plan], fetching: Fetching, folder: Path, context: Context, shapes: Mapping[str, str] | None = None
) -> Lock:
    """Return the lock for plans of one recipe, its variants; `folder` is where the lock will be. Reads every file.

    `shapes` are the hashes of what was made of meshes, by key. What is damaged in the store is reported.
    """
    plans = tuple(plans)
    uses = _FileGatherer(fetching, folder, context).of(plans)
    for id, use in uses.items():
        _is_whole(id, use, context)
    return Lock(
        mjcompose=__version__,
        mujoco=_mujoco(),
        sources={id: locked for id, use in uses.items() if (locked := _locked(use, fetching)) is not None},
        extensions={name: version for plan in plans for name, version in packages_of(plan).items()},
        shapes=dict(shapes or {}),
    )


def check_lock(plan: Plan, context: Context) -> None:
    """Report differences from the lock, if there is one: changed bytes, and sources that are not in it.

    Damaged files in the store are reported with or without a lock.
    """
    fetching = context.fetching
    if fetching is None or not (fetching.lock or any(each.is_fetched for each in fetching.origins.values())):
        return
    lock_file = fetching.lock_file or lock_path(plan.path)
    uses = _FileGatherer(fetching, lock_file.parent, context).of([plan])
    whole = {id: use for id, use in uses.items() if _is_whole(id, use, context)}
    if fetching.lock is None:
        return
    shown = context.shown(lock_file)
    if fetching.locked and is_one_choice(read_recipe(plan.path, replace(context, sink=Sink()))):
        _report_unused(fetching.lock.sources.keys() - uses.keys(), shown, plan, context=context)
    for id, use in whole.items():
        now, before = _locked(use, fetching), fetching.lock.sources.get(id)
        if now is None:
            continue
        name = next(iter(use.used_by))
        if before is None:
            report = context.sink.error if fetching.locked else context.sink.warning
            report("lock-stale", f"`{id}` is not in the lock `{shown}`", use.span,
                 help=f"run `mjcompose lock {plan.file}` and commit the lock")  # fmt: skip
        elif changes := differences(
            {
                file: digest
                for file, digest in before.files.items()
                if file in now.files or not os.path.isfile(use.root / file)
            },
            now.files,
        ):
            report = context.sink.warning if kind_of(now).is_local and not fetching.locked else context.sink.error
            notes = [Note(change) for change in changes[:_SHOWN]] + _more(changes)
            help = f"if that is meant, run `mjcompose lock {plan.file} --upgrade-source {name}`"
            report("source-changed", f"`{id}` is not what `{shown}` pins", use.span, notes=notes, help=help)
        elif wrong := [*_wrong(before, now)]:
            message = f"what `{shown}` says of `{id}` cannot be: it was not made so"
            help = "take the lock from version control, or remove it and run `mjcompose lock`"
            context.sink.error("lock-invalid", message, use.span, notes=[Note(each) for each in wrong], help=help)
        elif fetching.locked and (others := [*_of_another_version(before, now)]):
            context.sink.warning(
                "lock-stale",
                f"`{id}` has the bytes that `{shown}` pins, and is of another version, which the manifest names",
                use.span,
                notes=[Note(each) for each in others],
                help=f"install that version, or run `mjcompose lock {plan.file} --upgrade-source {name}` and commit the"
                " lock",
            )


def _of_another_version(before: Locked, now: Locked) -> Iterator[str]:
    """Yield other facts about a source that a manifest records and that differ from the lock."""
    for what in ("version", "commit"):
        was, there = getattr(before, what), getattr(now, what)
        if was and there and was != there:
            yield f"{what} {was} was locked, {there} is there"


def _report_unused(unused: Iterable[str], shown: str, plan: Plan, context: Context) -> None:
    for id in sorted(unused):
        context.sink.error("lock-stale", f"`{id}` is in the lock `{shown}`, and nothing uses it",
                           help=f"run `mjcompose lock {plan.file}` and commit the lock")  # fmt: skip


def plan_with_intact_store(make: Callable[[], Plan | None], context: Context) -> Plan | None:
    """Return the plan that `make` makes; if files in the store are damaged, they are fetched again for another one.

    Offline nothing is fetched, and `check_lock` reports them.
    """
    forget = context.sink.marked()
    plan = make()
    if not _forgot_damaged(plan, context):
        return plan
    forget()
    return make()


def _forgot_damaged(plan: Plan | None, context: Context) -> bool:
    """Remove damaged sources from the store, and from the memory of the run; return whether there were any."""
    fetching = context.fetching
    if fetching is None or fetching.offline or not any(each.stored for each in fetching.origins.values()):
        return False
    used = [*context.recipes, *(source.path for source in fetching.first.values())]
    if plan is not None:
        folder = (fetching.lock_file or lock_path(plan.path)).parent
        uses = _FileGatherer(fetching, folder, replace(context, sink=Sink())).of([plan])
        used += (path for use in uses.values() if use.origin is not None for path in use.files.values())
    damaged: dict[str, Origin] = {}
    for path in dict.fromkeys(used):
        origin = fetching.around(path)
        if origin is not None and origin.id not in damaged and _is_damaged(path, origin, fetching):
            damaged[origin.id] = origin
    if plan is None or context.sink.has_errors:  # perhaps because a file is gone
        gone = (
            each
            for each in fetching.origins.values()
            if not all(os.path.isfile(each.root / name) for name in each.stored)
        )
        damaged.update({each.id: each for each in gone})
    for origin in damaged.values():
        fetching.progress(f"`{origin.id}` is damaged in the store, and fetched again")
        Store.of(context.environment).remove_content(origin.root)
    if damaged:
        fetching.forget()
        context.recipes.clear()
        context.concrete.clear()
    return bool(damaged)


def _is_damaged(path: Path, origin: Origin, fetching: Fetching) -> bool:
    stored = origin.stored.get(_relative(path, origin.root))
    try:
        return stored is not None and fetching.digest(path) != stored
    except OSError:
        return True


def _is_whole(id: str, use: _SourceUse, context: Context) -> bool:
    """Return whether the used files in the store are as they were fetched, and report those that are not."""
    if use.origin is None or context.fetching is None:
        return True
    there = {}
    for name, path in use.files.items():
        if name in use.origin.stored:
            with contextlib.suppress(OSError):  # reported where the file is needed
                there[name] = context.fetching.digest(path)
    stored = {name: digest for name, digest in use.origin.stored.items() if name in there}
    changes = differences(stored, there)
    if changes:
        message = f"`{id}` is not what was fetched: files in the store were changed"
        notes = [Note(each.replace("was locked", "was stored")) for each in changes[:_SHOWN]] + _more(changes)
        help = "run `mjcompose cache verify --fix`; it is fetched again when it is needed"
        context.sink.error("source-changed", message, use.span, notes=notes, help=help)
    return not changes


def _wrong(before: Locked, now: Locked) -> Iterator[str]:
    """Yield contradictions between a lock's entry and its kind or its correct pin; they show a manual edit."""
    if before.kind == now.kind:
        own = kind_of(now).pins
        foreign = (pin for pin in PINS if pin not in own and getattr(before, pin) is not None)
        yield from (f"a source of kind `{now.kind}` has no {pin}" for pin in foreign)
    for what in ("kind", "tree"):
        was, there = getattr(before, what), getattr(now, what)
        if was != there and before.pin == now.pin:
            yield f"its {what} is `{there}`, and not `{was or 'nothing'}`"


def _more(changes: Sequence[str]) -> list[Note]:
    return [Note(f"and {len(changes) - _SHOWN} more")] if len(changes) > _SHOWN else []


class _FileGatherer:
    """Gathers all files of plans by source."""

    def __init__(self, fetching: Fetching, folder: Path, context: Context) -> None:
        self.fetching = fetching
        self.folder = folder
        self.context = context
        self.uses: dict[str, _SourceUse] = {}

    def of(self, plans: Iterable[Plan]) -> dict[str, _SourceUse]:
        for place in (place for plan in plans for place in plan.walk()):
            if isinstance(place.model, Plan):
                self._recipe(place.model, place)
            elif place.model is not None:
                self._put(place.model.path, self._files_of(place.model), place.model, label=place.part, span=place.span)
        return self.uses

    def _recipe(self, plan: Plan, placed: PlacedModel) -> None:
        """Add the files of a recipe itself.

        The built recipe, recipes next to it that it extends, and models written in place are not locked, because
        any change that matters changes a source. Nested recipes and fetched ones are locked.
        """
        if placed.part and not plan.at:
            self._put(plan.path, [plan.path], plan.source, label=placed.part, span=placed.span)
        label = f"{placed.part}{plan.separator}{EXTENDS}" if placed.part else EXTENDS
        for source, span in plan.extended:
            if placed.part or source.origin is not None:
                self._put(source.path, [source.path, *source.licenses], source, label=label, span=placed.span or span)
        for file in files_of_recipe(plan, self.context):
            main = plan.path if self.fetching.around(file) is None else file
            self._put(main, [file], None, label=placed.part or plan.path.name, span=placed.span)

    def _put(self, main: Path, files: list[Path], source: Source | None, label: str, span: Span | None) -> None:
        origin = (source and source.origin) or self.fetching.around(main)
        root = self.folder if origin is None else origin.root
        id = _local_id(_relative(main, root)) if origin is None else origin.id
        if files:
            use = self.uses.setdefault(id, _SourceUse(root, origin, source, span=span))
            use.used_by.setdefault(label)
            licenses = {os.path.realpath(each) for each in source.licenses} if source is not None else set()
            for file in files:
                name = _relative(file, root)
                use.files[name] = file
                if os.path.realpath(file) in licenses:
                    use.licenses.add(name)

    def _files_of(self, source: Source) -> list[Path]:
        read = self.fetching.files
        if source not in read:
            read[source] = list(files_of_source(source))
        return read[source]


def _local_id(path: str) -> str:
    return path if path.startswith("../") or os.path.isabs(path) else f"./{path}"


def _locked(use: _SourceUse, fetching: Fetching) -> Locked | None:
    """Return the entry of a source, or None if no file of it is readable."""
    files = {}
    for name, path in use.files.items():
        try:
            files[name] = fetching.digest(path)
        except OSError:
            continue  # reported by those who need it
    if not files:
        return None
    source, origin = use.source, use.origin
    return Locked(
        kind=(PATH if origin is None else origin.kind).name,
        commit=origin.commit if origin else None,
        tree=origin.tree if origin else None,
        sha256=origin.sha256 if origin else None,
        package=source.package if source else None,
        version=source.version if source and source.package else None,
        files=files,
        licenses=sorted(use.licenses),
        used_by=sorted(use.used_by),
    )


def _relative(path: Path, folder: Path) -> str:
    """Return a relative path, with `..` if necessary: a license may be outside of its package."""
    return Path(os.path.relpath(os.path.realpath(path), os.path.realpath(folder))).as_posix()


def _mujoco() -> str | None:
    from importlib import metadata  # a build without a lock has no use for it

    try:
        return metadata.version("mujoco")
    except metadata.PackageNotFoundError:
        return None


def lock_changes(before: Lock | None, after: Lock) -> Iterator[str]:
    """Yield the changes from an older lock to a new one, in words. No I/O."""
    old = before.sources if before is not None else {}
    for id in sorted({*old, *after.sources}):
        if id not in after.sources:
            yield f"{id}: no longer used"
        elif id not in old:
            pin = after.sources[id].pin
            yield f"{id}: locked" + (f" at {pin[:12]}" if pin else "")
        else:
            was, now = old[id], after.sources[id]
            if was.pin and now.pin and was.pin != now.pin:
                yield f"{id}: {was.pin[:12]} is now {now.pin[:12]}"
            elif was.version and now.version and was.version != now.version:
                yield f"{id}: version {was.version} is now {now.version}"
            yield from (f"{id}: {line}" for line in differences(was.files, now.files))
    earlier = before.shapes if before is not None else {}
    for word, keys in (
        ("locked", after.shapes.keys() - earlier.keys()),
        ("no longer used", earlier.keys() - after.shapes.keys()),
        ("changed", {key for key in earlier if after.shapes.get(key, earlier[key]) != earlier[key]}),
    ):
        if keys:
            yield f"{len(keys)} result{'s' * (len(keys) != 1)} of work on meshes: {word}"
