from __future__ import annotations

import os
from pathlib import Path

import pytest
from mjcompose.sources import license
from mjcompose.sources.kinds import PATH
from mjcompose.sources.license import identify, is_license, license_of, of_package
from mjcompose.sources.reference import Source


def write(root: Path, *names: str) -> None:
    for name in names:
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("")


def found(root: Path, model: str, base: Path | None = None) -> list[str]:
    return [path.relative_to(root.resolve()).as_posix() for path in license.find(root / model, base)]


def test_the_nearest_folder_wins(tmp_path: Path) -> None:
    write(tmp_path, "LICENSE", "robots/NOTICE", "robots/COPYING.txt", "robots/arm/arm.xml", "robots/arm/meshes/LICENSE")
    assert found(tmp_path, "robots/arm/arm.xml") == ["robots/COPYING.txt", "robots/NOTICE"]


def test_three_levels_up_and_no_more(tmp_path: Path) -> None:
    write(tmp_path, "LICENSE", "a/b/c/d/model.xml")
    assert found(tmp_path, "a/b/c/model.xml") == ["LICENSE"]
    assert found(tmp_path, "a/b/c/d/model.xml") == []


def test_a_repository_is_not_left(tmp_path: Path) -> None:
    write(tmp_path, "LICENSE", "repo/.git/HEAD", "repo/arm/model.xml")
    assert found(tmp_path, "repo/arm/model.xml") == []
    write(tmp_path, "repo/LICENSE")
    assert found(tmp_path, "repo/arm/model.xml") == ["repo/LICENSE"]


def test_a_worktree_counts_as_a_repository(tmp_path: Path) -> None:
    write(tmp_path, "LICENSE", "repo/.git", "repo/model.xml")
    assert found(tmp_path, "repo/model.xml") == []


def test_the_base_is_not_left(tmp_path: Path) -> None:
    write(tmp_path, "LICENSE", "package/arm/model.xml")
    assert found(tmp_path, "package/arm/model.xml", tmp_path / "package") == []


def test_a_stray_license_beside_all_packages_is_nobodys(tmp_path: Path) -> None:
    write(tmp_path, "site-packages/LICENSE", "site-packages/robots/model.xml")
    assert found(tmp_path, "site-packages/robots/model.xml") == []


def test_a_relative_path_is_searched_from_where_it_starts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path, "LICENSE", "recipes/x.yaml", "models/arm.xml")
    monkeypatch.chdir(tmp_path / "recipes")
    assert license.find(Path("../models/arm.xml")) == ((tmp_path / "LICENSE").resolve(),)


def test_all_texts_in_a_folder_called_licenses_are_licenses(tmp_path: Path) -> None:
    write(
        tmp_path,
        ".git/HEAD",
        "LICENSE.md",
        "LICENSES/CC-BY-4.0.txt",
        "LICENSES/MIT.txt",
        "LICENSES/left/hand/NOTICE",
        "LICENSES/.hidden",
        "LICENSES/check.py",
        "arm/model.xml",
    )
    wanted = ["LICENSE.md", *(f"LICENSES/{each}" for each in ("CC-BY-4.0.txt", "MIT.txt", "left/hand/NOTICE"))]
    assert found(tmp_path, "arm/model.xml") == wanted


def test_a_model_below_a_folder_called_licenses_is_no_license(tmp_path: Path) -> None:
    write(tmp_path, "licenses/arm/readme.txt", "licenses/arm/arm.xml")
    assert found(tmp_path, "licenses/arm/arm.xml", tmp_path / "licenses") == []


@pytest.mark.parametrize(
    "name", ["LICENSE", "license.md", "LICENSE-MIT", "COPYING.LESSER", "NOTICE.txt", "Licenses.txt"]
)
def test_names_of_licenses(name: str) -> None:
    assert is_license(name)


@pytest.mark.parametrize("name", ["license.py", "licenses.json", "noticeboard", "README", "MY_LICENSE", "licensed.xml"])
def test_names_of_other_files(name: str) -> None:
    assert not is_license(name)


def test_a_license_that_is_put_there_later_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mjcompose.base.files._SETTLED", -1)  # else nothing is remembered of a new folder
    (tmp_path / "arm" / ".git").mkdir(parents=True)
    os.utime(tmp_path / "arm", (1, 1))
    assert found(tmp_path, "arm/arm.xml") == []
    write(tmp_path, "arm/LICENSE")
    assert found(tmp_path, "arm/arm.xml") == ["arm/LICENSE"]


BSD = """Redistribution and use in source and binary forms, with or without
modification, are permitted provided that the following conditions are met:"""
CLAUSE_3 = """
* Neither the name of the copyright holder nor the names of its
  contributors may be used to endorse or promote products derived from this software"""


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            "                              Apache License\n                        Version 2.0, January 2004",
            "Apache-2.0",
        ),
        (BSD, "BSD-2-Clause"),
        (BSD + CLAUSE_3, "BSD-3-Clause"),
        ("Creative Commons Attribution 4.0 International Public License", "CC-BY-4.0"),
        ("Attribution-NonCommercial-ShareAlike 4.0 International", "CC-BY-NC-SA-4.0"),
        ("Creative Commons Legal Code\n\nCC0 1.0 Universal", "CC0-1.0"),
        (
            "GNU GENERAL PUBLIC LICENSE\n Version 3, 29 June 2007 … GNU Affero General Public License version 3",
            "GPL-3.0-only",
        ),
        ("GNU LESSER GENERAL PUBLIC LICENSE\n Version 3, 29 June 2007", "LGPL-3.0-only"),
        ("Mozilla Public License Version 2.0", "MPL-2.0"),
        ("SPDX-License-Identifier: MIT OR Apache-2.0\nApache License Version 2.0", "MIT OR Apache-2.0"),
        ("Do as you please.", None),
        ("<!-- SPDX-License-Identifier: -->", None),
        ("SPDX-License-Identifier:\nto be settled", None),
        ("", None),
    ],
)
def test_a_text_is_known_by_its_words(text: str, expected: str | None) -> None:
    assert identify(text) == expected


def source(folder: Path, head: str = "", licenses: dict[str, str] | None = None, package: str | None = None) -> Source:
    model = folder / "arm.xml"
    model.write_text(f"{head}<mujoco/>")
    for name, text in (licenses or {}).items():
        (folder / name).write_text(text)
    paths = tuple(folder / name for name in licenses or {})
    return Source(model, PATH, "./arm.xml", licenses=paths, license=package)


def test_the_model_itself_is_asked_first(tmp_path: Path) -> None:
    head = "<!-- SPDX-License-Identifier: CC-BY-4.0 -->\n"
    assert license_of(source(tmp_path, head, {"LICENSE": BSD})) == "CC-BY-4.0"


def test_several_licenses_hold_together(tmp_path: Path) -> None:
    files = {"LICENSE": BSD, "LICENSE-meshes": "SPDX-License-Identifier: MIT OR ISC", "NOTICE": "thanks"}
    assert license_of(source(tmp_path, "", files)) == "BSD-2-Clause AND (MIT OR ISC)"


def test_a_package_speaks_only_where_no_file_does(tmp_path: Path) -> None:
    assert license_of(source(tmp_path, package="MIT")) == "MIT"
    assert license_of(source(tmp_path, "", {"LICENSE": "Do as you please."}, "MIT")) is None
    assert license_of(source(tmp_path, "", {"LICENSE": " \n"}, "MIT")) == "MIT"
    assert license_of(source(tmp_path)) is None


@pytest.mark.parametrize(
    ("metadata", "expected"),
    [
        (("MIT OR Apache-2.0", "MIT", []), "MIT OR Apache-2.0"),
        ((None, "Apache License, Version 2.0", []), "Apache-2.0"),
        ((None, "see file", ["License :: OSI Approved :: MIT License"]), "MIT"),
        ((None, None, ["Programming Language :: Python"]), None),
    ],
)
def test_metadata_of_packages(metadata: tuple[str | None, str | None, list[str]], expected: str | None) -> None:
    assert of_package(*metadata) == expected
