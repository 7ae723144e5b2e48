"""Rows of the benchmark (pywrap/lithofrac/benchmark/) on blocks too small to tell a speed."""

import numpy as np
import pytest

from lithofrac.benchmark import blocks, machine, race, rows
from lithofrac.config import Material

SPEED = "million_element_steps_per_core_second"


@pytest.fixture(autouse=True)
def short(monkeypatch):
    monkeypatch.setattr(race, "ELEMENT_STEPS", 1e4)
    monkeypatch.setattr(rows, "CONTACT_STEPS", 20)
    monkeypatch.setattr(machine, "MATRIX", 16)


def test_pieces_keep_the_area_and_share_no_node():
    mesh = blocks.rectangle(0.08, 0.08, 0.01, structured=True, seed=1)
    cut = blocks.in_pieces(mesh, 0.02)
    assert len(cut.nodes) == 16 * 9
    np.testing.assert_allclose(cut.areas(), mesh.areas())
    np.testing.assert_array_equal(cut.nodes[cut.triangles], mesh.nodes[mesh.triangles])


@pytest.fixture
def small_pieces(monkeypatch):
    monkeypatch.setattr(blocks, "PIECES", {"0.1": {8: 4}, "some": {8: 4}})


def test_a_discrete_row_tells_what_its_pairs_cost(small_pieces):
    one, two = rows.discrete_rows(cells=8, pairs="some", repeat=2)
    assert one["name"] == "discrete_step_pairs_some"
    assert one["elements"] == 128
    assert 16 <= one["pairs"] <= 40
    assert np.isfinite(one["ns_per_pair"])
    assert one["time_over_uncut"] > 0.0
    assert one["lowest"] <= one[SPEED] <= one["highest"]
    assert (one["threads"], two["threads"]) == (1, 2)
    assert one["pairs"] == two["pairs"]  # threads change no bit


def test_a_discrete_row_is_held_against_the_block_in_one_piece(small_pieces, monkeypatch):
    """Each subject is known by its nodes: 81 of the block, 100 of four pieces."""
    raced = {}

    def race_of(subjects, elements, repeat):
        raced.update({name: subject.steps for name, subject in subjects.items()})
        speeds = {
            name: race.Speeds([1e4 / subject.steps], [1.0]) for name, subject in subjects.items()
        }
        return speeds

    monkeypatch.setattr(blocks, "bare", lambda mesh, rock: len(mesh.nodes))
    monkeypatch.setattr(blocks, "stepper", lambda run, threads=1: len(run.problem.mesh.nodes))
    monkeypatch.setattr(rows, "race", race_of)
    one, _ = rows.discrete_rows(cells=8, pairs="some", repeat=1)
    assert raced == {
        rows.BARE: 81,
        "uncut": 81,
        "discrete_step_pairs_some": 100,
        "discrete_step_pairs_some, 2 threads": 100,
    }
    assert one["time_over_uncut"] == pytest.approx(100 / 81)


def test_the_full_discrete_step_looks_for_cracks_and_finds_none(small_pieces):
    found = rows.discrete_rows(cells=8, pairs="0.1", repeat=1)
    names = ("discrete_step_pairs_0.1", "discrete_step_full_0.1", "discrete_step_damped_0.1")
    assert [(row["name"], row["threads"]) for row in found] == [
        (n, t) for n in names for t in (1, 2)
    ]
    assert [row["cracks"] for row in found] == 6 * [0]
    for make, fraction in ((blocks.full_pieces, 0.0), (blocks.damped_pieces, 0.3)):
        made = make(blocks.cut_square(8, "0.1"), Material.load("quartzite")).problem
        assert made.fracture.mode == "inter_element"
        assert len(made.probes) == 1
        assert made.damping.fraction == fraction
        assert made.contact.default_friction == blocks.FRICTION


def test_damping_is_that_of_a_case_without_keys():
    assert (blocks.DAMPED.fraction, blocks.DAMPED.relative_to) == (0.3, "affine")


def test_a_step_takes_its_records(monkeypatch):
    taken = []

    class Recorder:
        def __init__(self, run):
            self.run = run

        def record(self):
            taken.append(self.run.step)

    monkeypatch.setattr(blocks, "Recorder", Recorder)
    run = blocks.Run(blocks.pressed(blocks.square(4), Material.load("quartzite")))
    blocks.stepper(run)(300)
    assert taken == [blocks.WARM_UP + blocks.EVERY * i for i in (1, 2, 3)]


def test_two_threads_gain_what_the_wall_says():
    """Half the time on the wall at the same processor time."""
    one, two = race.Speeds(core=[10.0], wall=[10.0]), race.Speeds(core=[10.0], wall=[20.0])
    entries = [rows.row("a", 128, 1, one, one), rows.row("a", 128, 2, two, one)]
    found = rows.with_threads(entries, {"a": one, "a, 2 threads": two})
    assert "speed_up" not in found[0]
    assert found[1]["speed_up"] == pytest.approx(2.0)


def test_blocks_of_many_elements_have_few_windows(monkeypatch):
    asked = []
    monkeypatch.setattr(rows, "continuum_rows", lambda cells, repeat: [])
    monkeypatch.setattr(rows, "yielding_rows", lambda cells, repeat: [])
    monkeypatch.setattr(rows, "discrete_rows", lambda *given: asked.append(given) or [])
    assert list(rows.measure(5)) == []
    assert asked[:3] == [(50, "0.02", 5), (158, "0.02", 5), (316, "0.02", 3)]
    assert len(asked) == 9


def test_continuum_rows_are_paired_with_the_bare_kernel():
    found = rows.continuum_rows(cells=8, repeat=1)
    assert found[0]["name"] == "bare_elastic_kernel"
    assert found[0]["of_bare_kernel"] == 1.0
    damped = ("elastic_step_damped", "full_step_damped")
    names = ("elastic_step", "full_step", *damped, "axisymmetric_step")
    expected = [(name, threads) for name in names for threads in (1, 2)]
    assert [(row["name"], row["threads"]) for row in found[1:]] == expected
    for row in found:
        # one window: the ratio is that of the two speeds
        assert row["of_bare_kernel"] == pytest.approx(row[SPEED] / found[0][SPEED])
        assert ("speed_up" in row) == (row["threads"] == 2)
        counted = row["threads"] == 1 and row["name"] not in damped
        assert ("roofline_fraction" in row) == counted
    assert len({row["bandwidth_GB_s"] for row in found if "bandwidth_GB_s" in row}) == 1


def test_a_layer_yields_in_every_step_and_nothing_else_does():
    found = rows.yielding_rows(cells=8, repeat=2)
    assert [row["returns_per_step"] for row in found] == [1, 1, 13, 13, 128, 128]
    for row in found:
        assert row["only_these_yield"]
        expected = row[SPEED] * row["returns_per_step"] / row["elements"]
        assert row["million_returns_per_core_second"] == pytest.approx(expected)


def test_a_block_below_its_strength_does_not_yield():
    run = blocks.Run(blocks.pressed(blocks.square(8), Material.load("quartzite")))
    assert [len(found) for found in blocks.elements_that_yield(run, 3)] == [0, 0, 0]


def test_setup_is_no_part_of_a_step():
    """Twice the wait of the steps is set-up: without it they are three times as fast."""
    clock = [0.0]

    def steps(count):
        clock[0] += 2.0 + 0.01 * count

    subjects = {
        "with": race.Subject(steps, count=100),
        "without": race.Subject(steps, count=100, has_setup=True),
    }
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(race.time, "process_time", lambda: clock[0])
        patch.setattr(race.time, "perf_counter", lambda: clock[0])
        speeds = race.race(subjects, elements=1_000_000, repeat=2)
    assert speeds["with"].core == pytest.approx([100.0 / 3.0] * 2)
    assert speeds["without"].wall == pytest.approx([100.0] * 2)
    assert race.seconds_a_step(speeds["without"].core, 1_000_000) == pytest.approx(0.01)


def test_all_steps_are_counted_in_bytes_and_flops():
    assert set(machine.BYTES) == set(machine.FLOPS)
    # 11 reals less stored stress, 6 indices more: hand count of the full step
    assert machine.BYTES["full_step"] == 8 * (5 + 0.5 * (6 + 18)) + 4 * 6
    assert machine.roofline("full_step_yielding_10", 1.0, 1e9, 1e9) == {}


def test_the_share_of_the_roof_is_of_the_lower_one():
    found = machine.roofline("full_step", 1.0, 1e15, 1e9)
    assert found["roofline_fraction"] == pytest.approx(1e6 / (1e9 / machine.BYTES["full_step"]))
    found = machine.roofline("full_step", 1.0, 1e6, 1e9)
    assert found["roofline_fraction"] == pytest.approx(machine.FLOPS["full_step"])


@pytest.mark.one_build  # what a special build takes of memory tells nothing
@pytest.mark.parametrize(("pairs", "cells", "elements"), [(None, 64, 8192), ("0.1", 50, 5000)])
def test_memory_is_that_of_the_elements(monkeypatch, pairs, cells, elements):
    monkeypatch.setattr(machine, "MEMORY_CELLS", (23, cells))
    used = machine.memory(pairs)
    assert used["elements"] == elements
    assert (used["pairs"] > 0.05 * elements) == (pairs is not None)
    assert 100 < used["resident_bytes_per_element"] <= used["peak_bytes_per_element"] < 1e5
