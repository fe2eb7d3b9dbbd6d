"""Content-addressed bytes: what two models have in common is stored and sent once."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Collection, Iterable
from pathlib import Path
from typing import Any

import numpy as np

_DIGITS = 24


class Blobs:
    """Writes each content once to a file of `folder`, named by its hash; those in `known` are not even encoded."""

    def __init__(self, folder: Path, known: Collection[str] = ()) -> None:
        self.folder, self.known = folder, set(known)
        self.used: dict[str, None] = {}

    def put(self, form: str, arrays: Iterable[Any], encode: Callable[[], bytes]) -> str:
        """Return the hash of some arrays in the format `form`; `encode` returns their bytes if they are new."""
        digest = hashlib.sha256(form.encode())
        for each in arrays:
            array = np.ascontiguousarray(each)
            digest.update(f"{array.dtype}{array.shape}".encode())
            digest.update(array.data)
        name = digest.hexdigest()[:_DIGITS]
        if name not in self.used and name not in self.known:
            (self.folder / name).write_bytes(encode())
        self.used[name] = None
        return name


def packed(*arrays: Any) -> bytes:
    """Concatenate arrays, each padded so that the next one begins at a multiple of four bytes."""
    found = bytearray()
    for each in arrays:
        found += np.ascontiguousarray(each).tobytes()
        found += bytes(-len(found) % 4)
    return bytes(found)


def steps(values: Any, bits: int = 16) -> tuple[Any, list[float], list[float]]:
    """Quantize rows of numbers between the least and the greatest of each column.

    Return the steps, the least and the step.
    """
    low, high = values.min(axis=0), values.max(axis=0)
    most = (1 << bits) - 1
    step = np.where(high > low, (high - low) / most, 1.0)
    whole = np.rint((values - low) / step).astype(np.uint16 if bits == 16 else np.uint8)
    return whole, short(low), short(step)


def short(values: Any) -> list[Any]:
    """Return numbers with nine digits, which is all that single precision has, as a flat list."""
    flat = np.asarray(values).ravel()
    if flat.dtype.kind != "f":
        return flat.astype(int).tolist() if flat.dtype.kind == "b" else flat.tolist()
    return [float(f"{each:.9g}") for each in flat.tolist()]
