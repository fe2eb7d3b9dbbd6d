"""Workers with another disk: sources are sent, and the models are those of this machine, wherever they go."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from cli.balls import MODEL
from tools.cluster.dask_cluster import Cluster, wait_for
from tools.cluster.test_client import RECIPE, digests, run, start

pytest.importorskip("distributed", reason="needs `mjcompose[cluster]`")
pytestmark = [pytest.mark.slow, pytest.mark.skipif(os.name != "posix", reason="signals")]
MESH = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A recipe that extends another, with a mesh behind a link and a license above."""
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(tmp_path / "store"))
    here = tmp_path / "here"
    (here / "parts").mkdir(parents=True)
    (here / ".git").mkdir()
    monkeypatch.chdir(here)
    (here / "far").mkdir()
    (here / "far" / "tool.obj").write_text(MESH)
    (here / "parts" / "meshes").symlink_to("../far")
    (here / "LICENSE").write_text("MIT License\n")
    mesh = MODEL.replace("<mujoco>", '<mujoco><asset><mesh file="meshes/tool.obj"/></asset>')
    mesh = mesh.replace('<geom name="g"', '<geom type="mesh" mesh="tool"/><geom name="g"')
    (here / "parts" / "model.xml").write_text(mesh)
    (here / "base.yaml").write_text(RECIPE.replace("./model.xml", "./parts/model.xml"))
    (here / "r.yaml").write_text("recipe: 1\nextends: ./base.yaml\n")
    return here


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    """Two workers that read none of this machine's files, for all tests here."""
    found = Cluster(tmp_path_factory.mktemp("dask"))
    try:
        found.add(2, MJCOMPOSE_SHIPPED="1")
        yield found
    finally:
        found.end()


def test_the_models_and_the_words_are_the_same(folder: Path, cluster: Cluster) -> None:
    seen = []
    for words in (("--jobs", "2"), ("--cluster", str(cluster.file))):
        told = run("build", "r.yaml", "--all", "--no-cache", "-o", "out/{name}/", *words)
        seen.append((*told, digests(folder / "out")))
        (folder / "out").rename(folder / words[0])
    assert seen[0] == seen[1] and seen[0][0] == 1
    assert "ball-1-s0001/assets/model/meshes/tool.obj" in str(seen[1][3]) or "tool.obj" in str(seen[1][3])


def test_sources_are_sent_once_to_each_worker(folder: Path, cluster: Cluster) -> None:
    for _ in range(2):
        run("build", "r.yaml", "--all", "--no-cache", "-o", "out/{name}/", "--cluster", str(cluster.file))
    sent = sorted(cluster.folder.glob("dask-scratch-space*/worker-*/mjcompose-sources/*"))
    names = [each.name for each in sent]
    assert len(names) == 2 * len(set(names)) >= 8  # two workers, and each content once
    assert len({each.stat().st_mtime_ns for each in sent}) >= 2


def test_what_was_made_elsewhere_is_known_here(folder: Path, cluster: Cluster) -> None:
    words = ("build", "r.yaml", "--pick", "size=1", "-o", "out/{name}/")
    assert run(*words, "--cluster", str(cluster.file))[0] == 0
    assert run(*words)[1].count("is up to date") == 4
    recipe = (folder / "base.yaml").read_text()
    (folder / "base.yaml").write_text(recipe.replace("${size}", "${size / 2}"))
    assert run(*words)[1].count("wrote out/ball") == 4
    (folder / "base.yaml").write_text(recipe)
    (folder / "far" / "tool.obj").write_text(MESH.replace("v 1 0 0", "v 2 0 0"))
    assert run(*words, "--cluster", str(cluster.file))[1].count("wrote out/ball") == 4


def test_what_a_killed_run_has_written_is_not_built_again(folder: Path, cluster: Cluster) -> None:
    """The client is gone; the workers finish what they have."""
    many = RECIPE.replace("./model.xml", "./parts/model.xml").replace("[1, 2, -1]", "[1]")
    (folder / "base.yaml").write_text(many.replace("samples: 3", "samples: 60"))
    words = ("build", "r.yaml", "--all", "-o", "out/{name}/", "--cluster", str(cluster.file))
    process = start(*words)
    manifests = "out/ball*/manifest.json"
    wait_for(lambda: len(list(folder.glob(manifests))) >= 9)
    process.kill()
    process.communicate()
    time.sleep(3)
    before = {path: path.stat().st_ino for path in folder.glob(manifests)}
    assert run(*words)[0] == 0
    after = {path: path.stat().st_ino for path in folder.glob(manifests)}
    assert len(after) == 61 and before.items() <= after.items()
    assert not (folder / "out" / ".mjcompose-cluster").exists()


def test_a_file_that_is_not_foreseen_is_used_here(folder: Path, cluster: Cluster) -> None:
    """A number that decides which file is used: that model is made here, which is said."""
    for number in (1, 2):
        (folder / f"model-{number}.xml").write_text(MODEL)
    (folder / "r.yaml").write_text(
        "recipe: 1\nname: ball\nbase: ./model-${size}.xml\nparams: {size: 1}\nmatrix: {axes: {size: [1, 2]}}\n"
    )
    seen = []
    for words in (("--jobs", "2"), ("--cluster", str(cluster.file))):
        code, said, faults = run("build", "r.yaml", "--all", "--no-cache", "-o", "out/{name}/", *words)
        lines = [line for line in faults.splitlines() if "was made here" not in line]
        seen.append((code, said, lines, digests(folder / "out")))
        (folder / "out").rename(folder / words[0])
    assert seen[0] == seen[1] and seen[0][0] == 0
    assert faults.count("`ball-2` was made here") == 1


def test_text_alone_is_refused(folder: Path, cluster: Cluster) -> None:
    code, _, faults = run("build", "r.yaml", "--all", "-o", "out/{name}.xml", "--cluster", str(cluster.file))
    assert code == 1 and faults.count("error[cluster-worker]") == 1 and "MJCF alone only names" in faults


S3 = """
import os, subprocess, sys
import boto3
from moto.server import ThreadedMotoServer
server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
server.start()
host, port = server.get_host_and_port()
os.environ.update(AWS_ACCESS_KEY_ID="key", AWS_SECRET_ACCESS_KEY="secret", AWS_DEFAULT_REGION="us-east-1",
                  AWS_ENDPOINT_URL=f"http://{host}:{port}")
boto3.client("s3").create_bucket(Bucket="bucket")
build = [sys.executable, "-m", "mjcompose", "build", "r.yaml", "--all", "--cluster", "local", "--jobs", "1"]
for form, counts in (("{hash}/{name}.zip", ["wrote s3://", "is up to date"]), ("{name}/", ["wrote s3://"])):
    out = "s3://bucket/" + str(len(form))
    for count in counts:
        told = subprocess.run([*build, "-o", f"{out}/{form}"], capture_output=True, text=True)
        assert told.returncode == 1 and told.stdout.count(count) >= 4, (told.stdout, told.stderr)
    import mjcompose
    found = list(mjcompose.load_many(out, where="sample > 0"))
    assert len(found) == 3 and found[0].load().model.ngeom == 2
server.stop()
"""


def test_a_server_of_s3(folder: Path) -> None:
    pytest.importorskip("s3fs", reason="needs `s3fs`")
    pytest.importorskip("moto.server", reason="needs `moto[server]`")
    (folder / "s3.py").write_text(S3)
    environment = {**os.environ, "MJCOMPOSE_SHIPPED": "1"}
    process = subprocess.run(
        [sys.executable, "s3.py"], env=environment, capture_output=True, text=True, timeout=200, check=False
    )
    assert process.returncode == 0, process.stderr
