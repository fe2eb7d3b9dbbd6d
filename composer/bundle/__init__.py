"""Bundles: a finished model as `{path: bytes}` with a manifest, and the forms that it is written in.

`composer.bundle.write` never leaves half an output. Only `composer.bundle.manifest` imports pydantic. Submodules
are imported on first use.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing import Any

    from composer.bundle.bundle import MANIFEST, MODEL, Bundle, BundleError
    from composer.bundle.form import Form, form_of
    from composer.bundle.licences import licence_files
    from composer.bundle.output_error import OutputError
    from composer.bundle.read import ReadError, ReadLimits

__all__ = [
    "MANIFEST",
    "MODEL",
    "Bundle",
    "BundleError",
    "Form",
    "OutputError",
    "ReadError",
    "ReadLimits",
    "form_of",
    "licence_files",
]

_ROOMS = {
    "bundle": ("MANIFEST", "MODEL", "Bundle", "BundleError"),
    "form": ("Form", "form_of"),
    "licences": ("licence_files",),
    "output_error": ("OutputError",),
    "read": ("ReadError", "ReadLimits"),
}
_HOME = {name: room for room, names in _ROOMS.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"composer.bundle.{_HOME[name]}"), name)
