"""The toys' table: a scene with a robot, its cameras, and what is true in it."""
