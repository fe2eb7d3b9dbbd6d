"""Create the lock of a plan, and compare a plan with an existing lock."""

from __future__ import annotations

import contextlib
import os
import shlex
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from pathlib import Path

from mjcompose.base import __version__, files
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.report import with_rest
from mjcompose.base.sink import Sink
from mjcompose.plan.parts import is_one_choice
from mjcompose.plan.plan import PlacedModel, Plan
from mjcompose.plan.read import EXTENDS, files_of_recipe, files_of_source, packages_of, read_recipe
from mjcompose.sources.blobs import differences
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.kinds import PATH
from mjcompose.sources.lock import Disputed, Lock, Locked, kind_of, lock_path, read_lock
from mjcompose.sources.reference import PINS, Origin, Source
from mjcompose.sources.store import Store


def use_lock(recipe: Path, context: Context, disputes: Disputed | None = None) -> Fetching | None:
    """Return the rules for fetching from a recipe's lock, if any; None if it is faulty. `disputes`: `read_lock`."""
    fetching = context.fetching = context.fetching or Fetching()
    if fetching.lock_file is not None:
        return fetching
    before = context.sink.error_count
    path = lock_path(context.folder / recipe)
    if path.is_symlink() and not os.path.exists(path):
        message = f"the lock `{context.shown(path)}` is a link to `{os.readlink(path)}`, which does not exist"
        help = "remove the link, or fetch the file that it leads to"
        context.sink.error("lock-invalid", message, help=help)
        return None
    fetching.recipe = context.shown(context.folder / recipe)
    fetching.lock = read_lock(path, context.shown(path), context.sink, disputes=disputes)
    if context.sink.error_count > before:
        return None
    if fetching.lock is None and fetching.locked:
        _report_missing(context.shown(path), fetching.recipe, context.sink)
        return None
    # Its names are relative to its own folder: build systems such as Bazel show it through a link.
    fetching.lock_file = Path(os.path.realpath(path)) if path.is_symlink() else path
    if fetching.lock is not None:
        _note_pinned_files(fetching.lock, fetching.lock_file.parent)
        if fetching.locked:
            _report_versions(fetching.lock, context.shown(path), fetching.recipe, context=context)
    return fetching


def _report_missing(shown: str, recipe: str, sink: Sink) -> None:
    help = f"run `mjcompose lock {recipe}` and commit the lock"
    if recipe == files.STDIN:
        help = "write the recipe to a file: standard input has no lock"
    sink.error("lock-stale", f"the lock `{shown}` does not exist", help=help)


def _note_pinned_files(lock: Lock, folder: Path) -> None:
    """Note the local files that a lock pins: they are sources, even for variants that are not chosen."""
    local = [locked for locked in lock.sources.values() if kind_of(locked).is_local]
    files.current().note(os.path.join(folder, name) for locked in local for name in locked.files)


def _report_versions(lock: Lock, shown: str, recipe: str, context: Context) -> None:
    """Warn that other versions made the lock, which may change the result."""
    here = {"mjcompose": __version__, "MuJoCo": _mujoco()}
    locked = {"mjcompose": lock.mjcompose, "MuJoCo": lock.mujoco}
    others = [name for name, version in locked.items() if version and version != here[name]]
    if others:
        was = " and ".join(f"{name} {locked[name]}" for name in others)
        now = " and ".join(f"{name} {here[name] or 'none'}" for name in others)
        message = f"`{shown}` was made with {was}, this is {now}: the bytes of the model may differ"
        help = f"install the locked version, or run `mjcompose lock {recipe}`"
        context.sink.warning("lock-stale", message, help=help)


class _SourceUse(Struct, frozen=False):
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
    """Return the lock in `folder` for plans of one recipe, its variants. Damaged files in the store are reported."""
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
    """Report changed bytes and sources that are not in the lock, if there is one; in the store also without one."""
    fetching = context.fetching
    if fetching is None or not (fetching.lock or any(each.is_fetched for each in fetching.origins.values())):
        return
    lock_file = fetching.lock_file or lock_path(plan.path)
    uses = _FileGatherer(fetching, lock_file.parent, context).of([plan])
    whole = {id: use for id, use in uses.items() if _is_whole(id, use, context)}
    if fetching.lock is None:
        return
    report = _LockReport(plan.file, context.shown(lock_file), fetching.locked, context.sink)
    if fetching.locked and is_one_choice(read_recipe(plan.path, replace(context, sink=Sink()))):
        for id in sorted(fetching.lock.sources.keys() - uses.keys()):
            report.unused(id)
    for id, use in whole.items():
        now = _locked(use, fetching)
        before = fetching.lock.sources.get(id)
        if now is None:
            continue
        if before is None:
            report.missing(id, use)
        else:
            report.differing(id, use, before, now)


class _LockReport(Struct):
    """Reports how the sources of a recipe differ from its lock. With `locked`, more of the differences are errors."""

    recipe: str
    lock: str
    locked: bool
    sink: Sink

    def unused(self, id: str) -> None:
        help = f"run `mjcompose lock {self.recipe}` and commit the lock"
        self.sink.error("lock-stale", f"`{id}` is in the lock `{self.lock}`, and nothing uses it", help=help)

    def missing(self, id: str, use: _SourceUse) -> None:
        report = self.sink.error if self.locked else self.sink.warning
        help = f"run `mjcompose lock {self.recipe}` and commit the lock"
        report("lock-stale", f"`{id}` is not in the lock `{self.lock}`", use.span, help=help)

    def differing(self, id: str, use: _SourceUse, before: Locked, now: Locked) -> None:
        """Report other bytes, or else a lock that contradicts itself, or else another version."""
        upgrade = f"run `mjcompose lock {self.recipe} --upgrade-source {shlex.quote(next(iter(use.used_by)))}`"
        changes = _changed_files(use, before, now)
        if changes:
            report = self.sink.warning if kind_of(now).is_local and not self.locked else self.sink.error
            message = f"`{id}` differs from the lock `{self.lock}`"
            help = f"if you want the change, {upgrade}"
            report("source-changed", message, use.span, notes=_notes(changes), help=help)
        elif wrong := [*_wrong(before, now)]:
            message = f"the lock `{self.lock}` contradicts itself about `{id}`"
            help = "take the lock from version control, or remove it and run `mjcompose lock`"
            self.sink.error("lock-invalid", message, use.span, notes=list(map(Note, wrong)), help=help)
        elif self.locked and (others := [*_of_another_version(before, now)]):
            message = f"`{id}` has the bytes in the lock `{self.lock}`, but another version, which the manifest names"
            help = f"install that version, or {upgrade} and commit the lock"
            self.sink.warning("lock-stale", message, use.span, notes=list(map(Note, others)), help=help)


def _changed_files(use: _SourceUse, before: Locked, now: Locked) -> tuple[str, ...]:
    """Return the differences of files in words, without files that exist and that this recipe no longer uses."""
    unused = {file for file in before.files if file not in now.files and os.path.isfile(use.root / file)}
    relevant = {file: digest for file, digest in before.files.items() if file not in unused}
    return differences(relevant, now.files)


def _of_another_version(before: Locked, now: Locked) -> Iterator[str]:
    """Yield other facts about a source that a manifest records and that differ from the lock."""
    for what in ("version", "commit"):
        was = getattr(before, what)
        there = getattr(now, what)
        if was and there and was != there:
            yield f"{what} {was} was locked, and now it is {there}"


def plan_with_intact_store(make: Callable[[], Plan | None], context: Context) -> Plan | None:
    """Return the plan that `make` returns. Fetch damaged files again, unless offline, and plan again."""
    forget = context.sink.marked()
    plan = make()
    if not _forgot_damaged(plan, context):
        return plan
    forget()
    return make()


def _forgot_damaged(plan: Plan | None, context: Context) -> bool:
    """Remove damaged sources from the store, and from the memory of the run; return whether there were any."""
    fetching = context.fetching
    if fetching is None or fetching.offline or not any(origin.stored for origin in fetching.origins.values()):
        return False
    damaged = _damaged(plan, context, fetching)
    for origin in damaged.values():
        fetching.progress(f"`{origin.id}` is damaged in the store; fetching it again")
        Store.of(context.environment).remove_content(origin.root)
    if damaged:
        fetching.forget()
        context.recipes.clear()
        context.concrete.clear()
    return bool(damaged)


def _damaged(plan: Plan | None, context: Context, fetching: Fetching) -> dict[str, Origin]:
    """Return the fetched sources, by their id, that lack a file, or have a file other than the fetched one."""
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
        for origin in fetching.origins.values():
            if not all(os.path.isfile(origin.root / name) for name in origin.stored):
                damaged[origin.id] = origin
    return damaged


def _is_damaged(path: Path, origin: Origin, fetching: Fetching) -> bool:
    stored = origin.stored.get(_relative(path, origin.root))
    try:
        return stored is not None and fetching.digest(path) != stored
    except OSError:
        return True


def _is_whole(id: str, use: _SourceUse, context: Context) -> bool:
    """Return whether the used files in the store are unchanged since they were fetched, and report changed ones."""
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
        message = f"`{id}` has changed in the store since it was fetched"
        notes = _notes([change.replace("was locked", "was stored") for change in changes])
        help = "run `mjcompose cache verify --fix`; the next build fetches it again"
        context.sink.error("source-changed", message, use.span, notes=notes, help=help)
    return not changes


def _wrong(before: Locked, now: Locked) -> Iterator[str]:
    """Yield contradictions between a lock's entry and its kind or its correct pin; they show a manual edit."""
    if before.kind == now.kind:
        own = kind_of(now).pins
        foreign = (pin for pin in PINS if pin not in own and getattr(before, pin) is not None)
        yield from (f"a source of kind `{now.kind}` has no {pin}" for pin in foreign)
    for what in ("kind", "tree"):
        was = getattr(before, what)
        there = getattr(now, what)
        if was != there and before.pin == now.pin:
            yield f"its {what} is `{there}`, and not `{was or 'nothing'}`"


def _notes(changes: Sequence[str]) -> list[Note]:
    return list(map(Note, with_rest(changes)))


class _FileGatherer(Struct, frozen=False):
    fetching: Fetching
    folder: Path
    context: Context
    uses: dict[str, _SourceUse] = field(default_factory=dict)

    def of(self, plans: Iterable[Plan]) -> dict[str, _SourceUse]:
        for place in (place for plan in plans for place in plan.places()):
            model = place.model
            read = self.fetching.files
            if isinstance(model, Plan):
                self._recipe(model, place)
            elif model is not None:
                if model not in read:
                    read[model] = list(files_of_source(model))
                self._put(model.path, read[model], model, label=place.part, span=place.span)
        return self.uses

    def _recipe(self, plan: Plan, placed: PlacedModel) -> None:
        """Add the files of a recipe itself.

        The built recipe, recipes next to it that it extends, and models written in place are not locked, because
        any change that matters changes a source. Nested recipes and fetched ones are locked.
        """
        if placed.part and not plan.at:
            self._put(plan.path, [plan.path], plan.source, label=placed.part, span=placed.span)
        label = f"{placed.above}{EXTENDS}"
        for source, span in plan.extended:
            if placed.part or source.origin is not None:
                self._put(source.path, [source.path, *source.licenses], source, label=label, span=placed.span or span)
        for file in files_of_recipe(plan, self.context):
            main = plan.path if self.fetching.around(file) is None else file
            self._put(main, [file], None, label=placed.part or plan.path.name, span=placed.span)

    def _put(self, main: Path, files: list[Path], source: Source | None, label: str, span: Span | None) -> None:
        origin = (source and source.origin) or self.fetching.around(main)
        root = self.folder if origin is None else origin.root
        path = _relative(main, root)
        local = path if path.startswith("../") or os.path.isabs(path) else f"./{path}"
        id = local if origin is None else origin.id
        if files:
            use = self.uses.setdefault(id, _SourceUse(root, origin, source, span=span))
            use.used_by.setdefault(label)
            licenses = {os.path.realpath(each) for each in source.licenses} if source is not None else set()
            for file in files:
                name = _relative(file, root)
                use.files[name] = file
                if os.path.realpath(file) in licenses:
                    use.licenses.add(name)


def _locked(use: _SourceUse, fetching: Fetching) -> Locked | None:
    """Return the entry of a source, or None if no file of it is readable."""
    files = {}
    for name, path in use.files.items():
        with contextlib.suppress(OSError):  # reported where the file is needed
            files[name] = fetching.digest(path)
    if not files:
        return None
    source = use.source
    origin = use.origin
    pins = {"commit": origin.commit, "tree": origin.tree, "sha256": origin.sha256} if origin else {}
    return Locked(
        kind=(PATH if origin is None else origin.kind).name,
        **pins,
        package=source.package if source else None,
        version=source.version if source and source.package else None,
        files=files,
        licenses=sorted(use.licenses),
        used_by=sorted(use.used_by),
    )


def _relative(path: Path, folder: Path) -> str:
    """Return a relative path, with `..` if necessary: a license may be outside its package."""
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
        yield from (f"{id}: {line}" for line in _changes_of_source(old.get(id), after.sources.get(id)))
    earlier = before.shapes if before is not None else {}
    for word, keys in (
        ("locked", after.shapes.keys() - earlier.keys()),
        ("no longer used", earlier.keys() - after.shapes.keys()),
        ("changed", {key for key in earlier if after.shapes.get(key, earlier[key]) != earlier[key]}),
    ):
        if keys:
            yield f"{len(keys)} result{'s' * (len(keys) != 1)} of work on meshes: {word}"
    old_interface = before.interface if before is not None else {}
    if old_interface != after.interface:
        word = "no longer used" if not after.interface else "changed" if old_interface else "locked"
        yield f"the interface: {word}"


def _changes_of_source(before: Locked | None, after: Locked | None) -> Iterator[str]:
    """Yield the changes of one source, which one of the two locks may not have."""
    if after is None:
        yield "no longer used"
        return
    if before is None:
        yield f"locked at {after.pin[:12]}" if after.pin else "locked"
        return
    if before.pin and after.pin and before.pin != after.pin:
        yield f"{before.pin[:12]} is now {after.pin[:12]}"
    elif before.version and after.version and before.version != after.version:
        yield f"version {before.version} is now {after.version}"
    yield from differences(before.files, after.files)
