"""Archives in object stores: one in memory, and a server of S3 on the loopback."""

from __future__ import annotations

import hashlib
import importlib
import io
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from mjcompose.base.limits import allow
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.kinds import parse
from mjcompose.sources.lock import Lock, Locked, resolve
from mjcompose.sources.reference import Origin, SourceError, Trust

fsspec = pytest.importorskip("fsspec", reason="needs `mjcompose[remote]`")

REFERENCE = "s3://lab/robots.zip#arm/arm.xml"


def archive(text: str = "<mujoco/>") -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as opened:
        opened.writestr(zipfile.ZipInfo("arm/arm.xml"), text)
        opened.writestr(zipfile.ZipInfo("LICENSE"), "As you like.\n")
    return stream.getvalue()


@pytest.fixture
def store(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """An object store in memory at `s3:`, with the archive."""
    fs = fsspec.filesystem("memory", skip_instance_cache=True)
    monkeypatch.setattr(fsspec.core, "url_to_fs", lambda url: (fs, f"/{url.partition('://')[2]}"))
    fs.pipe_file("/lab/robots.zip", archive())
    yield fs
    fs.store.clear()


def test_an_archive_is_fetched_and_kept(store: Any, take: Any, refused: Any) -> None:
    assert refused(REFERENCE, locked=True).code == "lock-stale"
    assert refused(REFERENCE, offline=True).code == "source-offline"
    source = take(REFERENCE)
    sha256 = hashlib.sha256(archive()).hexdigest()
    assert (source.version, source.origin.sha256) == (sha256, sha256)
    assert [each.name for each in source.licenses] == ["LICENSE"]
    store.pipe_file("/lab/robots.zip", archive("<mujoco model='new'/>"))
    assert take(REFERENCE, offline=True).path == source.path
    assert take(REFERENCE).version != sha256
    lock = Lock(
        mjcompose="1", mujoco="3", sources={"s3://lab/robots.zip": Locked(kind="bucket", sha256=sha256, files={})}
    )
    assert take(REFERENCE, lock=lock, locked=True).path == source.path


def test_another_archive_than_the_pinned_one(store: Any, refused: Any) -> None:
    assert refused(REFERENCE.replace("#", f"@sha256:{'0' * 64}#")).code == "source-changed"


def test_what_does_not_exist(store: Any, refused: Any) -> None:
    assert refused("s3://lab/other.zip#a.xml").code == "source-not-found"
    assert refused("s3://lab/robots.zip#b.xml").code == "source-not-found"


def test_an_archive_beyond_the_limit(store: Any, refused: Any, own_environment: dict[str, str]) -> None:
    with allow(source_size=100):
        assert refused(REFERENCE).code == "archive-refused"
    assert list(Path(own_environment["MJCOMPOSE_CACHE"], "partial").iterdir()) == []


def test_a_store_that_fails_shows_no_secret(store: Any, refused: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(path: str) -> Any:
        raise RuntimeError("no answer from https://lab/x?X-Amz-Signature=secret")

    monkeypatch.setattr(store, "info", fails)
    error = refused(REFERENCE)
    assert error.code == "source-fetch" and "no answer" in error.notes[0] and "secret" not in error.notes[0]


@pytest.mark.parametrize("name", ["fsspec", "s3fs"])
def test_without_its_package(name: str, refused: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.delitem(importlib.import_module("fsspec.registry")._registry, "s3", raising=False)
    assert refused(REFERENCE).help == 'run `pip install "mjcompose[remote]" s3fs`'


@pytest.mark.parametrize("is_trusted", [False, True])
def test_a_fetched_recipe_uses_no_credentials(
    store: Any, tmp_path: Path, own_environment: dict[str, str], is_trusted: bool
) -> None:
    origin = Origin("git+https://host/repo@v1", parse("git+https://host/repo@v1#x.xml").kind, tmp_path, commit="1" * 40)
    trust = Trust(references=("s3://lab/",) if is_trusted else ())
    fetching = Fetching(origins={origin.id: origin}, trust=trust)
    if is_trusted:
        assert resolve(REFERENCE, relative_to=tmp_path, environment=own_environment, fetching=fetching).path.is_file()
        return
    with pytest.raises(SourceError) as caught:
        resolve(REFERENCE, relative_to=tmp_path, environment=own_environment, fetching=fetching)
    assert caught.value.code == "source-outside"


@pytest.mark.parametrize(
    "text",
    [
        "s3://lab#a.xml",
        "s3:/lab/a.zip#a.xml",
        "s3://lab/a.zip",
        "s3://lab/a.zip::file:///etc/x#a.xml",
        "gs://lab/../a.zip#a.xml",
        "s3://me:pw@lab/a.zip#a.xml",
        "s3://lab/a.zip@sha256:12#a.xml",
        "s3://lab/a.zip?x=1#a.xml",
    ],
)
def test_what_is_no_reference(text: str) -> None:
    with pytest.raises(SourceError) as caught:
        parse(text)
    assert caught.value.code == "source-kind" and "pw" not in caught.value.message


@pytest.mark.slow
def test_a_server_of_s3(take: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    server = pytest.importorskip("moto.server").ThreadedMotoServer(port=0, verbose=False)
    s3fs = pytest.importorskip("s3fs")
    server.start()
    try:
        host, port = server.get_host_and_port()
        for name, value in {
            "ENDPOINT_URL": f"http://{host}:{port}",
            "ACCESS_KEY_ID": "a",
            "SECRET_ACCESS_KEY": "b",
        }.items():
            monkeypatch.setenv(f"AWS_{name}", value)
        monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
        fs = s3fs.S3FileSystem(skip_instance_cache=True)
        fs.mkdir("lab")
        fs.pipe_file("lab/robots.zip", archive())
        assert take(REFERENCE).path.read_text() == "<mujoco/>"
        fs.pipe_file("lab/robots.zip", archive("<mujoco model='new'/>"))
        assert "new" in take(REFERENCE).path.read_text() == take(REFERENCE).path.read_text()
    finally:
        server.stop()
