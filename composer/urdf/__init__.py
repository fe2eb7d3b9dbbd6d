"""URDF and xacro become MJCF: MuJoCo reads most, and the rest is added where MJCF has words for it."""
