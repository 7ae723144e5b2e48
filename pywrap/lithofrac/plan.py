"""What a run will use, leave out and take, before its first step."""

from __future__ import annotations

import math

from lithofrac.config.cost import rate_of, run_seconds
from lithofrac.core import Run
from lithofrac.problem import Problem


def plan(problem: Problem) -> dict:
    """What a run will use and what it leaves out.

    Returns
    -------
    dict
        elements, nodes, bodies, time_step_s, steps, expected_seconds (one core), and
        `uses`: feature -> bool.

    Raises
    ------
    CoreError
        Where the core refuses the problem, or parts overlap at the start.
    """
    run = Run(problem)
    if problem.contact is None:  # which looks for itself
        run.refuse_overlap()
    elements = len(problem.mesh.triangles)
    steps = math.ceil(problem.end_time / run.dt)
    return {
        "elements": elements,
        "nodes": len(problem.mesh.nodes),
        "bodies": len(problem.mesh.body_names),
        "time_step_s": run.dt,
        "steps": steps,
        "expected_seconds": expected_seconds(problem, steps),
        "uses": {
            "axisymmetry": problem.axisymmetric,
            "yield check": any(m.options[3] for m in problem.materials),
            "Mohr-Coulomb planes": any(m.options[3] and m.options[2] for m in problem.materials),
            "regularised softening": any(m.reference_width > 0.0 for m in problem.materials),
            "damping": problem.damping.fraction > 0.0 or bool(problem.damping.alpha),
            "pressure": bool(problem.pressure_loads),
            "contact": problem.contact is not None,
            "crack insertion": problem.fracture is not None,
            "probes": bool(problem.probes),
            "field output": problem.fields > 0,
        },
    }


def expected_seconds(problem: Problem, steps: int) -> float:
    """Time that so many steps are expected to take on one core [s]."""
    confined = any(load.pressure > 0.0 for load in problem.pressure_loads)
    options = [material.options for material in problem.materials]
    rate = rate_of(options, problem.contact is not None, problem.axisymmetric, confined)
    elements = len(problem.mesh.triangles)
    return run_seconds(elements, steps, problem.records, problem.fields, rate)
