"""The commands of joints in `<ros2_control>` of a URDF, as a ROS system reads them: at the joints, without a gear."""

from xml.etree import ElementTree

_INPUTS = {"effort": "force", "position": "position", "velocity": "velocity"}
_GAINS = ("kp", "kd", "kv")


def commands(file):
    """Return the input of each commanded joint, with its range and the gains of its servo."""
    found = {}
    tree = ElementTree.parse(file)  # nosec B314  # mjcompose wrote the model, without a document type
    for joint in tree.iterfind("ros2_control/joint"):
        gains = {each.get("name"): float(each.text) for each in joint.iterfind("param") if each.get("name") in _GAINS}
        for interface in joint.iterfind("command_interface"):
            ends = {each.get("name"): float(each.text) for each in interface.iterfind("param") if each.text}
            word = _INPUTS.get(interface.get("name"))
            if word is None:
                continue
            found[joint.get("name")] = {
                "input": word,
                "control": [ends["min"], ends["max"]] if {"min", "max"} <= ends.keys() else None,
                "kp": gains.get("kp", 0.0),
                "kd": gains.get("kv" if word == "velocity" else "kd", 0.0),
            }
    return found
