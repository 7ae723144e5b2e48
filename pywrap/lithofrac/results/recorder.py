"""Tables that grow while a run goes on: history, energy, probes."""

from __future__ import annotations

import numpy as np
import pandas as pd

from lithofrac.core import Energy, Run
from lithofrac.results.checkpoint import Layout
from lithofrac.results.columns import ENERGY_COLUMNS
from lithofrac.results.cracks import FRAGMENT_COLUMNS, fragments

ENERGY = (
    "kinetic",
    "elastic",
    "compressive",
    "fracture",
    "external",
    "damping",
    "contact",
    "friction",
    "insertion",
    "relump",
    "reset",
    "turning",
)
PROBE_COLUMNS = [
    *(f"stress_{c}_MPa" for c in ("xx", "yy", "zz", "xy")),
    *(f"strain_{c}" for c in ("xx", "yy", "zz", "xy")),
    "plastic_strain",
    *(f"tensile_strength_{i}_MPa" for i in (1, 2, 3)),
]


class Recorder:
    """Rows of a run, taken at its records; goes into the checkpoint and comes back from it."""

    def __init__(self, run: Run) -> None:
        self.run = run
        problem = run.problem
        self.names = [load.name for load in (*problem.velocity_loads, *problem.pressure_loads)]
        # step, time, force and displacement per load, then what `_contact_columns` names
        self.history: list[np.ndarray] = []
        self.energy: list[np.ndarray] = []
        self.probes: list[np.ndarray] = []
        self.fragments = np.zeros((0, len(FRAGMENT_COLUMNS)))  # each where it was first seen
        self.fragments_now = 0
        self._edges_seen = 0

    def record(self) -> None:
        """Take one row of everything."""
        run = self.run
        ledger, time = run.energy(), run.step * run.dt
        self.history.append(
            np.concatenate([[run.step, time], run.loads().ravel(), self._contact_row()])
        )
        self._note_fragments()
        entries = [getattr(ledger, name) for name in ENERGY]
        self.energy.append(np.array([time, *entries, _residual(ledger), ledger.residual]))
        if run.problem.probes:
            state = run.elements(np.fromiter(run.problem.probes.values(), int))
            rows = np.column_stack(
                [
                    state.stress / 1e6,
                    state.strain,
                    state.plastic_strain,
                    state.tensile_strength / 1e6,
                ]
            )
            self.probes.append(np.column_stack([np.full(len(rows), time), rows]))

    def _contact_row(self) -> np.ndarray:
        """Values of `_contact_columns`; nothing without contact."""
        run = self.run
        if run.problem.contact is None:
            return np.zeros(0)
        sizes = run.sizes()
        forces = run.contact_forces()
        nodes, triangles, body, _ = run.mesh()
        body_of = np.zeros(len(nodes), dtype=int)
        body_of[triangles[::-1]] = body[::-1, None]
        sums = [forces[body_of == i].sum(axis=0) for i in range(len(run.problem.mesh.body_names))]
        length = 1e3 * run.cracks()[:, 6].sum()
        return np.concatenate([[sizes.contact_pairs, sizes.cracks, length], *sums])

    def _contact_columns(self) -> list[str]:
        if self.run.problem.contact is None:
            return []
        bodies = self.run.problem.mesh.body_names
        forces = [f"{name}_contact_force_{axis}_N" for name in bodies for axis in "xy"]
        return ["contact_pairs", "cracks", "crack_length_mm", *forces]

    def _note_fragments(self) -> None:
        """Add the fragments that have come loose since the last record."""
        edges = self.run.sizes().opened_edges
        if edges == self._edges_seen:
            return
        self._edges_seen = edges
        rows = fragments(self.run)
        self.fragments_now = len(rows)
        new = ~np.isin(rows[:, 1], self.fragments[:, 1])
        self.fragments = np.concatenate([self.fragments, rows[new]])

    def arrays(self) -> dict[str, np.ndarray]:
        """What a checkpoint keeps."""
        kept = {
            "history": np.array(self.history),
            "energy": np.array(self.energy),
            "fragments": self.fragments,
            "fragments_seen": np.array([self.fragments_now, self._edges_seen]),
        }
        return kept | ({"probes": np.array(self.probes)} if self.probes else {})

    def layout(self) -> Layout:
        """Types and shapes of `arrays`, once there is a record."""
        width = 2 + 2 * len(self.names) + len(self._contact_columns())
        found = {
            "history": ("f8", ("records", width)),
            "energy": ("f8", ("records", len(ENERGY_COLUMNS))),
            "fragments": ("f8", ("fragments", len(FRAGMENT_COLUMNS))),
            "fragments_seen": ("i8", (2,)),
        }
        probes = len(self.run.problem.probes)
        shape = ("records", probes, 1 + len(PROBE_COLUMNS))
        return found | ({"probes": ("f8", shape)} if probes else {})

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        """Take back what `arrays` gave."""
        self.history = list(arrays["history"])
        self.energy = list(arrays["energy"])
        self.probes = list(arrays.get("probes", []))
        self.fragments = arrays["fragments"]
        self.fragments_now, self._edges_seen = map(int, arrays["fragments_seen"])

    def history_table(self) -> pd.DataFrame:
        """Boundary records with the axial and lateral measures of the specimen.

        Axial stress and strain are positive in compression, lateral strain in extension,
        volumetric strain in dilation. Strains count from the end of the confinement
        (`Measures.start_time`).
        """
        rows = np.array(self.history)
        table = pd.DataFrame({"step": rows[:, 0].astype(int), "time_s": rows[:, 1]})
        for i, name in enumerate(self.names):
            table[f"{name}_force_N"] = rows[:, 2 + 2 * i]
            table[f"{name}_displacement_mm"] = 1e3 * rows[:, 3 + 2 * i]
        first = 2 + 2 * len(self.names)
        for i, name in enumerate(self._contact_columns()):
            table[name] = rows[:, first + i]
            if name in ("contact_pairs", "cracks"):
                table[name] = table[name].astype(int)
        return self._measures(table)

    def _measures(self, table: pd.DataFrame) -> pd.DataFrame:
        problem = self.run.problem
        measures = problem.measures
        if measures is None:
            return table
        load = next(x for x in problem.velocity_loads if x.name == measures.axial_load)
        nodes = problem.mesh.nodes
        middle = 0.5 * (nodes.min(axis=0) + nodes.max(axis=0))[load.component]
        outward = 1.0 if nodes[load.nodes, load.component].mean() > middle else -1.0
        force = -outward * table[f"{load.name}_force_N"]
        axial = -outward * 1e-3 * table[f"{load.name}_displacement_mm"] / measures.length
        table["axial_force_N"] = force
        table["axial_stress_MPa"] = force / measures.area / 1e6
        table["axial_strain"] = axial - _value_at(measures.start_time, table["time_s"], axial)
        if measures.lateral_load is not None:
            moved = 1e-3 * table[f"{measures.lateral_load}_displacement_mm"]
            lateral = moved / measures.lateral_length
            lateral = lateral - _value_at(measures.start_time, table["time_s"], lateral)
            table["lateral_strain"] = lateral
            ways = 2 if problem.axisymmetric else 1
            table["volumetric_strain"] = lateral * ways - table["axial_strain"]
        return table

    def energy_table(self) -> pd.DataFrame:
        """The ledger [J] per metre of depth or per radian, and its relative residual."""
        return pd.DataFrame(np.array(self.energy), columns=ENERGY_COLUMNS)

    def probe_table(self) -> pd.DataFrame:
        """One row a probe and record."""
        probes = self.run.problem.probes
        n_records = len(self.probes)
        table = pd.DataFrame(
            {
                "probe": np.tile(list(probes), n_records),
                "element": np.tile(np.fromiter(probes.values(), int), n_records),
            }
        )
        values = np.concatenate(self.probes)
        return table.assign(**dict(zip(["time_s", *PROBE_COLUMNS], values.T, strict=True)))


def _residual(ledger: Energy) -> float:
    """Inside minus outside [J]; fortran/run/energy.f90 divides it by the largest energy so far."""
    outside = ledger.external + ledger.damping + ledger.contact + ledger.friction
    outside += ledger.insertion + ledger.relump + ledger.turning + ledger.initial
    return ledger.kinetic + ledger.internal - outside


def _value_at(moment: float, times: pd.Series, values: pd.Series) -> float:
    """`values` at `moment` [s], linear between the records."""
    return float(np.interp(moment, times, values))
