"""What was stated or measured elsewhere: the files below `data/`, read and checked.

Errors are sentences that name file, key or line, value, and what was expected (`DataError`).
"""

from lithofrac.data.digitised import Curve, load_curves
from lithofrac.data.errors import DataError
from lithofrac.data.measured import measured_strength

__all__ = ["Curve", "DataError", "load_curves", "measured_strength"]
