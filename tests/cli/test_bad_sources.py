"""Sources that are not what they were, or are out of reach: one error at its place, the store and old outputs intact."""

from __future__ import annotations

import hashlib
import io
import json
import os
import signal
import subprocess
import sys
import tarfile
import time
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from cli.shell import environment, process, run, snapshot
from mjcompose.sources import web_archive
from mjcompose.sources.store import Store
from sampling import rest_slow

MODEL = b'<mujoco model="arm"><worldbody><body name="arm"><geom size="0.1"/></body></worldbody></mujoco>\n'
OTHER = MODEL.replace(b"0.1", b"0.2")
NOBODY = "127.0.0.1:9"  # the port at which everything is thrown away: nobody listens there


def zipped(**files: bytes) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    return stream.getvalue()


def tarred(name: str, type: bytes, leads_to: str = "") -> bytes:
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w") as archive:
        arm = tarfile.TarInfo("arm.xml")
        arm.size = len(MODEL)
        archive.addfile(arm, io.BytesIO(MODEL))
        member = tarfile.TarInfo(name)
        member.type = type
        member.linkname = leads_to
        archive.addfile(member)
    return stream.getvalue()


GOOD = zipped(**{"arm.xml": MODEL})
CHANGED = zipped(**{"arm.xml": OTHER})


@dataclass
class World:
    """A folder with `good.yaml`, which was built to `out/`; a repository and a web server beside it."""

    folder: Path
    robots: Any
    web: Any

    @property
    def store(self) -> Store:
        return Store(self.folder.parent / "store")

    def recipe(self, reference: str) -> None:
        (self.folder / "bad.yaml").write_text(f"recipe: 1\nbase: {reference}\n")

    def archive(self, content: bytes) -> str:
        self.web.pages["/a.zip"] = content
        return f"{self.web.url}/a.zip#arm.xml"


@pytest.fixture
def world(tmp_path: Path, robots: Any, web: Any, monkeypatch: pytest.MonkeyPatch) -> World:
    folder = tmp_path / "work"
    folder.mkdir()
    monkeypatch.chdir(folder)
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(tmp_path / "store"))
    monkeypatch.setenv("MJCOMPOSE_TIMEOUT", "5")
    web.pages["/good.zip"] = GOOD
    (folder / "good.yaml").write_text(
        f"recipe: 1\nbase: {robots.reference('main')}\nattach:\n  two: {{model: {web.url}/good.zip#arm.xml}}\n"
    )
    assert run("build", "good.yaml", "-o", "out/").exit_code == 0
    return World(folder, robots, web)


def locked(world: World, reference: str) -> None:
    world.recipe(reference)
    done = run("lock", "bad.yaml")
    assert done.exit_code == 0, done.stderr


def other_sha256(world: World) -> str:
    name, path = world.archive(GOOD).split("#")
    return f"{name}@sha256:{hashlib.sha256(CHANGED).hexdigest()}#{path}"


def other_archive_than_locked(world: World) -> None:
    locked(world, world.archive(GOOD))
    run("cache", "prune", "--all")
    world.archive(CHANGED)


def branch_that_lost_its_commit(world: World) -> None:
    world.robots.commit(**{"arm/arm.xml": OTHER.decode()})
    locked(world, world.robots.reference("main"))
    world.robots.git("reset", "-q", "--hard", "HEAD~1")
    world.robots.git("reflog", "expire", "--expire=now", "--all")
    world.robots.git("gc", "-q", "--prune=now")
    run("cache", "prune", "--all")


def lock_with_another_commit(world: World) -> None:
    locked(world, world.robots.reference("main"))
    new = world.robots.commit(**{"arm/arm.xml": OTHER.decode()})
    _edit_lock(world, lambda source: source.update(commit=new))


def lock_with_another_hash(world: World) -> None:
    locked(world, world.robots.reference("main"))
    _edit_lock(world, lambda source: source["files"].update({"arm/arm.xml": "0" * 64}))


def _edit_lock(world: World, edit: Callable[[dict[str, Any]], None]) -> None:
    path = world.folder / "bad.lock"
    told = json.loads(path.read_text())
    for source in told["sources"].values():
        edit(source)
    path.write_text(json.dumps(told, indent=2))


CASES: dict[str, tuple[Callable[[World], str | None], str, str]] = {
    "another sha256 than the reference says": (other_sha256, "source-changed", "that the reference pins"),
    "another archive than the lock says": (other_archive_than_locked, "source-changed", "`arm.xml` changed"),
    "a branch that lost its commit": (
        branch_that_lost_its_commit,
        "source-revision",
        "the branch or tag was moved",
    ),
    "a tag that does not exist": (
        lambda world: world.robots.reference("v2"),
        "source-revision",
        "tags that exist: v1",
    ),
    "a commit that never was": (
        lambda world: world.robots.reference("0" * 40),
        "source-revision",
        "has no commit",
    ),
    "a host of git that is gone": (
        lambda world: f"git+http://{NOBODY}/robots@main#arm/arm.xml",
        "source-fetch",
        "cannot be fetched",
    ),
    "a host of archives that is gone": (
        lambda world: f"http://{NOBODY}/a.zip#arm.xml",
        "source-fetch",
        "cannot be fetched",
    ),
    "a repository without the file": (
        lambda world: world.robots.reference("main", "arm/leg.xml"),
        "source-not-found",
        "arm/arm.xml",
    ),
    "an archive without the file": (
        lambda world: world.archive(zipped(**{"leg.xml": MODEL})),
        "source-not-found",
        "leg.xml",
    ),
    "an archive that escapes its folder": (
        lambda world: world.archive(zipped(**{"arm.xml": MODEL, "../out.xml": MODEL})),
        "archive-refused",
        "leads out",
    ),
    "an archive with a link": (
        lambda world: world.archive(tarred("a", tarfile.SYMTYPE, "/etc/passwd")),
        "archive-refused",
        "a link",
    ),
    "an archive with a device": (
        lambda world: world.archive(tarred("a", tarfile.CHRTYPE)),
        "archive-refused",
        "a device",
    ),
    "an archive that is a bomb": (
        lambda world: world.archive(zipped(**{"arm.xml": MODEL, "b": bytes(1 << 24)})),
        "archive-refused",
        "only bombs do",
    ),
    "a lock with another commit": (lock_with_another_commit, "source-changed", "`arm/arm.xml` changed"),
    "a lock with another hash": (lock_with_another_hash, "source-changed", "`arm/arm.xml` changed"),
}
QUICK = [
    "another archive than the lock says",
    "a tag that does not exist",
    "a host of archives that is gone",
    "an archive that escapes its folder",
    "a lock with another hash",
]


@pytest.mark.parametrize("case", rest_slow(CASES, QUICK))
def test_one_error_at_its_place(world: World, case: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(web_archive, "SMALL", 1024 * 1024)
    prepare, code, said = CASES[case]
    reference = prepare(world)
    if reference is not None:
        world.recipe(reference)
    outputs = snapshot(world.folder / "out")
    lock = world.folder / "bad.lock"
    text = lock.read_bytes() if lock.is_file() else None
    entries = {entry.key for entry in world.store.entries()}
    for arguments in (("build", "bad.yaml", "-o", "out/"), ("lock", "bad.yaml")):
        result = run(*arguments)
        assert result.exit_code == 1, result.output
        assert f"error[{code}]: " in result.stderr and said in result.stderr
        assert result.stderr.rstrip().endswith("\n1 error")
        if arguments[0] == "build":
            assert result.stderr.startswith("bad.yaml:2:7: error")
    assert snapshot(world.folder / "out") == outputs
    assert (lock.read_bytes() if lock.is_file() else None) == text
    whole = world.store.entries()
    assert entries <= {entry.key for entry in whole}
    assert all(world.store.damage(entry) == () for entry in whole)
    assert world.store.unfinished() == []
    if entries:
        assert run("build", "good.yaml", "-o", "out/", "--offline").exit_code == 0
    assert list(world.folder.parent.glob("**/out.xml")) == []


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="files have no size limit there")
@pytest.mark.parametrize("kind", ["git", "archive"])
def test_a_full_disk(world: World, kind: str) -> None:
    import resource

    large = os.urandom(300_000)
    if kind == "git":
        (world.robots.folder / "arm" / "large.bin").write_bytes(large)
        world.robots.commit()
        world.recipe(world.robots.reference("main"))
    else:
        world.recipe(world.archive(zipped(**{"arm.xml": MODEL, "large.bin": large})))
    before = {entry.key for entry in world.store.entries()}, snapshot(world.folder)

    def small() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))

    result = process("build", "bad.yaml", "-o", "out/", preexec_fn=small)
    assert result.returncode == 1
    said = result.stderr.decode()
    assert said.startswith("bad.yaml:2:7: error[store-unusable]") and said.rstrip().endswith("\n1 error"), said
    assert ({entry.key for entry in world.store.entries()}, snapshot(world.folder)) == before
    assert run("build", "bad.yaml", "-o", "out/").exit_code == 0
    assert world.store.unfinished() == []


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs kill -9")
def test_a_build_that_is_killed_while_it_fetches(world: World) -> None:
    large = zipped(**{"arm.xml": MODEL, "large.bin": os.urandom(2_000_000)})
    world.recipe(world.archive(large))

    def stalls(handler: Any) -> None:
        handler.send_response(200)
        handler.send_header("Content-Length", str(len(large)))
        handler.send_header("ETag", '"one"')
        handler.end_headers()
        handler.wfile.write(large[:1_000_000])
        handler.wfile.flush()
        time.sleep(60)

    world.web.pages["/a.zip"] = stalls
    command = [sys.executable, "-m", "mjcompose", "build", "bad.yaml", "-o", "out/"]
    with subprocess.Popen(command, env=environment(MJCOMPOSE_TIMEOUT="60")) as building:
        while not any(path.suffix == ".part" and path.stat().st_size for path in world.store.unfinished()):
            assert building.poll() is None
            time.sleep(0.02)
        building.kill()
    before = snapshot(world.folder / "out")
    assert run("build", "good.yaml", "-o", "out/").exit_code == 0  # the lock of the store went with the process
    assert snapshot(world.folder / "out") == before
    world.web.pages["/a.zip"] = large
    assert run("build", "bad.yaml", "-o", "out/").exit_code == 0
    assert world.store.unfinished() == []


@pytest.mark.slow
def test_two_builds_fetch_once(world: World) -> None:
    content = zipped(**{"arm.xml": MODEL, "large.bin": os.urandom(1_000_000)})
    name, path = world.archive(content).split("#")
    world.recipe(f"{name}@sha256:{hashlib.sha256(content).hexdigest()}#{path}")
    command = [sys.executable, "-m", "mjcompose", "build", "bad.yaml", "--no-compile", "-o"]
    both = [subprocess.Popen([*command, out], env=environment()) for out in ("one.zip", "two.zip")]
    assert [each.wait() for each in both] == [0, 0]
    assert (world.folder / "one.zip").read_bytes() == (world.folder / "two.zip").read_bytes()
    assert [asked for asked, _ in world.web.asked].count("/a.zip") == 1
    assert world.store.unfinished() == []


def test_a_store_that_cannot_be_made(world: World, monkeypatch: pytest.MonkeyPatch) -> None:
    (world.folder / "file").write_text("")
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(world.folder / "file" / "store"))
    before = snapshot(world.folder)
    result = run("build", "good.yaml", "-o", "out/")
    assert result.exit_code == 1
    assert result.stderr.startswith("good.yaml:2:7: error[store-unusable]")
    assert "name another folder in `MJCOMPOSE_CACHE`" in result.stderr
    assert snapshot(world.folder) == before


def test_a_store_that_can_only_be_read_is_read(world: World) -> None:
    assert run("lock", "good.yaml").exit_code == 0
    folders = [folder for folder in world.store.folder.rglob("*") if folder.is_dir()]
    folders.append(world.store.folder)
    for folder in folders:
        folder.chmod(0o555)
    try:
        if os.access(world.store.folder, os.W_OK):
            pytest.skip("who runs this may write everywhere")
        assert run("build", "good.yaml", "-o", "out/", "--frozen").exit_code == 0
    finally:
        for folder in folders:
            folder.chmod(0o755)


def test_a_store_on_another_file_system(world: World, monkeypatch: pytest.MonkeyPatch) -> None:
    memory = Path("/dev/shm")
    if not os.access(memory, os.W_OK) or memory.stat().st_dev == world.folder.stat().st_dev:
        pytest.skip("there is no second file system")
    import tempfile

    with tempfile.TemporaryDirectory(dir=memory) as store:
        monkeypatch.setenv("MJCOMPOSE_CACHE", store)
        before = snapshot(world.folder / "out")
        assert run("build", "good.yaml", "-o", "out/").exit_code == 0
        assert snapshot(world.folder / "out") == before
        assert len(Store(Path(store)).entries()) == 2
