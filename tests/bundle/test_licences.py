from __future__ import annotations

from pathlib import Path

import pytest

from composer.bundle.bundle import check_paths
from composer.bundle.licences import licence_files, licence_folder


def put(path: Path, text: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def test_each_label_has_a_folder(tmp_path: Path) -> None:
    arm, hand = put(tmp_path / "arm" / "LICENSE", "Apache"), put(tmp_path / "hand" / "LICENSE", "BSD")
    notice = put(tmp_path / "hand" / "NOTICE.txt", "thanks")
    found = licence_files({"base": [arm], "left/gripper": [hand, notice], "none": []})
    assert found.files == {
        "LICENSES/base/LICENSE": b"Apache",
        "LICENSES/left/gripper/LICENSE": b"BSD",
        "LICENSES/left/gripper/NOTICE.txt": b"thanks",
    }
    assert found.of == {
        "base": ("LICENSES/base/LICENSE",),
        "left/gripper": ("LICENSES/left/gripper/LICENSE", "LICENSES/left/gripper/NOTICE.txt"),
        "none": (),
    }


def test_equal_files_of_several_labels_are_kept_once(tmp_path: Path) -> None:
    brick, other = put(tmp_path / "brick" / "LICENSE", "MIT"), put(tmp_path / "other" / "LICENSE", "MIT")
    named = put(tmp_path / "named" / "COPYING", "MIT")
    read: list[Path] = []

    def reading(path: Path) -> bytes:
        read.append(path)
        return path.read_bytes()

    found = licence_files({"b0": [brick], "b1": [brick], "c": [other], "d": [named]}, reading)
    assert found.files == {"LICENSES/b0/LICENSE": b"MIT", "LICENSES/d/COPYING": b"MIT"}
    assert [found.of[label] for label in ("b0", "b1", "c")] == [("LICENSES/b0/LICENSE",)] * 3
    assert len(read) == 3  # no file twice


def test_equal_names_of_one_label_are_numbered_and_equal_files_kept_once(tmp_path: Path) -> None:
    files = [
        put(tmp_path / folder / "LICENSE.txt", text) for folder, text in zip("abcd", "xyxz", strict=True)
    ]
    assert licence_files({"p": files}).files == {
        "LICENSES/p/LICENSE.txt": b"x",
        "LICENSES/p/LICENSE-2.txt": b"y",
        "LICENSES/p/LICENSE-3.txt": b"z",
    }


def test_files_that_differ_in_case_do_not_meet(tmp_path: Path) -> None:
    files = [put(tmp_path / "a" / "LICENSE", "x"), put(tmp_path / "b" / "License", "y")]
    found = licence_files({"p": files}).files
    assert sorted(found.values()) == [b"x", b"y"]
    check_paths(found)


@pytest.mark.parametrize(
    ("label", "folder"),
    [
        ("left/gripper", "LICENSES/left/gripper"),
        ("../../etc", "LICENSES/_/_/etc"),
        ("C:\\x y", "LICENSES/C_/x_y"),
        ("", "LICENSES/model"),
        ("größe", "LICENSES/größe"),
    ],
)
def test_a_label_becomes_a_folder_that_every_system_can_hold(label: str, folder: str) -> None:
    assert licence_folder(label) == folder
    check_paths([f"{folder}/LICENSE"])
