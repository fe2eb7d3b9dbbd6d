"""The words, units and MJCF attributes of the arrays of `mjModel`, for the readers of a comparison."""

from __future__ import annotations

from composer.compiled.fields import RULES, Treatment
from composer.compiled.joints import ANGULAR
from composer.dataclass import dataclass


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
"""Arrays that MuJoCo computes from others, besides those that ``composer.compiled.fields`` marks as derived."""


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
