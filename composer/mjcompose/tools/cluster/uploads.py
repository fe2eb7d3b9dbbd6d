"""Files that a worker lacks, and their places on it."""

from __future__ import annotations

import contextlib
import hashlib
import os
import pickle
import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from io import BytesIO
from pathlib import Path
from typing import Any

from mjcompose.base.access import MARKERS
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import DiagnosticError
from mjcompose.base.files import read_regular
from mjcompose.base.sink import Sink
from mjcompose.language.expand import Cell
from mjcompose.pipeline import stages
from mjcompose.pipeline.cache.cache import Package
from mjcompose.pipeline.cache.cache_key import FileState, FileStates
from mjcompose.pipeline.cache.cell_run import CellMaker, Finish, Job
from mjcompose.pipeline.cache.inputs import Inputs
from mjcompose.sources.blobs import sha256_of
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.store import ENTRY, KINDS
from mjcompose.text.node import Scalar


class ClusterError(DiagnosticError):
    """There is no cluster, it was lost, or one of its workers would make different models."""


_MOST_LINKS = 40


class MirrorContents(Struct):
    """The contents of a mirror: real paths of files with their sha256, links with their targets, and folders."""

    files: Mapping[str, str]
    links: Mapping[str, str]
    folders: frozenset[str]


def layout_of(paths: Iterable[str]) -> MirrorContents:
    """Return the layout of a mirror in which the existing paths lead to the same files.

    It includes the marker files of the top of a project, which limits the files that a model may read.
    """
    files: dict[str, str] = {}
    links: dict[str, str] = {}
    folders: set[str] = set()
    marked: set[str] = set()

    def add(path: str) -> str:
        real = _followed(path, links)
        if os.path.isdir(real):
            folders.add(real)
        elif os.path.isfile(real) and real not in files:
            with contextlib.suppress(OSError):  # unreadable files are reported when the run needs them
                files[real] = sha256_of(Path(real))
        return real

    for path in map(os.path.abspath, paths):
        for at in (os.path.dirname(path), os.path.dirname(add(path))):
            while at not in marked:
                marked.add(at)
                for marker in (os.path.join(at, name) for name in MARKERS):
                    if os.path.exists(marker):
                        add(marker)
                at = os.path.dirname(at)
    return MirrorContents(files, links, frozenset(folders))


def lay_out(layout: MirrorContents, root: Path, content: Callable[[str], Path]) -> None:
    """Create the mirror below an empty folder; `content` returns the file with a sha256. Raises OSError."""
    for folder in layout.folders:
        _inside(root, folder).mkdir(parents=True, exist_ok=True)
    for path, digest in layout.files.items():
        target = _inside(root, path)
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            os.link(content(digest), target)
        except OSError:  # another file system, or one without links
            shutil.copyfile(content(digest), target)
    for path, leads in layout.links.items():
        link = _inside(root, path)
        link.parent.mkdir(parents=True, exist_ok=True)
        _inside(root, leads).parent.mkdir(parents=True, exist_ok=True)
        if not os.path.lexists(link):
            link.symlink_to(_inside(root, leads))


def loaded(content: bytes, root: str) -> Any:
    """Unpickle data with its absolute paths moved below `root`."""

    class PathLoader(pickle.Unpickler):
        def find_class(self, module: str, name: str) -> Any:
            found = super().find_class(module, name)
            if isinstance(found, type) and issubclass(found, Path):
                return lambda *parts: rooted(Path(*parts), root)
            return found

    return PathLoader(BytesIO(content)).load()


def rooted(path: Path, root: str) -> Path:
    """Return an absolute path moved below `root`, or a relative path as it is.

    >>> rooted(Path("a.xml"), "/r").as_posix(), rooted(Path("/home/a.xml"), "/r").as_posix()
    ('a.xml', '/r/home/a.xml')
    """
    return _inside(Path(root), str(path)) if path.is_absolute() else path


def without_root(value: Any, root: str) -> Any:
    """Return data with paths and texts as if the mirror were at the root of the machine.

    >>> without_root(("at /r/x/a.xml:3", Path("/r/x/b")), "/r/x")
    ('at /a.xml:3', PosixPath('/b'))
    """
    if isinstance(value, str):
        return value.replace(root, "")
    if isinstance(value, Path):
        return Path(str(value).replace(root, ""))
    if isinstance(value, Mapping):
        return {without_root(name, root): without_root(each, root) for name, each in value.items()}
    if isinstance(value, tuple | list | frozenset | set):
        return type(value)(without_root(each, root) for each in value)
    if is_dataclass(value) and not isinstance(value, type):
        before = {each.name: getattr(value, each.name) for each in fields(value) if each.init}
        after = {name: without_root(each, root) for name, each in before.items()}
        return replace(value, **after) if after != before else value
    return value


def _inside(root: Path, path: str) -> Path:
    return root / os.path.relpath(path, os.path.abspath(os.sep))


def _followed(path: str, links: dict[str, str]) -> str:
    rest = path.split(os.sep)[1:]
    at = os.sep
    followed = 0
    while rest:
        candidate = os.path.join(at, rest.pop(0))
        if os.path.islink(candidate) and followed < _MOST_LINKS:
            followed += 1
            leads = os.path.normpath(os.path.join(at, os.readlink(candidate)))
            links[candidate] = leads
            rest = [*leads.split(os.sep)[1:], *rest]
            at = os.sep
        else:
            at = candidate
    return at


_AT_ONCE = 16 << 20  # maximum bytes in one message


class Freight(Struct):
    """The files of all cells that are known beforehand, and the packages that these cells depend on."""

    files: tuple[FileState, ...]
    layout: MirrorContents
    packages: tuple[Package, ...]


def freight_of(making: CellMaker, cells: Sequence[Cell]) -> Freight:
    """Plan enough cells to see every value of a parameter or variant; other files are found if a worker fails."""
    maker = making.maker
    inputs = Inputs()
    paths: dict[str, None] = {}
    packages: dict[Package, None] = {}
    context = replace(maker.context, sink=Sink())
    for cell in _typical(cells):
        request = stages.ModelRequest(maker.recipe, {**making.given, **cell.given}, cell.name, sample=cell.sample)
        plan = stages.planned(request, context)
        if plan is not None:
            paths.update(dict.fromkeys(inputs.planned(plan, context)))
            packages.update(dict.fromkeys(inputs.packages(plan)))
    fetching = context.fetching
    store = maker.cache.store.folder if maker.cache is not None else None
    if fetching is not None:
        for origin in fetching.origins.values():
            if store is not None and origin.root.parent.parent.name in KINDS:
                paths[os.fspath(origin.root.parent / ENTRY)] = None
    files = FileStates()
    return Freight(tuple(files.look(path) for path in paths), layout_of(paths), tuple(packages))


def away_job(making: CellMaker, finish: Finish | None) -> bytes | None:
    """Return the job for a machine with a mirror of the files, or None if it cannot write models there."""
    if making.finish is not None and finish is None:
        return None
    job = Job.of(making)
    how = job.context.fetching
    fetching = (
        None
        if how is None
        else Fetching(
            offline=True,
            locked=how.locked,
            lock=how.lock,
            lock_file=how.lock_file,
            recipe=how.recipe,
            fresh=how.fresh,
            origins=how.origins,
            outer=how.outer,
            trust=how.trust,
        )
    )
    context = replace(job.context, recipes={}, concrete={}, fetching=fetching)
    return pickle.dumps(replace(job, context=context, finish=finish))


def batches(paths: Mapping[str, str]) -> Iterator[dict[str, bytes]]:
    """Yield the contents of files in batches of limited size, by their sha256. Raises ClusterError."""
    batch: dict[str, bytes] = {}
    size = 0
    for digest, path in paths.items():
        content = b""
        with contextlib.suppress(OSError):
            content = read_regular(path)
        if hashlib.sha256(content).hexdigest() != digest:
            message = f"`{path}` changed while it was sent to the workers"
            raise ClusterError("cluster-worker", message, "run the same command again")
        batch[digest] = content
        size += len(content)
        if size > _AT_ONCE:
            yield batch
            batch = {}
            size = 0
    if batch:
        yield batch


def _typical(cells: Sequence[Cell]) -> Iterator[Cell]:
    seen: set[object] = set()
    for cell in cells:
        texts = ((name, node) for name, node in cell.given.items() if isinstance(node, Scalar))
        values = {(name, node.text) for name, node in texts if isinstance(node.value, str)}
        marks = {*values, ("names", tuple(cell.given)), ("draws", cell.sample > 0)}
        if not marks <= seen:
            seen |= marks
            yield cell
