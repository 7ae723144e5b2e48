"""Columns of the tables of a run, for those who write and those who read them."""

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
