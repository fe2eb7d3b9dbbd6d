from __future__ import annotations

from pathlib import Path

import pytest

from composer.sources.path import KIND
from composer.sources.source import Source
from composer.sources.spdx import identify, licence_of, of_package

BSD = """Redistribution and use in source and binary forms, with or without
modification, are permitted provided that the following conditions are met:"""
CLAUSE_3 = """
* Neither the name of the copyright holder nor the names of its
  contributors may be used to endorse or promote products derived from this software"""


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("                              Apache License\n                        Version 2.0, January 2004", "Apache-2.0"),
        (BSD, "BSD-2-Clause"),
        (BSD + CLAUSE_3, "BSD-3-Clause"),
        ("Creative Commons Attribution 4.0 International Public License", "CC-BY-4.0"),
        ("Attribution-NonCommercial-ShareAlike 4.0 International", "CC-BY-NC-SA-4.0"),
        ("Creative Commons Legal Code\n\nCC0 1.0 Universal", "CC0-1.0"),
        ("GNU GENERAL PUBLIC LICENSE\n Version 3, 29 June 2007 … GNU Affero General Public License version 3", "GPL-3.0-only"),
        ("GNU LESSER GENERAL PUBLIC LICENSE\n Version 3, 29 June 2007", "LGPL-3.0-only"),
        ("Mozilla Public License Version 2.0", "MPL-2.0"),
        ("SPDX-License-Identifier: MIT OR Apache-2.0\nApache License Version 2.0", "MIT OR Apache-2.0"),
        ("Do as you please.", None),
        ("<!-- SPDX-License-Identifier: -->", None),
        ("SPDX-License-Identifier:\nto be settled", None),
        ("", None),
    ],
)  # fmt: skip
def test_a_text_is_known_by_its_words(text: str, expected: str | None) -> None:
    assert identify(text) == expected


def source(
    folder: Path, head: str = "", licences: dict[str, str] | None = None, package: str | None = None
) -> Source:
    model = folder / "arm.xml"
    model.write_text(f"{head}<mujoco/>")
    for name, text in (licences or {}).items():
        (folder / name).write_text(text)
    paths = tuple(folder / name for name in licences or {})
    return Source(model, KIND, "./arm.xml", licences=paths, licence=package)


def test_the_model_itself_is_asked_first(tmp_path: Path) -> None:
    head = "<!-- SPDX-License-Identifier: CC-BY-4.0 -->\n"
    assert licence_of(source(tmp_path, head, {"LICENSE": BSD})) == "CC-BY-4.0"


def test_several_licences_hold_together(tmp_path: Path) -> None:
    files = {"LICENSE": BSD, "LICENSE-meshes": "SPDX-License-Identifier: MIT OR ISC", "NOTICE": "thanks"}
    assert licence_of(source(tmp_path, "", files)) == "BSD-2-Clause AND (MIT OR ISC)"


def test_a_package_speaks_only_where_no_file_does(tmp_path: Path) -> None:
    assert licence_of(source(tmp_path, package="MIT")) == "MIT"
    assert licence_of(source(tmp_path, "", {"LICENSE": "Do as you please."}, "MIT")) is None
    assert licence_of(source(tmp_path, "", {"LICENSE": " \n"}, "MIT")) == "MIT"
    assert licence_of(source(tmp_path)) is None


@pytest.mark.parametrize(
    ("metadata", "expected"),
    [
        (("MIT OR Apache-2.0", "MIT", []), "MIT OR Apache-2.0"),
        ((None, "Apache License, Version 2.0", []), "Apache-2.0"),
        ((None, "see file", ["License :: OSI Approved :: MIT License"]), "MIT"),
        ((None, None, ["Programming Language :: Python"]), None),
    ],
)
def test_metadata_of_packages(
    metadata: tuple[str | None, str | None, list[str]], expected: str | None
) -> None:
    assert of_package(*metadata) == expected
