"""The ViPlan benchmark's problems, and what its grounder and others reach on them."""
