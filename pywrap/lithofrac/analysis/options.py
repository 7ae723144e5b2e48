"""What the choices that the paper leaves open change, by the point bench.

A row is a rock with one option of `Material` other than its default. The size of an element is the
leg of a right isosceles triangle; its crack band width follows from the option `band_width`.
"""

from pathlib import Path

import numpy as np
import pandas as pd

from lithofrac.config.material import Material

ROCKS = ("quartzite", "sandstone")
OTHERS = ({}, {"hardening": "total"}, {"coupling": "explicit"}, {"band_width": "sqrt_A"})
LEGS_MM = (0.25, 0.5, 1.0, 2.0)
LEG_MM = 1.0  # in compression
END_STRAIN = 0.015  # of the compression
OPENED = 0.02  # axial strain up to which tension is followed closely


def options(inputs: list[Path], data: Path) -> pd.DataFrame:
    """Crack energy by element size, and uniaxial compression, under each option of the law.

    `inputs` are files of materials; without any, quartzite and sandstone are taken.
    """
    rows = []
    for name in inputs or ROCKS:
        default = None
        for other in OTHERS:
            rock = Material.load(name).model_copy(update=other)
            curve = compressed(rock)
            default = curve if default is None else default
            spent = [crack_energy(rock, 1e-3 * leg) for leg in LEGS_MM]
            rows.append(
                {
                    "rock": Path(name).stem,
                    "option": ", ".join(f"{k}: {v}" for k, v in other.items()) or "default",
                    **{f"crack_energy_at_{leg:g}_mm_J_m2": energy
                       for leg, energy in zip(LEGS_MM, spent, strict=True)},
                    "uniaxial_peak_MPa": curve["axial_stress_MPa"].max(),
                    "strain_of_lateral_exhaustion_percent": 100.0 * exhaustion(curve),
                    "largest_change_of_stress_MPa": largest_change(
                        default, curve, "axial_stress_MPa"
                    ),
                    "largest_change_of_lateral_strength_MPa": largest_change(
                        default, curve, "tensile_strength_lateral_MPa"
                    ),
                }
            )  # fmt: skip
    return pd.DataFrame(rows)


def crack_energy(rock: Material, leg: float) -> float:
    """Energy [J/m2] that a band one leg [m] wide has used up when it is pulled open.

    The leg, not the band width of the option: an element is as wide as it is. Pulled somewhat
    beyond the critical strain 2 Gf / (h ft) of eq. 15, at which a crack carries nothing any more.
    """
    from lithofrac import point  # loads the compiled core

    width = float(rock.band_width_of(0.5 * leg**2))
    onset = rock.tensile_strength / rock.young
    end = max(onset, 2.0 * rock.fracture_energy / (width * rock.tensile_strength))
    close = np.linspace(onset, min(OPENED, end), 601)[1:]
    wide = np.linspace(close[-1], end, 41)[1:] if end > close[-1] else []
    path = [0.5 * onset, onset, *close, *wide, *(end * np.array([1.1, 1.2]))]
    curve = point.drive(rock, "tension", steps=path, length_m=width)
    return float(curve["dissipated_J_m3"].iloc[-1] * leg)


def compressed(rock: Material) -> pd.DataFrame:
    """Uniaxial compression, columns as `point.drive` gives them."""
    from lithofrac import point  # loads the compiled core

    width = float(rock.band_width_of(0.5 * (1e-3 * LEG_MM) ** 2))
    return point.drive(rock, "triaxial", end_strain=END_STRAIN, length_m=width)


def exhaustion(curve: pd.DataFrame) -> float:
    """Axial strain at which dilation has used up the lateral tensile strength; NaN if it never has.

    The first row without strength, so at most one step of the curve late.
    """
    gone = curve.loc[curve["tensile_strength_lateral_MPa"] <= 0.0, "axial_strain"]
    return float(gone.iloc[0]) if len(gone) else float("nan")


def largest_change(default: pd.DataFrame, other: pd.DataFrame, column: str) -> float:
    """Largest difference of a column [MPa] between two curves at equal strain, to 1e-9."""
    strain = default["axial_strain"]
    values = np.interp(strain, other["axial_strain"], other[column])
    return round(float(np.abs(values - default[column]).max()), 9)
