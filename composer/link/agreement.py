"""Pass: the sections that a model has only once. A setting of a part that the model does not take is reported.

The model takes the base's value if the base writes one, else the value that all parts that write the setting agree
on, else MuJoCo's default. A setting that the recipe writes itself cannot conflict.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Cause, Note
from composer.diagnostics.span import Span
from composer.link.adopting import Opinions, common_settings, of_base
from composer.link.linking import Linking
from composer.link.part import Part
from composer.link.sizes import merge_sizes
from composer.link.written import Written, default_of, equal, merged, opinions, set_value
from composer.tree.adopted import Adopted

_NAMED = 4  # settings that a message names; the notes have all of them


@dataclass(frozen=True, slots=True)
class _Wish:
    """A setting of a part that differs from the model's; `settled` is the value that a merge gives it."""

    path: str
    wanted: Written
    have: Written | None
    settled: str | None = None

    @property
    def section(self) -> str:
        return self.path.split("/")[0]

    @property
    def shown(self) -> str:
        return f"`{self.path.replace('/', '.')}`"

    def written(self) -> Span | None:
        """The place of the model's own value, or None if it is not written."""
        return None if self.have is None else self.have.span()

    def difference(self, wanted: str) -> str:
        return f"{wanted} `{self.wanted.value}`, {_model_has(self.have, default_of(self.path))}"


def agreement(linking: Linking) -> None:
    """Compare what every unit writes, take what the parts agree on, then merge the sizes.

    Sizes make room for both; what contradicts the base is reported:

    >>> from composer.link.example import after
    >>> part = '<option gravity="0 0 0" cone="elliptic"/><size nuserdata="3"/>'
    >>> base = '<option gravity="0 0 -1"/>'
    >>> after(agreement, part, base)
    base: <option gravity="0 0 -1" cone="elliptic"/>
    base: <size nuserdata="3"/>
    error: `p/` wants `option.gravity` to be `0 0 0`, the model has `0 0 -1`
    """
    if not linking.parts:
        return
    model = opinions(linking.base)
    asked = [(part, opinions(part.unit)) for part in linking.parts]
    common, disagreed = _common(linking, model, asked)
    if linking.request.conflict == "merge":  # as in MuJoCo, a default gives way, wherever it is written
        unwritten = {each.path for each in linking.base.adopted if not each.is_written}
        model = {path: have for path, have in model.items() if path not in unwritten}
    elif linking.request.conflict == "error":
        for path, given in disagreed.items():
            owner, first = given[0]
            model[path] = first._replace(parts=(owner,))
    found = [(part, [*_wishes(linking, wanted, model, common)]) for part, wanted in asked]
    open_ones = [wish for _, wishes in found for wish in wishes if wish.settled is None]
    for part, wishes in found:
        _report_merged(linking, part, [wish for wish in wishes if wish.settled is not None])
        _report(linking, part, [wish for wish in wishes if wish.settled is None], open_ones)
    merge_sizes(linking)


def _common(
    linking: Linking, now: Opinions, asked: list[tuple[Part, dict[str, Written]]]
) -> tuple[dict[str, Adopted], dict[str, list[tuple[str, Written]]]]:
    """Return the settings that the parts agree on, which the base notes, and those that they do not agree on."""
    base, overridden = linking.base, linking.request.overridden_options
    parts = [(part.called, wanted) for part, wanted in asked]
    found, disagreed = common_settings(now, parts, overridden)
    base.adopted = (*of_base(base.adopted, now, overridden), *found.values())
    return found, disagreed


def _wishes(
    linking: Linking, asked: Opinions, model: dict[str, Written], common: Mapping[str, Adopted]
) -> Iterator[_Wish]:
    """Yield the settings that a part asks for and the model does not have. Later parts see the results of merges.

    What the parts agree on is written on the way, so that settings stand in the order in which parts write them.
    """
    for path, wanted in asked.items():
        if path in linking.request.overridden_options:
            continue
        if path in common:
            _take(linking, common[path])
            continue
        have = model.get(path)
        current = have.value if have is not None else default_of(path)
        if current is not None and equal(current, wanted.value):
            continue
        settled = merged(path, have, wanted) if linking.request.conflict == "merge" else None
        yield _Wish(path, wanted, have, settled)
        if settled is not None:
            set_value(linking.base, path, settled)
            model[path] = wanted._replace(value=settled)


def _take(linking: Linking, adopted: Adopted) -> None:
    if adopted.is_written:
        element = set_value(linking.base, adopted.path, adopted.value)
        linking.base.origins.settings.setdefault(element, {})[_name(adopted.path)] = adopted.at


def _report(linking: Linking, part: Part, wishes: list[_Wish], all_wishes: list[_Wish]) -> None:
    """Report all settings of a part in one finding with one help text for all parts. Equal parts share a finding."""
    if not wishes:
        return
    message, notes, span, cause = _described(part, wishes)
    if linking.request.conflict == "warning":
        stands = ", which stands" if len(wishes) == 1 else "; the model's values stand"
        linking.sink.warning("option-conflict", f"{message}{stands}", span, notes=notes, cause=cause)
        return
    asked: dict[str, str] = {}
    for wish in all_wishes:
        asked.setdefault(wish.path, wish.wanted.value)
    sections = dict.fromkeys(wish.section for wish in wishes)
    others = [f"leave those of the part out: `drop: [{', '.join(sections)}]`"]
    if linking.request.conflict == "error" and _would_merge(all_wishes):
        others.append("write `conflict: merge`")
    sentence, *lines = settling(asked, linking.request.overridden_options).split("\n")
    help = "\n".join([f"{sentence}; or {', or '.join(others)}", *lines])
    subjects = (part.called, *(wish.path for wish in wishes))
    linking.sink.error(
        "option-conflict", message, span, notes=notes, help=help, cause=cause, subjects=subjects
    )


def _report_merged(linking: Linking, part: Part, wishes: list[_Wish]) -> None:
    if not wishes:
        return
    message, notes, span, cause = _described(part, wishes)
    message += f"; merged to `{wishes[0].settled}`" if len(wishes) == 1 else "; they are merged"
    linking.sink.warning("option-conflict", message, span, notes=notes, cause=cause)


def _described(part: Part, wishes: list[_Wish]) -> tuple[str, list[Note], Span, Cause]:
    """Return the message, the notes with both values, the place, and the cause by which equal parts are recognized."""
    first = wishes[0]
    if len(wishes) == 1:
        message = first.difference(f"`{part.called}` wants {first.shown} to be")
        place = first.written()
        notes = (
            []
            if place is None or first.have is None
            else [Note(f"`{first.have.value}` is written here", place)]
        )
    else:
        names = ", ".join(wish.shown for wish in wishes[:_NAMED])
        more = f" and {len(wishes) - _NAMED} more settings" if len(wishes) > _NAMED else ""
        message = f"`{part.called}` wants other values than the model has of {names}{more}"
        notes = [Note(_noted(wish), wish.written()) for wish in wishes]
    same = [[wish.path, wish.wanted.value, wish.settled] for wish in wishes]
    return message, notes, first.wanted.span(), Cause(str(same), f"`{part.called}`")


def _noted(wish: _Wish) -> str:
    said = wish.difference(f"{wish.shown}: it wants")
    return said if wish.settled is None else f"{said}; merged to `{wish.settled}`"


def _would_merge(wishes: Iterable[_Wish]) -> bool:
    """Return whether `conflict: merge` would resolve all conflicts."""
    model: dict[str, Written] = {}
    for wish in wishes:
        have = model.get(wish.path, wish.have)
        if have is not None and equal(have.value, wish.wanted.value):
            continue
        settled = merged(wish.path, have, wish.wanted)
        if settled is None:
            return False
        model[wish.path] = wish.wanted._replace(value=settled)
    return True


def _model_has(have: Written | None, current: str | None) -> str:
    if have is not None:
        return f"{f'`{have.parts[0]}`' if have.parts else 'the model'} has `{have.value}`"
    if current is not None:
        return f"the model has `{current}`, MuJoCo's default"
    return "the model leaves it to MuJoCo"


def _name(path: str) -> str:
    return path.rsplit("/", 1)[1]


def settling(wanted: Mapping[str, str], settled: Collection[str]) -> str:
    """Return what to write in a recipe to resolve all conflicts.

    `wanted` has the value that one part asks for, by path; `settled` are the paths that the recipe sets already.

    >>> settling({"option/cone": "elliptic", "option/flag/gravity": "disable"}, ())
    'say in the recipe which it is, for example `option: {cone: elliptic, flag: {gravity: disable}}`'
    """
    tree: dict[str, Any] = {}
    for path, value in wanted.items():
        *inner, name = path.split("/")
        place = tree
        for tag in inner:
            place = place.setdefault(tag, {})
        tokens = value.split()
        place[name] = f"[{', '.join(tokens)}]" if len(tokens) > 1 else value
    written_already = {path.split("/")[0] for path in settled}
    new = [
        f"{section}: {_flow(values)}" for section, values in tree.items() if section not in written_already
    ]
    grown = [
        f"say which it is in the recipe's `{section}`, for example `{_flow(values)[1:-1]}`"
        for section, values in tree.items()
        if section in written_already
    ]
    if len(new) > 1:
        return "\n".join(["; ".join([*grown, "say in the recipe which it is, for example as follows"]), *new])
    return "; ".join([*grown, *(f"say in the recipe which it is, for example `{each}`" for each in new)])


def _flow(tree: Mapping[str, Any]) -> str:
    entries = (f"{name}: {value if isinstance(value, str) else _flow(value)}" for name, value in tree.items())
    return f"{{{', '.join(entries)}}}"
