"""The check `targets`: write models for other programs, which read them back."""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from lxml import etree

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Fault, Note
from mjcompose.base.extensions import check_rows
from mjcompose.base.limits import in_force
from mjcompose.base.processes import DEVNULL, PIPE, Overrun, Process, WorkFolder, isolated
from mjcompose.base.scratch import scratch
from mjcompose.bundle.bundle import Bundle
from mjcompose.language.checks.targets import Targets
from mjcompose.language.target_names import CONSUMERS, READ_IN
from mjcompose.mujoco import engine
from mjcompose.targets.export import exported
from mjcompose.targets.judge import MotionQuestion, ReadingQuestion, asked_of, judged, motion_of, without_lost
from mjcompose.targets.readers.shared import facts as facts_module
from mjcompose.targets.table import TARGETS
from mjcompose.targets.target import Loss, grouped, in_words

_READERS = Path(__file__).with_name("readers")
_INTERPRETER = "Scripts/python.exe" if os.name == "nt" else "bin/python"
_ASK = "import importlib.util, sys; sys.exit(importlib.util.find_spec(sys.argv[1]) is None)"
_ANSWERING = 60.0
"""The seconds in which a Python says whether it has a module."""
_LAST_WORDS = 400
_MOST_FACTS = 256 << 20
_LARGEST = 4 << 30
"""The most bytes of a file that a program writes while it reads a model: Warp and JAX compile kernels."""
_RAISED = re.compile(r"[\w.]+(Error|Exception|Exit)\b")


class ReaderProgram(Struct):
    """A program that reads models back.

    `program` is both the file in `readers/` and the folder of its environment. Python imports `module`, and pip
    installs `packages`. A program that computes in `single` precision gets a larger tolerance.
    """

    target: str
    program: str
    module: str
    packages: tuple[str, ...]
    single: bool = False


READERS: Mapping[str, ReaderProgram] = {
    each.target: each
    for each in (
        ReaderProgram("drake", "drake", "pydrake", packages=("drake",)),
        ReaderProgram("pinocchio", "pinocchio", "pinocchio", packages=("pin",)),
        ReaderProgram("pybullet", "pybullet", "pybullet", packages=("numpy", "pybullet"), single=True),
        ReaderProgram(
            "newton", "newton", "newton", packages=("newton", "trimesh", "scipy", "mujoco", "mujoco-warp"),
            single=True,
        ),
        ReaderProgram("genesis", "genesis", "genesis", packages=("torch", "genesis-world")),
        ReaderProgram("mjx", "mjx", "mujoco.mjx", packages=("mujoco-mjx",)),
        ReaderProgram("warp", "warp", "mujoco_warp", packages=("mujoco-warp",), single=True),
        ReaderProgram("urdf", "pinocchio", "pinocchio", packages=("pin",)),
    )
}  # fmt: skip
"""By the name of the target that it reads."""

check_rows("the programs of composer/mjcompose/targets/read_back.py", READERS, READ_IN)
check_rows("the targets that they read", [name for name in TARGETS if name in READERS], READERS)


def interpreter(reader: ReaderProgram, environment: Mapping[str, str]) -> str | None:
    """Return the Python that can import a program: its environment's, or the current one; None without either."""
    folder = environment.get(CONSUMERS, "")
    # A relative folder would be in whatever folder you type the command.
    named = Path(folder, reader.program, _INTERPRETER) if os.path.isabs(folder) else None
    for python in (named, Path(sys.executable)):
        if python is not None and os.path.isfile(python):
            question = isolated(str(python), ["-c", _ASK, reader.module])
            with suppress(OSError, Overrun), Process(question, stdout=DEVNULL, stderr=DEVNULL) as process:
                process.finish(seconds=_ANSWERING, most=0)
                if process.returncode == 0:
                    return str(python)
    return None


def read_back(reader: ReaderProgram, python: str, model: Path, questions: dict[str, Any]) -> dict[str, Any] | str:
    """Return the facts of a model as the program reads it, or an error message.

    The facts are as in `judge.py`: numbers by name, the count of shapes, poses, and the end of a motion. Files are
    written next to the folder of the model.
    """
    asked = model.parent.with_suffix(".poses.json")
    out = model.parent.with_suffix(".facts.json")
    asked.write_text(json.dumps(questions), encoding="utf-8")
    program = _READERS / f"{reader.program}.py"
    command = isolated(python, [facts_module.__file__, str(program), str(model), str(asked), str(out)])
    seconds = in_force().time
    folder = WorkFolder(model.parent.parent, "a folder of ours, into which programs write their files")
    with Process(command, stdout=DEVNULL, stderr=PIPE, folder=folder, size=_LARGEST) as process:
        try:
            _, said = process.finish(seconds=seconds, most=0)
        except Overrun:
            return f"it took longer than {seconds:g} seconds"
    if process.returncode or not os.path.isfile(out):
        lines: list[str] = [line for line in said.decode("utf-8", "replace").splitlines() if line.strip(" -")]
        raised = [line for line in lines if _RAISED.match(line)]  # JAX and Genesis write more after it
        return (raised or lines or [f"it ended with the code {process.returncode}"])[-1][:_LAST_WORDS]
    with out.open("rb") as stream:
        content = stream.read(_MOST_FACTS + 1)
    if len(content) > _MOST_FACTS:
        return f"it wrote more than {_MOST_FACTS >> 20} MiB of facts"
    facts: dict[str, Any] = json.loads(content)
    return facts


_FAILED = "check-failed"
_MISSING = "consumer-missing"
_SHOWN = 8
_POSES = 50
LOSS = "target-loss"


class Work(Struct):
    """A bundle that MuJoCo has compiled. The session keeps its model under the name `whole`."""

    bundle: Bundle
    whole: str
    session: engine.Session
    environment: Mapping[str, str]


def carry_out(work: Work, check: Targets) -> tuple[Sequence[Fault], dict[str, Any]]:
    """Return a finding for each target that lacks something of the model, cannot read it, or reads a different model.

    The values are the number of losses or the version of the program, by target.
    """
    findings: list[Fault] = []
    values: dict[str, Any] = {}
    questions: dict[str, Any] = {}
    if check.read:
        answer = engine.call(work.session, asked_of, [work.whole], argument=_POSES)
        if not answer.ok:
            return [Fault(_FAILED, f"MuJoCo does not move the model: {answer.error or answer.crash}")], values
        questions = answer.value
    for index, name in enumerate(check.targets):
        at = ("in", index)
        with scratch("target") as folder:
            each, value = _about(work, name, folder, check, questions)
        findings += [replace(fault, at=at) for fault in each]
        values |= {} if value is None else {name: value}
    return findings, values


def _about(work: Work, name: str, folder: Path, check: Targets, questions: dict[str, Any]) -> tuple[list[Fault], Any]:
    """Return the findings for one target, and its number of losses or the version of the program."""
    reader = READERS[name] if check.read else None
    python = None if reader is None else interpreter(reader, work.environment)
    if reader is not None and python is None:
        return [_missing(name, reader, work.environment)], None
    written = _written(work, name, folder)
    if isinstance(written, Fault):
        return [written], None
    losses = [Loss(**loss) for loss in written["losses"]]
    lacked = [loss for loss in losses if not loss.otherwise]
    if lacked and check.losses == "error":
        return [_lacking(name, lacked)], len(lacked)
    faults = _reported(name, lacked)
    if reader is None or python is None:
        return faults, len(lacked)
    questions = without_lost(questions, losses)
    facts = _facts(reader, python, placed(folder / "out", written["model"]), lacked=lacked, questions=questions)
    if isinstance(facts, str):
        return [Fault(_FAILED, f"`{name}` does not read the model: {facts}")], None
    version = str(facts["version"])
    question = ReadingQuestion(facts, questions, reader.single, losses)
    answer = engine.call(work.session, judged, [work.whole], argument=asdict(question))
    wrong = list(answer.value) if answer.ok else [str(answer.error or answer.crash)]
    if wrong:
        faults.insert(0, _reading_differently(name, version, wrong))
    return faults, version


def _facts(
    reader: ReaderProgram, python: str, model: Path, lacked: Sequence[Loss], questions: dict[str, Any]
) -> dict[str, Any] | str:
    """Return the facts of the model in the program, or why it does not read the model."""
    refused = next((loss for loss in lacked if loss.refused), None)
    if refused is not None:
        return f"{refused.shown}: {refused.why}"
    return read_back(reader, python, model, questions=questions)


def _written(work: Work, name: str, folder: Path) -> dict[str, Any] | Fault:
    """Return the export of the model for a target."""
    written = exported(work.bundle, name, folder, session=work.session)
    if isinstance(written, str):
        reason = written
    elif written["differences"]:
        reason = f"MuJoCo reads the plain text of the model back as a different model: {written['differences'][0]}"
    else:
        return written
    return Fault(_FAILED, f"the model cannot be written for `{name}`: {reason}")


def _reported(name: str, lacked: Sequence[Loss]) -> list[Fault]:
    """Return a fault with all that a target lacks; none if it lacks nothing."""
    if not lacked:
        return []
    first, *others = _sentences(name, lacked)
    return [Fault(LOSS, first, notes=(Note("\n".join(others)),) if others else ())]


def _reading_differently(name: str, version: str, wrong: Sequence[str]) -> Fault:
    notes = ["expected: the numbers, poses and motion of MuJoCo", f"actual: {len(wrong)} that differ"]
    notes += wrong[1:_SHOWN]
    if len(wrong) > _SHOWN:
        notes.append(f"and {len(wrong) - _SHOWN} more")
    message = f"`{name}` {version} reads another model: {wrong[0]}"
    return Fault(_FAILED, message, notes=tuple(map(Note, notes)))


def motion_in(work: Work, name: str, seconds: float) -> tuple[dict[str, float], dict[str, float]] | Fault:
    """Return the joint positions after a motion without forces, in MuJoCo and in another program; or a finding."""
    python = interpreter(READERS[name], work.environment)
    if python is None:
        return _missing(name, READERS[name], work.environment)
    answer = engine.call(work.session, asked_of, [work.whole], argument=0)
    with scratch("motion") as folder:
        written = exported(work.bundle, name, folder, session=work.session)
        if not answer.ok or isinstance(written, str):
            return Fault(_FAILED, f"`{name}` gets no model: {answer.error if not answer.ok else written}")
        questions = {**answer.value, "seconds": seconds, "drives": {}}
        facts = read_back(READERS[name], python, placed(folder / "out", written["model"]), questions=questions)
    if isinstance(facts, str):
        return Fault(_FAILED, f"`{name}` does not read the model: {facts}")
    losses = [Loss(**loss) for loss in written["losses"]]
    question = MotionQuestion(questions, losses, facts.get("without", []))
    answer = engine.call(work.session, motion_of, [work.whole], argument=asdict(question))
    if not answer.ok:
        return Fault(_FAILED, f"MuJoCo does not move the model: {answer.error or answer.crash}")
    return answer.value, facts.get("motion", {})


def _lacking(name: str, lacked: Sequence[Loss]) -> Fault:
    lines = _sentences(name, lacked)
    several = "s" * (len(lacked) != 1)
    actual = f"actual: it lacks {len(lacked)} thing{several}"
    notes = ["expected: nothing that it lacks", actual, *lines[1:_SHOWN]]
    if len(lines) > _SHOWN:
        notes.append(f"and {len(lines) - _SHOWN} more")
    help = next((each.help for each in lacked if each.help), None)
    message = f"`{name}` does not have all of the model: {lines[0]}"
    return Fault(_FAILED, message, notes=tuple(map(Note, notes)), help=help)


def _missing(name: str, reader: ReaderProgram, environment: Mapping[str, str]) -> Fault:
    message = f"`{name}` is not installed: no Python here has its module `{reader.module}`"
    packages = " ".join(reader.packages)
    help = (
        f"run `pip install {packages}`; or install it into an environment `FOLDER/{reader.program}`,"
        f" and set `{CONSUMERS}` to FOLDER"
    )
    folder = environment.get(CONSUMERS, "")
    is_ignored = folder and not os.path.isabs(folder)
    notes = (Note(f"`{CONSUMERS}` is `{folder}`, which is not an absolute path"),) if is_ignored else ()
    return Fault(_MISSING, message, notes=notes, help=help)


def _sentences(name: str, losses: Sequence[Loss]) -> list[str]:
    return [in_words(TARGETS[name].title, group) for group in grouped(losses)]


def placed(folder: Path, model: str) -> Path:
    """Return the path of a model after its folder is moved to where the program looks for it.

    A ROS package must be in a folder with the name of the package.
    """
    about = folder / "package.xml"
    if os.path.isfile(about):
        named = str(etree.parse(about, etree.XMLParser(resolve_entities=False)).findtext("name"))
        folder = folder.rename(folder.with_name(named))
    return folder / model
