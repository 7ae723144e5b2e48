# The quick suite held against tests/references; both rules at the end are asked for by name only.
from snakemake.exceptions import WorkflowError

# What is run, whatever suite is asked for: by the installed build each case, and for new
# references also by a build that gives the same bits on every x86-64 since 2013, with two more meshes of
# cases that crack.
QUICK_SUITE = "configs/suite_quick.yaml"
QUICK = load_suite(QUICK_SUITE)
REALISED = [
    f"{name}@seed{seed}"
    for name in QUICK.cases
    for seed in (2, 3)
    if QUICK.case(name).fracture.mode != "off"
]
QUICK_RUN = f"{OUT}/regression/{{build}}/{{quick}}/summary.json"
PORTABLE = "build/portable-site"
PACKAGE = [file for file in sorted(Path("pywrap").rglob("*.py"))]
SOURCES = CORE + [
    str(file) for file in PACKAGE if file.parent.name not in ("plots", "report")
]


@cache
def quick_cost(case):
    """What a run of the quick suite is expected to take."""
    return predicted(QUICK.case(case))


# Where the tree is and somebody reads what they say, not on a node of a cluster.
localrules:
    portable,
    regression,
    update_references,


wildcard_constraints:
    quick="|".join([*QUICK.cases, *REALISED]),
    build="installed|portable",


rule portable:
    # The twin for references; the installed build stays as it is.
    input:
        SOURCES,
    output:
        f"{PORTABLE}/build.stamp",
    message:
        "Build for every x86-64"
    shell:
        "python3 tasks.py portable"


rule run_quick:
    input:
        SOURCES,
        lambda wildcards: rules.portable.output if wildcards.build == "portable" else [],
    output:
        QUICK_RUN,
    log:
        f"{OUT}/log/regression_{{build}}_{{quick}}.txt",
    group:
        lambda wildcards: quick_cost(wildcards.quick).group
    threads: lambda wildcards: quick_cost(wildcards.quick).threads
    resources:
        mem_mb=lambda wildcards: quick_cost(wildcards.quick).mem_mb,
        runtime=lambda wildcards: quick_cost(wildcards.quick).runtime,
    params:
        case=lambda wildcards: QUICK.case(wildcards.quick).resolved(),
        first=lambda wildcards: (
            f"PYTHONPATH={PORTABLE}" if wildcards.build == "portable" else ""
        ),
    message:
        "Run {wildcards.quick} of the quick suite ({wildcards.build} build)"
    shell:
        "{params.first} lithofrac run {wildcards.quick} --suite {QUICK_SUITE}"
        " --out $(dirname {output}) --threads {threads} > {log} 2>&1"


rule regression:
    # Asked for by name only: says what moved, and fails if anything did.
    input:
        runs=expand(QUICK_RUN, build="installed", quick=QUICK.cases),
    message:
        "Hold the quick suite against tests/references"
    shell:
        "lithofrac compare {input.runs}"


def with_reason(wildcards):
    """Runs for new references; refuses before the first of them when nobody says why."""
    if not str(config.get("why", "")).strip():
        raise WorkflowError(
            "update_references: no reason, expected --config why='WHAT AND WHY'"
        )
    return expand(QUICK_RUN, build="portable", quick=[*QUICK.cases, *REALISED])


rule update_references:
    # Asked for by name only, with `--config why="..."`.
    input:
        runs=with_reason,
        twin=rules.regression.input.runs,
    params:
        why=lambda wildcards: str(config["why"]),
    message:
        "Replace tests/references"
    shell:
        "lithofrac references {input.runs} --twin {input.twin} --why {params.why:q}"
