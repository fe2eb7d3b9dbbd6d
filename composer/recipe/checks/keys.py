"""The keys of one check, read one by one; what is wrong with them becomes a fault at its place."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from composer.diagnostics.suggest import closest, exists_note
from composer.recipe.fault import Fault, Path, Remark
from composer.recipe.pattern import pattern_fault
from composer.recipe.shown import kind_of


@dataclass(frozen=True, slots=True)
class Keys:
    """What stands behind `word` in the check `name`; faults have paths from the section `check`."""

    name: str
    word: str
    value: Any
    faults: list[Fault]

    @property
    def owner(self) -> str:
        return f"check `{self.name}`"

    def known(self, keys: Iterable[str], noun: str = "key") -> None:
        """Tell every key that is none of these."""
        keys = list(keys)
        for key in self.value:
            if key not in keys:
                near = closest(key, keys)
                remark = Remark(exists_note(noun, keys, key).message)
                help = f"write `{near[0]}`" if near else None
                message = f"`{self.word}` of {self.owner} has no {noun} `{key}`"
                self.add("unknown-key", message, key, key=True, remarks=(remark,), help=help)

    def add(
        self,
        code: str,
        message: str,
        *at: str | int,
        key: bool = False,
        remarks: tuple[Remark, ...] = (),
        help: str | None = None,
    ) -> None:
        """A fault at a path below this mapping."""
        path: Path = (self.name, self.word, *at)
        self.faults.append(Fault(code, message, path, key, remarks, help))

    def required(self, key: str, example: str) -> bool:
        """Whether a key is there; it is a fault where it is not."""
        if key in self.value:
            return True
        message = f"`{self.word}` of {self.owner} lacks `{key}`"
        at = (self.name, self.word)
        self.faults.append(
            Fault("missing-key", message, at, key=True, help=f"write `{key}: {example}`", lacks=key)
        )
        return False

    def one_of(self, *keys: str) -> str | None:
        """The one of several keys that is there; two are a fault."""
        found = [key for key in keys if key in self.value]
        for key in found[1:]:
            message = f"`{self.word}` of {self.owner} has both `{found[0]}` and `{key}`"
            self.add("wrong-type", message, key, key=True, help="take one of them out")
        return found[0] if found else None

    def text(self, key: str, what: str) -> str | None:
        """The text of a key; None where it is not there or is none."""
        if key not in self.value:
            return None
        return self.text_of(self.value[key], what, key)

    def text_of(self, value: Any, what: str, *at: str | int) -> str | None:
        """A value that must be a text, at its path."""
        if isinstance(value, str) and value:
            return value
        got = "nothing" if value == "" else kind_of(value)
        key = next(each for each in reversed(at) if isinstance(each, str))
        self.add("wrong-type", f"`{key}` of {self.owner} expects {what}, got {got}", *at)
        return None

    def glob_of(self, value: Any, what: str, *at: str | int) -> str | None:
        """A value that must be a name, a glob or a regular expression over names, at its path."""
        text = self.text_of(value, what, *at)
        if text is not None and (fault := pattern_fault(text, self.owner, (self.name, self.word, *at))):
            self.faults.append(fault)
            return None
        return text

    def number(
        self,
        key: str,
        default: float | None = None,
        *,
        least: float | None = None,
        above: float | None = None,
    ) -> float | None:
        """The number of a key, or the default where it is not there; None where it is none."""
        return (
            self.number_of(self.value[key], key, least=least, above=above) if key in self.value else default
        )

    def number_of(
        self, value: Any, *at: str | int, least: float | None = None, above: float | None = None
    ) -> float | None:
        """A value that must be a finite number within bounds, at its path."""
        number = _number(value)
        if number is None:
            noun = "a finite number" if isinstance(value, float) else "a number"
            self.add("wrong-type", f"`{at[0]}` of {self.owner} expects {noun}, got {kind_of(value)}", *at)
            return None
        if (least is not None and number < least) or (above is not None and number <= above):
            wanted = f"at least {least:g}" if least is not None else f"more than {above:g}"
            message = f"`{at[0]}` of {self.owner} is {number:g}, and must be {wanted}"
            self.add("out-of-range", message, *at)
            return None
        return number

    def numbers(self, key: str, count: int, example: str) -> tuple[float, ...] | None:
        """The list of so many numbers of a key; None where it is not there or is none."""
        if key not in self.value:
            return None
        value = self.value[key]
        if not isinstance(value, list) or len(value) != count:
            code = "wrong-length" if isinstance(value, list) else "wrong-type"
            got = f"{len(value)}" if isinstance(value, list) else kind_of(value)
            message = f"`{key}` of {self.owner} expects a list of {count} numbers, got {got}"
            self.add(code, message, key, help=f"write for instance `{key}: {example}`")
            return None
        found = [self.number_of(each, key, index) for index, each in enumerate(value)]
        return None if None in found else tuple(each for each in found if each is not None)


def _number(value: Any) -> float | None:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) if is_number and abs(value) <= sys.float_info.max else None
