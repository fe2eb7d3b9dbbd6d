"""The time of the files in an archive, ours and those of others."""

from __future__ import annotations

import errno
import os
import pickle
import zipfile
from io import BytesIO
from pathlib import Path

import pytest
from hypothesis import given, strategies as st
from mjcompose.base.codes import CODES
from mjcompose.bundle.bundle import (
    Bundle,
    BundleError,
    check_paths,
    license_files,
    license_folder,
    unwritable_error,
    with_moment,
)

MODEL = b"<mujoco/>"


def test_files_are_sorted_and_read_only() -> None:
    bundle = Bundle({"model.xml": MODEL, "assets/b.obj": b"b", "assets/a.obj": b"a"})
    assert list(bundle.files) == ["assets/a.obj", "assets/b.obj", "model.xml"]
    with pytest.raises(TypeError):
        bundle.files["x"] = b""  # type: ignore[index]


def test_it_does_not_follow_changes_of_the_mapping_it_was_made_from() -> None:
    files = {"model.xml": MODEL}
    bundle = Bundle(files)
    files["late"] = b""
    assert list(bundle.files) == ["model.xml"]


@pytest.mark.parametrize(
    ("path", "fault"),
    [
        ("/etc/passwd", "it is absolute"),
        ("C:/x", "it is absolute"),
        ("c:x", "it is absolute"),
        ("../x", "it leads out of the bundle"),
        ("a/../../x", "it leads out of the bundle"),
        ("a/..", "it leads out of the bundle"),
        ("a\\b", "it has a backslash"),
        ("a//b", "it has an empty segment"),
        ("a/", "it has an empty segment"),
        ("./a", "it has an empty segment"),
        ("", "it has an empty segment"),
        ("a\nb", "it has a control character"),
        ("a\x00", "it has a control character"),
        ("\ud800", "it is not Unicode text"),
    ],
)
def test_a_path_that_is_not_plain_and_relative_is_refused(path: str, fault: str) -> None:
    with pytest.raises(BundleError) as caught:
        Bundle({"model.xml": MODEL, path: b""})
    assert str(caught.value).endswith(f"cannot be a path in a bundle: {fault}")


@pytest.mark.parametrize("path", ["..a/b..", "a b/ü.obj", ".hidden", "left:a", "100%.obj"])
def test_odd_but_harmless_paths_are_kept(path: str) -> None:
    assert path in Bundle({"model.xml": MODEL, path: b""}).files


@pytest.mark.parametrize(
    ("one", "two"), [("a/X.obj", "A/x.obj"), ("straße", "STRASSE"), ("\u00e9", "e\u0301"), ("Model.XML", "model.xml")]
)
def test_paths_that_are_one_where_case_does_not_count_are_refused(one: str, two: str) -> None:
    with pytest.raises(BundleError, match="are the same file on systems that ignore case"):
        check_paths([one, two])


@pytest.mark.parametrize("paths", [["a", "a/b"], ["a/b", "a"], ["A/b/c", "a/B"]])
def test_a_path_cannot_be_a_file_and_a_folder(paths: list[str]) -> None:
    with pytest.raises(BundleError, match="is a file, but"):
        check_paths(paths)


def test_the_model_is_one_of_the_files() -> None:
    with pytest.raises(BundleError, match=r"the bundle has no `arm\.xml`"):
        Bundle({"model.xml": MODEL}, "arm.xml")


def test_its_identity_is_known() -> None:
    """A change of this value changes the identity of everything that was ever built."""
    bundle = Bundle({"model.xml": MODEL, "assets/a.obj": b"a"})
    assert bundle.sha256 == "60208c2a0925fa7fd9b2a964e68f1aa560393c0ca5c2896edebea85b8f5b620c"


def test_its_identity_is_that_of_paths_and_contents() -> None:
    bundle = Bundle({"model.xml": MODEL, "a": b"1", "b": b"2"})
    assert Bundle({"b": b"2", "a": b"1", "model.xml": MODEL}).sha256 == bundle.sha256
    others = [
        {"model.xml": MODEL, "a": b"2", "b": b"1"},
        {"model.xml": MODEL, "a": b"1", "c": b"2"},
        {"model.xml": MODEL, "a": b"1"},
        {"model.xml": MODEL, "a": b"1", "b": b"2", "c": b""},
    ]
    assert bundle.sha256 not in {Bundle(files).sha256 for files in others}


@given(st.dictionaries(st.text("ab/", min_size=1, max_size=4), st.binary(max_size=3), max_size=5))
def test_equal_identities_mean_equal_files(files: dict[str, bytes]) -> None:
    try:
        bundle = Bundle({**files, "model.xml": MODEL})
    except BundleError:
        return
    for path in files:
        assert bundle.with_files({path: files[path] + b"!"}).sha256 != bundle.sha256


def test_files_are_added_without_changing_the_bundle() -> None:
    bundle = Bundle({"model.xml": MODEL})
    assert list(bundle.with_files({"manifest.json": b"{}"}).files) == ["manifest.json", "model.xml"]
    assert list(bundle.files) == ["model.xml"]


def test_only_what_is_new_is_hashed_again() -> None:
    first = Bundle({"model.xml": b"<mujoco/>", "a.obj": b"1", "b.obj": b"2"})
    identity = first.sha256
    second = first.with_files({"b.obj": b"3"})
    assert second._digests.keys() == {"model.xml", "a.obj"}
    assert second.sha256 == Bundle(dict(second.files)).sha256 != identity


def test_it_can_be_sent_to_another_process() -> None:
    bundle = Bundle({"arm.xml": MODEL, "a": b"1"}, "arm.xml")
    copy = pickle.loads(pickle.dumps(bundle))
    assert copy == bundle
    assert copy.sha256 == bundle.sha256


def put(path: Path, text: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def test_each_label_has_a_folder(tmp_path: Path) -> None:
    arm = put(tmp_path / "arm" / "LICENSE", "Apache")
    hand = put(tmp_path / "hand" / "LICENSE", "BSD")
    notice = put(tmp_path / "hand" / "NOTICE.txt", "thanks")
    found = license_files({"base": [arm], "left/gripper": [hand, notice], "none": []})
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
    brick = put(tmp_path / "brick" / "LICENSE", "MIT")
    other = put(tmp_path / "other" / "LICENSE", "MIT")
    named = put(tmp_path / "named" / "COPYING", "MIT")
    read: list[Path] = []

    def reading(path: Path) -> bytes:
        read.append(path)
        return path.read_bytes()

    found = license_files({"b0": [brick], "b1": [brick], "c": [other], "d": [named]}, reading)
    assert found.files == {"LICENSES/b0/LICENSE": b"MIT", "LICENSES/d/COPYING": b"MIT"}
    assert [found.of[label] for label in ("b0", "b1", "c")] == [("LICENSES/b0/LICENSE",)] * 3
    assert len(read) == 3  # no file twice


def test_equal_names_of_one_label_are_numbered_and_equal_files_kept_once(tmp_path: Path) -> None:
    files = [put(tmp_path / folder / "LICENSE.txt", text) for folder, text in zip("abcd", "xyxz", strict=True)]
    assert license_files({"p": files}).files == {
        "LICENSES/p/LICENSE.txt": b"x",
        "LICENSES/p/LICENSE-2.txt": b"y",
        "LICENSES/p/LICENSE-3.txt": b"z",
    }


def test_files_that_differ_in_case_do_not_meet(tmp_path: Path) -> None:
    files = [put(tmp_path / "a" / "LICENSE", "x"), put(tmp_path / "b" / "License", "y")]
    found = license_files({"p": files}).files
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
    assert license_folder(label) == folder
    check_paths([f"{folder}/LICENSE"])


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EACCES, errno.EROFS, errno.ENAMETOOLONG])
def test_a_refusal_of_the_system_says_what_to_do(number: int) -> None:
    error = unwritable_error("out", OSError(number, os.strerror(number)))
    assert error.code == ("output-full" if number == errno.ENOSPC else "output-unwritable")
    assert error.code in CODES
    assert error.message == f"cannot write `out`: {os.strerror(number).lower()}"
    assert error.help


def test_an_error_without_a_number_is_told_by_its_text() -> None:
    assert unwritable_error("out", OSError("Odd")).message == "cannot write `out`: odd"
    assert unwritable_error("out", OSError()).message == "cannot write `out`: oserror"


MOMENT = (2023, 11, 14, 22, 13, 20)


def test_an_archive_of_others_gets_the_time_and_stays_as_it_is() -> None:
    made = BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        for name in ("a.usdc", "Textures/ü.png"):
            info = zipfile.ZipInfo(name, (1999, 12, 31, 23, 59, 58))
            info.extra = b"\x86\x19\x04\x00\0\0\0\0"
            info.comment = b"a comment"
            archive.writestr(info, name.encode() * 50)
    changed = with_moment(made.getvalue(), MOMENT)
    assert len(changed) == len(made.getvalue())
    with zipfile.ZipFile(BytesIO(changed)) as archive:
        assert archive.testzip() is None
        assert [(info.filename, info.date_time) for info in archive.infolist()] == [
            ("a.usdc", MOMENT),
            ("Textures/ü.png", MOMENT),
        ]
    assert with_moment(changed, (1999, 12, 31, 23, 59, 58)) == made.getvalue()
