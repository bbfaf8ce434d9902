"""Runs of benchmarks: those of a study, changed as no configuration allows, and simulated from where they stopped."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from postproc.mesh import write_surface
from workflows.cases.sliding_sample.parameters import derived_parameters
from workflows.config.design import Run
from workflows.config.layers import merge
from workflows.config.patterns import sample_surface
from workflows.engine.chain import Chain
from workflows.engine.cycles import fill_bed, run_chain


def changed(run: Run, change: Mapping[str, Any]) -> Run:
    """Return the run with other parameters and what follows from them.

    change: nested, SI, as the parameters; a section that the run does not have, such as a plain sample's pattern, is
    left out
    """
    given: dict[str, Any] = {key: value for key, value in run.parameters.items() if key != "derived"}
    given = merge(given, {key: value for key, value in change.items() if given[key] is not None})
    return replace(run, parameters={**given, "derived": derived_parameters(given)})


def with_bed(chain: Chain, bed_name: str) -> Chain:
    """Return the chain, its bed filled unless it is there."""
    if not chain.bed_restart.with_name("cost.csv").exists():
        fill_bed(chain.case, bed_name, chain.bed, chain.bed_restart.parent)
    return chain


def simulated_run(chain: Chain, bed_name: str) -> Chain:
    """Return the chain, simulated from where it stopped; sample and bed made unless they are there."""
    with_bed(chain, bed_name)
    if not chain.surface.exists():
        write_surface(chain.surface, sample_surface(chain.parameters["sample"], chain.parameters["pattern"]))
    if not (chain.folder / "wear.csv").exists():
        run_chain(chain)
    return chain
