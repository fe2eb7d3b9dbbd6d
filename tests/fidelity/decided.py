"""Compositions where mjcompose differs from MuJoCo's attach on purpose, and those it does not make yet."""

from __future__ import annotations

UNLIKE_MJSPEC = {
    "34-flexcomp": "attach leaves pinned vertices behind when a cloth is moved; ours move with it",
    "44-settotalmass-child": "attach drops the part's total mass; ours are the masses of the part alone",
    "47-fitaabb": "attach fits the part's primitives by the base's rule; ours keep the part's",
    "48-fusestatic-child": "attach drops the part's fusestatic; ours are the bodies of the part alone",
    "68-chain": "attach reads the third part's angles wrong; ours are right by the part alone",
    "70-equality-keys-unnamed": "attach gives an unnamed key the prefix as its name; ours stay unnamed",
    "dev-scene+pulley": "attach gives an unnamed key the prefix as its name; ours stay unnamed",
    "84-urdf-child": "attach leaves the fixed links of the URDF unfused; ours are fused as they are alone",
    "dev-scene+stretchURDF": "attach leaves the fixed links of the URDF unfused; ours are fused as they are alone",
    "dev-halfcheetah+d435i": "attach scales the camera by the base's total mass; ours keeps its own",
}
"""Why the two differ; in each the parts of ours are what they are alone."""

NOT_YET: dict[str, str] = {}
"""What has to be refused with a diagnostic until it works."""

OTHERWISE = {
    "22-sensors-every-reference": ("sensor/c_fl/ref",)  # the world of a part that hangs on a body is that body
}
"""Facts of feature cases that mjcompose has decided otherwise than the corpus, by path."""
