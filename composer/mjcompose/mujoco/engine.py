"""Requests to MuJoCo in a child process with limits, and its answers."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import re
import shutil
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, field
from functools import lru_cache
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from mjcompose.base.dataclass import Struct
from mjcompose.base.files import untrusted
from mjcompose.base.limits import GIB, in_force
from mjcompose.base.processes import PIPE, Process, WorkFolder, isolated, module_path
from mjcompose.base.scratch import scratch
from mjcompose.tree.grammar import version_key

if TYPE_CHECKING:
    import numpy

    from mjcompose.mujoco.index import CompiledIndex


class RequestLimits(Struct):
    """Limits of one request; the defaults are the limits in force.

    `seconds` is wall-clock time per request, without the start of Python and the import of MuJoCo. `memory` is in
    bytes and applies on POSIX only.
    """

    seconds: float = field(default_factory=lambda: in_force().time)
    memory: int = field(default_factory=lambda: in_force().memory)

    @property
    def step(self) -> float:
        """Seconds that the first step of a model may compute (POSIX); a slower model cannot be simulated."""
        return self.seconds / 20

    def __post_init__(self) -> None:
        if not self.seconds > 0 or not self.memory > 0:
            raise ValueError("limits must be greater than zero")


WANTS = frozenset({"forward", "index", "names"})


class CompileRequest(Struct):
    """Compile `folder/model` and report on it.

    `wants` lists contents of the answer besides sizes and warnings: `index` (joints, actuators, sensors with their
    addresses), `names` (of every kind of object), `forward` (one mj_forward at the reference configuration).
    `arrays` are attributes of mjModel, or of mjData after mj_forward if written `data.NAME`. `mjb` is the path for
    the compiled model. `keep` is a name under which a session's child keeps the compiled model for `Session.call`.
    `text`, if given, replaces the file's content; the file need not exist then, and relative paths in the text
    still start at its folder. `folder_is_reused`: only the model in `folder` ever changes, so MuJoCo may reuse
    the other files.
    """

    folder: Path
    model: str = "model.xml"
    wants: tuple[str, ...] = ()
    arrays: tuple[str, ...] = ()
    mjb: Path | None = None
    text: str | None = None
    keep: str | None = None
    folder_is_reused: bool = False

    def __post_init__(self) -> None:
        unknown = set(self.wants) - WANTS
        if unknown:
            raise ValueError(f"unknown needs {sorted(unknown)}; there are {sorted(WANTS)}")

    def to_json(self, arrays_file: Path, step: float = 0) -> str:
        """Return a line of JSON with absolute paths. `step` limits the forward step, in seconds, if it is not 0."""
        paths = {
            "folder": str(self.folder.absolute()),
            "mjb": self.mjb and str(self.mjb.absolute()),
            "arrays_file": str(arrays_file),
        }
        return json.dumps({**asdict(self), **paths, "step": step}, ensure_ascii=False)


class Compiled(Struct):
    """A model that compiled, or the reason that it did not.

    `error` is MuJoCo's own text, or one sentence if MuJoCo gave none. Paths in it are relative to the folder.
    `crash` is set if there is no verdict on the model: `timeout`, `memory`, `signal N`, `exit N`, `missing` (no
    MuJoCo in this Python) or `start` (no child process). `forward` is the error in one mj_forward at the reference
    configuration; None if all numbers are finite, or if it was not requested. `sizes` are all integer sizes of
    mjModel (nq, nv, nu, na, nbody, ...) and `nactuator`, which counts actuators while `nu` counts controls.
    """

    ok: bool
    error: str | None = None
    crash: str | None = None
    warnings: tuple[str, ...] = ()
    mujoco_version: str | None = None
    sizes: Mapping[str, int] = field(default_factory=dict)
    forward: str | None = None
    index: CompiledIndex | None = None
    names: Mapping[str, tuple[str, ...]] | None = None


class Measured(Struct):
    """A compiled model with some of its arrays.

    `arrays` has the requested attributes that this version of MuJoCo has, sizes as arrays of one; it is empty if
    `compiled.ok` is false. `names` has for each kind of object (body, joint, geom, site, camera, light, mesh, ...)
    the names in the order of the arrays' rows.
    """

    compiled: Compiled
    arrays: Mapping[str, numpy.ndarray]

    @property
    def names(self) -> Mapping[str, tuple[str, ...]]:
        return self.compiled.names or {}


class Called(Struct):
    """The result of a function in the child, whose exception is an `error`; `value` is JSON data, if `ok`."""

    ok: bool
    value: Any = None
    error: str | None = None
    crash: str | None = None
    warnings: tuple[str, ...] = ()


_BOUND = re.compile(r"(?P<operator>==|~=|<=|<)\s*(?P<version>[\d.]+)")


def _too_old(version: str) -> str:
    """Return a message about an installed MuJoCo, and which packages of the environment do not allow a newer one."""
    from importlib import metadata  # slow to import, and only this error needs it

    message = f"mjcompose builds with MuJoCo {OLDEST} or newer; MuJoCo {version} can only load models"
    for distribution in metadata.distributions():
        for requirement in distribution.requires or ():
            wanted = requirement.partition(";")[0]
            is_mujoco = re.match(r"mujoco(?![\w.-])", wanted)
            if is_mujoco and any(_excludes(bound["operator"], bound["version"]) for bound in _BOUND.finditer(wanted)):
                message += f"; `{distribution.name} {distribution.version}` requires `{wanted.strip()}`"
    return message


def _excludes(operator: str, version: str) -> bool:
    """Return whether a bound of a requirement allows neither OLDEST nor anything newer.

    >>> _excludes("~=", "3.9.0"), _excludes("~=", "3.9"), _excludes("<", "4"), _excludes("==", "3.9.*")
    (True, False, False, True)
    """
    bound = version_key(version.strip("."))
    if operator == "~=":  # `~=3.9.0` is `<3.10`, `~=3.9` is `<4`
        return (*bound[:-2], bound[-2] + 1) <= version_key(OLDEST)
    return bound <= version_key(OLDEST) if operator == "<" else bound < version_key(OLDEST)


STARTUP_SECONDS = 120.0
OLDEST = "3.11.0"
"""Older versions of MuJoCo lack features that are used here; bundles can still be loaded with them."""
_LAST_WORDS = 4096


class Session:
    """Runs MuJoCo in a child process, which starts with the first request and again after a crash.

    Use it as a context manager, from one thread at a time. Nothing in the child reaches the caller except the answer:
    no exception, no output, no file. `rendering` lets the child use OpenGL. A session that `remembers` repeatedly gets
    almost the same model, so it has a persistent folder.
    """

    def __init__(
        self, limits: RequestLimits | None = None, *, rendering: bool = False, remembers: bool = False
    ) -> None:
        self.limits = limits or RequestLimits()
        self.rendering = rendering
        self.remembers = remembers
        self.no_opengl: str | None = None
        """MuJoCo's error if it could not be imported with OpenGL; it then works without."""
        self.mujoco_version: str | None = None
        self._process: Process | None = None
        self._is_greeted = self._is_over = False
        self._lines: queue.Queue[str | None] = queue.Queue()
        self._folder: Path | None = None
        self._shelf: Path | None = None
        self._held = contextlib.ExitStack()
        self._count = 0
        self._index: str | None = None

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def begin(self) -> None:
        """Start the child process without waiting for it: it imports MuJoCo in parallel."""
        if self._process is None:
            with contextlib.suppress(OSError, ValueError):  # the first request reports it
                self._spawn()

    def ask(self, request: CompileRequest) -> tuple[dict[str, Any], Path]:
        """Return the child's answer or a failure, and the file of its arrays if there is one."""
        answer = self._start()
        arrays_file = (self._folder or Path()) / f"arrays-{self._count}.npz"
        self._count += 1
        if answer is None:
            answer = self._exchange(request.to_json(arrays_file, self.limits.step), self.limits.seconds)
        if "index" in answer:  # None for the same as before
            self._index = answer["index"] = answer["index"] or self._index
        return answer, arrays_file

    def call(self, function: Callable[..., Any], models: Sequence[str], argument: Any) -> dict[str, Any]:
        """Run `function(mujoco, *models, argument)` in the child, on mjModels that requests kept by name.

        `function` is defined at the top of a module; `argument` and its result are JSON data. It is for anything
        that needs the compiled model itself, such as simulating it. The kept models are lost with a crash.
        """
        name = f"{function.__module__}:{function.__qualname__}"
        line = json.dumps({"function": name, "models": list(models), "argument": argument}, ensure_ascii=False)
        return self._start() or self._exchange(line, self.limits.seconds)

    def standing(self, name: str) -> Path:
        """Return the folder for files that `name` identifies by their bytes. Remove the folders of other names.

        Raises OSError. Their paths contain the name, and MuJoCo identifies files by path. The folder does not exist
        until it has files.
        """
        if self._shelf is None:
            self._shelf = self._held.enter_context(scratch("standing"))
        for other in self._shelf.iterdir():
            if other.name != name:
                shutil.rmtree(other, ignore_errors=True)
        return self._shelf / name

    def close(self) -> None:
        """End the child process and remove its folder."""
        self._stop()
        self._folder = self._shelf = None
        self._held.close()

    def end(self) -> None:
        """Kill the child process, from any thread: callers that wait for it get a failure, and so do later callers."""
        self._is_over = True
        process = self._process
        if process is not None:
            process.end()

    def _start(self) -> dict[str, Any] | None:
        """Return None if a child is ready, otherwise the answer with the reason."""
        if self._is_over:
            return _failure("MuJoCo was stopped", "stopped")
        if self._process is not None and self._is_greeted:
            return None
        try:
            if self._process is None:
                self._spawn()
        except (OSError, ValueError) as error:
            return _failure(f"cannot start a process for MuJoCo: {error}", "start")
        hello = self._receive(STARTUP_SECONDS)
        self._is_greeted = hello is not None
        if hello is None:
            return self._crashed()
        if "missing" in hello:
            self._stop()
            if self.rendering and self.no_opengl is None:
                self.no_opengl = hello["missing"]
                return self._start()
            return _failure(f"MuJoCo cannot be imported in {sys.executable}: {hello['missing']}", "missing")
        if version_key(hello["mujoco"]) < version_key(OLDEST):
            self._stop()
            return _failure(_too_old(hello["mujoco"]), "missing")
        self.mujoco_version = hello["mujoco"]
        return None

    def _spawn(self) -> None:
        if self._folder is None:
            why = untrusted(tempfile.gettempdir(), is_temporary=True)
            if why is not None:
                raise OSError(f"the folder for temporary files, `{tempfile.gettempdir()}`, is not trusted: {why}")
            self._folder = self._held.enter_context(scratch("engine"))
        work = self._folder / f"work-{self._count}"
        work.mkdir(exist_ok=True)
        # Threads of linear algebra would only count against the memory limit.
        environment = {**os.environ, "MUJOCO_GL": self._graphics(), "OPENBLAS_NUM_THREADS": "1"}
        if not sys.executable:
            raise ValueError("this Python does not know its own executable")
        with (self._folder / "log").open("wb") as log:
            # File names are bytes: the child's are UTF-8 in every locale.
            self._process = Process(
                isolated(sys.executable, ["-X", "utf8", str(Path(__file__).with_name("child.py"))]),
                folder=WorkFolder(work, "MuJoCo writes its log there"),
                watches=True,
                stdin=PIPE,
                stdout=PIPE,
                stderr=log,
                env=environment,
                encoding="utf-8",
                errors="surrogateescape",
            )
        self._lines = queue.Queue()
        assert self._process.stdout is not None
        threading.Thread(target=_forward_lines, args=(self._process.stdout, self._lines), daemon=True).start()
        self._is_greeted = False
        settings = {"path": module_path(), "seconds": self.limits.seconds, "memory": self.limits.memory}
        with contextlib.suppress(OSError):  # a child that has ended gives no answer, which is reported
            self._send(json.dumps(settings))

    def _graphics(self) -> str:
        """Return MuJoCo's graphics backend: none, the user's choice, or a backend that needs no display."""
        if not self.rendering or self.no_opengl is not None:
            return "disable"
        return os.environ.get("MUJOCO_GL") or ("egl" if sys.platform == "linux" else "glfw")

    def _exchange(self, line: str, seconds: float) -> dict[str, Any]:
        try:
            self._send(line)
        except OSError:
            return self._crashed()
        except BaseException:
            self.close()  # interrupted: the line may or may not be sent
            raise
        answer = self._receive(seconds)
        return self._crashed() if answer is None else answer

    def _send(self, line: str) -> None:
        process = self._process
        if process is None or process.stdin is None or process.stdin.closed:  # ended by another thread
            raise BrokenPipeError
        process.stdin.write(line + "\n")
        process.stdin.flush()

    def _receive(self, seconds: float) -> dict[str, Any] | None:
        """Wait for one line; return None if the child ended. A child that takes too long is killed."""
        latest = time.monotonic() + seconds
        try:
            received = self._lines.get(timeout=min(seconds, threading.TIMEOUT_MAX))
            if received is not None and time.monotonic() > latest:
                raise queue.Empty  # a late answer is too late, however this process was scheduled
        except queue.Empty:
            self._stop()
            return _failure(f"MuJoCo did not finish within {seconds:g} s", "timeout")
        except BaseException:
            self.close()  # interrupted: the child may be in the middle of anything
            raise
        if received is None:
            return None
        answer: dict[str, Any] = json.loads(received)
        if answer.get("crash") == "memory":
            self._stop()  # the next request starts with a fresh process
            return self._out_of_memory(answer["error"])
        return answer

    def _crashed(self) -> dict[str, Any]:
        process = self._process
        folder = self._folder
        if self._is_over or process is None or folder is None:  # ended by another thread
            return _failure("MuJoCo was stopped", "stopped")
        status = process.wait()
        self._stop()
        words = _last_words(folder / "log")
        if "bad_alloc" in words or "MemoryError" in words:
            return self._out_of_memory(words)
        number = -status
        if number <= 0:
            return _failure(f"MuJoCo's process ended with status {status}{_quoted(words)}", f"exit {status}")
        if number == getattr(signal, "SIGXCPU", None):
            return _failure("MuJoCo used up its processor time", "timeout")
        if number == getattr(signal, "SIGPROF", None):
            return _failure(f"MuJoCo needs more than {self.limits.step:g} s for the first step of the model", "timeout")
        name = next((f" ({entry.name})" for entry in signal.Signals if entry == number), "")
        return _failure(f"MuJoCo crashed with signal {number}{name}{_quoted(words)}", f"signal {number}")

    def _out_of_memory(self, words: str) -> dict[str, Any]:
        allowed = f"{self.limits.memory / GIB:.3g} GiB"
        return _failure(f"MuJoCo needs more than the {allowed} of memory that it may use{_quoted(words)}", "memory")

    def _stop(self) -> None:
        process = self._process
        self._process = None
        if process is None:
            return
        process.end()
        for pipe in filter(None, (process.stdin, process.stdout)):
            with contextlib.suppress(OSError):  # a request that is not sent yet has no receiver any more
                pipe.close()


def _failure(error: str, crash: str) -> dict[str, Any]:
    return {"ok": False, "error": error, "crash": crash}


def _last_words(log: Path) -> str:
    with log.open("rb") as file:
        file.seek(max(0, file.seek(0, os.SEEK_END) - _LAST_WORDS))
        return file.read().decode("utf-8", "replace")


def _quoted(words: str) -> str:
    lines = words.strip().splitlines()
    return f": {lines[-1].strip()[:200]}" if lines else ""


def _forward_lines(pipe: IO[str], lines: queue.Queue[str | None]) -> None:
    """Move lines from the pipe to the queue, then None. Runs in a thread, because pipes have no timeouts."""
    with contextlib.suppress(OSError, ValueError):  # closed from this side
        for line in pipe:
            lines.put(line)
    lines.put(None)


def compile(
    folder: Path,
    model: str = "model.xml",
    *,
    wants: tuple[str, ...] = (),
    mjb: Path | None = None,
    text: str | None = None,
    keep: str | None = None,
    folder_is_reused: bool = False,
    limits: RequestLimits | None = None,
    session: Session | None = None,
) -> Compiled:
    """Compile `folder/model`, run one mj_forward, and write an MJB to `mjb` if that is given.

    Never raises for faults of the model. `limits` apply only without a `session`, which has its own.
    """
    wants = (*wants, "forward")
    request = CompileRequest(folder, model, wants, mjb=mjb, text=text, keep=keep, folder_is_reused=folder_is_reused)
    return _run(request, limits, session).compiled


def measure(
    folder: Path,
    model: str = "model.xml",
    arrays: tuple[str, ...] = (),
    *,
    text: str | None = None,
    limits: RequestLimits | None = None,
    session: Session | None = None,
) -> Measured:
    """Compile `folder/model` and return arrays of mjModel (or `data.NAME` of mjData) with all names.

    Units and shapes are MuJoCo's own: radians, meters, one row per object.
    """
    return _run(CompileRequest(folder, model, wants=("names",), arrays=arrays, text=text), limits, session)


def call(session: Session, function: Callable[..., Any], models: Sequence[str], argument: Any) -> Called:
    """Run `function(mujoco, *models, argument)` in the session's child on models kept there by name."""
    answer = session.call(function, models, argument)
    known = {name: answer[name] for name in ("ok", "value", "error", "crash") if name in answer}
    return Called(**known, warnings=_distinct(answer.get("warnings", ())))


def _run(request: CompileRequest, limits: RequestLimits | None, session: Session | None) -> Measured:
    if session is None:
        with Session(limits) as own:
            return _run(request, None, own)
    answer, arrays_file = session.ask(request)
    arrays = _load_arrays(arrays_file) if answer.get("arrays") else {}
    return Measured(_compiled(answer, request, session.mujoco_version), arrays)


def _compiled(answer: dict[str, Any], request: CompileRequest, version: str | None) -> Compiled:
    names = answer.get("names")
    said = [answer.get("error"), answer.get("forward")]
    error, forward = (text and without_folder(text, request.folder) for text in said)
    return Compiled(
        ok=answer["ok"],
        error=error,
        crash=answer.get("crash"),
        warnings=_distinct(without_folder(text, request.folder) for text in answer.get("warnings", ())),
        mujoco_version=version,
        sizes=answer.get("sizes", {}),
        forward=forward,
        index=_index(answer["index"]) if "index" in answer else None,
        names=None if names is None else {kind: tuple(found) for kind, found in names.items()},
    )


@lru_cache(maxsize=4)
def _index(text: str) -> CompiledIndex:
    """Return the index for its JSON text. Samples of a model have the same index, which is read once."""
    from mjcompose.mujoco.index import CompiledIndex

    return CompiledIndex.from_data(json.loads(text))


def without_folder(text: str, folder: Path) -> str:
    """Return `text` with paths below `folder` made relative to it, because the folder is not the reader's."""
    for form in (str(folder.absolute()), os.path.realpath(folder)):
        text = text.replace(form.rstrip("/\\") + "/", "").replace(form.rstrip("/\\") + "\\", "")
    return text


def _distinct(warnings: Iterable[str]) -> tuple[str, ...]:
    """Return each warning once, in order; MuJoCo also logs the first line of some warnings that it reports in full."""
    found = list(dict.fromkeys(text.strip() for text in warnings if text.strip()))
    return tuple(text for text in found if not any(other.startswith(text + "\n") for other in found))


def _load_arrays(path: Path) -> dict[str, numpy.ndarray]:
    import numpy

    with numpy.load(path, allow_pickle=False) as stored:
        arrays = {name: stored[name] for name in stored.files}
    path.unlink()
    return arrays
