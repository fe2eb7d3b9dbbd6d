"""A small model that declares one name in every namespace, and a place in it for any element of the grammar.

Loaded by path from the tests beside it, as test folders are no packages.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from xml.sax.saxutils import quoteattr

from mjcompose.tree.grammar import GRAMMAR, Attribute, ElementType

BASE = """
<mujoco>
  {compiler}{option}{size}{statistic}{visual}
  <default><default class="{{default}}"/>{default}</default>
  <extension>
    <plugin plugin="mujoco.pid"><instance name="{{instance}}"><config key="kp" value="1"/></instance></plugin>
    <plugin plugin="mujoco.sensor.touch_grid"/>
    {extension}
  </extension>
  <asset>
    <mesh name="{{mesh}}" builtin="wedge" params="8 4 30 10 0"/>
    <hfield name="{{hfield}}" nrow="2" ncol="2" size="1 1 1 1"/>
    <texture name="{{texture}}" type="2d" builtin="flat" width="4" height="4"/>
    <material name="{{material}}"/>
    {asset}
  </asset>
  <worldbody>
    <body name="{{body}}">
      <frame name="{{frame}}"/>
      <joint name="{{joint}}" type="slide" range="-1 1"/>
      <geom name="{{geom}}" size="0.1" friction="0.5"/>
      <site name="{{site}}"/>
      <camera name="{{camera}}"/>
      <light name="{{light}}"/>
      {body}
    </body>
    <body name="other" pos="0 0 3">
      <joint name="other"/>
      <geom name="other" size="0.1"/>
      <site name="other" pos="0.1 0 0"/>
    </body>
    <body name="cloth" pos="0 0 9">
      <flexcomp name="{{flex}}" type="grid" dim="2" count="3 3 1" spacing="0.1 0.1 0.1" radius="0.01"/>
    </body>
    {worldbody}
  </worldbody>
  <deformable>
    <skin name="{{skin}}" vertex="0 0 0 1 0 0 0 1 0" face="0 1 2">
      <bone body="{{body}}" bindpos="0 0 0" bindquat="1 0 0 0" vertid="0 1 2" vertweight="1 1 1"/>
    </skin>
    {deformable}
  </deformable>
  <contact>
    <pair name="{{pair}}" geom1="{{geom}}" geom2="other"/>
    <exclude name="{{exclude}}" body1="{{body}}" body2="other"/>
    {contact}
  </contact>
  <tendon>
    <fixed name="second"><joint joint="other" coef="1"/></fixed>
    <fixed name="{{tendon}}" range="-1 1"><joint joint="{{joint}}" coef="1"/></fixed>
    {tendon}
  </tendon>
  <equality><joint name="{{equality}}" joint1="{{joint}}" joint2="other"/>{equality}</equality>
  <actuator>
    <motor name="{{actuator}}" joint="{{joint}}"/>
    <plugin joint="{{joint}}" plugin="mujoco.pid" instance="{{instance}}"/>
    {actuator}
  </actuator>
  <sensor><jointpos name="{{sensor}}" joint="{{joint}}"/>{sensor}</sensor>
  <custom>
    <numeric name="{{numeric}}" data="1"/>
    <text name="{{text}}" data="x"/>
    <tuple name="{{tuple}}"><element objtype="body" objname="{{body}}"/></tuple>
    {custom}
  </custom>
  <keyframe><key name="{{key}}"/>{keyframe}</keyframe>
</mujoco>
"""

SLOTS = (
    "compiler option size statistic visual default extension asset body worldbody deformable contact tendon"
    " equality actuator sensor custom keyframe"
).split()

NAMES = {namespace: f"the_{namespace}" for namespace in GRAMMAR.namespaces}

Attributes = dict[str, str]


@dataclass(frozen=True)
class Place:
    """Where an element goes: a slot of the base, what stands around it (`@`), what it needs to be legal."""

    slot: str
    around: str = "@"
    attributes: Attributes = field(default_factory=dict)
    inside: str = ""
    also: Attributes = field(default_factory=dict)
    """What else the base must have, by slot."""


FLEX = '<flexcomp name="x" type="grid" dim="2" count="3 3 1" spacing="0.1 0.1 0.1" radius="0.01">@</flexcomp>'
RAW_FLEX = {"dim": "2", "body": "{body}", "element": "0 1 2", "vertex": "0 0 0 1 0 0 0 1 0"}
GRID = '<config key="size" value="7 7"/><config key="fov" value="9 9"/><config key="nchannel" value="1"/>'
GAMMA = '<config key="gamma" value="0"/>'

BALL = {"worldbody": '<body><joint name="ball" type="ball"/><geom size="0.1"/></body>'}
BLOCK = {
    "worldbody": '<body name="solid"><flexcomp name="block" type="grid" dim="3" count="3 3 3" dof="trilinear"'
    ' spacing="0.1 0.1 0.1" radius="0.01"/></body>'
}

PLACES: dict[str, Place] = {
    "compiler": Place("compiler"),
    "compiler/lengthrange": Place("compiler", "<compiler>@</compiler>"),
    "option": Place("option"),
    "option/flag": Place("option", "<option>@</option>"),
    "size": Place("size"),
    "statistic": Place("statistic"),
    "default": Place("default", "@", {"class": "another"}),
    "extension/plugin": Place("extension", "@", {"plugin": "mujoco.sdf.torus"}),
    "plugin/instance": Place("extension", '<plugin plugin="mujoco.sdf.torus">@</plugin>', {"name": "more"}),
    "plugin/config": Place(
        "extension",
        '<plugin plugin="mujoco.sdf.torus"><instance name="more">@</instance></plugin>',
        {"key": "radius1", "value": "0.4"},
    ),
    "mesh": Place(
        "asset",
        "@",
        {"name": "m", "vertex": "0 0 0 1 0 0 0 1 0 0 0 1"},
        also={"worldbody": '<geom type="mesh" mesh="m"/>'},  # what a mesh says is read where it is used
    ),
    "hfield": Place("asset", "@", {"name": "h", "nrow": "3", "ncol": "3"}),
    "skin": Place(
        "asset",
        "@",
        {"vertex": "0 0 0 1 0 0 0 1 0", "face": "0 1 2"},
        '<bone body="{body}" bindpos="0 0 0" bindquat="1 0 0 0" vertid="0 1 2" vertweight="1 1 1"/>',
    ),
    "skin/bone": Place(
        "asset",
        '<skin name="s" vertex="0 0 0 1 0 0 0 1 0" face="0 1 2">@</skin>',
        {"bindpos": "0 0 0", "bindquat": "1 0 0 0", "vertid": "0 1 2", "vertweight": "1 1 1"},
    ),
    "texture": Place("asset", "@", {"name": "t", "builtin": "flat", "width": "4", "height": "24"}),
    "material": Place("asset", "@", {"name": "ma"}),
    "material/layer": Place("asset", '<material name="ma">@</material>', {"texture": "{texture}"}),
    "body": Place("worldbody", inside='<geom size="0.1"/>'),
    "inertial": Place("worldbody", "<body><joint/>@</body>", {"pos": "0.1 0 0", "mass": "1", "diaginertia": "1 1 1"}),
    "joint": Place("worldbody", '<body>@<geom size="0.1" pos="0 0 1"/></body>'),
    "freejoint": Place("worldbody", '<body>@<geom size="0.1"/></body>'),
    "geom": Place("body", "@", {"size": "0.1 0.2 0.3", "type": "box", "pos": "1 0 0"}),
    "site": Place("body", "@", {"type": "box", "pos": "1 0 0"}),
    "camera": Place("body"),
    "light": Place("body"),
    "frame": Place("worldbody", inside='<body><joint/><geom size="0.1"/></body>'),
    "replicate": Place("worldbody", "@", {"count": "2"}, '<body><joint/><geom size="0.1"/></body>'),
    "flexcomp": Place(
        "worldbody",
        '<body name="sheet">@</body>',
        {"name": "x", "type": "grid", "dim": "2", "count": "3 3 1", "radius": "0.001"},
    ),
    "flexcomp/edge": Place("worldbody", f'<body name="sheet">{FLEX}</body>', {"equality": "true"}),
    "flexcomp/pin": Place("worldbody", f'<body name="sheet">{FLEX}</body>', {"id": "0"}),
    "flex/elasticity": Place("worldbody", f'<body name="sheet">{FLEX}</body>', {"young": "10"}),
    "flex/contact": Place("worldbody", f'<body name="sheet">{FLEX}</body>'),
    "flex": Place("deformable", "@", RAW_FLEX),
    "flex/edge": Place("deformable", '<flex body="{body}" element="0 1 2" vertex="0 0 0 1 0 0 0 1 0">@</flex>'),
    "contact/pair": Place("contact", "@", {"geom1": "{geom}", "geom2": "other"}),
    "contact/exclude": Place("contact", "@", {"body1": "other"}),
    "tendon/spatial": Place("tendon", inside='<site site="{site}"/><site site="other"/>'),
    "tendon/fixed": Place("tendon", inside='<joint joint="{joint}" coef="2"/>'),
    "spatial/site": Place("tendon", '<spatial>@<site site="other"/></spatial>'),
    "spatial/geom": Place("tendon", '<spatial><site site="{site}"/>@<site site="other"/></spatial>'),
    "spatial/pulley": Place(
        "tendon",
        '<spatial><site site="{site}"/><site site="other"/>@<site site="{site}"/><site site="other"/></spatial>',
        {"divisor": "2"},
    ),
    "fixed/joint": Place("tendon", "<fixed>@</fixed>", {"coef": "1"}),
    "equality/connect": Place("equality", "@", {"body1": "other", "anchor": "0.5 0 0"}),
    "equality/weld": Place("equality", "@", {"body1": "other"}),
    "equality/joint": Place("equality", "@"),
    "equality/tendon": Place("equality"),
    "equality/flex": Place("equality"),
    "equality/flexstrain": Place("equality", "@", {"flex": "block", "cell": "0 0 0"}, also=BLOCK),
    "actuator/orientation": Place("actuator", "@", {"site": "{site}", "refsite": "other"}),
    "actuator/adhesion": Place("actuator", "@", {"body": "{body}", "ctrlrange": "0 1"}),
    "actuator/muscle": Place("actuator", "@", {"tendon": "{tendon}", "lengthrange": "0 1"}),
    "actuator/dcmotor": Place("actuator", "@", {"joint": "{joint}", "motorconst": "1", "resistance": "1"}),
    "actuator/damper": Place("actuator", "@", {"joint": "{joint}", "ctrlrange": "0 1"}),
    "actuator/plugin": Place("actuator", "@", {"joint": "{joint}", "plugin": "mujoco.pid", "instance": "{instance}"}),
    "sensor/rangefinder": Place("sensor", "@", {"site": "{site}"}),
    "sensor/distance": Place("sensor", "@", {"geom1": "{geom}", "geom2": "other"}),
    "sensor/normal": Place("sensor", "@", {"geom1": "{geom}", "geom2": "other"}),
    "sensor/fromto": Place("sensor", "@", {"geom1": "{geom}", "geom2": "other"}),
    "sensor/ballquat": Place("sensor", "@", {"joint": "ball"}, also=BALL),
    "sensor/ballangvel": Place("sensor", "@", {"joint": "ball"}, also=BALL),
    "sensor/user": Place("sensor", "@", {"dim": "1"}),
    "sensor/plugin": Place(
        "sensor", "@", {"plugin": "mujoco.sensor.touch_grid", "objtype": "site", "objname": "{site}"}, GRID + GAMMA
    ),
    "custom/numeric": Place("custom", "@", {"size": "3"}),
    "custom/text": Place("custom", "@", {"name": "te", "data": "x"}),
    "custom/tuple": Place("custom", inside='<element objtype="body" objname="{body}"/>'),
    "tuple/element": Place("custom", '<tuple name="tu">@</tuple>', {"objtype": "body", "objname": "{body}"}),
    "keyframe/key": Place("keyframe"),
}
for _path in GRAMMAR.paths:
    if _path.startswith("actuator/"):
        PLACES.setdefault(_path, Place("actuator", "@", {"joint": "{joint}"}))
    elif _path.startswith("sensor/"):
        PLACES.setdefault(_path, Place("sensor"))
    elif _path.startswith("visual/"):
        PLACES[_path] = Place("visual", "<visual>@</visual>")
    elif _path.startswith("default/"):
        PLACES[_path] = Place("default", '<default class="another">@</default>')
PLACES["default/dcmotor"] = Place(
    "default", '<default class="another">@</default>', {"motorconst": "1", "resistance": "1"}
)

LEFT_OUT = {
    "mujoco": "the base itself",
    "worldbody": "takes no attributes",
    "visual": "takes no attributes",
    "attach": "needs a second file",
    "model": "needs a second file",
    "plugin": "MuJoCo ships no plugin that needs no mesh",
    "include": "needs a second file",
}


def needed(element: ElementType) -> Attributes:
    """Attributes without which the element is not legal, by what its place says and what the grammar says."""
    attributes = dict(PLACES[element.path].attributes)
    for attribute in element.attributes.values():
        if attribute.required and attribute.name not in attributes:
            attributes[attribute.name] = some_value(attribute, attributes)
    return attributes


def some_value(attribute: Attribute, others: Attributes) -> str:
    """Any legal text for an attribute; names are those of the base."""
    if attribute.is_reference:
        if attribute.refers_by is not None:
            return "{" + GRAMMAR.objtypes[others[attribute.refers_by]] + "}"
        return "{" + str(attribute.refers) + "}"
    if attribute.keywords:
        return attribute.keywords[0]
    if attribute.is_number:
        return " ".join(["1"] * (attribute.min_length or 1))
    return {"name": f"new_{attribute.declares}", "bool": "true"}.get(attribute.type, "x")


def write(element: ElementType, attributes: Attributes) -> str:
    """The element as XML, inside what its place puts around it."""
    place = PLACES[element.path]
    written = "".join(f" {name}={quoteattr(text)}" for name, text in attributes.items())
    return place.around.replace("@", f"<{element.tag}{written}>{place.inside}</{element.tag}>")


def model(
    element: ElementType | None = None,
    attributes: Attributes | None = None,
    names: dict[str, str] | None = None,
    extra: str = "",
) -> str:
    """The base, with one element more. `{namespace}` in attributes is replaced by the name declared there."""
    slots = dict.fromkeys(SLOTS, "")
    slots["compiler"] = extra
    if element is not None:
        written = needed(element) if attributes is None else attributes
        slots[PLACES[element.path].slot] += write(element, written)
        for slot, text in PLACES[element.path].also.items():
            slots[slot] += text
    return BASE.format(**slots).format(**(names or NAMES))
