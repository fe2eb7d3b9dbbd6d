"""Connections over HTTP that end before the first byte is sent if the other side is not public."""

from __future__ import annotations

import socket

from urllib3 import HTTPConnectionPool, HTTPSConnectionPool, PoolManager, Timeout
from urllib3.connection import HTTPConnection, HTTPSConnection
from urllib3.exceptions import LocationParseError
from urllib3.util import parse_url

from mjcompose.sources.address import is_public, resolved, take_apart


class NotPublicError(Exception):
    """The other side of a connection is on this machine or in its network."""


def check_peer(connection: socket.socket) -> None:
    """Raise NotPublicError if a connection leads to this machine or its network, whatever its name had resolved to."""
    try:
        peer = resolved(str(connection.getpeername()[0]))
        own = resolved(str(connection.getsockname()[0]))
        is_fit = is_public(peer) and peer != own
    except Exception:  # a guard that fails refuses
        is_fit = False
    if not is_fit:
        connection.close()
        raise NotPublicError


class _PublicConnection(HTTPConnection):
    _is_judged = False

    def _new_conn(self) -> socket.socket:
        connection = super()._new_conn()
        check_peer(connection)
        self._is_judged = True
        return connection

    def connect(self) -> None:
        super().connect()
        if not self._is_judged:  # a version of urllib3 that opens its connections in another way
            self.close()
            raise NotPublicError


class _PublicTlsConnection(_PublicConnection, HTTPSConnection):
    pass


class _PublicPool(HTTPConnectionPool):
    ConnectionCls = _PublicConnection


class _PublicTlsPool(HTTPSConnectionPool):
    ConnectionCls = _PublicTlsConnection


def public_pool(timeout: Timeout) -> PoolManager:
    """Return a pool whose connections raise NotPublicError for a server that is not public."""
    pool = PoolManager(timeout=timeout)
    pool.pool_classes_by_scheme = {"http": _PublicPool, "https": _PublicTlsPool}
    return pool


def is_read_alike(url: str) -> bool:
    """Return whether urllib3 connects to the server that `take_apart` finds in an address."""
    ours = take_apart(url)
    try:
        theirs = parse_url(url)
    except LocationParseError:
        return False
    if ours is None or theirs.auth is not None:
        return False
    host = (theirs.host or "").strip("[]")
    return (theirs.scheme, host, theirs.port) == (ours.scheme, ours.hostname, ours.port)
