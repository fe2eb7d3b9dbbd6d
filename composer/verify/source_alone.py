"""Compile the source of a part alone and keep it in the session."""

from __future__ import annotations

from composer import engine
from composer.plan.part_record import PartRecord
from composer.sources import ros_package


def keep_source(member: PartRecord, session: engine.Session, name: str) -> str | None:
    """Keep the whole source under `name`; return a message if it cannot be read or MuJoCo refuses it."""
    path, text = member.source.path, None
    if member.source.format == "urdf":
        try:
            names = ros_package.packages_in(member.source.door.read(path).decode("utf-8", "replace"))
            packages = ros_package.folders(names, path, dict(member.source.packages))
            converted = engine.convert_urdf(
                path, packages, door=member.source.door, stands=member.stands, session=session
            )
        except OSError as error:
            return f"its source cannot be read: {(error.strerror or str(error)).lower()}"
        if (text := converted.text) is None:
            return refused(converted.error or converted.crash)
    file = path.name if text is None else f"{path.stem}.xml"
    compiled = engine.compile(path.parent, file, text=text, keep=name, session=session)
    return None if compiled.ok else refused(compiled.error or compiled.crash)


def refused(said: str | None) -> str:
    """Return the message about a source that MuJoCo does not compile alone."""
    return f"MuJoCo does not accept its source alone: {' '.join((said or '').split())}"
