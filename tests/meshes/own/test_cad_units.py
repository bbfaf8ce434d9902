"""The unit that a CAD file says itself, in each way that programs write it."""

import pytest

from bulkwear.meshes.own.cad_units import said_unit
from bulkwear.meshes.own.mesh import own_mesh
from tests.support.own_solids import SIZES, write_bodies

MILLIMETRE = "( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )"
INCH = "( CONVERSION_BASED_UNIT('INCH',#901) LENGTH_UNIT() NAMED_UNIT(#902) )"
INCH_LAST = "( LENGTH_UNIT() NAMED_UNIT(#902) CONVERSION_BASED_UNIT ( 'INCH', #901 ) )"
FOOT = "( CONVERSION_BASED_UNIT('FOOT',#901)\n  LENGTH_UNIT()\n  NAMED_UNIT(#902) )"
DEGREE = "( CONVERSION_BASED_UNIT('DEGREE',#904) NAMED_UNIT(#905) PLANE_ANGLE_UNIT() )"
BASE = (
    "#901 = LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#903);\n#902 = DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n"
    f"#903 = {MILLIMETRE};\n"
)
CONTEXT = (
    "#7 = ( GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#9))\n"
    "GLOBAL_UNIT_ASSIGNED_CONTEXT ( ( #10, #8 ) ) REPRESENTATION_CONTEXT('of a; b','') );\n"
)


def said(path, text):
    path.write_text(text)
    return said_unit(path)


@pytest.mark.parametrize("context", [CONTEXT, ""], ids=["context", "no context"])
@pytest.mark.parametrize(("entity", "unit"), [(INCH, "in"), (INCH_LAST, "in"), (FOOT, "ft"), (MILLIMETRE, "mm")])
@pytest.mark.parametrize("base_first", [True, False])
def test_a_converted_unit_of_a_step_file_is_its_unit(tmp_path, context, entity, unit, base_first):
    """The mm that inches are converted to are not, wherever they stand; angles are no lengths."""
    units = f"#8 = {entity};\n#10 = {DEGREE};\n"
    assert said(tmp_path / "a.step", f"{context}{BASE}{units}" if base_first else f"{units}{BASE}{context}") == unit


def test_the_unit_of_a_step_file_is_the_one_of_its_context(tmp_path):
    """Inches that only a note is in are not."""
    assert said(tmp_path / "a.stp", f"#11 = {INCH};\n{BASE}#8 = {MILLIMETRE};\n{CONTEXT}") == "mm"


def test_a_step_file_in_inches_is_read_in_inches(tmp_path):
    """The box is 25.4 times as large as one in mm, and mm are refused."""
    write_bodies(tmp_path / "bodies.step")
    text = (tmp_path / "bodies.step").read_text()
    base = BASE.replace("#90", "#9990")
    inches = text.replace(MILLIMETRE, INCH.replace("#90", "#9990")).replace("DATA;\n", f"DATA;\n{base}", 1)
    (tmp_path / "bodies.step").write_text(inches)
    part = own_mesh(tmp_path / "bodies.step", "in", 0.5).parts[0]
    assert part.high_m == pytest.approx([0.0254 * size for size in SIZES["trough"]])
    with pytest.raises(ValueError, match="the file says that its lengths are in in, found unit mm; allowed is in"):
        own_mesh(tmp_path / "bodies.step", "mm", 0.5)


AFTER = "32,308,15,308,15,7Hbox.IGS,{scale},{unit},2HMM,50,0.125,13H191011.120000,1E-08,499990.,4Hjohn,,11,0,;"
IGES_HEADS = {
    "nothing told": (",,7Hbox.IGS,10HC:\\box.IGS,9HSome CAD1,4HV1.0,", ",;"),
    "delimiters told": ("1H,,1H;,7Hbox.IGS,10HC:\\box.IGS,15HSolidWorks 2019,15HSolidWorks 2019,", ",;"),
    "the first told": ("1H,,,7Hbox.IGS,10HC:\\box.IGS,9HSome CAD1,4HV1.0,", ",;"),
    "other delimiters": ("1H//1H#/8Hbox,/IGS/10HC;\\box#IGS/9HSome CAD1/4HV1.0/", "/#"),
    "delimiters in texts": (",,9H;box,.IGS,10HC:\\box.IGS,16HCAD 4, Inc. V1.0,4HV,;0,", ",;"),
}


def iges(fields):
    """The lines of a global section, 72 letters each."""
    lines = [fields[first : first + 72] for first in range(0, len(fields), 72)]
    return "\n".join([f"{'':72}S      1", *(f"{line:72}G{n:7d}" for n, line in enumerate(lines, start=1)), ""])


@pytest.mark.parametrize("head", IGES_HEADS)
@pytest.mark.parametrize("scale", ["1", "1."])
@pytest.mark.parametrize(("flag", "unit"), [(1, "in"), (2, "mm"), (10, "cm"), (3, None)])
def test_the_unit_of_an_iges_file_is_its_flag(tmp_path, head, scale, flag, unit):
    """Whether delimiters are told, and whatever texts hold; the scale of the model is none."""
    begin, (delimiter, end) = IGES_HEADS[head]
    after = AFTER.format(scale=scale, unit=flag).replace(",", delimiter).replace(";", end)
    assert said(tmp_path / "a.igs", iges(begin + after)) == unit


@pytest.mark.parametrize("fields", ["", ",,7Hbox", ",,;", ",,99Hbox.IGS,1,2,3,4,5,6,7,8,9,10,11,12,13;"])
def test_an_iges_file_that_is_cut_short_says_no_unit(tmp_path, fields):
    """It is refused where it is read."""
    assert said(tmp_path / "a.iges", iges(fields)) is None
