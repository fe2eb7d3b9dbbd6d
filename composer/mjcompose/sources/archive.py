"""Model references to archives on the web, pinned in a lock by their sha256."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from mjcompose.sources.reference import (
    Form,
    Reference,
    SourceKind,
    check_secrets,
    host_of_url,
    malformed,
    never,
    take_apart,
)  # fmt: skip

if TYPE_CHECKING:
    from mjcompose.sources.fetching import Lookup
    from mjcompose.sources.reference import Source

_FORM = Form("https://host/archive.zip#path/model.xml", "a file in a zip or tar (plain, gz, bz2, xz) on the web")
_PINNED = Form("https://host/archive.zip@sha256:HEX#path/model.xml", "the same; another archive there is an error")


def _parse(text: str) -> Reference:
    scheme, _, rest = text.partition(":")
    location, _, path = rest.partition("#")
    host, _, archive = location.removeprefix("//").partition("/")
    check_secrets(text, host)
    archive, _, sha256 = archive.partition("@sha256:")
    if not host or not archive:
        raise malformed(text, _FORM, "does not say the archive")
    if take_apart(f"{scheme}://{host}/") is None:
        raise malformed(text, _FORM, "names a host that cannot be one")
    if not path:
        raise malformed(text, _FORM, "does not say the file inside the archive")
    if "@sha256:" in location and not re.fullmatch("[0-9a-f]{64}", sha256):
        raise malformed(text, _FORM, "has a sha256 that is not 64 digits of 0-9 and a-f")
    return Reference(text, KIND, f"{scheme}://{host}/{archive}", path=path, revision=sha256)


def _resolve(reference: Reference, lookup: Lookup) -> Source:
    from mjcompose.sources.web_archive import resolve  # a model that the cache knows is not fetched

    return resolve(reference, lookup)


KIND = SourceKind(
    name="archive", forms=(_FORM, _PINNED), local_schemes=("http",), separator="#", is_local=False,
    is_fetched=True, runs_code=False, pins=frozenset({"sha256"}), variables=(), libraries=(), parse=_parse,
    resolve=_resolve, host=host_of_url, is_of_this_machine=never,
)  # fmt: skip
