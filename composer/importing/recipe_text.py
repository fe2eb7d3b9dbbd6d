"""Write a proposal as the text of a recipe."""

from __future__ import annotations

from composer.importing.entries import Entry
from composer.importing.propose import Proposal

_LISTS = frozenset({"add", "edit"})
_WHOLE = frozenset({"option", "size", "visual", "statistic", "compiler"})
_ORDER = (
    "attach option size visual statistic compiler asset add contact tendon equality actuator sensor edit keyframe"
).split()


def recipe_text(proposal: Proposal) -> tuple[str, dict[int, Entry]]:
    """Return the text, and the entry on each line (from 1). Entries with a note are comments."""
    lines = list(proposal.head)
    places: dict[int, Entry] = {}
    for section in _ORDER:
        entries = [entry for entry in proposal.entries if entry.section == section]
        if not entries:
            continue
        lines.append("")
        live = any(entry.note is None for entry in entries)
        if section in _WHOLE:
            lines.append(f"{'' if live else '# '}{section}: {entries[0].text}")
            places[len(lines)] = entries[0]
            continue
        lines.append(f"{section}:" if live else f"# {section}:")
        group = note = None
        for entry in sorted(entries, key=lambda entry: (entry.group, entry.rank)):
            if entry.group != group and entry.group:
                live = any(each.note is None for each in entries if each.group == entry.group)
                lines.append(f"{'' if live else '# '}  {entry.group}:")
                group = entry.group
            if entry.note is not None and entry.note != note:
                lines.append(f"  # not expressed: {entry.note}")
            note = entry.note
            dash = "- " if section in _LISTS or section == "contact" else ""
            indent = "    " if entry.group else "  "
            lines.append(f"{indent}{'# ' if entry.note is not None else ''}{dash}{entry.text}")
            places[len(lines)] = entry
    return "\n".join(lines) + "\n", places
