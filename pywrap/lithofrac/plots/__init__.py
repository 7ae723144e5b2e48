"""Figures of the report. The only package that imports matplotlib."""

from lithofrac.plots.draw import draw

__all__ = ["draw"]
