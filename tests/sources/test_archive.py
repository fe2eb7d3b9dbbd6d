from __future__ import annotations

import hashlib
import io
import tarfile
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mjcompose.sources.lock import Lock, Locked
from mjcompose.sources.reference import SourceError

MODEL = b"<mujoco/>\n"


def zipped(**files: bytes) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content)
    return stream.getvalue()


ROBOTS = zipped(**{"robots/arm.xml": MODEL, "robots/LICENSE": b"As you like."})
SHA256 = hashlib.sha256(ROBOTS).hexdigest()


@pytest.mark.parametrize("mode", ["w", "w:gz", "w:bz2", "w:xz"])
def test_every_kind_of_tar(web: Any, take: Callable[..., Any], mode: str) -> None:
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode=mode) as archive:  # type: ignore[call-overload]
        member = tarfile.TarInfo("./robots/arm.xml")
        member.size = len(MODEL)
        archive.addfile(member, io.BytesIO(MODEL))
    web.pages["/robots.tar"] = stream.getvalue()
    assert take(f"{web.url}/robots.tar#robots/arm.xml").path.read_bytes() == MODEL


def test_a_zip_with_its_license_and_sha256(web: Any, take: Callable[..., Any]) -> None:
    web.pages["/robots.zip"] = ROBOTS
    source = take(f"{web.url}/robots.zip#robots/arm.xml")
    assert source.version == source.origin.sha256 == SHA256
    assert [path.name for path in source.licenses] == ["LICENSE"]


def test_what_is_pinned_is_fetched_once(web: Any, take: Callable[..., Any]) -> None:
    web.pages["/robots.zip"] = ROBOTS
    for _ in range(2):
        take(f"{web.url}/robots.zip@sha256:{SHA256}#robots/arm.xml")
    assert len(web.asked) == 1


def test_what_is_not_pinned_is_asked_for_again(web: Any, take: Callable[..., Any], answer: Callable[..., None]) -> None:
    def page(handler: Any) -> None:
        same = handler.headers.get("If-None-Match") == '"one"'
        answer(handler, b"" if same else ROBOTS, status=304 if same else 200, ETag='"one"')

    web.pages["/robots.zip"] = page
    paths = {take(f"{web.url}/robots.zip#robots/arm.xml").path for _ in range(2)}
    assert len(paths) == 1
    assert [headers.get("If-None-Match") for _, headers in web.asked] == [None, '"one"']


def test_another_archive_than_the_reference_pins(web: Any, refused: Callable[..., SourceError]) -> None:
    web.pages["/robots.zip"] = zipped(**{"robots/arm.xml": b"<mujoco model='other'/>"})
    error = refused(f"{web.url}/robots.zip@sha256:{SHA256}#robots/arm.xml")
    assert error.code == "source-changed"
    assert SHA256 in error.notes[0]


def test_another_archive_than_the_lock_pins_says_which_files_changed(
    web: Any, take: Callable[..., Any], refused: Callable[..., SourceError]
) -> None:
    web.pages["/robots.zip"] = zipped(**{"robots/arm.xml": b"<mujoco model='other'/>", "robots/new.xml": MODEL})
    files = {"robots/arm.xml": hashlib.sha256(MODEL).hexdigest(), "robots/LICENSE": "1" * 64}
    locked = Locked(kind="archive", sha256=SHA256, files=files)
    lock = Lock(mjcompose="0", mujoco=None, sources={f"{web.url}/robots.zip": locked})
    error = refused(f"{web.url}/robots.zip#robots/arm.xml", lock=lock)
    assert error.code == "source-changed"
    assert [note.split(":")[0] for note in error.notes[1:]] == ["`robots/LICENSE` is gone", "`robots/arm.xml` changed"]
    assert take(f"{web.url}/robots.zip#robots/arm.xml", lock=lock, fresh=None).version != SHA256


def test_what_is_not_there(web: Any, refused: Callable[..., SourceError]) -> None:
    assert refused(f"{web.url}/gone.zip#arm.xml").code == "source-not-found"


def test_a_page_instead_of_an_archive(web: Any, refused: Callable[..., SourceError]) -> None:
    web.pages["/robots.zip"] = b"<!DOCTYPE html><html>log in</html>"
    error = refused(f"{web.url}/robots.zip#arm.xml")
    assert error.code == "archive-refused"
    assert "web page" in error.message


def test_a_file_that_is_not_in_it(web: Any, refused: Callable[..., SourceError]) -> None:
    web.pages["/robots.zip"] = ROBOTS
    error = refused(f"{web.url}/robots.zip#robots/amr.xml")
    assert error.code == "source-not-found"
    assert error.help == f"write `{web.url}/robots.zip#robots/arm.xml`"


def test_offline_and_locked(web: Any, take: Callable[..., Any], refused: Callable[..., SourceError]) -> None:
    web.pages["/robots.zip"] = ROBOTS
    reference = f"{web.url}/robots.zip#robots/arm.xml"
    assert refused(reference, offline=True).code == "source-offline"
    assert refused(reference, locked=True).code == "lock-stale"
    assert web.asked == []
    take(reference)
    assert take(reference, offline=True).version == SHA256


def test_a_refused_archive_leaves_nothing_in_the_store(
    web: Any, refused: Callable[..., SourceError], own_environment: dict[str, str]
) -> None:
    web.pages["/robots.zip"] = zipped(**{"robots/arm.xml": MODEL, "../../out.xml": MODEL})
    error = refused(f"{web.url}/robots.zip#robots/arm.xml")
    assert error.code == "archive-refused"
    store = Path(own_environment["MJCOMPOSE_CACHE"])
    assert list(store.rglob("*.xml")) == []
    assert not list((store / "staging").iterdir())
