"""The Bayes filter over joint states: how it begins, and what actions do to it."""
