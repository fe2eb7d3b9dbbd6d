"""The arrays of `mjModel`: words, units, types of joint, and how each is compared.

The types of joint: the sizes of their state, and units.

MuJoCo uses radians and metres. A quaternion has no unit; its numbers have the word for one.

The rules for comparing each array of `mjModel` between a part and its composition.

An array that is in no table here is *plain*: one row for each element, the same alone and composed, bit for bit.
Everything else has its treatment and the reason for it in ``RULES``.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from functools import cache
from typing import Any

from mjcompose.base.dataclass import dataclass

ENUMS: Mapping[str, tuple[str, str]] = {
    "jnt_type": ("mjtJoint", "mjJNT_"),
    "geom_type": ("mjtGeom", "mjGEOM_"),
    "site_type": ("mjtGeom", "mjGEOM_"),
    "cam_mode": ("mjtCamLight", "mjCAMLIGHT_"),
    "light_mode": ("mjtCamLight", "mjCAMLIGHT_"),
    "light_type": ("mjtLightType", "mjLIGHT_"),
    "tex_type": ("mjtTexture", "mjTEXTURE_"),
    "eq_type": ("mjtEq", "mjEQ_"),
    "sensor_type": ("mjtSensor", "mjSENS_"),
    "actuator_dyntype": ("mjtDyn", "mjDYN_"),
    "actuator_gaintype": ("mjtGain", "mjGAIN_"),
    "actuator_biastype": ("mjtBias", "mjBIAS_"),
    "actuator_trntype": ("mjtTrn", "mjTRN_"),
}
"""By array: MuJoCo's enumeration, and the prefix of its members."""

SWITCHES = frozenset(
    "limited actgravcomp actlimited ctrllimited forcelimited actfrclimited active0 actearly castshadow active"
    " texuniform mocapid".split()
)
"""The suffixes of arrays that are booleans; `body_mocapid` is -1 for no."""

# Sensors whose tag differs from the name in MuJoCo's enumeration.
_TAGS = {
    "geomdist": "distance",
    "geomnormal": "normal",
    "geomfromto": "fromto",
    "jointactfrc": "jointactuatorfrc",
    "tendonactfrc": "tendonactuatorfrc",
}


@cache
def words(mujoco: Any, array: str) -> Mapping[int, str]:
    """Return the words of an array by their numbers; for `sensor_type` these are the tags of sensors."""
    enumeration, prefix = ENUMS[array]
    members: Mapping[str, Any] = getattr(mujoco, enumeration).__members__
    found = {
        int(value): name.removeprefix(prefix).lower()
        for name, value in members.items()
        if name.startswith(prefix)
    }
    return {
        number: _TAGS.get(name, name) if array == "sensor_type" else name for number, name in found.items()
    }


ANGLE, LENGTH, QUATERNION = "rad", "m", "quaternion"

FREE, BALL, SLIDE, HINGE = range(4)
"""The values of `jnt_type`."""


@dataclass(frozen=True, slots=True)
class JointType:
    """A type of joint.

    `position_units` has the unit of each number in `qpos`, `velocity_units` those in `qvel`. `range_unit` is that
    of `jnt_range`, which MuJoCo does not use for a free joint. The linear numbers of a free joint precede the
    angular ones; its linear velocity is in the world's frame, its angular velocity in the body's own.
    """

    word: str
    position_units: tuple[str, ...]
    velocity_units: tuple[str, ...]
    range_unit: str | None

    @property
    def positions(self) -> int:
        """The number of its entries in `qpos`."""
        return len(self.position_units)

    @property
    def velocities(self) -> int:
        """The number of its degrees of freedom: entries of `qvel`, rows of the `dof_` arrays."""
        return len(self.velocity_units)

    @property
    def unit(self) -> str | None:
        """The common unit of all its positions."""
        return _common(self.position_units)

    @property
    def velocity_unit(self) -> str | None:
        """The common unit of all its velocities."""
        return _common(self.velocity_units)

    @property
    def coordinate(self) -> str | None:
        """The unit of its position, if that is a single number."""
        return self.unit if self.positions == 1 else None


def _common(units: tuple[str, ...]) -> str | None:
    return units[0] if len(set(units)) == 1 else None


JOINT_TYPES = (
    JointType("free", (LENGTH,) * 3 + (QUATERNION,) * 4, ("m/s",) * 3 + ("rad/s",) * 3, range_unit=None),
    JointType("ball", (QUATERNION,) * 4, ("rad/s",) * 3, range_unit=ANGLE),
    JointType("slide", (LENGTH,), ("m/s",), range_unit=LENGTH),
    JointType("hinge", (ANGLE,), ("rad/s",), range_unit=ANGLE),
)
"""By `jnt_type`."""

BY_WORD = {each.word: each for each in JOINT_TYPES}
ANGULAR = tuple(each.word for each in JOINT_TYPES if each.range_unit == ANGLE)
"""Rotational joints, whose ranges are angles."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """A physical quantity.

    `unit` is that of slides and of everything except joints; `angular` is that of hinges if it differs.
    """

    words: str
    unit: str = ""
    angular: str | None = None
    attributes: tuple[str, ...] = ()


def _quantities(table: str) -> dict[str, Quantity]:
    found = {}
    for line in table.strip().splitlines():
        array, words, units, attributes = (cell.strip() for cell in line.split("|"))
        unit, _, angular = units.partition(";")
        found[array] = Quantity(
            words, unit.strip(), angular.strip() or None, attributes=tuple(attributes.split())
        )
    return found


_POSE = "pos quat euler axisangle xyaxes zaxis fromto"
_TURN = "quat euler axisangle xyaxes zaxis fromto pos"

# array | words | unit; unit of hinges | attributes
_QUANTITIES = _quantities(f"""
body_mass | mass | kg | mass
body_inertia | principal inertia | kg·m² | diaginertia fullinertia
body_ipos | centre of mass | m | pos
body_iquat | principal axes of inertia | | quat
body_pos | position | m | {_POSE}
body_quat | orientation | | {_TURN}
body_gravcomp | gravity compensation | | gravcomp
body_mocapid | mocap | | mocap
jnt_type | type | | type
jnt_range | range | m; rad | range
jnt_limited | limited | | limited range
jnt_pos | anchor | m | pos
jnt_axis | axis | | axis
jnt_stiffness | stiffness | N/m; N·m/rad | stiffness springdamper
jnt_actfrcrange | force limit of its actuators | N; N·m | actuatorfrcrange
jnt_actfrclimited | force of its actuators limited | | actuatorfrclimited actuatorfrcrange
jnt_actgravcomp | gravity compensation by its actuators | | actuatorgravcomp
jnt_margin | margin of its limit | m; rad | margin
jnt_solref | softness of its limit (solref) | | solreflimit
jnt_solimp | softness of its limit (solimp) | | solimplimit
dof_damping | damping | N·s/m; N·m·s/rad | damping springdamper
dof_armature | armature | kg; kg·m² | armature
dof_frictionloss | friction loss | N; N·m | frictionloss
dof_solref | softness of its friction loss (solref) | | solreffriction
dof_solimp | softness of its friction loss (solimp) | | solimpfriction
qpos0 | reference position | m; rad | ref
qpos_spring | rest position of its spring | m; rad | springref ref
geom_type | type | | type
geom_size | size | m | size fromto
geom_pos | position | m | {_POSE}
geom_quat | orientation | | {_TURN}
geom_friction | friction | | friction
geom_dataid | shape | | mesh hfield
geom_matid | material | | material
geom_fluid | fluid coefficients | | fluidcoef fluidshape
geom_rgba | colour (rgba) | | rgba
site_pos | position | m | {_POSE}
site_quat | orientation | | {_TURN}
site_size | size | m | size fromto
site_rgba | colour (rgba) | | rgba
site_matid | material | | material
cam_pos | position | m | {_POSE}
cam_quat | orientation | | {_TURN}
cam_fovy | vertical field of view | deg | fovy focal focalpixel sensorsize
cam_intrinsic | lens | m | focal focalpixel principal principalpixel sensorsize fovy
cam_mode | mode | | mode
cam_resolution | resolution | px | resolution
cam_targetbodyid | target | | target
light_pos | position | m | pos
light_dir | direction | | dir
light_targetbodyid | target | | target
mat_rgba | colour (rgba) | | rgba
mat_texid | textures | | texture
mesh_vert | vertices | m | file vertex scale builtin params
mesh_face | faces | | file face builtin params
mesh_vertnum | number of vertices | | file vertex builtin params
mesh_facenum | number of faces | | file face builtin params
mesh_pos | centre in its file | m | file refpos
mesh_quat | orientation in its file | | file refquat
tex_data | pixels | | file builtin rgb1 rgb2 mark markrgb random
hfield_data | heights | | file elevation
hfield_size | size | m | size
tendon_range | range | m | range
tendon_limited | limited | | limited range
tendon_stiffness | stiffness | N/m | stiffness
tendon_damping | damping | N·s/m | damping
tendon_frictionloss | friction loss | N | frictionloss
tendon_armature | armature | kg | armature
tendon_lengthspring | rest length of its spring | m | springlength
tendon_actfrcrange | force limit of its actuators | N | actuatorfrcrange
tendon_width | width | m | width
tendon_rgba | colour (rgba) | | rgba
tendon_solref_lim | softness of its limit (solref) | | solreflimit
tendon_solimp_lim | softness of its limit (solimp) | | solimplimit
tendon_solref_fri | softness of its friction loss (solref) | | solreffriction
tendon_solimp_fri | softness of its friction loss (solimp) | | solimpfriction
wrap_type | path | |
wrap_objid | path | |
wrap_prm | path | |
kp | position gain (kp) | | kp gainprm biasprm
kv | velocity gain (kv) | | kv dampratio gainprm biasprm
gain | gain | | gainprm kp kv
actuator_gainprm | gain parameters | | gainprm kp kv gain
actuator_biasprm | bias parameters | | biasprm kp kv dampratio
actuator_dynprm | activation parameters | | dynprm timeconst
actuator_gaintype | gain type | | gaintype
actuator_biastype | bias type | | biastype
actuator_dyntype | activation type | | dyntype
actuator_ctrlrange | control range | | ctrlrange inheritrange
actuator_ctrllimited | control limited | | ctrllimited ctrlrange inheritrange
actuator_forcerange | force range | | forcerange
actuator_forcelimited | force limited | | forcelimited forcerange
actuator_actrange | activation range | | actrange
actuator_actlimited | activation limited | | actlimited actrange
actuator_gear | gear | | gear
actuator_trnid | target | | joint jointinparent tendon site body cranksite slidersite refsite
actuator_trntype | transmission | | joint jointinparent tendon site body cranksite slidersite
actuator_lengthrange | length range | m | lengthrange
sensor_objid | object | | site joint tendon actuator body objname geom1 geom2 camera
sensor_refid | reference | | refname
sensor_type | type | |
sensor_dim | number of values | | dim
sensor_noise | noise | | noise
sensor_cutoff | cutoff | | cutoff
eq_data | parameters | | anchor relpose polycoef torquescale
eq_active0 | active | | active
eq_obj1id | first object | | body1 joint1 tendon1 site1 geom1 flex
eq_obj2id | second object | | body2 joint2 tendon2 site2 geom2
eq_solref | softness (solref) | | solref
eq_solimp | softness (solimp) | | solimp
pair_dim | condim | | condim
numeric_data | numbers | | data
text_data | text | | data
key_qpos | position | m; rad | qpos
key_qvel | velocity | m/s; rad/s | qvel
key_ctrl | control | | ctrl
key_act | activation | | act
key_mpos | position | m | mpos
key_mquat | orientation | | mquat
key_time | time | s | time
timestep | timestep | s | timestep
gravity | gravity | m/s² | gravity
wind | wind | m/s | wind
density | density of the medium | kg/m³ | density
viscosity | viscosity of the medium | Pa·s | viscosity
body_parentid | parent | |
jnt_bodyid | body | |
geom_bodyid | body | |
site_bodyid | body | |
cam_bodyid | body | |
light_bodyid | body | |
""")

_RANKS = {field: number for number, field in enumerate(_QUANTITIES)}

_FOLLOWING = frozenset(
    """
    geom_rbound geom_aabb body_sameframe geom_sameframe site_sameframe
    body_contype body_conaffinity body_margin body_jntnum body_dofnum body_geomnum
    jnt_actuatorid tendon_actuatorid tendon_length0 tendon_num
    actuator_length0 actuator_acc0 actuator_actnum actuator_ctrlnum actuator_outnum
    sensor_needstage sensor_datatype cam_intrinsic
    mesh_normal mesh_normalnum mesh_facenormal mesh_graph mesh_graphadr mesh_polynum mesh_polynormal mesh_polyvert
    mesh_polyvertnum mesh_polymap mesh_polymapnum mesh_texcoordnum mesh_bvhnum mesh_octnum mesh_extrema
    mesh_facetexcoord mesh_texcoord
    oct_depth oct_aabb oct_coeff hfield_nrow hfield_ncol text_size numeric_size tuple_size
    meaninertia meanmass meansize extent center
    """.split()
)
"""Arrays that MuJoCo computes from others, besides those that ``mjcompose.mujoco.arrays`` marks as derived."""


def quantity(field: str) -> Quantity:
    """Return the words for an array; the default is its name without the first word.

    >>> quantity("geom_condim").words, unit("jnt_range", "hinge")
    ('condim', 'rad')
    """
    known = _QUANTITIES.get(field.partition("[")[0])
    if known is not None:
        return known
    array = field.partition("[")[0]
    plain = array.partition("_")[2] or array
    return Quantity(plain.replace("_", " "), attributes=(plain,))


def rank(field: str) -> int:
    """Return the position of a quantity in reports: its row in the table above, others after that."""
    return _RANKS.get(field.partition("[")[0], len(_RANKS))


def is_place(field: str) -> bool:
    """Return whether it is a position or a state, for which a relative change has no meaning."""
    return field.endswith(("pos", "qpos0", "quat")) or field.startswith("key_")


def unit(field: str, form: str) -> str:
    """Return the unit of a quantity; none for free joints, whose numbers have several units."""
    known = quantity(field)
    if form == "free" or (form == "ball" and field != "jnt_range"):
        return ""
    return known.angular if known.angular and form in ANGULAR else known.unit


def follows(field: str) -> bool:
    """Return whether MuJoCo computes the array from others that are compared too."""
    field = field.partition("[")[0]
    rule = RULES.get(field)
    return field in _FOLLOWING or (
        rule is not None and rule.treatment in (Treatment.DERIVED, Treatment.SUBTREE)
    )


class Treatment(StrEnum):
    PLAIN = "plain"
    """Row by row, exactly."""
    SKIPPED = "skipped"
    """Not compared."""
    PRESENT = "present"
    """Only whether it exists (is not negative)."""
    LINKED = "linked"
    """An id, compared as its element."""
    DATA = "data"
    """Not one row for each element: the element's run of data is compared."""
    USER = "user"
    """Exactly, except for zeros at the end of a row."""
    ROOT_POSE = "root pose"
    """Exactly, but at the part's root compared through the mount."""
    ROUNDED = "rounded"
    """Exactly if the part is in place, else up to rounding."""
    HOST = "host"
    """Exactly, but not on bodies that carry geoms of others, nor for elements on such bodies."""
    SUBTREE = "subtree"
    """Exactly, but not if elements of others are below."""
    LENS = "lens"
    """Exactly, but not for a camera without a sensor, where it is not used."""
    DERIVED = "derived"
    """Up to rounding if no element of others is on the same kinematic tree and the part is not moved, else not at
    all; the values it is computed from are compared.
    """
    GAIN = "gain"
    """Exactly (up to rounding if the part is moved), or as MuJoCo computes it from the inertia of the whole model."""


@dataclass(frozen=True, slots=True)
class Rule:
    treatment: Treatment
    reason: str


ROUNDING = 1e-9
"""Relative and absolute (SI units): poses through a frame are multiplied in double precision, with 1e-16 for each
step.
"""

DERIVED_ROUNDING = 1e-7
"""Relative: the mass matrix of a larger model is factored in another order, which inverse inertias amplify."""

AUTHORED_SLEEP = 3
"""The first value of `mjtSleepPolicy` that an author writes; lower ones follow from the whole tree."""

_TABLE: dict[Treatment, dict[str, str]] = {
    Treatment.SKIPPED: {
        "an address of the whole model; the joints, dofs and geoms themselves are compared": (
            "body_jntadr body_dofadr body_geomadr jnt_qposadr jnt_dofadr dof_Madr"
        ),
        "a count that takes in the geoms others have put there; each geom is matched": "body_geomnum",
        "follows from the parents and joints, which are compared, and from what the part hangs on": (
            "body_rootid body_weldid body_treeid dof_bodyid dof_jntid dof_parentid dof_treeid"
            " tendon_treenum tendon_treeid"
        ),
        "a shortcut for bodies whose whole tree is simple; depends on what the tree hangs on": (
            "body_simple dof_simplenum"
        ),
        "the bounding volumes of a body's geoms, whose boxes are compared": "body_bvhadr body_bvhnum",
        "a pose in the whole model's reference configuration; the local pose is compared": (
            "cam_poscom0 cam_pos0 cam_mat0 light_poscom0 light_pos0 light_dir0"
        ),
        "the address of a file path; files are renamed in a bundle, what they hold is compared": (
            "mesh_pathadr skin_pathadr hfield_pathadr tex_pathadr tex_contenttypeadr"
        ),
        "the address of the element's data; the data is compared": (
            "mesh_vertadr mesh_faceadr mesh_bvhadr mesh_octadr mesh_normaladr mesh_polyadr mesh_polyvertadr"
            " mesh_polymapadr hfield_adr tex_adr skin_vertadr skin_faceadr skin_boneadr skin_bonevertadr"
            " flex_nodeadr flex_vertadr flex_edgeadr flex_elemadr flex_elemdataadr flex_stiffnessadr"
            " flex_elemedgeadr flex_bendingadr flex_shelldataadr flex_bvhadr"
            " tendon_adr numeric_adr text_adr tuple_adr plugin_attradr"
            " actuator_ctrladr actuator_outadr"
        ),
        "an address in the state or the sensor data of the whole model": "sensor_adr plugin_stateadr",
        "the body ids of a pair once more; its geoms are compared": "pair_signature",
        "the neighbours of a flex's vertices (in MuJoCo 3); its edges are compared": (
            "flex_evpairadr flex_vertedgeadr flex_vertedgenum flex_vertedge"
        ),
        "the bounding volumes of a flex, built from its vertices in the world's frame": "flex_bvhnum",
        "one time for a whole key, which may be of several parts": "key_time",
    },
    Treatment.PRESENT: {
        "an id in order of the whole model": "body_mocapid",
        "an address in the state of the whole model": (
            "jnt_plasticadr tendon_plasticadr flex_plasticadr actuator_actadr actuator_historyadr"
            " sensor_historyadr"
        ),
        "the address of data an element may lack": (
            "mesh_texcoordadr mesh_graphadr skin_texcoordadr flex_texcoordadr"
        ),
    },
    Treatment.LINKED: {
        "an id": (
            "body_parentid body_plugin jnt_bodyid jnt_actuatorid geom_bodyid geom_dataid geom_matid"
            " geom_plugin site_bodyid site_dataid site_matid cam_bodyid cam_targetbodyid light_bodyid"
            " light_targetbodyid light_texid mat_texid skin_matid flex_matid tendon_matid"
            " tendon_actuatorid actuator_trnid actuator_plugin sensor_objid sensor_refid sensor_plugin"
            " eq_obj1id eq_obj2id pair_geom1 pair_geom2 exclude_signature skin_bonebodyid"
            " flex_vertbodyid flex_nodebodyid tuple_objid"
        ),
    },
    Treatment.DATA: {
        "several rows an element": (
            "mesh_vert mesh_normal mesh_texcoord mesh_face mesh_facenormal mesh_facetexcoord mesh_graph"
            " mesh_polynormal mesh_polyvertnum mesh_polyvert mesh_polymapnum mesh_polymap"
            " hfield_data tex_data skin_vert skin_texcoord skin_face skin_bonevertnum skin_bonebindpos"
            " skin_bonebindquat skin_bonevertid skin_bonevertweight numeric_data text_data tuple_objtype"
            " tuple_objprm plugin_attr"
            " flex_vertcell flex_edge flex_edgeflap flex_elem flex_elemtexcoord flex_elemedge flex_elemlayer"
            " flex_shell flex_evpair flex_vertmetric flex_vert flex_vert0 flex_node flex_node0 flex_stiffness"
            " flex_bending flex_texcoord"
        ),
        "one row a control, not an actuator (in MuJoCo 4)": "actuator_ctrllimited actuator_ctrlrange",
        "one row a force output, not an actuator (in MuJoCo 4)": (
            "actuator_gear actuator_acc0 actuator_length0 actuator_lengthrange"
        ),
        "compared by joint, actuator and mocap body": (
            "key_qpos key_qvel key_act key_ctrl key_mpos key_mquat key_plastic"
        ),
    },
    Treatment.USER: {
        "as wide as the widest of the whole model, filled up with zeros": (
            "body_user jnt_user geom_user site_user cam_user tendon_user actuator_user sensor_user"
        ),
    },
    Treatment.ROOT_POSE: {
        "in the frame of the part's world, which the mount moves": (
            "body_pos body_quat geom_pos geom_quat site_pos site_quat cam_pos cam_quat light_pos light_dir"
        ),
    },
    Treatment.ROUNDED: {
        "measured in the global frame of the reference configuration": (
            "tendon_length0 tendon_lengthspring eq_data flex_size"
        ),
    },
    Treatment.HOST: {
        "summed over all geoms of the body, where it has no inertial of its own": (
            "body_mass body_inertia body_ipos body_iquat"
        ),
        "the union over all geoms of the body": "body_contype body_conaffinity body_margin",
        "whether the frame coincides with the body's or its inertia's": (
            "body_sameframe geom_sameframe site_sameframe"
        ),
    },
    Treatment.SUBTREE: {
        "summed over everything below": "body_subtreemass",
    },
    Treatment.LENS: {
        "the distance of the near plane in the whole model, of a camera that `fovy` describes": "cam_intrinsic",
    },
    Treatment.DERIVED: {
        "computed from the inertia of the whole kinematic tree": (
            "body_invweight0 dof_invweight0 dof_M0 dof_length tendon_invweight0"
        ),
    },
    Treatment.GAIN: {
        "`springdamper` and `dampratio` are turned into gains through the inertia of the whole model": (
            "jnt_stiffness dof_damping actuator_biasprm"
        ),
    },
}

RULES: dict[str, Rule] = {
    array: Rule(treatment, reason)
    for treatment, reasons in _TABLE.items()
    for reason, arrays in reasons.items()
    for array in arrays.split()
}

NOT_OF_AN_ELEMENT: dict[str, str] = {
    "qpos0": "compared by joint",
    "qpos_spring": "compared by joint",
    "wrap_type": "compared as the tendon's path",
    "wrap_objid": "compared as the tendon's path",
    "wrap_prm": "compared as the tendon's path",
    "tree_sleep_policy": "compared by the root body, where it is authored",
    "bvh_depth bvh_child bvh_nodeid bvh_aabb": "built from geoms and meshes, which are compared",
    "oct_depth oct_child oct_aabb oct_coeff": "compared by mesh",
    "tree_bodyadr tree_bodynum tree_dofadr tree_dofnum": "kinematic trees of the whole model",
    "flexvert_J_rownnz flexvert_J_rowadr flexvert_J_colind": "sparsity of the whole model",
    "flexedge_length0": "compared by flex",
    "flexedge_rigid": "compared by flex",
    "flexedge_invweight0": "computed from the inertia of the whole model",
    "flexedge_J_rownnz flexedge_J_rowadr flexedge_J_colind": "sparsity of the whole model",
    "ten_J_rownnz ten_J_rowadr ten_J_colind": "sparsity of the whole model",
    "efm0_dofid efm0_L_rownnz efm0_L_rowadr efm0_L_colind efm0_L efmC_perm": "a factor of the mass matrix",
    "B_rownnz B_rowadr B_colind D_rownnz D_rowadr D_colind D_diag M_rownnz M_rowadr M_colind": (
        "sparsity of the whole model"
    ),
    "mapM2D mapD2M mapM2M": "sparsity of the whole model",
    "names_map": "a hash table of names",
}
"""Arrays that belong to no single element, and what is compared in their place."""


HULL = frozenset(
    "mesh_extrema mesh_graphadr mesh_graph mesh_polynum mesh_polynormal mesh_polyvertnum mesh_polyvert"
    " mesh_polymapnum mesh_polymap".split()
)
"""What MuJoCo computes for meshes that can collide, which another part's elements may cause."""


BEFORE_CONTROLS: dict[str, Treatment] = {
    "actuator_ctrllimited": Treatment.PLAIN,
    "actuator_ctrlrange": Treatment.PLAIN,
    "actuator_gear": Treatment.PLAIN,
    "actuator_length0": Treatment.ROUNDED,
    "actuator_lengthrange": Treatment.ROUNDED,
    "actuator_acc0": Treatment.DERIVED,
}
"""Arrays with one row for each actuator in MuJoCo 3, where an actuator has one control and one output."""


def rule(array: str) -> Rule | None:
    """Return the rule for ``array``; None for a plain one."""
    return RULES.get(array)
