"""Step: joints, actuators, sensors and keys in the order of `interface`, and errors for other names and orders."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.report import counted
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import unknown_name
from mjcompose.build.plan.plan import Plan
from mjcompose.build.plan.steps import OrderElements
from mjcompose.language.interface import Order
from mjcompose.link.key_layout import BLOCKS
from mjcompose.link.linking import Linking
from mjcompose.link.ordering import elements_in_order, put_in_order, why_before
from mjcompose.text.node import locate
from mjcompose.tree.unit import Unit

if TYPE_CHECKING:
    from mjcompose.mujoco.index import Index

_SHOWN = 8
_PLAIN = re.compile(r"(?!(?:true|false|null|yes|no|on|off|y|n|nan|inf)$)[A-Za-z_][\w./-]*", re.ASCII | re.IGNORECASE)


def order_elements(plan: Plan, linking: Linking, *, keys: bool = False) -> None:
    """Order the elements, or the keys, and report an order that MJCF cannot have, and names that do not fit."""
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
            found = [name for _, name in elements_in_order(unit, order.kind)]
            _check(order, found, plan, sink=linking.sink, unit=unit)


def check_index(plan: Plan, index: Index, sink: Sink) -> None:
    """Report names and orders of the compiled model that differ from the interface."""
    for order in plan.interface:
        rows: Sequence[object] = getattr(index, {"key": "keyframes"}.get(order.kind, f"{order.kind}s"))
        _check(order, [str(getattr(each, "name", "")) for each in rows], plan, sink=sink)


def pasted(order: Order, names: Sequence[str]) -> str:
    """Return the list of an interface as text for a recipe."""
    listed = [name if _PLAIN.fullmatch(name) else json.dumps(name, ensure_ascii=False) for name in names]
    return f"`{order.kind}: [{', '.join([*listed, *(['…'] if order.more else [])])}]`"


def _check(order: Order, found: Sequence[str], plan: Plan, sink: Sink, unit: Unit | None = None) -> None:
    kind, others = order.kind, [name for name in found if name not in order.names]
    missing = [(at, name) for at, name in enumerate(order.names) if name not in found]
    for place, name in missing:
        span = locate(plan.document, (*order.at, place))
        sink.add(unknown_name(kind, name, filter(None, (*others, *found)), span=span))
    if missing:
        return
    span = locate(plan.document, order.at, key=True)
    if others and not order.more:
        _report_others(order, others, span=span, sink=sink)
        return
    at = next((at for at, name in enumerate(order.names) if found[at] != name), None)
    if at is None:
        return
    second, first = order.names[at], found[at]
    last = max(map(found.index, order.names))
    called = f"`{first}`" if first else f"a {kind} without a name"
    unlisted = ", which `interface` does not list" if first not in order.names else ""
    notes = [Note(why_before(unit, kind, first, second=second))] if unit is not None and first else []
    help = f"write the order that the model has: {pasted(order, found[: last + 1])}"
    if "" in found[: last + 1]:
        help = f"{_naming(kind, 1)}, and list it"
    message = f"the {kind} `{second}` cannot come before {called}{unlisted}"
    sink.error("interface-order", message, locate(plan.document, (*order.at, at)), notes=notes, help=help,
               subjects=(second, first))  # fmt: skip


def _naming(kind: str, count: int) -> str:
    name = f'"{kind}_${{index}}"' if count > 1 else "NAME"
    edit = f'edit: [{{select: {{{kind}: "**", where: {{name: ""}}}}, rename: {name}}}]'
    return f"name {'them' if count > 1 else 'it'}: `{edit}`"


def _report_others(order: Order, others: Sequence[str], span: Span, sink: Sink) -> None:
    kind, named = order.kind, [name for name in others if name]
    nameless = len(others) - len(named)
    shown = [f"`{name}`" for name in named[:_SHOWN]] + ["…"] * (len(named) > _SHOWN)
    shown += [f"{nameless} without a name"] * (nameless > 0)
    message = f"the model has {counted(len(others), kind)} that `interface` does not list: {', '.join(shown)}"
    help = f"add {'them' if len(named) > 1 else 'it'}: {pasted(order, [*order.names, *named])}"
    if nameless:
        help = _naming(kind, nameless)
    sink.error("interface-extra", message, span, help=f"{help}, or end the list with `…`", subjects=named)
