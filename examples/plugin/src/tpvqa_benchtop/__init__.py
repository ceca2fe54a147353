"""A plug-in for tpvqa: a VLM, a world, a planner and a monitor."""
