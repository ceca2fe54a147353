"""A kitchen, rendered; falls are physical: MuJoCo draws it and moves what falls, nothing else."""
