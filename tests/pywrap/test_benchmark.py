"""Rows of the benchmark (pywrap/lithofrac/benchmark.py) on blocks too small to tell a speed."""

import numpy as np
import pytest

from lithofrac import benchmark
from lithofrac.scenes._rectangle import rectangle


@pytest.fixture(autouse=True)
def short(monkeypatch):
    monkeypatch.setattr(benchmark, "ELEMENT_STEPS", 1e4)


def test_pieces_keep_the_area_and_share_no_node():
    mesh = rectangle(0.08, 0.08, 0.01, structured=True, seed=1)
    cut = benchmark.in_pieces(mesh, 0.02)
    assert len(cut.nodes) == 16 * 9
    np.testing.assert_allclose(cut.areas(), mesh.areas())
    np.testing.assert_array_equal(cut.nodes[cut.triangles], mesh.nodes[mesh.triangles])


def test_a_discrete_row_tells_what_its_pairs_cost(monkeypatch):
    monkeypatch.setattr(benchmark, "PIECES", {"some": 4})
    row = benchmark.discrete_row(cells=8, pairs="some", repeat=2)
    assert row["name"] == "discrete_step_pairs_some"
    assert row["elements"] == 128
    assert 16 <= row["pairs"] <= 40
    assert np.isfinite(row["ns_per_pair"])
    assert row["time_over_no_contact"] > 0.0
    assert row["lowest"] <= row["million_element_steps_per_core_second"] <= row["highest"]


def test_continuum_rows_are_paired_with_the_bare_kernel():
    rows = benchmark.continuum_rows(cells=8, repeat=1)
    assert rows[0]["name"] == "bare_elastic_kernel"
    assert rows[0]["of_bare_kernel"] == 1.0
    assert len(rows) == 4
