"""Compile a bundle in MuJoCo and return what MuJoCo says."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from composer import engine
from composer.bundle.admitted import outside
from composer.bundle.bundle import MANIFEST, Bundle
from composer.bundle.output_error import unwritable
from composer.bundle.staging import write_files
from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Diagnostic
from composer.mujoco_errors.message import CRASHES, Fault, parse
from composer.scratch import scratch

WHOLE = "whole"
"""The name under which the session keeps the composition."""
# Greedy: the match may include what stands between two sections of one name, but it never misses anything.
_OF_FILES = [
    re.compile(rb"<%b\b[^>]*>(?:.*</%b>)?" % (tag, tag), re.DOTALL)
    for tag in (b"asset", b"default", b"compiler")
]
_MATERIAL = re.compile(rb"<material\b[^>]*>")
"""Materials are the assets that are drawn most often, and MuJoCo reads no file for them."""


@dataclass(frozen=True, slots=True)
class Verified:
    """MuJoCo's verdict on a bundle; `compiled` has the sizes and the index.

    `error` says why MuJoCo refused the model. If MuJoCo gave no verdict, `crash` is set (see
    `engine.Compiled`) and `error` describes the crash. `code` is the code of the diagnostic for `error`.
    """

    compiled: engine.Compiled
    error: Fault | None = None
    crash: str | None = None
    warnings: tuple[Fault, ...] = ()

    @property
    def ok(self) -> bool:
        return self.error is None

    @property
    def code(self) -> str | None:
        """The code of the diagnostic that reports `error`; None if there is no error."""
        if self.error is None:
            return None
        if self.crash is None:
            return "mujoco-rejects"
        return CRASHES.get(self.crash, "mujoco-crash")


class StrangerError(Exception):
    """A bundle names files outside of itself; `found` reports each of them."""

    def __init__(self, found: tuple[Diagnostic, ...]) -> None:
        super().__init__(found[0].message)
        self.found = found


def verify(
    bundle: Bundle,
    *,
    limits: engine.Limits | None = None,
    session: engine.Session | None = None,
    keep: str | None = None,
    stranger: str | None = None,
) -> Verified:
    """Compile the bundle in a folder of its own, as a user would, and run one mj_forward.

    If the bundle may come from anyone, `stranger` is its name in messages; it is then compiled only if it
    names no files outside of itself. A failing first forward step is an error too. With a `session`, `keep`
    names the compiled model for later calls. Raises OutputError if the bundle cannot be written to a
    temporary folder, and StrangerError.
    """
    try:
        with _written(bundle, session) as (folder, stands):
            if stranger is not None and (found := outside(folder, bundle.model, stranger)):
                raise StrangerError(found)
            compiled = engine.compile(
                folder,
                bundle.model,
                wants=("index",),
                keep=keep,
                stands=stands,
                limits=limits,
                session=session,
            )
    except OSError as error:
        raise unwritable("a temporary folder", error) from error
    warnings = tuple(parse(text) for text in compiled.warnings)
    if compiled.crash is not None:
        return Verified(compiled, Fault(compiled.error or compiled.crash), compiled.crash, warnings=warnings)
    if compiled.error is not None:
        return Verified(compiled, parse(compiled.error), None, warnings=warnings)
    if compiled.forward is not None:
        fault = Fault(f"the model compiles, but its first forward step fails: {compiled.forward}")
        return Verified(compiled, fault, None, warnings=warnings)
    return Verified(compiled, None, None, warnings=warnings)


@contextmanager
def _written(bundle: Bundle, session: engine.Session | None) -> Iterator[tuple[Path, bool]]:
    """Yield a folder with the bundle, and whether the folder is reused for bundles that differ only in the tree."""
    if session is None or not session.remembers:
        with scratch("bundle") as folder:
            write_files(bundle, folder)
            yield folder, False
        return
    folder = session.standing(_named(bundle))
    if os.path.exists(folder):
        (folder / bundle.model).write_bytes(bundle.files[bundle.model])
    else:
        stage = folder.with_name("stage")
        stage.mkdir()
        write_files(bundle, stage)
        stage.rename(folder)
    yield folder, True


def _named(bundle: Bundle) -> str:
    """Return a hash of the files, their bytes and what the model says of them. No version of MuJoCo uses more."""
    whole = hashlib.sha256(bundle.model.encode())
    for path in bundle.files:
        if path not in (bundle.model, MANIFEST):
            whole.update(f"\0{path}\0{bundle.digest(path)}".encode())
    for section in _OF_FILES:
        whole.update(_MATERIAL.sub(b"", b"\0".join(section.findall(bundle.files[bundle.model]))))
    return whole.hexdigest()
