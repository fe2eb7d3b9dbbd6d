"""Where and how a model reference is looked up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from composer.sources.fetching import Fetching


@dataclass(frozen=True, slots=True)
class Lookup:
    """The folder of the file that holds a reference, the environment, and the rules and the memory of the run."""

    folder: Path
    environment: Mapping[str, str]
    fetching: Fetching
