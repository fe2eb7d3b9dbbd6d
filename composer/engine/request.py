"""One request to MuJoCo, as plain data for the child process."""

from __future__ import annotations

import json
from pathlib import Path

from composer.dataclass import dataclass

WANTS = frozenset({"forward", "index", "names"})


@dataclass(frozen=True, slots=True)
class Request:
    """Compile `folder/model` and report on it.

    `wants` lists what the answer has besides sizes and warnings: `index` (joints, actuators, sensors with their
    addresses), `names` (of every kind of object), `forward` (one mj_forward at the reference configuration).
    `arrays` are attributes of mjModel, or of mjData after mj_forward if written `data.NAME`. `mjb` is the path for
    the compiled model. `keep` is a name under which a session's child keeps the compiled model for `Session.call`.
    `text`, if given, replaces the file's content; the file need not exist then, and relative paths in the text
    still start at its folder. `stands` says that only the model in `folder` ever changes, so that MuJoCo may reuse
    the other files.
    """

    folder: Path
    model: str = "model.xml"
    wants: tuple[str, ...] = ()
    arrays: tuple[str, ...] = ()
    mjb: Path | None = None
    text: str | None = None
    keep: str | None = None
    stands: bool = False

    def __post_init__(self) -> None:
        unknown = set(self.wants) - WANTS
        if unknown:
            raise ValueError(f"unknown wants {sorted(unknown)}; there are {sorted(WANTS)}")

    def to_json(self, arrays_file: Path, step: float = 0) -> str:
        """Return one line of JSON. All paths in it are absolute, because the child works in another folder.

        `step` is the limit for the forward step in seconds; 0 is no limit.
        """
        return json.dumps(
            {
                "folder": str(self.folder.absolute()),
                "model": self.model,
                "wants": self.wants,
                "arrays": self.arrays,
                "arrays_file": str(arrays_file),
                "mjb": None if self.mjb is None else str(self.mjb.absolute()),
                "text": self.text,
                "keep": self.keep,
                "step": step,
                "stands": self.stands,
            },
            ensure_ascii=False,
        )
