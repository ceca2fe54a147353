"""Where to grasp, from what a depth camera sees."""
