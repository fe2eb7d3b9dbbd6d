from __future__ import annotations

import shutil
import ssl
import subprocess
import threading
import time
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from ipaddress import ip_address
from pathlib import Path
from typing import Any

import pytest
from mjcompose.base.limits import allow
from mjcompose.sources.address import is_private
from mjcompose.sources.download import Version, download
from mjcompose.sources.fetching import Fetching, Lookup
from mjcompose.sources.reference import SourceError

NOTHING = Version()
CONTENT = bytes(range(256)) * 64


def lookup(is_confined: bool = False, **environment: str) -> Lookup:
    return Lookup(Path(), environment, Fetching(progress=print), is_confined=is_confined)


@pytest.fixture
def get(tmp_path: Path) -> Callable[..., Version | None]:
    def get(url: str, known: Version = NOTHING, **environment: str) -> Version | None:
        told = {"MJCOMPOSE_TIMEOUT": "1", **environment}
        return download(url, tmp_path / "file.part", known, lookup=lookup(**told))

    return get


def test_redirects_are_followed(web: Any, get: Callable[..., Any], answer: Callable[..., None], tmp_path: Path) -> None:
    web.pages["/a"] = lambda handler: answer(handler, b"", status=302, Location="/b")
    web.pages["/b"] = CONTENT
    get(f"{web.url}/a")
    assert (tmp_path / "file.part").read_bytes() == CONTENT


def test_redirects_in_a_circle_end(web: Any, get: Callable[..., Any], answer: Callable[..., None]) -> None:
    web.pages["/a"] = lambda handler: answer(handler, b"", status=302, Location="/a")
    with pytest.raises(SourceError) as caught:
        get(f"{web.url}/a")
    assert caught.value.code == "source-fetch"
    assert len(web.asked) == 11


@pytest.mark.parametrize(
    "location", ["http://[::1/b", "http://127.0.0.1:99999/b", "ftp://127.0.0.1/b", "file:///etc/hostname", "https:"]
)
def test_a_redirect_to_what_is_no_address(
    web: Any, get: Callable[..., Any], answer: Callable[..., None], location: str
) -> None:
    web.pages["/a"] = lambda handler: answer(handler, b"", status=302, Location=location)
    with pytest.raises(SourceError, match="is not a web address"):
        get(f"{web.url}/a")
    assert len(web.asked) == 1


def test_an_answer_that_nobody_asked_for(web: Any, get: Callable[..., Any], answer: Callable[..., None]) -> None:
    web.pages["/a"] = lambda handler: answer(handler, b"", status=304)
    with pytest.raises(SourceError, match="answered 304"):
        get(f"{web.url}/a")


@pytest.mark.parametrize("status", [429, 503])
def test_a_server_says_when_to_come_again(
    web: Any, get: Callable[..., Any], answer: Callable[..., None], monkeypatch: pytest.MonkeyPatch, status: int
) -> None:
    pauses: list[float] = []
    monkeypatch.setattr(time, "sleep", pauses.append)

    def page(handler: Any) -> None:
        if len(web.asked) == 1:
            answer(handler, b"", status=status, Retry_After="17")
        else:
            answer(handler, CONTENT)

    web.pages["/a"] = page
    get(f"{web.url}/a")
    assert pauses == [17]


def test_a_server_that_asks_for_too_much_patience(
    web: Any, get: Callable[..., Any], answer: Callable[..., None]
) -> None:
    web.pages["/a"] = lambda handler: answer(handler, b"", status=429, Retry_After="86400")
    with pytest.raises(SourceError, match="429") as caught:
        get(f"{web.url}/a")
    assert caught.value.notes == ("it says `Retry-After: 86400`",)
    assert len(web.asked) == 1


def test_a_busy_server_is_asked_again(
    web: Any, get: Callable[..., Any], answer: Callable[..., None], tmp_path: Path
) -> None:
    def page(handler: Any) -> None:
        answer(handler, *((b"",) if len(web.asked) < 3 else (CONTENT,)), status=503 if len(web.asked) < 3 else 200)

    web.pages["/a"] = page
    get(f"{web.url}/a")
    assert len(web.asked) == 3
    assert (tmp_path / "file.part").read_bytes() == CONTENT


def resuming(web: Any, answer: Callable[..., None], etag: Callable[[], str]) -> Callable[[Any], None]:
    """Breaks off in the middle of the first answer."""

    def page(handler: Any) -> None:
        asked = handler.headers.get("Range")
        version = etag()
        if asked and handler.headers.get("If-Range") == version:
            start = int(asked.removeprefix("bytes=").removesuffix("-"))
            answer(
                handler,
                CONTENT[start:],
                status=206,
                ETag=version,
                Content_Range=f"bytes {start}-{len(CONTENT) - 1}/{len(CONTENT)}",
            )
        elif len(web.asked) == 1:
            answer(handler, CONTENT[:5000], length=len(CONTENT), ETag=version)
            handler.close_connection = True
        else:
            answer(handler, CONTENT, ETag=version)

    return page


def test_what_broke_off_goes_on(web: Any, get: Callable[..., Any], answer: Callable[..., None], tmp_path: Path) -> None:
    web.pages["/a"] = resuming(web, answer, lambda: '"one"')
    assert get(f"{web.url}/a") == Version('"one"', "")
    assert (tmp_path / "file.part").read_bytes() == CONTENT
    assert web.asked[1][1]["Range"] == "bytes=5000-"


def test_a_file_that_changed_meanwhile_is_fetched_anew(
    web: Any, get: Callable[..., Any], answer: Callable[..., None], tmp_path: Path
) -> None:
    web.pages["/a"] = resuming(web, answer, lambda: f'"{len(web.asked)}"')
    get(f"{web.url}/a")
    assert (tmp_path / "file.part").read_bytes() == CONTENT


def test_a_server_that_says_nothing(web: Any, get: Callable[..., Any]) -> None:
    release = threading.Event()
    web.pages["/a"] = lambda handler: release.wait(20)
    with pytest.raises(SourceError) as caught:
        get(f"{web.url}/a", MJCOMPOSE_TIMEOUT="0.1")
    release.set()
    assert caught.value.code == "source-fetch"
    assert caught.value.notes == ("after 1 try: the server said nothing for 0.1 s",)
    assert caught.value.help is not None and "MJCOMPOSE_TIMEOUT" in caught.value.help


def test_a_silent_server_takes_no_more_than_the_time_that_it_may_be_silent(
    web: Any, get: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mjcompose.sources.fetching._FIRST", 0.2)
    monkeypatch.setattr("mjcompose.sources.fetching._EVERY", 0.2)
    release = threading.Event()
    web.pages["/a"] = lambda handler: release.wait(20)
    told: list[str] = []
    begun = time.monotonic()
    with pytest.raises(SourceError):
        own = Lookup(Path(), {"MJCOMPOSE_TIMEOUT": "2"}, Fetching(progress=told.append))
        download(f"{web.url}/a", Path("never written"), NOTHING, lookup=own)
    assert time.monotonic() - begun < 3.8
    release.set()
    assert len(told) >= 2 and all(each.startswith("waiting for 127.0.0.1: ") for each in told)


@pytest.mark.parametrize("chunked", [False, True])
def test_a_server_that_drips_is_as_good_as_silent(
    web: Any, get: Callable[..., Any], answer: Callable[..., None], tmp_path: Path, chunked: bool
) -> None:
    release = threading.Event()

    def page(handler: Any) -> None:
        start = int(handler.headers.get("Range", "bytes=0-").removeprefix("bytes=").removesuffix("-"))
        if len(web.asked) == 3:
            answer(
                handler,
                CONTENT[start:],
                status=206,
                ETag='"one"',
                Content_Range=f"bytes {start}-{len(CONTENT) - 1}/{len(CONTENT)}",
            )
            return
        handler.send_response(206 if start else 200)
        handler.send_header("ETag", '"one"')
        if start:
            handler.send_header("Content-Range", f"bytes {start}-{len(CONTENT) - 1}/{len(CONTENT)}")
        if chunked:
            handler.send_header("Transfer-Encoding", "chunked")
        else:
            handler.send_header("Content-Length", str(len(CONTENT) - start))
        handler.end_headers()
        for byte in CONTENT[start:]:
            if release.wait(0.05):
                break
            handler.wfile.write(b"1\r\n%c\r\n" % byte if chunked else bytes([byte]))

    web.pages["/a"] = page
    get(f"{web.url}/a", MJCOMPOSE_TIMEOUT="0.5")
    release.set()
    assert (tmp_path / "file.part").read_bytes() == CONTENT
    first, second = (int(asked[1]["Range"][6:-1]) for asked in web.asked[1:])
    assert 0 < first < second < 1000


def test_what_comes_slowly_to_its_end_is_whole(web: Any, get: Callable[..., Any], tmp_path: Path) -> None:
    def page(handler: Any) -> None:
        handler.send_response(200)
        handler.send_header("Content-Length", "3")
        handler.end_headers()
        for byte in (b"a", b"bc"):
            time.sleep(0.15)
            handler.wfile.write(byte)

    web.pages["/a"] = page
    get(f"{web.url}/a", MJCOMPOSE_TIMEOUT="0.25")
    assert (tmp_path / "file.part").read_bytes() == b"abc" and len(web.asked) == 1


def test_a_host_that_is_gone(get: Callable[..., Any]) -> None:
    with pytest.raises(SourceError) as caught:
        get("http://127.0.0.1:9/a.zip")
    assert caught.value.code == "source-fetch"
    assert "refused" in caught.value.notes[0]


def test_a_name_that_cannot_be_resolved_is_asked_for_once(
    get: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    def wait(seconds: float) -> None:
        raise AssertionError("it is tried again")

    monkeypatch.setattr("mjcompose.sources.download.time.sleep", wait)
    for proxy in ({}, {"https_proxy": "http://proxy.invalid:3128"}):
        with pytest.raises(SourceError, match="the name of its server cannot be resolved") as caught:
            get("https://nobody.invalid/a.zip", **proxy)
        assert caught.value.code == "source-fetch"


@pytest.mark.parametrize("status", [401, 403, 418])
def test_what_is_not_given_is_not_asked_for_again(
    web: Any, get: Callable[..., Any], answer: Callable[..., None], status: int
) -> None:
    web.pages["/a"] = lambda handler: answer(handler, b"", status=status)
    with pytest.raises(SourceError, match=str(status)):
        get(f"{web.url}/a")
    assert len(web.asked) == 1


def test_a_proxy_is_used_unless_the_host_is_spared(web: Any, get: Callable[..., Any], tmp_path: Path) -> None:
    web.pages["http://robots.invalid/a.zip"] = CONTENT  # a proxy is asked for the whole address
    get("http://robots.invalid/a.zip", http_proxy=web.url)
    assert (tmp_path / "file.part").read_bytes() == CONTENT
    with pytest.raises(SourceError):
        get("http://robots.invalid/a.zip", http_proxy=web.url, no_proxy="robots.invalid")


def test_what_is_known_is_not_sent_again(web: Any, get: Callable[..., Any], answer: Callable[..., None]) -> None:
    web.pages["/a"] = lambda handler: answer(handler, b"", status=304)
    assert get(f"{web.url}/a", Version('"one"', "")) is None


def test_no_way_leads_over_an_address_that_is_not_encrypted(
    web: Any, get: Callable[..., Any], answer: Callable[..., None]
) -> None:
    """The server is a proxy too, and would give the file in the name of any host."""
    way = {"status": 302, "Location": "http://example.org/b"}
    web.pages[f"{web.url}/a"] = lambda handler: answer(handler, b"", **way)
    web.pages["http://example.org/b"] = lambda handler: answer(handler, b"", status=302, Location=f"{web.url}/c")
    web.pages[f"{web.url}/c"] = CONTENT
    with pytest.raises(SourceError, match=r"leads to `http://example.org/b`, which is not encrypted"):
        get(f"{web.url}/a", http_proxy=web.url)


@pytest.mark.skipif(shutil.which("openssl") is None, reason="nothing makes a certificate")
def test_a_server_that_is_not_trusted_is_asked_once(
    get: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    key = tmp_path / "key.pem"
    certificate = tmp_path / "certificate.pem"
    subprocess.run(
        [
            "openssl",
            "req",
            "-x509",
            "-newkey",
            "rsa:2048",
            "-nodes",
            "-subj",
            "/CN=127.0.0.1",
            "-keyout",
            key,
            "-out",
            certificate,
        ],
        check=True,
        capture_output=True,
    )
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificate, key)
    server = ThreadingHTTPServer(("127.0.0.1", 0), BaseHTTPRequestHandler)
    server.handle_error = lambda *_: None  # type: ignore[method-assign]
    server.socket = context.wrap_socket(server.socket, server_side=True, do_handshake_on_connect=False)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    pauses: list[float] = []
    monkeypatch.setattr(time, "sleep", pauses.append)
    with pytest.raises(SourceError, match="no certificate that this machine trusts"):
        get(f"https://127.0.0.1:{server.server_port}/a", MJCOMPOSE_TIMEOUT="30")
    server.shutdown()
    server.server_close()
    assert pauses == []


def test_a_download_that_is_larger_than_it_may_be(
    web: Any, refused: Callable[..., SourceError], tmp_path: Path
) -> None:
    web.pages["/a.zip"] = bytes(3000)
    with allow(source_size=2000):
        error = refused(f"{web.url}/a.zip#arm.xml")
    assert error.code == "archive-refused" and "is larger than 2K" in error.message
    assert not list((tmp_path / "store" / "partial").iterdir())


@pytest.mark.parametrize("found", [("10.0.0.7",), ("93.184.216.34", "10.0.0.7"), ("::1",), ("169.254.169.254",)])
def test_a_detour_leads_to_no_name_of_this_network(
    web: Any, answer: Callable[..., None], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, found: tuple[str, ...]
) -> None:
    """Nor is one asked that had no address when its reference was read."""
    monkeypatch.setattr("mjcompose.sources.address._addresses", lambda name: tuple(map(ip_address, found)))
    monkeypatch.setattr(
        "mjcompose.sources.download.is_private", lambda host: "127.0.0.1" not in host and is_private(host)
    )
    monkeypatch.setattr("mjcompose.sources.connections.check_peer", lambda connection: None)
    web.pages["/a"] = lambda handler: answer(handler, b"", status=302, Location="https://robots.example.org/b")
    confined = lookup(is_confined=True, MJCOMPOSE_TIMEOUT="1")
    for start, asked in ((f"{web.url}/a", 1), ("https://robots.example.org/b", 1)):
        with pytest.raises(SourceError) as caught:
            download(start, tmp_path / "file.part", NOTHING, lookup=confined)
        assert caught.value.code == "source-outside" and len(web.asked) == asked
