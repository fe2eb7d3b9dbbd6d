"""From the text of a model reference to the file it stands for."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from composer.sources import archive, descriptions, git, licence, menagerie, package, path
from composer.sources.error import SourceError
from composer.sources.fetching import Fetching
from composer.sources.reference import Kind, Reference, parse
from composer.sources.source import Source


def resolve(
    reference: str, *, relative_to: Path, environment: Mapping[str, str], fetching: Fetching | None = None
) -> Source:
    """Find the file that a model reference stands for, and the licences that go with it; fetch it where it has to be.

    `relative_to` is the folder of the file that holds the reference; `environment` stands for the environment
    of the process; `fetching` has the rules and the memory of the run. Raises SourceError.
    """
    fetching = Fetching() if fetching is None else fetching
    source = _resolve(parse(reference), relative_to, environment, fetching)
    if source.origin is not None:
        fetching.origins[source.origin.id] = source.origin
        fetching.first.setdefault(source.origin.id, source)
    return source


def _resolve(
    reference: Reference, relative_to: Path, environment: Mapping[str, str], fetching: Fetching
) -> Source:
    match reference.kind:
        case Kind.PATH:
            try:
                found = path.resolve(reference, relative_to)
            except SourceError as error:
                raise _left_out(reference, relative_to, fetching) or error from None
            return _of_the_same(found, relative_to, fetching)
        case Kind.PACKAGE:
            return package.resolve(reference)
        case Kind.MENAGERIE:
            return menagerie.resolve(reference, environment, fetching)
        case Kind.DESCRIPTIONS:
            return descriptions.resolve(reference, fetching)
        case Kind.GIT:
            return git.resolve(reference, environment, fetching)
        case Kind.ARCHIVE:
            return archive.resolve(reference, environment, fetching)


def _left_out(reference: Reference, relative_to: Path, fetching: Fetching) -> SourceError | None:
    """The error for a path in a recipe that was fetched, where it leads to what was left out when that was done."""
    origin = fetching.around(relative_to)
    if origin is None:
        return None
    inside = Path(
        os.path.relpath(os.path.realpath(relative_to / reference.path), os.path.realpath(origin.root))
    )
    for name, why in origin.without:
        if inside.is_relative_to(name):
            return SourceError(
                "source-not-found",
                f"the model `{reference.text}` does not exist: `{name}` of `{origin.id}` is {why}",
            )
    return None


def _of_the_same(source: Source, relative_to: Path, fetching: Fetching) -> Source:
    """A path in a recipe that was fetched leads to a file that was fetched with it."""
    origin = fetching.around(relative_to)
    if origin is None:
        return source
    if fetching.around(source.path) != origin:
        if origin.is_fetched:
            raise SourceError(
                "source-outside",
                f"`{source.reference}` was not fetched with `{origin.id}`, whose recipe names it",
                help="a recipe that is fetched must hold all that it names by paths",
            )
        return source
    asked = fetching.first.get(origin.id, source)
    own = licence.find(source.path, origin.root)
    of_the_whole = tuple(each for each in asked.licences if not each.is_relative_to(origin.root))
    return replace(
        source, package=asked.package, version=asked.version, licence=asked.licence,
        licences=own or of_the_whole, origin=origin,
    )  # fmt: skip
