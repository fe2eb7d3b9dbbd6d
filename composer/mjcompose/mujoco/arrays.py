"""Everything known about each array of `mjModel`, in one table that every comparison reads.

For a new array of MuJoCo, add one row. MuJoCo uses radians and meters; a quaternion has no unit, so its numbers have
the unit `quaternion`.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from functools import cache
from typing import Any

from mjcompose.base.dataclass import Struct

ANGLE = "rad"
LENGTH = "m"
QUATERNION = "quaternion"

FREE, BALL, SLIDE, HINGE = range(4)
"""The values of `jnt_type`."""


class JointType(Struct):
    """A type of joint.

    `position_units` has the unit of each number in `qpos`, and `velocity_units` in `qvel`. `range_unit` is the unit of
    `jnt_range`, which MuJoCo does not use for a free joint. The linear numbers of a free joint precede the angular
    ones; its linear velocity is in the world's frame, and its angular velocity is in the body's own frame.
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
        return _common(self.position_units)

    @property
    def velocity_unit(self) -> str | None:
        return _common(self.velocity_units)

    @property
    def coordinate(self) -> str | None:
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


class Treatment(StrEnum):
    PLAIN = "plain"
    """Row by row, exactly."""
    SKIPPED = "skipped"
    """Not compared."""
    ELSEWHERE = "elsewhere"
    """Of no single element: not compared, or with the element that has its numbers."""
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
    """Exactly, except for a camera without a sensor, which does not use it."""
    DERIVED = "derived"
    """Up to rounding if no element of others is on the same kinematic tree and the part is not moved, otherwise not at
    all; the values it is computed from are compared.
    """
    GAIN = "gain"
    """Exactly (up to rounding if the part is moved), or as MuJoCo computes it from the inertia of the whole model."""


ROUNDING = 1e-9
"""Relative and absolute (SI units): poses through a frame are multiplied in double precision, with 1e-16 for each
step.
"""

DERIVED_ROUNDING = 1e-7
"""Relative: the mass matrix of a larger model is factored in another order, which inverse inertias amplify."""

AUTHORED_SLEEP = 3
"""The first value of `mjtSleepPolicy` that an author writes; lower ones follow from the whole tree."""

_BEHAVIOURS: Mapping[str, tuple[str, ...]] = {
    "address": ("skipped", "an address within the whole model; joints, dofs and geoms are compared by name"),
    "count": ("skipped", "a count that includes geoms that other parts add; each geom is matched"),
    "tree": ("skipped", "follows from the parents and joints, which are compared, and from the part's place"),
    "shortcut": ("skipped", "a shortcut for bodies whose whole tree is simple; depends on the place of the tree"),
    "volumes": ("skipped", "the bounding volumes of a body's geoms, whose boxes are compared"),
    "global pose": ("skipped", "a pose in the whole model's reference configuration; the local pose is compared"),
    "path": ("skipped", "the address of a file path; files are renamed in a bundle, and their contents are compared"),
    "data address": ("skipped", "the address of the element's data; the data is compared"),
    "state address": ("skipped", "an address in the state or the sensor data of the whole model"),
    "signature": ("skipped", "the body ids of a pair once more; its geoms are compared"),
    "neighbors": ("skipped", "the neighbors of a flex's vertices (in MuJoCo 3); its edges are compared"),
    "flex volumes": ("skipped", "the bounding volumes of a flex, built from its vertices in the world's frame"),
    "key time": ("skipped", "one time for a whole key, which may be of several parts"),
    "by joint": ("elsewhere", "compared by joint"),
    "by tendon": ("elsewhere", "compared as the tendon's path"),
    "by root": ("elsewhere", "compared by the root body, which has the authored value"),
    "by mesh": ("elsewhere", "compared by mesh"),
    "by flex": ("elsewhere", "compared by flex"),
    "all volumes": ("elsewhere", "built from geoms and meshes, which are compared"),
    "trees": ("elsewhere", "kinematic trees of the whole model"),
    "sparsity": ("elsewhere", "sparsity of the whole model"),
    "inertia": ("elsewhere", "computed from the inertia of the whole model"),
    "factor": ("elsewhere", "a factor of the mass matrix"),
    "names": ("elsewhere", "a hash table of names"),
    "mocap id": ("present", "an id in order of the whole model"),
    "has state": ("present", "an address in the state of the whole model"),
    "has data": ("present", "the address of data an element may lack"),
    "id": ("linked", "an id"),
    "control": ("data", "one row per control, not per actuator (in MuJoCo 4)", "plain"),
    "output": ("data", "one row per force output, not per actuator (in MuJoCo 4)", "plain"),
    "output length": ("data", "one row per force output, measured in the global frame", "rounded"),
    "output inertia": ("data", "one row per force output, computed from the inertia of the whole tree", "derived"),
    "key": ("data", "compared by joint, actuator and mocap body"),
    "user": ("user", "as wide as the widest of the whole model, filled up with zeros"),
    "root pose": ("root pose", "in the frame of the part's world, which the mount moves"),
    "global length": ("rounded", "measured in the global frame of the reference configuration"),
    "body sum": ("host", "summed over all geoms of a body without an inertial of its own"),
    "body union": ("host", "the union over all geoms of the body"),
    "body frame": ("host", "whether the frame coincides with the body's or its inertia's"),
    "subtree": ("subtree", "summed over everything below"),
    "lens": ("lens", "the distance of the near plane in the whole model, of a camera that `fovy` describes"),
    "tree inertia": ("derived", "computed from the inertia of the whole kinematic tree"),
    "gain": ("gain", "`springdamper` and `dampratio` are turned into gains through the inertia of the whole model"),
}  # fmt: skip
"""Traits of arrays of a part: the treatment, why, and the treatment in MuJoCo 3 if that differs.

There an actuator has one control and one output, and the arrays about these have one row for each actuator.
"""

_BETWEEN_VERSIONS = {
    "order": "an address, a count or an order in the arrays of one version",
    "joints": "follows from joints, bodies and constraints, which are compared",
    "triangles": "made of the triangles of a mesh, which are compared",
    "vertices": "made of the vertices and elements of a flex, which are compared",
    "storage": "how a texture is stored",
    "by name": "compared by name",
    "unread": "read by nothing",
}
"""Traits of arrays that are not compared between versions of MuJoCo, and why."""

SWITCH, COMPUTED, HULL, MEASURED, PLACED, REWRITTEN, UNSAID = (
    "switch computed hull measured placed rewritten unsaid".split()
)
"""Other traits, in this order: a boolean (`body_mocapid` is -1 for no); an array that MuJoCo computes from arrays that
are compared too, or for meshes that can collide, which another part's elements may cause, or from flex positions in the
world, which a moved part has up to rounding. Flex data that is a position in the world, or in the flex's box along
the axes of the world. An array that may differ in a model that is written and read back,
because it depends on the frame of a mesh or on the text. An array whose neutral numbers mean the same in all versions
that have it, because no renderer of MuJoCo read them.
"""

_POSE = "pos quat euler axisangle xyaxes zaxis fromto"
_TURN = "quat euler axisangle xyaxes zaxis fromto pos"

# arrays | traits | words | unit; unit of hinges | attributes of MJCF, the attribute with the numbers first
#
# Traits, besides those above: `rows` and the index of an array with several rows for each element (a size of `mjModel`
# for which `addresses.RUNS` has an entry, an address, or a size and the prefix of arrays of addresses and counts), an
# enumeration of MuJoCo, and the numbers that say nothing where only one of two versions has the array. An array without
# a trait has one row for each element, the same alone and composed, bit for bit. Rows with words are in the order of
# reports, arrays of data in the order in which they are compared.
_TABLE = f"""
body_mass | body sum | mass | kg | mass
body_inertia | body sum | principal inertia | kg·m² | diaginertia fullinertia
body_ipos | body sum | center of mass | m | pos
body_iquat | body sum | principal axes of inertia | | quat
body_pos | root pose | position | m | {_POSE}
body_quat | root pose | orientation | | {_TURN}
body_gravcomp | | gravity compensation | | gravcomp
body_mocapid | mocap id, switch | mocap | | mocap
body_bvhadr body_bvhnum | volumes, order, rewritten
body_conaffinity body_contype body_margin | body union, joints, computed
body_dofadr body_geomadr body_jntadr | address, order
body_geomnum | count, order, computed
body_simple | shortcut, joints
body_subtreemass | subtree
body_weldid | tree
jnt_type | mjtJoint | type | | type
jnt_range | | range | m; rad | range
jnt_limited | switch | limited | | limited range
jnt_pos | | anchor | m | pos
jnt_axis | | axis | | axis
jnt_stiffness | gain | stiffness | N/m; N·m/rad | stiffness springdamper
jnt_actfrcrange | | force limit of its actuators | N; N·m | actuatorfrcrange
jnt_actfrclimited | switch | force of its actuators limited | | actuatorfrclimited actuatorfrcrange
jnt_actgravcomp | 0, switch | gravity compensation by its actuators | | actuatorgravcomp
jnt_margin | | margin of its limit | m; rad | margin
jnt_solref | | softness of its limit (solref) | | solreflimit
jnt_solimp | | softness of its limit (solimp) | | solimplimit
dof_damping | gain | damping | N·s/m; N·m·s/rad | damping springdamper
dof_armature | | armature | kg; kg·m² | armature
dof_frictionloss | | friction loss | N; N·m | frictionloss
dof_solref | | softness of its friction loss (solref) | | solreffriction
dof_solimp | | softness of its friction loss (solimp) | | solimpfriction
qpos0 | by joint, rows nq | reference position | m; rad | ref
qpos_spring | by joint, rows nq | rest position of its spring | m; rad | springref ref
dof_Madr jnt_dofadr jnt_qposadr | address, order
dof_bodyid dof_jntid | tree
dof_length | tree inertia, joints
dof_simplenum | shortcut, joints
jnt_actuatorid | id, joints, computed
geom_type | mjtGeom | type | | type
geom_size | | size | m | size fromto
geom_pos | root pose | position | m | {_POSE}
geom_quat | root pose | orientation | | {_TURN}
geom_friction | | friction | | friction
geom_dataid | id | shape | | mesh hfield
geom_matid | id | material | | material
geom_fluid | | fluid coefficients | | fluidcoef fluidshape
geom_rgba | | color (rgba) | | rgba
geom_aabb | triangles, computed, rewritten
geom_castshadow | 1, switch
geom_rbound | computed, rewritten
site_pos | root pose | position | m | {_POSE}
site_quat | root pose | orientation | | {_TURN}
site_size | rewritten | size | m | size fromto
site_rgba | | color (rgba) | | rgba
site_matid | id | material | | material
site_dataid | id, -1
site_type | mjtGeom
cam_pos | root pose | position | m | {_POSE}
cam_quat | root pose | orientation | | {_TURN}
cam_fovy | | vertical field of view | deg | fovy focal focalpixel sensorsize
cam_intrinsic | lens, computed | lens | m | focal focalpixel principal principalpixel sensorsize fovy
cam_mode | mjtCamLight | mode | | mode
cam_resolution | | resolution | px | resolution
cam_targetbodyid | id | target | | target
cam_mat0 cam_pos0 cam_poscom0 | global pose
cam_output | 1
light_pos | root pose | position | m | pos
light_dir | root pose | direction | | dir
light_targetbodyid | id | target | | target
light_bulbradius | 0.02
light_dir0 light_pos0 light_poscom0 | global pose
light_mode | mjtCamLight
light_range | 10
light_softness | unread
light_texid | id, -1
light_type | mjtLightType
mat_rgba | | color (rgba) | | rgba
mat_texid | id | textures | | texture
mat_metallic | -1 0 1, unsaid
mat_roughness | -1 1, unsaid
mesh_vert | rows nmeshvert, triangles | vertices | m | file vertex scale builtin params
mesh_polymapnum | rows nmeshvert, order, computed, hull
mesh_normal | rows nmeshnormal, triangles, computed
mesh_texcoord | rows nmeshtexcoord, computed
mesh_face | rows nmeshface | faces | | file face builtin params
mesh_facenormal mesh_facetexcoord | rows nmeshface, triangles, computed
mesh_graph | rows nmeshgraph, triangles, computed, hull
mesh_polynormal | rows nmeshpoly, triangles, computed, hull
mesh_polyvertnum | rows nmeshpoly, order, computed, hull
mesh_polyvert | rows nmeshpoly mesh_polyvert, triangles, computed, hull
mesh_polymap | rows nmeshvert mesh_polymap, triangles, computed, hull
oct_depth oct_aabb oct_coeff | by mesh, rows noct, order, computed
mesh_extrema | triangles, computed, hull
mesh_graphadr | has data, order, computed, hull
mesh_polynum | order, computed, hull
mesh_scale | triangles
oct_child | by mesh, order
mesh_vertnum | order | number of vertices | | file vertex builtin params
mesh_facenum | order | number of faces | | file face builtin params
mesh_pos | triangles | center in its file | m | file refpos
mesh_quat | triangles | orientation in its file | | file refquat
tex_data | rows ntexdata | pixels | | file builtin rgb1 rgb2 mark markrgb random
tex_colorspace | 0 1
tex_height tex_nchannel tex_width | storage
tex_pathadr | path, order, rewritten
tex_type | mjtTexture
hfield_data | rows nhfielddata | heights | | file elevation
hfield_size | | size | m | size
skin_vert | rows nskinvert
skin_texcoord | rows nskintexvert
skin_face | rows nskinface
skin_bonebindpos skin_bonebindquat | rows nskinbone
skin_bonevertnum | rows nskinbone, order
skin_bonevertid skin_bonevertweight | rows nskinbone skin_bonevert
skin_bonenum skin_facenum skin_vertnum | order
flex_vert | rows nflexvert
flex_vert0 | rows nflexvert, vertices, placed
flex_vertcell | rows nflexvert, vertices
flex_vertmetric | rows nflexvert, vertices, measured
flex_node | rows nflexnode, vertices, measured
flex_node0 | rows nflexnode, vertices, placed
flex_edge | rows nflexedge
flex_edgeflap | rows nflexedge, vertices
flexedge_length0 | by flex, rows nflexedge, measured
flexedge_rigid | by flex, rows nflexedge, joints
flex_elemlayer | rows nflexelem, vertices
flex_elem | rows nflexelemdata
flex_elemtexcoord | rows nflexelemdata, vertices
flex_elemedge | rows nflexelemedge, vertices
flex_shell | rows nflexshelldata, vertices
flex_evpair | rows flex_evpairadr, vertices
flex_stiffness | rows flex_stiffnessadr, 0, measured
flex_bending | rows flex_bendingadr, 0, measured
flex_texcoord | rows flex_texcoordadr
flex_bandwidth flex_cellnum flex_edgenum flex_elemnum flex_evpairnum flex_nodenum flex_shellnum | order
flex_vertnum | order
flex_bvhnum | flex volumes, order
flex_evpairadr flex_vertedgeadr flex_vertedgenum | neighbors, order
flex_interp flex_xvert0 | vertices
flex_nodebodyid | id, vertices
flex_size | global length, vertices
flex_vertedge | neighbors, vertices
flexedge_invweight0 | inertia
tendon_range | | range | m | range
tendon_limited | switch | limited | | limited range
tendon_stiffness | | stiffness | N/m | stiffness
tendon_damping | | damping | N·s/m | damping
tendon_frictionloss | | friction loss | N | frictionloss
tendon_armature | 0 | armature | kg | armature
tendon_lengthspring | global length | rest length of its spring | m | springlength
tendon_actfrcrange | 0 | force limit of its actuators | N | actuatorfrcrange
tendon_width | | width | m | width
tendon_rgba | | color (rgba) | | rgba
tendon_solref_lim | | softness of its limit (solref) | | solreflimit
tendon_solimp_lim | | softness of its limit (solimp) | | solimplimit
tendon_solref_fri | | softness of its friction loss (solref) | | solreffriction
tendon_solimp_fri | | softness of its friction loss (solimp) | | solimpfriction
wrap_type | by tendon, rows nwrap | path
wrap_objid | by tendon | path
wrap_prm | by tendon, rows nwrap | path
tendon_actfrclimited | 0, switch
tendon_actuatorid | id, joints, computed
tendon_length0 | global length, computed
kp | | position gain (kp) | | kp gainprm biasprm
kv | | velocity gain (kv) | | kv dampratio gainprm biasprm
gain | | gain | | gainprm kp kv
actuator_gainprm | | gain parameters | | gainprm kp kv gain
actuator_biasprm | gain | bias parameters | | biasprm kp kv dampratio
actuator_dynprm | | activation parameters | | dynprm timeconst
actuator_gaintype | mjtGain | gain type | | gaintype
actuator_biastype | mjtBias | bias type | | biastype
actuator_dyntype | mjtDyn | activation type | | dyntype
actuator_ctrlrange | control, rows nu | control range | | ctrlrange inheritrange
actuator_ctrllimited | control, rows nu, switch | control limited | | ctrllimited ctrlrange inheritrange
actuator_forcerange | | force range | | forcerange
actuator_forcelimited | switch | force limited | | forcelimited forcerange
actuator_actrange | | activation range | | actrange
actuator_actlimited | switch | activation limited | | actlimited actrange
actuator_gear | output, rows nout | gear | | gear
actuator_trnid | id | target | | joint jointinparent tendon site body cranksite slidersite refsite
actuator_trntype | mjtTrn | transmission | | joint jointinparent tendon site body cranksite slidersite
actuator_lengthrange | output length, rows nout | length range | m | lengthrange
actuator_length0 | output length, rows nout, computed
actuator_acc0 | output inertia, rows nout, computed
sensor_objid | id | object | | site joint tendon actuator body objname geom1 geom2 camera
sensor_refid | id | reference | | refname
sensor_type | mjtSensor | type
sensor_dim | order | number of values | | dim
sensor_noise | | noise | | noise
sensor_cutoff | | cutoff | | cutoff
sensor_adr | state address, order
sensor_datatype sensor_needstage | joints, computed
eq_data | global length | parameters | | anchor relpose polycoef torquescale
eq_active0 | switch | active | | active
eq_obj1id | id | first object | | body1 joint1 tendon1 site1 geom1 flex
eq_obj2id | id | second object | | body2 joint2 tendon2 site2 geom2
eq_solref | | softness (solref) | | solref
eq_solimp | | softness (solimp) | | solimp
eq_type | mjtEq
pair_dim | | condim | | condim
pair_signature | signature, joints
exclude_signature | id, joints
numeric_data | rows nnumericdata | numbers | | data
text_data | rows text_adr | text | | data
tuple_objtype tuple_objprm | rows ntupledata
plugin_attr | rows plugin_attradr
plugin_stateadr | state address, order
key_qpos | key | position | m; rad | qpos
key_qvel | key | velocity | m/s; rad/s | qvel
key_ctrl | key | control | | ctrl
key_act | key | activation | | act
key_mpos | key | position | m | mpos
key_mquat | key | orientation | | mquat
key_time | key time | time | s | time
key_plastic | key, 0
timestep | | timestep | s | timestep
gravity | | gravity | m/s² | gravity
wind | | wind | m/s | wind
density | | density of the medium | kg/m³ | density
viscosity | | viscosity of the medium | Pa·s | viscosity
bvh_aabb bvh_child bvh_depth bvh_nodeid | all volumes, order, rewritten
efm0_L efm0_L_colind efm0_L_rownnz efm0_dofid efmC_perm | factor, joints
efm0_L_rowadr | factor, order
names_map | names, order, rewritten
integrator | mjtIntegrator
cone | mjtCone
jacobian | mjtJacobian
solver | mjtSolver
opt.apirate | unread
opt.ccd_iterations | 35 50
opt.ccd_tolerance | 1e-06
opt.disableflags opt.enableflags | by name
opt.sleep_tolerance | 0.0001 0.001
tree_bodyadr tree_bodynum tree_dofadr tree_dofnum | trees, order
tree_sleep_policy | by root, order
vis.global.bvactive | 0 1
vis.global.cameraid | -1
vis.rgba.bv vis.rgba.bvactive | 0 0.5 1
vis.rgba.frustum | 0 0.2 1
vis.scale.frustum | 10
body_parentid | id | parent
jnt_bodyid | id | body
geom_bodyid | id | body
site_bodyid | id | body
cam_bodyid | id | body
light_bodyid | id | body
jnt_group geom_conaffinity geom_condim geom_contype geom_gap geom_group geom_margin geom_priority geom_solimp
geom_solmix geom_solref site_group cam_ipd cam_orthographic cam_sensorsize light_ambient light_attenuation
light_cutoff light_diffuse light_directional light_exponent light_specular mat_emission mat_reflectance
mat_shininess mat_specular mat_texrepeat tex_rgb skin_group skin_inflate skin_rgba flex_activelayers
flex_centered flex_conaffinity flex_condim flex_contype flex_dim flex_edgedamping flex_edgeequality
flex_edgestiffness flex_flatskin flex_friction flex_gap flex_group flex_margin flex_priority flex_radius
flex_rgba flex_rigid flex_selfcollide flex_solimp flex_solmix flex_solref tendon_group tendon_margin
actuator_cranklength actuator_group sensor_objtype sensor_reftype pair_friction pair_gap pair_margin pair_solimp
pair_solref pair_solreffriction plugin plugin_statenum
dof_dampingpoly jnt_springyield jnt_stiffnesspoly geom_adhesion geom_surfacevel cam_projection light_intensity | 0
flex_damping flex_internal flex_passive flex_plasticmode flex_yield tendon_dampingpoly tendon_springyield | 0
tendon_stiffnesspoly actuator_armature actuator_damping actuator_dampingpoly actuator_delay actuator_history | 0
sensor_delay sensor_history sensor_interval pair_adhesion opt.disableactuator tree_sleep | 0
vis.global.orthographic | 0
body_sameframe geom_sameframe site_sameframe | body frame, joints, computed
hfield_ncol hfield_nrow actuator_actnum center extent meaninertia meanmass meansize | computed
mesh_bvhadr mesh_faceadr mesh_normaladr mesh_octadr mesh_polyadr mesh_polymapadr | data address, order
mesh_polyvertadr mesh_vertadr tex_adr hfield_adr skin_boneadr skin_bonevertadr skin_faceadr | data address, order
skin_vertadr flex_bendingadr flex_bvhadr flex_edgeadr flex_elemadr flex_elemdataadr | data address, order
flex_elemedgeadr flex_nodeadr flex_shelldataadr flex_stiffnessadr flex_vertadr tendon_adr | data address, order
actuator_ctrladr actuator_outadr numeric_adr text_adr tuple_adr plugin_attradr | data address, order
mesh_texcoordadr skin_texcoordadr flex_texcoordadr | has data, order
jnt_plasticadr flex_plasticadr tendon_plasticadr actuator_actadr actuator_historyadr | has state, order
sensor_historyadr | has state, order
body_plugin geom_plugin skin_bonebodyid skin_matid flex_matid flex_vertbodyid tendon_matid actuator_plugin | id
sensor_plugin pair_geom1 pair_geom2 tuple_objid | id
tendon_type actuator_ctrlspec sensor_intprm eq_objtype | joints
body_dofnum body_jntnum mesh_bvhnum mesh_normalnum mesh_octnum mesh_texcoordnum tendon_num | order, computed
actuator_ctrlnum actuator_outnum numeric_size text_size tuple_size | order, computed
mesh_pathadr tex_contenttypeadr hfield_pathadr skin_pathadr | path, order
flexedge_J_colind flexedge_J_rownnz flexvert_J_colind flexvert_J_rownnz ten_J_colind | sparsity, joints
ten_J_rownnz B_colind B_rownnz D_colind D_diag D_rownnz M_colind M_rownnz mapD2M mapM2D mapM2M | sparsity, joints
flexedge_J_rowadr flexvert_J_rowadr ten_J_rowadr B_rowadr D_rowadr M_rowadr | sparsity, order
light_active light_castshadow mat_texuniform actuator_actearly | switch
body_invweight0 dof_M0 dof_invweight0 tendon_invweight0 | tree inertia
body_rootid body_treeid dof_parentid dof_treeid tendon_treeid tendon_treenum | tree, joints
body_user jnt_user geom_user site_user cam_user tendon_user actuator_user sensor_user | user
"""

_UNRANKED = 1 << 16


class ArrayInfo(Struct):
    """An array: its row of the table.

    ``treatment`` is the comparison between the numbers of a part alone and in a composition, ``single`` the comparison
    in MuJoCo 3 if it differs, and ``reason`` the reason. ``rows`` says which rows belong to an element, if there are
    several. ``version`` is the reason why the array is not compared between versions of MuJoCo; ``neutral`` are the
    numbers that have no meaning if only one of two versions has the array. ``unit`` is the unit for slides and for
    everything except joints, and ``angular`` is the unit for hinges if it differs. ``rank`` is the position in reports.
    """

    name: str
    traits: frozenset[str]
    treatment: Treatment
    single: Treatment
    reason: str
    rows: str
    version: str
    neutral: tuple[float, ...]
    enumeration: str
    words: str
    unit: str
    angular: str
    attributes: tuple[str, ...]
    rank: int

    @property
    def is_computed(self) -> bool:
        """Whether MuJoCo computes the array from other arrays that are compared."""
        return COMPUTED in self.traits or self.treatment in (Treatment.DERIVED, Treatment.SUBTREE)


ARRAYS: Mapping[str, tuple[str, int]] = {
    array: (line, rank)
    for rank, (arrays, _, line) in enumerate(row.partition("|") for row in _TABLE.strip().splitlines())
    for array in arrays.split()
}
"""The row of each array in any version of MuJoCo, without the names of arrays, and its number. `about` reads it."""


def _traits(line: str) -> frozenset[str]:
    return frozenset(line.partition("|")[0].strip().split(", ")) - {""}


def _info(array: str, line: str = "", rank: int = _UNRANKED) -> ArrayInfo:
    _, words, units, attributes = [*(cell.strip() for cell in line.split("|")), "", "", "", ""][:4]
    known = _traits(line)
    rows = next((each.removeprefix("rows ") for each in known if each.startswith("rows ")), "")
    default = ("data", "several rows an element") if rows else ("plain", "")
    treatment, reason, *single = next((_BEHAVIOURS[each] for each in known if each in _BEHAVIOURS), default)
    neutral = next((each for each in known if each.lstrip("-")[0].isdigit()), "")
    unit, _, angular = units.partition("; ")
    plain = array.partition("_")[2] or array
    return ArrayInfo(
        array,
        known,
        treatment=Treatment(treatment),
        single=Treatment(*single or (treatment,)),
        reason=reason,
        rows=rows,
        version=next((reason for each, reason in _BETWEEN_VERSIONS.items() if each in known), ""),
        neutral=tuple(map(float, neutral.split())),
        enumeration=next((each for each in known if each.startswith("mjt")), ""),
        words=words or plain.replace("_", " "),
        unit=unit,
        angular=angular,
        attributes=tuple(attributes.split()) if words else (plain,),
        rank=rank if words else _UNRANKED,
    )


@cache
def about(field: str) -> ArrayInfo:
    """Return the row of an array, which may have an index. An array that is not in the table gets a plain row.

    >>> about("geom_condim").words, about("jnt_range[1]").unit, about("geom_new").treatment
    ('condim', 'm', <Treatment.PLAIN: 'plain'>)
    """
    array = field.partition("[")[0]
    return _info(array, *ARRAYS.get(array, ()))


def with_trait(*traits: str) -> frozenset[str]:
    """Return the arrays with any of these traits.

    >>> sorted(with_trait("gain"))
    ['actuator_biasprm', 'dof_damping', 'jnt_stiffness']
    """
    return frozenset(array for array, (line, _) in ARRAYS.items() if not _traits(line).isdisjoint(traits))


ENUMS = frozenset(array for array, (line, _) in ARRAYS.items() if "mjt" in line and "_" in array)
"""The arrays whose numbers stand for words."""


def is_place(field: str) -> bool:
    """Return whether the array is a position or a state, for which a relative change has no meaning."""
    return field.endswith(("pos", "qpos0", "quat")) or field.startswith("key_")


def unit(field: str, form: str) -> str:
    """Return the unit of an array for a type of joint; none for free joints, whose numbers have several units.

    >>> unit("jnt_stiffness", "hinge"), unit("jnt_stiffness", "slide"), unit("key_qpos", "free")
    ('N·m/rad', 'N/m', '')
    """
    known = about(field)
    if form == "free" or (form == "ball" and field != "jnt_range"):
        return ""
    return known.angular if known.angular and form in ANGULAR else known.unit


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
    members: Mapping[str, Any] = getattr(mujoco, about(array).enumeration).__members__
    prefix = next(iter(members)).partition("_")[0] + "_"
    by_number = {
        int(value): name.removeprefix(prefix).lower() for name, value in members.items() if name.startswith(prefix)
    }
    return {number: _TAGS.get(name, name) if array == "sensor_type" else name for number, name in by_number.items()}
