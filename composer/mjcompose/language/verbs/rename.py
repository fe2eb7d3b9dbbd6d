"""The form of the verb `rename`: give elements new names, and update every reference."""

from __future__ import annotations

import re
from typing import Annotated

from pydantic import Field

from mjcompose.language.edit import Verb
from mjcompose.language.forms.model import WHOLE
from mjcompose.language.forms.scalars import Name
from mjcompose.text.evaluate import Template


class Rename(Verb):
    """the new name, which every reference follows"""

    name: Annotated[str, Name(computed=True, what="the new name", new=True)] = Field(
        alias=WHOLE, examples=['"${name}_left"']
    )
    """the new name"""

    def words(self) -> str:
        return f"rename to {self.name}"

    def new_names(self) -> re.Pattern[str] | None:
        """Return the names that it may give; None if it may give any name."""
        pieces = Template.parse(self.name).pieces
        if not any(isinstance(piece, str) for piece in pieces):
            return None
        return re.compile("".join(re.escape(piece) if isinstance(piece, str) else ".*" for piece in pieces))


VERB = Rename
