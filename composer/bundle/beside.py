"""Names of files next to a bundle, derived from the name of the model. No I/O."""

from __future__ import annotations

import hashlib
import re


def file_name(name: str) -> str:
    """Return a model's name as a file name, which cannot lead out of its folder.

    >>> file_name("cell 1/left"), file_name("..")
    ('cell_1_left', 'model')
    """
    return re.sub(r"[^\w.+-]+", "_", name).lstrip(".") or "model"


def hash_of(name: str) -> str:
    """Return the model's folder among 256, which keeps each of them small: two digits of a hash of its name.

    >>> hash_of("cell-s0001"), hash_of("cell-s0002")
    ('b0', '46')
    """
    return hashlib.sha256(file_name(name).encode()).hexdigest()[:2]


def picture_of(name: str) -> str:
    """Return the name of a model's picture, which is next to its bundle.

    >>> picture_of("demo")
    'demo.png'
    """
    return f"{file_name(name)}.png"
