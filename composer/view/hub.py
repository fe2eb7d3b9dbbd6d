"""Send events to every open page."""

from __future__ import annotations

import json
import queue
from collections.abc import Iterator
from threading import Lock
from typing import Any

_MOST_WAITING, _MOST_PAGES = 64, 32
_BEAT_SECONDS = 15.0
_NOTHING = b": \n\n"


class Page:
    """One open page, from `Hub.join` to `Hub.leave`."""

    def __init__(self) -> None:
        self._waiting: queue.Queue[bytes | None] = queue.Queue(_MOST_WAITING)

    def put(self, message: bytes | None) -> None:
        """Add a message. If the page sleeps, its oldest messages are lost; it asks again when it wakes up."""
        while True:
            try:
                self._waiting.put_nowait(message)
                return
            except queue.Full:
                self._waiting.get_nowait()

    def messages(self) -> Iterator[bytes]:
        """Yield the messages for the page, and now and then a comment, which reveals a page that is gone."""
        while True:
            try:
                message = self._waiting.get(timeout=_BEAT_SECONDS)
            except queue.Empty:
                message = _NOTHING
            if message is None:
                return
            yield message


class Hub:
    """Server-Sent Events: `send` sends one to every page."""

    def __init__(self) -> None:
        self._pages: list[Page] = []
        self._lock = Lock()

    def join(self) -> Page | None:
        """Return a new page, or None if there are too many."""
        page = Page()
        with self._lock:
            if len(self._pages) >= _MOST_PAGES:
                return None
            self._pages.append(page)
        return page

    def leave(self, page: Page) -> None:
        with self._lock:
            self._pages.remove(page)

    def send(self, event: str, data: Any) -> None:
        self._put(encoded(event, data))

    def close(self) -> None:
        self._put(None)

    def _put(self, message: bytes | None) -> None:
        with self._lock:
            for page in self._pages:
                page.put(message)


def encoded(event: str, data: Any) -> bytes:
    return f"event: {event}\ndata: {json.dumps(data)}\n\n".encode()
