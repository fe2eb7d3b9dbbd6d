"""What stands beside a bundle: names of its files that come from the name of the model. No I/O."""

from __future__ import annotations

import hashlib
import re


def file_name(name: str) -> str:
    """A model's name as that of a file, which stays in its folder.

    >>> file_name("cell 1/left"), file_name("..")
    ('cell_1_left', 'model')
    """
    return re.sub(r"[^\w.+-]+", "_", name).lstrip(".") or "model"


def hash_of(name: str) -> str:
    """The folder of a model among 256, so that none has very many: two digits of a hash of its name.

    >>> hash_of("cell-s0001"), hash_of("cell-s0002")
    ('b0', '46')
    """
    return hashlib.sha256(file_name(name).encode()).hexdigest()[:2]


def picture_of(name: str) -> str:
    """The picture of a model, beside its bundle.

    >>> picture_of("demo")
    'demo.png'
    """
    return f"{file_name(name)}.png"
