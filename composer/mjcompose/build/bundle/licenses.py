"""The licenses of a plan's parts, as a table."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from mjcompose.base.dataclass import dataclass
from mjcompose.sources.context import Context

if TYPE_CHECKING:
    from mjcompose.build.plan.plan import Plan


@dataclass(frozen=True, slots=True)
class Row:
    """One part: its model reference, its license as an SPDX expression (None if unknown), and its license files."""

    part: str
    source: str
    license: str | None
    files: tuple[str, ...]

    @property
    def has_none(self) -> bool:
        """Whether nothing states the license; an unrecognized license text counts as a statement."""
        return self.license is None and not self.files


def license_rows(plan: Plan, context: Context) -> list[Row]:
    """Return a row for each part, with the base named after its file. Reads license files and the heads of models."""
    from mjcompose.build.bundle.assemble import sources  # a model from the cache needs none of this
    from mjcompose.sources.license import is_empty, license_of

    rows = []
    for label, source in sources(plan):
        files = tuple(context.shown(file) for file in source.licenses if not is_empty(file))
        rows.append(Row(label, source.reference, license_of(source), files=files))
    return rows


def license_table(rows: Iterable[Row]) -> str:
    """Return the rows in columns, with headings."""
    from mjcompose.sources.license import UNKNOWN

    lines = [("part", "source", "license", "file")]
    lines += [(row.part, row.source, row.license or UNKNOWN, ", ".join(row.files) or "-") for row in rows]
    widths = [max(len(line[column]) for line in lines) for column in range(3)]
    return "\n".join(
        "  ".join([*(text.ljust(width) for text, width in zip(line, widths, strict=False)), line[3]]) for line in lines
    )


def report_unlicensed(rows: Iterable[Row], context: Context) -> None:
    """Warn of the parts without a license, all at once."""
    bare = [row for row in rows if row.has_none]
    if not bare:
        return
    names = ", ".join(f"`{row.part}`" for row in bare[:20])
    if len(bare) > 20:
        names += f" and {len(bare) - 20} other parts"
    help = (
        "put a `LICENSE` with its text next to the model, or `<!-- SPDX-License-Identifier: CC-BY-4.0 -->` at its top"
    )
    context.sink.warning("license-missing", f"nothing says under which license {names} may be passed on", help=help)
