"""A robot behind ROS 2 topics: the world `ros2`, and a skill server for any `Robot`.

Standard messages alone are used, so nothing has to be built: see docs/robots-ros2.md.
"""
