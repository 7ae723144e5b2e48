"""Scenes: a checked case becomes a mesh and, with it, a problem in SI units."""

from lithofrac.scenes._gmsh import MeshError
from lithofrac.scenes.make import make_mesh, make_problem

__all__ = ["MeshError", "make_mesh", "make_problem"]
