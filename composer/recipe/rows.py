"""Tables that must have a row for each member of a set. A missing or unknown row fails at import."""

from __future__ import annotations

from collections.abc import Iterable


def check_rows(table: str, rows: Iterable[object], members: Iterable[object]) -> None:
    """Raise TypeError if the rows of a table are not exactly the members.

    >>> check_rows("words", ["set", "scale"], ["set", "scale"])
    >>> check_rows("words", ["set"], ["set", "scale"])
    Traceback (most recent call last):
    TypeError: words: no row for scale
    """
    rows, members = list(rows), list(members)
    missing = [_name(each) for each in members if each not in rows]
    unknown = [_name(each) for each in rows if each not in members]
    faults = [f"no row for {', '.join(missing)}"] if missing else []
    faults += [f"a row for {', '.join(unknown)}, which does not exist"] if unknown else []
    if faults:
        raise TypeError(f"{table}: {'; '.join(faults)}")


def _name(member: object) -> str:
    return member.__name__ if isinstance(member, type) else str(member)
