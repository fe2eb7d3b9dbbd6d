from __future__ import annotations

import os
from pathlib import Path

import pytest

from composer.sources import licence
from composer.sources.licence import is_licence


def write(root: Path, *names: str) -> None:
    for name in names:
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("")


def found(root: Path, model: str, base: Path | None = None) -> list[str]:
    return [path.relative_to(root.resolve()).as_posix() for path in licence.find(root / model, base)]


def test_the_nearest_folder_wins(tmp_path: Path) -> None:
    write(
        tmp_path,
        "LICENSE",
        "robots/NOTICE",
        "robots/COPYING.txt",
        "robots/arm/arm.xml",
        "robots/arm/meshes/LICENSE",
    )
    assert found(tmp_path, "robots/arm/arm.xml") == ["robots/COPYING.txt", "robots/NOTICE"]


def test_three_levels_up_and_no_more(tmp_path: Path) -> None:
    write(tmp_path, "LICENSE", "a/b/c/d/model.xml")
    assert found(tmp_path, "a/b/c/model.xml") == ["LICENSE"]
    assert found(tmp_path, "a/b/c/d/model.xml") == []


def test_a_repository_is_not_left(tmp_path: Path) -> None:
    write(tmp_path, "LICENSE", "repo/.git/HEAD", "repo/arm/model.xml")
    assert found(tmp_path, "repo/arm/model.xml") == []
    write(tmp_path, "repo/LICENCE")
    assert found(tmp_path, "repo/arm/model.xml") == ["repo/LICENCE"]


def test_a_worktree_counts_as_a_repository(tmp_path: Path) -> None:
    write(tmp_path, "LICENSE", "repo/.git", "repo/model.xml")
    assert found(tmp_path, "repo/model.xml") == []


def test_the_base_is_not_left(tmp_path: Path) -> None:
    write(tmp_path, "LICENSE", "package/arm/model.xml")
    assert found(tmp_path, "package/arm/model.xml", tmp_path / "package") == []


def test_a_stray_licence_beside_all_packages_is_nobodys(tmp_path: Path) -> None:
    write(tmp_path, "site-packages/LICENSE", "site-packages/robots/model.xml")
    assert found(tmp_path, "site-packages/robots/model.xml") == []


def test_a_relative_path_is_searched_from_where_it_starts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path, "LICENSE", "recipes/x.yaml", "models/arm.xml")
    monkeypatch.chdir(tmp_path / "recipes")
    assert licence.find(Path("../models/arm.xml")) == ((tmp_path / "LICENSE").resolve(),)


def test_all_texts_in_a_folder_called_licenses_are_licences(tmp_path: Path) -> None:
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
    wanted = [
        "LICENSE.md",
        *(f"LICENSES/{each}" for each in ("CC-BY-4.0.txt", "MIT.txt", "left/hand/NOTICE")),
    ]
    assert found(tmp_path, "arm/model.xml") == wanted


def test_a_model_below_a_folder_called_licenses_is_no_licence(tmp_path: Path) -> None:
    write(tmp_path, "licenses/arm/readme.txt", "licenses/arm/arm.xml")
    assert found(tmp_path, "licenses/arm/arm.xml", tmp_path / "licenses") == []


@pytest.mark.parametrize(
    "name", ["LICENSE", "licence.md", "LICENSE-MIT", "COPYING.LESSER", "NOTICE.txt", "Licenses.txt"]
)
def test_names_of_licences(name: str) -> None:
    assert is_licence(name)


@pytest.mark.parametrize(
    "name", ["license.py", "licenses.json", "noticeboard", "README", "MY_LICENSE", "licensed.xml"]
)
def test_names_of_other_files(name: str) -> None:
    assert not is_licence(name)


def test_a_licence_that_is_put_there_later_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("composer.reading.memory._SETTLED", -1)  # else nothing is remembered of a new folder
    (tmp_path / "arm" / ".git").mkdir(parents=True)
    os.utime(tmp_path / "arm", (1, 1))
    assert found(tmp_path, "arm/arm.xml") == []
    write(tmp_path, "arm/LICENSE")
    assert found(tmp_path, "arm/arm.xml") == ["arm/LICENSE"]
