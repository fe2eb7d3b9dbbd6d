"""Models that MJX or MuJoCo Warp refuses, each with what is reported of it: by builds, and of worlds."""

from __future__ import annotations

from typing import Any

import pytest

BODY = """<mujoco model="m"><option {option}>{flags}</option>
  <worldbody><body name="b" {body}><joint name="j" {joint}/><geom name="g" size=".1" {geom}/><site name="s"/></body>
  <body name="c"><geom name="h" type="mesh" mesh="m"/></body></worldbody>
  <asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>
  {more}</mujoco>"""


def model(**given: str) -> str:
    keys = ("option", "flags", "body", "joint", "geom", "more")
    return BODY.format(**{key: given.get(key, "") for key in keys})


BODY_SENSOR = '<sensor><contact body1="b" num="1"/></sensor>'
NETFORCE = '<sensor><contact geom1="g" geom2="h" num="1" reduce="netforce"/></sensor>'

MANY = "<worldbody>" + '<body><freejoint/><geom size=".1"/></body>' * 10 + "</worldbody>"
CLOTH = (
    '<worldbody><flexcomp name="cloth" type="grid" dim="2" count="3 3 1" spacing=".1 .1 .1" radius=".01" mass="1"><edge/>'
    "</flexcomp></worldbody>"
)
ELASTIC = CLOTH.replace("<edge/>", '<elasticity young="1e4" poisson=".1" thickness=".01" elastic2d="both"/>')
CARRIED = ELASTIC.replace("<flexcomp", "<body name='carrier'><freejoint/><geom size='.01'/><flexcomp").replace(
    "</flexcomp>", '<pin id="0"/></flexcomp></body>'
)

PLUGIN = (
    '<extension><plugin plugin="mujoco.pid"><instance name="i"><config key="kp" value="1"/></instance></plugin>'
    '</extension><actuator><plugin name="p" joint="j" plugin="mujoco.pid" instance="i" actdim="0"/></actuator>'
)

CASES: list[tuple[str, dict[str, str], str]] = [
    ("mjx", {"option": 'integrator="implicit"'}, "option: MJX has no integrator `implicit`"),
    ("mjx", {"option": 'solver="PGS"'}, "option: MJX has no solver `pgs`"),
    ("mjx", {"flags": '<flag energy="enable"/>'}, "option: MJX does not have the flag `energy`"),
    ("mjx", {"geom": 'margin=".01"'}, "geom `g`: MJX has no margin for contacts with meshes and height fields"),
    ("mjx", {"more": '<actuator><adhesion name="a" body="b" ctrlrange="0 1"/></actuator>'},
     "general `a`: MJX has no such transmission"),
    ("mjx", {"more": '<sensor><jointlimitpos name="l" joint="j"/></sensor>', "joint": 'range="-1 1"'},
     "jointlimitpos `l`: MJX has no such sensor"),
    ("mjx", {"more": BODY_SENSOR}, "contact: MJX has no contact sensor of a body"),
    ("mjx", {"more": BODY_SENSOR.replace('body1="b"', 'site="s"')}, "contact: MJX has no contact sensor of a site"),
    ("mjx", {"more": '<contact><pair name="p" geom1="g" geom2="h" margin=".1"/></contact>'},
     "pair `p`: MJX has no margin for contacts with meshes and height fields"),
    ("mjx", {"more": NETFORCE}, "contact: MJX has no contact sensor of the net force"),
    ("warp", {"option": 'solver="PGS"'}, "option: MuJoCo Warp has no solver `pgs`"),
    ("mjx", {"option": 'integrator="implicitfast" viscosity="1"'},
     "option: MJX has no integrator `implicitfast` in a medium: with `density`, `viscosity` or `wind`"),
    ("warp", {"body": 'sleep="init"', "joint": 'type="free"'},
     "body `b`: MuJoCo Warp does not have `sleep` of a body"),
    ("warp", {"body": 'sleep="allowed"', "joint": 'type="free"'},
     "body `b`: MuJoCo Warp does not have `sleep` of a body"),
    ("warp", {"option": 'solver="CG"', "flags": '<flag sleep="enable"/>'},
     "option: MuJoCo Warp has the flag `sleep` only with the solver `Newton`"),
    ("warp", {"option": 'jacobian="dense"', "more": MANY},
     "option: MuJoCo Warp has no `jacobian` `dense` for more than 60 degrees of freedom"),
    ("warp", {"more": PLUGIN}, "plugin `p`: a plugin computes this actuator"),
    ("warp", {"flags": '<flag fwdinv="enable"/>'}, "option: MuJoCo Warp does not have the flag `fwdinv`"),
    ("mjx", {"geom": 'type="cylinder" fromto="0 0 0 0 0 .1"'}, "geom `g`: MJX cannot compute contacts of a cylinder with a mesh"),
]  # fmt: skip
"""Target, what stands in the model, and the message."""

OF_MUJOCO_4: list[tuple[str, dict[str, str], str]] = [
    ("warp", {"option": 'integrator="discrete" noslip_iterations="3"'},
     "option: MuJoCo Warp has no `noslip_iterations` with the integrator `discrete`"),
    ("warp", {"geom": 'type="sdf" mesh="m"', "more": CLOTH}, "geom `g`: MuJoCo Warp has no `sdf` in a model with flexes"),
    ("warp", {"more": CLOTH + '<sensor><contact name="k" geom1="g" data="linvel"/></sensor>'},
     "contact `k`: MuJoCo Warp has no `linvel` and `angvel` of contacts in a model with flexes"),
    ("warp", {"flags": '<flag sleep="enable"/>', "more": CLOTH.replace("<edge/>", '<edge equality="true"/>')},
     "option: MuJoCo Warp has no flag `sleep` with equality constraints of flexes"),
    ("warp", {"option": 'integrator="discrete"', "more": CARRIED},
     "flex `cloth`: MuJoCo Warp has no elastic flex on moving bodies with `discrete` and the solver `Newton`"),
    ("warp", {"more": CLOTH.replace("<edge/>", '<contact selfcollide="narrow"/>').replace("3 3 1", "3 3 3")
              .replace('dim="2"', 'dim="3" dof="trilinear"')},
     "flex `cloth`: MuJoCo Warp has no contacts of an interpolated flex with itself: `selfcollide`"),
]  # fmt: skip
"""The same for what MuJoCo 3 does not compile, or MuJoCo Warp took before."""


def of(target: str) -> list[Any]:
    """The rest of each case of a target, for `pytest.mark.parametrize`."""
    return [pytest.param(*each.values[1:], marks=each.marks) for each in ALL if each.values[0] == target]


_NEW = pytest.mark.mujoco4("it does not compile this, or MuJoCo Warp took it")
ALL = [pytest.param(*each) for each in CASES] + [pytest.param(*each, marks=_NEW) for each in OF_MUJOCO_4]
