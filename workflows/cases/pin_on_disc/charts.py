"""Interactive figures of a pin on its disc."""

from __future__ import annotations

from bulkwear.postproc.plots.chart import BARS, LEVELS, LINES, POINTS, Axis, Chart, Layer, Panel, one_panel
from bulkwear.postproc.tables.display import CUBIC_MILLIMETRES, MICROMETRES, MILLIMETRES

REVOLUTIONS = Axis("Revolutions")
COEFFICIENT = "wear_coefficient_per_pa"
NAMES = {COEFFICIENT: "coefficient (1/Pa)"}
COLOURS = {"conserving": "BLUE", "per_triangle": "ORANGE"}
VOLUMES = {"x": "revolution", "factor": CUBIC_MILLIMETRES}

WEAR_VOLUME = one_panel(
    REVOLUTIONS,
    Axis("Volume", "mm³"),
    Layer(LINES, "removed_volume_m3", **VOLUMES, group=("scheme",), curve=("run",), said="Removed from the surface"),
    Layer(
        LINES,
        "touched_centroid_path_volume_m3",
        **VOLUMES,
        group=("scheme",),
        curve=("run",),
        only={"scheme": "per_triangle"},
        name="Eq 5.9 over touched triangles",
        said="By Eq 5.9",
        dashed=True,
    ),
    Layer(LINES, "published_volume_m3", **VOLUMES, name="Yan 2022, Eq 5.11 to 5.15", published=True),
    Layer(LINES, "law_volume_m3", **VOLUMES, name="alpha F L"),
    split=COEFFICIENT,
    names=NAMES,
    colours=COLOURS,
)
OF_SCHEMES = {"x": "revolution", "group": ("scheme",), "curve": (COEFFICIENT, "run")}
FORCES = {
    "vertical_force_over_load": "Vertical force over load",
    "force_rise": "Sum of normal forces over load",
    "contacts": "Contacts at once",
}
FORCE_RISE = Chart(
    tuple(Panel(REVOLUTIONS, Axis(words, "-"), (Layer(LINES, name, **OF_SCHEMES),)) for name, words in FORCES.items()),
    sift=COEFFICIENT,
    names=NAMES,
    colours=COLOURS,
)
LABORATORY = {"low": "laboratory_low_per_pa", "high": "laboratory_high_per_pa", "band": True}
CALIBRATION = one_panel(
    Axis("Simulated revolutions that stand for the test"),
    Axis("Wear coefficient", "1/Pa", log=True),
    Layer(LINES, "laboratory_per_pa", "revolutions", **LABORATORY, name="laboratory's, by Archard", published=True),
    Layer(POINTS, COEFFICIENT, "revolutions", f"least_{COEFFICIENT}", f"largest_{COEFFICIENT}", group=("scheme",)),
    colours=COLOURS,
)
BOUND = {"table": "published", "only": {"quantity": "size_invariance_difference"}, "published": True}
SIZE_INVARIANCE = one_panel(
    Axis("Scale of the pin", "-"),
    Axis("Volume less that of Archard's law", "%"),
    Layer(LINES, "difference_percent", "particle_scale", curve=("run",), name="simulated, one revolution"),
    *(Layer(LEVELS, "value", **BOUND, name="Yan 2022, at most", factor=sign) for sign in (1.0, -1.0)),
)
COMPARED = {"depth": "mm", "width": "mm", "volume": "mm³"}
COMPARISON = Chart(
    tuple(
        Panel(
            Axis(name.capitalize(), unit),
            Axis("Case"),
            (Layer(BARS, "case", f"{name}_{unit.replace('³', '3')}", name=name),),
        )
        for name, unit in COMPARED.items()
    )
)
SIZES = {"depth": Axis("Depth", "µm"), "opening width": Axis("Opening width", "mm")}
FACTORS = {"depth": MICROMETRES, "opening width": MILLIMETRES}
CONTOUR = {"y": "mean_m", "x": "revolution", "spread": "deviation_m", "group": ("scheme",), "curve": ("run",)}
RUN_IN = Chart(
    tuple(
        Panel(REVOLUTIONS, axis, (Layer(LINES, **CONTOUR, only={"size": size}, factor=FACTORS[size]),))
        for size, axis in SIZES.items()
    ),
    sift="run",
    colours=COLOURS,
)
MESHES = Chart(
    tuple(
        Panel(
            Axis("Size of the elements", "mm"),
            axis,
            (
                Layer(
                    LINES,
                    "mean_mm",
                    "element_size_mm",
                    spread="deviation_mm",
                    group=("scheme",),
                    only={"size": size},
                    factor=FACTORS[size] / MILLIMETRES,
                ),
            ),
        )
        for size, axis in SIZES.items()
    ),
    colours=COLOURS,
)
