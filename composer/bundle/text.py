"""Write a bundle as one MJCF file."""

from __future__ import annotations

from pathlib import Path

from composer.bundle.bundle import MANIFEST, Bundle
from composer.bundle.licences import LICENCES
from composer.bundle.output_error import OutputError
from composer.bundle.staging import staged_file


def write_text(bundle: Bundle, out: Path) -> None:
    """Write only the model's MJCF to `out`, without manifest and licences.

    Raises OutputError if the model needs other files, which would be lost, and then leaves an older `out`
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
    """Return the files that the model's MJCF needs to load."""
    return [
        path
        for path in bundle.files
        if path not in (bundle.model, MANIFEST) and not path.startswith(f"{LICENCES}/")
    ]
