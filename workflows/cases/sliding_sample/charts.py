"""Interactive figures of studies of sliding samples, of their screenings and of particle size."""

from __future__ import annotations

from bulkwear.postproc.plots.chart import BARS, LEVELS, LINES, POINTS, Axis, Chart, Layer, Panel, one_panel

INTERVAL = {"low": "interval_low", "high": "interval_high"}
SETTING = ("setting", "surface")
TRAVEL, SETTINGS, SCALE = Axis("Travel", "mm"), Axis("Setting"), Axis("Particle scale", "-")
OVER_PLAIN = Axis("Wear volume over the plain sample's", "-")
PLAIN_SAMPLE = {"plain sample": 1.0}  # by definition
RUNS = {"x": "travel_mm", "group": ("surface",), "curve": ("setting", "run")}
SIFTED = {"sift": "setting"}
RELATIONS = {"about": "about", "above": "at least", "below": "at most"}
YAN = {"name": "Yan 2022", "published": True}

APPLIED = {"name": "applied", "said": "Applied to the surface", "dashed": True}
WEAR_AGAINST_TRAVEL = one_panel(
    TRAVEL,
    Axis("Cumulative wear volume", "mm³"),
    Layer(LINES, "worn_volume_mm3", **RUNS, said="Worn by the law"),
    Layer(LINES, "applied_volume_mm3", **RUNS, **APPLIED, but={"applied_volume_mm3": 0.0}),
    **SIFTED,
)
BOTH = "both, with interval"
PARTS = {"base": "BASE_COLOUR", "pattern": "PATTERN_COLOUR", BOTH: "OTHER_COLOUR"}
WEAR_SPLIT = one_panel(
    SETTINGS,
    OVER_PLAIN,
    Layer(BARS, "base_over_plain", SETTING, name="base", said="Base"),
    Layer(BARS, "pattern_over_plain", SETTING, name="pattern", said="Pattern"),
    Layer(POINTS, "wear_over_plain", SETTING, **INTERVAL, name=BOTH, said="Both"),
    levels=PLAIN_SAMPLE,
    colours=PARTS,
    stacked=True,
)
RELATIVE_WEAR = one_panel(
    SETTINGS,
    OVER_PLAIN,
    Layer(BARS, "wear_over_plain", "setting", **INTERVAL, group=("surface",)),
    Layer(POINTS, "value", "row", table="published", group=("relation",), said="Published", **YAN),
    levels=PLAIN_SAMPLE,
    names=RELATIONS,
)
PREDICTED = {"low": "predicted_low", "high": "predicted_high"}
SEARCH_RECORD = one_panel(
    Axis("Pattern"),
    Axis("Wear over plain", "-"),
    Layer(POINTS, "wear_over_plain", "setting", **INTERVAL, group=("enough_left",), said="Simulated"),
    Layer(POINTS, "predicted", "setting", **PREDICTED, name="predicted before", said="Predicted before"),
    levels=PLAIN_SAMPLE,
    names={"yes": "enough is left", "no": "too little is left"},
)
SEARCH_SLICES = one_panel(
    Axis("Value of the factor", "mm"),
    Axis("Wear over plain", "-"),
    Layer(LINES, "predicted", "value", **PREDICTED, band=True),
    split="factor",
)
DEPTHS = one_panel(
    Axis("Depth", "µm", log=True),
    Axis("Area worn deeper", "% of the sample"),
    Layer(LINES, "area_share_percent", **(RUNS | {"x": "depth_um"})),
    **SIFTED,
)
LAWS = one_panel(
    SETTINGS,
    Axis("Wear volume", "mm³", log=True),
    Layer(POINTS, "worn_volume_mm3", SETTING, name="the study's law"),
    Layer(POINTS, "finnie_volume_mm3", SETTING, name="Finnie, the solver's own"),
)
FORCES = (
    one_panel(
        SETTINGS,
        Axis("Mean force", "N"),
        Layer(POINTS, "mean_force_N", "setting", **INTERVAL, group=("surface",)),
        split="direction",
    ),
    Chart(
        tuple(
            Panel(TRAVEL, Axis(f"{direction.capitalize()} force", "N"), (Layer(LINES, f"{direction}_force_N", **RUNS),))
            for direction in ("vertical", "drag")
        ),
        **SIFTED,
    ),
)
PUBLISHED_VELOCITY = Layer(
    LEVELS, "value", table="published", split="of", only={"quantity": "relative_velocity"}, **YAN
)
BY_ROW = RUNS | {"curve": ("row", "run")}
RELATIVE_VELOCITY = one_panel(
    TRAVEL,
    Axis("Relative velocity of the particles", "%"),
    Layer(LINES, "relative_velocity_percent", **BY_ROW),
    PUBLISHED_VELOCITY,
    split="regime",
    sift="row",
)
WEAR_GRADIENT = one_panel(
    TRAVEL,
    Axis("Wear gradient over the largest of all runs", "-"),
    Layer(LINES, "relative_gradient", **BY_ROW),
    split="regime",
    sift="row",
)
BY_REGIME = {"split": "regime"}
WEAR_BY_REGIME = one_panel(
    SETTINGS,
    Axis("Wear per length over the largest of the regime", "-"),
    Layer(BARS, "base_relative_wear", SETTING, name="base", said="Base"),
    Layer(BARS, "bump_relative_wear", SETTING, name="pattern", said="Pattern"),
    Layer(POINTS, "relative_wear", SETTING, **INTERVAL, name=BOTH, said="Both"),
    colours=PARTS,
    stacked=True,
    **BY_REGIME,
)
FORCE_BY_REGIME = one_panel(
    SETTINGS,
    Axis("Normal force on the sample", "N"),
    Layer(POINTS, "mean_normal_force_N", "setting", **INTERVAL, group=("surface",)),
    **BY_REGIME,
)
BY_SCALE = {"x": "particle_scale", "group": ("curve",)}
WEAR_AGAINST_SCALE = one_panel(
    SCALE,
    Axis("Wear over the plain sample's with the smallest particles", "-"),
    Layer(POINTS, "relative_wear", **BY_SCALE, curve=("row",)),
    Layer(LINES, "relative_wear", **BY_SCALE, table="published_lines", **YAN),
    names={"bumps": "pattern"},
    colours={"plain": "ORANGE", "convex": "BLUE"},
)
STEADY = {"x": "particle_scale", "spread": "deviation_percent"}
STEADY_BY_SCALE = one_panel(
    SCALE,
    Axis("Mean in the steady window", "%"),
    Layer(POINTS, "mean_percent", **STEADY, group=("surface",), curve=("run",)),
    Layer(LEVELS, "value", table="published", split="quantity", group=("surface", "relation"), **YAN),
    split="measure",
    names=RELATIONS,
    axes={
        "relative_velocity": Axis("Relative velocity of the particles", "%"),
        "relative_wear_rate": Axis("Wear rate over the largest of all runs", "%"),
    },
)


def _of_motion(column: str, title: str) -> Chart:
    """Return a component of the velocity against the height of the layer, a curve per run."""
    scales = {"group": ("particle_scale",), "curve": ("run",)}
    layer = Layer(LINES, "height_mm", column, **scales)
    return one_panel(Axis(title, "m/s"), Axis("Height of the layer", "mm"), layer, split="surface")


VELOCITY = _of_motion("velocity_m_per_s", "Velocity with the sample")
UPWARDS = _of_motion("upward_m_per_s", "Velocity upwards")
SIDEWAYS = _of_motion("sideways_m_per_s", "Velocity sideways")
SPIN_ALONG = one_panel(
    Axis("Distance behind the front edge", "mm"),
    Axis("Averaged angular velocity of the lowest layer", "°/s"),
    Layer(
        LINES,
        "averaged_angular_velocity_deg_per_s",
        "along_mm",
        group=("particle_scale",),
        curve=("run",),
    ),
    split="surface",
)
