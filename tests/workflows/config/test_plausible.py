"""Nonsense that a machine could begin, and no person can mean, is refused in one sentence."""

import pytest

from bulkwear.workflows.config.design import load_study
from bulkwear.workflows.config.layers import ConfigError
from bulkwear.workflows.config.run_checks import MOST_STEPS
from bulkwear.workflows.config.schema import LEAST, case_schema, leaves, load_schema
from bulkwear.workflows.engine.cases import case_names

MATERIALS, DESIGN, DEFAULT = "materials.yaml", "designs/small.csv", "default.yaml"
THREE = "relative_diameter: [0.8, 1.0, 1.2]"
NONSENSE = {
    "sizes far from their median": (MATERIALS, THREE, "relative_diameter: [18, 19, 20]", "median of 19 by mass"),
    "sizes of one value": (MATERIALS, THREE, "relative_diameter: [20, 20, 20]", r"\[20, 20, 20\], allowed are rising"),
    "sizes swapped": (MATERIALS, THREE, "relative_diameter: [1.2, 1.0, 0.8]", "allowed are rising numbers"),
    "a coefficient of nothing": (
        DEFAULT,
        "6.3e-13",
        "1e-320",
        "allowed is a number from 1e-20 to 1e-06 1/Pa",
    ),
    "a step of nothing": (
        DEFAULT,
        "edge_fraction: 0.1",
        "edge_fraction: 1e-300",
        "edge_fraction is 1e-300, allowed is",
    ),
    "a patch of nothing": (DEFAULT, "patch_radius_mm: 1.0", "patch_radius_mm: 1e-9", "allowed is a number from 0.001"),
    "a long name": (DESIGN, "R9,8", f"{'R' * 300},8", "line 2: row is a name of 300 letters, allowed are 60"),
    "a name of two lines": (DESIGN, "R9,8", '"R\n9",8', r"line 3: found 'R\\n9'"),
    "steps without end": (
        "cases/sliding_sample.yaml",
        "travel_mm: 1000",
        "travel_mm: 100000",
        f"time steps, allowed are at most {MOST_STEPS}",
    ),
}


@pytest.mark.parametrize("what", NONSENSE)
def test_nonsense_is_refused(config, what):
    """The sentence names file, key or row, what was found and what is allowed."""
    file, old, new, said = NONSENSE[what]
    config.edit(file, old, new)
    if what == "steps without end":
        config.edit(DEFAULT, "rayleigh_fraction: 0.2", "rayleigh_fraction: 0.01")
        config.edit(MATERIALS, "shear_modulus_pa: 0.07e9", "shear_modulus_pa: 1e12")
        config.edit(MATERIALS, "median_diameter_mm: 2.65", "median_diameter_mm: 0.7")
        config.edit(DESIGN, "6.0,1.0,40", "6.0,0.001,40")
    with pytest.raises(ConfigError, match=said):
        load_study("small", project=config.project)


@pytest.mark.parametrize("name", ["settings", "materials", *(f"cases/{case}/design" for case in case_names())])
def test_every_number_has_a_range(name):
    """From a least value that is sensible to a largest one: no key takes what is only not 0."""
    schemas = [load_schema(name)] + [case_schema(case, "settings") for case in case_names() if name == "settings"]
    for schema in schemas:
        for path, inner in leaves(schema):
            if inner.get("type") not in ("number", "integer"):
                continue
            assert "minimum" in inner or "exclusiveMinimum" in inner, path
            assert "maximum" in inner or "exclusiveMaximum" in inner, path
            if inner.get("minimum") in LEAST.values() and inner["type"] == "number":
                assert inner["minimum"] > 0.0
