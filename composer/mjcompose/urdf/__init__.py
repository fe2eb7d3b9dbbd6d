"""Convert URDF and xacro to units."""
