"""The one kind of error that a user of this package can cause."""


class InputError(Exception):
    """Bad input: one line that names the file, the place, what was found and what is allowed."""
