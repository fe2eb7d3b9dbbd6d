"""Compile the source of a part alone and keep it in the session."""

from __future__ import annotations

from composer import engine
from composer.diagnostics.sink import Sink
from composer.link.measure import folder_of
from composer.plan.part_record import PartRecord
from composer.tree.write import write


def keep_source(member: PartRecord, session: engine.Session, name: str) -> str | None:
    """Keep the whole source under `name`; return a message if it cannot be read or MuJoCo refuses it."""
    path = member.source.path
    if member.source.format == "urdf":
        return _keep_urdf(member, session, name)
    compiled = engine.compile(path.parent, path.name, keep=name, session=session)
    return None if compiled.ok else refused(compiled.error or compiled.crash)


def _keep_urdf(member: PartRecord, session: engine.Session, name: str) -> str | None:
    from composer.urdf.read import UrdfReader  # few recipes need it

    sink = Sink()
    unit = UrdfReader(member.source, sink, session, stands=member.stands).unit()
    if unit is None:
        found = sink.errors
        return f"its source cannot be read: {found[0].message}" if found else "its source cannot be read"
    with folder_of(unit) as folder:
        text = write(unit.root).decode()
        compiled = engine.compile(folder, "source.xml", text=text, keep=name, session=session)
    return None if compiled.ok else refused(compiled.error or compiled.crash)


def refused(said: str | None) -> str:
    """Return the message about a source that MuJoCo does not compile alone."""
    return f"MuJoCo does not accept its source alone: {' '.join((said or '').split())}"
