"""Messages, services and actions of ROS 2: their definitions, and how they are built."""
