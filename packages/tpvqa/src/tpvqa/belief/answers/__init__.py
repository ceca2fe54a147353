"""What answers are worth: how they err, how errors last, and what was heard."""
