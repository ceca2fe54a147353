"""Answers → what is probably true, and what cannot be true together."""
