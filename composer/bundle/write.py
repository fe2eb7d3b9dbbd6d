"""Write a bundle in the form that the output's name selects."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from os import PathLike
from pathlib import Path

from composer import engine
from composer.bundle.archive import write_archive
from composer.bundle.bundle import Bundle
from composer.bundle.folder import write_folder
from composer.bundle.form import Form, form_of
from composer.bundle.mjb import write_mjb
from composer.bundle.packing import Packing, packed_now
from composer.bundle.text import write_text
from composer.bundle.usd import write_usd


def write(
    bundle: Bundle,
    out: str | PathLike[str],
    *,
    environment: Mapping[str, str],
    limits: engine.Limits | None = None,
    session: engine.Session | None = None,
    packing: Packing = packed_now,
    warn: Callable[[str], None] = lambda _: None,
) -> Form:
    """Write the bundle to `out` in the form for its name, and return the form.

    The output is complete, or OutputError is raised and everything is as before. `environment` may hold
    SOURCE_DATE_EPOCH; `limits` or `session` are for MJB and USD, which need MuJoCo, `packing` for archives; `warn`
    receives what USD cannot represent.
    """
    form = form_of(out)
    path = Path(out)
    match form:
        case Form.FOLDER:
            write_folder(bundle, path)
        case Form.ARCHIVE:
            write_archive(bundle, path, environment, packing=packing)
        case Form.TEXT:
            write_text(bundle, path)
        case Form.MJB:
            write_mjb(bundle, path, limits=limits, session=session)
        case Form.USD:
            write_usd(bundle, path, environment, warn=warn, limits=limits, session=session)
    return form
