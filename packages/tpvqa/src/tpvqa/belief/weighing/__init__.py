"""Answers and readings as evidence, and what is expected of further ones."""
