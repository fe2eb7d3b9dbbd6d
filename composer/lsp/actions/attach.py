"""Code action: attach the part that a name refers to and that the recipe does not have."""

from __future__ import annotations

from collections.abc import Iterator

from composer.document.node import Mapping, find
from composer.document.quote import word
from composer.lsp.actions.offer import Offer
from composer.lsp.answers import Action
from composer.lsp.writing import with_key
from composer.sources.suggest import model_files

_CODES = ("unknown-name", "attach-place", "selector")
_MOST = 3


def offer(offered: Offer) -> Iterator[Action]:
    """Yield an `attach` entry for the prefix of an unknown name. Models with a similar name come first."""
    tree, analysis = offered.tree, offered.analysis
    for diagnostic in offered.diagnostics if tree is not None else ():
        if diagnostic.code not in _CODES or tree is None:
            continue
        for subject in sorted(diagnostic.subjects):
            key, separator, _ = subject.partition(analysis.separator)
            if not separator or not key.isidentifier() or key in _parts(tree):
                continue
            for model in _models(key, offered):
                value = f"{{model: {word(model)}}}"
                change = with_key(tree, analysis.lines, analysis.file, ("attach", key), value)
                if change is not None:
                    yield Action(f"attach `{key}`: `{model}`", (change,), diagnostic)


def _parts(tree: Mapping) -> set[str]:
    attach = find(tree, ("attach",))
    return set(attach.entries) if isinstance(attach, Mapping) else set()


def _models(key: str, offered: Offer) -> list[str]:
    """Return the model files beside the recipe whose names resemble a key, or a placeholder if there are none."""
    files = [f"./{each}" for each in model_files(offered.analysis.path.parent)]
    near = [each for each in files if key.lower() in each.rpartition("/")[2].lower()]
    return near[:_MOST] or ["./MODEL.xml"]
