"""Whether finished containers still answer what is asked, where Snakemake has no record that tells it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from bulkwear.workflows.cases.sliding_sample.particle_size.packings import container
from bulkwear.workflows.cases.sliding_sample.particle_size.study import by_scale
from bulkwear.workflows.engine.bulk_simulations import simulation_folder
from bulkwear.workflows.engine.case import Parameters


def other_containers(runs: Mapping[str, Parameters], packing: Mapping[str, Any], profiles: Path) -> str | None:
    """Return in a phrase why a table of profiles is not of these containers; None where it is.

    packing: the study's settings of it, SI; their simulations lie beside the table
    """
    scales = by_scale(runs)
    if set(pd.read_csv(profiles, usecols=["particle_scale"])["particle_scale"]) != set(scales):
        return "its particle scales are others"
    folders = (simulation_folder(container(run, packing), profiles.parent) for run in scales.values())
    return None if all(map(Path.is_dir, folders)) else "its containers are others"
