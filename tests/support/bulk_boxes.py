"""Bulk tests of a calibration's study, as its driver asks for them."""

from bulkwear.workflows.cases.calibration.boxes import test_of as bulk_test_of
from bulkwear.workflows.config.design import load_study

SLIDING, ROLLING = "particle.contact.sliding_friction", "particle.contact.rolling_friction"
NOT_ROLLING = [  # what may be looked for without a model of rolling friction
    {"name": SLIDING, "low": 0.1, "high": 0.7},
    {"name": "particle.contact.restitution", "low": 0.2, "high": 0.8},
]
PAIR = {SLIDING: 0.3, ROLLING: 0.3}
SEED = 20_000


def asked(kind="shear_box", **settings):
    """A bulk test of the study as configured, at particle scale 5 or with other settings."""
    study = load_study("calibration", overrides={"fidelity": "quick", **settings})
    return bulk_test_of(study.runs[0].parameters, kind, PAIR, SEED)


def small():
    """A shear box of a few hundred particles that needs seconds: the particles fill a tenth of its length."""
    test = asked(particle_scale=5.0)
    box = {"length_m": 0.135, "width_m": 0.054, "fill_height_m": 0.135}
    return {**test, "box": {**test["box"], **box}}
