"""The modules with the effects of our own checks and verbs, by word. The language has their forms.

Other packages register such rows as entry points. Some checks are in packages above `verify`, which runs
them by this table. A recipe imports only the modules of the words that it has.
"""

from __future__ import annotations

CHECKS = {
    "expect": "mjcompose.verify.checks.expect",
    "settles": "mjcompose.verify.checks.settles",
    "clearance": "mjcompose.verify.checks.clearance",
    "reachable": "mjcompose.verify.checks.reachable",
    "unchanged": "mjcompose.verify.checks.unchanged",
    "budget": "mjcompose.verify.checks.budget",
    "targets": "mjcompose.targets.check",
    "moves_alike": "mjcompose.targets.moves_alike",
    "tracks": "mjcompose.tools.identify.check",
    "lint": "mjcompose.lint.check",
}
VERBS = {
    "set": "mjcompose.compose.verbs.set",
    "scale": "mjcompose.compose.verbs.scale",
    "simplify": "mjcompose.compose.verbs.simplify",
    "collision": "mjcompose.compose.verbs.collision",
    "inertia": "mjcompose.compose.verbs.inertia",
    "convert": "mjcompose.compose.verbs.convert",
    "datasheet": "mjcompose.compose.verbs.datasheet",
    "calibrate": "mjcompose.compose.verbs.calibrate",
    "move": "mjcompose.compose.verbs.move",
    "rename": "mjcompose.compose.verbs.rename",
    "remove": "mjcompose.compose.verbs.remove",
}
