"""A model as a ROS package: URDF with `ros2_control`, and SRDF."""
