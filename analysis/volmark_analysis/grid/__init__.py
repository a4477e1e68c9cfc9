"""Grids on many machines: hands out batches of points, to Dask workers or by a Slurm script. Which points are done is told by
their result files alone, so nothing is lost or measured twice whatever is killed, and the same command goes on."""
