"""Table of cohesion, friction and dilation from triaxial tests, by bounded least squares.

A test with a curve is driven on the point bench (`lithofrac.point`) through its measured axial
strains; its stresses, and lateral strains where they were measured, are compared. The strength of
every test is compared with the closed form that the bench meets. Stresses are
divided by the mean strength and lateral strains by the largest measured one, so that both count.

Confidence intervals are those of the linear model at the solution: (J^T J)^-1 times the variance of
the residuals, Student's t. What was read off the curves before, and held, adds what an error of its
own does to the solution (two-step estimation, Murphy & Topel 1985): next to 0 the plastic strain is
a small difference of the measured and the elastic one, so Young's modulus decides the first rows.
Intervals take points as independent, which those of one curve are not, and say nothing of a law
that does not fit: look at the residuals first.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import stats
from scipy.optimize import OptimizeResult, least_squares

from lithofrac.analysis.mohr_coulomb import peak_strength
from lithofrac.analysis.rock_start import Start
from lithofrac.config.material import Material
from lithofrac.data.triaxial import Triaxial
from lithofrac.errors import CoreError

MPA = 1e6
POINTS = 50  # of a curve, at most
SUBSTEPS = 4  # of the bench from point to point: quartzite 0.13 % off, with one 0.7 %
STRENGTH = 10  # points of a curve that the strength of a test counts for
CONFIDENCE = 0.95
BAND = 1e-3  # crack band width of the bench [m], if its limit allows
MOST_TRIALS = 25  # steps of the least squares
STEEPEST = 75.0  # upper bound of the angles [degrees]


@dataclass(frozen=True)
class Unknowns:
    """What is fitted.

    base : rock whose other keys stay
    keys : key of `Material` and row of the table of each unknown
    start, low, high : (n,) values in the units of the keys
    """

    base: Material
    keys: tuple[tuple[str, int], ...]
    start: np.ndarray
    low: np.ndarray
    high: np.ndarray

    def rock(self, values: np.ndarray) -> Material:
        """The base with these values."""
        changed: dict = {}
        for (key, row), value in zip(self.keys, values, strict=True):
            changed.setdefault(key, list(getattr(self.base, key)))[row] = float(value)
        tables = {k: tuple(v) if isinstance(v, list) else v for k, v in changed.items()}
        return self.base.model_copy(update=tables)


@dataclass(frozen=True)
class RockFit:
    """A fitted rock.

    parameters : columns quantity, plastic_strain, value, plus_minus (half-width of the interval,
        NaN where there is none), lower_bound, upper_bound, note
    strengths : one row a test: test, confinement_MPa, role (fitted or predicted), strength_MPa,
        computed_MPa, difference_percent
    points : compared points of curves, fitted or predicted: test, confinement_MPa, role,
        axial_strain, quantity, measured, computed
    converged : whether the least squares came to an end before `MOST_TRIALS`
    """

    rock: Material
    parameters: pd.DataFrame
    strengths: pd.DataFrame
    points: pd.DataFrame
    converged: bool

    def residuals(self) -> pd.DataFrame:
        """Strengths and points of curves, one row each; strains are empty for strengths."""
        names = {"strength_MPa": "measured", "computed_MPa": "computed"}
        strengths = self.strengths.rename(columns=names).drop(columns="difference_percent")
        both = pd.concat([strengths.assign(quantity="strength_MPa"), self.points])
        both = both.assign(difference=both["computed"] - both["measured"])
        first = ["test", "confinement_MPa", "role", "quantity"]
        return both[[*first, *(name for name in both if name not in first)]]

    def error_percent(self, role: str) -> tuple[float, float, float]:
        """Rms and largest difference of the strengths of a role, and where the largest stands."""
        rows = self.strengths[self.strengths["role"] == role]
        off = rows["difference_percent"].abs()
        return (
            float(np.sqrt(np.mean(off**2))),
            float(off.max()),
            float(rows["confinement_MPa"][off.idxmax()]),
        )


def unknowns(base: Material, start: Start, strongest: float, dilates: bool = False) -> Unknowns:
    """Unknowns of a table with the rows of `start`.

    Parameters
    ----------
    base : its table is that of `start`
    strongest : largest strength of the tests [MPa], bound of the cohesion
    dilates : whether the dilation angles are fitted
    """
    keys, first, low, high = [], [], [], []
    columns = [("cohesion_MPa", start.cohesion, strongest)]
    columns += [("friction_angle_deg", start.friction, STEEPEST)]
    columns += [("dilation_angle_deg", start.dilation, STEEPEST)] if dilates else []
    for key, values, top in columns:
        for row, value in enumerate(values):
            keys.append((key, row))
            first.append(value)
            low.append(0.0)
            high.append(top)
    low, high = np.array(low), np.array(high)
    inside = 1e-3 * (high - low)  # least_squares starts inside its bounds
    return Unknowns(base, tuple(keys), np.clip(first, low + inside, high - inside), low, high)


def fit_rock(
    wanted: Unknowns,
    fitted: list[Triaxial],
    predicted: list[Triaxial],
    errors: dict[str, float] | None = None,
) -> RockFit:
    """Fit the unknowns to some tests and predict the strength of others.

    `errors` are standard errors of keys of the base that were read off the same tests.

    Raises
    ------
    ValueError
        When there are fewer measured numbers than unknowns.
    CoreError
        When the fitted rock cannot be driven through a test.
    """
    compare = _comparison(fitted)
    residuals = compare(wanted.rock(wanted.start))
    if len(residuals) < len(wanted.keys):
        raise ValueError(
            f"{len(residuals)} measured numbers for {len(wanted.keys)} unknowns, expected at least "
            "as many"
        )
    solved = least_squares(
        lambda values: compare(wanted.rock(values)),
        wanted.start,
        bounds=(wanted.low, wanted.high),
        x_scale=np.maximum(np.abs(wanted.start), 0.05 * (wanted.high - wanted.low)),
        diff_step=1e-5,
        xtol=1e-6,
        ftol=1e-7,
        max_nfev=MOST_TRIALS,
    )
    rock = wanted.rock(solved.x)
    roles = [("fitted", test) for test in fitted] + [("predicted", test) for test in predicted]
    roles.sort(key=lambda pair: pair[1].confinement_MPa)
    points = [_points(rock, role, test) for role, test in roles if test.has_curve]
    return RockFit(
        rock,
        _parameters(wanted, solved, _moved(compare, rock, errors or {})),
        pd.DataFrame([_strength(rock, role, test) for role, test in roles]),
        pd.concat(points, ignore_index=True) if points else pd.DataFrame(),
        solved.status > 0,
    )


def sampled(test: Triaxial) -> np.ndarray:
    """Rows of a curve that are compared, strains above 0 and at most `POINTS` of them.

    They stand at equal distances along the curve in units of its own ranges, since the rows of a
    table near 0 are passed in a small part of the strain.
    """
    rows = np.flatnonzero(test.axial_strain > 0.0)
    columns = [test.axial_strain, test.axial_stress_MPa]
    columns += [] if test.lateral_strain is None else [test.lateral_strain]
    steps = [np.diff(column[rows]) / (np.ptp(column[rows]) or 1.0) for column in columns]
    along = np.append(0.0, np.cumsum(np.linalg.norm(steps, axis=0)))
    wanted = np.linspace(0.0, along[-1], min(POINTS, len(rows)))
    return rows[np.unique(np.abs(along - wanted[:, None]).argmin(axis=1))]


def driven(rock: Material, test: Triaxial) -> pd.DataFrame:
    """Axial stress [MPa] and lateral strain of the rock at the compared strains of a test."""
    strains = test.axial_strain[sampled(test)]
    rows = np.arange(SUBSTEPS * len(strains) + 1) / SUBSTEPS
    finer = np.interp(rows, np.arange(len(strains) + 1), np.append(0.0, strains))
    curve = _drive(rock, test.confinement_MPa, finer[1:])
    columns = ("axial_stress_MPa", "lateral_strain")
    return pd.DataFrame(
        {name: np.interp(strains, curve["axial_strain"], curve[name]) for name in columns}
    )


def _drive(rock: Material, confinement: float, strains: np.ndarray) -> pd.DataFrame:
    from lithofrac import point  # loads the compiled core

    band = min(BAND, 0.5 * rock.band_width_limit)
    try:
        return point.drive(rock, "triaxial", confinement, steps=strains, length_m=band)
    except ValueError as error:  # a knot that the step leaps over
        raise CoreError(f"{confinement:g} MPa: {error}") from None


def _comparison(tests: list[Triaxial]) -> Callable[[Material], np.ndarray]:
    """Function from a rock to the residuals of all tests, without unit."""
    stress = float(np.mean([test.strength_MPa for test in tests]))
    lateral = [np.abs(test.lateral_strain).max() for test in tests
               if test.lateral_strain is not None]  # fmt: skip
    strain = max(lateral, default=1.0) or 1.0

    def residuals(rock: Material) -> np.ndarray:
        parts = []
        for test in tests:
            strength = peak_strength(rock.table, test.confinement_MPa * MPA)[0] / MPA
            parts.append([np.sqrt(STRENGTH) * (strength - test.strength_MPa) / stress])
            if not test.has_curve:
                continue
            rows = sampled(test)
            try:
                curve = driven(rock, test)
            except CoreError:  # a trial far from any rock: as bad as no strength at all
                curve = {"axial_stress_MPa": 0.0, "lateral_strain": 0.0}
            parts.append((curve["axial_stress_MPa"] - test.axial_stress_MPa[rows]) / stress)
            if test.lateral_strain is not None:
                parts.append((curve["lateral_strain"] - test.lateral_strain[rows]) / strain)
        return np.concatenate(parts)

    return residuals


def _moved(compare: Callable, rock: Material, errors: dict[str, float]) -> np.ndarray:
    """Change of the residuals by one standard error of each key that is held, (m, k)."""
    columns = []
    for key, error in errors.items():
        ends = [compare(rock.model_copy(update={key: getattr(rock, key) + sign * error}))
                for sign in (1.0, -1.0)]  # fmt: skip
        columns.append(0.5 * (ends[0] - ends[1]))
    return np.array(columns).T


def _parameters(wanted: Unknowns, solved: OptimizeResult, moved: np.ndarray) -> pd.DataFrame:
    """Values with their intervals and bounds; what lies on a bound has no interval."""
    values, jacobian, residuals = solved.x, solved.jac, solved.fun
    low, high = solved.active_mask < 0, solved.active_mask > 0
    unseen = np.linalg.norm(jacobian, axis=0) == 0.0
    free = ~(low | high | unseen)
    degrees = len(residuals) - int(free.sum())
    half = np.full(len(values), np.nan)
    if degrees > 0 and free.any():
        variance = float(residuals @ residuals) / degrees
        squares = variance * np.diag(np.linalg.pinv(jacobian[:, free].T @ jacobian[:, free]))
        if moved.size:
            squares = squares + np.sum((np.linalg.pinv(jacobian[:, free]) @ moved) ** 2, axis=1)
        half[free] = stats.t.ppf(0.5 + 0.5 * CONFIDENCE, degrees) * np.sqrt(squares)
    strain = wanted.base.plastic_strain
    notes = np.select(
        [low, high, unseen],
        ["at its lower bound", "at its upper bound", "not seen by the tests"],
        "",
    )
    return pd.DataFrame(
        {
            "quantity": [key for key, _ in wanted.keys],
            "plastic_strain": [strain[row] for _, row in wanted.keys],
            "value": values,
            "plus_minus": half,
            "lower_bound": wanted.low,
            "upper_bound": wanted.high,
            "note": notes,
        }
    )


def _strength(rock: Material, role: str, test: Triaxial) -> dict:
    computed = peak_strength(rock.table, test.confinement_MPa * MPA)[0] / MPA
    return {
        "test": test.name,
        "confinement_MPa": test.confinement_MPa,
        "role": role,
        "strength_MPa": test.strength_MPa,
        "computed_MPa": computed,
        "difference_percent": 100.0 * (computed / test.strength_MPa - 1.0),
    }


def _points(rock: Material, role: str, test: Triaxial) -> pd.DataFrame:
    rows, curve = sampled(test), driven(rock, test)
    measured = {"axial_stress_MPa": test.axial_stress_MPa}
    if test.lateral_strain is not None:
        measured["lateral_strain"] = test.lateral_strain
    return pd.concat(
        pd.DataFrame(
            {
                "test": test.name,
                "confinement_MPa": test.confinement_MPa,
                "role": role,
                "axial_strain": test.axial_strain[rows],
                "quantity": name,
                "measured": values[rows],
                "computed": curve[name],
            }
        )
        for name, values in measured.items()
    )
