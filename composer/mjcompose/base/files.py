"""The files that a run reads: only ordinary files. Each is remembered, and no output of the run replaces it.

Folders are resolved and listed once until a `stat` shows a change, which takes less time than reading a model. Every
reader notes its files here, and the one writer (`bundle/staging.py`) asks here. Paths are resolved when something is
written. A file that the run itself wrote is not a source.
"""

from __future__ import annotations

import errno
import os
import re
import stat
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from io import BufferedReader
from itertools import islice
from pathlib import PurePath
from typing import TYPE_CHECKING, Generic, TypeVar

from mjcompose.base.dataclass import Struct
from mjcompose.base.limits import in_force, written
from mjcompose.base.naming import without_odd
from mjcompose.base.scratch import is_scratch

if TYPE_CHECKING:
    from pathlib import Path

    from mjcompose.base.diagnostic import Note, Span
    from mjcompose.base.sink import Sink

_MOST = 4096
"""The maximum number of paths in one memory; beyond it, all are looked up again."""
_SETTLED = 2_000_000_000
"""Nanoseconds: changes closer to each other than this may have the same time, as on FAT."""

T = TypeVar("T")


class Memory(Generic[T]):
    """Caches `look_up` for paths until `stat` shows a change; `missing` is for paths without a `stat`."""

    def __init__(self, look_up: Callable[[str], T], missing: Callable[[str], T]) -> None:
        self._look_up = look_up
        self._missing = missing
        self._known: dict[str, tuple[tuple[int, ...], T]] = {}

    def ask(self, path: str) -> T:
        try:
            status = os.stat(path)
        except (OSError, ValueError):
            return self._missing(path)
        changed = max(status.st_mtime_ns, status.st_ctime_ns)
        state = (*status[1:4], status.st_size, status.st_mtime_ns, status.st_ctime_ns)  # inode, device, links
        known = self._known.get(path)
        if known is not None and known[0] == state:
            return known[1]
        found = self._look_up(path)
        if time.time_ns() - changed > _SETTLED:
            if len(self._known) >= _MOST:
                self._known.clear()
            self._known[path] = state, found
        return found


Mark = tuple[int, int, int, int] | None
"""The properties that change with a file: its two times, its size and its inode; None if it does not exist.

Programs such as `cp -p` and `tar` set the first time of a file to any value, and the system the second one.
"""


def mark_of(path: str | os.PathLike[str]) -> Mark:
    """Return the mark of a file; None if it does not exist."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_ctime_ns, found.st_size, found.st_ino


_FEW = 4
"""The smallest number of files for which a folder is listed."""
_LISTED = 16
"""The number of entries that are read for each of these files."""
_real = Memory(os.path.realpath, os.path.realpath)


def real_folder(folder: str) -> str:
    """Return the real path of a folder, which need not exist."""
    return _real.ask(folder)


def parted(path: str) -> tuple[str, str]:
    """Split a path into its folder, including the separator, and the name."""
    if os.altsep is not None:
        return os.path.split(path)
    at = path.rfind(os.sep) + 1
    return path[:at], path[at:]


def files_among(paths: Iterable[str]) -> Iterator[tuple[str, list[str]]]:
    """Yield folders with those paths in each that a fast listing shows as ordinary files; it misses links."""
    by_folder: dict[str, dict[str, str]] = {}
    for path in paths:
        folder, name = parted(path)
        by_folder.setdefault(folder, {})[name] = path
    for folder, names in by_folder.items():
        if len(names) < _FEW:
            continue
        existing: list[str] = []
        try:
            with os.scandir(folder) as entries:
                for entry in islice(entries, _LISTED * len(names)):
                    if entry.name in names and entry.is_file(follow_symlinks=False):
                        existing.append(names[entry.name])
        except (OSError, ValueError):
            continue
        yield folder, existing


def real_path(path: str | os.PathLike[str]) -> str:
    """Return the real path of a path, which need not exist."""
    text = os.fspath(path)
    folder, name = os.path.split(text)
    if name in ("", os.curdir, os.pardir) or os.path.islink(text):
        return os.path.realpath(text)
    return os.path.join(real_folder(folder), name)


def memory_of(names: tuple[str, ...]) -> Callable[[str], bool]:
    """Return a cached function that says whether a folder has an entry with one of these names."""

    def holds_any(folder: str) -> bool:
        # `exists` raises and catches an exception for each missing name.
        return any(os.access(f"{folder}{os.sep}{name}", os.F_OK) for name in names)

    return Memory(holds_any, lambda _: False).ask


CODE = "source-outside"
OUTSIDE = "is outside {}"


class Refused(OSError):
    """A file that a door does not admit; `why` follows its name in a message, `help` says what to do."""

    def __init__(self, path: str, why: str, help: str | None = None, real: str | None = None) -> None:
        super().__init__(errno.EACCES, why, path)
        self.path = path
        self.why = why
        self.help = help
        self.real = real

    def message(self, shown: Callable[[Path], str] | None = None) -> str:
        """Return one sentence; `shown` returns the file's name in messages."""
        from pathlib import Path

        call = shown or str
        path = Path(self.path)
        leads = f", a link to `{call(Path(self.real))}`," if self.real is not None and path.is_symlink() else ""
        return f"the file `{call(path)}`{leads} {self.why}"

    def report(
        self,
        sink: Sink,
        span: Span | None,
        notes: Iterable[Note] = (),
        shown: Callable[[Path], str] | None = None,
    ) -> None:
        """Report it to a `sink`, at the place that names the file."""
        from pathlib import Path

        from mjcompose.base.diagnostic import Cause

        cause = None
        if self.real is not None:  # all files of one folder have one cause
            folder = os.path.dirname(self.real)
            cause = Cause(f"{span.file if span else ''} {folder} {self.why}", f"`{(shown or str)(Path(self.path))}`")
        sink.error(CODE, self.message(shown), span, notes=tuple(notes), help=self.help, cause=cause)


# Opening does not wait for the other end of a pipe, and does not acquire a controlling terminal.
_FLAGS = os.O_RDONLY | sum(getattr(os, f"O_{name}", 0) for name in ("BINARY", "NONBLOCK", "NOCTTY", "CLOEXEC"))
_KINDS = {stat.S_IFIFO: "a named pipe", stat.S_IFCHR: "a device", stat.S_IFBLK: "a device", stat.S_IFSOCK: "a socket"}


class TooLarge(OSError):
    """A file with more bytes than allowed; `size` is its size, or the number of bytes read."""

    def __init__(self, size: int, most: int, what: str = "it is", path: str | None = None) -> None:
        super().__init__(f"{what} larger than {written('xml-size', most)}")
        self.size = size
        self.path = path


def is_irregular(path: str) -> str | None:
    """Return why a path is neither a file nor a folder; None if it is one or does not exist."""
    try:
        return _irregular(os.stat(path).st_mode)
    except (OSError, ValueError):  # reported where it is read
        return None


def _irregular(mode: int) -> str | None:
    if stat.S_ISREG(mode) or stat.S_ISDIR(mode):
        return None
    return f"is {_KINDS.get(stat.S_IFMT(mode), 'no file')}, not an ordinary file"


def read_regular(path: str | os.PathLike[str], most: int | None = None, *, is_source: bool = True) -> bytes:
    """Return the bytes of an ordinary file, or its unsaved text from an editor.

    It becomes a source of the run, so no output replaces it. Raises Refused for other kinds of files, and OSError, even
    for more than `most` bytes. By default `most` is the limit of a whole bundle.
    """
    most = in_force().output_size if most is None else most
    kept = unsaved_text(path)
    if kept is not None:
        _bound(len(kept), most, path)
        return kept
    file, size = _opened(path, most, is_source)
    try:
        pieces = [os.read(file, size + 1)]
        while pieces[-1] and (so_far := sum(map(len, pieces))) != size:  # it is growing, or too large for one call
            _bound(so_far, most, path)
            pieces.append(os.read(file, 1 << 24))
    finally:
        os.close(file)
    return pieces[0] if len(pieces) == 1 else b"".join(pieces)


def read_argument(path: str | os.PathLike[str], most: int) -> bytes:
    """Read a file, standard input or `<(command)` that an argument names: at most one byte more than `most`."""
    text = os.fspath(path)
    if text == "/dev/stdin" or os.path.dirname(text) in ("/dev/fd", "/proc/self/fd"):
        with open(text, "rb") as stream:
            content = stream.read(most + 1)
        if content or text not in _piped:  # a pipe can be read only once
            _piped[text] = content
        return _piped[text]
    return read_regular(path, most)


def open_regular(path: str | os.PathLike[str], most: int | None = None, *, is_source: bool = True) -> BufferedReader:
    """Open an ordinary file, as `read_regular` reads it."""
    file, _ = _opened(path, in_force().output_size if most is None else most, is_source)
    return os.fdopen(file, "rb")


def _opened(path: str | os.PathLike[str], most: int, is_source: bool) -> tuple[int, int]:
    text = os.fspath(path)
    if is_source:
        current().note((text,))
    what = is_irregular(text)
    if what is not None:
        raise Refused(text, what)
    file = os.open(text, _FLAGS)
    try:
        status = os.fstat(file)
        what = _irregular(status.st_mode)
        if what is not None:  # replaced since the first check
            raise Refused(text, what)
        if stat.S_ISDIR(status.st_mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), text)
        _bound(status.st_size, most, text)
    except BaseException:
        os.close(file)
        raise
    return file, status.st_size


def _bound(size: int, most: int, path: str | os.PathLike[str]) -> None:
    if size > most:
        raise TooLarge(size, most, path=os.fspath(path))


_NAMES = re.compile(rb"""[^\s\0"'<>|{}\[\],;:#]+\.\w{2,5}|"[^"\n\0]+"|'[^'\n\0]+'|(?<=[:-] )[^\s"'{\[][^\n\0#]*""")
"""Texts that may name a file in a recipe: a word with a suffix, a quoted text, the rest of a line."""
_FOLDERS = re.compile(rb"""(?:mesh|texture|asset)dir\s*=\s*["']([^"'\n\0]+)["']""")
_COMMENT = re.compile(rb"(?m)(?:^|(?<=[ \t]))#[^\n]*")
_FILES = re.compile(rb"""\bfile\w*\s*=\s*["']([^"'\n\0]+)["']""")
RECIPES = (".yaml", ".yml")
"""The ends of the names of recipes."""
MJCF_FILES = (".xml", ".mjcf")
"""The ends of the names of MJCF files; MuJoCo 4.0 opens only the first."""
URDF_FILES = (".urdf", ".xacro")
MODEL_FILES = (*RECIPES, *MJCF_FILES, *URDF_FILES)
"""The ends of the names of files that are models."""
MESH_FILES = (".obj", ".stl", ".msh")
"""The ends of the names of meshes that MuJoCo reads; `base` and `attach` take them as models of one body."""
_NOWHERE = {errno.ENOENT, errno.ENOTDIR, errno.EACCES, errno.ENAMETOOLONG, errno.ELOOP}
Identity = tuple[int, int]
"""The device and the inode of a file, which are the same under each of its names."""


class RunSources:
    """The sources of one run."""

    def __init__(self) -> None:
        self._noted: dict[str, None] = {}
        self._resolved = 0
        self._paths: set[str] = set()
        self._files: dict[Identity, str] = {}
        self._above: dict[str, str] = {}
        self._named: dict[Identity, str] = {}
        self._unscanned: list[str] = []
        self._scanned: set[Identity] = set()
        self._written: set[str] = set()

    def note(self, paths: Iterable[str | os.PathLike[str]]) -> None:
        """Note files that are read."""
        for path in paths:
            text = os.fspath(path)
            if text not in self._noted and not is_scratch(text):
                self._noted[text] = None

    def noted(self) -> tuple[str, ...]:
        return tuple(self._noted)

    def wrote(self, path: str) -> None:
        """Note a file or a folder that the run has written."""
        self._written.add(os.path.realpath(path))

    def taken(self, target: str, *, more: Iterable[str | os.PathLike[str]] = ()) -> str | None:
        """Return the source whose place `target` would take, or that is in the folder `target`; None for a free place.

        `more` are sources whoever wrote them. Raises OSError and ValueError if that is unknown; then nothing is
        written.
        """
        self._resolve()
        real = os.path.realpath(target)
        at = os.path.normcase(real)
        identity = _identity(real)
        for path in more:
            source = os.path.normcase(real_path(path))
            is_same = identity is not None and identity == _identity(source)
            if is_same or source == at or source.startswith(_folder(at)):
                return os.fspath(path)
        if real in self._written:
            return None
        if at in self._paths:
            return real
        if identity is not None and identity in self._files:
            return self._files[identity]
        if identity is None:
            return None
        named = self._all_named()
        if not os.path.isdir(real):
            return named.get(identity)
        inside = (source for above, source in self._above.items() if above == at or identity == _identity(above))
        below = (path for path in named.values() if real_path(path).startswith(_folder(real)))
        return next(inside, None) or next(below, None)

    def _resolve(self) -> None:
        for path in list(self._noted)[self._resolved :]:
            self._resolved += 1
            real = real_path(path)
            if any(path_above in self._written for path_above in _with_above(real)):
                continue
            self._paths.add(os.path.normcase(real))
            identity = _identity(real)
            if identity is not None:
                self._files[identity] = path
                if path.lower().endswith(RECIPES):
                    self._unscanned.append(path)
            for above in _with_above(os.path.dirname(os.path.normcase(real))):
                if above in self._above:
                    break
                self._above[above] = path

    def _all_named(self) -> Mapping[Identity, str]:
        """Return the files that the recipes and models name but the run did not read, such as files of a variant."""
        while self._unscanned:
            path = self._unscanned[-1]  # until it is scanned
            own = _identity(path)
            is_recipe = path.lower().endswith(RECIPES)
            text = b"" if own is None or own in self._scanned else _text(path)
            folder = os.path.dirname(path)
            folders = [folder, *(os.path.join(folder, os.fsdecode(each)) for each in _FOLDERS.findall(text))]
            names = dict.fromkeys(
                os.fsdecode(word.strip(b" \t\r\"'"))
                for word in (_NAMES if is_recipe else _FILES).findall(_COMMENT.sub(b"", text) if is_recipe else text)
            )
            more = []
            for named in (os.path.join(each, name) for each in folders for name in names):
                found = _identity(named)
                if found is not None and found not in self._files and os.path.isfile(named):
                    self._named[found] = named
                    if named.lower().endswith(MODEL_FILES):
                        more.append(named)
            if own is not None:
                self._scanned.add(own)
            self._unscanned[-1:] = more
        return self._named


class _NoRun(RunSources):
    """The state outside a run: another program reads and writes files freely."""

    def note(self, paths: Iterable[str | os.PathLike[str]]) -> None:
        """Note nothing."""


_runs: list[RunSources] = [_NoRun()]


def current() -> RunSources:
    """Return the run of this process that began last."""
    return _runs[-1]


@contextmanager
def run() -> Iterator[RunSources]:
    """Start a run without sources for the block."""
    _runs.append(RunSources())
    try:
        yield _runs[-1]
    finally:
        _runs.pop()


def _folder(path: str) -> str:
    return path.rstrip(os.sep) + os.sep


def _with_above(path: str) -> Iterator[str]:
    while True:
        yield path
        above = os.path.dirname(path)
        if above == path:
            return
        path = above


def _identity(path: str) -> Identity | None:
    """Return the identity of a file, which all of its names share, or None. Raises OSError and ValueError."""
    try:
        found = os.stat(path)
    except OSError as error:
        if error.errno in _NOWHERE:
            return None
        raise
    return found.st_dev, found.st_ino


def _text(path: str) -> bytes:
    with suppress(TooLarge):  # which no run reads
        if os.path.isfile(path):
            return read_regular(path, in_force().xml_size, is_source=False)
    return b""


_TEXTS: ContextVar[Mapping[str, bytes] | None] = ContextVar("mjcompose.base.files", default=None)

STDIN = "<stdin>"
"""The name of standard input in messages: a recipe in the current folder that is in no file."""
DATA = "<recipe>"
"""The name of a recipe that a program has as data, until messages name the program's line."""
_piped: dict[str, bytes] = {}


def keep_stdin() -> str:
    """Read a recipe from standard input, to be read as a file in the current folder, and return its name."""
    stream = None if sys.stdin is None else sys.stdin.buffer
    _piped[os.path.join(os.getcwd(), STDIN)] = b"" if stream is None else stream.read(in_force().recipe_size + 1)
    return STDIN


def own_name(path: PurePath) -> str:
    r"""Return the name of a recipe's model if the recipe gives it none, which fits on one line. No I/O.

    >>> from pathlib import Path
    >>> own_name(Path("arms/left arm.yaml")), own_name(Path("arm\n.yaml"))
    ('left arm', 'arm_')
    """
    return "model" if path.name in (STDIN, DATA) else without_odd(path.stem) or "model"


@contextmanager
def unsaved(texts: Mapping[str, bytes]) -> Iterator[None]:
    """Within the block, read `texts`, by real path, instead of files."""
    token = _TEXTS.set({**(_TEXTS.get() or {}), **texts})
    try:
        yield
    finally:
        _TEXTS.reset(token)


def unsaved_text(path: str | os.PathLike[str]) -> bytes | None:
    """Return the text to read instead of a file, or None."""
    if _piped and (kept := _piped.get(os.fspath(path))) is not None:
        return kept
    texts = _TEXTS.get()
    return texts.get(os.path.realpath(path)) if texts else None


def untrusted(folder: str | os.PathLike[str], is_temporary: bool = False) -> str | None:
    """Return why a private folder is not trusted, or None. A system folder may be sticky, for temporary files."""
    if not hasattr(os, "geteuid"):  # a system without such owners, as Windows
        return None
    try:
        status = os.stat(folder)
    except (FileNotFoundError, NotADirectoryError):
        return None
    except Exception as error:
        reason = getattr(error, "strerror", None) or type(error).__name__
        return f"its owner cannot be determined: {reason.lower()}"
    if status.st_uid != os.geteuid() and not (is_temporary and status.st_uid == 0):
        return "it belongs to another user"
    if not status.st_mode & stat.S_IWOTH or (is_temporary and status.st_mode & stat.S_ISVTX):
        return None
    return "every user may remove what others have in it" if is_temporary else "every user may write to it"


class Foreign(Struct):
    """A format by its name; `advice` has `{file}` and `{stem}` for the path of a file with and without its suffix."""

    name: str
    advice: str

    def message(self, text: str) -> str:
        return f"`{text}` is {self.name}, which mjcompose does not read"

    def help(self, text: str) -> str:
        suffix = PurePath(text).suffix
        return self.advice.format(file=text, stem=text.removesuffix(suffix) + "_mjcf" * (suffix == ".xml"))


SDF = Foreign("SDFormat", "convert it with Gazebo: `sdf2mjcf {file} {stem}.xml`, of the package `sdformat-mjcf`")
USD = Foreign("USD", "use the MJCF or URDF that it was made from, or export URDF from the program that made it")
_FORMATS = {**dict.fromkeys((".sdf", ".world"), SDF), **dict.fromkeys((".usd", ".usda", ".usdc", ".usdz"), USD)}


def foreign_format(path: PurePath) -> Foreign | None:
    """Return the format of a file by its suffix, if it is one of these. No I/O."""
    return _FORMATS.get(path.suffix.lower())
