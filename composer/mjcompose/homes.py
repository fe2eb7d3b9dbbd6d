"""The modules of our own checks and verbs, by word.

Other packages register such rows as entry points. `base.extensions` imports this module by name, as it reads entry
points, so the language names no package above it. A recipe imports only the modules of the words that it has. The order
of the verbs counts: an entry of `edit` carries its verbs out in it, and `fmt` writes keys in it.
"""

from __future__ import annotations

OWN = {
    "checks": {
        "expect": "mjcompose.verify.checks.expect",
        "settles": "mjcompose.verify.checks.settles",
        "clearance": "mjcompose.verify.checks.clearance",
        "reachable": "mjcompose.verify.checks.reachable",
        "unchanged": "mjcompose.verify.checks.unchanged",
        "budget": "mjcompose.verify.checks.budget",
        "targets": "mjcompose.targets.check",
        "moves_alike": "mjcompose.targets.moves_alike",
        "lint": "mjcompose.lint.check",
    },
    "verbs": {
        "set": "mjcompose.compose.verbs.set",
        "scale": "mjcompose.compose.verbs.scale",
        "simplify": "mjcompose.compose.verbs.simplify",
        "collision": "mjcompose.compose.verbs.collision",
        "inertia": "mjcompose.compose.verbs.inertia",
        "convert": "mjcompose.compose.verbs.convert",
        "datasheet": "mjcompose.compose.verbs.datasheet",
        "move": "mjcompose.compose.verbs.move",
        "rename": "mjcompose.compose.verbs.rename",
        "remove": "mjcompose.compose.verbs.remove",
    },
}
