"""What a run will take, from its case alone: for a scheduler, which asks before anything is meshed.

Elements are those of `element_count` and of the platens; steps are the duration of the test over
the time step of its smallest elements. `SAFETY` covers what that leaves out. Rates and shares were
measured on the suite; reports/guide/cluster.md says how near its runs come.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from lithofrac.config.case import Case
from lithofrac.config.element_count import element_count
from lithofrac.config.errors import ConfigError
from lithofrac.config.gmsh_file import GmshFile
from lithofrac.config.loading import TractionLoading
from lithofrac.config.scene import (
    Bar,
    Brazilian,
    Hole,
    HoleInBlock,
    Punch,
    Scene,
    SingleElement,
)

# Element-steps per second of one core, from continuum runs of the suite: nothing yields; a part
# between bodies that touch, where most stays elastic (9.7e6 to 16e6, up to its peak 22e6); a
# specimen in plane strain, all of which yields beyond its peak (7.4e6 to 14e6); the same in
# axisymmetry (6.3e6 to 9.4e6). Without confinement it fails in tension, point by point.
ELASTIC_RATE, PARTLY_RATE, PLANE_RATE, AXIAL_RATE = 60e6, 12.5e6, 10.5e6, 8e6
TOUCHING_RATE = 45e6  # nothing yields, but bodies touch
PLANE_UNCONFINED_RATE, AXIAL_UNCONFINED_RATE = 7e6, 3e6
EXPLICIT_SLOWER = 8  # times: every choice of tension planes is tried
# Beside that: of each step, of each record with its ledger and guards, of each element in a frame,
# and of each run with its tables. Single elements and the wave in a bar take nothing else.
STEP_SECONDS, RECORD_SECONDS, FRAME_SECONDS, RUN_SECONDS = 6e-6, 4e-5, 4e-6, 0.025
# Time step at factor 1 over the time of a pressure wave along the nominal edge length: of equal
# right-angled triangles, and of the worst of an unstructured mesh.
STRUCTURED_STEP, UNSTRUCTURED_STEP = 0.65, 0.45
CUT_STEP = 0.44  # over that step, once cracks cut elements

SAFETY = 4  # of the time limit: the slowest run of the suite took 2.1 times its prediction
START_MINUTES = 5  # in each limit, to start Python and mesh, on a file system that is slow
BASE_MB = 1000  # a run takes 220, and Snakemake stands beside it in the job
BYTES_PER_ELEMENT = 2000  # of which the core takes less than half
ELEMENTS_A_THREAD, MOST_THREADS = 20_000, 8  # choice: runs side by side use cores better
SHORT_SECONDS = 120.0  # choice: up to here a job of its own would be mostly waiting
OWN_ELEMENTS, OWN_STEPS = (
    20_000,
    500_000,
)  # choice: a geometry of one's own tells its size to gmsh only


@dataclass(frozen=True)
class Cost:
    """Prediction for one run.

    Attributes
    ----------
    elements : of rock and platens
    steps : of time
    seconds : on one core
    """

    elements: float
    steps: float
    seconds: float

    @property
    def threads(self) -> int:
        """Cores that are worth asking for."""
        return max(1, min(MOST_THREADS, int(self.elements / ELEMENTS_A_THREAD)))

    @property
    def mem_mb(self) -> int:
        """Memory to ask for [MB]."""
        return math.ceil(BASE_MB + BYTES_PER_ELEMENT * self.elements / 1e6)

    @property
    def runtime(self) -> int:
        """Time limit to ask for [min]: one thread, `SAFETY` and `START_MINUTES` in it."""
        return START_MINUTES + math.ceil(SAFETY * self.seconds / 60)

    @property
    def group(self) -> str | None:
        """`short` where several runs should share a job of the cluster."""
        return "short" if self.seconds <= SHORT_SECONDS else None


def predicted(case: Case) -> Cost:
    """What a run of the case will take, good to a factor of 1.5 in elements and steps.

    Of a geometry from a file nothing is known before gmsh reads it: a fixed, ample guess.
    """
    if isinstance(case.scene, GmshFile):
        return Cost(OWN_ELEMENTS, OWN_STEPS, OWN_ELEMENTS * OWN_STEPS / PLANE_RATE)
    bodies = [(element_count(case.scene), *_rock(case)), *_platens(case)]
    elements = sum(count for count, _, _ in bodies)
    step = case.time_step_factor * min(share * size for _, share, size in bodies)
    if case.fracture.mode == "intra_element":
        step *= CUT_STEP
    steps = max(1.0, _duration(case) / step)
    confined = getattr(case.loading, "confinement", 0.0) > 0.0
    rate = rate_of(
        [case.material.options], case.contact is not None, _is_axial(case.scene), confined
    )
    seconds = run_seconds(elements, steps, case.output.records, case.output.fields, rate)
    return Cost(elements, steps, seconds)


def refuse_above_budget(case: Case) -> None:
    """Refuse what is above `budget_element_steps` by prediction, where nothing is meshed.

    Raises
    ------
    ConfigError
        With the prediction.
    """
    cost = predicted(case)
    if isinstance(case.scene, GmshFile) or cost.elements * cost.steps <= case.budget_element_steps:
        return
    raise ConfigError(
        f"budget_element_steps = {case.budget_element_steps:g}: the run takes about "
        f"{cost.elements:.2g} elements times {cost.steps:.2g} steps"
    )


def rate_of(
    options: Sequence[Sequence[int]], contact: bool, axisymmetric: bool, confined: bool
) -> float:
    """Element-steps per second of one core; `options` are `Material.options` of all bodies."""
    if not any(yields for *_, yields in options):
        return TOUCHING_RATE if contact else ELASTIC_RATE
    slower = EXPLICIT_SLOWER if any(explicit for _, explicit, *_ in options) else 1
    if contact:
        return PARTLY_RATE / slower
    if axisymmetric:
        return (AXIAL_RATE if confined else AXIAL_UNCONFINED_RATE) / slower
    return (PLANE_RATE if confined else PLANE_UNCONFINED_RATE) / slower


def run_seconds(elements: float, steps: float, records: int, frames: int, rate: float) -> float:
    """Time of a run on one core [s]; there are no more records than steps."""
    beside = steps * STEP_SECONDS + min(steps, records) * RECORD_SECONDS + RUN_SECONDS
    return elements * (steps / rate + frames * FRAME_SECONDS) + beside


def _is_axial(scene: Scene) -> bool:
    return scene.kind == "triaxial" or getattr(scene, "axisymmetric", False)


def _rock(case: Case) -> tuple[float, float]:
    """Share of the wave's time, and that time for the smallest elements of the rock [s]."""
    scene = case.scene
    size = scene.element_size
    if isinstance(scene, HoleInBlock):
        size = min(size, scene.wall_size)
    if isinstance(scene, Punch):
        size = scene.fine_size
    equal = isinstance(scene, SingleElement) or getattr(scene, "structured", False)
    return STRUCTURED_STEP if equal else UNSTRUCTURED_STEP, size / case.material.wave_speed


def _platens(case: Case) -> list[tuple[float, float, float]]:
    """For each platen its elements, share and time, as in `_rock`."""
    if case.platens is None:
        return []
    platens, found = case.platens, []
    for length, size in _fronts(case.scene, 2 * platens.overhang):
        own = size * platens.element_size_over_rock
        count = 2 * max(1.0, length / own) * max(1.0, platens.thickness / own)
        found.append((count, STRUCTURED_STEP, own / platens.material.wave_speed))
    return found


def _fronts(scene: Scene, more: float) -> list[tuple[float, float]]:
    """Length of the face of each platen, and size of the rock's elements there [m]."""
    size = scene.element_size
    if isinstance(scene, Punch):
        beside = (scene.block_height, (scene.fine_size + size) / 2)
        return [(scene.strip_width + more, scene.fine_size), beside, beside]
    if isinstance(scene, Hole):
        return [(scene.height + more, size)]
    if isinstance(scene, Brazilian):
        return 2 * [(scene.flat_width + more, size)]
    sides = 2 * [(scene.height, size)] if scene.lateral_platens else []
    return 2 * [(scene.width + more, size)] + sides


def _duration(case: Case) -> float:
    """Time of the test [s]."""
    scene, loading, material = case.scene, case.loading, case.material
    transit = scene.height / material.wave_speed
    ramp = loading.ramp_transits * transit
    if isinstance(loading, TractionLoading):
        return ramp + loading.hold_transits * transit
    one_end = isinstance(scene, (SingleElement, Bar, Punch))
    length = scene.height if one_end else scene.height / 2
    confined = loading.confinement * (1 - 2 * material.poisson) / material.young
    before = ramp if loading.confinement > 0.0 else 0.0
    return before + ramp / 2 + (confined + loading.end_strain) * length / loading.speed
