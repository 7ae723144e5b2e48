"""Columns of the tables of a run, for those who write and those who read them."""

# Keys whose own name leaves open what is counted -> words of a heading or an axis. An event is a
# failed node that cracked; it may open several edges of the mesh, the rows of cracks.parquet.
WORDS = {"cracks": "crack events"}

ENERGY_COLUMNS = [
    "time_s",
    "kinetic_J",
    "elastic_J",
    "compressive_dissipation_J",
    "fracture_dissipation_J",
    "external_J",
    "damping_J",
    "contact_J",
    "friction_J",
    "insertion_J",
    "relump_J",
    "reset_J",
    "turning_J",
    "residual_J",
    "residual_relative",
]
