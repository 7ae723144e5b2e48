# Error against run time: asked for by name only, `snakemake --cores all accuracy`.
ACCURACY = [f"{OUT}/tables/{name}.csv" for name in ("accuracy", "accuracy_summary")]


rule make_accuracy:
    # One run after the other, for core seconds are what is measured; all threads, so that
    # nothing else runs beside it.
    input:
        DECIDING,
        POINT,
        TABLING,
        sorted(map(str, Path("configs").glob("*/*.yaml"))),
        sorted(map(str, Path("pywrap/lithofrac/accuracy").rglob("*.py"))),
    output:
        ACCURACY,
    log:
        f"{OUT}/log/accuracy.txt",
    threads: 64  # all there are
    message:
        "Measure error against run time"
    shell:
        "lithofrac accuracy --out {OUT}/tables > {log} 2>&1"


rule plot_accuracy:
    input:
        DRAWING,
        table=ACCURACY[0],
    output:
        f"{OUT}/figures/accuracy.{{format}}",
    log:
        f"{OUT}/log/plot_accuracy_{{format}}.txt",
    wildcard_constraints:
        format="svg|png",
    message:
        "Plot error against run time"
    shell:
        "lithofrac plot accuracy {input.table} --out {output} > {log} 2>&1"


rule accuracy:
    # Refreshes what is committed: the sheet and its figure.
    input:
        ACCURACY,
        picture=f"{OUT}/figures/accuracy.png",
    message:
        "Fill the sheet of error against run time"
    shell:
        "lithofrac report {OUT} --out reports/sheets/11_accuracy.md &&"
        " cp {input.picture} reports/sheets/accuracy.png"
