"""Config files: read, checked at once, turned into SI numbers.

Only this package reads YAML and knows units other than SI.
"""

from lithofrac.config.case import Case, load_case
from lithofrac.config.cost import predicted
from lithofrac.config.errors import ConfigError
from lithofrac.config.material import Material
from lithofrac.config.suite import Suite, find_case, load_suite

__all__ = [
    "Case",
    "ConfigError",
    "Material",
    "Suite",
    "find_case",
    "load_case",
    "load_suite",
    "predicted",
]
