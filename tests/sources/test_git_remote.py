"""git over https and ssh, as from another machine: a server on the loopback, and a login that stays here."""

from __future__ import annotations

import base64
import os
import shutil
import socket
import ssl
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from ipaddress import ip_address
from pathlib import Path
from typing import Any

import pytest
from mjcompose.sources import address, connections, download, git_repository
from mjcompose.sources.fetching import Fetching, Lookup
from mjcompose.sources.kinds import parse
from mjcompose.sources.lock import resolve
from mjcompose.sources.reference import SourceError

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="needs a POSIX shell")


def fetch(reference: str, environment: dict[str, str]) -> Any:
    return resolve(reference, relative_to=Path(), environment=environment, fetching=Fetching())


class _GitHandler(BaseHTTPRequestHandler):
    """Hands what is asked to `git http-backend`, as web servers do."""

    root: Path
    login = ""

    def _answer(self) -> None:
        if self.login and self.headers.get("Authorization") != self.login:
            self.send_response(401)
            self.send_header("WWW-Authenticate", 'Basic realm="robots"')
            self.send_header("Content-Length", "0")
            self.end_headers()
            return
        path, _, query = self.path.partition("?")
        length = int(self.headers.get("Content-Length", 0))
        own = {
            "GIT_PROJECT_ROOT": str(self.root),
            "GIT_HTTP_EXPORT_ALL": "1",
            "REQUEST_METHOD": self.command,
            "PATH_INFO": path,
            "QUERY_STRING": query,
            "CONTENT_TYPE": self.headers.get("Content-Type", ""),
            "CONTENT_LENGTH": str(length),
            "HTTP_CONTENT_ENCODING": self.headers.get("Content-Encoding", ""),
            "GIT_PROTOCOL": self.headers.get("Git-Protocol", ""),
            "GIT_CONFIG_COUNT": "1",
            "GIT_CONFIG_KEY_0": "safe.directory",
            "GIT_CONFIG_VALUE_0": "*",
        }
        done = subprocess.run(
            ["git", "http-backend"],
            input=self.rfile.read(length),
            capture_output=True,
            env={**os.environ, **own},
            check=True,
            timeout=60,
        )
        head, _, body = done.stdout.partition(b"\r\n\r\n")
        headers = dict(line.split(": ", 1) for line in head.decode().split("\r\n"))
        self.send_response(int(headers.pop("Status", "200").split()[0]))
        for name, value in headers.items():
            self.send_header(name, value)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    do_GET = do_POST = _answer  # noqa: N815

    def log_message(self, format: str, *arguments: object) -> None:
        pass


@pytest.fixture
def https(tmp_path: Path, robots: Any) -> Iterator[tuple[str, dict[str, str]]]:
    """The address of a server that has the repository `robots`, and what makes git trust its certificate."""
    if shutil.which("openssl") is None:
        pytest.skip("needs openssl for a certificate")
    certificate = tmp_path / "certificate.pem"
    key = tmp_path / "key.pem"
    subprocess.run(
        [
            "openssl",
            "req",
            "-x509",
            "-newkey",
            "rsa:2048",
            "-nodes",
            "-days",
            "2",
            "-subj",
            "/CN=localhost",
            "-addext",
            "subjectAltName=DNS:localhost",
            "-keyout",
            key,
            "-out",
            certificate,
        ],
        check=True,
        capture_output=True,
    )
    handler = type("Handler", (_GitHandler,), {"root": robots.folder.parent})
    server = ThreadingHTTPServer(("127.0.0.1", 0), handler)
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificate, key)
    server.socket = context.wrap_socket(server.socket, server_side=True)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"https://localhost:{server.server_port}/robots/.git", {"GIT_SSL_CAINFO": str(certificate)}
    server.shutdown()
    server.server_close()


@pytest.mark.parametrize("revision", ["v1", "main"])
def test_https(https: tuple[str, dict[str, str]], robots: Any, own_environment: dict[str, str], revision: str) -> None:
    url, trust = https
    source = fetch(f"git+{url}@{revision}#arm/arm.xml", {**own_environment, **trust})
    assert source.version == robots.git("rev-parse", f"{revision}^{{commit}}")
    assert source.path.read_text() == (robots.folder / "arm" / "arm.xml").read_text()


@pytest.mark.parametrize("known", [True, False])
def test_a_login_that_git_is_given(
    https: tuple[str, dict[str, str]],
    own_environment: dict[str, str],
    tmp_path: Path,
    known: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(_GitHandler, "login", f"Basic {base64.b64encode(b'robot:secret').decode()}")
    ask = tmp_path / "ask"
    ask.write_text('#!/bin/sh\ncase "$1" in Username*) echo robot;; *) echo secret;; esac\n')
    ask.chmod(0o755)
    environment = {**own_environment, **https[1], **({"GIT_ASKPASS": str(ask)} if known else {})}
    if known:
        assert fetch(f"git+{https[0]}@v1#arm/arm.xml", environment).path.is_file()
        return
    with pytest.raises(SourceError) as caught:
        fetch(f"git+{https[0]}@v1#arm/arm.xml", environment)
    assert caught.value.code == "source-fetch"


@pytest.mark.parametrize("trusts", [True, False])
def test_a_connection_whose_other_end_is_checked_checks_certificates_too(
    https: tuple[str, dict[str, str]], tmp_path: Path, trusts: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(download, "is_private", lambda netloc: False)
    monkeypatch.setattr(connections, "check_peer", lambda connection: None)
    if trusts:
        monkeypatch.setenv("SSL_CERT_FILE", https[1]["GIT_SSL_CAINFO"])
    lookup = Lookup(Path(), {"MJCOMPOSE_TIMEOUT": "5"}, Fetching(), is_confined=True)
    url = https[0].removesuffix("/.git") + "/.git/HEAD"
    if trusts:
        download.download(url, tmp_path / "file.part", download.Version(), lookup=lookup)
        assert (tmp_path / "file.part").read_text().startswith("ref: ")
        return
    with pytest.raises(SourceError, match="no certificate that this machine trusts"):
        download.download(url, tmp_path / "file.part", download.Version(), lookup=lookup)


def test_a_certificate_that_nobody_trusts_is_refused(
    https: tuple[str, dict[str, str]], own_environment: dict[str, str]
) -> None:
    with pytest.raises(SourceError) as caught:
        fetch(f"git+{https[0]}@v1#arm/arm.xml", own_environment)
    assert caught.value.code == "source-fetch"
    assert "certificate" in " ".join(caught.value.notes).lower()


def test_ssh(tmp_path: Path, robots: Any, own_environment: dict[str, str]) -> None:
    """What ssh would run on the other machine is run here; its arguments are host and command."""
    login = tmp_path / "login"
    login.write_text(f'#!/bin/sh\necho "$@" >> {tmp_path}/asked\nfor command; do :; done\nexec sh -c "$command"\n')
    login.chmod(0o755)
    environment = {**own_environment, "GIT_SSH_COMMAND": str(login), "GIT_SSH_VARIANT": "simple"}
    source = fetch(f"git+ssh://git@robots.example{robots.folder}@v1#arm/arm.xml", environment)
    assert source.version == robots.git("rev-parse", "v1^{commit}")
    assert "git@robots.example git-upload-pack" in (tmp_path / "asked").read_text()


def test_an_ssh_login_that_is_refused_is_told(tmp_path: Path, own_environment: dict[str, str]) -> None:
    login = tmp_path / "login"
    login.write_text("#!/bin/sh\necho 'git@robots.example: Permission denied (publickey).' >&2\nexit 255\n")
    login.chmod(0o755)
    environment = {**own_environment, "GIT_SSH_COMMAND": str(login), "GIT_SSH_VARIANT": "simple"}
    with pytest.raises(SourceError) as caught:
        fetch("git+ssh://git@robots.example/arms@v1#arm.xml", environment)
    assert caught.value.code == "source-fetch"
    assert "Permission denied (publickey)" in " ".join(caught.value.notes), caught.value.notes


@pytest.fixture
def mute() -> Iterator[int]:
    """The port of a server that takes every connection and never says a word."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield server.getsockname()[1]


@pytest.mark.skipif(shutil.which("ssh") is None, reason="needs ssh")
@pytest.mark.parametrize("command", ["", "ssh -F /dev/null"])
def test_an_ssh_server_that_says_nothing_is_given_up(
    mute: int, own_environment: dict[str, str], command: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mjcompose.sources.git_command._TRIES", 1)
    environment = {**own_environment, "MJCOMPOSE_TIMEOUT": "1", "GIT_SSH_COMMAND": command}
    began = time.monotonic()
    with pytest.raises(SourceError) as caught:
        fetch(f"git+ssh://git@127.0.0.1:{mute}/arms@v1#arm.xml", environment)
    assert time.monotonic() - began < 20
    assert "timed out" in " ".join(caught.value.notes), caught.value.notes


def test_a_part_of_a_second_is_one_for_git(mute: int, own_environment: dict[str, str]) -> None:
    with pytest.raises(SourceError) as caught:
        fetch(f"git+http://127.0.0.1:{mute}/arms@v1#arm.xml", {**own_environment, "MJCOMPOSE_TIMEOUT": "0.5"})
    assert "too slow" in " ".join(caught.value.notes), caught.value.notes


def confined(url: str, environment: dict[str, str]) -> Any:
    """Fetch what a fetched recipe names."""
    reference = replace(parse("git+https://robots.example.org/x@v1#arm/arm.xml"), name=url)
    lookup = Lookup(Path(), environment, Fetching(), is_confined=True)
    return git_repository.resolve(reference, lookup)


def test_git_connects_to_the_addresses_that_were_judged(
    web: Any, robots: Any, own_environment: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The name has no address when git asks for it, or another one."""
    web.serve(robots, "robots.git")
    port = web.url.rpartition(":")[2]
    monkeypatch.setattr(address, "_addresses", lambda name: (ip_address("127.0.0.1"),))
    monkeypatch.setattr(address, "is_public", lambda found: True)
    source = confined(f"http://robots.example.org:{port}/robots.git", own_environment)
    assert source.path.read_text() == (robots.folder / "arm" / "arm.xml").read_text()
    assert {headers["Host"] for _, headers in web.asked} == {f"robots.example.org:{port}"}


@pytest.mark.parametrize(
    ("addresses", "code"),
    [(["10.0.0.7"], "source-outside"), (["8.8.8.8", "::1"], "source-outside"), ([], "source-fetch")],
)
def test_git_does_not_start_for_a_server_that_is_not_public(
    own_environment: dict[str, str], addresses: list[str], code: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(address, "_addresses", lambda name: tuple(map(ip_address, addresses)))
    monkeypatch.setattr(git_repository.Git, "fetch", lambda *_, **__: pytest.fail("git has started"))
    for url in ("https://robots.example.org/x", "ssh://git@robots.example.org/x"):
        with pytest.raises(SourceError) as caught:
            confined(url, own_environment)
        assert caught.value.code == code


@pytest.mark.parametrize("is_confined", [True, False])
def test_a_repository_of_a_fetched_recipe_does_not_redirect(
    web: Any,
    robots: Any,
    own_environment: dict[str, str],
    answer: Callable[..., None],
    is_confined: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    web.serve(robots, "robots.git")
    suffix = "/info/refs?service=git-upload-pack"
    place = f"{web.url}/robots.git{suffix}"
    web.pages[f"/moved{suffix}"] = lambda handler: answer(handler, b"", status=301, Location=place)
    if not is_confined:
        assert fetch(f"git+{web.url}/moved@v1#arm/arm.xml", own_environment).path.is_file()
        return
    monkeypatch.setattr(git_repository, "is_private", lambda netloc: False)
    with pytest.raises(SourceError) as caught:
        confined(f"{web.url}/moved", own_environment)
    assert "redirects" in str(caught.value.help), caught.value.notes
    assert all(path.startswith("/moved") for path, _ in web.asked)


def test_a_server_of_a_fetched_recipe_names_no_other_for_its_objects(
    web: Any, robots: Any, own_environment: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Plain files of a repository may name further addresses with objects, which git follows with the redirects."""
    web.serve(robots, "robots.git")
    web.serve(robots, "other.git")
    for page in [page for page in web.pages if page.startswith("/robots.git/objects/")]:
        del web.pages[page]
    web.pages["/robots.git/objects/info/http-alternates"] = f"{web.url}/other.git/objects\n".encode()
    (tmp_path / "settings").write_text("[http]\n\tfollowRedirects = true\n")
    environment = {**own_environment, "GIT_CONFIG_GLOBAL": str(tmp_path / "settings")}
    assert fetch(f"git+{web.url}/robots.git@v1#arm/arm.xml", environment).path.is_file()
    assert any(path.startswith("/other.git") for path, _ in web.asked)
    web.asked.clear()
    monkeypatch.setattr(git_repository, "is_private", lambda netloc: False)
    with pytest.raises(SourceError):
        confined(f"{web.url}/robots.git", {**environment, "MJCOMPOSE_CACHE": str(tmp_path / "another store")})
    assert web.asked and not any(path.startswith("/other.git") for path, _ in web.asked)
