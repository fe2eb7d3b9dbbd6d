"""For each change of the table a small model that it is about: what becomes of it, in text and compiled."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Feature:
    """`model` is for `before`, and goes to `after`. `written` is in the result, `gone` is not. `warns` and `refuses` say
    what is reported. With `shows` the compiled model is another one without the change.
    """

    change: str
    before: str
    model: str
    after: str = "4.0.0"
    written: tuple[str, ...] = ()
    gone: tuple[str, ...] = ()
    warns: bool = False
    refuses: bool = False
    says: str = ""
    shows: bool = True

    @property
    def name(self) -> str:
        return f"{self.change}-{self.before}-{self.after}"


BALL = '<worldbody><body><freejoint/><geom size=".1"/></body></worldbody>'
HINGE = '<worldbody><body><joint name="j" axis="0 1 0"/><geom size=".1" pos=".3 0 0"/></body></worldbody>'
TWO = """<body><joint axis="0 1 0"/><geom size=".1" pos=".3 0 0"/>
      <body pos=".6 0 0"><joint name="k" axis="0 1 0"/><geom size=".1" pos=".3 0 0"/></body></body>"""
MESH = 'vertex="0 0 0 1 0 0 0 1 0 0 0 1 .6 .7 .8"'
HOLLOW = 'vertex="0 0 0 1 0 0 0 1 0 0 0 1 .2 .2 .2" face="0 2 1 0 1 3 0 3 2 1 2 4 2 3 4 3 1 4"'
FLEX = """<flexcomp name="f" type="grid" dim="{dim}" count="{count}" spacing=".1 .1 .1" radius=".01" mass="1">
        {inside}</flexcomp>"""


def flex(inside: str, dim: int = 2, count: str = "3 3 1", more: str = "") -> str:
    body = FLEX.format(dim=dim, count=count, inside=inside)
    return f'<mujoco>{more}<worldbody><body name="b">{body}</body></worldbody></mujoco>'


def option(text: str, rest: str = BALL) -> str:
    return f"<mujoco>\n  {text}\n  {rest}\n</mujoco>"


FEATURES = (
    Feature("mesh-volume", "3.0.0", f"""<mujoco><asset><mesh name="m" {MESH}/></asset><worldbody>
      <body><freejoint/><geom type="mesh" mesh="m"/></body></worldbody></mujoco>""", warns=True, shows=False),
    Feature("flexcomp-class", "3.0.0", """<mujoco><default><default class="c"/></default><worldbody><body name="b">
      <flexcomp name="f" class="c" type="grid" dim="1" count="3 1 1" spacing=".1 .1 .1" radius=".01" mass="1"/>
      </body></worldbody></mujoco>""", gone=("class=\"c\" type",), shows=False),
    Feature("sensor-noise", "3.1.3", option('<option><flag sensornoise="enable"/></option>'), gone=("sensornoise",),
            warns=True, shows=False),
    Feature("camera-color", "3.1.6", f"<mujoco>{BALL}</mujoco>", written=('camera="0.6 0.9 0.6 0.3"',)),
    Feature("camera-color", "4.0.0", f"<mujoco>{BALL}</mujoco>", "3.1.6", written=('camera="0.6 0.9 0.6 1"',)),
    Feature("ccd-names", "3.2.2", option('<option mpr_iterations="17" mpr_tolerance="1e-5"/>'),
            written=('<option ccd_iterations="17" ccd_tolerance="1e-5">',), gone=("mpr",), shows=False),
    Feature("ccd-names", "4.0.0", option('<option ccd_iterations="17"/>'), "3.2.2",
            written=('mpr_iterations="17"',), shows=False),
    Feature("mesh-inertia", "3.2.4", f"""<mujoco><compiler exactmeshinertia="true"/>
      <asset><mesh name="m" {HOLLOW}/></asset><worldbody>
      <body><freejoint/><geom type="mesh" mesh="m"/></body></worldbody></mujoco>""",
            written=('inertia="exact"',), gone=("exactmesh",)),
    Feature("mesh-inertia", "4.0.0", f"""<mujoco>
      <asset><mesh name="m" {HOLLOW} inertia="exact"/></asset><worldbody>
      <body><freejoint/><geom type="mesh" mesh="m"/></body></worldbody></mujoco>""", "3.2.4",
            written=('exactmeshinertia="true"',), gone=(" inertia=",), shows=False),
    Feature("convex-hull", "3.2.4", option('<compiler convexhull="false"/>'), gone=("convexhull",), warns=True,
            shows=False),
    Feature("layers", "3.2.4", f"""<mujoco><asset><texture name="t" type="2d" builtin="flat" width="4" height="4"/>
      <material name="m"><rgb texture="t"/></material></asset>{BALL}</mujoco>""",
            written=('<layer texture="t" role="rgb"/>',), shows=False),
    Feature("layers", "4.0.0", f"""<mujoco><asset><texture name="t" type="2d" builtin="flat" width="4" height="4"/>
      <material name="m"><layer role="rgb" texture="t"/></material></asset>{BALL}</mujoco>""", "3.2.4",
            written=('<rgb texture="t"/>',), shows=False),
    Feature("native-ccd", "3.2.7", option('<option timestep="0.001"/>'), written=('nativeccd="disable"',)),
    Feature("native-ccd", "4.0.0", option("<!-- nothing -->"), "3.2.7", written=('nativeccd="enable"',)),
    Feature("shell-meshes", "3.2.7", f"""<mujoco><asset><mesh name="m" {MESH}/></asset><worldbody>
      <body><freejoint/><geom type="mesh" mesh="m" shellinertia="true"/></body></worldbody></mujoco>""",
            written=('inertia="shell"',), gone=("shellinertia",), warns=True, shows=False),
    Feature("shell-meshes", "3.2.7", f"""<mujoco><asset><mesh name="m" {MESH}/></asset><worldbody>
      <body><freejoint/><geom type="mesh" mesh="m" shellinertia="true"/></body>
      <body><freejoint/><geom type="mesh" mesh="m"/></body></worldbody></mujoco>""", refuses=True, shows=False),
    Feature("flex-internal", "3.3.0", flex('<edge equality="true"/>'), "3.14.0", written=('internal="true"',)),
    Feature("flex-internal", "3.14.0", flex('<edge equality="true"/>'), "3.3.0", written=('internal="false"',)),
    Feature("flex-inside", "3.3.0", flex('<edge equality="true"/>'), warns=True, shows=False),
    Feature("light-type", "4.0.0", '<mujoco><worldbody><light type="directional"/></worldbody></mujoco>', "3.2.7",
            written=('directional="true"',), shows=False),
    Feature("light-type", "4.0.0", '<mujoco><worldbody><light type="image"/></worldbody></mujoco>', "3.2.7",
            refuses=True, shows=False),
    Feature("texture-colors", "3.3.2", f'<mujoco><asset><texture name="t" type="2d" file="t.png"/></asset>{BALL}</mujoco>',
            written=('colorspace="linear"',), shows=False),
    Feature("shell-plugin", "3.3.2", flex('<plugin plugin="mujoco.elasticity.shell"/>'), refuses=True, shows=False),
    Feature("solid-plugins", "3.2.3", flex('<plugin plugin="mujoco.elasticity.membrane"/>'), refuses=True, shows=False),
    Feature("sdf-plugin", "3.3.4", """<mujoco><extension><plugin plugin="mujoco.sdf.sdflib"/></extension></mujoco>""",
            refuses=True, shows=False),
    Feature("passive", "3.3.5", option('<option><flag passive="disable"/></option>'),
            written=('spring="disable"', 'damper="disable"'), gone=("passive",), shows=False),
    Feature("passive", "4.0.0", option('<option><flag spring="disable" damper="disable"/></option>'), "3.3.5",
            written=('passive="disable"',), gone=("spring",), shows=False),
    Feature("passive", "4.0.0", option('<option><flag spring="disable"/></option>'), "3.3.5", refuses=True, shows=False),
    Feature("islands", "3.3.5", f"<mujoco>{BALL}</mujoco>", written=('island="disable"',)),
    Feature("islands", "4.0.0", f"<mujoco>{BALL}</mujoco>", "3.3.5", written=('island="enable"',)),
    Feature("apirate", "3.3.6", option('<option apirate="50"/>'), gone=("apirate",), shows=False),
    Feature("ccd-iterations", "3.3.6", option('<option timestep="0.001"/>'), written=('ccd_iterations="50"',)),
    Feature("ccd-iterations", "4.0.0", option("<!-- nothing -->"), "3.3.6", written=('ccd_iterations="35"',)),
    Feature("fit-to-box", "3.3.6", f"""<mujoco><compiler fitaabb="true"/><asset><mesh name="m" {MESH}/></asset>
      <worldbody><body><freejoint/><geom type="box" mesh="m"/></body></worldbody></mujoco>""", warns=True, shows=False),
    Feature("margins", "3.4.0", """<mujoco><default><geom margin=".02"/></default><worldbody>
      <body><freejoint/><geom size=".1"/></body><body pos="1 0 0"><freejoint/><geom size=".1"/></body>
      </worldbody></mujoco>""", written=('margin="0.01"',)),
    Feature("margins", "4.0.0", """<mujoco><worldbody><body><freejoint/><geom size=".1" margin=".02"/></body>
      <body pos="1 0 0"><freejoint/><geom size=".1" margin=".02"/></body></worldbody></mujoco>""", "3.4.0",
            written=('margin="0.04"',)),
    Feature("margins", "3.4.0", """<mujoco><worldbody><body><freejoint/><geom size=".1" margin=".02"/></body>
      <body pos="1 0 0"><freejoint/><geom size=".1" margin=".03"/></body></worldbody></mujoco>""", warns=True, shows=False),
    Feature("projection", "3.4.0", '<mujoco><worldbody><camera orthographic="true"/></worldbody></mujoco>',
            written=('<camera projection="orthographic"/>',), shows=False),
    Feature("projection", "4.0.0", '<mujoco><worldbody><camera projection="orthographic"/></worldbody></mujoco>', "3.4.0",
            written=('<camera orthographic="true"/>',), shows=False),
    Feature("flex-vertices", "3.6.0", flex('<contact vertcollide="true"/><edge equality="true"/>'), gone=("vertcollide",),
            warns=True, shows=False),
    Feature("multiple-contacts", "3.7.0", f"<mujoco>{BALL}</mujoco>", written=('multiccd="disable"',)),
    Feature("multiple-contacts", "4.0.0", f"<mujoco>{BALL}</mujoco>", "3.7.0", written=('multiccd="enable"',)),
    Feature("gap", "3.8.1", """<mujoco><default><geom margin=".2" gap=".1"/><default class="c"><geom gap="0"/></default>
      <default class="d"><geom margin=".5"/></default></default><worldbody><body><freejoint/><geom size=".1"/>
      <geom size=".1" class="c"/><geom size=".1" class="d"/><geom size=".1" margin=".3"/><geom name="x" size=".1" gap=".2"/>
      </body></worldbody></mujoco>""",
            written=('margin="0.1" gap=".1"', 'gap="0" margin="0.2"', 'margin="0.4"', 'margin="0"')),
    Feature("gap", "4.0.0", '<mujoco><worldbody><body><freejoint/><geom size=".1" margin=".1" gap=".1"/></body></worldbody></mujoco>',
            "3.8.1", written=('margin="0.2"',)),
    Feature("gap", "4.0.0", '<mujoco><worldbody><body><freejoint/><geom size=".1" margin="-.2" gap=".1"/></body></worldbody></mujoco>',
            "3.8.1", refuses=True, shows=False),
    Feature("tactile", "3.8.1", """<mujoco><asset><mesh name="m" builtin="sphere" params="1"/></asset><worldbody>
      <body><freejoint/><geom name="g" type="mesh" mesh="m"/></body></worldbody>
      <sensor><tactile geom="g" mesh="m"/></sensor></mujoco>""", warns=True, shows=False),
    Feature("sleep-tolerance", "3.10.0", option('<option><flag sleep="enable"/></option>'),
            written=('sleep_tolerance="0.0001"',)),
    Feature("sleep-tolerance", "4.0.0", option('<option><flag sleep="enable"/></option>'), "3.10.0",
            written=('sleep_tolerance="0.001"',)),
    Feature("integrated-limits", "3.10.0", f"""<mujoco><compiler autolimits="false"/>{HINGE}<actuator>
      <intvelocity joint="j" actrange="-1 1"/></actuator></mujoco>""", "3.12.0", written=('actlimited="true"',), shows=False),
    Feature("integrated-limits", "3.10.0", f"""<mujoco><compiler autolimits="false"/>{HINGE}<actuator>
      <intvelocity joint="j" actrange="-1 1"/></actuator></mujoco>""", refuses=True, shows=False),
    Feature("bounding-volumes", "3.11.0", f"<mujoco>{BALL}</mujoco>", written=('bvactive="true"',)),
    Feature("bounding-volumes", "4.0.0", f"<mujoco>{BALL}</mujoco>", "3.11.0", written=('bvactive="false"',)),
    Feature("motor-inputs", "3.11.0", f"""<mujoco>{HINGE}<actuator>
      <dcmotor joint="j" motorconst="1" resistance="1" input="position" controller="1 0 0 0"/></actuator></mujoco>""",
            refuses=True, says="K²/R", shows=False),
    Feature("mocap-bodies", "3.11.0", """<mujoco><worldbody><body mocap="true"><geom size=".1"/></body></worldbody></mujoco>""",
            warns=True, shows=False),
    Feature("flex-integration", "3.12.0", flex('<elasticity young="1e4" elastic2d="both" thickness=".01"/>',
            more='<option integrator="implicitfast" solver="CG"/>'), refuses=True, shows=False),
    Feature("tendon-forces", "3.13.0", f"""<mujoco>{HINGE}<tendon><fixed name="t" actuatorfrcrange="-1 1">
      <joint joint="j" coef="1"/></fixed></tendon></mujoco>""", written=('actuatorfrclimited="false"',)),
    Feature("tendon-forces", "4.0.0", f"""<mujoco>{HINGE}<tendon><fixed name="t" actuatorfrcrange="-1 1">
      <joint joint="j" coef="1"/></fixed></tendon></mujoco>""", "3.13.0", written=('actuatorfrclimited="true"',)),
    Feature("damping-ratio", "3.14.0", f"""<mujoco><worldbody>{TWO}</worldbody><actuator>
      <position name="a" joint="k" kp="10" dampratio="1"/></actuator></mujoco>""", warns=True),
    Feature("damping-ratio", "4.0.0", f"""<mujoco><default><position kp="10" dampratio="1"/></default>
      <worldbody>{TWO}</worldbody><actuator><position name="a" joint="k"/></actuator></mujoco>""", "3.14.0", warns=True),
    Feature("flex-inside", "3.14.0", flex('<contact internal="true"/><edge equality="true"/>'), gone=("internal",),
            warns=True, shows=False),
    Feature("class-orientation", "3.15.0", """<mujoco><default><geom euler="0 0 45"/></default><worldbody>
      <body><freejoint/><geom type="box" size=".1 .2 .3" quat="0 1 0 0"/></body></worldbody></mujoco>""", gone=("quat",)),
    Feature("keys-of-copies", "3.15.0", """<mujoco><worldbody><replicate count="2" offset="1 0 0">
      <body><joint/><geom size=".1"/></body></replicate></worldbody>
      <keyframe><key qpos="1"/></keyframe></mujoco>""", warns=True, shows=False),
    Feature("actuator-classes", "3.15.0", f"""<mujoco><default><position kp="10"/></default>{HINGE}<actuator>
      <motor joint="j"/></actuator></mujoco>""", warns=True, shows=False),
    Feature("rods", "3.16.0", flex('<elasticity young="1e5"/>', 1, "5 1 1"),
            written=('young="0"',)),
    Feature("cables", "3.17.0", """<mujoco><extension><plugin plugin="mujoco.elasticity.cable"/></extension><worldbody>
      <composite type="cable" prefix="c" count="5 1 1" size="1"><geom type="capsule" size=".01"/></composite>
      </worldbody></mujoco>""", refuses=True, says="flexcomp dim", shows=False),
    Feature("flex-stiffness", "3.17.0", flex('<elasticity young="1e4" poisson=".2"/>', 3, "3 3 3"),
            written=('poisson="0.285714285714"',)),
    Feature("flex-stiffness", "3.17.0", flex('<elasticity young="1e4" poisson=".2" thickness=".01" elastic2d="both"/>'),
            written=('poisson="0.4"', "thickness=\"0.0134")),
    Feature("flex-stiffness", "3.17.0", flex('<elasticity young="1e4" poisson=".2" thickness=".01" elastic2d="stretch"/>'),
            written=('poisson="0.4"', 'thickness=".01"')),
    Feature("flex-stiffness", "3.17.0", flex('<elasticity young="1e4" poisson=".2" thickness=".01" elastic2d="bend"/>'),
            written=('young="6000"', 'poisson=".2"')),
    Feature("flex-stiffness", "4.0.0", flex('<elasticity young="1e4" poisson=".2"/>', 3, "3 3 3"), "3.17.0",
            written=('poisson="0.125"',)),
    Feature("flex-stiffness", "4.0.0", flex('<elasticity young="1e4" poisson=".2" thickness=".01" elastic2d="both"/>'),
            "3.17.0", written=('poisson="0.1"',)),
    Feature("flex-stiffness", "3.17.0", flex('<elasticity young="1e4" poisson=".3" thickness=".01" elastic2d="both"/>'),
            warns=True, shows=False),
    Feature("flexes-in-frames", "3.17.0", f"""<mujoco><worldbody><body name="b"><frame pos="0 0 1">
      {FLEX.format(dim=2, count="3 3 1", inside='<edge equality="true"/>')}</frame></body></worldbody></mujoco>""",
            warns=True, shows=False),
    Feature("headlight", "3.17.0", f"<mujoco>{BALL}</mujoco>", written=('<headlight active="1"/>',)),
    Feature("headlight", "4.0.0", option('<visual><headlight active="false"/></visual>'), "3.17.0",
            written=('active="0"',), shows=False),
    Feature("side-sites", "3.17.0", """<mujoco><worldbody><geom name="g" type="cylinder" size=".1 .1"/><site name="a" pos="1 0 0"/>
      <site name="b" pos="-1 0 0"/><site name="s" pos="0 .2 0"/></worldbody><tendon><spatial><site site="a"/>
      <geom geom="g" sidesite="s"/><site site="b"/></spatial></tendon></mujoco>""", warns=True, shows=False),
    Feature("runge-kutta", "4.0.0", option('<option integrator="RK4"/>'), "3.17.0", warns=True, shows=False),
    Feature("mocap-bodies", "4.0.0", """<mujoco><worldbody><body mocap="true"><geom size=".1"/></body></worldbody></mujoco>""",
            "3.11.0", warns=True, shows=False),
    Feature("class-orientation", "4.0.0", """<mujoco><default><geom euler="0 0 45"/></default><worldbody>
      <body><freejoint/><geom type="box" size=".1 .2 .3" quat="0 1 0 0"/></body></worldbody></mujoco>""", "3.15.0",
            refuses=True, shows=False),
    Feature("shell-meshes", "4.0.0", f"""<mujoco><asset><mesh name="m" {MESH} inertia="shell"/></asset><worldbody>
      <body><freejoint/><geom type="mesh" mesh="m"/></body></worldbody></mujoco>""", "3.2.7",
            written=('shellinertia="true"',), gone=("inertia=\"shell\"",), warns=True, shows=False),
    Feature("rods", "4.0.0", flex('<elasticity young="1e5"/>', 1, "5 1 1"), "3.16.0", warns=True, shows=False),
    Feature("runge-kutta", "3.17.0", option('<option integrator="RK4"/>'), warns=True, shows=False),
)  # fmt: skip
