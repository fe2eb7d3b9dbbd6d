"""Let MuJoCo open recipes: decoders and providers that MuJoCo 4 calls, in this process.

The decoder is also a library in MuJoCo's plugin folder, for programs without Python and for `import mujoco` alone.

MuJoCo calls these functions from C++, which no exception may reach: a ctypes callback that raises returns an
uninitialized pointer, and the process crashes. An interrupt can arrive at any instruction of Python, so `_Safe` lets
the handler of SIGINT raise only in code below its `try`.
"""

from __future__ import annotations

import contextlib
import ctypes
import glob
import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from types import FrameType
from typing import Any

from mjcompose.base.diagnostic import Diagnostic, DiagnosticError
from mjcompose.base.files import read_regular
from mjcompose.base.processes import DEVNULL, PIPE, Overrun, Process, program
from mjcompose.base.report import MjcomposeError, render
from mjcompose.base.scratch import scratch
from mjcompose.bundle.bundle import unwritable_error
from mjcompose.bundle.staging import staged_file
from mjcompose.sources import packages
from mjcompose.sources.lock import resolve
from mjcompose.sources.reference import SourceError
from mjcompose.tools.open.recipe import text_of

OLDEST = (4, 0)
"""The first MuJoCo whose decoders have these arguments."""
EXTENSIONS = b".yaml|.yml"
PROVIDERS = ("menagerie", "package")
_LONGEST = 1024


class _Provider(ctypes.Structure):
    """`mjpResourceProvider` of `mjplugin.h`."""


class _Resource(ctypes.Structure):
    """`mjResource` of `mjplugin.h`."""

    _fields_ = (
        ("name", ctypes.c_char_p), ("data", ctypes.c_void_p), ("vfs", ctypes.c_void_p),
        ("timestamp", ctypes.c_char * 512), ("provider", ctypes.POINTER(_Provider)), ("args", ctypes.c_char_p),
    )  # fmt: skip


_RESOURCE = ctypes.POINTER(_Resource)
_OPEN = ctypes.CFUNCTYPE(ctypes.c_int, _RESOURCE)
_READ = ctypes.CFUNCTYPE(ctypes.c_int, _RESOURCE, ctypes.POINTER(ctypes.c_void_p))
_CLOSE = ctypes.CFUNCTYPE(None, _RESOURCE)
_MODIFIED = ctypes.CFUNCTYPE(ctypes.c_int, _RESOURCE, ctypes.c_char_p)
_DECODE = ctypes.CFUNCTYPE(ctypes.c_void_p, _RESOURCE, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int)
_Provider._fields_ = (
    ("prefix", ctypes.c_char_p), ("open", _OPEN), ("read", _READ), ("close", _CLOSE), ("mount", _OPEN),
    ("unmount", _OPEN), ("modified", _MODIFIED), ("write", ctypes.c_void_p), ("data", ctypes.c_void_p),
)  # fmt: skip


class _Decoder(ctypes.Structure):
    """`mjpDecoder` of `mjplugin.h`."""

    _fields_ = (
        ("content_type", ctypes.c_char_p),
        ("extension", ctypes.c_char_p),
        ("can_decode", _OPEN),
        ("decode", _DECODE),
    )


_MARK = "_mjcompose"
"""The attribute of the `mujoco` module that holds the registered objects, so a reloaded module of ours finds them."""


def register() -> None:
    """Let MuJoCo open recipes in this process: `MjSpec.from_file("cell.yaml")`, and `<model file="cell.yaml">`.

    Files in MJCF may also be named by `menagerie:ROBOT/FILE` and `package:NAME/FILE`. Calling it again changes
    nothing. It cannot be undone in this process.

    Raises MjcomposeError before MuJoCo 4.0, or if another package opens `.yaml` files.
    """
    import mujoco

    if hasattr(mujoco, _MARK):
        return
    if tuple(int(part) for part in mujoco.__version__.split(".")[:2]) < OLDEST:
        message = f"MuJoCo {mujoco.__version__} cannot open recipes: its decoders are older than those of MuJoCo 4.0"
        raise _error(message, "use `mjcompose.spec(recipe)`, or install `mujoco>=4`")
    folder = Path(mujoco.__file__).parent
    if _has_plugin(folder):
        return
    library = _library(folder)
    probe = _Resource(name=b"x.yaml")
    if library.mjp_findDecoder(ctypes.byref(probe), b""):
        message = "another package already opens `.yaml` files in this process, and MuJoCo allows one decoder"
        raise _error(message, "use `mjcompose.spec(recipe)`")
    kept = [_decoder(library), *(_provider(scheme) for scheme in PROVIDERS)]
    library.mjp_registerDecoder(ctypes.byref(kept[0]))
    for provider in kept[1:]:
        library.mjp_registerProvider(ctypes.byref(provider))
    setattr(mujoco, _MARK, kept)
    _watch_interrupts()


def is_registered() -> bool:
    """Return whether MuJoCo opens recipes in this process."""
    import mujoco

    return hasattr(mujoco, _MARK) or _has_plugin(Path(mujoco.__file__).parent)


def _has_plugin(folder: Path) -> bool:
    if sys.platform != "linux":
        return False
    with contextlib.suppress(OSError):
        ctypes.CDLL(str(library_in(folder)), mode=os.RTLD_NOLOAD)
        return True
    return False


def _error(message: str, help: str) -> MjcomposeError:
    return MjcomposeError([Diagnostic("not-supported", message, help=help)])


def _library(folder: Path) -> Any:
    names = ("libmujoco.so.*", "libmujoco.*.dylib", "mujoco.dll")
    [path, *_] = [path for name in names for path in glob.glob(str(folder / name))]
    library = ctypes.CDLL(path)
    library.mjp_findDecoder.restype = ctypes.c_void_p
    library.mjp_findDecoder.argtypes = [_RESOURCE, ctypes.c_char_p]
    library.mjp_registerDecoder.restype = None
    library.mj_parseXMLString.restype = ctypes.c_void_p
    library.mj_parseXMLString.argtypes = [ctypes.c_char_p, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int]
    return library


_interrupted = threading.Event()
"""An interrupt arrived in a callback, and waits until MuJoCo has returned to Python."""
_before: Any = None
"""The handler of the program."""
_sent = False
"""An interrupt was sent again, and has not arrived yet."""


class _Safe:
    """A callback that never raises: it returns `failure` instead, and passes the reason to `explain`."""

    def __init__(self, work: Callable[..., Any], failure: Any, explain: Callable[..., None] | None = None) -> None:
        self.work = work
        self.failure = failure
        self.explain = explain

    def __call__(self, *arguments: Any) -> Any:
        try:
            return self.run(arguments)
        except BaseException as error:  # nothing may reach MuJoCo
            if isinstance(error, KeyboardInterrupt):
                _postpone()
            if self.explain is not None:
                self.explain(error, *arguments)
            return self.failure

    def run(self, arguments: tuple[Any, ...]) -> Any:
        """Do the work. Interrupts are raised in here, and nowhere else in a callback."""
        if _interrupted.is_set():
            raise KeyboardInterrupt  # MuJoCo returns sooner
        return self.work(*arguments)


_GUARD = _Safe.__call__.__code__
_WORK = _Safe.run.__code__


def _on_interrupt(number: int, frame: FrameType | None) -> None:
    global _sent
    _sent = False
    below: FrameType | None = frame
    while below is not None and below.f_code not in (_GUARD, _WORK):
        below = below.f_back
    if below is None:
        _interrupted.clear()
        _before(number, frame)
        return
    is_first = not _interrupted.is_set()
    _postpone()  # also if it is raised here: a destructor could swallow it
    if below.f_code is _WORK and is_first:
        _before(number, frame)


def _postpone() -> None:
    """Send the interrupt again, until it arrives outside callbacks."""
    if not _interrupted.is_set():
        _interrupted.set()
        threading.Thread(target=_send_again, daemon=True).start()


def _send_again() -> None:
    global _sent
    while _interrupted.is_set():
        if not _sent:  # otherwise two would arrive for one
            _sent = True
            if sys.platform == "win32":
                signal.raise_signal(signal.SIGINT)
            else:  # wakes the main thread up, too
                signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
        time.sleep(0.001)


def _watch_interrupts() -> None:
    """Handle SIGINT before the handler of the program, if that raises an exception."""
    global _before
    if threading.current_thread() is not threading.main_thread():
        return
    handler = signal.getsignal(signal.SIGINT)
    if callable(handler) and handler is not _on_interrupt:
        _before = handler
        signal.signal(signal.SIGINT, _on_interrupt)


def _decoder(library: Any) -> _Decoder:
    def decode(resource: Any, vfs: int | None, error: int | None, size: int) -> int:
        _watch_interrupts()  # the program may have set another handler
        reason = ctypes.create_string_buffer(_LONGEST)
        text = text_of(os.fsdecode(resource.contents.name)).encode()
        spec = library.mj_parseXMLString(text, vfs, reason, _LONGEST)
        if not spec:
            raise DiagnosticError("mujoco-rejects", reason.value.decode(errors="replace"))
        return int(spec)

    def explain(error: BaseException, resource: Any, vfs: int | None, place: int | None, size: int) -> None:
        if isinstance(error, MjcomposeError):
            first = error.diagnostics[0] if len(error.diagnostics) == 1 else error
            reason = render(first) if isinstance(first, Diagnostic) else str(error)
        else:
            reason = "interrupted" if isinstance(error, KeyboardInterrupt) else str(error) or type(error).__name__
        if place and size > 0:
            _write(place, size, reason)

    return _Decoder(
        content_type=b"application/x-mjcompose",
        extension=EXTENSIONS,
        can_decode=_OPEN(_Safe(lambda resource: 1, 1)),
        decode=_DECODE(_Safe(decode, None, explain)),
    )


def _write(place: int, size: int, reason: str) -> None:
    """Write a text into a buffer of MuJoCo, shortened at a character of UTF-8."""
    content = reason.encode(errors="replace")
    if len(content) >= size:
        content = content[: max(0, size - 4)].decode(errors="ignore").encode() + "…".encode()
    ctypes.memmove(place, content[: size - 1] + b"\0", min(len(content), size - 1) + 1)


def _provider(scheme: str) -> _Provider:
    """Return a provider of the files of one source kind, found by the resolver that recipes use."""
    folders: dict[str, Path] = {}
    contents: dict[int, bytes] = {}

    def path_of(name: str) -> Path:
        owner, _, inner = name.partition(":")[2].partition("/")
        if owner not in folders:
            folders[owner] = _folder(scheme, owner)
        root = os.path.realpath(folders[owner])
        path = os.path.realpath(os.path.join(root, inner))
        if not path.startswith(os.path.join(root, "")):
            raise PermissionError(f"`{name}` is outside `{owner}`")
        return Path(path)

    def state(path: Path) -> bytes:
        status = path.stat()
        return f"{status.st_mtime_ns}-{status.st_size}".encode()

    def open_(resource: Any) -> int:
        path = path_of(os.fsdecode(resource.contents.name))
        resource.contents.timestamp = state(path)
        contents[ctypes.addressof(resource.contents)] = read_regular(path)
        return 1

    def read(resource: Any, out: Any) -> int:
        content = contents[ctypes.addressof(resource.contents)]
        out[0] = ctypes.cast(ctypes.c_char_p(content), ctypes.c_void_p).value
        return len(content)

    def close(resource: Any) -> None:
        contents.pop(ctypes.addressof(resource.contents), None)

    def modified(resource: Any, timestamp: bytes) -> int:
        return int(state(path_of(os.fsdecode(resource.contents.name))) != timestamp)

    return _Provider(
        prefix=scheme.encode(),
        open=_OPEN(_Safe(open_, 0)),
        read=_READ(_Safe(read, -1)),
        close=_CLOSE(_Safe(close, None)),
        modified=_MODIFIED(_Safe(modified, 1)),
    )


def _folder(scheme: str, owner: str) -> Path:
    if scheme == "package":
        found = packages.folders(owner)
        if found:
            return found[0]
        raise SourceError("source-not-found", f"the Python package `{owner}` is not installed")
    source = resolve(f"{scheme}:{owner}", relative_to=Path.cwd(), environment=dict(os.environ))
    assert source.origin is not None, "a robot of Menagerie has one"
    return source.origin.root


SOURCE = Path(__file__).with_name("decoder.c")
NAME = "libmjcompose_decoder.so"
_COMPILING = 120.0


class PluginError(DiagnosticError):
    """The library cannot be compiled or installed."""


def mujoco_folder(named: Path | None = None) -> Path:
    """Return the folder of a MuJoCo: the named folder, or the folder of the `mujoco` package. Raises PluginError."""
    if named is None:
        spec = find_spec("mujoco")
        if spec is None or not spec.submodule_search_locations:
            raise PluginError("mujoco-missing", "the package `mujoco` is not installed", "use `--mujoco`")
        named = Path(spec.submodule_search_locations[0])
    if not os.path.isfile(named / "include" / "mujoco" / "mjplugin.h"):
        help = "name the folder of a MuJoCo release, or of the package `mujoco`"
        raise PluginError("mujoco-missing", f"`{named}` has no `include/mujoco/mjplugin.h`", help)
    return named


def library_in(folder: Path) -> Path:
    """Return the place of the library for a MuJoCo: `plugin` in the package, `bin/mujoco_plugin` in a release."""
    release = folder / "bin" / "mujoco_plugin"
    return (release if os.path.isdir(release) else folder / "plugin") / NAME


def install(folder: Path) -> Path:
    """Compile the decoder for the MuJoCo in a folder and put it in its place. Raises PluginError and OutputError."""
    if sys.platform != "linux":
        message = "the plugin for programs without Python exists for Linux only"
        raise PluginError("not-supported", message, "in Python, use `mjcompose.mujoco_plugin.register()`")
    header = read_regular(folder / "include" / "mujoco" / "mujoco.h").decode(errors="replace")
    version = next((line.split()[-1] for line in header.splitlines() if "#define mjVERSION_HEADER" in line), "0")
    if int(version) < 4_000_000:
        raise PluginError(
            "not-supported",
            f"the MuJoCo in `{folder}` is older than 4.0, the first that opens recipes",
            "install `mujoco>=4`, or build a bundle with `mjcompose build`",
        )
    named = os.environ.get("CC", "cc")
    compiler = named if os.path.isabs(named) else program(named, os.environ)
    if compiler is None:
        raise PluginError("not-installed", "there is no C compiler", "install one, such as `gcc`, or set `CC`")
    place = library_in(folder)
    with scratch("plugin") as build:
        made = build / NAME
        python = sys.executable.replace("\\", "\\\\").replace('"', '\\"')
        words = [
            compiler,
            "-O2",
            "-shared",
            "-fPIC",
            f"-I{folder.absolute() / 'include'}",
            f'-DMJCOMPOSE_PYTHON="{python}"',
            str(SOURCE),
            "-o",
            str(made),
            "-ldl",
        ]
        _compile(words)
        with staged_file(place) as stage:  # raises OutputError
            stage.write_bytes(read_regular(made))
    return place


def _compile(words: list[str]) -> None:
    reason = "no reason given"
    try:
        with Process(words, stdout=DEVNULL, stderr=PIPE) as process:
            _, said = process.finish(seconds=_COMPILING, most=0)
        if process.returncode == 0:
            return
        reason = next(iter(said.decode("utf-8", "replace").strip().splitlines()), reason)
    except (OSError, Overrun) as error:
        reason = str(error)
    raise PluginError("not-supported", f"`{words[0]}` cannot compile the plugin: {reason}")


def remove(folder: Path) -> Path | None:
    """Remove the library from the MuJoCo in a folder; return its place, or None if it is not there."""
    place = library_in(folder)
    try:
        place.unlink()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise unwritable_error(place, error) from None
    return place
