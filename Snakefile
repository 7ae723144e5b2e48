# From a suite to the report, below out/; every rule calls the command line and nothing else.
# Another suite: `--config suite=configs/suite_quick.yaml`.
from pathlib import Path

from snakemake.exceptions import WorkflowError

from lithofrac.config import load_suite

SUITE = config.get("suite", "configs/suite.yaml")
OUT = config.get("out", "out")
ENTRIES = load_suite(SUITE)
CASES = {name: ENTRIES.case(name).resolved() for name in ENTRIES.cases}
SCENES = {case["title"]: name for name, case in reversed(CASES.items())}.values()
DISCRETE = [name for name, case in CASES.items() if case["fracture"]["mode"] != "off"]

ROCKS = ["quartzite", "sandstone", "tyndall_limestone"]
CONFINEMENTS = ["00", "01", "02", "05", "10", "15", "20", "30", "40"]  # MPa
BENCH = [f"{OUT}/bench/{{rock}}/{{test}}_p{level}.parquet" for level in CONFINEMENTS]
QUARTZITE = "configs/materials/quartzite.yaml"

# Sources that decide a result beside its case, and those that decide a figure beside its results.
CORE = sorted(map(str, Path("fortran").rglob("*.f90")))
PARTS = ["pywrap/lithofrac/analysis", "pywrap/lithofrac/data", "pywrap/lithofrac/plots"]
DRAWING = [file for part in PARTS for file in sorted(Path(part).glob("*.py"))]
DRAWING += [*sorted(Path("data").rglob("*.csv")), *sorted(Path("data").rglob("*.yaml"))]

RUNS = expand(f"{OUT}/runs/{{case}}/summary.json", case=CASES)
SANDSTONE = [run for run in RUNS if "/sandstone_" in run]
CURVES = expand(BENCH, rock=ROCKS, test="triaxial")
STIFF = expand(BENCH, rock="sandstone", test="stiff_confinement")
TABLES = {
    "results": ["reports/bands.csv", QUARTZITE, *RUNS, *CURVES, *STIFF],
    "single_element": CURVES,
    "options": [QUARTZITE, "configs/materials/sandstone.yaml"],
    "strength": SANDSTONE,
    "errors": SANDSTONE,
    "tautona": [QUARTZITE],
    **{"zigong": [], "zigong_fit": []},
    "kirsch": [run for run in RUNS if "/kirsch" in run],
    "run_time": RUNS,
    **{"cracks": RUNS, "bands": RUNS, "punch": RUNS},
}
COMPARED = {
    "punch": [run for run in RUNS if "/punch_" in run],
    "fracture_series": [run for run in RUNS if "/sandstone_soft_p" in run],
}
FIGURES = expand(
    f"{OUT}/figures/{{kind}}_{{case}}.svg",
    kind=["fractures", "events", "energy"],
    case=DISCRETE,
) + [f"{OUT}/figures/{kind}.svg" for kind, runs in COMPARED.items() if runs]

# What `regression` runs, whatever suite is asked for: by the installed build each case, and for new
# references also by a build that gives the same bits on every x86-64, with two more meshes of cases
# that crack.
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


report: "reports/captions/suite.rst"


wildcard_constraints:
    case="|".join(CASES),
    compared="|".join(COMPARED),
    quick="|".join([*QUICK.cases, *REALISED]),
    build="installed|portable",


rule all:
    input:
        f"{OUT}/report.md",
        expand(f"{OUT}/figures/single_element_{{rock}}.svg", rock=ROCKS),
        expand(f"{OUT}/figures/mesh_{{case}}.svg", case=SCENES),


rule simulate:
    input:
        CORE,
    output:
        summary=f"{OUT}/runs/{{case}}/summary.json",
        history=f"{OUT}/runs/{{case}}/history.parquet",
    log:
        f"{OUT}/log/simulate_{{case}}.txt",
    benchmark:
        f"{OUT}/benchmarks/{{case}}.tsv"
    params:
        case=lambda wildcards: CASES[wildcards.case],
    message:
        "Mesh and run {wildcards.case}"
    shell:
        "lithofrac run {wildcards.case} --suite {SUITE} --out {OUT}/runs/{wildcards.case}"
        " --threads {threads} > {log} 2>&1"


rule bench:
    input:
        CORE,
        rock="configs/materials/{rock}.yaml",
    output:
        BENCH,
    log:
        f"{OUT}/log/bench_{{rock}}_{{test}}.txt",
    params:
        levels=CONFINEMENTS,
    message:
        "Drive one material point of {wildcards.rock}: {wildcards.test}"
    shell:
        "lithofrac point {input.rock} --test {wildcards.test} --confinement-MPa {params.levels}"
        " --end-strain 0.025 --out {OUT}/bench/{wildcards.rock} > {log} 2>&1"


rule plot_bench:
    input:
        DRAWING,
        curves=expand(BENCH, test="triaxial", allow_missing=True),
    output:
        report(
            f"{OUT}/figures/single_element_{{rock}}.svg",
            caption="reports/captions/single_element.rst",
            category="1 Material point",
        ),
    log:
        f"{OUT}/log/plot_bench_{{rock}}.txt",
    message:
        "Plot the material point of {wildcards.rock}"
    shell:
        "lithofrac plot single_element {input.curves} --out {output} > {log} 2>&1"


rule plot_run:
    input:
        DRAWING,
        run=f"{OUT}/runs/{{case}}/summary.json",
    output:
        mesh=report(
            f"{OUT}/figures/mesh_{{case}}.svg",
            caption="reports/captions/mesh.rst",
            category="4 Scenes",
        ),
        energy=report(
            f"{OUT}/figures/energy_{{case}}.svg",
            caption="reports/captions/energy.rst",
            category="4 Scenes",
        ),
    log:
        f"{OUT}/log/plot_run_{{case}}.txt",
    message:
        "Plot mesh and energy of {wildcards.case}"
    shell:
        "(lithofrac plot mesh {input.run} --out {output.mesh} &&"
        " lithofrac plot energy {input.run} --out {output.energy}) > {log} 2>&1"


rule plot_suite:
    input:
        DRAWING,
        runs=SANDSTONE,
        gallery=[run for run in SANDSTONE if "/sandstone_plane_strain_p" in run],
        stiff=STIFF,
        rock=QUARTZITE,
    output:
        curves=report(
            f"{OUT}/figures/stress_strain.svg",
            caption="reports/captions/stress_strain.rst",
            category="2 Sandstone",
        ),
        strength=report(
            f"{OUT}/figures/strength.svg",
            caption="reports/captions/strength.rst",
            category="2 Sandstone",
        ),
        gallery=f"{OUT}/figures/sandstone.png",
        measured=report(
            f"{OUT}/figures/measured.svg",
            caption="reports/captions/measured.rst",
            category="3 Measured strengths",
        ),
    log:
        f"{OUT}/log/plot_suite.txt",
    message:
        "Plot the sandstone tests and the measured strengths"
    shell:
        "(lithofrac plot stress_strain {input.runs} --out {output.curves} &&"
        " lithofrac plot strength {input.runs} {input.stiff} --out {output.strength} &&"
        " lithofrac plot gallery {input.gallery} --out {output.gallery} &&"
        " lithofrac plot measured {input.rock} --out {output.measured}) > {log} 2>&1"


rule plot_cracks:
    input:
        DRAWING,
        run=f"{OUT}/runs/{{case}}/summary.json",
    output:
        fractures=report(
            f"{OUT}/figures/fractures_{{case}}.svg",
            caption="reports/captions/fractures.rst",
            category="5 Cracks",
        ),
        events=report(
            f"{OUT}/figures/events_{{case}}.svg",
            caption="reports/captions/events.rst",
            category="5 Cracks",
        ),
    log:
        f"{OUT}/log/plot_cracks_{{case}}.txt",
    message:
        "Plot the cracks of {wildcards.case}"
    shell:
        "(lithofrac plot fractures {input.run} --out {output.fractures} &&"
        " lithofrac plot events {input.run} --out {output.events}) > {log} 2>&1"


rule plot_compared:
    input:
        DRAWING,
        runs=lambda wildcards: COMPARED[wildcards.compared],
    output:
        report(
            f"{OUT}/figures/{{compared}}.svg",
            caption="reports/captions/compared.rst",
            category="5 Cracks",
        ),
    log:
        f"{OUT}/log/plot_{{compared}}.txt",
    message:
        "Plot {wildcards.compared}"
    shell:
        "lithofrac plot {wildcards.compared} {input.runs} --out {output} > {log} 2>&1"


rule table:
    input:
        DRAWING,
        lambda wildcards: CORE if wildcards.table == "options" else [],  # it drives the point itself
        sources=lambda wildcards: TABLES[wildcards.table],
    output:
        f"{OUT}/tables/{{table}}.csv",
    log:
        f"{OUT}/log/table_{{table}}.txt",
    message:
        "Write the table {wildcards.table}"
    shell:
        "lithofrac plot {wildcards.table} {input.sources} --out {output} > {log} 2>&1"


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


rule pages:
    # Asked for by name only: refreshes what is committed, README.md, the sheets and its picture.
    input:
        f"{OUT}/report.md",
        f"{OUT}/figures/sandstone.png",
    params:
        pages=["README.md", *sorted(map(str, Path("reports/sheets").glob("*.md")))],
    message:
        "Fill README.md and the sheets"
    shell:
        "for page in {params.pages}; do lithofrac report {OUT} --out $page || exit 1; done &&"
        " mkdir -p reports/gallery && cp {OUT}/figures/sandstone.png reports/gallery/"


rule summary:
    input:
        expand(f"{OUT}/tables/{{table}}.csv", table=TABLES),
        rules.plot_suite.output,
        FIGURES,
        Path("reports/sheets").glob("*.md"),
    output:
        markdown=f"{OUT}/report.md",
        page=report(
            f"{OUT}/summary.html",
            caption="reports/captions/summary.rst",
            category="0 Results",
        ),
    log:
        f"{OUT}/log/summary.txt",
    message:
        "Write the summary"
    shell:
        "(lithofrac report {OUT} --out {output.markdown} &&"
        " lithofrac report {OUT} --out {output.page}) > {log} 2>&1"
