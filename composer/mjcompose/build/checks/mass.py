"""The check `mass`: the mass of the model, a body or a subtree."""

from __future__ import annotations

from typing import Any

from mjcompose.base.diagnostic import Fault
from mjcompose.build.checks.check import Scope, failed


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Report a mass that is not the expected one."""
    model = scope.model
    word = "subtree" if asked["subtree"] else "body" if asked["body"] else None
    if word is None:
        mass = float(sum(model.body_mass[index] for index in scope.own("body")))
        what = "the model" if scope.whole else "this recipe's model"
    else:
        index = scope.find("body", asked[word], word)
        if isinstance(index, Fault):
            return [index]
        mass = float((model.body_subtreemass if word == "subtree" else model.body_mass)[index])
        what = f"`{asked[word]}`" if word == "body" else f"`{asked[word]}` with all below it"
    scope.found("mass", mass)
    at = "range" if asked["value"] is None else "value"
    if asked["low"] <= mass <= asked["high"]:
        return []
    if asked["value"] is None:
        expected = f"{asked['low']:.9g} to {asked['high']:.9g} kg"
    else:
        expected = f"{asked['value']:.9g} kg" + ("" if asked["tol"] is None else f" ± {asked['tol']:g} kg")
    return [failed(f"the mass of {what} is {mass:.9g} kg", expected, f"{mass:.9g} kg", at)]
