from __future__ import annotations

import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from composer.bundle.bundle import Bundle, BundleError, check_paths

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
    ("one", "two"),
    [("a/X.obj", "A/x.obj"), ("straße", "STRASSE"), ("\u00e9", "e\u0301"), ("Model.XML", "model.xml")],
)
def test_paths_that_are_one_where_case_does_not_count_are_refused(one: str, two: str) -> None:
    with pytest.raises(BundleError, match="are one file where case does not count"):
        check_paths([one, two])


@pytest.mark.parametrize("paths", [["a", "a/b"], ["a/b", "a"], ["A/b/c", "a/B"]])
def test_a_path_cannot_be_a_file_and_a_folder(paths: list[str]) -> None:
    with pytest.raises(BundleError, match="is a file and, for"):
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
