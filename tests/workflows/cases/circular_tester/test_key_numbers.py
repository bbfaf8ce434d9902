"""Sentences of the tester's page that no figure tells."""

import pandas as pd

from bulkwear.workflows.cases.circular_tester.key_numbers import deeper_than_sample


def test_wear_deeper_than_the_sample_is_told():
    """From which revolution of the test on, whose revolutions are more than the run's; nothing while it is less."""
    left = pd.DataFrame({"run": "worn-out", "revolution": [100.0, 200.0, 300.0]})
    history = pd.DataFrame({"revolution": [10.0, 20.0, 30.0], "largest_depth_m": [0.004, 0.012, 0.016]})
    assert deeper_than_sample(left, history, 10.0) == (
        "From revolution 200 on worn-out is somewhere worn deeper than sample and holder are thick, 10 mm; at its end "
        "by 16 mm. What it loses there and then is that of a thicker one."
    )
    assert deeper_than_sample(left, history, 16.0) is None
