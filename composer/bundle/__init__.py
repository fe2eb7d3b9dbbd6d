"""Bundles: a finished model as `{path: bytes}` with a manifest, and the forms it is written in.

`write` never leaves half an output. The manifest is in `composer.bundle.manifest`, which alone imports
pydantic.
"""

from __future__ import annotations

from composer.bundle.bundle import MANIFEST, MODEL, Bundle, BundleError
from composer.bundle.licences import licence_files
from composer.bundle.output_error import OutputError
from composer.bundle.read import ReadError, ReadLimits, read
from composer.bundle.write import Form, form_of, write

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
    "read",
    "write",
]
