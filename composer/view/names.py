"""File names that reveal nothing about the machine."""

from __future__ import annotations

import os
from dataclasses import field, replace
from pathlib import Path, PurePath

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.diff.change import Cause, Diff, End, Group
from composer.diff.revision import split


@dataclass(slots=True)
class Names:
    """Short unique names for the files of several models.

    `folder` is the user's folder: files below it keep their relative path. Others get the shortest unique end of
    their path.
    """

    folder: Path
    _files: dict[str, str] = field(default_factory=dict)

    def of(self, name: str) -> str:
        """Return the short name of the file that messages call `name`."""
        if not os.path.isabs(name) and self.folder != Path(self.folder.anchor):
            return self._files.setdefault(name, name)
        parts = [part for part in PurePath(name).parts if part not in (os.sep, PurePath(name).anchor)]
        for count in range(1, len(parts) + 1):
            short = "/".join(parts[-count:])
            if self._files.setdefault(short, name) == name:
                return short
        return name

    def span(self, span: Span | None) -> Span | None:
        return None if span is None else replace(span, file=self.of(span.file))

    def diff(self, found: Diff) -> Diff:
        """Return a comparison whose text has short names."""
        groups = tuple(Group(self._cause(each.cause), each.changes) for each in found.groups)
        return replace(found, a=self._end(found.a), b=self._end(found.b), groups=groups)

    def _cause(self, cause: Cause | None) -> Cause | None:
        if cause is None:
            return None
        return replace(cause, before=self.span(cause.before), after=self.span(cause.after))

    def _end(self, end: End) -> End:
        in_revision = None if os.path.exists(self.folder / end.label) else split(end.label)
        if in_revision is None:
            return replace(end, label=self.of(end.label))
        revision, path = in_revision
        return replace(end, label=f"{revision}:{self.of(path)}")
