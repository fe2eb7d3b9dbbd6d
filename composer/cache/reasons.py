"""Explain why a model is built again: what changed in its key.

Files of `--set-file` are in the key with their contents, so that the changed value can be named.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping

GIVEN = "yes"
"""The value of an option without a value."""

_OPTION = "`--set-file "
_MOST = 1 << 16
_TEXT = "text:"


def differences(before: Mapping[str, str], after: Mapping[str, str]) -> tuple[str, ...]:
    """Return one line for each changed part of a key, sorted by name. No I/O.

    >>> differences({"`payload`": "1", "mjcompose": "a"}, {"`payload`": "2", "`--dedup`": "yes", "mjcompose": "a"})
    ('`--dedup` is given', '`payload` was 1, is 2')
    """
    return tuple(_changes(before, after))


def _changes(before: Mapping[str, str], after: Mapping[str, str]) -> Iterable[str]:
    for name in sorted({*before, *after}):
        was, now = before.get(name), after.get(name)
        if was == now:
            continue
        if _is_file(name):
            yield from value_changes(name, was, now)
        elif was is None:
            yield f"{name} is given" if now == GIVEN else f"{name} is {now}"
        elif now is None:
            yield f"{name} is no longer given" if was == GIVEN else f"{name} was {was}"
        else:
            yield f"{name} was {was}, is {now}"


def name_of(file: object) -> str:
    """Return the name of a file of values in a key. No I/O."""
    return f"{_OPTION}{file}`"


def content_of(data: bytes) -> str:
    """Return the content of such a file for a key: its text, or its sha256 if it is large or not text. No I/O."""
    if len(data) <= _MOST:
        try:
            return _TEXT + data.decode()
        except UnicodeDecodeError:
            pass
    from hashlib import sha256

    return sha256(data).hexdigest()


def _is_file(name: str) -> bool:
    return name.startswith(_OPTION)


def value_changes(name: str, was: str | None, now: str | None) -> Iterator[str]:
    r"""Yield one line for each changed value of such a file. No I/O.

    >>> list(value_changes("`--set-file a.yaml`", "text:load: 1\npose: [1, 2]\n", "text:load: 2\npose: [1, 2]\n"))
    ['`load` in `a.yaml` was 1, is 2']
    """
    if was is None or now is None:
        yield f"{name} is {'no longer ' if now is None else ''}given"
        return
    file = f"`{name.removeprefix(_OPTION)}"
    before, after = _values(was), _values(now)
    if before is None or after is None:
        yield f"{file} changed; which of its values is not known"
    elif before == after:
        yield f"{file} changed, but none of its values"
    else:
        for each in sorted({*before, *after}):
            old, new = before.get(each), after.get(each)
            if new is None:
                yield f"`{each}` in {file} was {old}, is no longer there"
            elif old != new:
                yield f"`{each}` in {file} " + (
                    f"is {new}, is new" if old is None else f"was {old}, is {new}"
                )


def _values(content: str) -> dict[str, str] | None:
    """Return the values by name as written, or None if they are unknown."""
    if not content.startswith(_TEXT):
        return None
    from composer.diagnostics.sink import Sink
    from composer.document import Mapping, Scalar, load, to_python

    node = load(content.removeprefix(_TEXT), "", Sink())
    if not isinstance(node, Mapping):
        return None
    return {
        name: value.text if isinstance(value, Scalar) else json.dumps(to_python(value), ensure_ascii=False)
        for name, (_, value) in node.entries.items()
    }
