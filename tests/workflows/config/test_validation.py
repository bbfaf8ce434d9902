"""Every wrong configuration is refused in one sentence: file, line, key or row, found, allowed."""

from __future__ import annotations

import re

import pytest

from bulkwear.meshes.pattern import PATTERNS
from bulkwear.postproc.wear.laws import LAWS
from bulkwear.workflows.cases.sliding_sample.decks import LEDGERS
from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.layers import ConfigError, command_line_layer, dotted, merge, read_yaml
from bulkwear.workflows.config.patterns import SURFACES, with_patterns
from bulkwear.workflows.config.readme import readme
from bulkwear.workflows.config.schema import OF_PACKAGE, SCHEMA_FOLDER, leaves, load_schema, validator
from bulkwear.workflows.config.validation import ALL_SUFFIXES, UNIT_OF_SUFFIX, check_layer
from bulkwear.workflows.engine.cases import case_names, find_case
from bulkwear.workflows.engine.ledgers import PRODUCERS
from bulkwear.workflows.report.page_parameters import page_of
from tests import REPOSITORY

SETTINGS = "default.yaml"
OWN_SETTINGS = "cases/sliding_sample.yaml"
STUDY = "studies/small.yaml"
TABLE = "designs/small.csv"
MATERIALS = "materials.yaml"
SUFFIX = ".schema.yaml"
SCHEMAS = sorted(
    path.relative_to(SCHEMA_FOLDER).as_posix().removesuffix(SUFFIX)
    for path in SCHEMA_FOLDER.rglob("*.yaml")
    if path.stem != "published.schema"  # of tables: a row says its unit, and where it is from
)
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
    ("", "config/designs/small.csv: the file is empty, allowed is a header and one row per run."),
    ("\n \n", "config/designs/small.csv: the file is empty, allowed is a header and one row per run."),
    (TABLE_HEADER, "config/designs/small.csv: found a header and no rows, allowed is one row or more."),
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


def message_of(config, overrides=None) -> str:
    with pytest.raises(ConfigError) as caught:
        load_study("small", config.project, overrides)
    return str(caught.value)


@pytest.mark.parametrize(("name", "old", "new", "message"), BAD_KEYS + BAD_VALUES)
def test_a_wrong_key_or_value_is_named_with_its_place_and_what_is_allowed(config, name, old, new, message):
    """One fault in one file gives one sentence: file, line, block, key, found, allowed."""
    config.edit(name, old, new)
    assert message_of(config) == message


@pytest.mark.parametrize(("old", "new", "message"), BAD_ROWS)
def test_a_wrong_design_row_is_named_with_line_row_and_column(config, old, new, message):
    """One fault in the design table gives one sentence: file, line, row, column, found, allowed."""
    config.edit(TABLE, old, new)
    assert message_of(config) == message


@pytest.mark.parametrize(("text", "message"), BAD_TABLES)
def test_a_table_without_rows_or_columns_is_refused(config, text, message):
    """A table that is empty, has no rows, another separator or too few columns is refused."""
    config.write(TABLE, text)
    assert message_of(config) == message


@pytest.mark.parametrize(("overrides", "message"), BAD_COMBINATIONS)
def test_values_that_do_not_fit_together_are_refused_before_any_solver(config, overrides, message):
    """Faults between values name the key to change, where it stands, and the limit with its reason."""
    assert message_of(config, overrides) == message


def test_every_message_is_one_sentence(config):
    """A message is one line and ends with one full stop."""
    messages = [case[-1] for case in BAD_KEYS + BAD_VALUES + BAD_ROWS + BAD_TABLES + BAD_COMBINATIONS]
    assert [text for text in messages if "\n" in text or not text.endswith(".") or ". " in text] == []


def test_text_in_another_encoding_is_refused(config):
    """A table saved as UTF-16 is refused by name."""
    config.path(TABLE).write_bytes(config.path(TABLE).read_text(encoding="utf-8").encode("utf-16"))
    assert message_of(config) == "config/designs/small.csv: byte 0 is not UTF-8, allowed is UTF-8 text."


def test_a_table_from_a_spreadsheet_is_read(config):
    """Byte order mark, CRLF, spaces and blank lines change nothing."""
    plain = load_study("small", config.project)
    text = config.path(TABLE).read_text(encoding="utf-8")
    spread = "\ufeff" + text.replace("\n", "\r\n\r\n").replace(",", " , ")
    config.path(TABLE).write_bytes(spread.encode())
    assert load_study("small", config.project) == plain


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            [(STUDY, "fidelities:", "sliding: {travel_mm: 500, test_duration_h: 2}\nfidelities:")],
            "config/studies/small.yaml, line 6: sliding.travel_mm and sliding.test_duration_h are both given, allowed"
            " is one of them.",
        ),
        (
            [(OWN_SETTINGS, " travel_mm: 1000,", "")],
            "config/cases/sliding_sample.yaml, line 23: sliding.travel_mm and sliding.test_duration_h are both missing,"
            " allowed is one of them.",
        ),
        (
            [(OWN_SETTINGS, "travel_mm: 1000", "test_duration_min: 2")],
            "config/cases/sliding_sample.yaml, line 23: unit min is not allowed for sliding.test_duration, write"
            " sliding.test_duration_h (found test_duration_min: 2).",
        ),
    ],
)
def test_either_a_travel_or_a_test_duration_is_given(config, changes, message):
    """Both in one place or none at all is a fault; hours are the unit."""
    for change in changes:
        config.edit(*change)
    assert message_of(config) == message


def test_broken_yaml_is_refused_with_its_line(config):
    """What is no YAML is refused with file and line."""
    config.edit(OWN_SETTINGS, "  seed: 20220317\n", "  seed: 20220317\n\tx: 1\n")
    assert message_of(config).startswith("config/cases/sliding_sample.yaml, line 21: found character '\\t'")


def test_a_file_that_is_no_mapping_is_refused(config):
    """A list where keys are expected is refused."""
    config.write(STUDY, "- a\n")
    assert message_of(config) == "config/studies/small.yaml: found a list, allowed is a mapping of keys to values."


def test_a_key_of_another_case_tells_that_the_study_names_none(config):
    """It would be taken for one of the default's."""
    config.write(STUDY, config.path(STUDY).read_text() + "parts:\n  liner: {file: liner.stl}\n")
    said = "parts is a key of equipment, and the study names no case, which is sliding_sample then; allowed is case:"
    assert said in message_of(config)


def test_a_folder_in_place_of_a_study_is_told(config):
    config.path(STUDY).unlink()
    config.path(STUDY).mkdir()
    assert message_of(config) == (
        f"config/{STUDY}: found no such file, a folder perhaps; allowed is the file of a study."
    )


def test_a_missing_file_is_named(config):
    """Without materials.yaml the message says which files there are."""
    config.path(MATERIALS).unlink()
    assert message_of(config) == ("config/materials.yaml: there is no such file, found in its folder: default.yaml.")


@pytest.mark.parametrize("text", ["6.3e-13", "6.3E-13", "63e-14", "+6.3e-13", ".63e-12", "0.00000000000063"])
def test_every_way_to_write_a_float_is_a_number(config, text):
    """YAML 1.2 floats are numbers, also without a point before the exponent (YAML 1.1: 63e-14 is text)."""
    config.edit(SETTINGS, "6.3e-13", text)
    study = load_study("small", config.project)
    assert study.settings["wear"]["wear_coefficient_per_pa"] == 6.3e-13


@pytest.mark.parametrize(("text", "value"), [("010", 10), ("1_0", "1_0"), ("1:30", "1:30"), ("on", "on"), ("~", None)])
def test_yaml_1_1_surprises_do_not_happen(tmp_path, text, value):
    """No octal 010, no base-60 1:30, no boolean `on`, no underscores in numbers."""
    (tmp_path / "a.yaml").write_text(f"key: {text}\n", encoding="utf-8")
    assert read_yaml(tmp_path / "a.yaml", tmp_path).values == {"key": value}


def test_command_line_text_becomes_numbers():
    """A shell knows only text; numbers and booleans in it are read as in the files, words stay words."""
    given = {"a": "2", "b": {"c": "1e-9", "d": "True", "e": "steel"}, "f": [{"low": "0.1"}, ["3"], "4"]}
    read = {"a": 2, "b": {"c": 1e-9, "d": True, "e": "steel"}, "f": [{"low": 0.1}, [3], 4]}
    assert command_line_layer(given).values == read


def test_names_of_rows_stay_words():
    """A row may be called 5."""
    assert command_line_layer({"rows": ["5", "R9"]}).values == {"rows": ["5", "R9"]}


def test_merge_is_deep_and_changes_nothing():
    """Keys of the upper mapping win at every depth; both arguments stay as they were."""
    lower, upper = {"a": {"b": 1, "c": 2}, "d": {"g": 3}}, {"a": {"c": 4}, "e": {"f": 5}}
    merged = merge(lower, upper)
    merged["a"]["b"] = merged["d"]["g"] = merged["e"]["f"] = 9
    assert merged == {"a": {"b": 9, "c": 4}, "d": {"g": 9}, "e": {"f": 9}}
    assert (lower, upper) == ({"a": {"b": 1, "c": 2}, "d": {"g": 3}}, {"a": {"c": 4}, "e": {"f": 5}})


def test_schemas_of_the_package_are_json_schemas():
    """Nobody looks at them again when they are read."""
    files = sorted(OF_PACKAGE.rglob("*.schema.yaml"))
    assert SCHEMA_FOLDER / "settings.schema.yaml" in files and any("cases" in path.parts for path in files)
    for path in files:
        validator().check_schema(with_patterns(read_yaml(path, REPOSITORY).values))


@pytest.mark.parametrize("name", SCHEMAS)
def test_units_of_the_schemas_agree_with_the_keys(name):
    """The unit that a schema states is the one that the key's suffix spells, for every number."""
    for path, schema in leaves(load_schema(name)):
        if "x-unit" in schema:
            suffix = next((s for s in ALL_SUFFIXES if str(path[-1]).endswith(f"_{s}")), None)
            assert UNIT_OF_SUFFIX.get(suffix, "-") == schema["x-unit"], dotted(path)


@pytest.mark.parametrize("name", SCHEMAS)
def test_every_number_has_a_range_a_unit_and_a_meaning(name):
    """No number without lower and upper bound, unit and description."""
    numbers = [(p, s) for p, s in leaves(load_schema(name)) if s.get("type") in ("number", "integer")]
    for path, schema in numbers:
        bounds = [key for key in schema if re.fullmatch(r"(exclusive)?(minimum|maximum)", key, re.IGNORECASE)]
        assert len(bounds) == 2, dotted(path)
        assert {"x-unit", "description"} <= set(schema), dotted(path)


def test_the_sampling_interval_matters_to_sampled_contacts_only(config):
    """With the solver's ledger no cycle is too short to be sampled, and the interval is no parameter of any run."""
    study = load_study("small", config.project, {"solver": {"sampling_interval_steps": 30000}})
    assert all("sampling_interval_steps" not in run.parameters["solver"] for run in study.runs)
    other = load_study("small", config.project, {"solver": {"sampling_interval_steps": 7}})
    assert [run.parameters for run in other.runs] == [run.parameters for run in study.runs]


def test_every_folder_of_a_case_can_be_chosen_and_has_its_page():
    """The study's schema offers the cases whose folders are there; each registers itself and has a page."""
    offered = load_schema("study")["properties"]["case"]["enum"]
    assert offered == case_names() and len(offered) >= 4
    assert [find_case(name).name for name in offered] == offered
    assert all(callable(page_of(name).sections) for name in offered)


def test_every_law_and_every_producer_can_be_chosen():
    """The schema offers the wear laws and the producers of ledgers that there are, and no others."""
    properties = load_schema("settings")["properties"]
    assert set(properties["wear"]["properties"]["law"]["enum"]) == set(LAWS)
    assert set(properties["ledger"]["enum"]) == set(PRODUCERS) == set(LEDGERS)


def test_a_plain_sample_needs_elements_too(config):
    """A plain study, which no bump bounds, still has four elements along its shorter side."""
    config.edit(STUDY, "[convex, plain]", "[plain]")
    assert message_of(config, {"sample": {"element_size_mm": 20, "width_mm": 70}}) == (
        "command line: sample.element_size_mm is 20 for row R9, allowed is at most 17.5 mm,"
        " a quarter of the sample's shorter side."
    )


def test_columns_of_a_pattern_are_needed_by_its_surface_only(config):
    """A plain study's design has no dimensions of a bump, and no pattern is asked for words that describe one."""
    config.edit(STUDY, "[convex, plain]", "[plain]")
    config.write(TABLE, "row,column_spacing_mm,velocity_m_per_s,bed_thickness_mm\nR9,20,1.0,40\n")
    config.edit(OWN_SETTINGS, "major_axis: along_travel, ", "")
    assert [run.parameters["pattern"] for run in load_study("small", config.project).runs] == [None]


def test_a_pattern_lacks_no_word_that_describes_it(config):
    """A key of the section `pattern` that only some surfaces need is named where one of them lacks it."""
    config.edit(OWN_SETTINGS, "major_axis: along_travel, ", "")
    assert message_of(config) == (
        "config/cases/sliding_sample.yaml, line 9: pattern.major_axis is missing,"
        " allowed is one of along_travel, across_travel, which its surface needs."
    )


def test_a_factor_is_a_column_of_the_design(config):
    """A regression on a dimension that the design does not give is refused."""
    config.edit(STUDY, "[convex, plain]", "[plain]\nfactors: {t: bed_thickness_mm, h: height_mm}")
    config.write(TABLE, "row,column_spacing_mm,velocity_m_per_s,bed_thickness_mm\nR9,20,1.0,40\nR5,20,1.0,50\n")
    assert message_of(config) == (
        "config/studies/small.yaml, line 5: factors.h is height_mm,"
        " allowed are columns that the design gives in every row."
    )


def test_a_travel_too_short_for_one_cycle_is_named(config):
    """Where no number of cycles helps, the travel is named."""
    config.edit(TABLE, "R9,8,2,20,6.0,1.0", "R9,8,2,20,6.0,20")
    message = message_of(config, {"sliding": {"travel_mm": 1}, "solver": {"sampling_interval_steps": 1}})
    assert message == (
        "command line: sliding.travel_mm is 1 for row R9, allowed is at least 17.2461 mm, 100 time steps."
    )


def test_the_first_fault_of_a_file_is_reported(config):
    """Of two faults in a file the upper one is named; a missing key, which has no line, comes last."""
    config.edit(OWN_SETTINGS, "length_mm: 200", "length_mm: 0")
    config.edit(OWN_SETTINGS, "  width_mm: 200\n", "")
    config.edit(OWN_SETTINGS, "seed: 20220317", "seed: 0")
    with pytest.raises(ConfigError, match=r"line 2: sample.length_mm is 0"):
        check_layer(read_yaml(config.path(OWN_SETTINGS), config.root), load_schema("cases/sliding_sample/settings"))


def test_the_page_of_keys_is_up_to_date(repository):
    """config/README.md is what `python -m bulkwear.workflows.config.readme` writes."""
    assert (repository / "config" / "README.md").read_text(encoding="utf-8") == readme()


@pytest.mark.parametrize(
    ("given", "key", "column"),
    [
        ({"bed": {"thickness_mm": 46}}, "bed.thickness_mm (46)", "bed_thickness_mm"),
        ({"sliding": {"velocity_m_per_s": 1}}, "sliding.velocity_m_per_s (1)", "velocity_m_per_s"),
        ({"bed_thickness_mm": 46}, "bed_thickness_mm (46)", "bed_thickness_mm"),
    ],
)
def test_a_key_that_is_a_column_of_the_design_is_told(given, key, column):
    """What the design table gives is no setting; the refusal names the column."""
    with pytest.raises(ConfigError) as fault:
        load_study("demo", overrides=given)
    said = f"{key} is no known key, it is the column {column} of the study's design table."
    assert str(fault.value) == f"command line: {said}"


def test_a_setting_that_every_row_has_its_own_of_is_refused_on_the_command_line():
    """It would change nothing; where a row lacks the column, it does."""
    with pytest.raises(ConfigError) as fault:
        load_study("particle_size", overrides={"particle_scale": 20})
    assert str(fault.value) == (
        "command line: particle_scale changes nothing, for every row of config/designs/particle_size.csv has its own"
        " particle_scale; allowed is to choose among them (rows), or another design."
    )
    assert load_study("circular_tester", overrides={"particle_scale": 5}).runs
