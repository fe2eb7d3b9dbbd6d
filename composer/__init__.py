"""Compose MuJoCo models from a YAML recipe into one verified bundle.

The package's functions are imported on first use, so that `import composer` costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from composer.loading.errors import BundleWarning as BundleWarning
    from composer.loading.errors import LoadError as LoadError
    from composer.loading.errors import UnknownNameError as UnknownNameError
    from composer.loading.load import load as load
    from composer.loading.many import load_many as load_many
    from composer.version import __version__ as __version__

_HOMES = {
    "BundleWarning": "composer.loading.errors",
    "LoadError": "composer.loading.errors",
    "UnknownNameError": "composer.loading.errors",
    "__version__": "composer.version",
    "load": "composer.loading.load",
    "load_many": "composer.loading.many",
}

__all__ = ["BundleWarning", "LoadError", "UnknownNameError", "__version__", "load", "load_many"]


def __getattr__(name: str) -> object:
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module `{__name__}` has no attribute `{name}`")
    value: object = getattr(import_module(home), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})
