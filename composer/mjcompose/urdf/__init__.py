"""URDF and xacro become units."""
