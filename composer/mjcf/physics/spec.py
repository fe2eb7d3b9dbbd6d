"""Read models from MuJoCo's own `MjSpec`."""

from __future__ import annotations

import posixpath
import warnings
from pathlib import Path
from typing import Any

from composer.compiled.kinds import KINDS
from composer.compiled.rows import arrays
from composer.diagnostics.call_site import call_site
from composer.mjcf.element import RootElement
from composer.mjcf.errors import MjcfWarning, failure
from composer.mjcf.parse import from_xml_string
from composer.mjcf.physics.compile import engine, refused


def from_spec(spec: Any) -> RootElement:
    """Return the model of a `mujoco.MjSpec`, from the XML that MuJoCo writes for it and the files in its `assets`.

    MuJoCo compiles a copy of the spec first. Raises `MjcfError` if it cannot. The origins of elements are lines of the
    XML. Numbers are exactly those of the spec. MuJoCo before 3.16 writes only six digits of each, and so does a later
    version if models with different compiler settings are attached to each other. An `MjcfWarning` is issued in these
    cases, and also if the spec has a NaN, which MuJoCo does not write.

    >>> import mujoco
    >>> spec = mujoco.MjSpec()
    >>> _ = spec.worldbody.add_body(name='arm')
    >>> from_spec(spec).find('body', 'arm')
    <body name="arm"/>
    """
    mujoco = engine()
    if not isinstance(spec, mujoco.MjSpec):
        raise failure("wrong-type", f"`spec` expects an `MjSpec`, got `{type(spec).__name__}`", call_site())
    try:
        copied = spec.copy()
        compiled = copied.compile()
        text = _text(copied)
    except (ValueError, mujoco.FatalError) as error:
        raise refused(error) from None
    folder = getattr(spec, "modelfiledir", "")
    assets = dict(spec.assets)
    for name, data in spec.assets.items():  # MuJoCo goes by the last part of a path alone
        assets.setdefault(posixpath.basename(name), data)
    if lost := _not_numbers(compiled):
        place = call_site()
        message = (
            "MuJoCo leaves out attributes with a NaN when it writes a spec, so that they get their default:"
            f" the spec has NaN in {', '.join(lost)}"
        )
        warnings.warn_explicit(message, MjcfWarning, place.file, place.line)
    return from_xml_string(text, assets=assets, base_dir=Path(folder) if folder else None)


def _not_numbers(compiled: Any) -> list[str]:
    """Return the arrays of elements that contain a NaN. To MuJoCo 4.0, NaN means not set, so it does not write it."""
    return sorted(
        name
        for kind in KINDS
        for name, array, _ in arrays(compiled, kind)
        if array.dtype.kind == "f" and bool((array != array).any())
    )


def _text(compiled: Any) -> str:
    """Return the XML that MuJoCo writes for a spec: with all digits if possible, else compiled, with six digits."""
    compiler, why = compiled.compiler, "this MuJoCo cannot write more: 3.16 can"
    if hasattr(compiler, "savecompiled"):
        compiler.savecompiled, compiler.savecanonical = False, True
        try:
            return str(compiled.to_xml())
        except (ValueError, engine().FatalError) as error:
            compiler.savecompiled = True
            why = " ".join(str(error).split())
    place = call_site()
    message = f"MuJoCo writes the numbers of this spec in six digits only: {why}"
    warnings.warn_explicit(message, MjcfWarning, place.file, place.line)
    return str(compiled.to_xml())
