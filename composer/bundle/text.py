"""A bundle as one MJCF file."""

from __future__ import annotations

from pathlib import Path

from composer.bundle.bundle import MANIFEST, Bundle
from composer.bundle.licences import LICENCES
from composer.bundle.output_error import OutputError
from composer.bundle.staging import staged_file


def write_text(bundle: Bundle, out: Path) -> None:
    """Write the model's MJCF alone to `out`; manifest and licences stay behind.

    Raises OutputError when the model has files beside it, which would be lost; then an older `out` is
    untouched.
    """
    needed = needed_files(bundle)
    if needed:
        raise OutputError(
            "output-kind",
            f"one XML file cannot hold the {len(needed)} files that the model needs, such as `{needed[0]}`",
            f"write a folder (`{out.with_suffix('')}/`) or an archive (`{out.with_suffix('.mjz')}`)",
        )
    with staged_file(out) as stage:
        stage.write_bytes(bundle.files[bundle.model])


def needed_files(bundle: Bundle) -> list[str]:
    """The files without which the model's MJCF does not load."""
    return [
        path
        for path in bundle.files
        if path not in (bundle.model, MANIFEST) and not path.startswith(f"{LICENCES}/")
    ]
