"""Words of the command line: commands, options, help with an example each."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

import lithofrac
from lithofrac._build import NATIVE


class _Screen(argparse.RawDescriptionHelpFormatter):
    """Lists commands one a line, without a line for their argument: help that fits a screen."""

    def _format_action(self, action: argparse.Action) -> str:
        if action.nargs != argparse.PARSER:
            return super()._format_action(action)
        self._dedent()  # the width of the column leaves no room for two levels
        _, commands = super()._format_action(action).split("\n", 1)
        self._indent()
        return commands


def parser() -> argparse.ArgumentParser:
    """The whole command line; `command` of what it parses is the name of the command."""
    found = argparse.ArgumentParser(
        prog="lithofrac",
        usage="lithofrac [--help | --version] COMMAND ...",
        description="Rock fracture benchmarks: continuum with a crack band, explicit in time.",
        epilog="example: lithofrac run sandstone_triaxial_p10 --out out/p10\n"
        "`lithofrac COMMAND --help` shows the options of a command and an example.\n"
        "exit: 0 good, 2 bad input, 3 numerical failure, 4 numbers moved, 130 interrupted",
        formatter_class=_Screen,
        add_help=False,
    )
    found.add_argument("-h", "--help", action="help", help=argparse.SUPPRESS)
    version = f"lithofrac {lithofrac.__version__}, native: {str(NATIVE).lower()}"
    found.add_argument("--version", action="version", version=version, help=argparse.SUPPRESS)
    commands = found.add_subparsers(
        title="commands", metavar="COMMAND", dest="command", required=True, prog="lithofrac"
    )
    for add in (
        _init,
        _check,
        _mesh,
        _run,
        _study,
        _show,
        _plot,
        _report,
        _gallery,
        _point,
        _fit,
        _compare,
        _references,
        _stability,
        _accuracy,
    ):
        add(commands)
    return found


def _command(commands, name: str, summary: str, example: str) -> argparse.ArgumentParser:
    return commands.add_parser(
        name,
        help=summary,
        description=f"{summary[0].upper()}{summary[1:]}.",
        epilog=f"example: lithofrac {name} {example}",
    )


MOST_THREADS = max(64, 4 * (os.cpu_count() or 1))  # far more than help, far fewer than crash
REFERENCES = Path("tests/references")
GALLERY = Path("reports/gallery")
CASE = "case file (.yaml) or name in the suite; NAME@seed2 is another mesh"


def _init(commands) -> None:
    one = _command(commands, "init", "start a project of your own in a new folder", "my_rock")
    one.add_argument("name", type=_path, metavar="NAME", help="folder to make; must not be there")


def _check(commands) -> None:
    one = _command(
        commands, "check", "check a case and say what its run would use", "sandstone_triaxial_p10"
    )
    one.add_argument("case", nargs="*", metavar="CASE", help=f"{CASE}; none: the whole suite")
    _source_of_case(one)


def _mesh(commands) -> None:
    one = _command(commands, "mesh", "mesh a case", "kirsch --out out/kirsch.npz")
    one.add_argument("case", metavar="CASE", help=CASE)
    one.add_argument("--out", type=_path, required=True, metavar="FILE", help="mesh to write, .npz")
    one.add_argument("--seed", type=_seed, metavar="N", help="realisation of the mesh")
    _source_of_case(one)


def _run(commands) -> None:
    one = _command(
        commands,
        "run",
        "run a case into a results folder",
        "sandstone_triaxial_p10 --set loading.end_strain=0.01 --out out/p10",
    )
    one.add_argument("case", metavar="CASE", help=CASE)
    one.add_argument("--out", type=_path, required=True, metavar="DIR", help="results folder")
    one.add_argument("--mesh", type=Path, metavar="FILE", help="mesh to use, of `lithofrac mesh`")
    one.add_argument(
        "--threads", type=_threads, default=1, metavar="N", help="results are the same bits"
    )
    start = one.add_mutually_exclusive_group()
    start.add_argument("--resume", action="store_true", help="go on from the checkpoint in DIR")
    start.add_argument(
        "--resume-if-possible", action="store_true",
        help="the same if a run of this very case and build was stopped there, else start anew",
    )  # fmt: skip
    one.add_argument("--quiet", action="store_true", help="print errors only")
    _source_of_case(one)


def _show(commands) -> None:
    one = _command(commands, "show", "print the summaries of runs side by side", "out/runs/punch_*")
    one.add_argument("run", nargs="+", type=Path, metavar="DIR", help="results folder")


def _study(commands) -> None:
    one = _command(
        commands,
        "study",
        "run a study: its cases, a table, a figure",
        "study.yaml --out out --cores 4",
    )
    one.add_argument("file", type=_path, metavar="FILE", help="study file (.yaml)")
    one.add_argument(
        "--out", type=_path, metavar="DIR", help="results folder; none: check and list the runs"
    )
    where = one.add_mutually_exclusive_group()
    where.add_argument("--cores", type=_threads, metavar="N", help="runs at a time, default all")
    where.add_argument("--profile", metavar="DIR", help="run on a cluster: slurm, pbs or a folder")
    one.add_argument("--quiet", action="store_true", help="print errors only")


KINDS = """figures (.svg .png .pdf)
  any run      curves pattern energy mesh gauges fractures events
  several      fracture_series fracture_evolution gallery study
  material     single_element measured
  sandstone    stress_strain strength stiffness_sweep
  punch, hole  punch punch_patterns hole_gauges hole_patterns size_effect
  suite        variants stability accuracy speed
tables (.csv .parquet)
  runs         strength cracks bands punch results claims errors run_time study
               variants hole_initiation hole_fits hole_checks size_effect kirsch
  rocks        single_element options tautona zigong zigong_fit
               zigong_prediction zigong_prediction_error
  suite        speed_rows speed_targets
animation (.gif)
  any run      animation
"""


def _plot(commands) -> None:
    one = _command(
        commands,
        "plot",
        "draw a figure of results",
        "fractures out/p10 --out out/fractures.png",
    )
    one.formatter_class = argparse.RawDescriptionHelpFormatter
    one.epilog = f"{KINDS}\n{one.epilog}"
    one.add_argument("kind", metavar="KIND", help="what to draw, see below")
    one.add_argument("input", nargs="*", type=Path, metavar="INPUT", help="results folder or file")
    one.add_argument(
        "--out", type=_path, required=True, metavar="FILE", help=".svg .png .pdf .csv .parquet .gif"
    )
    one.add_argument("--data", type=Path, metavar="DIR", help="measured data, default data/")


def _report(commands) -> None:
    one = _command(commands, "report", "write the report of a suite", "out --out reports/suite.md")
    one.add_argument("folder", type=Path, metavar="DIR", help="folder of the results folders")
    one.add_argument("--out", type=_path, required=True, metavar="FILE", help="Markdown to write")


def _gallery(commands) -> None:
    one = _command(commands, "gallery", "replace the committed pictures", "out out/gallery/*.png")
    one.add_argument("folder", type=Path, metavar="DIR", help="folder of the results folders")
    one.add_argument("picture", type=Path, nargs="+", metavar="PNG", help="picture to show")
    one.add_argument("--out", type=_path, default=GALLERY, metavar="DIR", help=f"default {GALLERY}")


def _point(commands) -> None:
    one = _command(
        commands,
        "point",
        "drive one material point",
        "sandstone --test triaxial --confinement-MPa 10 --out out/p10.parquet",
    )
    one.add_argument("rock", metavar="ROCK", help="name or file of a material")
    one.add_argument(
        "--test",
        default="triaxial",
        metavar="TEST",
        help="triaxial, plane_strain, extension, tension or stiff_confinement",
    )
    one.add_argument(
        "--confinement-MPa",
        type=float,
        nargs="+",
        default=[0.0],
        metavar="P",
        dest="confinement_MPa",
        help="lateral pressure, default 0; several write TEST_pNN.parquet into the folder --out",
    )
    one.add_argument("--end-strain", type=float, metavar="E", help="axial strain at the end")
    one.add_argument(
        "--stiffness", type=float, metavar="K", help="of stiff_confinement, over Young's modulus"
    )
    one.add_argument(
        "--out", type=_path, required=True, metavar="FILE", help="curve, .parquet, or a folder"
    )


FIT_FORMS = """tests as CSV, compression positive, in one of two forms (or files of both):
  strengths  confinement_MPa,strength_MPa
             one row a test; sigma_1, not sigma_1 - sigma_3 (strength_min_MPa,
             strength_max_MPa and tests may stand beside them, unused)
  curves     confinement_MPa,axial_strain,axial_stress_MPa
             one row a point, in order of loading; also lateral_strain
             (extension positive) or volumetric_strain (dilation positive),
             and test, a name, where two tests share a confinement
Strains are fractions counted from the isotropic state. Curves give E, with
lateral strains also Poisson's ratio and dilation; everything else comes from
--base, from TESTS.yaml beside TESTS.csv, or from --set. rock.svg,
rock_parameters.csv and rock_residuals.csv are written beside rock.yaml.
"""


def _fit(commands) -> None:
    one = _command(
        commands,
        "fit",
        "fit a rock to triaxial tests",
        "data/zigong/triaxial_strength.csv --base sandstone\n"
        "         --set dilation_angle_deg=10 --fit-on 10 30 50 70 --out out/zigong.yaml",
    )
    one.formatter_class = argparse.RawDescriptionHelpFormatter
    one.epilog = f"{FIT_FORMS}\n{one.epilog}"
    one.add_argument("tests", nargs="+", type=_path, metavar="TESTS", help="measured tests, .csv")
    one.add_argument("--out", type=_path, required=True, metavar="FILE", help="material, .yaml")
    one.add_argument("--base", metavar="ROCK", help="name or file of a material, see below")
    one.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="a key of the material"
    )
    one.add_argument(
        "--fit-on",
        type=float,
        nargs="+",
        metavar="P",
        help="confinements [MPa] to fit; the others are predicted (default: fit all)",
    )
    one.add_argument(
        "--knots",
        type=float,
        nargs="+",
        metavar="E",
        help="plastic strains of the table (default: up to 6, where the curves bend most)",
    )


def _compare(commands) -> None:
    one = _command(
        commands, "compare", "say what moved against the references", "out/regression/installed/*"
    )
    _finished_runs(one)


def _references(commands) -> None:
    one = _command(
        commands,
        "references",
        "replace the references",
        'out/regression/portable/* --twin out/regression/installed/* --why "Finer ramps"',
    )
    _finished_runs(one)
    one.add_argument(
        "--twin", type=Path, nargs="+", required=True, metavar="RUN", help="runs of a native build"
    )
    one.add_argument("--why", required=True, metavar="TEXT", help="reason, kept with the numbers")


def _stability(commands) -> None:
    one = _command(
        commands, "stability", "try the extremes of the model", "--only density --out out/tables"
    )
    one.add_argument("--out", type=_path, required=True, metavar="DIR", help="folder of the tables")
    one.add_argument(
        "--only", nargs="+", default=[], metavar="FAMILY", help="an unknown word lists all"
    )
    one.add_argument(
        "--processes", type=_threads, default=os.cpu_count() or 1, metavar="N", help="default: all"
    )


def _accuracy(commands) -> None:
    one = _command(
        commands, "accuracy", "measure error against run time", "--only kirsch --out out/tables"
    )
    one.add_argument("--out", type=_path, required=True, metavar="DIR", help="folder of the tables")
    one.add_argument(
        "--only", nargs="+", default=[], metavar="PROBLEM", help="an unknown word lists all"
    )
    one.add_argument(
        "--processes",
        type=_threads,
        default=1,
        metavar="N",
        help="default 1: runs side by side may slow each other down",
    )


def _finished_runs(one: argparse.ArgumentParser) -> None:
    one.add_argument(
        "run", nargs="+", type=Path, metavar="RUN", help="results folder or file in it"
    )
    one.add_argument(
        "--references", type=_path, default=REFERENCES, metavar="DIR", help=f"default {REFERENCES}"
    )


def _source_of_case(one: argparse.ArgumentParser) -> None:
    one.add_argument("--suite", type=Path, metavar="FILE", help="default configs/suite.yaml")
    one.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="override a dotted key"
    )


def _path(text: str) -> Path:
    if not text:  # Path("") is the working folder
        raise argparse.ArgumentTypeError("empty, expected a path")
    return Path(text)


def _threads(text: str) -> int:
    return _whole(text, MOST_THREADS)


def _seed(text: str) -> int:
    return _whole(text, 2**31 - 1)


def _whole(text: str, most: int) -> int:
    digits = text.lstrip("0")
    in_range = text.isdecimal() and 0 < len(digits) <= len(str(most)) and int(digits) <= most
    if not in_range:
        raise argparse.ArgumentTypeError(f"{text}: expected a whole number from 1 to {most}")
    return int(digits)
