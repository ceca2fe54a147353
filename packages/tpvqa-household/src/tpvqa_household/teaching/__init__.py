"""A user's labelled pictures → questions that the embedded network answers, of any domain."""
