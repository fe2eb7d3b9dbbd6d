"""The commands of joints in `<ros2_control>` of a URDF, as a ROS system reads them: at the joints, without a gear."""

from xml.etree import ElementTree

_INPUTS = {"effort": "force", "position": "position", "velocity": "velocity"}


def commands(file):
    """Return the input of each commanded joint, with its range and the gains of its servo."""
    found = {}
    tree = ElementTree.parse(file)  # nosec B314  # mjcompose wrote the model, without a document type
    for joint in tree.iterfind("ros2_control/joint"):
        gains = {each.get("name"): float(each.text) for each in joint.iterfind("param")}
        for interface in joint.iterfind("command_interface"):
            ends = {each.get("name"): float(each.text) for each in interface.iterfind("param")}
            word = _INPUTS[interface.get("name")]
            found[joint.get("name")] = {
                "input": word, "control": [ends["min"], ends["max"]] if ends else None,
                "kp": gains.get("kp", 0.0), "kd": gains.get("kv" if word == "velocity" else "kd", 0.0),
            }  # fmt: skip
    return found
