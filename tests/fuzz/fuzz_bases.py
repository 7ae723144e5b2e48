"""Right inputs that mutants are made from: small, and together using every part of a config."""

ROCK = """\
title: Sandstone
young_modulus_GPa: 28.0
poisson_ratio: 0.25
density_kg_m3: 2800.0
tensile_strength_MPa: 4.0
fracture_energy_J_m2: 100.0
plastic_strain: [0.0, 0.001, 0.002, 0.01]
cohesion_MPa: [20.0, 18.0, 16.0, 0.0]
friction_angle_deg: [17.0, 40.5, 52.5, 52.5]
dilation_angle_deg: [0.0, 11.5, 23.0, 18.0]
"""
REGULAR_ROCK = (
    ROCK
    + """\
hardening: total
coupling: explicit
band_width: sqrt_A
reference_size_mm: 2.0
"""
)
STEEL = """\
title: Steel
elastic: true
young_modulus_GPa: 210.0
poisson_ratio: 0.3
density_kg_m3: 7800.0
"""
MATERIALS = {"rock.yaml": ROCK, "regular.yaml": REGULAR_ROCK, "steel.yaml": STEEL}

HEAD = "title: A case\nmaterial: ./rock.yaml\n"
# Fast enough for cracks within some tens of steps.
SHORTEN = "loading: {kind: velocity, speed_m_s: 10.0, end_strain: 0.02, ramp_transits: 0.5"
PLATENS = """\
platens:
  material: ./steel.yaml
  thickness_mm: 2.0
  element_size_over_rock: 2.0
  overhang_mm: -0.1
  rigid: false
contact:
  friction: {rock-platen: 0.1, rock-rock: 0.8}
  default_friction: 0.2
"""
CRACKS = "fracture: {mode: MODE, weights: volume, reset: normal, interval_steps: 2}\n"
MORE = """\
damping: {fraction: 0.3, relative_to: affine}
mesh: {seed: 1}
output: {records: 20, fields: 2}
time_step_factor: 0.9
"""

# Name -> text of a case file. Those of `MESHED` start gmsh, which takes most of a second.
CASES = {
    "single_element": HEAD
    + "scene: {kind: single_element, size_mm: 0.5, axisymmetric: true}\n"
    + SHORTEN
    + ", confinement_MPa: 5.0}\n"
    + MORE,
    "triaxial": "title: A case\nmaterial: {extends: ./regular.yaml, coupling: implicit}\n"
    + "scene: {kind: triaxial, diameter_mm: 10.0, height_mm: 20.0, element_size_mm: 2.5,"
    + " structured: true, whole_height: false}\n"
    + SHORTEN
    + ", confinement_MPa: 5.0}\n"
    + "probes: {gauge: {x_mm: 1.0, y_mm: 2.0}}\n"
    + MORE,
    "plane_strain": HEAD
    + "scene: {kind: plane_strain, width_mm: 10.0, height_mm: 20.0, element_size_mm: 2.5,"
    + " structured: true, lateral_platens: true}\n"
    + SHORTEN
    + ", confinement_MPa: 2.0, lateral_stiffness_over_young: 0.1}\n"
    + PLATENS
    + CRACKS.replace("MODE", "inter_element")
    + MORE,
    "bar": HEAD
    + "scene: {kind: bar, height_mm: 20.0, width_mm: 5.0, element_size_mm: 2.5,"
    + " laterally_fixed: false}\n"
    + "loading: {kind: traction, stress_MPa: -8.0, ramp_transits: 0.5, hold_transits: 10.0}\n"
    + "contact: {friction: {rock-rock: 0.5}, tolerance: 1.0}\n"
    + CRACKS.replace("MODE", "intra_element")
    + MORE,
    "stretched_bar": HEAD
    + "scene: {kind: bar, height_mm: 20.0, width_mm: 5.0, element_size_mm: 2.5}\n"
    + SHORTEN
    + ", sense: stretch}\n"
    + MORE,
    "hole_quarter": HEAD
    + "scene: {kind: hole_quarter, hole_radius_mm: 10.0, block_over_radius: 4.0,"
    + " wall_elements_per_radius: 3.0, far_elements_per_radius: 1.0}\n"
    + "loading: {kind: traction, stress_MPa: 20.0, ramp_transits: 0.5, hold_transits: 5.0}\n"
    + MORE,
    "hole": HEAD
    + "scene: {kind: hole, hole_radius_mm: 10.0, block_over_radius: 4.0,"
    + " wall_elements_per_radius: 3.0, far_elements_per_radius: 1.0}\n"
    + SHORTEN
    + "}\n"
    + PLATENS
    + CRACKS.replace("MODE", "intra_element")
    + MORE,
    "punch": HEAD
    + "scene: {kind: punch, width_mm: 40.0, block_height_mm: 30.0, strip_width_mm: 10.0,"
    + " strip_height_mm: 4.0, strip_element_size_mm: 2.5, fine_radius_mm: 8.0,"
    + " element_size_mm: 5.0}\n"
    + SHORTEN
    + ", confinement_MPa: 2.0}\n"
    + PLATENS
    + CRACKS.replace("MODE", "inter_element")
    + MORE,
    "brazilian": HEAD
    + "scene: {kind: brazilian, diameter_mm: 20.0, flat_angle_deg: 20.0, element_size_mm: 4.0}\n"
    + SHORTEN
    + "}\n"
    + PLATENS
    + CRACKS.replace("MODE", "inter_element")
    + MORE,
}
CHECKPOINTS = ("bar", "triaxial")  # cases of which a run in its middle is kept
MESHED = ("hole_quarter", "hole", "punch", "brazilian")

SUITE = """\
title: A suite
cases:
  first: {extends: single_element, realisations: 2}
  second:
    extends: ./triaxial.yaml
    set: {loading.confinement_MPa: 10, scene.element_size_mm: 5.0}
    twin: first
"""

STUDY = """\
title: A study
base: case
set: {output.fields: 0}
grid:
  loading.confinement_MPa: [0, 5, 10]
  scene.size_mm: [0.5, 1.0]
name: run_{loading.confinement_MPa}_{scene.size_mm:04.1f}
realisations: 2
quantities: [peak_stress_MPa]
plot: {x: loading.confinement_MPa, y: [peak_stress_MPa], series: scene.size_mm, x_scale: linear}
"""

AXES = """\
figure,axis,quantity,unit,printed_min,printed_max,note,source
9,x,axial_strain,1,,,range is in the image only,"Fig. 9, section 3.2"
9,y,axial_stress,MPa,,,range is in the image only,"Fig. 9, section 3.2"
15,x,strain,microstrain,-6000,6000,labels every 2000,"Fig. 15, tick labels"
15,y,axial_stress,MPa,0,24,labels every 4,"Fig. 15, tick labels"
"""
SHEET = """\
figure: "9"
series: triaxial, 10 MPa
origin: experiment
compare_with: sandstone_triaxial_p10
x: {unit: percent, printed_min: 0, printed_max: 2}
y: {unit: MPa, printed_min: 0, printed_max: 300}
uncertainty: {x: 0.01, y: 2}
digitised_by: A. Reader
date: 2026-01-31
source: made in a test
"""
POINTS = "0.0,10.0\n0.5,120.5\n1.0,187.0\n1.5,90.0\n"
STRENGTH = """\
confinement_MPa,strength_MPa,strength_min_MPa,strength_max_MPa,tests
20,260.5,212.7,338.9,4
40,306.0,261.1,350.8,2
"""
CURVES = """\
confinement_MPa,axial_strain,axial_stress_MPa,lateral_strain,test
5,0.0,5.0,0.0,a
5,0.001,33.0,0.00025,a
5,0.002,61.0,0.0005,a
5,0.004,100.0,0.002,a
5,0.006,80.0,0.004,a
5,0.008,70.0,0.006,a
"""
DATA = {
    "data/own/strengths.csv": STRENGTH,
    "data/own/curves.csv": CURVES,
    "data/klerck2004/figure_axes.csv": AXES,
    "data/klerck2004/digitised/a.yaml": SHEET,
    "data/klerck2004/digitised/a.csv": POINTS,
    "data/tautona/triaxial_strength.csv": STRENGTH,
}

OWN = HEAD + (
    "scene: {kind: gmsh_file, file: own.msh, length_unit: mm, materials: {cap: ./steel.yaml}}\n"
    "loading: {kind: boundaries, held: {bottom: xy}, pressed_MPa: {right: 1.0}, driven: {top: "
    "{y_mm: -0.1}}, speed_m_s: 10.0, ramp_transits: 0.5, axial: top}\n"
    "contact: {friction: {rock-cap: 0.3}}\n" + CRACKS.replace("MODE", "inter_element") + MORE
)


def own_msh(columns: int = 3, rows: int = 4) -> str:
    """A plate of two bodies that share a row of nodes, in Gmsh's format 2.2."""
    wide = columns + 1
    nodes = [(i % wide, i // wide) for i in range(wide * (rows + 1))]
    lines = [(1, i, i + 1) for i in range(1, wide)]
    lines += [(2, wide * i, wide * (i + 1)) for i in range(1, rows + 1)]
    lines += [(3, wide * rows + i + 1, wide * rows + i) for i in range(columns, 0, -1)]
    triangles = []
    for row in range(rows):
        for column in range(columns):
            a = wide * row + column + 1
            body = 5 if row == rows - 1 else 4
            triangles += [(body, a, a + 1, a + wide + 1), (body, a, a + wide + 1, a + wide)]
    elements = [(1, *line) for line in lines] + [(2, *triangle) for triangle in triangles]
    names = ((1, 1, "bottom"), (1, 2, "right"), (1, 3, "top"), (2, 4, "rock"), (2, 5, "cap"))
    parts = {
        "MeshFormat": ["2.2 0 8"],
        "PhysicalNames": [str(len(names)), *(f'{d} {tag} "{name}"' for d, tag, name in names)],
        "Nodes": [str(len(nodes)), *(f"{i} {x} {y} 0" for i, (x, y) in enumerate(nodes, 1))],
        "Elements": [
            str(len(elements)),
            *(
                f"{i} {kind} 2 {tag} {tag} {' '.join(map(str, ends))}"
                for i, (kind, tag, *ends) in enumerate(elements, 1)
            ),
        ],
    }
    return "".join(f"${name}\n{chr(10).join(rows)}\n$End{name}\n" for name, rows in parts.items())


# Meshed by gmsh in other formats than the one above.
OWN_GEO = """\
Point(1) = {0, 0, 0, 1.5};
Point(2) = {3, 0, 0, 1.5};
Point(3) = {3, 3, 0, 1.5};
Point(4) = {0, 3, 0, 1.5};
Point(5) = {3, 4, 0, 1.5};
Point(6) = {0, 4, 0, 1.5};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Line(5) = {3, 5};
Line(6) = {5, 6};
Line(7) = {6, 4};
Curve Loop(1) = {1, 2, 3, 4};
Curve Loop(2) = {-3, 5, 6, 7};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
Physical Surface("rock") = {1};
Physical Surface("cap") = {2};
Physical Curve("bottom") = {1};
Physical Curve("right") = {2, 5};
Physical Curve("top") = {6};
"""
OTHER_MSH = {
    "own_41.msh": ("-format", "msh41"),
    "own_22_binary.msh": ("-format", "msh22", "-bin"),
    "own_41_binary.msh": ("-format", "msh41", "-bin"),
}
