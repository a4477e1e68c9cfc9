"""What scenes/fetch.py is made of: scenes, voxels, sources, downloads. Python's standard library only."""


class FetchError(Exception):
    """One line for the user."""
