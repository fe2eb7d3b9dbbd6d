"""The versions of MuJoCo that models can be migrated from and to."""

from __future__ import annotations

from composer.grammar.version import version_key

RELEASED = tuple(
    """
    3.0.0 3.0.1 3.1.0 3.1.1 3.1.2 3.1.3 3.1.4 3.1.5 3.1.6 3.2.0 3.2.1 3.2.2 3.2.3 3.2.4 3.2.5 3.2.6 3.2.7
    3.3.0 3.3.1 3.3.2 3.3.3 3.3.4 3.3.5 3.3.6 3.3.7 3.4.0 3.5.0 3.6.0 3.7.0 3.8.0 3.8.1 3.9.0 3.10.0 3.11.0
    3.12.0 3.13.0 3.14.0 3.15.0 3.16.0 3.17.0 4.0.0
    """.split()
)


def release(text: str) -> str | None:
    """The release that is meant: of `3.1` the last one; None for a version that there is not.

    >>> release("3.1"), release("3.2.3"), release("4"), release("2.3")
    ('3.1.6', '3.2.3', '4.0.0', None)
    """
    wanted = version_key(text)
    fitting = [each for each in RELEASED if version_key(each)[: len(wanted)] == wanted] if wanted else []
    return fitting[-1] if fitting else None


def later(version: str, than: str) -> bool:
    """Whether a version is later than another one."""
    return version_key(version) > version_key(than)
