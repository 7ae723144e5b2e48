"""Variants over their twins (plots/variants.py)."""

import pytest

from lithofrac.data import DataError
from lithofrac.plots import variants

pytestmark = pytest.mark.no_core


@pytest.fixture
def inputs(tmp_path, make_run):
    """A twin and four variants: two rows, the second with one panel."""
    names = [f"block_{number}" for number in range(4)]
    lines = [f"  {name}: {{extends: cases/bar.yaml, twin: block}}\n" for name in names]
    suite = tmp_path / "suite.yaml"
    suite.write_text("title: t\ncases:\n  block: {extends: cases/bar.yaml}\n" + "".join(lines))
    runs = [make_run(name, confinement=5.0 * i) for i, name in enumerate(["block", *names])]
    return [suite, *runs]


def test_every_variant_has_a_panel_with_its_twin(inputs, data_folder):
    panels = [axes for axes in variants.figure(inputs, data_folder).axes if axes.axison]
    assert len(panels) == 4
    for panel in panels:
        curves = [line for line in panel.lines if len(line.get_xdata()) > 100]
        assert len(curves) == 2
        assert curves[0].get_linewidth() > curves[1].get_linewidth()


def test_titles_name_the_twin_and_what_differs(inputs, data_folder):
    panel = variants.figure(inputs, data_folder).axes[0]
    assert panel.get_title(loc="left") == "block\nloading.confinement_MPa: 5.0"


def test_outer_panels_have_labels_with_units(inputs, data_folder):
    panels = variants.figure(inputs, data_folder).axes
    lowest = [panel.get_xlabel() for panel in panels if panel.axison]
    assert lowest == ["", "axial strain [%]", "axial strain [%]", "axial strain [%]"]
    assert [panels[i].get_ylabel() for i in (0, 3)] == ["axial stress [MPa]"] * 2


def test_nothing_to_compare_is_an_error(inputs, data_folder):
    with pytest.raises(DataError, match="expected at least one pair"):
        variants.figure(inputs[:2], data_folder)
