"""The foreign packages: unpacked once below the build folder, by pip or uv, and kept there."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

PINS = Path(__file__).with_name("packages.txt")


class Unavailable(Exception):
    """A package cannot be had here; the message says why."""


def pins() -> dict[str, str]:
    """The requirement of each package by its name."""
    lines = PINS.read_text(encoding="utf-8").splitlines()
    return {line.partition("==")[0]: line for line in lines if line and not line.startswith("#")}


def fetched(name: str, cache: Path) -> Path:
    """The folder with the files of a package. Raises `Unavailable`."""
    requirement = pins()[name]
    folder = cache / requirement
    if folder.is_dir():
        return folder
    cache.mkdir(parents=True, exist_ok=True)
    staged = Path(tempfile.mkdtemp(prefix=f"{name}-", dir=cache))
    try:
        _install(requirement, staged)
        os.rename(staged, folder)
    finally:
        shutil.rmtree(staged, ignore_errors=True)
    return folder


def _install(requirement: str, folder: Path) -> None:
    done = subprocess.run(
        [*_installer(), "--no-deps", "--target", str(folder), requirement], capture_output=True, text=True, check=False
    )
    if done.returncode:
        lines = [line for line in done.stderr.splitlines() if line.strip()] or ["no reason given"]
        said = next((line for line in reversed(lines) if "error" in line.lower()), lines[-1]).strip()
        # pip says in the end only that it has found nothing.
        why = " (PyPI cannot be reached)" if "connection broken" in done.stderr else ""
        raise Unavailable(f"{requirement} cannot be fetched: {said}{why}")


def _installer() -> Sequence[str]:
    # An environment that uv has made has no pip.
    if uv := shutil.which("uv"):
        return (uv, "pip", "install", "--quiet", "--python", sys.executable)
    return (sys.executable, "-m", "pip", "install", "--quiet", "--no-compile", "--retries", "1", "--timeout", "15")
