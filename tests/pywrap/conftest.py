"""Results folders made in the test: what a run writes, with a strength that is known exactly."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from lithofrac.analysis.mohr_coulomb import peak_strength, residual_strength
from lithofrac.config.material import Material

ROOT = Path(__file__).parents[2]


@pytest.fixture
def sandstone() -> Material:
    return Material.load(ROOT / "configs" / "materials" / "sandstone.yaml")


@pytest.fixture
def data_folder() -> Path:
    return ROOT / "data"


def straight_curve(rock: Material, confinement: float, factor: float, end: float = 0.02):
    """Linear rise to `factor` times the closed form, linear fall to the residual, then flat.

    Returns strain (n,) and stress (n,) [MPa]; the peak is a row.
    """
    peak = factor * peak_strength(rock.table, 1e6 * confinement)[0] / 1e6
    low = residual_strength(rock.table, 1e6 * confinement) / 1e6
    at_peak = (peak - confinement) / (1e-6 * rock.young)
    knots = [0.0, at_peak, at_peak + 0.004, end]
    strain = np.unique(np.concatenate([np.linspace(0.0, end, 400), knots]))
    return strain, np.interp(strain, knots, [confinement, peak, low, low])


@pytest.fixture
def make_run(tmp_path, sandstone):
    """make_run(name, test, confinement, stiffness=0, factor=1, peak=True) -> folder of a run."""

    def made(name, test="triaxial", confinement=0.0, stiffness=0.0, factor=1.0, peak=True):
        folder = tmp_path / "out" / "runs" / name
        folder.mkdir(parents=True)
        strain, stress = straight_curve(sandstone, confinement, factor)
        if not peak:
            stress = np.maximum.accumulate(stress)
        lateral = 0.25 * strain + np.maximum(strain - 0.006, 0.0)
        pd.DataFrame(
            {
                "time_s": 0.1 * strain,
                "step": np.arange(len(strain)),
                "axial_strain": strain,
                "axial_stress_MPa": stress,
                "lateral_strain": lateral,
                "volumetric_strain": 2 * lateral - strain,
            }
        ).to_parquet(folder / "history.parquet")
        work = np.concatenate(
            [[0.0], np.cumsum(0.5 * (stress[1:] + stress[:-1]) * np.diff(strain))]
        )
        elastic = 1e6 * 0.5 * stress**2 / 28e3
        pd.DataFrame(
            {
                "time_s": 0.1 * strain,
                "kinetic_J": 1e-3 * elastic,
                "elastic_J": np.minimum(elastic, 1e6 * work),
                "compressive_dissipation_J": np.maximum(1e6 * work - elastic, 0.0) * 0.8,
                "fracture_dissipation_J": np.maximum(1e6 * work - elastic, 0.0) * 0.15,
                "damping_J": np.maximum(1e6 * work - elastic, 0.0) * 0.05,
                "external_J": 1e6 * work,
                "residual_J": 1e-9 * work,
            }
        ).to_parquet(folder / "energy.parquet")
        summary = {
            "status": "completed", "case": name, "elements": 1200, "nodes": 660, "steps": 100000,
            "wall_seconds": 6.0, "core_seconds": 5.5, "element_steps_per_core_second": 2.2e7,
            "energy_residual": 1e-9, "kinetic_ratio_at_peak": 1e-3,
            "version": "0.1.0", "commit": "0123456789ab",
        }  # fmt: skip
        (folder / "summary.json").write_text(json.dumps(summary))
        case = {
            "title": name,
            "material": sandstone.model_dump(mode="json", exclude_none=True),
            "scene": {"kind": test},
            "loading": {
                "kind": "velocity",
                "confinement_MPa": confinement,
                "lateral_stiffness_over_young": stiffness,
            },
        }
        (folder / "case.yaml").write_text(yaml.safe_dump(case))
        return folder

    return made


@pytest.fixture
def make_bench(tmp_path, monkeypatch):
    """make_bench(rock, confinement, factor=1, test) -> file of a material-point curve."""
    monkeypatch.chdir(ROOT)  # rocks are found by name in configs/

    def made(rock, confinement, factor=1.0, test="triaxial"):
        path = tmp_path / "out" / "bench" / rock / f"{test}_p{confinement:02d}.parquet"
        path.parent.mkdir(parents=True, exist_ok=True)
        strain, stress = straight_curve(Material.load(rock), confinement, factor)
        plastic = np.maximum(strain - 0.003, 0.0)
        ends = [0.0, 0.01]
        pd.DataFrame(
            {
                "axial_strain": strain,
                "axial_stress_MPa": stress,
                "lateral_strain": 0.25 * strain + plastic,
                "volumetric_strain": -0.5 * strain + 2 * plastic,
                "plastic_strain": plastic,
                "tensile_strength_lateral_MPa": np.maximum(4.0 - 2000 * plastic, 0.0),
                "cohesion_MPa": np.interp(plastic, ends, [20.0, 0.0]),
                "friction_angle_deg": np.interp(plastic, ends, [17.0, 52.5]),
                "dilation_angle_deg": np.interp(plastic, ends, [0.0, 18.0]),
            }
        ).to_parquet(path)
        return path

    return made


SHEET = {
    "figure": "9",
    "series": "triaxial, 10 MPa",
    "origin": "experiment",
    "compare_with": "sandstone_triaxial_p10",
    "x": {"unit": "percent", "printed_min": 0, "printed_max": 2},
    "y": {"unit": "MPa", "printed_min": 0, "printed_max": 300},
    "uncertainty": {"x": 0.01, "y": 2},
    "digitised_by": "A. Reader",
    "date": "2026-01-31",
    "source": "made in a test",
}


@pytest.fixture
def digitise(tmp_path, data_folder):
    """digitise(points, name="a", **changes) -> a `data/` folder that holds that series.

    `points` are rows (x, y) or the text of the CSV; a change to None removes the key.
    """

    def made(points, name="a", sheet=None, **changes):
        data = tmp_path / "data"
        folder = data / "klerck2004" / "digitised"
        folder.mkdir(parents=True, exist_ok=True)
        axes = data / "klerck2004" / "figure_axes.csv"
        axes.write_text((data_folder / "klerck2004" / "figure_axes.csv").read_text())
        keys = {key: value for key, value in {**SHEET, **changes}.items() if value is not None}
        text = yaml.safe_dump(keys).replace("'2026-01-31'", "2026-01-31")
        (folder / f"{name}.yaml").write_text(text if sheet is None else sheet)
        rows = "\n".join(f"{x}, {y}" for x, y in points) if not isinstance(points, str) else points
        (folder / f"{name}.csv").write_text(rows)
        return data

    return made
