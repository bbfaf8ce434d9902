"""Interactive figures of the circular wear tester."""

from __future__ import annotations

from bulkwear.postproc.mesh import PLAIN
from bulkwear.postproc.plots.chart import BARS, LEVELS, LINES, Axis, Chart, Layer, Panel, one_panel
from bulkwear.postproc.tables.display import DEGREES, MILLIMETRES

SETTING = ("surface", "shape", "particle_scale")
INTERVAL = {"low": "interval_low", "high": "interval_high"}
REVOLUTION, REVOLUTIONS = Axis("Revolution"), Axis("Revolutions")
LOST = Axis("Lost volume", "mm³")
OF_SETTINGS = {"x": "revolution", "group": SETTING}
OF_SURFACES = {"x": "revolution", "group": ("surface",), **INTERVAL}
YAN = {"name": "Yan 2022", "published": True}
PERCENT = 100.0


def _of_surfaces(quantities: tuple[str, ...]) -> dict[str, str]:
    """Return the colours of published quantities: those of the surface that their name begins with."""
    return {name: "ORANGE" if name.startswith(PLAIN) else "BLUE" for name in quantities}


VOLUME = one_panel(
    REVOLUTIONS,
    LOST,
    Layer(LINES, "volume_mm3", **OF_SETTINGS, **INTERVAL),
    Layer(LINES, "published_volume_mm3", **OF_SETTINGS, **YAN),
)
FIRST_AND_LAST = ("plain_first_increment", "plain_last_increment")
OF_THESE = {"only": {"quantity": FIRST_AND_LAST}}
INCREMENTS = Chart(
    (
        Panel(
            REVOLUTION,
            Axis("Lost per revolution by an element", "mm³"),
            (
                Layer(LINES, "element_increment_mm3", **OF_SETTINGS),
                Layer(LEVELS, "value", table="published", group=("quantity",), **OF_THESE, **YAN),
            ),
        ),
        Panel(
            REVOLUTION,
            Axis("Lost per revolution by the sample", "mm³"),
            (Layer(LINES, "increment_mm3", **OF_SETTINGS, **INTERVAL),),
        ),
    ),
    colours=_of_surfaces(FIRST_AND_LAST),
)
VALUES = {"x": ("quantity", "hours")}
HOURS = one_panel(
    Axis("Quantity, hours of the test"),
    Axis("Value"),
    Layer(BARS, "experiment", **VALUES, name="experiment", published=True),
    Layer(BARS, "thesis' model", **VALUES, name="thesis' model", published=True),
    Layer(BARS, "thesis, our particle scale", **VALUES, name="thesis' model, our particle scale", published=True),
    Layer(BARS, "ours", **VALUES, **INTERVAL, name="ours"),
    split="unit",
    axes={"mm3": Axis("Volume", "mm³"), "%": Axis("Reduction", "%"), "mm": Axis("Largest loss", "mm")},
    names={"mm3": "Volumes", "%": "Reduction by the pattern", "mm": "Largest loss of bumps"},
    colours={"experiment": "OTHER_COLOUR", "thesis' model": "BASE_COLOUR", "ours": "BLUE"},
)
SHORT = {"hours": 56.0}
PREDICTED = {"low": "volume_mm3_low", "high": "volume_mm3_high", "only": SHORT}
SHORT_TEST = ("plain_volume_56_h", "convex_volume_56_h")
MEASURED = {"quantity": SHORT_TEST, "of": "laboratory"}
BENCHMARK = one_panel(
    Axis("Particle scale", "-"),
    Axis("Volume after the short test", "mm³"),
    Layer(BARS, "volume_mm3", "particle_scale", **PREDICTED, group=("surface",), name="ours"),
    Layer(LEVELS, "value", table="published", group=("quantity",), only=MEASURED, name="measured", published=True),
    colours=_of_surfaces(SHORT_TEST),
)
STEADINESS = one_panel(
    REVOLUTION,
    Axis("Coefficient of variation", "%"),
    Layer(LINES, "variation", **OF_SURFACES, factor=PERCENT),
    split="measure",
    names={
        "velocity_m_per_s": "particle velocity",
        "bed_height_m": "bed height",
        "wear_rate_m3_per_s": "wear rate",
    },
)


def _by_revolution(measure: str, axis: Axis, factor: float, *published: str) -> Chart:
    """Return the chart of a measure of the flow; published: quantities of it, with their deviations."""
    return one_panel(
        REVOLUTION,
        axis,
        Layer(LINES, "mean", **OF_SURFACES, only={"measure": measure}, factor=factor),
        Layer(
            LEVELS,
            "value",
            table="published",
            spread="uncertainty",
            band=True,
            group=("quantity",),
            only={"quantity": published},
            **YAN,
        ),
        colours=_of_surfaces(published),
    )


SPIN = _by_revolution(
    "bottom_averaged_angular_velocity_rad_per_s",
    Axis("Averaged angular velocity of the bottom layer", "°/s"),
    DEGREES,
    *("convex_first_angular_speed", "convex_last_angular_speed"),
    *("plain_least_angular_speed", "plain_largest_angular_speed"),
)
VELOCITY = _by_revolution(
    "bottom_velocity_m_per_s",
    Axis("Velocity of the bottom layer", "mm/s"),
    MILLIMETRES,
    *("plain_velocity_above", "convex_velocity_below"),
)
FORCE = _by_revolution(
    "normal_force_N",
    Axis("Normal force", "N"),
    1.0,
    *("convex_first_normal_force", "convex_last_normal_force"),
    *("plain_least_normal_force", "plain_largest_normal_force"),
)
AT_COEFFICIENT = Axis("Revolutions at the study's coefficient")
OF_RUNS = {"x": "revolution", "group": ("run",)}
PLAIN_RATE = {"y": "plain_per_revolution_mm3", "name": "plain sample", "dashed": True}
WORN_OUT = Chart(
    (
        Panel(
            AT_COEFFICIENT,
            Axis("Pattern left", "% of its volume"),
            (Layer(LINES, "pattern_share", **OF_RUNS, factor=PERCENT),),
        ),
        Panel(
            AT_COEFFICIENT,
            Axis("Lost per revolution", "mm³"),
            (Layer(LINES, "mean_per_revolution_mm3", **OF_RUNS), Layer(LEVELS, **PLAIN_RATE)),
        ),
    )
)
