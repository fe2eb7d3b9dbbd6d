"""An upper body with two arms: each arm is a model of its own, made by one function and attached twice.

python docs/examples/two_arms.py
"""

from __future__ import annotations

from mjcompose import mjcf

LENGTH = 0.3  # of each half of an arm, in meters


def make_arm(name: str) -> mjcf.RootElement:
    """A shoulder with three degrees of freedom, an elbow, and a motor for the elbow."""
    arm = mjcf.RootElement(name)
    upper = arm.worldbody.add("body", name="upper")
    upper.add("joint", name="shoulder", type="ball", damping=0.5)
    upper.add("geom", name="upper", type="capsule", size=[0.04], fromto=[0, 0, 0, 0, 0, -LENGTH])
    fore = upper.add("body", name="fore", pos=[0, 0, -LENGTH])
    elbow = fore.add("joint", name="elbow", axis=[0, 1, 0], range=[-150, 0], damping=0.5)
    fore.add("geom", name="fore", type="capsule", size=[0.03], fromto=[0, 0, 0, 0, 0, -LENGTH])
    fore.add("site", name="hand", pos=[0, 0, -LENGTH])
    arm.actuator.add("position", name="elbow", joint=elbow, kp=20, ctrlrange=[-2.6, 0])
    return arm


class UpperBody:
    """A chest on a post, with an arm on each side."""

    def __init__(self, name: str = "body") -> None:
        self.model = mjcf.RootElement(name)
        chest = self.model.worldbody.add("body", name="chest", pos=[0, 0, 1.2])
        chest.add("geom", name="chest", type="box", size=[0.1, 0.2, 0.25])
        self.arms = {}
        for side, y in (("left", 0.25), ("right", -0.25)):
            shoulder = chest.add("site", name=f"{side}_shoulder", pos=[0, y, 0.2])
            self.arms[side] = make_arm(side)
            shoulder.attach(self.arms[side])


def main() -> None:
    body = UpperBody()
    left = body.arms["left"]
    right = body.arms["right"]

    # An arm is still a model of its own: what is changed there is changed in the whole.
    right.find("geom", "fore").rgba = [0.8, 0.2, 0.2, 1]
    print(body.model.find("joint", "left/elbow") is left.find("joint", "elbow"))

    # What both arms have is asked for once, on the whole.
    physics = body.model.compile_model()
    elbows = physics.bind([arm.find("joint", "elbow") for arm in (left, right)])
    hands = physics.bind([arm.find("site", "hand") for arm in (left, right)])
    physics.bind(left.find("actuator", "elbow")).ctrl = -1.5
    physics.step(1000)
    physics.forward()
    print("elbows (rad):", elbows.qpos.round(2))
    print("hands (m):", *hands.xpos.round(2).tolist())


if __name__ == "__main__":
    main()
