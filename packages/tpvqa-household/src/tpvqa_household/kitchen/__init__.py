"""A kitchen, rendered and physical: MuJoCo draws it and moves what falls."""
