"""What the outer recipe lets models and fetched recipes reach on this machine, beyond the defaults."""

from __future__ import annotations

import os
import re
from pathlib import Path

from composer.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Trust:
    """The files and references that the outer recipe trusts.

    `files` are folders that the user's own models may read; `references` are what fetched recipes may name. A
    reference is allowed if it is one of `references`, or continues one of them after a separator:

    >>> trust = Trust(references=("git+file:///srv/robots", "package:arms"))
    >>> trust.allows("git+file:///srv/robots@v1#arm.xml"), trust.allows("package:armsdealer/arm.xml")
    (True, False)
    """

    files: tuple[Path, ...] = ()
    references: tuple[str, ...] = ()

    def with_more(self, other: Trust) -> Trust:
        """Return the union of both."""
        return Trust(
            tuple(dict.fromkeys((*self.files, *other.files))),
            tuple(dict.fromkeys((*self.references, *other.references))),
        )

    def allows(self, reference: str) -> bool:
        """Return whether a fetched recipe may contain the reference. No I/O."""
        if _LEADS_OUT.search(reference):  # leads out of the allowed folder
            return False
        return any(_begins(reference, each) for each in self.references)

    @property
    def folders(self) -> tuple[str, ...]:
        """The references that are absolute paths: the folders of this machine that fetched recipes may read."""
        return tuple(each for each in self.references if os.path.isabs(each))


_LEADS_OUT = re.compile(r"(^|[/\\])(\.|%2e){2}([/\\]|$)", re.IGNORECASE)
_SEPARATORS = "/:@#"


def _begins(text: str, start: str) -> bool:
    rest = text[len(start) :]
    return text.startswith(start) and (not rest or start[-1] in _SEPARATORS or rest[0] in _SEPARATORS)
