"""From the text of a model reference to the file it stands for."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from composer.sources import archive, descriptions, git, menagerie, package, path
from composer.sources.fetching import Fetching
from composer.sources.reference import Kind, parse
from composer.sources.source import Source


def resolve(
    reference: str, *, relative_to: Path, environment: Mapping[str, str], fetching: Fetching | None = None
) -> Source:
    """Find the file that a model reference stands for, and the licences that go with it; fetch it where it has to be.

    `relative_to` is the folder of the file that holds the reference; `environment` stands for the environment
    of the process; `fetching` has the rules and the memory of the run. Raises SourceError.
    """
    parsed = parse(reference)
    match parsed.kind:
        case Kind.PATH:
            return path.resolve(parsed, relative_to)
        case Kind.PACKAGE:
            return package.resolve(parsed)
        case Kind.MENAGERIE:
            return menagerie.resolve(parsed, environment)
        case Kind.DESCRIPTIONS:
            return descriptions.resolve(parsed)
        case Kind.GIT:
            return git.resolve(parsed, environment, fetching or Fetching())
        case Kind.ARCHIVE:
            return archive.resolve(parsed, environment, fetching or Fetching())
