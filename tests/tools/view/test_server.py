"""Who is answered.

The server as a stranger sees it: what it answers, to whom, and for how long it waits.
"""

from __future__ import annotations

import hmac
import json
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from mjcompose.tools.view import server
from mjcompose.tools.view.server import Guard, Hub, PageServer
from tools.view.test_live import running

GUARD = Guard("127.0.0.1", 8080, "secret")
OWN = "127.0.0.1:8080"


@pytest.mark.parametrize(
    ("target", "hosts", "origins", "expected"),
    [
        ("/secret/", [OWN], [], ""),
        ("/secret/model/3", ["LOCALHOST:8080"], [], "model/3"),
        ("/secret/play", [OWN], [f"http://{OWN}"], "play"),
        ("/secret/../x?y", [OWN], [], "../x?y"),  # nothing is resolved: it is no key of the server's table
        ("/", [OWN], [], None),
        ("", [OWN], [], None),
        ("/secret", [OWN], [], None),
        ("secret/", [OWN], [], None),
        ("//secret/", [OWN], [], None),
        ("/secret?/", [OWN], [], None),
        ("/SECRET/", [OWN], [], None),
        ("/secre/", [OWN], [], None),
        ("/secrets/", [OWN], [], None),
        ("/wrong/", [OWN], [], None),
        ("/s\xe9cret/", [OWN], [], None),
        ("/s\ud800ret/", [OWN], [], None),
        ("/secret/", [], [], None),
        ("/secret/", [OWN, OWN], [], None),
        ("/secret/", ["evil.example:8080"], [], None),
        ("/secret/", ["127.0.0.1:9090"], [], None),
        ("/secret/", ["127.0.0.1"], [], None),
        ("/secret/", [OWN], ["http://evil.example"], None),
        ("/secret/", [OWN], ["http://localhost:8080"], None),
        ("/secret/", [OWN], [f"http://{OWN}.evil.example"], None),
        ("/secret/", [OWN], [f"http://{OWN}/"], None),
        ("/secret/", [OWN], ["http://127.0.0.1:808"], None),
        ("/secret/", [OWN], [f"https://{OWN}"], None),
        ("/secret/", [OWN], [f"http://{OWN}", f"http://{OWN}"], None),
        ("/secret/", [OWN], ["null"], None),
        ("/secret/", [OWN], [""], None),
    ],
)
def test_token_host_and_origin_must_be_right(
    target: str, hosts: list[str], origins: list[str], expected: str | None
) -> None:
    assert GUARD.key_of(target, hosts, origins) == expected


@pytest.mark.parametrize("host", ["0.0.0.0", "::", ""])
def test_who_listens_everywhere_is_asked_by_any_one_name(host: str) -> None:
    guard = Guard(host, 8080, "secret")
    assert guard.address == "http://127.0.0.1:8080/secret/"
    assert guard.key_of("/secret/", ["robot.lab:8080"], []) == ""
    assert guard.key_of("/secret/", ["robot.lab:8080"], ["http://robot.lab:8080"]) == ""
    assert guard.key_of("/secret/", ["robot.lab:8080"], ["http://evil.example"]) is None
    assert guard.key_of("/secret/", ["robot.lab:8080", "robot.lab:8080"], []) is None
    assert guard.key_of("/wrong/", ["robot.lab:8080"], []) is None


def test_addresses_of_version_6_have_brackets() -> None:
    assert Guard("::1", 80, "t").address == "http://[::1]:80/t/"


MODEL = (
    '<mujoco><asset><mesh name="m" file="m.obj"/></asset><worldbody><geom type="mesh" mesh="m"/></worldbody></mujoco>'
)
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
SECRET = "only its owner may read this"


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[PageServer]:
    folder = tmp_path_factory.mktemp("served")
    (folder / "m.obj").write_text(TETRAHEDRON)
    (folder / "model.xml").write_text(MODEL)
    (folder / "secret.txt").write_text(SECRET)
    with running("model.xml", folder) as found:
        for _ in range(400):
            if found.workshop.shown.version == 0:
                break
            time.sleep(0.05)
        yield found


def raw(served: PageServer, sent: bytes) -> tuple[int, bytes]:
    """The status of what a server answers to some bytes, and all of it."""
    with socket.create_connection(("127.0.0.1", served.guard.port), 5) as connection:
        connection.sendall(sent)
        found = b"".join(iter(lambda: connection.recv(1 << 16), b""))
    return int(found.split()[1]) if found.startswith(b"HTTP/1.1 ") else 0, found


def asked(
    served: PageServer, target: bytes, *headers: str, method: str = "GET", body: bytes = b"", host: str | None = None
) -> tuple[int, bytes]:
    at = urlsplit(served.address)
    lines = [f"Host: {at.netloc if host is None else host}", "Connection: close", *headers]
    if body:
        lines += ["Content-Type: application/json", f"Content-Length: {len(body)}"]
    head = method.encode() + b" " + target + b" HTTP/1.1\r\n" + "\r\n".join([*lines, "", ""]).encode("latin-1")
    return raw(served, head + body)


def token(served: PageServer) -> bytes:
    return urlsplit(served.address).path.encode()


def blob(served: PageServer) -> bytes:
    return f"blob/{next(iter(served.workshop.shown.blobs))}".encode()


ROUTES: list[Callable[[PageServer], bytes]] = [
    lambda served: b"",
    lambda served: b"page.js",
    lambda served: b"page.css",
    lambda served: b"model/0",
    blob,
]
UP = "/".join([".."] * 12)
ESCAPES = [
    "/",
    "//",
    "/.",
    "/..",
    "/../",
    "/../page.js",
    f"/{UP}/{{file}}",
    "/{file}",
    "//{file}",
    "{file}",
    "/../secret.txt",
    "../secret.txt",
    "..",
    "%2e%2e",
    "/%2e%2e/%2e%2e/secret.txt",
    "%2f{file}",
    "/%2f{file}",
    "%2F..%2Fsecret.txt",
    "%252e%252e%252fsecret.txt",
    "%252f{file}",
    "\\..\\secret.txt",
    "\\{file}",
    "%5c..%5csecret.txt",
    "\0",
    "\0.js",
    "%00",
    "%00/{file}",
    "/..%00/",
    ";/../secret.txt",
    "?/../secret.txt",
    "?{file}",
    "#{file}",
    "%c0%ae%c0%ae/{file}",
    "/..%c0%af..%c0%afsecret.txt",
    "\xff",
    "%u002e%u002e/",
    "./",
    "/./",
    "....//....//secret.txt",
    "/C:\\Windows\\win.ini",
    "/\\\\host\\share",
    "file://{file}",
    "/file://{file}",
    "~",
    "/~/.ssh/id_rsa",
    "%20",
    "\x0b{file}",
    "x" * 9_000,
    "/" * 60_000,
    "/../" * 15_000,
    "%2e" * 30_000,
]


@pytest.mark.parametrize("route", ROUTES, ids=["page", "js", "css", "model", "blob"])
def test_every_route_answers_its_own_name_and_no_way_out_of_it(
    served: PageServer, route: Callable[[PageServer], bytes]
) -> None:
    file = (Path(served.workshop._open().folder) / "secret.txt").as_posix()
    own = token(served) + route(served)
    assert asked(served, own)[0] == 200
    for escape in ESCAPES:
        more = escape.format(file=file).encode("latin-1")
        for target in (
            own + more,
            own[len(token(served)) :] + more,
            b"/" + route(served) + more,
            b"/wrong/" + route(served) + more,
        ):
            status, said = asked(served, target or b"/")
            assert status in (403, 404) and SECRET.encode() not in said, target[:200]
            assert status == 403 or target.startswith(token(served))


@pytest.mark.parametrize(
    "before", ["/", "//", "/.", "/x/..", "/%2e", "\\", "http://{host}", "http://evil.example", "%2f", "*", "."]
)
def test_the_token_stands_at_the_beginning(served: PageServer, before: str) -> None:
    own = before.format(host=urlsplit(served.address).netloc).encode() + token(served)
    assert {asked(served, own + name)[0] for name in (b"", b"page.js", b"../page.js")} == {403}


def test_lines_that_are_no_request_are_forbidden(served: PageServer) -> None:
    own = token(served)
    for sent in (
        b"GET " + own + b"\r\n\r\n",
        b"GET " + own + b" HTTP/1.0\r\n\r\n",
        b"GET " + own + b" x HTTP/1.1\r\n\r\n",
        b"GET \xa0 " + own + b" HTTP/1.1\r\n\r\n",
        b"GET\t" + own + b" HTTP/1.1\r\n\r\n",
        b"GET  " + own + b" HTTP/1.1\r\n\r\n",
        b"GET " + own + b" HTTP/9\r\n\r\n",
        b"\r\n\r\n",
        b"\0\r\n\r\n",
        b"GET\r\n\r\n",
        b"GET /" + b"x" * 100_000 + b" HTTP/1.1\r\n\r\n",
        b"GET " + own + b" HTTP/1.1\r\n" + b"a: b\r\n" * 200 + b"\r\n",
    ):
        status, said = raw(served, sent)
        assert status in (0, 403) and b"<html" not in said and (not said or b"Forbidden" in said), sent[:80]
    host = b"\r\nHost: " + urlsplit(served.address).netloc.encode() + b"\r\n\r\n"
    assert raw(served, b"GET " + own + b" HTTP/1.0" + host)[0] == 200
    for line in (
        b"GET \xa0 %s HTTP/1.1",
        b"GET\t%s HTTP/1.1",
        b"GET  %s HTTP/1.1",
        b"GET %s\x1fHTTP/1.1",
        b"GET\x85%s HTTP/1.1",
        b"GET %s",
    ):
        assert raw(served, line % own + host)[0] in (0, 403), line
    for method in ("HEAD", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE", "CONNECT", "get"):
        assert asked(served, own, method=method)[0] == 403


def test_who_asks_has_one_name_and_comes_from_one_place(served: PageServer) -> None:
    own = token(served)
    host = urlsplit(served.address).netloc
    assert asked(served, own, f"Origin: http://{host}")[0] == 200
    for headers in (
        [f"Host: {host}"],
        ["Host: evil.example"],
        ["Origin: http://evil.example"],
        [f"Origin: http://{host}.evil.example"],
        [f"Origin: http://{host}0"],
        [f"Origin: https://{host}"],
        [f"Origin: http://{host}/"],
        ["Origin: null"],
        ["Origin: "],
        [f"Origin: http://{host}", f"Origin: http://{host}"],
        [f"Origin: http://{host}", "Origin: http://evil.example"],
    ):
        assert asked(served, own, *headers)[0] == 403, headers
    for other in ("", "evil.example", f"{host}.evil.example", f"evil.example@{host}", f"{host}, {host}", "localhost"):
        assert asked(served, own, host=other)[0] == 403, other


PLAY = {"playing": False, "qpos": [], "ctrl": [], "key": -1}


@pytest.mark.parametrize(
    ("key", "body", "expected"),
    [
        ("play", json.dumps(PLAY), 204),
        ("shown", "{}", 204),
        ("play", "no", 400),
        ("play", "[]", 400),
        ("play", json.dumps(PLAY | {"qpos": "abc"}), 400),
        ("play", json.dumps(PLAY | {"key": "9" * 10_000}), 400),
        ("pose", '{"ctrl": [[]]}', 400),
        ("pose", "[" * 100_000, 400),
        ("look", '{"version": 9, "looked": "a", "qpos": [], "ctrl": []}', 204),
        ("look", '{"version": 0, "looked": "a", "qpos": {}}', 400),
        ("pull", '{"body": 1, "at": [0, 0, 0], "to": [1, 2, 3]}', 204),
        ("pull", '{"body": "x"}', 400),
        ("choose", '{"name": "a"}', 400),
        ("choose", '{"name": "\\ud800", "value": "b"}', 400),
        ("", "{}", 404),
        ("page.js", "{}", 404),
        ("play/../choose", "{}", 404),
        ("play/", "{}", 404),
        ("model/0", "{}", 404),
    ],
)
def test_what_a_page_wants_is_in_a_table_too(served: PageServer, key: str, body: str, expected: int) -> None:
    assert asked(served, token(served) + key.encode(), method="POST", body=body.encode())[0] == expected


def test_a_body_has_one_length_and_is_json(served: PageServer) -> None:
    own = token(served) + b"shown"
    kind = "Content-Type: application/json"
    for headers in (
        [kind],
        [kind, "Content-Length: -5"],
        [kind, "Content-Length: 1_0"],
        [kind, "Content-Length: \xb2"],
        ["Content-Length: 2"],
        [kind, "Content-Length: 2", "Content-Length: 3"],
        [kind, "Content-Length: 2", "Transfer-Encoding: chunked"],
        [kind, f"Content-Length: {1 << 30}"],
        [kind, f"Content-Length: {'9' * 5000}"],
        [kind, kind, "Content-Length: 2"],
        ["Content-Type: text/plain", "Content-Length: 2"],
    ):
        assert asked(served, own, *headers, method="POST")[0] == 400, headers


def test_what_is_late_gets_the_newest_model_and_no_other(served: PageServer) -> None:
    own = token(served)
    assert asked(served, own + b"model/0")[0] == 200
    for name in (
        b"model",
        b"model/",
        b"model/1",
        b"model/-1",
        b"model/00",
        b"model/0/",
        b"model/+0",
        b"model/ 0",
        b"blob",
        b"blob/",
        b"blob/x",
    ):
        assert asked(served, own + name)[0] in (403, 404), name


@pytest.mark.parametrize("error", [RecursionError, MemoryError, OSError, UnicodeError, KeyError])
@pytest.mark.parametrize("inner", [(hmac, "compare_digest"), (server, "ip_address"), (server, "_bracketed")])
def test_a_guard_that_fails_refuses(
    served: PageServer, error: type[Exception], inner: tuple[object, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*arguments: object) -> bool:
        raise error

    own = served.guard
    at = urlsplit(served.address)
    asks = f"/{own.token}/", [at.netloc], [f"http://{at.netloc}"]
    assert own.key_of(*asks) == ""
    monkeypatch.setattr(*inner, fails)
    if inner[1] != "ip_address" or not issubclass(error, ValueError):  # that is how it says that a host is a name
        assert own.key_of(*asks) is None
        assert raw(served, f"GET /{own.token}/ HTTP/1.1\r\nHost: {at.netloc}\r\n\r\n".encode())[0] == 403


def test_four_hundred_slow_clients_keep_nobody_away(served: PageServer) -> None:
    before = threading.active_count()
    with ExitStack() as opened:
        slow = []
        for number in range(400):
            connection = opened.enter_context(socket.create_connection(("127.0.0.1", served.guard.port), 5))
            connection.sendall(b"GET / HTTP/1.1\r\nHost: x\r\n"[: number % 25])
            slow.append(connection)
            if number % 100 == 99:
                begun = time.monotonic()
                assert asked(served, token(served) + b"page.js")[0] == 200
                assert time.monotonic() - begun < 2
        assert threading.active_count() - before <= server._MOST_CONNECTIONS
    for _ in range(200):
        if threading.active_count() <= before:
            break
        time.sleep(0.05)
    assert threading.active_count() <= before


@pytest.mark.parametrize(
    "sent",
    [
        b"",
        b"GET /",
        b"POST {}shown HTTP/1.1\r\nHost: {}\r\nContent-Type: application/json\r\nContent-Length: 9\r\n\r\n",
    ],
)
def test_nobody_is_waited_for_long_however_slowly_it_comes(
    served: PageServer, sent: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server, "_SECONDS_TO_ASK", 0.5)
    at = urlsplit(served.address)
    begun = time.monotonic()
    with socket.create_connection(("127.0.0.1", served.guard.port), 5) as connection:
        connection.sendall(sent.replace(b"{}", token(served), 1).replace(b"{}", at.netloc.encode()))
        connection.settimeout(0.05)
        while time.monotonic() - begun < 5:
            try:
                if not connection.recv(100):
                    break
            except TimeoutError:
                connection.sendall(b"1" if b"POST" in sent or sent else b"")
            except OSError:
                break
    assert time.monotonic() - begun < 2


def test_an_answer_that_nobody_reads_ends(served: PageServer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server, "_SECONDS_TO_READ", 0.3)
    monkeypatch.setitem(served.workshop.shown.blobs, "large", bytes(60_000_000))
    at = urlsplit(served.address)
    before = threading.active_count()
    with socket.create_connection(("127.0.0.1", served.guard.port), 5) as connection:
        connection.sendall(
            b"GET " + token(served) + b"blob/large HTTP/1.1\r\nHost: " + at.netloc.encode() + b"\r\n\r\n"
        )
        time.sleep(0.2)
        assert threading.active_count() == before + 1
        for _ in range(100):
            if threading.active_count() == before:
                break
            time.sleep(0.05)
        assert threading.active_count() == before


def test_there_are_only_so_many_pages() -> None:
    hub = Hub()
    pages = [hub.join() for _ in range(40)]
    assert sum(page is not None for page in pages) == 32 < server._MOST_CONNECTIONS
    assert pages[0] is not None
    hub.leave(pages[0])
    assert hub.join() is not None


def test_the_table_is_read_once(served: PageServer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server, "BUILT", Path("nowhere"))
    assert {asked(served, token(served) + name)[0] for name in (b"page.js", b"page.css")} == {200}


CHANGE = b'{"kind": "undo"}'


def _origin(served: PageServer) -> str:
    return f"Origin: http://{urlsplit(served.address).netloc}"


def test_a_recipe_is_changed_only_by_a_page_of_this_server(served: PageServer) -> None:
    """Without a browser nothing says where a request comes from, so it has to say it itself."""
    own = token(served) + b"change"
    origin = _origin(served)
    assert asked(served, own, origin, method="POST", body=CHANGE)[0] == 200
    assert asked(served, own, origin, "Sec-Fetch-Site: same-origin", method="POST", body=CHANGE)[0] == 200
    for headers in (
        [],
        ["Origin: null"],
        ["Origin: http://evil.example"],
        [origin, origin],
        [origin, "Sec-Fetch-Site: cross-site"],
        [origin, "Sec-Fetch-Site: same-site"],
        [origin, "Sec-Fetch-Site: none"],
        [origin, "Sec-Fetch-Site: "],
        [origin, "Sec-Fetch-Site: same-origin", "Sec-Fetch-Site: cross-site"],
    ):
        assert asked(served, own, *headers, method="POST", body=CHANGE)[0] == 403, headers
    assert asked(served, b"/change", origin, method="POST", body=CHANGE)[0] == 403
    assert asked(served, b"/wrong/change", origin, method="POST", body=CHANGE)[0] == 403
    assert asked(served, own, origin)[0] == 404
    for method in ("PUT", "PATCH", "DELETE"):
        assert asked(served, own, origin, method=method, body=CHANGE)[0] == 403


@pytest.mark.parametrize(
    "body",
    [
        "{}",
        "[]",
        "null",
        "1",
        '"undo"',
        '{"kind": "write"}',
        '{"kind": ["undo"]}',
        '{"kind": "place", "version": 0}',
        '{"kind": "place", "at": ["model.xml", NaN, 1], "version": 0}',
        "[" * 100_000,
        '{"kind": "keyframe", "name": "\\ud800", "version": []}',
        '{"kind": "attach", "version": 0}',
    ],
)
def test_a_change_that_is_none_is_a_bad_request_or_refused(served: PageServer, body: str) -> None:
    status, said = asked(served, token(served) + b"change", _origin(served), method="POST", body=body.encode())
    assert status == 400 or (status == 200 and b"refused" in said), said


def test_a_change_has_a_size(served: PageServer) -> None:
    headers = [_origin(served), "Content-Type: application/json", f"Content-Length: {2 << 20}"]
    assert asked(served, token(served) + b"change", *headers, method="POST")[0] == 400


@pytest.mark.parametrize(
    ("host", "writes", "expected"),
    [
        ("127.0.0.1", True, True),
        ("localhost", True, True),
        ("::1", True, True),
        ("127.0.0.1", False, False),
        ("0.0.0.0", True, False),
        ("::", True, False),
        ("", True, False),
        ("192.168.1.5", True, False),
        ("robot.lab", True, False),
    ],
)
def test_who_shares_a_page_or_says_read_only_writes_nothing(host: str, writes: bool, expected: bool) -> None:
    guard = Guard(host, 8080, "secret", writes=writes)
    assert guard.may_write([f"http://{host}:8080"], ["same-origin"]) is expected
    assert not guard.may_write([], ["same-origin"])
