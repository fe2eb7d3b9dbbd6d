"""The order of the parts: as in the file, but for those that say `before` or `after` which other part they stand."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.diagnostics.unknown import unknown_name
from composer.document.node import Mapping as Located
from composer.document.node import locate
from composer.recipe.attach import RESERVED, Attachment


def in_order(parts: Mapping[str, Attachment], document: Located, sink: Sink) -> list[str]:
    """The keys of the parts in their order.

    A part that is moved stands right before, or right after, the other one and what was moved there earlier in the
    file. What cannot be is told, and that part stays where it is written.
    """
    asked = {key: dict(_asked(key, parts, document, sink)) for key in parts}
    order = [key for key in parts if not asked[key]]
    waiting = [key for key in parts if asked[key]]
    behind: dict[str, list[str]] = {key: [] for key in parts}
    while waiting:
        ready = next((key for key in waiting if all(other in order for other in asked[key].values())), None)
        if ready is None:
            _ring(waiting, asked, document, sink)
            return list(parts)
        waiting.remove(ready)
        before, after = asked[ready].get("before"), asked[ready].get("after")
        if after is not None:
            last = after
            while behind[last]:
                last = behind[last][-1]
            at = order.index(last) + 1
            behind[after].append(ready)
            if before is not None and order.index(before) < at:
                _contradiction(ready, before, after, document, sink)
        else:
            assert before is not None
            at = order.index(before)
        order.insert(at, ready)
    return order


def _asked(
    key: str, parts: Mapping[str, Attachment], document: Located, sink: Sink
) -> Iterator[tuple[str, str]]:
    for word in ("before", "after"):
        other = getattr(parts[key], word)
        if other in parts:
            yield word, other
        elif other is not None:
            known = [each for each in parts if each != key]
            span = locate(document, ("attach", key, word))
            first = f"the {RESERVED} always comes first: leave `{word}` out" if other == RESERVED else None
            purpose, written = f" for `{key}` to stand {word}", f"{word}: {{}}"
            sink.add(
                unknown_name(
                    "part", other, known, span, purpose=purpose, written=written, help=first, about=(key,)
                )
            )


def _ring(waiting: list[str], asked: Mapping[str, Mapping[str, str]], document: Located, sink: Sink) -> None:
    ring = [waiting[0]]
    while True:
        word, other = next((word, each) for word, each in asked[ring[-1]].items() if each in waiting)
        if other in ring:
            break
        ring.append(other)
    ring = ring[ring.index(other) :]
    steps = []
    for key in ring:
        word, other = next((word, each) for word, each in asked[key].items() if each in waiting)
        steps.append(f"`{key}` {word} `{other}`")
    first = ring[0]
    word = next(word for word, each in asked[first].items() if each in waiting)
    sink.error(
        "part-order",
        "parts shall stand in a ring: " + ", ".join(steps),
        locate(document, ("attach", first, word)),
        help="take one `before` or `after` out",
    )


def _contradiction(key: str, before: str, after: str, document: Located, sink: Sink) -> None:
    sink.error(
        "part-order",
        f"`{key}` shall stand after `{after}` and before `{before}`, which comes earlier",
        locate(document, ("attach", key, "before")),
        notes=(Note("`after` is here", locate(document, ("attach", key, "after"))),),
        help="leave one of the two out",
        subjects=(key, after, before),
    )
