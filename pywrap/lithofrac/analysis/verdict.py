"""The words of a verdict on a quantity that was given a band beforehand."""

HOLDS, FAILS, OPEN = "holds", "does not hold", "cannot be checked"


def verdict(good: bool) -> str:
    """Word for a condition that can be checked."""
    return HOLDS if good else FAILS
