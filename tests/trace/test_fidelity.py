"""Every origin of every attribute of every element is true: of golden and shipped recipes, and of the corpus."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from fidelity import corpus as corpora
from fidelity.corpus import Composition
from fidelity.recipe import write_recipe
from mjcompose.sources.context import Context
from mjcompose.trace.traced import Traced, trace

from tests.trace.proof import Proof

FOLDER = os.environ.get("MJCOMPOSE_CORPUS")


def _compositions() -> list[Composition]:
    """All feature cases, the pairs, and a few robots two by two."""
    if not FOLDER:
        return []
    corpus = Path(FOLDER)
    found = [*corpora.cases(corpus), *corpora.pairs(corpus), *list(corpora.robots(corpus, 22))[::67]]
    return [each for each in found if not each.refused]


def test_every_origin_is_true(recipe: Path, traced: Traced) -> None:
    proof = Proof(traced, recipe.parent)
    assert list(proof.faults()) == []
    # Rows of keys are more than attributes, and what a class gives is asked for once more.
    assert sum(proof.seen.values()) >= sum(len(node.keys()) for node in traced.model.root.iter("*"))


@pytest.mark.slow
@pytest.mark.skipif(not FOLDER, reason="MJCOMPOSE_CORPUS names no corpus")
@pytest.mark.parametrize("composition", _compositions(), ids=lambda each: each.id)
def test_every_origin_is_true_in_the_corpus(composition: Composition, tmp_path: Path) -> None:
    recipe = write_recipe(composition, tmp_path)
    context = Context(environment={}, folder=tmp_path)
    traced = trace(Path(recipe.name), context)
    if traced is None:
        pytest.skip(f"not composed: {context.sink.errors[0].message}")
    assert list(Proof(traced, tmp_path).faults()) == []
