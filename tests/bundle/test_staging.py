from __future__ import annotations

import errno
import os
import stat
from pathlib import Path
from typing import Any

import pytest
from mjcompose.bundle.bundle import Bundle, OutputError
from mjcompose.bundle.manifest import Manifest, files_of, with_manifest
from mjcompose.bundle.staging import _put_back, staged_file, write_folder, write_mjb


def made(text: str = "<mujoco/>", **files: bytes) -> Bundle:
    bundle = Bundle({"model.xml": text.encode(), **{path.replace("__", "/"): data for path, data in files.items()}})
    return with_manifest(bundle, Manifest(name="m", mujoco=None, grammar="4.0", files=files_of(bundle)))


def contents(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_it_holds_the_files_of_the_bundle(tmp_path: Path) -> None:
    bundle = made(assets__left__a=b"1", assets__b=b"2")
    write_folder(bundle, tmp_path / "new" / "out")
    assert contents(tmp_path / "new" / "out") == bundle.files
    assert os.listdir(tmp_path / "new") == ["out"]


def test_an_earlier_output_is_replaced_whole(tmp_path: Path) -> None:
    write_folder(made("<mujoco/>", old=b""), tmp_path / "out")
    bundle = made("<mujoco model='2'/>", new=b"")
    write_folder(bundle, tmp_path / "out")
    assert contents(tmp_path / "out") == bundle.files
    assert os.listdir(tmp_path) == ["out"]


def test_an_empty_folder_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    write_folder(made(), tmp_path / "out")
    assert "model.xml" in contents(tmp_path / "out")


def test_what_viewers_leave_behind_does_not_matter(tmp_path: Path) -> None:
    write_folder(made(), tmp_path / "out")
    (tmp_path / "out" / "MUJOCO_LOG.TXT").write_text("WARNING")
    (tmp_path / "out" / "model.xml").write_text("edited")
    write_folder(made(), tmp_path / "out")
    assert contents(tmp_path / "out") == made().files


@pytest.mark.parametrize(
    "manifest",
    [
        None,
        "",
        "{}",
        "[]",
        '{"mjcompose": "1", "files": []}',
        '{"manifest": 1, "files": []}',
        '{"manifest": 1, "mjcompose": "1", "files": 3}',
        '{"manifest": 1, "mjcompose": "1"}',
        "[" * 100_000,
    ],
)
def test_a_folder_that_is_not_ours_stays(tmp_path: Path, manifest: str | None) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "thesis.tex").write_text("years of work")
    if manifest is not None:
        (out / "manifest.json").write_text(manifest)
    before = contents(out)
    with pytest.raises(OutputError) as caught:
        write_folder(made(), out)
    assert caught.value.code == "output-unwritable"
    assert "was not made by mjcompose" in caught.value.message
    assert caught.value.help
    assert contents(out) == before
    assert os.listdir(tmp_path) == ["out"]


def test_files_that_others_put_into_our_folder_stay(tmp_path: Path) -> None:
    out = tmp_path / "out"
    write_folder(made(), out)
    (out / "notes").mkdir()
    (out / "notes" / "a.txt").write_text("mine")
    (out / "data").symlink_to(tmp_path)
    before = contents(out)
    with pytest.raises(OutputError, match=r"did not write: `data`, `notes/a\.txt`"):
        write_folder(made("<mujoco model='2'/>"), out)
    assert contents(out) == before


def test_a_file_in_the_place_of_the_folder_stays(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("mine")
    with pytest.raises(OutputError, match="a file of that name is there"):
        write_folder(made(), tmp_path / "out")
    assert (tmp_path / "out").read_text() == "mine"


def test_a_file_above_the_folder_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="not a directory"):
        write_folder(made(), tmp_path / "file" / "out")


@pytest.mark.parametrize("call", range(1, 4))
def test_a_full_disk_leaves_the_old_output(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: int) -> None:
    out = tmp_path / "out"
    write_folder(made(old=b"1"), out)
    before = contents(out)
    open_file = Path.open
    calls = 0

    def full(path: Path, *arguments: Any, **options: Any) -> Any:
        nonlocal calls
        calls += 1
        if calls == call:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return open_file(path, *arguments, **options)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "open", full)
        # the manifest of the old output is read without Path.open
        patch.setattr(Path, "read_bytes", lambda path: os_read(path))
        with pytest.raises(OutputError) as caught:
            write_folder(made(a=b"1", b=b"2"), out)
    assert calls == call
    assert caught.value.message == f"cannot write `{out}`: no space left on device"
    assert caught.value.help == "make room on the disk, or choose another place"
    assert contents(out) == before
    assert os.listdir(tmp_path) == ["out"]


def os_read(path: Path) -> bytes:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        return os.read(descriptor, 1 << 20)
    finally:
        os.close(descriptor)


@pytest.mark.parametrize("failing", [1, 2])
@pytest.mark.parametrize("failure", [OSError(errno.EBUSY, "Busy"), KeyboardInterrupt()])
def test_a_rename_that_fails_is_rolled_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failing: int, failure: BaseException
) -> None:
    out = tmp_path / "out"
    write_folder(made(old=b"1"), out)
    before = contents(out)
    rename = Path.replace
    calls = 0

    def fails(path: Path, target: Path) -> Path:
        nonlocal calls
        calls += 1
        if calls == failing:
            raise failure
        return rename(path, target)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", fails)
        with pytest.raises((OutputError, KeyboardInterrupt)):
            write_folder(made(), out)
    assert calls >= failing
    assert contents(out) == before
    assert os.listdir(tmp_path) == ["out"]


def test_a_failure_leaves_no_new_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(path: Path, target: Path) -> Path:
        raise OSError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(Path, "replace", fails)
    with pytest.raises(OutputError, match="permission denied"):
        write_folder(made(), tmp_path / "a" / "b")
    assert os.listdir(tmp_path) == []


@pytest.mark.skipif(os.name != "posix", reason="only POSIX has a umask")
def test_it_is_as_readable_as_other_folders(tmp_path: Path) -> None:
    write_folder(made(), tmp_path / "out")
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "file").write_text("")
    assert stat.S_IMODE((tmp_path / "out").stat().st_mode) == stat.S_IMODE((tmp_path / "other").stat().st_mode)
    mode = (tmp_path / "out" / "model.xml").stat().st_mode
    assert mode == (tmp_path / "other" / "file").stat().st_mode


def test_where_a_link_points_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to("real")
    write_folder(made(), tmp_path / "link")
    assert (tmp_path / "link").is_symlink()
    assert "model.xml" in contents(tmp_path / "real")


TETRAHEDRON = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
MODEL = b"""<mujoco><asset><mesh name="m" file="assets/t.obj"/></asset>
<worldbody><geom type="mesh" mesh="m"/></worldbody></mujoco>"""


def test_mujoco_opens_it_from_another_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mujoco = pytest.importorskip("mujoco")
    write_mjb(Bundle({"model.xml": MODEL, "assets/t.obj": TETRAHEDRON}), tmp_path / "new" / "arm.mjb")
    monkeypatch.chdir(tmp_path)
    assert mujoco.MjModel.from_binary_path(str(tmp_path / "new" / "arm.mjb")).nmesh == 1
    assert os.listdir(tmp_path / "new") == ["arm.mjb"]


def test_the_same_model_is_the_same_bytes(tmp_path: Path) -> None:
    """The paths of assets, which MuJoCo keeps in it, are those in the bundle and not those of a temporary folder."""
    mujoco = pytest.importorskip("mujoco")
    for name in ("one.mjb", "two.mjb"):
        write_mjb(Bundle({"model.xml": MODEL, "assets/t.obj": TETRAHEDRON}), tmp_path / name)
    assert (tmp_path / "one.mjb").read_bytes() == (tmp_path / "two.mjb").read_bytes()
    assert mujoco.MjModel.from_binary_path(str(tmp_path / "one.mjb")).paths == b"assets/t.obj\0"


def test_a_model_that_does_not_compile_leaves_the_old_file(tmp_path: Path) -> None:
    out = tmp_path / "arm.mjb"
    out.write_bytes(b"old")
    with pytest.raises(OutputError, match=r"assets/t\.obj"):
        write_mjb(Bundle({"model.xml": MODEL}), out)
    assert out.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["arm.mjb"]


def test_the_file_is_there_only_when_the_block_ends(tmp_path: Path) -> None:
    out = tmp_path / "new" / "folder" / "out"
    with staged_file(out) as stage:
        stage.write_text("done")
        assert not out.exists()
        assert stage.parent.parent == out.parent
    assert out.read_text() == "done"
    assert os.listdir(out.parent) == ["out"]


@pytest.mark.parametrize("failure", [RuntimeError, KeyboardInterrupt])
def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path: Path, failure: type[BaseException]) -> None:
    out = tmp_path / "out"
    out.write_text("old")
    with pytest.raises(failure), staged_file(out) as stage:
        stage.write_text("half")
        raise failure
    assert out.read_text() == "old"
    assert os.listdir(tmp_path) == ["out"]


def test_a_failure_takes_the_new_folders_with_it(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError), staged_file(tmp_path / "a" / "b" / "out") as stage:
        stage.write_text("half")
        raise RuntimeError
    assert os.listdir(tmp_path) == []


def test_a_fault_of_the_file_system_is_an_output_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError) as caught, staged_file(tmp_path / "file" / "out"):
        pass
    assert caught.value.code == "output-unwritable"
    assert caught.value.message == f"cannot write `{tmp_path / 'file' / 'out'}`: not a directory"


def test_a_file_does_not_replace_a_folder(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    with pytest.raises(OutputError, match="a folder of that name is there"), staged_file(tmp_path / "out"):
        pass


def test_what_a_link_points_to_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "real").write_text("old")
    (tmp_path / "link").symlink_to("real")
    with staged_file(tmp_path / "link") as stage:
        stage.write_text("new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_text() == "new"


def test_an_older_output_is_not_put_over_a_link(tmp_path: Path) -> None:
    left = tmp_path / f".out.tmp-{'0' * 12}"
    (left / "old-output").mkdir(parents=True)
    (tmp_path / "out").symlink_to(tmp_path / "nowhere")
    _put_back(left)
    assert (tmp_path / "out").is_symlink() and (left / "old-output").is_dir()
    (tmp_path / "out").unlink()
    _put_back(left)
    assert (tmp_path / "out").is_dir() and not (left / "old-output").exists()
