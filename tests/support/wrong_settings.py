"""Wrong settings of the small study, each with the whole sentence that refuses it."""

from __future__ import annotations

from bulkwear.meshes.pattern import PATTERNS
from bulkwear.postproc.wear.laws import LAWS
from bulkwear.workflows.config.patterns import SURFACES

SETTINGS = "default.yaml"
OWN_SETTINGS = "cases/sliding_sample.yaml"
STUDY = "studies/small.yaml"
TABLE = "designs/small.csv"
MATERIALS = "materials.yaml"
QUICK = "config/studies/small.yaml, line 9, fidelity quick"
ONE_PATTERN = f"a list of one pattern ({', '.join(PATTERNS)}), plain, or both"
WIDTH_RANGE = "a number from 5 to 2000 mm"

# (file, text that stands there once, its replacement, the whole message)
BAD_KEYS = [
    (
        STUDY,
        "width_mm: 80",
        "widht_mm: 80",
        f"{QUICK}: sample.widht_mm (80) is no known key, the nearest is sample.width_mm.",
    ),
    (
        STUDY,
        "width_mm: 80",
        "sliding_friction: 0.2",
        f"{QUICK}: sample.sliding_friction (0.2) is no known key but a property of the material that sample.material"
        " names, which config/materials.yaml gives, or a file of yours as --config materials=<file>.",
    ),
    (
        STUDY,
        "width_mm: 80",
        "width_mm: 0x8",
        f"{QUICK}: sample.width_mm is 0x8, allowed is {WIDTH_RANGE}, in decimal digits.",
    ),
    (
        STUDY,
        "width_mm: 80",
        "width_cm: 8",
        f"{QUICK}: unit cm is not allowed for sample.width, write sample.width_mm (found width_cm: 8).",
    ),
    (
        STUDY,
        "width_mm: 80",
        "area_mm: 80",
        f"{QUICK}: sample.area_mm (80) is no known key, allowed are width_mm, length_mm, element_size_mm,"
        " height_above_floor_mm, skirt_slope_deg, skirt_radius_mm, material.",
    ),
    (
        STUDY,
        "width_mm: 80",
        "width: 80",
        f"{QUICK}: sample.width has no unit, write sample.width_mm (found width: 80).",
    ),
    (
        STUDY,
        "particle_scale: 2.0",
        "particle_scale_mm: 2.0",
        "config/studies/small.yaml, line 8, fidelity quick: unit mm is not allowed for particle_scale,"
        " write particle_scale (found particle_scale_mm: 2).",
    ),
    (
        STUDY,
        "bed: {ahead_mm: 150}",
        "width_mm: 80",
        "config/studies/small.yaml, line 5: width_mm (80) is no known key, the nearest is sample.width_mm.",
    ),
    (
        STUDY,
        "design: small.csv",
        "case: drum\ndesign: small.csv",
        "config/studies/small.yaml, line 3: case is 'drum', allowed is one of calibration, circular_tester,"
        " equipment, pin_on_disc, sliding_sample.",
    ),
    (
        STUDY,
        "title:",
        "titel:",
        "config/studies/small.yaml, line 1: titel ('A small study') is no known key, the nearest is title.",
    ),
    (
        STUDY,
        "standard:",
        "standrd:",
        "config/studies/small.yaml, line 12: fidelities.standrd (empty) is no known key,"
        " the nearest is fidelities.standard.",
    ),
    (
        STUDY,
        "    particle_scale: 2.0",
        "    fidelity: paper",
        "config/studies/small.yaml, line 8, fidelity quick: fidelity ('paper') is no known key,"
        " allowed are particle_scale, packings, until, rows, materials, ledger, beyond_machine, wear, remeshing,"
        " solver, deck, sample, pattern, bed, sliding, packing, optimise, design.",
    ),
    (
        OWN_SETTINGS,
        "skirt_slope_deg: 3.0",
        "skirt_slope_rad: 0.05",
        "config/cases/sliding_sample.yaml, line 6: unit rad is not allowed for sample.skirt_slope,"
        " write sample.skirt_slope_deg (found skirt_slope_rad: 0.05).",
    ),
    (
        SETTINGS,
        "wear:\n",
        "waer:\n",
        "config/default.yaml, line 3: waer (a block of keys) is no known key, the nearest is wear.",
    ),
    (
        OWN_SETTINGS,
        "  skirt_slope_deg: 3.0\n",
        "",
        "config/cases/sliding_sample.yaml, line 1: sample.skirt_slope_deg is missing,"
        " allowed is a number from 0.5 to 45 deg.",
    ),
    (
        SETTINGS,
        "  law: archard\n",
        "  law: archard\n  law: archard\n",
        "config/default.yaml, line 5: wear.law stands here and in line 4, allowed is each key once.",
    ),
    (
        SETTINGS,
        "  law: archard\n",
        "  law: archard\n  1: 2\n",
        "config/default.yaml, line 5: found the key '1', allowed are words as keys.",
    ),
    (
        SETTINGS,
        "  law: archard\n",
        "  law: {a: 1,5}\n",
        "config/default.yaml, line 4: found the key '5', allowed are words as keys; decimals have a point, a comma"
        " ends a value.",
    ),
    (
        SETTINGS,
        "wear:\n",
        "wear.law: finnie\nwear:\n",
        "config/default.yaml, line 3: wear.law is written as blocks, wear: {law: ...}.",
    ),
    (
        MATERIALS,
        "shear_modulus_pa: 0.07e9",
        "shear_modulus_gpa: 0.07",
        "config/materials.yaml, line 5: unit gpa is not allowed for particles.river_gravel.shear_modulus,"
        " write particles.river_gravel.shear_modulus_pa (found shear_modulus_gpa: 0.07).",
    ),
    (
        MATERIALS,
        "    density_kg_per_m3: 1200\n",
        "",
        "config/materials.yaml, line 18: walls.perspex.density_kg_per_m3 is missing,"
        " allowed is a number from 10 to 30000 kg/m3.",
    ),
]

BAD_VALUES = [
    (
        SETTINGS,
        "acceleration: 1.0",
        "acceleration: true",
        "config/default.yaml, line 6: wear.acceleration is true, allowed is a number from 1e-09 to 1000000000.",
    ),
    (
        STUDY,
        "width_mm: 80",
        "width_mm: 80 mm",
        f"{QUICK}: sample.width_mm is '80 mm', write the number alone: width_mm: 80.",
    ),
    (
        STUDY,
        "width_mm: 80",
        "width_mm: 8 cm",
        f"{QUICK}: unit cm is not allowed for sample.width, write sample.width_mm, {WIDTH_RANGE} (found '8 cm').",
    ),
    (
        STUDY,
        "width_mm: 80",
        "width_mm: '80'",
        f"{QUICK}: sample.width_mm is the text '80', allowed is {WIDTH_RANGE}, without quotation marks.",
    ),
    (STUDY, "width_mm: 80", "width_mm: true", f"{QUICK}: sample.width_mm is true, allowed is {WIDTH_RANGE}."),
    (STUDY, "width_mm: 80", "width_mm: -80", f"{QUICK}: sample.width_mm is -80, allowed is {WIDTH_RANGE}."),
    (STUDY, "width_mm: 80", "width_mm: 2001", f"{QUICK}: sample.width_mm is 2001, allowed is {WIDTH_RANGE}."),
    (
        STUDY,
        "width_mm: 80",
        "width_mm: .nan",
        f"{QUICK}: sample.width_mm is '.nan', allowed is {WIDTH_RANGE}.",
    ),
    (STUDY, "width_mm: 80", "width_mm: 1e999", f"{QUICK}: sample.width_mm is inf, allowed is {WIDTH_RANGE}."),
    (STUDY, "width_mm: 80", "width_mm:", f"{QUICK}: sample.width_mm is empty, allowed is {WIDTH_RANGE}."),
    (STUDY, "width_mm: 80", "width_mm: [80]", f"{QUICK}: sample.width_mm is [80], allowed is {WIDTH_RANGE}."),
    (
        STUDY,
        "bed: {ahead_mm: 150}",
        "bed: 3",
        "config/studies/small.yaml, line 5: bed is 3, allowed is a block of keys.",
    ),
    (
        STUDY,
        "[convex, plain]",
        "[convex, flat]",
        f"config/studies/small.yaml, line 4: surfaces[2] is 'flat', allowed is one of {', '.join(SURFACES)}.",
    ),
    (
        STUDY,
        "[convex, plain]",
        "[]",
        f"config/studies/small.yaml, line 4: surfaces is [], allowed is {ONE_PATTERN}.",
    ),
    (
        STUDY,
        "[convex, plain]",
        "[plain, plain]",
        f"config/studies/small.yaml, line 4: surfaces is ['plain', 'plain'], allowed is {ONE_PATTERN}.",
    ),
    (
        STUDY,
        "small.csv",
        "smal.csv",
        "config/studies/small.yaml, line 3: design is 'smal.csv',"
        " allowed is one of small.csv (the nearest is small.csv).",
    ),
    (
        STUDY,
        "small.csv",
        "../materials.csv",
        "config/studies/small.yaml, line 3: design is '../materials.csv',"
        " allowed is the name of a .csv file in config/designs.",
    ),
    (
        OWN_SETTINGS,
        "cycles: 4",
        "cycles: 4.0",
        "config/cases/sliding_sample.yaml, line 23: sliding.cycles is 4.0,"
        " allowed is a whole number from 1 to 10000 or adaptive.",
    ),
    (
        OWN_SETTINGS,
        "cycles: 4",
        "cycles: 0",
        "config/cases/sliding_sample.yaml, line 23: sliding.cycles is 0,"
        " allowed is a whole number from 1 to 10000 or adaptive.",
    ),
    (
        OWN_SETTINGS,
        "travel_mm: 1000",
        "travel_mm: 0",
        "config/cases/sliding_sample.yaml, line 23: sliding.travel_mm is 0, allowed is a number from 1 to 100000 mm.",
    ),
    (
        SETTINGS,
        "deform: true",
        "deform: yes",
        "config/default.yaml, line 7: wear.deform is 'yes', allowed is true or false.",
    ),
    (
        SETTINGS,
        "acceleration: 1.0",
        "acceleration: 0",
        "config/default.yaml, line 6: wear.acceleration is 0, allowed is a number from 1e-09 to 1000000000.",
    ),
    (
        SETTINGS,
        "rolling_friction: cdt",
        "rolling_friction: epsd4",
        "config/default.yaml, line 17: solver.rolling_friction is 'epsd4', allowed is one of none, cdt, epsd, epsd2,"
        " epsd3, own_spin, rvd.",
    ),
    (
        SETTINGS,
        "ledger: solver",
        "ledger: dump",
        "config/default.yaml, line 22: ledger is 'dump', allowed is one of solver, dumps.",
    ),
    (
        SETTINGS,
        "law: archard",
        "law: archad",
        f"config/default.yaml, line 4: wear.law is 'archad', allowed is one of {', '.join(sorted(LAWS))}.",
    ),
    (
        SETTINGS,
        "fidelity: quick",
        "fidelity: paper",
        "config/default.yaml, line 1: fidelity is 'paper', allowed is one of quick, standard,"
        " the fidelities of config/studies/small.yaml.",
    ),
    (
        OWN_SETTINGS,
        "floor_material: perspex",
        "floor_material: perspx",
        "config/cases/sliding_sample.yaml, line 12: bed.floor_material is 'perspx',"
        " allowed is one of perspex, steel (the nearest is perspex).",
    ),
    (
        MATERIALS,
        "[0.25, 0.50, 0.25]",
        "[0.25, 0.50, 0.2]",
        "config/materials.yaml, line 10: particles.river_gravel.size_distribution.mass_fraction has"
        " the sum 0.95,"
        " allowed is 1.",
    ),
    (
        MATERIALS,
        "[0.25, 0.50, 0.25]",
        "[0.25, 0.75]",
        "config/materials.yaml, line 10: particles.river_gravel.size_distribution.mass_fraction has 2 values,"
        " allowed are 3, one per relative_diameter.",
    ),
    (
        MATERIALS,
        "[0.8, 1.0, 1.2]",
        "[0.8, x, 1.2]",
        "config/materials.yaml, line 9: particles.river_gravel.size_distribution.relative_diameter[2] is 'x',"
        " allowed is a number from 0.05 to 20.",
    ),
    (
        MATERIALS,
        "0.07e9",
        "0.07 GPa",
        "config/materials.yaml, line 5: unit GPa is not allowed for particles.river_gravel.shear_modulus,"
        " write particles.river_gravel.shear_modulus_pa, a number from 2500000 to 1e+12 Pa (found"
        " '0.07 GPa').",
    ),
    (
        MATERIALS,
        "poissons_ratio: 0.49",
        "poissons_ratio: 0.5",
        "config/materials.yaml, line 20: walls.perspex.poissons_ratio is 0.5, allowed is a number from 0 to 0.495.",
    ),
]

ROW_9 = "config/designs/small.csv, line 2, row R9"
HEIGHT_RANGE = "a number from 0.1 to 100 mm"
BAD_ROWS = [
    ("R9,8,2,20,6.0", "R9,8,2,20,six", f"{ROW_9}: height_mm is 'six', allowed is {HEIGHT_RANGE}."),
    ("R9,8,2,20,6.0", "R9,8,2,20,", f"{ROW_9}: height_mm is '', allowed is {HEIGHT_RANGE}."),
    ("R9,8,2,20,6.0", "R9,8,2,20,nan", f"{ROW_9}: height_mm is 'nan', allowed is {HEIGHT_RANGE}."),
    ("R9,8,2,20,6.0", "R9,8,2,20,-6", f"{ROW_9}: height_mm is -6, allowed is {HEIGHT_RANGE}."),
    (
        "R9,8,2,20,6.0",
        "R9,8,2,20,6 mm",
        f"{ROW_9}: height_mm is '6 mm', write the number alone: height_mm: 6.",
    ),
    (
        "R9,8,2,20,6.0",
        "R9,8,2,20,0.6 cm",
        f"{ROW_9}: unit cm is not allowed for height, write height_mm, {HEIGHT_RANGE} (found '0.6 cm').",
    ),
    (
        "R9,8,2,20,6.0",
        "R9,8,2,20,6,0",
        f"{ROW_9}: found 8 values, allowed are 7, one per column, with a point in decimals.",
    ),
    (
        "R9,8,2,20,6.0",
        "R9,8,2,20,60",
        f"{ROW_9}: bed_thickness_mm is 40, allowed is above 60 mm, the height of the pattern.",
    ),
    (
        "R5,",
        "R9,",
        "config/designs/small.csv, line 3: row is 'R9', which stands in line 2 too, allowed is each name once.",
    ),
    (
        "R9,",
        "R/9,",
        "config/designs/small.csv, line 2, row R/9: row is 'R/9', allowed is letters, digits and hyphens.",
    ),
    ("R9,", ",", "config/designs/small.csv, line 2: row is '', allowed is letters, digits and hyphens."),
    (
        ",height_mm",
        ",height_cm",
        "config/designs/small.csv, header: unit cm is not allowed for height, write height_mm (found height_cm).",
    ),
    (
        ",height_mm",
        ",height",
        "config/designs/small.csv, header: height has no unit, write height_mm (found height).",
    ),
    (
        ",height_mm",
        ",hieght_mm",
        "config/designs/small.csv, header: hieght_mm is no known column, the nearest is height_mm.",
    ),
    (
        ",height_mm",
        ",",
        "config/designs/small.csv, header: column 5 has no name, allowed are names, with commas between.",
    ),
    (
        ",height_mm",
        ",row",
        "config/designs/small.csv, line 1: column 'row' stands there twice, allowed is each column once.",
    ),
]

TABLE_HEADER = "row,major_radius_mm,minor_radius_mm,column_spacing_mm,height_mm,velocity_m_per_s,bed_thickness_mm"
BAD_TABLES = [
    ("", "config/designs/small.csv: the file is empty, allowed is a header and one row or more."),
    ("\n \n", "config/designs/small.csv: the file is empty, allowed is a header and one row or more."),
    (TABLE_HEADER, "config/designs/small.csv: found a header and no rows, allowed is one row or more."),
    (
        "# my rows\nrow\nR9\n",
        "config/designs/small.csv, line 1: found a comment, allowed is the header: tables have none.",
    ),
    (
        "row;height_mm\nR9;6\n",
        "config/designs/small.csv, line 1: found 'row;height_mm', allowed is the comma between columns.",
    ),
    (
        "row,height_mm\nR9,6\n",
        "config/designs/small.csv, header: column major_radius_mm is missing,"
        " allowed are row, major_radius_mm, minor_radius_mm, height_mm, column_spacing_mm, velocity_m_per_s,"
        " bed_thickness_mm.",
    ),
]

# (command line, the whole message): faults between values, and faults of the command line itself
BAD_COMBINATIONS = [
    (
        {"particle_scale": 6.0},
        f"{ROW_9}: bed_thickness_mm is 40, allowed is at least 47.7 mm, three layers of particles of 15.9 mm"
        " (particle_scale 6), or bed.allow_thin_bed: true.",
    ),
    (
        {"sample": {"width_mm": 110}},
        "command line: sample.width_mm is 110 for row R9, allowed is at most 106.261 mm,"
        " bed.width_mm less a skirt of 6.86921 mm on each side.",
    ),
    (
        {"bed": {"width_mm": 90}},
        f"{QUICK}: sample.width_mm is 80 for row R9, allowed is at most 76.2615 mm,"
        " bed.width_mm less a skirt of 6.86921 mm on each side.",
    ),
    (
        {"bed": {"behind_mm": 5}},
        "command line: bed.behind_mm is 5 for row R9, allowed is at least 6.86921 mm, the width of the sample's skirt.",
    ),
    (
        {"sliding": {"test_duration_h": 100}},
        "command line: sliding.test_duration_h is 100 for row R9, allowed is at most 0.0277778 h at this acceleration"
        " and velocity, 100 m of travel.",
    ),
    (
        {"sliding": {"test_duration_h": 1e-9}},
        "command line: sliding.test_duration_h is 1e-09 for row R9, allowed is at least 2.39529e-07 h at this"
        " acceleration and velocity, 100 time steps.",
    ),
    (
        {"bed": {"ends": "periodic", "ahead_mm": 10, "behind_mm": 20}},
        "command line: bed.ahead_mm is 10 for row R9, allowed is at least 56.5732 mm with bed.ends: periodic, so that"
        " the friction of the floor exceeds that of the sample and its skirt.",
    ),
    (
        {"bed": {"ends": "window", "exchange_mm": 12}},
        "command line: bed.exchange_mm is 12 for row R9, allowed is at least 12.72 mm with bed.ends: window, the length"
        " of the strip that is held.",
    ),
    (
        {"sample": {"element_size_mm": 2.5}},
        "command line: sample.element_size_mm is 2.5 for row R9, allowed is at most 2 mm,"
        " the smaller radius of a bump.",
    ),
    (
        {"pattern": {"row_spacing_mm": 8.05}},
        "config/studies/small.yaml, line 9, fidelity quick: sample.element_size_mm is 1.5 for row R9, allowed is at"
        " most 0.555556 mm where bumps are 0.1 mm apart.",
    ),
    (
        {"sample": {"height_above_floor_mm": 2.2, "skirt_slope_deg": 45}},
        "command line: sample.height_above_floor_mm is 2.2 for row R9, allowed is below 2.12 mm,"
        " the radius of the smallest particle.",
    ),
    (
        {"ledger": "dumps", "solver": {"sampling_interval_steps": 30000}},
        "command line: solver.sampling_interval_steps is 30000 for row R9, allowed is below 28992,"
        " the time steps of a cycle.",
    ),
    (
        {"sliding": {"cycles": 10000, "travel_mm": 100}},
        "command line: sliding.cycles is 10000 for row R9, allowed is at most 115, so that a cycle has 100 time steps.",
    ),
    (
        {"pattern": {"row_spacing_mm": 2}},
        f"{ROW_9}: bumps overlap: major radius 8 mm needs each row more than 8 mm from the next, found 2 mm.",
    ),
    (
        {"fidelity": "paper"},
        "command line: fidelity is 'paper', allowed is one of quick, standard,"
        " the fidelities of config/studies/small.yaml.",
    ),
    ({"fidelity": "fast"}, "command line: fidelity is 'fast', allowed is one of quick, standard, paper."),
    (
        {"particle_scale": "2 mm"},
        "command line: unit mm is not allowed for particle_scale, write particle_scale,"
        " a number from 1 to 20 (found '2 mm').",
    ),
    (
        {"wear": {"acceleration": float("nan")}},
        "command line: wear.acceleration is nan, allowed is a number from 1e-09 to 1000000000.",
    ),
    (
        {"sampel": {"width_mm": 9}},
        "command line: sampel (a block of keys) is no known key, the nearest is sample.",
    ),
    (
        {"kk": "x"},
        "command line: kk ('x') is no known key, allowed are fidelity, particle_scale, packings, until, rows,"
        " materials, ledger, beyond_machine, wear, remeshing, solver, deck, sample, pattern, bed, sliding, packing,"
        " optimise.",
    ),
]
