"""The matrix in short: a row for each family and mesh."""

import pandas as pd


def by_family(table: pd.DataFrame) -> pd.DataFrame:
    """Cells and verdicts, the worst of the stable ones and the least margin."""
    rows = []
    for (family, mesh), own in table.groupby(["family", "mesh"], sort=False):
        verdicts = own["verdict"].value_counts()
        stable = own[own["verdict"] == "stable"]
        row = {"family": family, "mesh": mesh, "cells": len(own)}
        row |= {name: int(verdicts.get(name, 0)) for name in ("stable", "refused", "n/a")}
        row["others"] = len(own) - sum(row[name] for name in ("stable", "refused", "n/a"))
        row["least_margin"] = stable["margin"].min()
        for name in ("energy_residual", "speed_over_wave", "penetration_over_h", "overlap_over_h"):
            row[f"largest_{name}"] = stable[name].max()
        rows.append(row)
    return pd.DataFrame(rows)
