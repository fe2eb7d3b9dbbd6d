"""Write `mujoco/model_types.py`, which tells type checkers the arrays of `mjModel` and `mjData`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np

_HEAD = '''\
"""The arrays and sizes of a compiled model and of its state, for type checkers.

MuJoCo's package has no types for them. With these, `mypy` finds a misspelt array, and an array with another number of
axes than a function takes.

Written by `make schemas` from MuJoCo {version}; do not edit. An older MuJoCo lacks some of them.
"""

from __future__ import annotations

from typing import Any, Protocol, TypeAlias

import numpy as np

'''
_WORDS = {1: "Row", 2: "Table", 3: "Stack"}
"""The last word in the name of a type, by the number of axes."""

_KINDS = {
    "bool": "Bool",
    "int8": "Int8",
    "uint8": "UInt8",
    "int32": "Int32",
    "int64": "Int64",
    "uint32": "UInt32",
    "uint64": "UInt64",
    "float32": "Float32",
    "float64": "Float64",
}

_MODEL = "<mujoco><worldbody><body><joint/><geom size='1'/></body></worldbody></mujoco>"


def written() -> str:
    """Return the text of the module, for the MuJoCo that is installed."""
    model = mujoco.MjModel.from_xml_string(_MODEL)
    data = mujoco.MjData(model)
    arrays = [value for of in (model, data) for _name, value in _public(of) if isinstance(value, np.ndarray)]
    aliases = sorted({(_KINDS[array.dtype.name], array.ndim, array.dtype.name) for array in arrays})
    return "".join(
        [
            _HEAD.format(version=mujoco.__version__),
            *(_alias(ndim, dtype) for _kind, ndim, dtype in aliases),
            *_protocol("MjModel", "The sizes and arrays of `mjModel`.", model),
            *_protocol("MjData", "The sizes and arrays of `mjData`.", data),
        ]
    )


def _alias(ndim: int, dtype: str) -> str:
    axes = ", ".join(["int"] * ndim)
    of = "np.bool_" if dtype == "bool" else f"np.{dtype}"
    return f"{_called(ndim, dtype)}: TypeAlias = np.ndarray[tuple[{axes}], np.dtype[{of}]]\n"


def _called(ndim: int, dtype: str) -> str:
    return f"{_KINDS[dtype]}{_WORDS[ndim]}"


def _protocol(name: str, summary: str, of: object) -> Iterator[str]:
    yield f'\n\nclass {name}(Protocol):\n    """{summary}"""\n\n'
    yield "    def __hash__(self) -> int: ...\n\n"
    for attribute, value in _public(of):
        if isinstance(value, np.ndarray):
            yield f"    {attribute}: {_called(value.ndim, value.dtype.name)}\n"
        elif isinstance(value, bool | int | float | bytes):
            yield f"    {attribute}: {type(value).__name__}\n"
        else:
            yield f"    {attribute}: Any\n"


def _public(of: object) -> Iterator[tuple[str, object]]:
    for name in sorted(dir(of)):
        if not name.startswith("_"):
            yield name, getattr(of, name)


if __name__ == "__main__":
    path = Path(__file__).parents[1] / "composer" / "mjcompose" / "mujoco" / "model_types.py"
    path.write_text(written(), encoding="utf-8")
