"""A bundle as a compiled model with a manifest next to it."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

from composer import engine
from composer.bundle.bundle import MANIFEST, Bundle
from composer.bundle.output_error import OutputError, unwritable
from composer.bundle.staging import staged_file, write_files
from composer.scratch import scratch


def write_mjb(
    bundle: Bundle,
    out: Path,
    *,
    limits: engine.Limits | None = None,
    session: engine.Session | None = None,
) -> None:
    """Compile the bundle and write MuJoCo's binary form, which only the same version of MuJoCo reads.

    A manifest that lists this one file is written next to it. Raises OutputError, also if the model does not
    compile, and then leaves an older `out` untouched.
    """
    with staged_file(out) as stage:
        stage.touch()  # fail now if the operating system does not allow writing there
        try:
            with scratch("bundle") as folder:
                write_files(bundle, Path(folder))
                compiled = engine.compile(
                    Path(folder), bundle.model, mjb=stage, limits=limits, session=session
                )
        except OSError as error:
            raise unwritable("a temporary folder", error) from error
        if not compiled.ok:
            raise OutputError("output-unwritable", f"cannot write `{out}`: {compiled.error}")
        if MANIFEST in bundle.files:
            with staged_file(manifest_beside(out)) as beside:
                beside.write_bytes(_manifest(bundle.files[MANIFEST], out.name, stage.read_bytes()))


def manifest_beside(out: Path) -> Path:
    """Return the path of a compiled model's manifest. No I/O.

    >>> manifest_beside(Path("build/arm.mjb")).as_posix()
    'build/arm.manifest.json'
    """
    return out.with_suffix(f".{MANIFEST}")


def with_version(out: str, version: str | None = None) -> str:
    """Replace `{mujoco}` in a compiled model's name by the version of MuJoCo, the only one that reads it.

    No I/O except for the installed version of MuJoCo, if no version is given.

    >>> with_version("build/arm-{mujoco}.mjb", "4.0.0"), with_version("build/arm.mjb", "4.0.0")
    ('build/arm-4.0.0.mjb', 'build/arm.mjb')
    """
    if "{mujoco}" not in out:
        return out
    if version is None:
        from importlib import metadata  # takes longer to import than a known model to be found

        version = metadata.version("mujoco")
    return out.replace("{mujoco}", version)


def _manifest(text: bytes, name: str, content: bytes) -> bytes:
    """Return the bundle's manifest with the compiled form as only file."""
    manifest = json.loads(text)
    manifest["model"] = name
    manifest["files"] = [{"path": name, "sha256": hashlib.sha256(content).hexdigest(), "size": len(content)}]
    return (json.dumps(manifest, indent=2, ensure_ascii=False, allow_nan=False) + "\n").encode()
