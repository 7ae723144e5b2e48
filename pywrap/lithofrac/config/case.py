"""One case: a scene, a material and how it is loaded, checked before anything is computed."""

from collections.abc import Mapping
from pathlib import Path
from typing import Literal

from pydantic import Field, ValidationError, model_validator

from lithofrac.config.base import MM, Coordinate, Section
from lithofrac.config.contact import ContactSection
from lithofrac.config.errors import ConfigError, sentences
from lithofrac.config.extend import GEOMETRY, Draft, nested, read_draft
from lithofrac.config.fit import misfits
from lithofrac.config.fracture import FractureSection
from lithofrac.config.guards import GuardsSection
from lithofrac.config.loading import Loading
from lithofrac.config.material import Material, find_material
from lithofrac.config.platens import PlatensSection
from lithofrac.config.scene import Scene
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
    checkpoint_seconds: float = Field(default=20.0, ge=0.0, le=1e6)
    """Wall time between two checkpoints, 0 for one at every record; no number depends on it."""


class Probe(Section):
    """A point; the element whose centroid is nearest to it is recorded."""

    x_mm: Coordinate
    """Place of the point across; in axisymmetry its radius."""
    y_mm: Coordinate
    """Height of the point."""

    @property
    def point(self) -> tuple[float, float]:
        """Position [m]."""
        return self.x_mm * MM, self.y_mm * MM


class Case(Section):
    """One run of the suite, as its file describes it."""

    title: str
    """What the run is, in a few words."""
    material: Material
    """Of the rock: name of a file in `configs/materials`, path of one, its keys themselves, or
    `extends:` with a name and the keys that differ."""
    scene: Scene
    """Geometry, one kind of several."""
    loading: Loading
    """How it is loaded."""
    damping: DampingSection = DampingSection()
    mesh: MeshSection = MeshSection()
    platens: PlatensSection | None = None
    """Bodies that press on the rock; without it, the faces of the rock are moved themselves."""
    contact: ContactSection | None = None
    """Friction of all surfaces; without it, parts pass through each other."""
    fracture: FractureSection = FractureSection()
    """Discrete cracks, or `off`."""
    time_step_factor: float = Field(default=0.9, ge=1e-6, le=1.0)
    """Time step over the exact limit of the most critical element."""
    probes: dict[str, Probe] = Field(default_factory=dict)
    """Points to record, beside those that the scene has anyway."""
    output: Output = Output()
    budget_element_steps: float = Field(default=1e12, ge=1.0, le=1e18)
    """Elements times steps above which the case is refused; the default is two days on one core."""
    guards: GuardsSection = GuardsSection()
    """When a run is worth a warning, and when it is stopped."""

    @model_validator(mode="after")
    def _parts_fit_together(self):
        problems = misfits(self)
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
    for at in draft.materials:
        holder = draft.holder(at)
        own = holder.get(at[-1])
        if isinstance(own, str) or (isinstance(own, Mapping) and "extends" in own):
            try:
                _fill_in_material(draft, at)
            except ConfigError as error:
                problems.append(str(error))
                holder[at[-1]] = _ANY
    file = draft.holder(GEOMETRY).get(GEOMETRY[-1])
    if isinstance(file, str):
        draft.holder(GEOMETRY)[GEOMETRY[-1]] = str(draft.folder_of(GEOMETRY) / file)
    try:
        case = Case.model_validate(draft.values)
    except ValidationError as error:
        problems.append(str(sentences(error, Case, draft.file_of)))
    if problems:
        raise ConfigError("\n".join(problems))
    return case


_ANY = Material(elastic=True, young_modulus_GPa=1.0, poisson_ratio=0.0, density_kg_m3=1.0)


def _fill_in_material(draft: Draft, at: tuple) -> None:
    """Put the keys of a named material below those that the case gives itself."""
    own = draft.holder(at)[at[-1]]
    own = dict(own) if isinstance(own, Mapping) else {"extends": own}
    name = own.pop("extends")
    where = draft.file_of((*at, "extends"))
    if not isinstance(name, str):
        key = ".".join((*at, "extends"))
        raise ConfigError(f"{where}: {key}: expected a text, the name of a material")
    try:
        path = find_material(name, draft.folder_of(at))
    except ConfigError as error:
        raise ConfigError(f"{where}: {error}") from None
    files = {key: draft.file_of((*at, key)) for key in own}
    above = at[:-1]
    draft.put({at[-1]: None}, str(path), at=above)
    draft.put({at[-1]: read_yaml(path)}, str(path), at=above)
    for key, value in own.items():
        draft.put({at[-1]: {key: value}}, files[key], at=above)
