"""The child process: MuJoCo with limits, separate from the user's process and folder.

Run as a script by `engine.py`. It reads one JSON object on each line of standard input, first its settings, then
requests, and answers each request with one line on its original standard output. MuJoCo's own prints cannot interfere:
file descriptor 1 is redirected to the log before MuJoCo is imported. The working directory is a new folder that the
parent removes.

MuJoCo's warnings come from the log file that it writes there, not from a Python callback: threads of the mesh
compiler raise some of them while the main thread holds the interpreter lock.
"""

from __future__ import annotations

import contextlib
import importlib
import json
import os
import re
import signal
import sys
import traceback
import warnings
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

LOG_FILE = "MUJOCO_LOG.TXT"  # MuJoCo 4.0 writes its warnings into it, in the working directory
_LOG_HEAD = re.compile(r"^(?:WARNING|ERROR) \w{3} \w{3} [ \d]\d \d\d:\d\d:\d\d \d{4}: ", re.MULTILINE)
_REMEMBERED = 256 << 20
# how pybind11, C++ and MuJoCo's compiler report a failed allocation
_NO_MEMORY = ("Caught an unknown exception", "bad_alloc", "ould not allocate")


def main() -> None:
    answers = os.fdopen(os.dup(1), "w", encoding="ascii", buffering=1)
    os.dup2(2, 1)
    settings = json.loads(sys.stdin.readline())
    sys.path[:] = settings["path"]
    if os.name == "posix":  # before MuJoCo is imported, which starts threads
        from mjcompose.base.guard import end_with

        end_with(*map(int, sys.argv[1:]))
    # Without core dumps; with limits for data and, where only that is counted, for address space.
    for limit, value in (
        ("RLIMIT_CORE", 0),
        ("RLIMIT_DATA", settings["memory"]),
        ("RLIMIT_AS", 2 * settings["memory"]),
    ):
        _set_soft_limit(limit, value)
    try:
        import mujoco
    except Exception as error:  # any exception of a broken installation becomes the answer
        _say(answers, {"missing": f"{type(error).__name__}: {error}" if str(error) else type(error).__name__})
        return
    _say(answers, {"mujoco": mujoco.__version__})
    log_read = 0
    index = None
    kept: dict[str, Any] = {}
    for line in sys.stdin:
        _set_cpu_limit(settings["seconds"])
        request = json.loads(line)
        with warnings.catch_warnings(record=True) as python_warnings:
            warnings.simplefilter("always", UserWarning)
            answer = (_call if "function" in request else _compile)(request, mujoco, kept)
        logged, log_read = _read_log(log_read)
        answer["warnings"] = [str(entry.message) for entry in python_warnings] + logged
        if answer.get("index") is not None:  # the parent keeps it, and gets None for the same one
            same = answer["index"] == index
            index = answer["index"]
            answer["index"] = None if same else index
        _say(answers, answer)


def _compile(request: dict[str, Any], mujoco: Any, kept: dict[str, Any]) -> dict[str, Any]:
    answer: dict[str, Any] = {"ok": False, "crash": None}
    try:
        with _remembering(mujoco, request["folder_is_reused"]):
            model = _compiled_there(request, mujoco) if request["mjb"] else _spec(request, mujoco).compile()
        if request["keep"] is not None:
            kept[request["keep"]] = model
        return answer | _described(request, mujoco, model) | {"ok": True}
    except Exception as error:  # ValueError, RuntimeError, FatalError and pybind11's translations of C++ exceptions
        return answer | _fault(error)


def _compiled_there(request: dict[str, Any], mujoco: Any) -> Any:
    """Compile in the model's own folder: an MJB contains the paths of its assets, which should be relative."""
    log = Path(LOG_FILE).absolute()
    with contextlib.chdir(request["folder"]):
        try:
            return _spec({**request, "folder": ""}, mujoco).compile()
        finally:
            with contextlib.suppress(OSError):
                contents = Path(LOG_FILE).read_bytes()
                Path(LOG_FILE).unlink()
                with log.open("ab") as file:
                    file.write(contents)


def _spec(request: dict[str, Any], mujoco: Any) -> Any:
    path = Path(request["folder"], request["model"])
    try:
        str(path).encode()
    except UnicodeEncodeError:
        raise ValueError("MuJoCo opens only files whose whole path is UTF-8: rename it") from None
    text = request["text"]
    if path.suffix.lower() == ".mjcf":  # MuJoCo 4.0 has no decoder for this name
        text = path.read_text(encoding="utf-8") if text is None else text
        path = path.with_name(f"{path.name}.xml")
    if text is not None:
        return mujoco.MjSpec.from_file(str(path), include={str(path): text.encode()})
    if path.suffix.lower() in {".zip", ".mjz"}:
        return mujoco.MjSpec.from_zip(str(path))
    return mujoco.MjSpec.from_file(str(path))


def _described(request: dict[str, Any], mujoco: Any, model: MjModel) -> dict[str, Any]:
    from mjcompose.mujoco import attributes
    from mjcompose.mujoco.index import index

    wants = request["wants"]
    answer: dict[str, Any] = {"sizes": attributes.sizes(model)}
    if "index" in wants:
        answer["index"] = json.dumps(asdict(index(model, mujoco)))
    if "names" in wants:
        answer["names"] = attributes.all_names(model)
    if request["mjb"]:
        mujoco.mj_saveModel(model, request["mjb"])
        if not os.path.isfile(request["mjb"]):
            raise OSError("the compiled model could not be written")
    data = None
    if "forward" in wants or any(name.startswith("data.") for name in request["arrays"]):
        data, answer["forward"] = _forward(model, mujoco, request["step"])
    if request["arrays"]:
        import numpy

        numpy.savez(request["arrays_file"], **attributes.arrays(request["arrays"], model, data))
        answer["arrays"] = True
    return answer


def _call(request: dict[str, Any], mujoco: Any, kept: dict[str, Any]) -> dict[str, Any]:
    missing = [name for name in request["models"] if name not in kept]
    if missing:
        return {"ok": False, "error": f"no model is kept as `{missing[0]}`", "crash": None}
    module, _, name = request["function"].partition(":")
    try:
        function = getattr(importlib.import_module(module), name)
        value = function(mujoco, *(kept[name] for name in request["models"]), request["argument"])
        return {"ok": True, "value": json.loads(json.dumps(value))}
    except Exception as error:
        traceback.print_exc()
        fault = _fault(error)
        return {"ok": False} | fault | {"error": f"{type(error).__name__}: {fault['error']}"}


@contextlib.contextmanager
def _computing(seconds: float) -> Iterator[None]:
    """Let the system end this process if the block computes for longer; nothing else interrupts MuJoCo."""
    if not hasattr(signal, "setitimer"):
        yield
        return
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


def _forward(model: MjModel, mujoco: Any, seconds: float) -> tuple[Any, str | None]:
    """Run mj_forward at the reference configuration; return the data, and the error if there is one."""
    import numpy

    data = None
    try:
        data = mujoco.MjData(model)
        with _computing(seconds):
            mujoco.mj_forward(model, data)
    except Exception as error:
        return data, str(error).strip() or type(error).__name__
    for name in ("xpos", "xquat", "qacc"):
        if not numpy.isfinite(getattr(data, name)).all():
            return data, f"`{name}` is not finite"
    return data, None


def _fault(error: Exception) -> dict[str, Any]:
    text = str(error).strip() or type(error).__name__
    short = isinstance(error, MemoryError) or any(sign in text for sign in _NO_MEMORY)
    return {"error": text, "crash": "memory" if short else None}


def _set_cpu_limit(seconds: float) -> None:
    """Limit processor time, as a backstop for a child without a parent: all cores busy for a whole request."""
    try:
        import resource
    except ImportError:
        return
    usage = resource.getrusage(resource.RUSAGE_SELF)
    allowance = min((seconds + 5) * (os.cpu_count() or 1), 1e9)
    _set_soft_limit("RLIMIT_CPU", int(usage.ru_utime + usage.ru_stime + allowance) + 1)


def _set_soft_limit(name: str, value: int) -> None:
    try:
        import resource

        kind: int = getattr(resource, name)
    except (ImportError, AttributeError):  # a system without this limit
        return
    hard = resource.getrlimit(kind)[1]
    if hard != resource.RLIM_INFINITY:
        value = min(value, hard)
    with contextlib.suppress(OSError, ValueError):
        resource.setrlimit(kind, (value, hard))


@contextlib.contextmanager
def _remembering(mujoco: Any, folder_is_reused: bool) -> Iterator[None]:
    """Let MuJoCo read and compile each asset once, and keep the assets of a persistent folder for its next model.

    It identifies files by path and time, which files of other folders may share. So the cache is
    emptied before and after the model of another folder: without capacity it has nothing.
    """
    if not folder_is_reused:
        _set_cache(mujoco, 0)
    _set_cache(mujoco, _REMEMBERED)
    try:
        yield
    finally:
        if not folder_is_reused:
            _set_cache(mujoco, 0)


def _set_cache(mujoco: Any, capacity: int) -> None:
    with contextlib.suppress(AttributeError, TypeError):  # a version without a cache, or without access to it
        mujoco.mj_setCacheCapacity(mujoco.mj_getCache(), capacity)


def _read_log(start: int) -> tuple[list[str], int]:
    try:
        with Path(LOG_FILE).open("rb") as file:
            file.seek(start)
            content = file.read()
    except OSError:
        return [], start
    messages = _LOG_HEAD.split(content.decode("utf-8", "replace"))
    return [message.strip() for message in messages if message.strip()], start + len(content)


def _say(answers: TextIO, answer: dict[str, Any]) -> None:
    answers.write(json.dumps(answer) + "\n")
    answers.flush()


if __name__ == "__main__":
    main()
