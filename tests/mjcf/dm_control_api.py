"""The public names of `dm_control.mjcf`, by introspection.

    python tests/mjcf/dm_control_api.py > tests/mjcf/dm_control_names.txt

Members stand behind their class (`Element.add`), parameters of functions in parentheses
(`from_path(assets)`), what is offered only by a submodule behind that (`constants.BODY`).
"""

from __future__ import annotations

import importlib
import inspect
from importlib.metadata import version
from types import ModuleType
from typing import Any

SUBMODULES = "attribute constants copier debugging namescope physics schema skin".split()


def names() -> list[str]:
    """Every public name, in order. Raises `ImportError` where dm_control is not installed."""
    package = importlib.import_module("dm_control.mjcf")
    element = importlib.import_module("dm_control.mjcf.element")
    found: set[str] = set()
    classes = {name: value for name, value in _public(package) if inspect.isclass(value)}
    classes["Element"] = element._AttachableElement
    classes["ElementList"] = element._ElementListView
    classes["namescope.NameScope"] = importlib.import_module("dm_control.mjcf.namescope").NameScope
    classes["physics.Binding"] = importlib.import_module("dm_control.mjcf.physics").Binding
    for name, value in _public(package):
        if isinstance(value, ModuleType):
            continue
        found.add(name)
        if inspect.isfunction(value):
            found |= {f"{name}({each})" for each in _parameters(value)}
    found |= {f"{owner}({each})" for owner in ("Asset", "RootElement") for each in _parameters(classes[owner])}
    for owner, value in classes.items():
        inherited = {each for each, _ in _public(classes["Element"])} if owner == "RootElement" else set()
        for name, member in _public(value):
            if name not in inherited or name == "attach":
                found.add(f"{owner}.{name}")
                found |= {f"{owner}.{name}({each})" for each in _parameters(member)}
    for submodule in SUBMODULES:
        module = importlib.import_module(f"dm_control.mjcf.{submodule}")
        for name, value in _public(module):
            own = getattr(value, "__module__", module.__name__) == module.__name__
            if not own or isinstance(value, ModuleType) or hasattr(package, name):
                continue
            found.add(f"{submodule}.{name}")
    return sorted(found)


def installed() -> str:
    """The version of dm_control. Raises `PackageNotFoundError` where there is none."""
    return version("dm_control")


def _parameters(value: Any) -> list[str]:
    if not inspect.isroutine(value) and (not inspect.isclass(value) or value.__init__ is object.__init__):
        return []
    kinds = inspect.Parameter
    return [
        name
        for name, each in inspect.signature(value).parameters.items()
        if name != "self" and each.kind not in (kinds.VAR_KEYWORD, kinds.VAR_POSITIONAL)
    ]


def _public(owner: Any) -> list[tuple[str, Any]]:
    return [(name, getattr(owner, name, None)) for name in dir(owner) if not name.startswith("_")]


if __name__ == "__main__":
    print("\n".join([f"# dm_control {installed()}", *names()]))  # noqa: T201
