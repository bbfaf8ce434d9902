"""Interactive figures of a calibration."""

from __future__ import annotations

from bulkwear.postproc.plots.chart import BARS, LEVELS, LINES, POINTS, Axis, Chart, Layer, Panel, one_panel

RESPONSES = {
    "shear_angle_deg": Axis("Shear angle, shear box", "°"),
    "draw_down_shear_angle_deg": Axis("Shear angle, draw-down", "°"),
    "repose_angle_deg": Axis("Angle of repose", "°"),
    "discharge_time_s": Axis("Discharge time", "s"),
    "wall_friction_angle_deg": Axis("Wall friction angle", "°"),
}
MEASURED = {"y": "measured", "spread": "measured_deviation", "band": True, "published": True}
PAIRS = one_panel(
    Axis("Pair"),
    Axis("Response"),
    Layer(POINTS, "simulated", "pair", spread="simulated_uncertainty", name="simulated here, mean of seeds"),
    Layer(POINTS, "predicted", "pair", spread="predicted_deviation", name="surrogate"),
    Layer(LEVELS, **MEASURED, name="measured, ± one standard deviation"),
    split="response",
    axes=RESPONSES,
    names={name: axis.title for name, axis in RESPONSES.items()},
    colours={"surrogate": "OTHER_COLOUR"},
)
ANGLE = Axis("Shear angle", "°")
OF_BOXES = {"spread": "deviation", "group": ("varied",), "curve": ("row",)}
BEFORE = {"table": "before", "spread": "deviation_deg", "name": "Yan 2022, Table 3.3", "published": True}
BOX_SIZES = Chart(
    (
        Panel(
            Axis("Length and height of the box", "mm"),
            ANGLE,
            (
                Layer(POINTS, "mean", "length_mm", **OF_BOXES),
                Layer(LINES, "shear_angle_deg", "length_mm", **BEFORE),
            ),
        ),
        Panel(Axis("Width of the box", "mm"), ANGLE, (Layer(POINTS, "mean", "width_mm", **OF_BOXES),)),
    )
)
PROGRESS = Chart(
    (
        Panel(
            Axis("Simulations of a test"),
            Axis("Surrogate's share of the variance", "-"),
            (Layer(LINES, "surrogate_share", "simulations", group=("test",)),),
        ),
        Panel(
            Axis("Expected information", "bit"),
            Axis("Response"),
            (Layer(BARS, "response", "information_bits", name="information"),),
        ),
    )
)
