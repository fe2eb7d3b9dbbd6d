"""Step: joints, actuators, sensors and keys in the order of `interface`, which is compared with the lock."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import unknown_name
from mjcompose.base.words import counted, element_text
from mjcompose.language.recipe import Order
from mjcompose.link.key_layout import BLOCKS
from mjcompose.link.linking import Linking
from mjcompose.link.ordering import elements_in_order, put_in_order, why_before
from mjcompose.plan.plan import Plan
from mjcompose.plan.steps import OrderElements
from mjcompose.sources.context import Context
from mjcompose.sources.lock import LockedName
from mjcompose.text.node import locate
from mjcompose.tree.unit import Unit

if TYPE_CHECKING:
    from mjcompose.mujoco.index import CompiledIndex

_SHOWN = 8
_PLAIN = re.compile(r"(?!(?:true|false|null|yes|no|on|off|y|n|nan|inf)$)[A-Za-z_][\w./-]*", re.ASCII | re.IGNORECASE)


def order_elements(plan: Plan, linking: Linking, *, keys: bool = False) -> None:
    """Order the elements or the keys, and report orders that MJCF cannot express and names that do not fit."""
    unit = linking.base
    if linking.sink.has_errors:  # the model may lack elements
        return
    for step in plan.steps:
        if not isinstance(step, OrderElements) or (step.order.kind == "key") != keys:
            continue
        order = step.order
        put_in_order(unit, order.kind, order.names)
        linking.watch(linking.units, step)
        if next(unit.root.iter(*BLOCKS), None) is None:  # otherwise only MuJoCo knows all names: `check_index`
            _check(order, [name for _, name in elements_in_order(unit, order.kind)], plan, sink=linking.sink, unit=unit)


def check_index(plan: Plan, index: CompiledIndex, sink: Sink) -> None:
    """Report names and orders of the compiled model that differ from the interface."""
    for order in plan.interface:
        _check(order, [each.name for each in _rows(index, order.kind)], plan, sink=sink)


def locked_interface(orders: Sequence[Order], index: CompiledIndex) -> dict[str, list[LockedName]]:
    """Return the names that a recipe lists, as a lock has them."""
    found: dict[str, list[LockedName]] = {}
    for order in orders:
        rows = {each.name: each for each in _rows(index, order.kind)}
        found[order.kind] = [_locked(rows[name]) for name in order.names if name in rows]
    return found


def _rows(index: CompiledIndex, kind: str) -> Sequence[Any]:
    return {"joint": index.joints, "actuator": index.actuators, "sensor": index.sensors, "key": index.keyframes}[kind]


def _locked(row: Any) -> LockedName:
    names = ("qpos_size", "dof_size", "ctrl_size", "act_size", "size")
    sizes = [getattr(row, name) for name in names if hasattr(row, name)]
    ranges = list(getattr(row, "ctrl_ranges", ())) or ([row.range] if getattr(row, "limited", False) else [])
    # The last digits of a range in degrees depend on the machine.
    exact = [None if pair is None else [float(f"{each:.12g}") for each in pair] for pair in ranges]
    type = getattr(row, "type", None)
    unit = getattr(row, "unit", None)
    return LockedName(name=row.name, type=type, unit=unit, sizes=sizes, ranges=exact)


def check_locked_interface(plan: Plan, index: CompiledIndex, context: Context) -> None:
    """Report differences of the compiled model from the interface in the lock, if it has one."""
    fetching = context.fetching
    if fetching is None or fetching.lock is None or not fetching.lock.interface or fetching.lock_file is None:
        return
    before = fetching.lock.interface
    after = locked_interface(plan.interface, index)
    if changes := [*interface_changes(before, after)]:
        span = locate(plan.document, ("interface",), key=True) if plan.interface else plan.span
        help = f"if you want the change, run `mjcompose lock {plan.file} --upgrade-interface`"
        message = f"the interface differs from the lock `{context.shown(fetching.lock_file)}`"
        context.sink.error("interface-changed", message, span, notes=list(map(Note, changes)), help=help)


def interface_changes(
    before: Mapping[str, Sequence[LockedName]], after: Mapping[str, Sequence[LockedName]]
) -> Iterator[str]:
    for kind in dict.fromkeys((*before, *after)):
        old, new = ({each.name: each for each in rows.get(kind, ())} for rows in (before, after))
        yield from (f"the {kind} `{name}` is no longer listed" for name in old if name not in new)
        yield from (f"the {kind} `{name}` is new" for name in new if name not in old)
        kept = [name for name in new if name in old]
        if kept != [name for name in old if name in new]:
            yield f"the order of {kind}s is now {', '.join(f'`{name}`' for name in new)}"
        for name in kept:
            rows = old[name].model_dump(), new[name].model_dump()
            yield from (
                f"the {kind} `{name}`: {field} {value} is now {rows[1][field]}"
                for field, value in rows[0].items()
                if value != rows[1][field]
            )


def pasted(order: Order, names: Sequence[str]) -> str:
    """Return the list of an interface as text for a recipe."""
    listed = [name if _PLAIN.fullmatch(name) else json.dumps(name, ensure_ascii=False) for name in names]
    return f"`{order.kind}: [{', '.join([*listed, *(['…'] if order.more else [])])}]`"


def _check(order: Order, found: Sequence[str], plan: Plan, sink: Sink, unit: Unit | None = None) -> None:
    kind = order.kind
    others = [name for name in found if name not in order.names]
    missing = [(at, name) for at, name in enumerate(order.names) if name not in found]
    for place, name in missing:
        span = locate(plan.document, (*order.at, place))
        sink.add(unknown_name(kind, name, filter(None, (*others, *found)), span=span))
    if others and not order.more and not missing:
        _report_others(order, others, span=locate(plan.document, order.at, key=True), sink=sink)
        return
    at = None if missing else next((at for at, name in enumerate(order.names) if found[at] != name), None)
    if at is None:
        return
    second = order.names[at]
    first = found[at]
    last = max(map(found.index, order.names))
    called = f"`{first}`" if first else element_text(kind, None)
    unlisted = ", which `interface` does not list" if first not in order.names else ""
    reason = f"MuJoCo puts the {kind}s of a model that it attaches after all others, and keeps its joints together"
    if unit is not None:
        reason = why_before(unit, kind, first, second=second)
    help = f"write the order that the model has: {pasted(order, found[: last + 1])}"
    if "" in found[: last + 1]:
        help = f"{_naming(kind, 1)}, and list it"
    message = f"the {kind} `{second}` cannot come before {called}{unlisted}"
    sink.error(
        "interface-order",
        message,
        locate(plan.document, (*order.at, at)),
        notes=[Note(reason)],
        help=help,
        subjects=(second, first),
    )


def _naming(kind: str, count: int) -> str:
    name = f'"{kind}_${{index}}"' if count > 1 else "NAME"
    edit = f'edit: [{{select: {{{kind}: "**", where: {{name: ""}}}}, rename: {name}}}]'
    return f"name {'them' if count > 1 else 'it'}: `{edit}`"


def _report_others(order: Order, others: Sequence[str], span: Span, sink: Sink) -> None:
    kind = order.kind
    named = [name for name in others if name]
    nameless = len(others) - len(named)
    shown = [f"`{name}`" for name in named[:_SHOWN]] + ["…"] * (len(named) > _SHOWN)
    shown += [f"{nameless} without a name"] * (nameless > 0)
    message = f"the model has {counted(len(others), kind)} that `interface` does not list: {', '.join(shown)}"
    help = f"add {'them' if len(named) > 1 else 'it'}: {pasted(order, [*order.names, *named])}"
    if nameless:
        help = _naming(kind, nameless)
    sink.error("interface-extra", message, span, help=f"{help}, or end the list with `…`", subjects=named)
