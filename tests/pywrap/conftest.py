"""Results folders made in the test: what a run writes, with a strength that is known exactly."""

import json
from pathlib import Path

import meshio
import numpy as np
import pandas as pd
import pytest
import yaml
from punch_runs import as_punch

from lithofrac.analysis.mohr_coulomb import peak_strength, residual_strength
from lithofrac.config.material import Material
from lithofrac.problem import Mesh
from lithofrac.results.fields import write_series

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
                "damping_J": -np.maximum(1e6 * work - elastic, 0.0) * 0.05,
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


def block_mesh(platen: bool = True) -> Mesh:
    """Rock of 4 x 6 mm in squares of 1 mm, two triangles each, below a platen of 4 x 1 mm.

    Nodes of the rock stand at (i, j) mm with number 5 j + i.
    """
    rows = [(0.0, 7, "rock")] + ([(6.0, 2, "platen")] if platen else [])
    nodes, triangles, body = [], [], []
    for index, (bottom, n, _) in enumerate(rows):
        first = sum(len(part) for part in nodes)
        x, y = np.meshgrid(np.arange(5.0), bottom + np.arange(n))
        nodes.append(1e-3 * np.column_stack([x.ravel(), y.ravel()]))
        number = first + np.arange(5 * n).reshape(n, 5)
        a, b, c, d = (
            part.ravel()
            for part in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1])
        )
        triangles += [np.column_stack([a, b, c]), np.column_stack([a, c, d])]
        body += [np.full(2 * len(a), index)]
    return Mesh(
        np.concatenate(nodes), np.concatenate(triangles).astype(np.int32),
        np.concatenate(body).astype(np.int32), tuple(name for *_, name in rows),
    )  # fmt: skip


def opened(mesh: Mesh, x_mm: float, from_mm: float, opening_mm: float):
    """Mesh with a vertical crack from the top of the rock down to a tip, opened to both sides.

    Returns nodes (n, 2) [m], displacement (n, 2) [m], triangles (m, 3); the tip is not split.
    """
    rock, top = mesh.body == 0, 6e-3
    on_it = np.isclose(mesh.nodes[:, 0], 1e-3 * x_mm) & (mesh.nodes[:, 1] > 1e-3 * from_mm + 1e-9)
    split = np.intersect1d(np.flatnonzero(on_it), mesh.triangles[rock])
    copy = np.arange(len(mesh.nodes))
    copy[split] = len(mesh.nodes) + np.arange(len(split))
    nodes = np.concatenate([mesh.nodes, mesh.nodes[split]])
    right = rock & (mesh.centroids()[:, 0] > 1e-3 * x_mm)
    triangles = mesh.triangles.copy()
    triangles[right] = copy[triangles[right]]
    side = np.where(nodes[:, 0] > 1e-3 * x_mm + 1e-9, 1.0, -1.0)
    side[len(mesh.nodes) :] = 1.0
    side[np.setdiff1d(np.arange(len(nodes)), mesh.triangles[rock])] = 0.0
    side[len(mesh.nodes) :] = 1.0
    height = np.clip((nodes[:, 1] - 1e-3 * from_mm) / (top - 1e-3 * from_mm), 0.0, 1.0)
    displacement = np.column_stack([0.5e-3 * opening_mm * side * height, -2e-5 * nodes[:, 1] / top])
    return nodes, displacement, triangles


@pytest.fixture
def make_cracked_run(make_run):
    """make_cracked_run(name, opening_mm, cracks, mode, **of make_run) -> folder of a discrete run.

    A vertical crack at x = 2 mm grows down from the top of the rock by 1 mm at a time; the first
    two pieces are tensile, the others compressive dilation.
    """

    def made(name, opening_mm=0.2, cracks=3, mode="inter_element", **keys):
        folder = make_run(name, **keys)
        mesh = block_mesh()
        mesh.save(folder / "mesh.npz")
        history = pd.read_parquet(folder / "history.parquet")
        end = float(history["time_s"].iloc[-1])
        nodes, displacement, triangles = opened(mesh, 2.0, 6.0 - cracks, opening_mm)
        plastic = np.where(np.abs(mesh.centroids()[:, 0] - 2e-3) < 0.5e-3, 0.01, 0.0)
        zero = np.zeros((len(nodes), 1))
        grid = meshio.Mesh(
            np.hstack([nodes, zero]), [("triangle", triangles)],
            point_data={"displacement_m": np.hstack([displacement, zero])},
            cell_data={"plastic_strain": [plastic * (mesh.body == 0)], "body": [mesh.body]},
        )  # fmt: skip
        (folder / "fields").mkdir()
        meshio.write(folder / "fields" / "frame_0000.vtu", grid)
        write_series(folder / "fields.pvd", [(end, "fields/frame_0000.vtu")])
        n = np.arange(cracks)
        table = pd.DataFrame(
            {
                "time_s": end * (0.4 + 0.1 * n), "step": 1000 * n, "crack": n + 1,
                "x1_mm": 2.0, "y1_mm": 6.0 - n, "x2_mm": 2.0, "y2_mm": 5.0 - n,
                "length_mm": 1.0, "direction_deg": 90.0, "failure_factor": 1.0, "agreement": 1.0,
                "mode": np.where(n < 2, "tensile", "compressive_dilation"),
                "compressive_share": np.where(n < 2, 0.1, 0.9),
                "end": np.where(n < cracks - 1, "through", "tip"),
                "way": "edge", "fallback": n == 1,
            }
        )  # fmt: skip
        table.to_parquet(folder / "cracks.parquet")
        energy = pd.read_parquet(folder / "energy.parquet")
        grown = np.clip(energy["time_s"] / end - 0.4, 0.0, None)
        energy.assign(
            contact_J=-1e-6 * grown, friction_J=-2e3 * grown, insertion_J=-1e2 * grown,
            relump_J=-1e-2 * grown, reset_J=10.0 * grown,
        ).to_parquet(folder / "energy.parquet")  # fmt: skip
        case = yaml.safe_load((folder / "case.yaml").read_text())
        case["fracture"] = {"mode": mode}
        (folder / "case.yaml").write_text(yaml.safe_dump(case))
        path = folder / "summary.json"
        more = {
            "cracks": cracks, "fragments": 1, "crack_length_mm": float(cracks),
            "crack_fallbacks": 1, "time_step_min_s": 9e-9, "time_step_max_s": 1e-8,
            "contact_pairs_max": 12, "contact_sweeps_mean": 2.5, "contact_unconverged_steps": 0,
            "max_penetration_over_h": 1e-9, "core_seconds": 8.25,
        }  # fmt: skip
        path.write_text(json.dumps(json.loads(path.read_text()) | more))
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


LIMESTONE = ROOT / "configs" / "materials" / "tyndall_limestone.yaml"
GAUGES = {
    "crown": ((0.0, 1.02), "primary"),
    "sidewall_right": ((1.02, 0.0), "sidewall"),
    "sidewall_left": ((-1.02, 0.0), "sidewall"),
    "remote_01": ((0.8, 1.4), "remote"),
    "remote_02": ((-0.8, 1.4), "remote"),
}  # probe -> position in radii, zone
HOLE_SLOPE = {"primary": 45e-6, "remote": 20e-6, "sidewall": -140e-6}  # strain per MPa
HOLE_KINK = {"primary": 4.0, "remote": 8.0, "sidewall": 10.0}  # MPa


def hole_probes(times, stress, kinks, wake, whole):
    """Rows of `probes.parquet`: straight to the kink of its zone, then twice as steep.

    From there on the tensile strength fades over 8 MPa. A gauge in `wake` bends and stays whole.
    """
    tables = []
    for number, (name, (_, zone)) in enumerate(GAUGES.items()):
        at = kinks[zone] + (0.5 if name.endswith(("_02", "left")) else 0.0)
        beyond = np.maximum(stress - at, 0.0) * (0.0 if whole else 1.0)
        principal = HOLE_SLOPE[zone] * (stress + beyond)
        strength = 1.5 * np.clip(1.0 - np.maximum.accumulate(beyond) / 8.0, 0.0, 1.0)
        if name in wake:
            strength = np.full_like(stress, 1.5)
        # The other principal strain is opposite; both are turned by 30 degrees.
        tables.append(
            pd.DataFrame(
                {
                    "probe": name, "element": number, "time_s": times,
                    "stress_xx_MPa": 1.1 * stress if zone != "sidewall" else 0.0,
                    "stress_yy_MPa": -3.3 * stress if zone == "sidewall" else 0.0,
                    "stress_zz_MPa": 0.0, "stress_xy_MPa": 0.0,
                    "strain_xx": 0.5 * principal, "strain_yy": -0.5 * principal,
                    "strain_zz": 0.0, "strain_xy": 2.0 * principal * np.sqrt(0.75),
                    "plastic_strain": 0.0, "tensile_strength_1_MPa": strength,
                    "tensile_strength_2_MPa": 1.5, "tensile_strength_3_MPa": 1.5,
                }
            )
        )  # fmt: skip
    return pd.concat(tables).sort_values("time_s", kind="stable", ignore_index=True)


@pytest.fixture
def make_hole(tmp_path):
    """make_hole(name, radius_mm, kinks, cracks, wake, largest, whole) -> folder of a hole run.

    kinks : zone -> axial stress [MPa] at which its gauges bend; principal strain equals that
    cracks : rows (axial stress [MPa], x, y, mode) of single edges, positions in radii
    wake : probes that bend without softening
    largest : axial stress [MPa] that the block bears before it falls to nothing
    whole : straight gauges, no cracks: the elastic run
    """

    def made(name, radius_mm=25.0, kinks=None, cracks=(), wake=(), largest=24.0, whole=False):
        folder = tmp_path / "out" / "runs" / name
        folder.mkdir(parents=True)
        times = np.linspace(0.0, 1.1, 441)
        stress = np.where(times <= 1.0, largest * times, largest * (11.0 - 10.0 * times))
        pd.DataFrame(
            {
                "time_s": times, "step": np.arange(len(times)), "axial_strain": 1e-3 * times,
                "axial_stress_MPa": stress,
            }
        ).to_parquet(folder / "history.parquet")  # fmt: skip
        rising = np.maximum.accumulate(stress)
        hole_probes(times, rising, HOLE_KINK | (kinks or {}), wake, whole).to_parquet(
            folder / "probes.parquet"
        )
        rows = [
            {
                "time_s": moment / largest, "step": i, "crack": i + 1,
                "x1_mm": radius_mm * x, "y1_mm": radius_mm * (y - 0.05), "x2_mm": radius_mm * x,
                "y2_mm": radius_mm * (y + 0.05), "length_mm": 0.1 * radius_mm, "mode": mode,
            }
            for i, (moment, x, y, mode) in enumerate(cracks)
        ]  # fmt: skip
        columns = ["time_s", "x1_mm", "y1_mm", "x2_mm", "y2_mm", "mode"]
        if not whole:
            pd.DataFrame(rows, columns=None if rows else columns).to_parquet(
                folder / "cracks.parquet"
            )
        material = yaml.safe_load(LIMESTONE.read_text())
        if whole:
            keep = ("title", "young_modulus_GPa", "poisson_ratio", "density_kg_m3")
            material = {key: material[key] for key in keep} | {"elastic": True}
        case = {
            "title": name, "material": material, "loading": {"kind": "velocity"},
            "scene": {"kind": "hole", "hole_radius_mm": radius_mm},
        }  # fmt: skip
        (folder / "case.yaml").write_text(yaml.safe_dump(case))
        (folder / "summary.json").write_text(json.dumps({"case": name}))
        mesh = block_mesh(platen=False)
        mesh.save(folder / "mesh.npz")
        return folder

    return made


@pytest.fixture
def make_punch_run(make_run):
    """make_punch_run(name, gf=60, compression=True, cracks=None) -> folder (`punch_runs`)."""

    def made(name, gf=60.0, compression=True, cracks=None):
        folder = make_run(name, test="punch", confinement=4.5)
        return as_punch(folder, gf, compression, cracks)

    return made
