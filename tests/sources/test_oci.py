"""Artifacts of a registry, imitated on the loopback."""

from __future__ import annotations

import hashlib
import io
import json
import tarfile
from pathlib import Path
from typing import Any

import pytest
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.kinds import parse
from mjcompose.sources.lock import resolve
from mjcompose.sources.reference import Origin, SourceError

TAR = "application/vnd.oci.image.layer.v1.tar+gzip"
FILE = "text/xml"


def tar(**files: bytes) -> bytes:
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w:gz") as archive:
        for name, content in files.items():
            member = tarfile.TarInfo(name)
            member.size = len(content)
            archive.addfile(member, io.BytesIO(content))
    return stream.getvalue()


def push(web: Any, *layers: tuple[str, bytes, str | None]) -> str:
    """Put an artifact of layers (media type, content, title) onto the server; return the reference without the file."""
    listed = []
    for media, content, title in layers:
        digest = f"sha256:{hashlib.sha256(content).hexdigest()}"
        web.pages[f"/v2/lab/robots/blobs/{digest}"] = content
        annotations = {} if title is None else {"annotations": {"org.opencontainers.image.title": title}}
        listed.append({"mediaType": media, "digest": digest, "size": len(content), **annotations})
    return put(web, json.dumps({"schemaVersion": 2, "layers": listed}).encode())


def put(web: Any, manifest: bytes) -> str:
    digest = hashlib.sha256(manifest).hexdigest()
    web.pages[f"/v2/lab/robots/manifests/sha256:{digest}"] = manifest
    return f"oci:{web.url.removeprefix('http://')}/lab/robots@sha256:{digest}"


def test_layers_that_are_tars_and_files(web: Any, take: Any, refused: Any) -> None:
    id = push(
        web, (TAR, tar(**{"arm/arm.xml": b"<mujoco/>", "LICENSE": b"x"}), None), (FILE, b"<mujoco/>", "hand/hand.xml")
    )
    assert refused(f"{id}#arm/arm.xml", locked=True).code == "lock-stale"
    assert refused(f"{id}#arm/arm.xml", offline=True).code == "source-offline"
    source = take(f"{id}#arm/arm.xml")
    assert (source.origin.id, source.version) == (id, id.rpartition(":")[2])
    assert sorted(source.origin.stored) == ["LICENSE", "arm/arm.xml", "hand/hand.xml"]
    web.pages.clear()
    assert take(f"{id}#hand/hand.xml", offline=True).path.read_text() == "<mujoco/>"


def test_a_token_that_anybody_gets(web: Any, answer: Any, take: Any) -> None:
    id = push(web, (FILE, b"<mujoco/>", "arm.xml"))
    realm = f'Bearer realm="{web.url}/token",service="lab",scope="repository:lab/robots:pull"'

    def guarded(page: bytes) -> Any:
        def give(request: Any) -> None:
            if request.headers.get("Authorization") != "Bearer t0ken":
                answer(request, b"", status=401, WWW_Authenticate=realm)
            else:
                answer(request, page)

        return give

    web.pages = {path: guarded(page) for path, page in web.pages.items()}
    web.pages["/token?service=lab&scope=repository%3Alab%2Frobots%3Apull"] = b'{"token": "t0ken"}'
    assert take(f"{id}#arm.xml").path.read_text() == "<mujoco/>"


@pytest.mark.parametrize(
    "realm", ["Basic", 'Bearer realm="http://example.org/x"', 'Bearer realm="file:///etc/passwd"', ""]
)
def test_a_login_is_not_supported(web: Any, answer: Any, refused: Any, realm: str) -> None:
    id = push(web, (FILE, b"<mujoco/>", "arm.xml"))
    web.pages = dict.fromkeys(web.pages, lambda request: answer(request, b"", status=401, WWW_Authenticate=realm))
    error = refused(f"{id}#arm.xml")
    assert error.code == "source-fetch" and "requires a login" in error.message


@pytest.mark.parametrize("what", ["manifests", "blobs"])
def test_other_bytes_are_refused(web: Any, refused: Any, what: str) -> None:
    id = push(web, (FILE, b"<mujoco/>", "arm.xml"))
    web.pages = {path: page + b" " if what in path else page for path, page in web.pages.items()}
    assert refused(f"{id}#arm.xml").code == "source-changed"


@pytest.mark.parametrize("what", ["manifests", "blobs"])
def test_what_does_not_exist(web: Any, refused: Any, what: str) -> None:
    id = push(web, (FILE, b"<mujoco/>", "arm.xml"))
    web.pages = {path: page for path, page in web.pages.items() if what not in path}
    assert refused(f"{id}#arm.xml").code == "source-not-found"


@pytest.mark.parametrize(
    "manifest", [b"", b"[]", b"{}", b'{"layers": []}', b'{"layers": [{"digest": 1}]}', b'{"manifests": []}']
)
def test_what_is_no_artifact(web: Any, refused: Any, manifest: bytes) -> None:
    assert refused(f"{put(web, manifest)}#arm.xml").code == "archive-refused"


@pytest.mark.parametrize("title", ["../arm.xml", "/tmp/arm.xml", "a.xml", "a.xml/b.xml"])
def test_names_that_are_refused(web: Any, refused: Any, own_environment: dict[str, str], title: str) -> None:
    id = push(web, (FILE, b"<mujoco/>", "a.xml"), (FILE, b"<mujoco></mujoco>", title))
    assert refused(f"{id}#a.xml").code == "archive-refused"
    assert list(Path(own_environment["MJCOMPOSE_CACHE"], "partial").iterdir()) == []


def test_a_fetched_recipe_reaches_no_registry_here(web: Any, tmp_path: Path, own_environment: dict[str, str]) -> None:
    id = push(web, (FILE, b"<mujoco/>", "arm.xml"))
    origin = Origin("git+https://host/repo@v1", parse("git+https://host/repo@v1#x.xml").kind, tmp_path, commit="1" * 40)
    fetching = Fetching(origins={origin.id: origin})
    with pytest.raises(SourceError) as caught:
        resolve(f"{id}#arm.xml", relative_to=tmp_path, environment=own_environment, fetching=fetching)
    assert caught.value.code == "source-outside" and web.asked == []


DIGEST = f"sha256:{'0' * 64}"


@pytest.mark.parametrize(
    "text",
    [
        f"oci:lab/robots@{DIGEST}#a.xml",
        "oci:ghcr.io/lab/robots:latest#a.xml",
        f"oci:ghcr.io/lab@{DIGEST}",
        f"oci://ghcr.io/lab@{DIGEST}#a.xml",
        f"oci:ghcr.io/../x@{DIGEST}#a.xml",
        f"oci:ghcr.io/a/../x@{DIGEST}#a.xml",
        f"oci:me:pw@ghcr.io/x@{DIGEST}#a.xml",
        "oci:ghcr.io/lab@sha256:12#a.xml",
    ],
)
def test_what_is_no_reference(text: str) -> None:
    with pytest.raises(SourceError) as caught:
        parse(text)
    assert caught.value.code == "source-kind"
