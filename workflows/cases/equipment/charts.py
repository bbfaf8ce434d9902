"""Interactive figures of equipment."""

from __future__ import annotations

from bulkwear.postproc.plots.chart import BARS, LEVELS, LINES, Axis, Chart, Layer, Panel, one_panel

OPERATION, TIME = Axis("Operation", "h"), Axis("Simulated time", "s")

DEPTHS = {"y": "depth_mm", "x": "operation_h", "group": ("setting",)}
RECESSION = one_panel(
    OPERATION,
    Axis("Depth of the deciding patch", "mm"),
    Layer(LINES, **DEPTHS, only={"packing": 0, "simulated": True}),
    Layer(LINES, **DEPTHS, only={"packing": 0, "simulated": False}, name="extrapolated", dashed=True),
    Layer(LINES, **DEPTHS, but={"packing": 0}, curve=("packing",), name="packings", thin=True),
    Layer(LEVELS, "allowed_mm", group=("setting",), table="life", name="change-out", dashed=True),
    split="part",
)
LIFE = one_panel(
    Axis("Life", "h of operation"),
    Axis("Part"),
    Layer(BARS, "part", "life_h", "life_low_h", "life_high_h", group=("setting",)),
)
OVER_TIME = {"x": "time_s", "curve": ("setting", "packing")}
FLOW = Chart(
    (
        Panel(
            TIME,
            Axis("Mass flow", "t/h"),
            (
                Layer(LINES, "in_t_per_h", **OVER_TIME, name="in", but={"in_t_per_h": 0.0}),
                Layer(LINES, "out_t_per_h", **OVER_TIME, name="out", but={"out_t_per_h": 0.0}),
            ),
        ),
        Panel(TIME, Axis("Mass held", "kg"), (Layer(LINES, "held_kg", **OVER_TIME, name="held"),)),
        Panel(TIME, Axis("Power", "kW"), (Layer(LINES, "power_*_kW", **OVER_TIME, name="power of"),)),
    ),
    sift="setting",
    colours={"in": "OTHER_COLOUR", "out": "BLUE"},
)
MEASURES = {"height_mm": Axis("Height", "mm"), "leading_face_angle_deg": Axis("Leading face", "°")}
LIFTERS = Chart(
    tuple(
        Panel(OPERATION, axis, (Layer(LINES, name, "operation_h", f"{name}_low", f"{name}_high", group=("setting",)),))
        for name, axis in MEASURES.items()
    ),
    split="part",
)
