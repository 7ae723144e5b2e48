"""Where a table softens, and which elements may follow it (config/regularise.py)."""

import numpy as np
import pytest

from lithofrac.config import ConfigError, Material, find_case
from lithofrac.config.regularise import softening_onset, width_limit
from lithofrac.scenes import make_mesh, make_problem

pytestmark = pytest.mark.no_core

CASE = "sandstone_triaxial_p10"
KEY = "material.reference_size_mm"


def table(strain, cohesion, friction=0.0, dilation=0.0):
    rows = np.broadcast_arrays(np.asarray(strain), cohesion, friction, dilation)
    return np.array(rows, dtype=float)


def sandstone(**changes) -> Material:
    keys = Material.load("sandstone").model_dump(mode="json", exclude_none=True) | changes
    keys = {key: value for key, value in keys.items() if value is not None}
    return Material.from_values(keys, "rock.yaml")


@pytest.mark.parametrize(
    ("name", "strain"), [("quartzite", 0.0015), ("sandstone", 0.0015), ("tyndall_limestone", 0.002)]
)
def test_table_1_softens_from_its_uniaxial_peak_on(name, strain):
    rock = Material.load(name)
    assert rock.table[0, softening_onset(rock.table)] == strain


def test_of_equal_strengths_the_last_counts():
    assert softening_onset(table([0.0, 0.1, 0.2, 0.3], [2.0, 3.0, 3.0, 1.0])) == 2
    assert softening_onset(table([0.0, 0.1], [2.0, 2.0])) == 1


def test_width_limit_of_a_cohesive_rock_is_the_closed_form():
    """Without friction and dilation q = 2 c, a = b = 1/2: by hand from eqs 7 and 8."""
    fall, young, poisson = 3e8, 1e9, 0.2
    rock = table([0.0, 0.01], [5e6, 5e6 - 0.01 * fall])
    triaxial = young / (2.0 * fall)  # dep = (1/4, 1/4, -1/2): the effective strain is 1/2
    plane = young / (1.0 - poisson**2) / (2.0 * fall * 2.0 / np.sqrt(3.0))
    assert width_limit(rock, young, poisson, 1e-3) == pytest.approx(1e-3 * min(triaxial, plane))
    assert width_limit(rock, young, poisson, 2e-3) == pytest.approx(2e-3 * min(triaxial, plane))


def test_a_table_that_never_softens_has_no_limit():
    assert width_limit(table([0.0, 0.1], [1e6, 2e6]), 1e9, 0.2, 1e-3) == float("inf")


def test_a_material_without_a_reference_follows_its_table_in_every_band():
    rock = Material.load("sandstone")
    assert (rock.reference_width, rock.compressive_width_limit) == (0.0, float("inf"))
    np.testing.assert_array_equal(rock.table_of_band(1e-9), rock.table)


def test_rows_beyond_the_onset_are_stretched_by_reference_over_width():
    rock = sandstone(reference_size_mm=1.0)
    np.testing.assert_array_equal(rock.table_of_band(1e-3), rock.table)
    strain = rock.table_of_band(0.5e-3)[0]
    np.testing.assert_array_equal(strain[:4], rock.table[0, :4])
    np.testing.assert_allclose(strain[4:] - 0.0015, 2.0 * (rock.table[0, 4:] - 0.0015))
    np.testing.assert_array_equal(rock.table_of_band(0.5e-3)[1:], rock.table[1:])


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"reference_size_mm": 0.0}, "reference_size_mm = 0.0: expected"),
        (
            {"reference_size_mm": 1.0, "compression": False},
            "reference_size_mm = 1: there is no compressive softening to scale, leave it out",
        ),
        (
            {"reference_size_mm": 1.0, "elastic": True},
            "reference_size_mm = 1: there is no compressive softening to scale, leave it out",
        ),
        (
            {"reference_size_mm": 1.0, "cohesion_MPa": [20.0] * 8},
            "reference_size_mm = 1: the uniaxial strength is largest in the last row of the table, "
            "which never softens, leave it out",
        ),
    ],
)
def test_a_reference_without_use_is_refused(changes, why):
    with pytest.raises(ConfigError) as caught:
        sandstone(**changes)
    assert why in str(caught.value)


def test_elements_that_would_snap_back_are_refused_with_the_limit():
    """The limit for sandstone is 1.246 of the reference, see the closed form above."""
    find_case(CASE, None, {KEY: 1.0, "scene.element_size_mm": 1.2})
    with pytest.raises(ConfigError) as caught:
        find_case(CASE, None, {KEY: 1.0, "scene.element_size_mm": 1.25})
    assert (
        "scene.element_size_mm = 1.25: crack band width 1.25 mm of the largest element is not "
        "below the limit of 1.246 mm for material.reference_size_mm = 1, above which compressive "
        "softening is steeper than elastic unloading"
    ) in str(caught.value)


def test_the_largest_element_of_the_mesh_decides():
    size = {"scene.element_size_mm": 2.5}
    mesh = make_mesh(find_case(CASE, None, size))
    width = float(Material.load("sandstone").band_width_of(mesh.areas().max()))
    share = sandstone(reference_size_mm=1.0).compressive_width_limit / 1e-3
    assert width > 2.503e-3, "larger than the nominal size, which is looked at first"
    make_problem(find_case(CASE, None, {**size, KEY: 1.001e3 * width / share}), mesh)
    case = find_case(CASE, None, {**size, KEY: 2.503 / share})
    with pytest.raises(ConfigError, match="steeper than elastic unloading"):
        make_problem(case, mesh)
