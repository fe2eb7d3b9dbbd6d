"""From the text of a model reference to the file it stands for."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from composer.sources.fetching import Fetching, Lookup
from composer.sources.kinds import kind_called, parse
from composer.sources.source import Source


def resolve(
    reference: str, *, relative_to: Path, environment: Mapping[str, str], fetching: Fetching | None = None
) -> Source:
    """Find the file that a model reference stands for, and the licences that go with it; fetch it where it has to be.

    `relative_to` is the folder of the file that holds the reference; `environment` stands for the environment
    of the process; `fetching` has the rules and the memory of the run. Raises SourceError.
    """
    fetching = Fetching() if fetching is None else fetching
    parsed = parse(reference)
    kind = kind_called(parsed.kind.name)
    assert kind is not None, "what is parsed is of a kind"
    if not kind.is_fetched:  # another variable could change the outcome without the build cache's knowing
        environment = {name: environment[name] for name in kind.variables if name in environment}
    source = kind.resolve(parsed, Lookup(relative_to, environment, fetching))
    if source.origin is not None:
        fetching.origins[source.origin.id] = source.origin
        fetching.first.setdefault(source.origin.id, source)
    return source
