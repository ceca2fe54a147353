"""What is learned while it acts: how often actions, skills and their reports fail."""
