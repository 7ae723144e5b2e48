"""A first table of cohesion, friction and dilation, read off measured stress-strain curves.

Plastic strains are measured strains less elastic ones; at equal plastic strain the stresses of all
tests lie on a line, which gives cohesion and friction there (Klerck, Sellers & Owen 2004, eq. 6).
`rock_fit` starts from it.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.stats import linregress

from lithofrac.data.triaxial import Triaxial

ELASTIC_PART = 0.2  # of the stress difference at the peak: below it a curve counts as elastic
FEWEST = 4  # rows of a straight piece of a curve
BENT = 0.5  # of the squared misses of one line: two lines that leave less show a bend, not noise
GRID = 400  # plastic strains at which the curves are compared
NEAREST = 0.03  # of the largest plastic strain: rows stand no closer, and none so near to 0
CLOSE = 0.02  # of the range of a column: a table this near to the curves needs no further row
BEYOND = 1.05  # a row may lie this far beyond the estimated end of the curves
WINDOW = GRID // 10  # of the grid, over which the slope of the volume is taken
STEEPEST = 70.0  # largest angle of a start [degrees]


@dataclass(frozen=True)
class Start:
    """Columns of a first table, (k,) each; MPa and degrees."""

    plastic_strain: np.ndarray
    cohesion: np.ndarray
    friction: np.ndarray
    dilation: np.ndarray


def one_row(tests: list[Triaxial]) -> Start:
    """Row without dilation from the strengths alone."""
    strength = np.array([[test.strength_MPa] for test in tests])
    cohesion, friction = _line(strength, np.array([test.confinement_MPa for test in tests]))
    return Start(np.zeros(1), cohesion, friction, np.zeros(1))


def elastic_constants(tests: list[Triaxial]) -> tuple[float, float]:
    """Young's modulus [MPa] and Poisson's ratio from the first part of the curves.

    Medians of the tests. The ratio is NaN where no test has lateral strains.
    """
    moduli, ratios = _elastic_lines(tests)
    slopes = [[line.slope for line in lines] for lines in (moduli, ratios)]
    return float(np.median(slopes[0])), float(np.median(slopes[1])) if ratios else float("nan")


def elastic_errors(tests: list[Triaxial]) -> tuple[float, float]:
    """Standard errors of `elastic_constants`, those of a mean of lines; 0 where there is none."""
    moduli, ratios = (np.array([line.stderr for line in lines]) for lines in _elastic_lines(tests))
    return tuple(float(np.linalg.norm(own) / max(own.size, 1)) for own in (moduli, ratios))


def _elastic_lines(tests: list[Triaxial]) -> tuple[list, list]:
    """Lines of stress difference and of lateral strain over the elastic part of each curve."""
    moduli, ratios = [], []
    for test in tests:
        last = _elastic_rows(test)
        strain = test.axial_strain[:last]
        moduli.append(linregress(strain, test.axial_stress_MPa[:last] - test.confinement_MPa))
        if test.lateral_strain is not None:
            ratios.append(linregress(strain, test.lateral_strain[:last]))
    return moduli, ratios


def _elastic_rows(test: Triaxial) -> int:
    """Number of first rows that count as elastic.

    Those below `ELASTIC_PART`; where two lines with a bend between them show that the curve has
    yielded there already, those before the bend.
    """
    strain, stress = test.axial_strain, test.axial_stress_MPa - test.confinement_MPa
    last = max(int(np.argmax(stress > ELASTIC_PART * stress.max())), 3)
    if last < 2 * FEWEST:
        return last
    near = max(FEWEST, last // 4)  # a shorter piece has the slope of its noise
    bends = range(near, last - near + 1)
    pieces = [(_straight(strain[:n], stress[:n]), _straight(strain[n:last], stress[n:last]))
              for n in bends]  # fmt: skip
    best = int(np.argmin([first[1] + second[1] for first, second in pieces]))
    (before, missed), (after, missed_too) = pieces[best]
    bent = missed + missed_too < BENT * _straight(strain[:last], stress[:last])[1]
    return bends[best] if bent and after < before else last


def _straight(strain: np.ndarray, stress: np.ndarray) -> tuple[float, float]:
    """Slope of the line through points, and the sum of its squared misses."""
    line = np.polyfit(strain, stress, 1)
    return float(line[0]), float(np.sum((np.polyval(line, strain) - stress) ** 2))


def plastic_parts(test: Triaxial, young: float, poisson: float, dilation: np.ndarray) -> tuple:
    """Axial, lateral and effective plastic strain of a curve, (n,) each, none negative.

    Without lateral strains the lateral part follows from the flow rule and the dilation angles
    (2, k): plastic strains and degrees.
    """
    elastic = (test.axial_stress_MPa - test.confinement_MPa) / young
    axial = np.maximum(test.axial_strain - elastic, 0.0)
    if test.lateral_strain is None:
        sine = np.sin(np.radians(dilation[1]))
        swells = (1.0 + sine) / (1.0 - sine)  # twice the lateral over the axial strain
        effective = np.linspace(0.0, axial.max() * _per_axial(swells.max()), GRID)
        swells = np.interp(effective, dilation[0], swells)
        per_axial = cumulative_trapezoid(1.0 / _per_axial(swells), effective, initial=0.0)
        effective = np.maximum.accumulate(np.interp(axial, per_axial, effective))
        return axial, np.sqrt(np.maximum(0.75 * effective**2 - 0.5 * axial**2, 0.0)), effective
    lateral = np.maximum(test.lateral_strain - poisson * elastic, 0.0)
    effective = np.sqrt(2.0 / 3.0 * (axial**2 + 2.0 * lateral**2))  # eq. 7 on a straight path
    return axial, lateral, np.maximum.accumulate(effective)


def _per_axial(swells):
    """Effective over axial plastic strain (eq. 7), from twice the lateral over the axial one."""
    return np.sqrt((2.0 + swells**2) / 3.0)


def first_table(
    tests: list[Triaxial], young: float, poisson: float, dilation: np.ndarray, most_rows: int
) -> Start:
    """Table with rows at both ends, at the peak and where the curves bend most.

    It has at most `most_rows`, 3 or more, and ends where fewer than two confinements are left to
    tell cohesion from friction.

    Parameters
    ----------
    tests : with curves, at two confinements or more
    young, poisson : elastic constants [MPa], [-]
    dilation : (2, k) plastic strains and angles [degrees], for tests without lateral strains

    Raises
    ------
    ValueError
        When fewer than two confinements leave the elastic range.
    """
    columns = _columns(tests, young, poisson, dilation)
    grid = columns[0]
    peak = int(np.searchsorted(grid, _at_peak(tests, young, poisson, dilation)))
    inside = NEAREST * grid[-1] < grid[min(peak, GRID - 1)] < (1.0 - NEAREST) * grid[-1]
    rows = [0, *([peak] if inside else []), GRID - 1]
    while len(rows) < most_rows:
        miss = np.zeros(GRID)
        for column in columns[1:]:
            interpolated = np.interp(grid, grid[rows], column[rows])
            miss = np.maximum(miss, np.abs(column - interpolated) / max(np.ptp(column), 1e-9))
        near = np.abs(grid[:, None] - grid[rows]).min(axis=1) < NEAREST * grid[-1]
        miss[near] = 0.0
        if miss.max() < CLOSE:
            break
        rows = sorted([*rows, int(np.argmax(miss))])
    return Start(*(column[rows] for column in columns))


def table_at(
    knots: np.ndarray, tests: list[Triaxial], young: float, poisson: float, dilation: np.ndarray
) -> Start:
    """Table with rows at given plastic strains; other arguments as of `first_table`.

    Raises
    ------
    ValueError
        When a row lies beyond what two confinements have reached.
    """
    columns = _columns(tests, young, poisson, dilation)
    last = columns[0][-1]
    if knots[-1] > BEYOND * last:
        raise ValueError(
            f"{knots[-1]:g} lies beyond the plastic strain that the curves of two confinements "
            f"reach, expected at most {last:.3g}"
        )
    at_knots = (np.interp(knots, columns[0], column) for column in columns[1:])
    return Start(np.asarray(knots, dtype=float), *at_knots)


def _columns(tests, young, poisson, dilation) -> list[np.ndarray]:
    """Plastic strain, cohesion, friction and dilation on a fine grid."""
    parts = [plastic_parts(test, young, poisson, dilation) for test in tests]
    # Finer near the start, which is no nearer to 0 than an error of the elastic strain.
    grid = np.linspace(np.sqrt(NEAREST / 3.0), 1.0, GRID) ** 2 * _last_shared(tests, parts)
    stress, confinement, axial, lateral = [], [], [], []
    for test, (own_axial, own_lateral, effective) in zip(tests, parts, strict=True):
        reached = grid <= effective[-1]
        yields = _increasing(effective)
        for collected, values in (
            (stress, test.axial_stress_MPa),
            (axial, own_axial),
            (lateral, own_lateral),
        ):
            on_grid = np.interp(grid, effective[yields], values[yields])
            collected.append(np.where(reached, on_grid, np.nan))
        confinement.append(test.confinement_MPa)
    cohesion, friction = _line(np.array(stress), np.array(confinement))
    ratio = _slope(2.0 * np.array(lateral) - np.array(axial), grid) / np.maximum(
        _slope(np.array(axial), grid), 1e-9
    )
    sine = np.clip(ratio / (2.0 + np.maximum(ratio, 0.0)), 0.0, np.sin(np.radians(STEEPEST)))
    grid[0] = 0.0
    return [grid, cohesion, friction, np.degrees(np.arcsin(sine))]


def _at_peak(tests: list[Triaxial], young: float, poisson: float, dilation: np.ndarray) -> float:
    """Plastic strain at the strength, median of the tests."""
    strains = [plastic_parts(test, young, poisson, dilation)[2] for test in tests]
    peaks = [int(np.argmax(test.axial_stress_MPa)) for test in tests]
    return float(np.median([own[i] for own, i in zip(strains, peaks, strict=True)]))


def _slope(strains: np.ndarray, grid: np.ndarray) -> np.ndarray:
    """Mean slope (m,) of strains (tests, m) on the grid, over `WINDOW`; NaN left out."""
    rows = np.arange(GRID)
    low, high = np.maximum(rows - WINDOW // 2, 0), np.minimum(rows + WINDOW // 2, GRID - 1)
    rise = strains[:, high] - strains[:, low]
    rise = np.where(np.isfinite(rise), rise, strains - strains[:, low])  # a test ends inside
    return np.nanmean(rise, axis=0) / (grid[high] - grid[low])


def _last_shared(tests: list[Triaxial], parts: list[tuple]) -> float:
    """Largest plastic strain that two confinements have reached."""
    reached: dict[float, float] = {}
    for test, (_, _, effective) in zip(tests, parts, strict=True):
        known = reached.get(test.confinement_MPa, 0.0)
        reached[test.confinement_MPa] = max(known, float(effective[-1]))
    last = sorted(reached.values())[-2]
    if not last > 0.0:
        raise ValueError("the curves of fewer than two confinements leave the elastic range")
    return last


def _increasing(values: np.ndarray) -> np.ndarray:
    """Last row of each run of equal values: where a plastic strain is first left again."""
    return np.append(np.diff(values) > 0.0, True)


def _line(stress: np.ndarray, confinement: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cohesion and friction [degrees] (m,) of lines through stresses (tests, m), NaN left out."""
    number, intercept = np.ones(stress.shape[1]), np.ones(stress.shape[1])
    for i, column in enumerate(stress.T):
        known = np.isfinite(column)
        if np.ptp(confinement[known]) > 0.0:
            number[i], intercept[i] = np.polyfit(confinement[known], column[known], 1)
        elif i:
            number[i], intercept[i] = number[i - 1], intercept[i - 1]
    number = np.maximum(number, 1.0)
    friction = np.degrees(np.arcsin((number - 1.0) / (number + 1.0)))
    cohesion = np.maximum(intercept, 0.0) / (2.0 * np.sqrt(number))
    return cohesion, np.minimum(friction, STEEPEST)
