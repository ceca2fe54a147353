"""A trial in the terms of ROS 2: run as an action, told on topics, kept as a bag."""
