# The stability matrix: asked for by name only, `snakemake --cores all stability`.
STABILITY = [
    f"{OUT}/tables/{name}.csv"
    for name in ("stability", "stability_families", "stability_limit")
]


rule make_stability:
    # Cells run side by side in processes of their own.
    input:
        DECIDING,
        POINT,
        sorted(map(str, Path("pywrap/lithofrac/stability").rglob("*.py"))),
    output:
        STABILITY,
    log:
        f"{OUT}/log/stability.txt",
    threads: 64  # all there are
    message:
        "Try the extremes of the model"
    shell:
        "lithofrac stability --out {OUT}/tables --processes {threads} > {log} 2>&1"


rule plot_stability:
    input:
        DRAWING,
        tables=[STABILITY[0], STABILITY[2]],
    output:
        f"{OUT}/figures/stability.{{format}}",
    log:
        f"{OUT}/log/plot_stability_{{format}}.txt",
    wildcard_constraints:
        format="svg|png",
    message:
        "Plot where runs break"
    shell:
        "lithofrac plot stability {input.tables} --out {output} > {log} 2>&1"


rule stability:
    # Refreshes what is committed: the sheet and its figure.
    input:
        STABILITY,
        picture=f"{OUT}/figures/stability.png",
    message:
        "Fill the sheet of the stability matrix"
    shell:
        "lithofrac report {OUT} --out reports/sheets/10_stability.md &&"
        " cp {input.picture} reports/sheets/stability.png"
