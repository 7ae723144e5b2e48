"""One case: a scene, a material and how it is loaded, checked before anything is computed."""

from collections.abc import Mapping
from pathlib import Path
from typing import Literal

from pydantic import Field, ValidationError, model_validator

from lithofrac.config.base import MM, Coordinate, Section
from lithofrac.config.element_count import MOST_ELEMENTS, element_count
from lithofrac.config.errors import ConfigError, sentences
from lithofrac.config.extend import Draft, nested, read_draft
from lithofrac.config.loading import Loading, TractionLoading, VelocityLoading
from lithofrac.config.material import Material, find_material
from lithofrac.config.scene import SIZE_KEYS, Scene
from lithofrac.config.yaml_file import read_yaml


class DampingSection(Section):
    """Mass-proportional damping (Klerck 2004, eqs 1-3)."""

    fraction: float = Field(default=0.3, ge=0.0, lt=1.0)
    """Fraction of critical damping of the lowest frequency; 0 is none."""
    alpha_1_s: float | None = Field(default=None, ge=0.0, le=1e12)
    """A fixed factor alpha instead of one from the lowest frequency found at run time."""
    relative_to: Literal["affine", "ground"] = "affine"
    """Damp the motion relative to the affine fit of each body, or all motion (eq. 3)."""


class MeshSection(Section):
    """Which of the many meshes of equal density is taken."""

    seed: int = Field(default=1, ge=1, le=2**31 - 1)
    """Realisation; each seed gives another mesh, always the same one."""


class Output(Section):
    """What a run writes."""

    records: int = Field(default=1000, ge=2, le=10_000_000)
    """Rows of the history."""
    fields: int = Field(default=5, ge=0, le=10_000)
    """Frames of the fields, 0 for none."""


class Probe(Section):
    """A point; the element whose centroid is nearest to it is recorded."""

    x_mm: Coordinate
    y_mm: Coordinate

    @property
    def point(self) -> tuple[float, float]:
        """Position [m]."""
        return self.x_mm * MM, self.y_mm * MM


class Case(Section):
    """One run of the suite, as its file describes it."""

    title: str
    material: Material
    scene: Scene
    loading: Loading
    damping: DampingSection = DampingSection()
    mesh: MeshSection = MeshSection()
    time_step_factor: float = Field(default=0.9, ge=1e-6, le=1.0)
    """Time step over the exact limit of the most critical element."""
    probes: dict[str, Probe] = Field(default_factory=dict)
    """Points to record, beside those that the scene has anyway."""
    output: Output = Output()

    @model_validator(mode="after")
    def _parts_fit_together(self):
        problems = [*_loading_problems(self.scene, self.loading), *_size_problems(self)]
        problems += _count_problems(self.scene)
        if problems:
            raise ValueError("\n".join(problems))
        return self

    def resolved(self) -> dict:
        """All keys with their values in force; loading them again gives an equal case."""
        return self.model_dump(mode="json", exclude_none=True)


def load_case(path: Path | str, overrides: Mapping | None = None) -> Case:
    """Read a case, what it extends, and its material.

    Parameters
    ----------
    path : the case file
    overrides : keys that replace those of the file, nested or dotted

    Raises
    ------
    ConfigError
        With one sentence per mistake, one per line.
    """
    draft = read_draft(Path(path))
    draft.put(nested(overrides or {}), "command line", Path())
    return check_case(draft)


def check_case(draft: Draft) -> Case:
    """Turn merged keys into a case; see `load_case`."""
    problems = []
    material = draft.values.get("material")
    if isinstance(material, str) or (isinstance(material, Mapping) and "extends" in material):
        try:
            _fill_in_material(draft)
        except ConfigError as error:
            problems.append(str(error))
            draft.values["material"] = _ANY
    try:
        case = Case.model_validate(draft.values)
    except ValidationError as error:
        problems.append(str(sentences(error, Case, draft.file_of)))
    if problems:
        raise ConfigError("\n".join(problems))
    return case


_ANY = Material(elastic=True, young_modulus_GPa=1.0, poisson_ratio=0.0, density_kg_m3=1.0)


def _fill_in_material(draft: Draft) -> None:
    """Put the keys of a named material below those that the case gives itself."""
    own = draft.values["material"]
    own = dict(own) if isinstance(own, Mapping) else {"extends": own}
    name = own.pop("extends")
    where = draft.file_of(("material", "extends"))
    if not isinstance(name, str):
        raise ConfigError(f"{where}: material.extends: expected a text, the name of a material")
    try:
        path = find_material(name, draft.beside)
    except ConfigError as error:
        raise ConfigError(f"{where}: {error}") from None
    files = {key: draft.file_of(("material", key)) for key in own}
    draft.put({"material": None}, str(path))
    draft.put({"material": read_yaml(path)}, str(path))
    for key, value in own.items():
        draft.put({"material": {key: value}}, files[key])


def _loading_problems(scene: Scene, loading: Loading) -> list[str]:
    """Keys of the loading that the scene has no place for."""
    kind = scene.kind
    if isinstance(loading, TractionLoading):
        if kind in ("hole_quarter", "bar"):
            return []
        return [f"loading.kind = traction: the scene {kind} is loaded by velocity only"]
    assert isinstance(loading, VelocityLoading)
    problems = []
    if loading.confinement_MPa > 0 and kind in ("hole_quarter", "bar"):
        problems.append(
            f"loading.confinement_MPa = {loading.confinement_MPa:g}: the scene {kind} has no "
            "confined faces, expected 0"
        )
    if loading.lateral_stiffness_over_young > 0 and kind != "plane_strain":
        problems.append(
            f"loading.lateral_stiffness_over_young = {loading.lateral_stiffness_over_young:g}: "
            f"the scene {kind} has no lateral platens, expected 0"
        )
    if loading.sense == "stretch" and loading.confinement_MPa > 0:
        problems.append(
            "loading.sense = stretch: the ends cannot follow a confinement first, expected shorten"
        )
    return problems


def _size_problems(case: Case) -> list[str]:
    """Refuse elements above the limit of unique tension returns, by their nominal size."""
    nominal = case.scene.element_size
    width = case.material.band_width_of(0.5 * nominal**2)
    if width < case.material.band_width_limit:
        return []
    key = SIZE_KEYS.get(case.scene.kind, "element_size_mm")
    return [f"scene.{key} = {getattr(case.scene, key):g}: {too_large(case.material, width)}"]


def _count_problems(scene: Scene) -> list[str]:
    """Refuse meshes that would take hours or all memory, before gmsh is started."""
    count = element_count(scene)
    if count <= MOST_ELEMENTS:
        return []
    key = "wall_elements_per_radius" if scene.kind == "hole_quarter" else "element_size_mm"
    return [
        f"scene.{key} = {getattr(scene, key):g}: about {count:.2g} elements, expected at most "
        f"{MOST_ELEMENTS}"
    ]


def too_large(material: Material, width: float) -> str:
    """Why elements of crack band width `width` [m] are refused."""
    return (
        f"crack band width {width / MM:.4g} mm of the largest element is not below the limit of "
        f"{material.band_width_limit / MM:.4g} mm, 2 Gf E / ((1 + nu) ft^2), above which softening "
        "has no unique answer"
    )
