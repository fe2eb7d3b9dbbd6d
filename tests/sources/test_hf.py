"""Repositories of the Hugging Face Hub, imitated on the loopback: git, the batch API of LFS, model cards."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import pytest
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.kinds import parse
from mjcompose.sources.license import license_of
from mjcompose.sources.lock import Lock, Locked, resolve
from mjcompose.sources.reference import Origin, SourceError, Trust

CONTENT = b"v 0 0 0\n" * 300
SHA256 = hashlib.sha256(CONTENT).hexdigest()
POINTER = f"version https://git-lfs.github.com/spec/v1\noid sha256:{SHA256}\nsize {len(CONTENT)}\n"
REFERENCE = "hf:lab/robots@main#arm/arm.xml"


@pytest.fixture
def hub(robots: Any, web: Any, answer: Any, own_environment: dict[str, str]) -> Any:
    """A hub with the repository `lab/robots`, whose mesh is in Git LFS, and without a license file."""
    (robots.folder / "LICENSE").unlink()
    robots.commit(**{"README.md": "---\ntags: [robot]\nlicense: apache-2.0\n---\n# Robots\n", "arm/mesh.obj": POINTER})
    web.serve(robots, "lab/robots")

    def batch(request: Any) -> None:
        asked = json.loads(request.rfile.read(int(request.headers["Content-Length"])))["objects"]
        listed = [{**each, "actions": {"download": {"href": f"{web.url}/cdn/{each['oid']}"}}} for each in asked]
        answer(request, json.dumps({"objects": listed}).encode())

    web.pages |= {"/lab/robots.git/info/lfs/objects/batch": batch, f"/cdn/{SHA256}": CONTENT}
    own_environment["HF_ENDPOINT"] = web.url
    return web


def test_a_model_is_fetched_at_its_commit(hub: Any, robots: Any, take: Any) -> None:
    source = take(REFERENCE)
    commit = robots.git("rev-parse", "HEAD")
    assert (source.origin.id, source.origin.commit, source.version) == ("hf:lab/robots@main", commit, commit)
    assert source.path.with_name("mesh.obj").read_bytes() == CONTENT
    assert license_of(source) == "Apache-2.0"


def test_offline_and_locked(hub: Any, robots: Any, take: Any, refused: Any) -> None:
    assert refused(REFERENCE, locked=True).code == "lock-stale"
    assert refused(REFERENCE, offline=True).code == "source-offline"
    first = take(REFERENCE)
    pinned = Locked(kind="hf", commit=first.origin.commit, tree=first.origin.tree, files={})
    lock = Lock(mjcompose="1", mujoco="3", sources={"hf:lab/robots@main": pinned})
    robots.commit(**{"arm/arm.xml": "<mujoco/>\n"})
    hub.serve(robots, "lab/robots")
    assert take(REFERENCE, lock=lock, locked=True, offline=True).path == first.path
    assert take(REFERENCE).version == robots.git("rev-parse", "HEAD") != first.version
    assert take(REFERENCE, lock=lock, locked=True).path.read_text() == first.path.read_text()


def test_a_revision_that_does_not_exist(hub: Any, refused: Any) -> None:
    error = refused("hf:lab/robots@v11#arm/arm.xml")
    assert (error.code, error.help) == ("source-revision", "write `hf:lab/robots@v1#arm/arm.xml`")


@pytest.mark.parametrize("card", ["# Robots\n", "---\nlicense: other\n---\n", "---\nlicense: mit\n"])
def test_a_card_without_a_license(hub: Any, robots: Any, take: Any, card: str) -> None:
    robots.commit(**{"README.md": card})
    hub.serve(robots, "lab/robots")
    assert license_of(take(REFERENCE)) is None


def test_a_license_file_comes_first(hub: Any, robots: Any, take: Any) -> None:
    robots.commit(LICENSE="SPDX-License-Identifier: MIT\n")
    hub.serve(robots, "lab/robots")
    assert license_of(take(REFERENCE)) == "MIT"


@pytest.mark.parametrize(
    "endpoint", ["http://example.org", "ftp://example.org", "hub", "https://me:secret@host", "https://[::1"]
)
def test_a_hub_that_is_no_https_address(own_environment: dict[str, str], refused: Any, endpoint: str) -> None:
    own_environment["HF_ENDPOINT"] = endpoint
    error = refused(REFERENCE)
    assert error.message.startswith("`HF_ENDPOINT` is `") and "secret" not in error.message


@pytest.mark.parametrize("is_trusted", [False, True])
def test_a_fetched_recipe_reaches_no_hub_here(
    hub: Any, tmp_path: Path, own_environment: dict[str, str], is_trusted: bool
) -> None:
    origin = Origin("git+https://host/repo@v1", parse("git+https://host/repo@v1#x.xml").kind, tmp_path, commit="1" * 40)
    trust = Trust(references=("hf:lab/robots",) if is_trusted else ())
    fetching = Fetching(origins={origin.id: origin}, trust=trust)
    if is_trusted:
        assert resolve(REFERENCE, relative_to=tmp_path, environment=own_environment, fetching=fetching).path.is_file()
        return
    with pytest.raises(SourceError) as caught:
        resolve(REFERENCE, relative_to=tmp_path, environment=own_environment, fetching=fetching)
    assert caught.value.code == "source-outside" and hub.asked == []


@pytest.mark.parametrize(
    "text",
    [
        "hf:robots@v1#a.xml",
        "hf:../robots@v1#a.xml",
        "hf:lab/robots#a.xml",
        "hf:lab/robots@v1",
        "hf://lab/robots@v1#a.xml",
        "hf:lab/robots@-x#a.xml",
        "hf:models/lab/robots@v1#a.xml",
    ],
)
def test_what_is_no_reference(text: str) -> None:
    with pytest.raises(SourceError) as caught:
        parse(text)
    assert caught.value.code == "source-kind"
