"""Step: an element under a body, a frame or the world."""

from __future__ import annotations

from composer.diagnostics.suggest import exists_note
from composer.grammar import GRAMMAR
from composer.link.linking import Linking
from composer.plan.plan import AddElement
from composer.steps.elements import Making, make
from composer.tree.classes import NESTED


def add(step: AddElement, linking: Linking, making: Making) -> None:
    """Append the element; in the world it takes the base's top class, as if it were written in the base."""
    if step.to_kind == "world":
        holder = linking.base.section("worldbody")
    else:
        found = linking.names.find(step.to_kind, step.to)
        if found is None:
            names = linking.names.of(step.to_kind)
            making.sink.error(
                "unknown-name",
                f"there is no {step.to_kind} `{step.to}` to add to",
                step.to_span,
                notes=(exists_note(step.to_kind, names, step.to),),
            )
            return
        holder = found
    kind = GRAMMAR.element("worldbody" if step.to_kind == "world" else step.to_kind)
    node = make(step.element, kind.children.get(step.element.tag, kind), making)
    if step.to_kind == "world" and linking.base_class is not None:
        if node.tag in NESTED:
            if node.get("childclass") is None:
                node.set("childclass", linking.base_class)
        elif node.tag in ("geom", "site", "camera", "light") and node.get("class") is None:
            node.set("class", linking.base_class)
    holder.append(node)
    making.register(node, "worldbody", step.element)
