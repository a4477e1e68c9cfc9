"""Kreskowski, Rendle, Froehlich: Efficient Direct Isosurface Rasterization of Scalar Volumes, 2022: Figures 1, 6, 7 and 8 and
the claims of section 4."""
