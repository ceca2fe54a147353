"""Robosuite's door: its handle is gripped, turned and pulled."""
