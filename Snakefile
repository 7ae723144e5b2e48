# From a suite to the report, below out/; every rule calls the command line and nothing else.
# Another suite: `--config suite=configs/suite_quick.yaml`.
from functools import cache
from pathlib import Path

from lithofrac.config import ConfigError, load_suite, predicted
from lithofrac.errors import CoreError
from lithofrac.meshed_cost import meshed_cost
from lithofrac.report import category_of, load_sheets

SUITE = config.get("suite", "configs/suite.yaml")
OUT = config.get("out", "out")
ENTRIES = load_suite(SUITE)
READ = {name: ENTRIES.case(name) for name in ENTRIES.names}
CASES = {name: case.resolved() for name, case in READ.items()}
SCENES = {case["title"]: name for name, case in reversed(CASES.items())}.values()
VARIANTS = ENTRIES.variants  # name -> name of its twin
DISCRETE = [name for name, case in CASES.items() if case["fracture"]["mode"] != "off"]

ROCKS = ["quartzite", "sandstone", "tyndall_limestone"]
CONFINEMENTS = ["00", "01", "02", "05", "10", "15", "20", "30", "40"]  # MPa
BENCH = [f"{OUT}/bench/{{rock}}/{{test}}_p{level}.parquet" for level in CONFINEMENTS]
QUARTZITE = "configs/materials/quartzite.yaml"


def modules(part, *names):
    """Files of a part of the package, all or those named."""
    folder = Path("pywrap/lithofrac", part)
    found = [folder / f"{name}.py" for name in names] or sorted(folder.glob("*.py"))
    return [str(file) for file in found]


def of(runs, *starts):
    """Those of some runs whose cases have names that start so."""
    return [run for run in runs if Path(run).parent.name.startswith(starts)]


def named(runs, name):
    """The run of that name, or nothing where the suite has none."""
    return [run for run in runs if Path(run).parent.name == name]


# Sources that decide a result beside its case: the core, and what a run imports; so its summary
# says its peak and its fragments by modules of `analysis`.
CORE = [
    str(file)
    for part in ("fortran", "pywrap/face")
    for file in sorted(Path(part).rglob("*.f90"))
]
# Of `config`, but for pages, warnings, and what no case of a suite uses.
WORDS = ["doubts", "reference", "schema", "setting", "study"]
CONFIG = [file for file in modules("config") if Path(file).stem not in WORDS]
SHARED = [
    *CORE,
    *CONFIG,
    *modules("", "errors", "mesh_flaws", "npz", "plain_file", "problem"),
]
POINT = [*SHARED, *modules("", "kernels", "point")]
DECIDING = [
    *SHARED,
    *modules("", "core", "guards", "plan", "run"),
    *modules("analysis", "crack_faces", "frames", "run_numbers", "strength"),
    *modules("results"),
    *modules("scenes"),
]

# Sources that decide a table, and those that decide a figure, beside results.
TABLING = [*modules("analysis"), *modules("data")]
TABLING += [
    str(file)
    for end in ("csv", "yaml")
    for file in sorted(Path("data").rglob(f"*.{end}"))
]
DRAWING = [*TABLING, *modules("plots")]

RUNS = expand(f"{OUT}/runs/{{case}}/summary.json", case=CASES)
PAIRED = dict.fromkeys(name for pair in VARIANTS.items() for name in pair)
PAIRS = expand(f"{OUT}/runs/{{case}}/summary.json", case=PAIRED)
OWN = [run for run in RUNS if run.split("/")[-2] not in VARIANTS]
SANDSTONE = of(OWN, "sandstone_")
DRAWN = ["hole_r25.0", "hole_r16.3", "hole_r06.4"]  # of the paper's Figs 13 and 14
HOLES = of(OWN, "hole_")
INITIATION = [
    f"{OUT}/tables/hole_initiation.csv",
    *HOLES,
]  # made once, read by the others
# Cases with figures of their own: variants, other meshes and other radii tell differences only.
SHOWN = [
    name
    for name in DISCRETE
    if name not in VARIANTS and (name in DRAWN or not name.startswith("hole_"))
]
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
    "zigong_prediction": ["configs/materials/sandstone.yaml"],
    "zigong_prediction_error": ["configs/materials/sandstone.yaml"],
    "kirsch": of(RUNS, "kirsch"),
    "run_time": ["reports/bands.csv", *RUNS],
    **{"cracks": RUNS, "bands": RUNS, "punch": OWN},
    "variants": [SUITE, *PAIRS],
    "claims": ["reports/claims_bands.csv", *RUNS],
    **{"hole_initiation": HOLES, "size_effect": INITIATION, "hole_fits": INITIATION},
    "hole_checks": ["reports/bands.csv", *INITIATION],
}
TABLES["claims"] += [
    f"{OUT}/tables/{name}.csv"
    for name in ("hole_initiation", "size_effect", "hole_fits")
    if name in TABLES
]
COMPARED = {
    "punch": of(OWN, "punch_"),
    "punch_patterns": of(OWN, "punch_"),
    "fracture_series": of(OWN, "sandstone_soft_p"),
    "stiffness_sweep": of(OWN, "sandstone_plane", "sandstone_soft"),
    "fracture_evolution": named(OWN, "sandstone_plane_strain_p10"),
    "variants": [SUITE, *PAIRS] if VARIANTS else [],
    "hole_gauges": named(HOLES, "hole_r25.0"),
    "hole_patterns": [run for run in HOLES if run.split("/")[-2] in DRAWN],
    "size_effect": INITIATION if HOLES else [],
}
ALWAYS = ["stress_strain.svg", "strength.svg", "measured.svg", "sandstone.png"]
FIGURES = expand(
    f"{OUT}/figures/{{kind}}_{{case}}.svg",
    kind=["fractures", "events", "energy"],
    case=SHOWN,
) + [f"{OUT}/figures/{kind}.svg" for kind, runs in COMPARED.items() if runs]

# The best figures, committed by `pages`: name -> plot and its runs, where the suite has them.
GALLERY = {
    "punch": ("punch", COMPARED["punch"]),
    "fractures_punch_discrete": (
        "fractures",
        named(RUNS, "punch_discrete"),
    ),
    "fractures_punch_tension_only": (
        "fractures",
        named(RUNS, "punch_tension_only"),
    ),
    "sandstone": (
        "gallery",
        of(SANDSTONE, "sandstone_plane_strain_p"),
    ),
    "stress_strain": ("stress_strain", SANDSTONE),
    "strength": ("strength", [*SANDSTONE, *STIFF]),
    **{
        name: (name, runs)
        for name, runs in COMPARED.items()
        if name != "punch"  # which comes first
    },
}
GALLERY = {name: (kind, runs) for name, (kind, runs) in GALLERY.items() if runs}

# A page and a category for each scene; its sheet says which figures it shows.
SHEETS = load_sheets(Path("reports/sheets"))
CAPTIONS = sorted(map(str, Path("reports/captions").glob("*.rst")))
MADE = FIGURES + expand(f"{OUT}/figures/single_element_{{rock}}.svg", rock=ROCKS)
MADE += expand(f"{OUT}/figures/mesh_{{case}}.svg", case=SCENES)
MADE += [f"{OUT}/figures/{name}" for name in ALWAYS]


def scene(figure):
    """Category of a figure, whose name may hold wildcards of its rule."""
    return lambda wildcards: category_of(figure.format(**wildcards), SHEETS)


def on_page(wildcards):
    """Figures of a page."""
    sheet = next(sheet for sheet in SHEETS if sheet.name == wildcards.sheet)
    shown = sheet.figures([Path(figure).stem for figure in MADE])
    return [figure for figure in MADE if Path(figure).stem in shown]


report: "reports/captions/suite.rst"


def geometry(wildcards):
    """The Gmsh file of a case that names one."""
    scene = READ[wildcards.case].scene
    return str(scene.path) if scene.kind == "gmsh_file" else []


MESHES = {}  # of geometries from files, made once


@cache
def cost(case):
    """What a run is expected to take; asked for job by job, as some need a moment."""
    try:
        return meshed_cost(READ[case], MESHES)
    except (ConfigError, CoreError):  # which the run itself will say
        return predicted(READ[case])


# It writes to the tree, not below `out`: never on a node of a cluster.
localrules:
    pages,


wildcard_constraints:
    case="|".join(CASES),
    compared="|".join(COMPARED),
    picture="|".join(GALLERY),


rule all:
    # Runs by name: one that failed leaves nothing, and figures of an older run would hide that.
    input:
        RUNS,
        f"{OUT}/report.md",
        expand(f"{OUT}/pages/{{sheet}}.html", sheet=[sheet.name for sheet in SHEETS]),


rule simulate:
    input:
        DECIDING,
        geometry=geometry,
    output:
        summary=f"{OUT}/runs/{{case}}/summary.json",
        history=f"{OUT}/runs/{{case}}/history.parquet",
    log:
        f"{OUT}/log/simulate_{{case}}.txt",
    benchmark:
        f"{OUT}/benchmarks/{{case}}.tsv"
    group:
        lambda wildcards: cost(wildcards.case).group
    threads: lambda wildcards: cost(wildcards.case).threads
    resources:
        mem_mb=lambda wildcards: cost(wildcards.case).mem_mb,
        runtime=lambda wildcards: cost(wildcards.case).runtime,
    params:
        case=lambda wildcards: CASES[wildcards.case],
    message:
        "Mesh and run {wildcards.case}"
    shell:
        "lithofrac run {wildcards.case} --suite {SUITE} --out {OUT}/runs/{wildcards.case}"
        " --threads {threads} --resume-if-possible > {log} 2>&1"


rule bench:
    input:
        POINT,
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
            category=scene("single_element_{rock}"),
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
            category=scene("mesh_{case}"),
        ),
        energy=report(
            f"{OUT}/figures/energy_{{case}}.svg",
            caption="reports/captions/energy.rst",
            category=scene("energy_{case}"),
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
        gallery=of(SANDSTONE, "sandstone_plane_strain_p"),
        stiff=STIFF,
        rock=QUARTZITE,
    output:
        curves=report(
            f"{OUT}/figures/stress_strain.svg",
            caption="reports/captions/stress_strain.rst",
            category=scene("stress_strain"),
        ),
        strength=report(
            f"{OUT}/figures/strength.svg",
            caption="reports/captions/strength.rst",
            category=scene("strength"),
        ),
        gallery=report(
            f"{OUT}/figures/sandstone.png",
            caption="reports/captions/sandstone.rst",
            category=scene("sandstone"),
        ),
        measured=report(
            f"{OUT}/figures/measured.svg",
            caption="reports/captions/measured.rst",
            category=scene("measured"),
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
            category=scene("fractures_{case}"),
        ),
        events=report(
            f"{OUT}/figures/events_{{case}}.svg",
            caption="reports/captions/events.rst",
            category=scene("events_{case}"),
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
            category=scene("{compared}"),
        ),
    log:
        f"{OUT}/log/plot_{{compared}}.txt",
    message:
        "Plot {wildcards.compared}"
    shell:
        "lithofrac plot {wildcards.compared} {input.runs} --out {output} > {log} 2>&1"


rule table:
    input:
        TABLING,
        lambda wildcards: POINT if wildcards.table == "options" else [],  # it drives the point itself
        sources=lambda wildcards: TABLES[wildcards.table],
    output:
        f"{OUT}/tables/{{table}}.csv",
    log:
        f"{OUT}/log/table_{{table}}.txt",
    message:
        "Write the table {wildcards.table}"
    shell:
        "lithofrac plot {wildcards.table} {input.sources} --out {output} > {log} 2>&1"


rule picture:
    input:
        DRAWING,
        runs=lambda wildcards: GALLERY[wildcards.picture][1],
    output:
        f"{OUT}/gallery/{{picture}}.png",
    log:
        f"{OUT}/log/picture_{{picture}}.txt",
    params:
        kind=lambda wildcards: GALLERY[wildcards.picture][0],
    message:
        "Draw {wildcards.picture} for the gallery"
    shell:
        "lithofrac plot {params.kind} {input.runs} --out {output} > {log} 2>&1"


rule pages:
    # Asked for by name only: refreshes what is committed, first the gallery, to which README.md and
    # the sheets have links.
    input:
        f"{OUT}/report.md",
        pictures=expand(f"{OUT}/gallery/{{picture}}.png", picture=GALLERY),
    params:
        pages=["README.md", *sorted(map(str, Path("reports/sheets").glob("*.md")))],
    message:
        "Fill README.md, the sheets and the gallery"
    shell:
        "lithofrac gallery {OUT} {input.pictures} --out reports/gallery &&"
        " for page in {params.pages}; do lithofrac report {OUT} --out $page || exit 1; done"


rule summary:
    input:
        expand(f"{OUT}/tables/{{table}}.csv", table=TABLES),
        MADE,
        CAPTIONS,
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


rule page:
    input:
        expand(f"{OUT}/tables/{{table}}.csv", table=TABLES),
        CAPTIONS,
        "reports/sheets/{sheet}.md",
        figures=on_page,
    output:
        report(
            f"{OUT}/pages/{{sheet}}.html",
            caption="reports/captions/page.rst",
            category=lambda wildcards: next(
                sheet.category for sheet in SHEETS if sheet.name == wildcards.sheet
            ),
        ),
    log:
        f"{OUT}/log/page_{{sheet}}.txt",
    message:
        "Write the page of {wildcards.sheet}"
    shell:
        "lithofrac report {OUT} --out {output} > {log} 2>&1"


include: "pywrap/rules/regression.smk"
include: "pywrap/rules/stability.smk"
include: "pywrap/rules/speed.smk"
include: "pywrap/rules/accuracy.smk"
