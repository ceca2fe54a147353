"""Robots for tpvqa: a simulated arm that picks, places and finds by physics."""

DISTRIBUTION = "tpvqa-robots"
