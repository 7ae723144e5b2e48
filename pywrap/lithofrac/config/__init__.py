"""Config files: read, checked at once, turned into SI numbers.

Only this package reads YAML and knows units other than SI.
"""

from lithofrac.config.errors import ConfigError
from lithofrac.config.material import Material

__all__ = ["ConfigError", "Material"]
