"""A mirror of files: what is there, where links lead, and paths that come home as they are here."""

from __future__ import annotations

import hashlib
import os
import pickle
from dataclasses import dataclass
from pathlib import Path

import pytest
from mjcompose.tools.cluster import uploads
from mjcompose.tools.cluster.uploads import batches, lay_out, layout_of, loaded, without_root

pytestmark = pytest.mark.skipif(os.name != "posix", reason="links")


@dataclass(frozen=True)
class Told:
    path: Path
    words: tuple[str, ...]


@pytest.fixture
def files(tmp_path: Path) -> Path:
    folder = tmp_path / "here"
    (folder / "project" / ".git").mkdir(parents=True)
    (folder / "project" / "models").mkdir()
    (folder / "project" / "models" / "arm.xml").write_text("<mujoco/>")
    (folder / "far").mkdir()
    (folder / "far" / "mesh.obj").write_text("v 0 0 0")
    (folder / "project" / "meshes").symlink_to("../far")
    return folder


def mirrored(paths: list[Path], root: Path) -> Path:
    layout = layout_of(map(str, paths))
    known = {hashlib.sha256(path.read_bytes()).hexdigest(): path for path in map(Path, layout.files)}
    root.mkdir()
    lay_out(layout, root, known.__getitem__)
    return root


def test_files_stand_under_the_same_paths_and_links_lead_there(files: Path, tmp_path: Path) -> None:
    project = files / "project"
    root = mirrored([project / "models" / "arm.xml", project / "meshes" / "mesh.obj"], tmp_path / "root")
    there = root / project.relative_to("/")
    assert (there / "models" / "arm.xml").read_text() == "<mujoco/>"
    assert (there / "meshes" / "mesh.obj").read_text() == "v 0 0 0" and (there / "meshes").is_symlink()
    assert os.path.realpath(there / "meshes").startswith(os.path.realpath(root))
    assert (there / ".git").is_dir()  # what makes it a project, for its models may read all of it


def test_what_is_not_there_is_not_there(files: Path, tmp_path: Path) -> None:
    root = mirrored([files / "project" / "LICENSE", files / "project" / "models"], tmp_path / "root")
    there = root / files.relative_to("/") / "project"
    assert not (there / "LICENSE").exists() and (there / "models").is_dir() and not list((there / "models").iterdir())


def test_a_link_to_itself_has_an_end(tmp_path: Path) -> None:
    (tmp_path / "loop").symlink_to("loop")
    assert not layout_of([str(tmp_path / "loop")]).files


def test_paths_go_below_the_root_and_come_home() -> None:
    told = Told(Path("/project/a.xml"), ("in /project/a.xml:3", "b"))
    there = loaded(pickle.dumps(told), "/mirror")
    assert there.path == Path("/mirror/project/a.xml")
    assert loaded(pickle.dumps(Path("models/a.xml")), "/mirror") == Path("models/a.xml")
    said = Told(there.path, ("in /mirror/project/a.xml:3", "b"))
    assert without_root([said, {"/mirror/a": 1}], "/mirror") == [told, {"/a": 1}]


class CountedBytes(bytes):
    """A file's content that counts how often something takes its length."""

    lengths = 0

    def __len__(self) -> int:
        CountedBytes.lengths += 1
        return super().__len__()


def test_batches_are_limited_and_measure_each_file_once(monkeypatch: pytest.MonkeyPatch) -> None:
    contents = {f"mesh{number}.obj": CountedBytes(b"v %d 0 0" % number) for number in range(200)}
    digests = {hashlib.sha256(content).hexdigest(): path for path, content in contents.items()}
    monkeypatch.setattr(uploads, "read_regular", contents.__getitem__)
    monkeypatch.setattr(uploads, "_AT_ONCE", 500)
    CountedBytes.lengths = 0
    sent = list(batches(digests))
    assert CountedBytes.lengths == len(contents)
    assert [digest for batch in sent for digest in batch] == list(digests)
    sizes = [sum(map(len, batch.values())) for batch in sent]
    assert len(sizes) > 2 and all(500 < size < 520 for size in sizes[:-1])
