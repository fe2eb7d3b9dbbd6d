"""Write a bundle as USD, with the converter of the extra `usd`."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path

from composer import engine
from composer.bundle.bundle import Bundle
from composer.bundle.output_error import OutputError, unwritable
from composer.bundle.staging import staged_file, write_files
from composer.bundle.timestamp import moment_of, with_moment
from composer.scratch import scratch


def write_usd(
    bundle: Bundle,
    out: Path,
    environment: Mapping[str, str],
    warn: Callable[[str], None],
    *,
    limits: engine.Limits | None = None,
    session: engine.Session | None = None,
) -> None:
    """Write the model as USD: one layer (`.usd`, `.usda`, `.usdc`), or a package with its textures (`.usdz`).

    `warn` receives the converter's warnings, such as elements that USD cannot represent. The same model gives the
    same bytes; files of a package are dated SOURCE_DATE_EPOCH as in an archive. Raises OutputError, and then leaves
    an older `out` untouched.
    """
    if session is None:
        with engine.Session(limits) as own:
            write_usd(bundle, out, environment, warn=warn, session=own)
            return
    from composer.engine.usd import export_usd

    moment = moment_of(environment)
    with staged_file(out) as stage:
        try:
            with scratch("bundle") as folder:
                write_files(bundle, Path(folder))
                target = Path(folder) / f"usd-output{out.suffix.lower()}"
                exported = export_usd(Path(folder) / bundle.model, target, session)
                if os.path.isfile(target):
                    content = target.read_bytes()
                    stage.write_bytes(with_moment(content, moment) if target.suffix == ".usdz" else content)
        except OSError as error:
            raise unwritable("a temporary folder", error) from error
        if exported.missing is not None:
            raise OutputError(
                "usd-missing",
                f"writing `{out.name}` needs the Python package `mujoco-usd-converter`: {exported.missing}",
                'run `pip install "mjcompose[usd]"` in an environment with Python 3.12 or older',
            )
        if exported.error is not None:
            raise OutputError(
                "output-unwritable", f"cannot write `{out}`: {' '.join(exported.error.split())}"
            )
        if exported.textures:
            raise OutputError(
                "output-kind",
                f"one USD layer cannot hold the {len(exported.textures)} textures of the model,"
                f" such as `{exported.textures[0]}`",
                f"write a package, which holds them: `{out.with_suffix('.usdz')}`",
            )
    for warning in exported.warnings:
        warn(warning)
