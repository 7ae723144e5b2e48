# The runs of a study, its table and its figure. `lithofrac study` writes study.yaml, cases/ and
# jobs.json into the results folder and starts these rules there; Ctrl-C, then the same command.
import sys
from functools import cache
from pathlib import Path

from lithofrac.config import load_case, predicted
from lithofrac.config.cost import Cost


configfile: "jobs.json"


CASES = config["cases"]
RUNS = expand("runs/{case}/summary.json", case=CASES)
# The interpreter that was asked, without the working folder on its path.
LITHOFRAC = [sys.executable, "-P", "-m", "lithofrac"]


@cache
def read(case):
    """A case of the study."""
    return load_case(f"cases/{case}.yaml")


@cache
def cost(case):
    """What a run is expected to take; that of a geometry from a file was found by meshing it."""
    known = config["costs"].get(case)
    return Cost(**known) if known else predicted(read(case))


def geometry(wildcards):
    """The Gmsh file of a case that names one."""
    scene = read(wildcards.case).scene
    return str(scene.path) if scene.kind == "gmsh_file" else []


wildcard_constraints:
    case="|".join(CASES),


localrules:
    all,


rule all:
    input:
        RUNS,
        "table.parquet",
        "figure.svg",


rule simulate:
    input:
        case="cases/{case}.yaml",
        geometry=geometry,
    output:
        "runs/{case}/summary.json",
    log:
        "log/{case}.txt",
    group:
        lambda wildcards: cost(wildcards.case).group
    threads: lambda wildcards: cost(wildcards.case).threads
    resources:
        mem_mb=lambda wildcards: cost(wildcards.case).mem_mb,
        runtime=lambda wildcards: cost(wildcards.case).runtime,
    params:
        core=config["core"],  # another core, other results
        program=LITHOFRAC,
    message:
        "Mesh and run {wildcards.case}"
    shell:
        "{params.program:q} run {input.case:q} --out runs/{wildcards.case}"
        " --threads {threads} --resume-if-possible > {log:q} 2>&1"


rule collect:
    input:
        "study.yaml",
        RUNS,
    output:
        table="table.parquet",
        figure="figure.svg",
    log:
        "log/collect.txt",
    params:
        program=LITHOFRAC,
    message:
        "Write the table and the figure"
    shell:
        "({params.program:q} plot study {input:q} --out {output.table} &&"
        " {params.program:q} plot study {input:q} --out {output.figure}) > {log} 2>&1"
