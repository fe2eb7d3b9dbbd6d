"""Synonyms of keys and attributes, from other formats, from tools and from English."""

from __future__ import annotations

_BY_NAME: dict[str, str] = {
    # attributes of MJCF
    "rgba": "color colour rgb diffuse_color tint alpha opacity transparency",
    "pos": "position translation xyz location origin offset coordinate",
    "quat": "rotation orientation quaternion rot",
    "euler": "rpy rotation orientation euler_angle rotate",
    "size": "radius diameter dimension dim extent half_size halfsize half_extent box_size",
    "type": "shape geometry kind primitive",
    "range": "limit joint_limit bound lower_limit upper_limit lower upper",
    "ctrlrange": "limit control_range control_limit ctrl_range range",
    "forcerange": "effort max_force maxforce force_limit max_torque torque_limit effort_limit",
    "actuatorfrcrange": "effort max_force maxforce force_limit max_torque torque_limit effort_limit",
    "file": "filename path uri url src mesh_file",
    "stiffness": "spring spring_constant spring_stiffness",
    "damping": "damper viscous_friction",
    "frictionloss": "friction dry_friction coulomb_friction",
    "armature": "rotor_inertia reflected_inertia",
    "mass": "weight",
    "diaginertia": "inertia moment_of_inertia",
    "fovy": "fov field_of_view",
    "gear": "gear_ratio transmission_ratio",
    "kp": "gain p_gain stiffness proportional_gain",
    "kv": "d_gain damping_gain derivative_gain",
    "timestep": "dt time_step step_size",
    "axis": "direction rotation_axis",
    "dir": "direction",
    "childclass": "default_class defaults",
    "class": "default_class defaults dclass",
    "contype": "collision collide collision_group",
    "name": "id identifier",
    # keys of a recipe
    "model": "file path xml source src url uri mjcf urdf",
    "body": "parent parent_body link",
    "site": "mount attach_to to on at parent_site",
    "mate": "child_site own_site",
    "with": "param parameter arg argument value",
    "drop": "remove exclude without omit ignore",
    "edit": "modify patch override change overlay",
    "attach": "part component attachment child",
    "extends": "extend inherit inherits parent import",
    "params": "variable parameter arg argument",
    "matrix": "sweep grid",
    "check": "test assert assertion verify expect",
    "keyframe": "key pose home",
    "randomize": "randomise randomization randomisation domain_randomization",
    "recipe": "version",
    "angle": "unit angle_unit",
    "replicate": "repeat copy",
    "freejoint": "free floating",
}
"""By the name that exists here, what is written for it, in singular and with `_`. Several names may share a word."""

SYNONYMS: dict[str, list[str]] = {}
"""The names that a word may mean, in the order of the table."""
for _name, _words in _BY_NAME.items():
    for _word in _words.split():
        SYNONYMS.setdefault(_word, []).append(_name)
