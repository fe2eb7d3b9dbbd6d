"""Read models from MuJoCo's own `MjSpec`."""

from __future__ import annotations

import posixpath
import warnings
from pathlib import Path
from typing import Any

from composer.compiled.kinds import KINDS
from composer.compiled.rows import arrays
from composer.mjcf.call_site import call_site
from composer.mjcf.element import RootElement
from composer.mjcf.errors import MjcfWarning, failure
from composer.mjcf.parse import from_xml_string
from composer.mjcf.physics.compile import engine, refused


def from_spec(spec: Any) -> RootElement:
    """The model of a `mujoco.MjSpec`, as MuJoCo writes it out; files in its `assets` come along.

    MuJoCo compiles it for that. Raises `MjcfError` where it cannot. Elements have no origin but that text.
    Numbers are those of the spec, to the last bit. MuJoCo before 3.16 writes six digits of each, and so does a later
    one where models with different compiler settings are attached to each other. An `MjcfWarning` says so, and also
    where the spec has a NaN, which MuJoCo does not write.

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
    """The arrays of elements that have a NaN. MuJoCo 4.0 leaves out what is written as NaN: it means not written."""
    return sorted(
        name
        for kind in KINDS
        for name, array, _ in arrays(compiled, kind)
        if array.dtype.kind == "f" and bool((array != array).any())
    )


def _text(compiled: Any) -> str:
    """What MuJoCo writes of a spec: as it was given where it can, else what it has compiled, in six digits."""
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
