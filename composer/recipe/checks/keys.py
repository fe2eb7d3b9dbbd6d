"""The keys of one check. Faults in their values get their places here."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from typing import Any

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.fix import Fix
from composer.recipe.advice import without_unit
from composer.recipe.fault import Fault, Path, unknown_key
from composer.recipe.pattern import pattern_fault
from composer.recipe.shown import kind_of


@dataclass(frozen=True, slots=True)
class Keys:
    """The value behind `word` in the check `name`. The paths of faults start at the section `check`."""

    name: str
    word: str
    value: Any
    faults: list[Fault]

    @property
    def owner(self) -> str:
        return f"check `{self.name}`"

    def known(self, keys: Iterable[str], noun: str = "key") -> None:
        """Report every key that is not one of these."""
        keys = list(keys)
        for key in self.value:
            if key not in keys:
                message = f"`{self.word}` of {self.owner} has no {noun} `{key}`"
                self.faults.append(unknown_key(message, key, keys, at=(self.name, self.word, key), noun=noun))

    def add(
        self,
        code: str,
        message: str,
        *at: str | int,
        key: bool = False,
        notes: tuple[Note, ...] = (),
        help: str | None = None,
        fix: Fix | None = None,
    ) -> None:
        """Add a fault at a path below this mapping."""
        path: Path = (self.name, self.word, *at)
        self.faults.append(Fault(code, message, path, key=key, notes=notes, help=help, fix=fix))

    def lacks(self, key: str, example: str) -> None:
        """Report a missing key."""
        message = f"`{self.word}` of {self.owner} lacks `{key}`"
        at = (self.name, self.word)
        self.faults.append(
            Fault("missing-key", message, at, key=True, help=f"write `{key}: {example}`", lacks=key)
        )

    def one_of(self, *keys: str) -> str | None:
        """Return which of several keys is written, or None. Two of them are a fault."""
        found = [key for key in keys if key in self.value]
        for key in found[1:]:
            message = f"`{self.word}` of {self.owner} has both `{found[0]}` and `{key}`"
            self.add("wrong-type", message, key, key=True, help="take one of them out")
        return found[0] if found else None

    def text_of(self, value: Any, what: str, *at: str | int) -> str | None:
        """Return a value that must be a text, or None after a reported fault."""
        if isinstance(value, str) and value:
            return value
        got = "nothing" if value == "" else kind_of(value)
        key = next(each for each in reversed(at) if isinstance(each, str))
        self.add("wrong-type", f"`{key}` of {self.owner} expects {what}, got {got}", *at)
        return None

    def glob_of(self, value: Any, what: str, *at: str | int) -> str | None:
        """Return a value that must be a name, a glob or a regular expression over names."""
        text = self.text_of(value, what, *at)
        if text is not None and (fault := pattern_fault(text, self.owner, (self.name, self.word, *at))):
            self.faults.append(fault)
            return None
        return text

    def number_of(
        self, value: Any, *at: str | int, least: float | None = None, above: float | None = None
    ) -> float | None:
        """Return a value that must be a finite number within bounds, or None after a reported fault."""
        number = _number(value)
        if number is None:
            noun = "a finite number" if isinstance(value, float) else "a number"
            message = f"`{at[0]}` of {self.owner} expects {noun}, got {kind_of(value)}"
            advice = without_unit(value) if isinstance(value, str) else None
            help, fix = (advice.help, advice.fix) if advice is not None else (None, None)
            self.add("wrong-type", message, *at, help=help, fix=fix)
            return None
        if (least is not None and number < least) or (above is not None and number <= above):
            wanted = f"at least {least:g}" if least is not None else f"more than {above:g}"
            message = f"`{at[0]}` of {self.owner} is {number:g}, and must be {wanted}"
            self.add("out-of-range", message, *at)
            return None
        return number


def _number(value: Any) -> float | None:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) if is_number and abs(value) <= sys.float_info.max else None
