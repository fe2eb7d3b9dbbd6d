"""What the outer recipe lets models and fetched recipes reach on this machine, beyond what they may anyway."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class Trust:
    """`files` are folders that one's own models may read; `references` are what fetched recipes may name.

    A reference is allowed that is one of `references`, or goes on after one at a separator:

    >>> trust = Trust(references=("git+file:///srv/robots", "package:arms"))
    >>> trust.allows("git+file:///srv/robots@v1#arm.xml"), trust.allows("package:armsdealer/arm.xml")
    (True, False)
    """

    files: tuple[Path, ...] = ()
    references: tuple[str, ...] = ()

    def with_more(self, other: Trust) -> Trust:
        """Both."""
        return Trust(
            tuple(dict.fromkeys((*self.files, *other.files))),
            tuple(dict.fromkeys((*self.references, *other.references))),
        )

    def allows(self, reference: str) -> bool:
        """Whether a fetched recipe may write the reference. No I/O."""
        if _LEADS_OUT.search(reference):  # out of the folder that was allowed
            return False
        return any(_begins(reference, each) for each in self.references)

    @property
    def folders(self) -> tuple[str, ...]:
        """The references that are paths: what fetched recipes may see of this machine."""
        return tuple(each for each in self.references if os.path.isabs(each))


_LEADS_OUT = re.compile(r"(^|[/\\])(\.|%2e){2}([/\\]|$)", re.IGNORECASE)
_SEPARATORS = "/:@#"


def _begins(text: str, start: str) -> bool:
    rest = text[len(start) :]
    return text.startswith(start) and (not rest or start[-1] in _SEPARATORS or rest[0] in _SEPARATORS)
