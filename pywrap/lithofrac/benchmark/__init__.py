"""Speed of the core: what a step costs, what is left out, and how cost grows.

python -m lithofrac.benchmark [--out FILE] [--repeat N]
python -m lithofrac.benchmark.leave_out SUITE [--out FILE]
python -m lithofrac.benchmark.growth [--out FILE] [--repeat N]
"""
