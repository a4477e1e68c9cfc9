"""What users, and the disks they use, can cause."""


class InputError(Exception):
    """Bad input: one line that names the file, the place, what was found and what is allowed."""


class DamagedFile(InputError):
    """A file that volmark wrote is cut off or overwritten: its run is left out and named, the others count."""
