"""A row of the table of what was read of a source that is not MJCF, and what was not."""

from __future__ import annotations

from composer.dataclass import dataclass
from composer.diagnostics.span import Span


@dataclass(frozen=True, slots=True)
class ReadRow:
    """`count` elements of the kind `what`, with what they `became`, or `why` they are not in the model.

    `what` is a path of tags, such as `joint/limit`, with an attribute behind it where only that is meant
    (`joint/limit velocity`), or the tag that they lack (`link without inertial`). `span` is where the first of them
    stands. A row that nearly every file has `is_minor`.
    """

    what: str
    count: int
    became: str
    why: str
    span: Span
    is_minor: bool = False

    @property
    def called(self) -> str:
        """Its name in messages.

        >>> ReadRow("joint/limit velocity", 6, "", "", Span("arm.urdf", 1, 1)).called
        '`<joint><limit>` `velocity` (6)'
        >>> ReadRow("link without inertial", 1, "", "", Span("arm.urdf", 1, 1)).called
        '`<link>` without `<inertial>` (1)'
        """
        tags, _, more = self.what.partition(" ")
        lacks = more.removeprefix("without ")
        inside = f" without `<{lacks}>`" if lacks != more else f" `{more}`" if more else ""
        return f"`{''.join(f'<{tag}>' for tag in tags.split('/'))}`{inside} ({self.count})"
