"""The rules for comparing each array of `mjModel` between a part and its composition.

An array that is in no table here is *plain*: one row for each element, the same alone and composed, bit for bit.
Everything else has its treatment and the reason for it in ``RULES``.
"""

from __future__ import annotations

from enum import StrEnum

from composer.dataclass import dataclass


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
