"""Steps: write the recipe's own entries for the sections of MJCF."""

from __future__ import annotations

from lxml import etree

from composer.compose.elements import ElementBuilder, default_kind, make, update
from composer.diagnostics.diagnostic import Note
from composer.grammar import GRAMMAR
from composer.grammar.element import ElementType
from composer.link.linking import Linking
from composer.plan.steps.append_element import AppendElement
from composer.plan.steps.set_default import SetDefault
from composer.plan.steps.set_singleton import SetSingleton
from composer.tree.classes import MAIN
from composer.tree.references import unresolved


def set_singleton(step: SetSingleton, linking: Linking, making: ElementBuilder) -> None:
    """Write `option`, `visual` and the like. The recipe is written last, so its values win."""
    node = linking.base.section(step.section)
    update(node, step.element, GRAMMAR.section(step.section), making=making)


def set_default(step: SetDefault, linking: Linking, making: ElementBuilder) -> None:
    """Write the settings of a class, and create the class if needed. `main` is the base's own top class."""
    name = (linking.base_class or MAIN) if step.name == MAIN else step.name
    found = linking.names.find("default", name)
    if found is None and name in (MAIN, linking.base_class):
        found = linking.base.section("default") if name == MAIN else _class_node(linking, name)
    if found is None:
        parent = _parent(step, linking, making)
        found = etree.Element("default", {"class": name})
        if parent is not None:  # else that was reported, and the class counts as declared all the same
            parent.append(found)
        linking.names.declared.setdefault("default", {})[name] = found
        making.origins.own(found, step.span)
    elif step.parent is not None:
        making.sink.error(
            "class-clash",
            f"the default class `{step.name}` exists already, and `parent` is for a new one",
            making.span(step.element, "parent"),
            notes=(Note(f"`{step.name}` is declared here", linking.span(linking.base, found)),),
            help="leave `parent` out to change the class, or choose another name",
            subjects=(step.name,),
        )
        return
    for child in step.element.children:
        kind = default_kind(child.tag)
        existing = next(found.iterchildren(child.tag), None)
        if existing is None:
            # A class's own settings come before the classes nested in it.
            node = make(child, kind, making)
            found.insert(len(found) - len(list(found.iterchildren("default"))), node)
            making.register(node, "default")
        else:
            update(existing, child, kind, making=making)
            making.made[existing] = child
            making.registered.append((existing, "default"))


def _parent(step: SetDefault, linking: Linking, making: ElementBuilder) -> etree._Element | None:
    if step.parent is None or step.parent == MAIN:
        return (
            _class_node(linking, linking.base_class)
            if linking.base_class
            else linking.base.section("default")
        )
    found = linking.names.find("default", step.parent)
    if found is None:
        span = making.span(step.element, "parent")
        making.sink.add(unresolved(linking, "default", step.parent, span=span, written="parent: {}"))
    return found


def _class_node(linking: Linking, name: str) -> etree._Element:
    return next(node for node in linking.base.root.iter("default") if node.get("class") == name)


def append(step: AppendElement, linking: Linking, making: ElementBuilder) -> None:
    """Append an element to a section that holds several."""
    section = linking.base.section(step.section)
    kind = GRAMMAR.section(step.section)
    child = kind.children[step.element.tag]
    node = make(step.element, child, making)
    if step.section == "extension":
        # All instances of a plugin are in one element, whichever part declares them.
        existing = next((plugin for plugin in section if plugin.get("plugin") == node.get("plugin")), None)
        if existing is not None:
            existing.extend(list(node))
            for instance in existing:
                if instance in making.made:
                    making.register(instance, step.section)
            return
    if linking.base_class is not None and node.get("class") is None and _has_class(child, linking):
        node.set("class", linking.base_class)
    section.append(node)
    making.register(node, step.section)


def _has_class(kind: ElementType, linking: Linking) -> bool:
    """Return whether an element of a section must name the top class of the base."""
    attribute = kind.attributes.get("class")
    if attribute is None or attribute.since is None:
        return attribute is not None
    # `<texture class="c"/>` is an error before MuJoCo 3.17, in which classes have no settings for textures either.
    top = _class_node(linking, str(linking.base_class))
    return kind.tag in linking.request.isolated_tags or next(top.iterchildren(kind.tag), None) is not None
