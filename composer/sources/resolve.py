"""From the text of a model reference to the file it stands for."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from composer.sources import descriptions, menagerie, package, path
from composer.sources.error import SourceError
from composer.sources.reference import Kind, Reference, parse
from composer.sources.source import Source


def resolve(reference: str, *, relative_to: Path, environment: Mapping[str, str]) -> Source:
    """Find the file that a model reference stands for, and the licences that go with it.

    `relative_to` is the folder of the file that holds the reference; `environment` stands for the environment
    of the process. Nothing of the file itself is read. Raises SourceError.
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
        case Kind.GIT | Kind.ARCHIVE:
            raise _not_yet(parsed)


def _not_yet(reference: Reference) -> SourceError:
    place = "git repositories" if reference.kind is Kind.GIT else "archives on the web"
    return SourceError(
        "not-supported",
        f"models in {place} cannot be fetched yet: `{reference.text}`",
        help="fetch it yourself and write the path of the model file",
    )
