"""How each array of `mjModel` is compared between two versions of MuJoCo, and what says nothing in it."""

from __future__ import annotations

from fnmatch import fnmatchcase
from functools import cache

_FOLLOWS: dict[str, str] = {
    "an address, a count or an order in the arrays of one version": (
        "*adr *_num bvh_* oct_* names_map body_bvh* mesh_bvh* flex_bvh* body_*num mesh_*num hfield_*num"
        " skin_*num flex_*num tendon_num sensor_dim tree_* flex_bandwidth flex_cellnum actuator_ctrlnum actuator_outnum"
        " tuple_size numeric_size text_size plugin_attradr name_*"
    ),
    "follows from joints, bodies and constraints, which are compared": (
        "body_rootid body_treeid dof_treeid dof_Madr dof_simplenum dof_length body_simple *sameframe jnt_actuatorid"
        " tendon_actuatorid tendon_tree* flg_* dof_parentid M_* B_* D_* map* ten_J_* flexedge_J_* flexvert_J_* efm*"
        " flexedge_rigid eq_objtype sensor_datatype sensor_needstage sensor_intprm actuator_ctrlspec tendon_type"
        " body_contype body_conaffinity body_margin pair_signature exclude_signature"
    ),
    "made of the triangles of a mesh, which are compared": (
        "mesh_normal mesh_facenormal mesh_poly* mesh_graph* mesh_extrema mesh_oct* mesh_scale mesh_vert"
        " mesh_facetexcoord mesh_pos mesh_quat geom_aabb"
    ),
    "made of the vertices and elements of a flex, which are compared": (
        "flex_elemedge* flex_evpair* flex_vertedge* flex_vertmetric flex_edgeflap flex_size flex_vertcell flex_shell*"
        " flex_elemlayer flex_node flex_node0 flex_nodebodyid flex_elemtexcoord flex_interp flex_xvert0 flex_vert0"
    ),
    "how a texture is stored": "tex_nchannel tex_height tex_width",
    "compared by name": "opt.disableflags opt.enableflags",
    "read by nothing": "opt.apirate light_softness",
}

_NEUTRAL: dict[str, tuple[float, ...]] = {
    **dict.fromkeys(
        "opt.disableactuator jnt_actgravcomp cam_projection vis.global.orthographic flex_damping tendon_actfrclimited"
        " tendon_actfrcrange tendon_armature light_intensity flex_passive actuator_delay actuator_history sensor_delay"
        " sensor_history sensor_interval actuator_armature actuator_damping actuator_dampingpoly jnt_stiffnesspoly"
        " dof_dampingpoly tendon_stiffnesspoly tendon_dampingpoly geom_adhesion geom_surfacevel pair_adhesion"
        " flex_plasticmode flex_yield jnt_springyield tendon_springyield key_plastic flex_bending flex_stiffness"
        " flex_internal tree_sleep".split(),
        (0.0,),
    ),
    **dict.fromkeys(
        "light_texid vis.global.cameraid site_dataid flex_plasticadr jnt_plasticadr tendon_plasticadr"
        " actuator_historyadr sensor_historyadr mesh_octadr".split(),
        (-1.0,),
    ),
    "light_bulbradius": (0.02,),
    "light_range": (10.0,),
    "mat_metallic": (-1.0, 0.0, 1.0),
    "mat_roughness": (-1.0, 1.0),
    "tex_colorspace": (0.0, 1.0),
    "cam_output": (1.0,),
    "geom_castshadow": (1.0,),
    "vis.scale.frustum": (10.0,),
    "vis.rgba.frustum": (0.0, 0.2, 1.0),
    "vis.rgba.bv": (0.0, 0.5, 1.0),
    "vis.rgba.bvactive": (0.0, 0.5, 1.0),
    "vis.global.bvactive": (0.0, 1.0),
    "opt.sleep_tolerance": (0.0001, 0.001),
    "opt.ccd_iterations": (35.0, 50.0),
    "opt.ccd_tolerance": (1e-6,),
}
"""What a field holds that one of two versions lacks, where the model does as if it were not there."""

UNSAID = frozenset({"mat_metallic", "mat_roughness"})
"""Fields whose neutral values mean the same in all versions that have them: what no renderer of MuJoCo read then."""

FLAGS = {"nativeccd": False, "multiccd": False, "island": False, "autoreset": True, "sleep": False, "diagexact": False,
         "ipc": False, "speculative": False, "sensornoise": False, "spring": True, "damper": True}  # fmt: skip
"""What a version does that does not have the flag."""


@cache
def follows(array: str) -> bool:
    """Whether an array is made of others that are compared."""
    if array == "nnames_map" or (array.startswith("n") and "_" not in array):
        return True  # a count: `nbody`
    return any(fnmatchcase(array, pattern) for patterns in _FOLLOWS.values() for pattern in patterns.split())


def neutral(array: str) -> tuple[float, ...] | None:
    """The numbers that say nothing in an array that one of the versions lacks; None where that is not known."""
    return _NEUTRAL.get(array)
