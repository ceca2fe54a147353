"""Programs that are not ours, each in a process of its own: what they do to it ends there."""
