"""Which studies a call of Snakemake asks for: only those are loaded and checked."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from bulkwear.workflows.config.design import CONFIRMATION, RULE_NAMES, TARGETS, ConfigError, list_studies
from bulkwear.workflows.config.study_files import own_studies
from bulkwear.workflows.config.validation import unknown_name
from bulkwear.workflows.engine.project import Project, current_project

COMMAND_LINE = "command line"  # as faults of what it gives begin
DEMO = "demo"  # of the package
RERUN_TRIGGERS = ("mtime", "params", "input")  # as in profiles/default: what Snakemake makes a job again for
BELOW_RESULTS = re.compile(r"(?:.*/)?results/([^/]+)/")
# of a run alone, not of its bed or a cycle
FILE_OF_RUN = re.compile(
    r"(?:.*/)?results/(?P<study>[^/]+)/(?P<run>[^/]+)/(?:surface\.vtu|wear\.csv|worn_surface\.vtu)"
)


@dataclass(frozen=True)
class Naming:
    """What a Snakefile that takes the workflow as a module puts round names of rules: `use rule * ... as a_*_b`.

    is_module: whether it is one; then names that are none of ours are that Snakefile's own
    """

    before: str = ""
    after: str = ""
    is_module: bool = False

    def ours(self, name: str) -> str | None:
        """Return the name of a rule as this workflow has it; None for one that is not named so."""
        if not (name.startswith(self.before) and name.endswith(self.after)):
            return None
        return name[len(self.before) : len(name) - len(self.after)]


def naming(modify: Callable[[str], str], is_module: bool) -> Naming:
    """Return how a function changes names: what it puts before and after them."""
    before, _, after = modify("\0").partition("\0")
    return Naming(before, after, is_module)


def triggers_sentence(found: Iterable[str]) -> str | None:
    """Return what triggers of Snakemake mean that are not those of the package's profiles, a sentence; else None."""
    found = sorted(found)
    if set(found) == set(RERUN_TRIGGERS):
        return None
    if lacking := [name for name in RERUN_TRIGGERS if name not in found]:
        means = f"without {' and '.join(lacking)} results may stay that no longer answer what is asked"
    else:
        means = "newer code fills beds and simulates runs again, also where it changes no number"
    return (
        f"rerun-triggers of Snakemake are {', '.join(found)}: {means}; the package's profiles/default has"
        f" {', '.join(RERUN_TRIGGERS)}."
    )


def placed(sentence: str, names: Naming, given: Sequence[str], files: Sequence[Path] = ()) -> str:
    """Return the sentence for a fault of the settings over all studies with the place where they stand: the command
    line, the files of --configfile, or the config of a module.

    given: what the command line has for --config, KEY=VALUE
    """
    begin = f"{COMMAND_LINE}: "
    key = re.match(r"\w*", sentence.removeprefix(begin))[0]
    if not sentence.startswith(begin) or key in (word.partition("=")[0] for word in given):
        return sentence
    if files:
        return f"{', '.join(map(str, files))}{sentence.removeprefix(COMMAND_LINE)}"
    return sentence if given or not names.is_module else f"config of the module{sentence.removeprefix(COMMAND_LINE)}"


def unheard_sentence(given: Sequence[str], heard: Collection[str], known: Collection[str]) -> str | None:
    """Return a sentence for settings of ours on the command line that do not reach the module, which has a config of
    its own; None where all do.

    given: what the command line has for --config, KEY=VALUE; heard: keys of the module's config; known: of settings
    """
    keys = [word.partition("=")[0] for word in given]
    lost = [key for key in keys if key in known and key not in heard]
    if not lost:
        return None
    return (
        f"{COMMAND_LINE}: {', '.join(lost)} of --config does not reach the studies: settings are those of the module's"
        " `config:`, as --config 'bulkwear={KEY: VALUE}' where that takes a block `bulkwear`."
    )


def default_studies(project: Project) -> list[str]:
    """Return the studies that are made where no target is asked for: the package's demo, or all of a project's own."""
    own = own_studies(project)
    return [DEMO] if project.is_package and DEMO in own else own


def requested_studies(
    targets: Iterable[str],
    jobs: Iterable[tuple[str, Mapping[str, str]]] = (),
    project: Project | None = None,
    names: Naming = Naming(),
) -> list[str]:
    """Return the names of the studies that targets and jobs need, of best designs after those that they are found in.

    jobs: rule and wildcards of those that Snakemake starts by themselves, as on a cluster. Without targets and jobs
    those that are made by default count; so they do where another Snakefile, which takes the workflow as a module, is
    asked for something of its own. Raises ConfigError for a target that is no
    study's, no rule and no file.
    """
    project = project or current_project()
    written = list_studies(project)
    asked = [
        *(_studies_of(word, written, names) for word in targets),
        *(_studies_of_job(rule, wildcards, written, names) for rule, wildcards in jobs),
    ]
    default = default_studies(project)
    wanted = [name for studies in asked for name in (default if studies is None else studies)]
    return list(dict.fromkeys(wanted if asked else default))


def nearly_studies(targets: Iterable[str], project: Project | None = None, names: Naming = Naming()) -> list[str]:
    """Return a sentence per target that is no study of ours but spelt nearly as one. Where another Snakefile takes the
    workflow as a module it may be a rule of that Snakefile, so it is no fault yet.
    """
    written = list_studies(project or current_project())
    sentences = []
    for word in targets if names.is_module else ():
        name = names.ours(word)
        if _studies_of(word, written, names) is not None or not name or "/" in word or "." in word:
            continue
        if near := difflib.get_close_matches(name, written, n=1):
            sentences.append(f"{word} is no study, the nearest is {near[0]}; it is taken for a rule of this Snakefile.")
    return sentences


def unknown_run(targets: Iterable[str], runs: Mapping[str, Collection[str]]) -> str | None:
    """Return a sentence for the first target that is a file of a run which its study does not have.

    runs: {study: names of its runs}, of those that are made
    """
    for word in targets:
        found = FILE_OF_RUN.fullmatch(word)
        if found and found["run"] not in runs.get(found["study"], (found["run"],)):
            return unknown_name(f"target {word}", "its run", found["run"], sorted(runs[found["study"]]))
    return None


def _studies_of_job(rule: str, wildcards: Mapping[str, str], written: list[str], names: Naming) -> list[str] | None:
    """Return the studies that a job needs as `_studies_of` does; its rule may be one that a case has of its own."""
    name = wildcards.get("study", "")
    if name.removesuffix(CONFIRMATION) in written or name in written:
        return _studies_of(f"results/{name}/", written, names)
    try:
        return _studies_of(rule, written, names)
    except ConfigError:
        return []


def _studies_of(word: str, written: list[str], names: Naming) -> list[str] | None:
    """Return the studies that a target needs, none for a rule or a file of no study; None for what is not ours."""
    below = BELOW_RESULTS.match(word)
    name = below[1] if below else names.ours(word)
    if not below and name in RULE_NAMES and name in written:
        return [name]  # which is refused, as no study can be called so
    if not below and (name in RULE_NAMES or "/" in word or "." in word):
        return None if names.is_module and name not in RULE_NAMES else []
    for ending in () if below or name is None else TARGETS:
        name = name.removesuffix(ending)
    base = name if name in written or name is None else name.removesuffix(CONFIRMATION)
    if base in written:
        return list(dict.fromkeys([base, name]))
    if names.is_module:
        return None
    *first, last = (*TARGETS, CONFIRMATION)
    sentence = unknown_name(COMMAND_LINE, "target", word, written).removesuffix(".")
    raise ConfigError(f"{sentence}, alone or with the ending {', '.join(first)} or {last}.")
