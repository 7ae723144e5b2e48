"""Bad data files."""


class DataError(ValueError):
    """A file below `data/` is wrong; one sentence: file, key or line, value, what was expected."""
