"""Searches over the points of a grid: the best of each scene, Pareto fronts of error against time, successive halving. A
difference that is smaller than its uncertainty is called a tie."""
