"""Robosuite's pick-and-place: milk, bread, cereal and a can go from one bin into four others."""
