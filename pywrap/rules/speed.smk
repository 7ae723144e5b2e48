# Speed, asked for by name only: `snakemake --cores all speed`. Each measurement takes all cores
# that there are, so that nothing runs beside it.
SPEED = [
    f"{OUT}/benchmark.json",
    f"{OUT}/tables/leave_out.csv",
    f"{OUT}/tables/growth.csv",
]
SPEED_SOURCES = sorted(map(str, Path("pywrap/lithofrac/benchmark").glob("*.py")))
TIMED = ["punch_discrete", "punch_gf60"]  # a coarse suite has not both
PUNCHES = (
    expand(f"{OUT}/timed/{{timed}}/summary.json", timed=TIMED)
    if {*TIMED} <= {*CASES}
    else []
)


rule time_punch:
    # In the suite two runs share the machine; here each has it alone, on one core.
    input:
        DECIDING,
    output:
        f"{OUT}/timed/{{timed}}/summary.json",
    log:
        f"{OUT}/log/time_{{timed}}.txt",
    wildcard_constraints:
        timed="|".join(TIMED),
    threads: 64  # all there are
    message:
        "Time {wildcards.timed} alone"
    shell:
        "lithofrac run {wildcards.timed} --suite {SUITE} --out $(dirname {output}) > {log} 2>&1"


rule make_benchmark:
    input:
        DECIDING,
        SPEED_SOURCES,
    output:
        SPEED[0],
    log:
        f"{OUT}/log/benchmark.txt",
    threads: 64  # all there are
    message:
        "Measure the speed of a step"
    shell:
        "python -m lithofrac.benchmark --out {output} > {log} 2>&1"


rule make_leave_out:
    input:
        DECIDING,
        SPEED_SOURCES,
        suites=["configs/suite_quick.yaml", "configs/suite_leave_out.yaml"],
    output:
        SPEED[1],
    log:
        f"{OUT}/log/leave_out.txt",
    threads: 64
    message:
        "Run the quick suite and more with what it needs and with everything on"
    shell:
        "python -m lithofrac.benchmark.leave_out {input.suites} --out {output} > {log} 2>&1"


rule make_growth:
    input:
        DECIDING,
        SPEED_SOURCES,
    output:
        SPEED[2],
    log:
        f"{OUT}/log/growth.txt",
    threads: 64
    message:
        "Measure how cost grows"
    shell:
        "python -m lithofrac.benchmark.growth --out {output} > {log} 2>&1"


rule table_speed:
    # Not in `TABLES`, all of which the suite makes.
    input:
        TABLING,
        measured=SPEED,
        runs=PUNCHES,
    output:
        rows=f"{OUT}/tables/speed_rows.csv",
        targets=f"{OUT}/tables/speed_targets.csv",
    log:
        f"{OUT}/log/table_speed.txt",
    message:
        "Write the tables of speed"
    shell:
        "(lithofrac plot speed_rows {input.measured} --out {output.rows} &&"
        " lithofrac plot speed_targets {input.measured} {input.runs} --out {output.targets})"
        " > {log} 2>&1"


rule plot_speed:
    input:
        DRAWING,
        measured=SPEED,
    output:
        f"{OUT}/figures/speed.{{format}}",
    log:
        f"{OUT}/log/plot_speed_{{format}}.txt",
    wildcard_constraints:
        format="svg|png",
    message:
        "Plot what steps cost"
    shell:
        "lithofrac plot speed {input.measured} --out {output} > {log} 2>&1"


rule speed:
    # Refreshes what is committed: the sheet and its figure.
    input:
        f"{OUT}/tables/speed_rows.csv",
        f"{OUT}/tables/speed_targets.csv",
        picture=f"{OUT}/figures/speed.png",
    message:
        "Fill the sheet of speed"
    shell:
        "lithofrac report {OUT} --out reports/sheets/12_speed.md &&"
        " cp {input.picture} reports/sheets/speed.png"
