"""The license files of a model, and the SPDX identifier of their text."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

from mjcompose.base.files import Memory, open_regular, real_folder
from mjcompose.sources.reference import Source

UNKNOWN = "unknown"
"""The name of an unidentified license, which is not an SPDX identifier."""

_LARGEST = 1 << 20
_DECLARED = re.compile(
    r"SPDX-License-Identifier:[ \t]*([A-Za-z0-9(][A-Za-z0-9.+() -]*?)\s*(?:-->|\*/|[\"'<]|$)", re.MULTILINE
)
_HEAD = 4096

_PHRASES: tuple[tuple[str, str], ...] = (
    ("Apache-2.0", r"apache license,? version 2\.0"),
    ("MPL-2.0", r"mozilla public license,? version 2\.0"),
    ("AGPL-3.0-only", r"gnu affero general public license version 3"),
    ("LGPL-3.0-only", r"gnu lesser general public license version 3"),
    ("LGPL-2.1-only", r"gnu lesser general public license version 2\.1"),
    ("GPL-3.0-only", r"gnu general public license version 3"),
    ("GPL-2.0-only", r"gnu general public license version 2"),
    ("EPL-2.0", r"eclipse public license - v ?2\.0"),
    ("BSL-1.0", r"boost software license - version 1\.0"),
    ("CC-BY-NC-ND-4.0", r"attribution-noncommercial-noderivatives 4\.0"),
    ("CC-BY-NC-SA-4.0", r"attribution-noncommercial-sharealike 4\.0"),
    ("CC-BY-NC-4.0", r"attribution-noncommercial 4\.0"),
    ("CC-BY-ND-4.0", r"attribution-noderivatives 4\.0"),
    ("CC-BY-SA-4.0", r"attribution-sharealike 4\.0"),
    ("CC-BY-4.0", r"attribution 4\.0"),
    ("CC-BY-3.0", r"attribution 3\.0"),
    ("CC0-1.0", r"cc0 1\.0 universal"),
    ("Zlib", r"altered source versions must be plainly marked as such"),
    ("Unlicense", r"free and unencumbered software released into the public domain"),
    ("ISC", r"permission to use, copy, modify, and/?(?:or)? distribute this software for any purpose with or"),
    ("MIT", r"permission is hereby granted, free of charge, to any person obtaining a copy .{0,400}restriction"),
)  # fmt: skip
"""Phrases that occur in one license only; the first one in the text counts."""

_BSD = r"redistribution and use in source and binary forms, with or without modification"
_BSD_3 = r"neither the name of .{1,200} may be used to endorse or promote"
_BSD_4 = r"all advertising materials mentioning features"


@lru_cache(maxsize=64)
def identify(text: str) -> str | None:
    r"""Return the SPDX identifier of a license text, or None if it is not a common license. No I/O.

    A line `SPDX-License-Identifier: …` takes precedence over the text itself.

    >>> identify("The MIT License\n\nPermission is hereby granted, free of charge, to any person\n"
    ...          "obtaining a copy of this software, to deal in it without restriction")
    'MIT'
    """
    declared = _DECLARED.search(text)
    if declared is not None:
        return declared[1]
    plain = " ".join(re.sub(r"[\s#*/;]+", " ", text.casefold().replace("license", "license")).split())
    matches = ((re.search(phrase, plain), name) for name, phrase in _PHRASES)
    places = [(match.start(), name) for match, name in matches if match is not None]
    match = re.search(_BSD, plain)
    if match is not None:
        clauses = "BSD-4-Clause" if re.search(_BSD_4, plain) else "BSD-3-Clause"
        places.append((match.start(), clauses if re.search(_BSD_3, plain) else "BSD-2-Clause"))
    return min(places)[1] if places else None


def license_of(source: Source) -> str | None:
    """Return the license of a model as an SPDX expression, or None if it is not stated.

    The model file itself comes first (`SPDX-License-Identifier`), then its license files, then the package.
    Different license files are joined by AND.
    """
    declared = _DECLARED.search(_heads.ask(os.fspath(source.path)))
    if declared is not None:
        return declared[1]
    named = sorted({name for path in source.licenses if (name := identify(_texts.ask(os.fspath(path)))) is not None})
    if named:
        return " AND ".join(
            f"({expression})" if " OR " in expression and len(named) > 1 else expression for expression in named
        )
    return source.license if all(map(is_empty, source.licenses)) else None


def is_empty(license: Path) -> bool:
    return not _texts.ask(os.fspath(license)).strip()


def _read(path: str, size: int) -> str:
    try:
        with open_regular(path) as file:
            return file.read(size).decode("utf-8", "replace")
    except OSError:
        return ""


# Many models of one run share the same license files.
_heads = Memory(lambda path: _read(path, _HEAD), lambda _: "")
_texts = Memory(lambda path: _read(path, _LARGEST), lambda _: "")


_CLASSIFIERS = {
    "Apache Software License": "Apache-2.0",
    "MIT License": "MIT",
    "MIT No Attribution License (MIT-0)": "MIT-0",
    "ISC License (ISCL)": "ISC",
    "Mozilla Public License 2.0 (MPL 2.0)": "MPL-2.0",
    "GNU General Public License v2 (GPLv2)": "GPL-2.0-only",
    "GNU General Public License v3 (GPLv3)": "GPL-3.0-only",
    "CC0 1.0 Universal (CC0 1.0) Public Domain Dedication": "CC0-1.0",
}
_WRITTEN = {
    "apache 2.0": "Apache-2.0",
    "apache-2.0": "Apache-2.0",
    "apache license 2.0": "Apache-2.0",
    "apache license, version 2.0": "Apache-2.0",
    "mit": "MIT",
    "mit license": "MIT",
    "bsd-3-clause": "BSD-3-Clause",
    "bsd-2-clause": "BSD-2-Clause",
    "isc": "ISC",
    "mpl-2.0": "MPL-2.0",
}


def of_package(expression: str | None, written: str | None, classifiers: Iterable[str]) -> str | None:
    """Return the license in the metadata of a package: its `License-Expression`, `License`, or classifiers. No I/O."""
    if expression:
        return expression
    if written and (license := _WRITTEN.get(written.strip().casefold()) or identify(written)):
        return license
    for classifier in classifiers:
        license = _CLASSIFIERS.get(classifier.rpartition(" :: ")[2])
        if license is not None:
            return license
    return None


_CARD = re.compile(r"\A---\r?\n(.*?)^---\s*$", re.DOTALL | re.MULTILINE)
_IN_CARD = re.compile(r"^license:\s*(?:-\s*)?[\"']?([\w.-]+)[\"']?\s*$", re.MULTILINE)


def of_card(card: Path) -> str | None:
    """Return the license in the metadata of a model card of Hugging Face, or None if it gives no known license."""
    head = _CARD.match(_texts.ask(os.fspath(card)))
    written = None if head is None else _IN_CARD.search(head[1])
    known = {name.casefold(): name for _, name in _PHRASES} | _WRITTEN
    return None if written is None else known.get(written[1].casefold())


LEVELS = 3
"""How many folders above its own a model's license may be."""
_NAME = re.compile(r"(licen[sc]e|copying|notice)s?([-_. ].*)?", re.IGNORECASE)
_FOLDER = re.compile("licen[sc]es", re.IGNORECASE)
_DEPTH = 3
_NOT_TEXT = frozenset({".py", ".pyc", ".pyi", ".js", ".json", ".xml", ".yaml", ".yml", ".toml", ".sh", ".h", ".png"})


def find(model: Path, base: Path | None = None) -> tuple[Path, ...]:
    """Return the license files of the nearest folder that has any: the model's own, or one of the `LEVELS` above it.

    All texts in a folder `LICENSES` count. The search stays inside `base`, does not go above a folder with `.git`, and
    stops below the folder where Python packages are installed. The result is empty if there are none. It reads only
    folders, no files.
    """
    folder = Path(real_folder(os.fspath(model.parent)))
    top = Path(os.path.realpath(base)) if base is not None else None
    for _ in range(LEVELS + 1):
        if folder.name in ("site-packages", "dist-packages"):
            break
        with suppress(OSError):
            paths = (folder / name for name in licenses_in(os.fspath(folder)))
            licenses = tuple(sorted(path for path in paths if os.path.isfile(path)))
            if licenses:
                return licenses
        if folder in (top, folder.parent) or os.path.exists(folder / ".git"):
            break
        folder = folder.parent
    return ()


def is_license(name: str) -> bool:
    """Return whether a file with this name is a license or a notice. No I/O."""
    return _NAME.fullmatch(name) is not None and _is_text(name)


def licenses_in(folder: str) -> list[str]:
    """Return the sorted relative paths of the licenses in a folder, with all texts in `LICENSES`. Raises OSError."""
    names = _remembered.ask(folder)
    found = [name for name in names if is_license(name) and not os.path.isdir(os.path.join(folder, name))]
    for name in filter(_FOLDER.fullmatch, names):
        for path, _, files in os.walk(os.path.join(folder, name)):
            below = os.path.relpath(path, folder)
            found += [os.path.join(below, file) for file in files if _is_text(file)]
    return sorted(found)


def _names(folder: str) -> list[str]:
    return [name for name in os.listdir(folder) if is_license(name) or _FOLDER.fullmatch(name)]


# Each of many models looks in the same four folders.
_remembered = Memory(_names, _names)


def license_folders(folder: str) -> list[str]:
    """Return the folders `LICENSES` in a folder and all folders below them; none if it cannot be read."""
    try:
        names = [name for name in os.listdir(folder) if _FOLDER.fullmatch(name)]
    except OSError:
        return []
    return sorted(path for name in names for path, _, _ in os.walk(os.path.join(folder, name)))


def license_names(folder: str) -> str:
    """Return a text that changes when the licenses directly in a folder change. Raises OSError."""
    if any(map(_FOLDER.fullmatch, folder.split(os.sep)[-_DEPTH:])):
        return "\n".join(sorted(os.listdir(folder)))
    return "\n".join(sorted(name for name in os.listdir(folder) if is_license(name)))


def _is_text(name: str) -> bool:
    return not name.startswith(".") and os.path.splitext(name)[1].lower() not in _NOT_TEXT
