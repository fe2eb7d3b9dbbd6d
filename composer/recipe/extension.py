"""The section `extension`: plugins."""

from __future__ import annotations

from typing import Any

from composer.dataclass import dataclass
from composer.grammar.element import ElementType
from composer.recipe.by_tag import ByTag
from composer.recipe.element import Element
from composer.recipe.element_schema import by_name, described, element, mapping
from composer.recipe.fault import Path
from composer.recipe.reader import Reader
from composer.recipe.reference import Schema, reference


@dataclass(frozen=True, slots=True)
class Extension(ByTag):
    """Form of the plugins that a model uses, and of their instances:

    `plugin: {mujoco.sdf.torus: {instance: {small: {config: {radius1: 0.3}}}}}`.

    It is read as a tuple of `Element`, one for each plugin, with its instances as children.
    """

    def schema(self) -> Schema:
        kind = self.kind.children["plugin"]
        instance = kind.children["instance"]
        instances = {"instance": described(by_name(reference(f"named:{instance.path}")), instance.doc)}
        plugins = by_name(element(kind, keyed=("plugin",), properties=instances))
        return mapping({"plugin": described(plugins, kind.doc)})

    def element(self, reader: Reader, kind: ElementType, name: str, value: Any, at: Path) -> Element | None:
        instances: list[Element] = []
        if isinstance(value, dict) and "instance" in value:
            below = (*at, "instance")
            for each, item in reader.names(value["instance"], below, f"`instance` of plugin `{name}`"):
                instance = reader.element(
                    kind.children["instance"],
                    item,
                    (*below, each),
                    f"instance `{each}`",
                    keyed={"name": each},
                )
                instances += [instance] if instance is not None else []
        owner = f"{kind.tag} `{name}`"
        keyed = {"plugin": name}
        return reader.element(
            kind, value, at, owner, keyed=keyed, own=("instance",), children=tuple(instances)
        )
