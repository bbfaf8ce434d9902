"""A circular wear tester small enough for tests: 700 particles, a sample of 40 mm, two cycles, some seconds."""

from workflows.config.design import Study, load_study

TINY = {
    "particle_scale": 4,
    "sample": {"width_mm": 40, "length_mm": 40, "thickness_mm": 5, "element_size_mm": 2},
    "tester": {
        "inner_radius_mm": 100,
        "outer_radius_mm": 196,
        "channel_deg": 56,
        "bed_height_mm": 72,
        "depth_mm": 35,
        "consolidator_level_mm": 72,
        "consolidator_rise_mm": 10,
        "consolidator_ramp_mm": 20,
        "consolidator_flat_mm": 10,
    },
    "sliding": {
        "angular_speed_deg_per_s": 235,
        "revolution_deg": 30,
        "steady_revolutions": 1.0,
        "run_in_revolutions": 0.2,
        "revolutions": 2,
        "cycles_per_revolution": 2,
    },
    "solver": {"pictures_per_revolution": 8, "looks_per_revolution": 8},
}
ROWS = ("plain", "convex")


def tiny_tester(**changes) -> Study:
    """Return the quick study, shrunk; `changes` are further settings, merged by section."""
    settings = {key: dict(value) if isinstance(value, dict) else value for key, value in TINY.items()}
    for key, value in changes.items():
        settings[key] = {**settings.get(key, {}), **value} if isinstance(value, dict) else value
    return load_study("circular_tester", overrides={"fidelity": "quick", "rows": list(ROWS), **settings})
