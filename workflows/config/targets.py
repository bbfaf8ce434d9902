"""Which studies a call of Snakemake asks for: only those are loaded and checked."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from bulkwear.workflows.config.design import CONFIRMATION, REPOSITORY, RULE_NAMES, TARGETS, ConfigError, list_studies
from bulkwear.workflows.config.validation import unknown_name

DEFAULT_TARGET = "demo"
BELOW_RESULTS = re.compile(r"(?:.*/)?results/([^/]+)/")


def requested_studies(
    targets: Iterable[str], jobs: Iterable[tuple[str, Mapping[str, str]]] = (), root: Path = REPOSITORY
) -> list[str]:
    """Return the names of the studies that targets and jobs need, of best designs after those that they are found in.

    jobs: rule and wildcards of those that Snakemake starts by themselves, as on a cluster. Without targets and jobs
    the default target counts, all studies where there is none. Raises ConfigError for a target that is no study's, no
    rule and no file.
    """
    written = list_studies(root)
    words = [*targets, *(_word_of(rule, wildcards) for rule, wildcards in jobs)]
    if not words:
        return [DEFAULT_TARGET] if DEFAULT_TARGET in written else written
    names = (name for word in words for name in _studies_of(word, written))
    return list(dict.fromkeys(names))


def _word_of(rule: str, wildcards: Mapping[str, str]) -> str:
    """Return what stands for a job as a target does; a rule without the wildcard is that of a target or of no study."""
    return f"results/{wildcards['study']}/" if "study" in wildcards else rule


def _studies_of(word: str, written: list[str]) -> list[str]:
    """Return the studies that a target needs, none for a rule or a file of no study."""
    below = BELOW_RESULTS.match(word)
    if not below and (word in RULE_NAMES or "/" in word or "." in word):
        return []
    name = below[1] if below else word
    for ending in () if below else TARGETS:
        name = name.removesuffix(ending)
    base = name if name in written else name.removesuffix(CONFIRMATION)
    if base not in written:
        *first, last = (*TARGETS, CONFIRMATION)
        sentence = unknown_name("command line", "target", word, written).removesuffix(".")
        raise ConfigError(f"{sentence}, alone or with the ending {', '.join(first)} or {last}.")
    return list(dict.fromkeys([base, name]))
