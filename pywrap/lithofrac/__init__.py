"""lithofrac: an open validation and benchmark suite for rock fracture."""

__version__ = "0.1.0"
