"""Resolve the text of a model reference to its file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from composer.reading.door import Door
from composer.reading.refused import CODE, Refused
from composer.sources.error import SourceError
from composer.sources.fetching import Fetching, Lookup
from composer.sources.kinds import kind_called, parse
from composer.sources.reach import check_reach
from composer.sources.source import Source


def resolve(
    reference: str, *, relative_to: Path, environment: Mapping[str, str], fetching: Fetching | None = None
) -> Source:
    """Find the file of a model reference and its licences; fetch it if necessary.

    `relative_to` is the folder of the file that contains the reference; `environment` replaces the environment of
    the process; `fetching` has the rules and the memory of the run. A reference in a fetched file may not name
    anything on this machine. Raises SourceError.
    """
    fetching = Fetching() if fetching is None else fetching
    parsed = parse(reference)
    kind = kind_called(parsed.kind.name)
    assert kind is not None, "what is parsed is of a kind"
    if not kind.is_fetched:  # another variable could change the result without the build cache noticing
        environment = {name: environment[name] for name in kind.variables if name in environment}
    asking = fetching.around(relative_to)
    is_confined = asking is not None and asking.is_fetched
    if asking is not None and is_confined:
        check_reach(parsed, kind, asking, trust=fetching.trust, offline=fetching.offline)
        is_confined = not fetching.trust.allows(reference)
    source = kind.resolve(parsed, Lookup(relative_to, environment, fetching, is_confined=is_confined))
    if source.origin is not None:
        fetching.origins[source.origin.id] = source.origin
        fetching.first.setdefault(source.origin.id, source)
        return _with_door(source, fetching.door_of_origin(source.origin))
    return _with_door(source, fetching.door_of_model(source.path))


def _with_door(source: Source, door: Door) -> Source:
    """Return the source with its door, after the door has admitted its file and its licences, which may be links."""
    try:
        door.admit(source.path)
        for licence in source.licences:
            if licence.is_symlink():
                door.admit(licence)
    except Refused as refused:
        raise SourceError(CODE, refused.message(), refused.help) from None
    return replace(source, door=door)
