"""Tables of the hole scene: initiation by run, by radius, and what the radius does to it."""

from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from lithofrac.analysis import hole_theory as theory
from lithofrac.analysis.hole import AFTER, CRITERIA, ZONES, HoleRun, is_hole
from lithofrac.analysis.hole_cohesive import primary_cohesive
from lithofrac.analysis.runs import Run, find_runs
from lithofrac.config.material import Material
from lithofrac.data.csv_file import read_columns

MM, MPA = 1e-3, 1e6
SERIES = ("similar", "mesh1mm", "block150")  # those that run over the radius
GROUP = ["series", "zone", "criterion"]
INITIATION = [
    "case", "series", "radius_mm", "seed", "zone", "criterion", "probe",
    "initiation_MPa", "low_MPa", "high_MPa", "largest_stress_MPa", "note",
]  # fmt: skip
NUMBERS = [name for name in INITIATION if name.endswith(("_MPa", "_mm"))]
EFFECT = [
    *GROUP, "radius_mm", "runs", "found", "mean_MPa", "min_MPa", "max_MPa",
    "kirsch_MPa", "average_stress_MPa", "coupled_MPa", "cohesive_MPa",
]  # fmt: skip


def hole_runs(inputs: list[Path]) -> list[HoleRun]:
    """Runs of the hole scene among results folders, by series, radius and seed."""
    folders = [path for path in map(Path, inputs) if path.suffix != ".csv"]
    runs = [HoleRun(run) for run in find_runs(folders) if is_hole(run)]
    return sorted(runs, key=lambda run: (run.series, run.radius_mm, run.seed, run.run.name))


def hole_initiation(inputs: list[Path], data: Path) -> pd.DataFrame:
    """Axial stress at initiation of every run, zone and criterion, with its interval.

    Where the table itself is among the inputs it is read, for it takes seconds a run.
    """
    made = [path for path in map(Path, inputs) if path.name == "hole_initiation.csv"]
    if made:
        return read_columns(
            made[0], INITIATION, "the table hole_initiation", NUMBERS, empty=True,
            keep_default_na=False, na_values={c: [""] for c in NUMBERS},
        )  # fmt: skip
    rows = []
    for run in hole_runs(inputs):
        head = {
            "case": run.run.name,
            "series": run.series,
            "radius_mm": run.radius_mm,
            "seed": run.seed,
            "largest_stress_MPa": float(run.stress.max()),
        }
        for event in run.events():
            found = {"initiation_MPa": event.stress, "low_MPa": event.low, "high_MPa": event.high}
            words = {key: getattr(event, key) for key in ("zone", "criterion", "probe", "note")}
            rows.append(head | found | words)
    return pd.DataFrame(rows, columns=INITIATION)


@dataclass(frozen=True)
class Theory:
    """Predictions for one radius [MPa]; NaN where a theory says nothing of the zone."""

    kirsch: float
    average: float
    coupled: float
    cohesive: float


def predicted(zone: str, rock: Material, radius_mm: float) -> Theory:
    """Theory of `hole_theory` and `hole_cohesive` for crown and sidewall; there is none for remote.

    At the sidewall Kirsch is first yield, 3 p against the uniaxial yield of Table 1.
    """
    nan = float("nan")
    if zone == "sidewall":
        return Theory(theory.sidewall_yield(rock.table) / MPA, nan, nan, nan)
    if zone == "remote" or not rock.tensile_strength:
        return Theory(nan, nan, nan, nan)
    own = rock.tensile_strength, rock.young, rock.poisson, rock.fracture_energy
    length = theory.characteristic_length(*own)
    return Theory(
        theory.primary_kirsch(rock.tensile_strength) / MPA,
        theory.primary_average(rock.tensile_strength, length, MM * radius_mm) / MPA,
        theory.primary_coupled(*own, MM * radius_mm)[0] / MPA,
        primary_cohesive(*own, MM * radius_mm)[0] / MPA,
    )


def size_effect(inputs: list[Path], data: Path) -> pd.DataFrame:
    """Mean and range over the realisations of each radius, theory of the infinite plate beside.

    What initiates only after the block has borne its largest stress is not found: the axial stress
    then says how far the block has failed.
    """
    return size_effect_of(hole_initiation(inputs, data), rock_of(inputs))


def size_effect_of(initiation: pd.DataFrame, rock: Material | None) -> pd.DataFrame:
    """The same from the table `hole_initiation`."""
    rows = []
    chosen = initiation[initiation["series"].isin(SERIES)]
    for key, group in chosen.groupby([*GROUP, "radius_mm"], sort=False):
        found = group.loc[group["note"] != AFTER, "initiation_MPa"].dropna()
        said = predicted(key[1], rock, key[3])
        rows.append(
            dict(zip([*GROUP, "radius_mm"], key, strict=True))
            | {
                "runs": len(group),
                "found": len(found),
                "mean_MPa": found.mean(),
                "min_MPa": found.min(),
                "max_MPa": found.max(),
                "kirsch_MPa": said.kirsch,
                "average_stress_MPa": said.average,
                "coupled_MPa": said.coupled,
                "cohesive_MPa": said.cohesive,
            }
        )
    return _sorted(pd.DataFrame(rows, columns=EFFECT), [*GROUP, "radius_mm"])


def rock_of(inputs: list[Path]) -> Material | None:
    """Rock of the runs; that of the first one which can fail."""
    runs: list[Run] = [run.run for run in hole_runs(inputs)]
    rocks = [run.rock for run in runs if not run.case["material"].get("elastic", False)]
    return rocks[0] if rocks else None


def _sorted(table: pd.DataFrame, keys: list[str]) -> pd.DataFrame:
    """Rows in the order of `SERIES`, `ZONES` and `CRITERIA`, then of the radius."""
    order = {name: i for i, name in enumerate([*SERIES, *ZONES, *CRITERIA])}
    return table.sort_values(
        keys, key=lambda c: c if c.name == "radius_mm" else c.map(order), ignore_index=True
    )
