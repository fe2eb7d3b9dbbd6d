"""Read sizes, names and arrays of a compiled model. Runs in the child process; imports no MuJoCo itself.

All attributes exist in MuJoCo 3.12; newer ones are read with a fallback.
"""

from __future__ import annotations

from typing import Any

from composer.compiled.kinds import KINDS, names


def sizes(model: Any) -> dict[str, int]:
    """Return all integer sizes of the model; `nactuator` falls back to `nu`, which is the same in older versions."""
    found = {}
    for name in dir(model):
        if name.startswith("n"):
            value = getattr(model, name)
            if isinstance(value, int):
                found[name] = value
    found.setdefault("nactuator", found["nu"])
    return found


def all_names(model: Any) -> dict[str, list[str]]:
    return {kind: names(model, kind) for kind in KINDS}


def arrays(wanted: list[str], model: Any, data: Any) -> dict[str, Any]:
    """Return the requested arrays; a size becomes an array of one, text its bytes.

    Names that this version does not have are left out.
    """
    import numpy

    found = {}
    for name in wanted:
        owner, _, attribute = name.rpartition(".")
        value = getattr(data if owner == "data" else model, attribute, None)
        if isinstance(value, bytes):
            value = numpy.frombuffer(value, numpy.uint8)
        if isinstance(value, int | float | numpy.ndarray):
            found[name] = numpy.atleast_1d(value)
    return found
