"""What MuJoCo says of a model alone and of what is composed of it: neither may compile without the other."""

from __future__ import annotations

from pathlib import Path

from fuzz.target import Tools, without_a_place
from mjcompose.mujoco import engine
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

# Where mjcompose is stricter than MuJoCo, on purpose: docs/contributing/security_tests.md says why.
STRICTER = frozenset(
    {
        "unknown-element",
        "name-clash",
        "class-clash",
        "xml-syntax",
        "xml-include",
        "not-supported",
        "not-mjcf",
        "asset-missing",
        "file-unreadable",
        "bad-name",
        "unknown-name",
        "not-urdf",
        "limit-exceeded",
        "xacro",
    }
)


_UNSEEN = frozenset({"unknown-attribute", "wrong-length"})
"""The same, inside `<frame>` and `<replicate>`, where MuJoCo's reader does not look."""


def _stricter(path: Path) -> frozenset[str]:
    text = path.read_bytes()
    return STRICTER | _UNSEEN if b"<frame" in text or b"<replicate" in text else STRICTER


def differs(path: Path, tools: Tools, recipes: dict[str, str]) -> str | None:
    """What is wrong with the models of these recipes, by name, that are made of the one at `path`.

    That a part is refused which is fine alone may have a reason that lies in the composition, which a base has not.
    """
    source = engine.compile(path.parent, path.name, session=tools.session)
    for name, text in recipes.items():
        recipe = path.with_name(f"{name}.yaml")
        recipe.write_text(text, encoding="utf-8")
        context = Context(environment={}, folder=path.parent)
        built = build(ModelRequest(recipe), context, session=tools.session)
        if unlocated := without_a_place(context):
            return f"{unlocated}-{name}"
        if source.crash is not None or any(each.code == "mujoco-timeout" for each in context.sink.errors):
            continue
        if built is not None and source.error is not None:
            return f"only-result-compiles-{name}: {' '.join(source.error.split())}"
        if source.forward is not None:  # it compiles, and its first step fails
            continue
        codes = {each.code for each in context.sink.errors}
        if built is None and source.ok and name == "base" and not codes & _stricter(path):
            return f"only-source-compiles-{'-'.join(sorted(codes))}: {context.sink.errors[0].message}"
    return None
