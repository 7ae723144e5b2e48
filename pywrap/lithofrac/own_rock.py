"""`lithofrac fit`: triaxial tests in, a material file and the account of its fit out."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from lithofrac.analysis.rock_fit import MOST_TRIALS, RockFit, Unknowns, fit_rock, unknowns
from lithofrac.analysis.rock_start import (
    Start,
    elastic_constants,
    elastic_errors,
    first_table,
    one_row,
    table_at,
)
from lithofrac.config import ConfigError
from lithofrac.config.errors import suggestion
from lithofrac.config.material import COLUMNS, Material, find_material
from lithofrac.config.setting import settings
from lithofrac.config.yaml_file import read_yaml, text_of
from lithofrac.data.triaxial import Triaxial, load_triaxial

ELASTIC = ("young_modulus_GPa", "poisson_ratio")
NEEDED = (*ELASTIC, "density_kg_m3", "tensile_strength_MPa", "fracture_energy_J_m2")
DILATION = "dilation_angle_deg"
KEPT = (*NEEDED, "hardening", "coupling", "band_width")
IGNORED = ("title", *COLUMNS[:3])  # a base may be a whole material; these come from the tests
MOST_ROWS = 6
SWELLS = 10.0  # dilation angle where nothing tells it [degrees]
SIGNIFICANT = 7  # digits of a number in the file


def fit(
    tests: list[Path],
    out: Path,
    base: str | None = None,
    given: Sequence[str] = (),
    fit_on: list[float] | None = None,
    knots: list[float] | None = None,
) -> list[str]:
    """Fit a rock to tests, write it, and say how well it fits.

    Parameters
    ----------
    tests : CSV files, see `lithofrac.data.triaxial`
    out : material to write, .yaml; a figure and two tables are written beside it
    base : material with what the tests do not give; default: the first CSV's name with .yaml
    given : KEY=VALUE, which go before those of the base
    fit_on : confinements [MPa] of the tests to fit; the others are predicted. Default: all
    knots : plastic strains of the rows of the table; default: where the curves bend most

    Returns
    -------
    Lines to print.

    Raises
    ------
    ConfigError, DataError
        When a file, key or option is wrong; nothing is written then.
    """
    if out.suffix not in (".yaml", ".yml"):
        raise ConfigError(f"--out {out}: expected a file that ends in .yaml")
    measured = load_triaxial(tests)
    fitted, predicted = _split(measured, fit_on)
    source, values = _base(tests[0], base, settings(given))
    curves = [test for test in fitted if test.has_curve]
    start, values, given_by_curves = _start(curves, values, knots, source)
    wanted = _unknowns(fitted, start, values, DILATION in given_by_curves, source)
    try:
        found = fit_rock(wanted, fitted, predicted, _errors(curves, given_by_curves))
    except ValueError as error:
        raise ConfigError(f"{tests[0]}: {error}") from None
    read_off = [key for key in given_by_curves if key in ELASTIC]
    text = _material_text(found, [str(path) for path in tests], source, read_off)
    written = _write(out, text, found)
    return [*_account(found, source, read_off), f"written: {', '.join(map(str, written))}"]


def _split(tests: list[Triaxial], fit_on: list[float] | None) -> tuple[list, list]:
    """Tests to fit and tests to predict."""
    known = {test.confinement_MPa for test in tests}
    for confinement in fit_on or []:
        if confinement not in known:
            listed = ", ".join(f"{level:g}" for level in sorted(known))
            raise ConfigError(
                f"--fit-on {confinement:g}: no test at that confinement, expected some of {listed}"
            )
    chosen = known if fit_on is None else set(fit_on)
    fitted = [test for test in tests if test.confinement_MPa in chosen]
    levels = {test.confinement_MPa for test in fitted}
    curves = {test.confinement_MPa for test in fitted if test.has_curve}
    if len(levels) < 2 or len(curves) == 1:
        what, have = ("curves", curves) if len(levels) > 1 else ("tests", levels)
        raise ConfigError(
            f"the {what} to fit stand at one confinement ({min(have):g} MPa), expected two or more "
            "to tell cohesion from friction"
        )
    return fitted, [test for test in tests if test.confinement_MPa not in chosen]


def _base(first: Path, base: str | None, given: dict) -> tuple[str, dict]:
    """Where the keys come from that the tests do not give, and these keys."""
    sidecar = first.with_suffix(".yaml")
    values, source = {}, "--set"
    if base is not None or sidecar.is_file():
        path = sidecar if base is None else find_material(base)
        values, source = read_yaml(path), str(path) + (" and --set" if given else "")
    values = {**values, **given}
    known = (*KEPT, DILATION, *IGNORED)
    for key in values:
        if key not in known:
            raise ConfigError(
                f"{source}: {key}: not a key of a rock that is fitted, {suggestion(key, [*known])}"
            )
    return source, values


def _start(
    curves: list[Triaxial], values: dict, knots: list[float] | None, source: str
) -> tuple[Start | None, dict, tuple[str, ...]]:
    """First table and elastic constants from the curves, and the keys beside cohesion and friction
    that curves give."""
    if not curves:
        if knots:
            raise ConfigError("--knots: strengths alone give one row, expected curves for more")
        _refuse_missing(values, (*NEEDED, DILATION), source)
        return None, values, ()
    lateral = any(test.lateral_strain is not None for test in curves)
    given = (ELASTIC[0], ELASTIC[1], DILATION) if lateral else ELASTIC[:1]
    _refuse_missing(values, tuple(k for k in (*NEEDED, DILATION) if k not in given), source)
    young, poisson = elastic_constants(curves)
    if not young > 0.0:
        raise ConfigError(f"{curves[0].name}: the stress falls from the start, expected a rise")
    poisson = min(max(poisson, 0.01), 0.48) if lateral else values[ELASTIC[1]]
    values = values | {ELASTIC[0]: 1e-3 * young, ELASTIC[1]: poisson}
    # Of tests without lateral strains; a start only, where others give the dilation.
    dilation = np.array([[0.0], [SWELLS]])
    if not lateral:
        strain = np.linspace(0.0, 1.0, 10_001) ** 2  # finer near 0, and beyond every table
        dilation = np.array([strain, _given_dilation(values, strain, source)])
    about = (curves, young, poisson, dilation)
    here = "the tests to fit"
    try:
        if not knots:
            return first_table(*about, MOST_ROWS), values, given
        here = f"--knots {' '.join(f'{knot:g}' for knot in knots)}"
        if not (knots[0] >= 0.0 and all(b > a for a, b in pairwise(knots))):
            raise ValueError("expected numbers not below 0, each above the one before")
        return table_at(np.array(knots), *about), values, given
    except ValueError as error:
        raise ConfigError(f"{here}: {error}") from None


def _errors(curves: list[Triaxial], given: tuple[str, ...]) -> dict[str, float]:
    """Standard errors of the elastic constants that the curves give, by key."""
    young, poisson = elastic_errors(curves) if curves else (0.0, 0.0)
    return {key: error for key, error in zip(ELASTIC, (1e-3 * young, poisson), strict=True)
            if key in given}  # fmt: skip


def _refuse_missing(values: dict, needed: tuple, source: str) -> None:
    missing = [key for key in needed if values.get(key) is None]
    if missing:
        where = "no base was named" if source == "--set" else f"{source} lacks them"
        raise ConfigError(
            f"the tests do not give {', '.join(missing)} and {where}, expected them in --base, in "
            "a .yaml beside the CSV, or by --set KEY=VALUE"
        )


def _unknowns(
    fitted: list[Triaxial], start: Start | None, values: dict, dilates: bool, source: str
) -> Unknowns:
    """What is to be fitted, from a base that has passed the checks of a material."""
    strongest = max(test.strength_MPa for test in fitted)
    if start is None:
        start = one_row(fitted)
    rows = len(start.plastic_strain)
    if not dilates:
        dilation = _given_dilation(values, start.plastic_strain, source)
        start = Start(start.plastic_strain, start.cohesion, start.friction, dilation)
    table = {
        COLUMNS[0]: [_digits(value) for value in start.plastic_strain],
        COLUMNS[1]: [1.0] * rows,
        COLUMNS[2]: [1.0] * rows,
        DILATION: list(map(float, start.dilation)),
    }
    kept = {key: values[key] for key in KEPT if key in values}
    rock = Material.from_values({**kept, **table}, source)
    return unknowns(rock, start, strongest, dilates)


def _given_dilation(values: dict, strain: np.ndarray, source: str) -> np.ndarray:
    """Dilation angles [degrees] at the rows of the table, from one number or a table."""
    angles, here = _angles(values, source), f"{source}: {DILATION}"
    if angles.size == 1:
        return np.full(len(strain), float(angles[0]))
    if len(strain) == 1:
        raise ConfigError(
            f"{here} has {angles.size} values, but strengths alone give a table of one row, "
            f"expected one, as by --set {DILATION}=10"
        )
    own = np.atleast_1d(values.get(COLUMNS[0]))
    if own.dtype.kind not in "if" or own.shape != angles.shape or np.any(np.diff(own) <= 0.0):
        raise ConfigError(
            f"{here} has {angles.size} values, expected one, or as many rising ones in {COLUMNS[0]}"
        )
    return np.interp(strain, own, angles)


def _angles(values: dict, source: str) -> np.ndarray:
    """The dilation angles that were given, (n,) [degrees]."""
    given = values[DILATION]
    listed = given if isinstance(given, (list, tuple)) else [given]
    if not listed or any(type(angle) not in (int, float) for angle in listed):
        raise ConfigError(f"{source}: {DILATION} = {given}: expected a number or a list of numbers")
    return np.array(listed, dtype=float)


def _digits(value: float) -> float:
    return float(f"{value:.{SIGNIFICANT}g}")


def _not_given(fit: RockFit, source: str, read_off: list[str]) -> str:
    """What no test told, and where it is from instead."""
    told = {*fit.parameters["quantity"], *read_off}
    rest = [key for key in (*NEEDED, DILATION) if key not in told]
    return f"from {source}: {', '.join(rest)}"


def _material_text(fit: RockFit, tests: list[str], source: str, read_off: list[str]) -> str:
    """The material file: where each number comes from, and the numbers."""
    rock = fit.rock
    fitted = fit.strengths[fit.strengths["role"] == "fitted"]["confinement_MPa"]
    levels = ", ".join(f"{level:g}" for level in sorted(set(fitted)))
    free = list(dict.fromkeys(fit.parameters["quantity"]))
    values = {"title": f"Rock fitted to {', '.join(tests)} at {levels} MPa"}
    values |= rock.model_dump(exclude_defaults=True, exclude={"title", *COLUMNS})
    values |= {key: _digits(values[key]) for key in ELASTIC}
    columns = {key: ", ".join(str(_digits(v)) for v in getattr(rock, key)) for key in COLUMNS}
    head = [
        f"Fitted by lithofrac: {', '.join(free)}.",
        f"Not given by the tests, {_not_given(fit, source, read_off)}.",
    ]
    if read_off:
        head.insert(1, f"Read off the first parts of the curves: {', '.join(read_off)}.")
    else:
        head.append("Strengths alone: one row, no hardening, softening or change of dilation.")
    table = "".join(f"{key}: [{column}]\n" for key, column in columns.items())
    return "".join(f"# {line}\n" for line in head) + text_of(values) + table


def _write(out: Path, text: str, fit: RockFit) -> list[Path]:
    """Write figure, tables and, when these are there, the material."""
    from lithofrac.plots import style
    from lithofrac.plots.rock_fit import rock_fit
    from lithofrac.results.files import write_whole

    drawn = rock_fit(fit)
    beside = {name: out.with_name(f"{out.stem}{name}")
              for name in (".svg", "_parameters.csv", "_residuals.csv")}  # fmt: skip
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        style.save(drawn, beside[".svg"])
        write_whole(
            beside["_parameters.csv"], lambda part: fit.parameters.to_csv(part, index=False)
        )
        write_whole(
            beside["_residuals.csv"], lambda part: fit.residuals().to_csv(part, index=False)
        )
        write_whole(out, lambda part: part.write_text(text, encoding="utf-8"))
    except OSError as error:
        raise ConfigError(f"--out {out}: cannot be written ({error.strerror})") from None
    return [out, *beside.values()]


def _account(fit: RockFit, source: str, read_off: list[str]) -> list[str]:
    """The fit in words and two tables."""
    rock, rows = fit.rock, len(fit.rock.plastic_strain)
    what = [f"a table of {rows} rows from curves"]
    if not read_off:
        what = [
            "a table of one row: strengths alone say nothing of hardening, softening or dilation"
        ]
    what += [f"{key} {getattr(rock, key):.4g}, from the first parts of the curves"
             for key in read_off]  # fmt: skip
    what.append(f"not given by the tests, {_not_given(fit, source, read_off)}")
    if not fit.converged:
        what.append(f"not converged in {MOST_TRIALS} steps: fewer --knots may help")
    pairs = zip(rock.plastic_strain, rock.friction_angle_deg, rock.dilation_angle_deg, strict=True)
    for strain, friction, dilation in pairs:
        if dilation > friction:
            what.append(
                f"at a plastic strain of {strain:.4g} it dilates by {dilation:.3g} degrees, more "
                f"than the friction angle of {friction:.3g}"
            )
    lines = [*what, f"{'quantity':<21}{'plastic strain':>15}{'value':>11}{'95 %':>11}  bounds"]
    for row in fit.parameters.itertuples():
        strain = "" if np.isnan(row.plastic_strain) else f"{row.plastic_strain:.5g}"
        half = "-" if np.isnan(row.plus_minus) else f"± {row.plus_minus:.2g}"
        bounds = f"{row.lower_bound:.4g} to {row.upper_bound:.4g} {row.note}".rstrip()
        lines.append(f"{row.quantity:<21}{strain:>15}{row.value:>11.5g}{half:>11}  {bounds}")
    lines.append(f"{'test':<14}{'':<11}{'measured':>10}{'fitted':>10}{'off':>9}")
    for row in fit.strengths.itertuples():
        lines.append(
            f"{row.test:<14}{row.role:<11}{row.strength_MPa:>10.4g}{row.computed_MPa:>10.4g}"
            f"{row.difference_percent:>7.2f} %"
        )
    for role in dict.fromkeys(fit.strengths["role"]):
        rms, largest, where = fit.error_percent(role)
        lines.append(f"strengths {role}: rms {rms:.2f} %, largest {largest:.2f} % at {where:g} MPa")
    return lines
