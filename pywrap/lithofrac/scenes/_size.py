"""Size field of a mesh, with a small smooth modulation that a seed sets.

Each seed gives another mesh of the same density, and always the same one.
"""

import numpy as np

AMPLITUDE = 0.01  # of the element size, per wave
WAVES = 3


def jittered(size: str, length: float, seed: int) -> str:
    """Background size field of a .geo.

    Parameters
    ----------
    size : nominal edge length [m] as a gmsh formula in x and y
    length : a typical edge length [m]; the waves are some ten of it long
    seed : realisation
    """
    random = np.random.default_rng(seed)
    factor = "1"
    for _ in range(WAVES):
        angle, phase = random.uniform(0, 2 * np.pi, 2)
        k = 2 * np.pi / (length * random.uniform(5, 15))
        kx, ky = k * np.cos(angle), k * np.sin(angle)
        factor += f" + {AMPLITUDE}*Sin(({kx:.12g})*x + ({ky:.12g})*y + {phase:.12g})"
    return f"""\
Field[1] = MathEval;
Field[1].F = "({size})*({factor})";
Background Field = 1;
"""
