"""Whether a bundle compiles in MuJoCo, and what MuJoCo says where it does not."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

from composer import engine
from composer.bundle.bundle import Bundle
from composer.bundle.output_error import unwritable
from composer.bundle.staging import write_files
from composer.mujoco_errors.message import CRASHES, Fault, parse


@dataclass(frozen=True, slots=True)
class Verified:
    """What MuJoCo said about a bundle; `compiled` has the sizes and the index.

    `error` is why the model was refused. `crash` is set when MuJoCo gave no verdict (see `engine.Compiled`);
    `error` is then a sentence about that. `code` is the diagnostic's code for `error`.
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
        """The code of the diagnostic that tells `error`; None when all is well."""
        if self.error is None:
            return None
        if self.crash is None:
            return "mujoco-rejects"
        return CRASHES.get(self.crash, "mujoco-crash")


def verify(
    bundle: Bundle,
    *,
    limits: engine.Limits | None = None,
    session: engine.Session | None = None,
    keep: str | None = None,
) -> Verified:
    """Compile the bundle as a user would, from a folder of its own, and run one mj_forward.

    A model that compiles and whose first forward step fails is not well: that is an error too. With a
    `session`, `keep` names the compiled model for what is run on it later. Raises OutputError when the bundle
    cannot be put into a temporary folder.
    """
    try:
        with tempfile.TemporaryDirectory(prefix="mjcompose-", ignore_cleanup_errors=True) as name:
            write_files(bundle, Path(name))
            compiled = engine.compile(
                Path(name), bundle.model, wants=("index",), keep=keep, limits=limits, session=session
            )
    except OSError as error:
        raise unwritable("a temporary folder", error) from error
    warnings = tuple(parse(text) for text in compiled.warnings)
    if compiled.crash is not None:
        return Verified(compiled, Fault(compiled.error or compiled.crash), compiled.crash, warnings)
    if compiled.error is not None:
        return Verified(compiled, parse(compiled.error), None, warnings)
    if compiled.forward is not None:
        fault = Fault(f"the model compiles, but its first forward step fails: {compiled.forward}")
        return Verified(compiled, fault, None, warnings)
    return Verified(compiled, None, None, warnings)
