"""How a cell is judged (pywrap/lithofrac/stability/judge.py): each verdict can be had."""

from dataclasses import replace

import pytest

from lithofrac.core import Run
from lithofrac.errors import CoreError
from lithofrac.stability import limit
from lithofrac.stability.cell import CONTINUUM, Cell, Left, Limits, Refused, Sound, Stable
from lithofrac.stability.judge import COLUMNS, Seen, faults_of, find_margin, judge, run_trial


def cell(expected):
    return Cell("family", "extreme", CONTINUUM, expected)


def too_long():
    trial = limit.one_element()
    return replace(trial, problem=replace(trial.problem, time_step_factor=1.1))


def refuse():
    raise CoreError("density must be positive")


def test_a_good_run_is_stable_and_its_row_is_whole():
    row = judge(cell(Stable(limit.one_element)))
    assert tuple(row) == COLUMNS
    assert row["verdict"] == "stable"
    assert 0.0 < row["energy_residual"] < 1e-6
    assert row["penetration_over_h"] is None


def test_a_free_element_breaks_at_its_exact_limit():
    margin, ended = find_margin(limit.one_element())
    assert margin == pytest.approx(1.0, abs=0.011)
    assert ended


def test_a_run_above_its_limit_is_broken():
    row = judge(cell(Stable(too_long)))
    assert row["verdict"] == "broken"
    assert "internal energy" in row["note"]
    assert row["margin"] is None


def test_a_run_that_misses_a_limit_is_broken_and_says_which():
    row = judge(cell(Stable(limit.one_element, Limits(speed=1e-9))))
    assert row["verdict"] == "broken"
    assert row["note"].startswith("speed over that of waves")


@pytest.mark.parametrize(
    ("seen", "words"),
    [
        (Seen(residual=2e-6), "energy residual 2.0e-06, expected at most 1e-06"),
        (Seen(residual=float("nan")), "energy residual nan"),
        (Seen(gain=11.0), "internal energy over that put in"),
        (Seen(penetration=2e-5), "penetration over h"),
        (Seen(contact_work=0.02), "work of contact over the energy put in"),
        (Seen(contact_work=-0.02), "work of contact over the energy put in"),
    ],
)
def test_each_limit_is_held(seen, words):
    assert [fault for fault in faults_of(seen, Limits()) if fault.startswith(words)]
    assert not faults_of(Seen(), Limits())


def test_a_refusal_is_held_to_its_words():
    assert judge(cell(Refused(refuse, "density must be")))["verdict"] == "refused"
    assert judge(cell(Refused(refuse, "stiffness")))["verdict"] == "wrong words"
    assert judge(cell(Refused(lambda: None, "density")))["verdict"] == "not refused"


def test_a_crash_of_another_kind_is_no_refusal():
    with pytest.raises(ZeroDivisionError):
        judge(cell(Refused(lambda: 1 / 0, "division")))


def test_a_kernel_that_is_wrong_is_broken():
    def wrong():
        raise AssertionError("2 points without a return")

    assert judge(cell(Sound(wrong)))["note"] == "2 points without a return"
    assert judge(cell(Sound(lambda: "fine")))["verdict"] == "stable"


def test_what_is_left_out_says_why():
    row = judge(cell(Left("nothing is cut")))
    assert (row["verdict"], row["note"]) == ("n/a", "nothing is cut")


@pytest.mark.parametrize("mesh", limit.MESHES)
def test_the_limit_of_each_mesh_is_that_of_its_elements_or_above(mesh):
    """Contact and cuts take nothing away; a mesh whose elements are all free has just that."""
    trial = limit.MESHES[mesh]()
    assert not run_trial(trial, 0.99).broke
    assert run_trial(trial, 1.7).broke
    if mesh in (limit.ONE, "cracked"):
        assert run_trial(trial, 1.04).broke
    assert Run(trial.problem).dt < Run(trial.problem).critical_step[0]
