"""What jobs are told of tables, figures and pages, and what they ask for: processors, memory, time and programs."""

from functools import cache

from bulkwear.workflows.engine.solver import LAUNCHER
from bulkwear.workflows.forecast.rates import rates_file
from bulkwear.workflows.report.products import code_of, looked_up, paths_of, told_to


def input_of(source):
    """An input of a rule: a path, or an input function."""
    return looked_up(source) if isinstance(source, str) else lambda wildcards: paths_of(source, study_so_far(wildcards))


def in_report(product, paths):
    """The outputs of a product, marked for Snakemake's own report; the captions lie beside the rule."""
    if not product.is_figure:
        return {key: table_in_report(path) for key, path in paths.items()}
    titles = {"figure": product.title}
    if product.suffix == "gif":  # that report shows no film, it saves one
        titles["still"] = f"{product.title}: its last picture"
    flagged = {
        key: report(paths[key], caption="caption.rst", category=product.category, labels={"figure": title})
        for key, title in titles.items()
        if key in paths
    }
    return {**paths, **flagged}


def table_in_report(path, captions=""):
    """A path, marked for Snakemake's own report where it is that of a table beside the page: others may be large."""
    folder, _, name = path.rpartition("/")
    if folder != "results/{study}" or not name.endswith(".csv"):
        return path
    shown = name.removesuffix(".csv").replace("_", " ")
    return report(path, caption=f"{captions}table.rst", category="Tables", labels={"table": shown})


def told_of(product):
    """A param: what a product is told of a study."""
    return lambda wildcards: told_to(product, study_so_far(wildcards))


def code_of_pages(*modules):
    """A param: the hash of what tables, figures or a page that modules make depend on beside results and configuration.

    Without modules, of what the case makes.
    """
    return lambda wildcards: code_by_name(wildcards.study, modules or (type(study_of(wildcards).case).__module__,))


@cache  # many figures are of one module
def code_by_name(study, modules):
    return code_of(STUDIES[study], *modules)


def used_rates(wildcards=None):
    """The rates that were measured on this machine, or the default ones."""
    return str(rates_file())


def solver_work(study):
    """A function of wildcards: the jobs of a study that call the solver, with their sizes."""

    def work(wildcards):
        from bulkwear.workflows.forecast.forecast import work_of  # slow to import, and most jobs ask for no forecast

        return work_of(STUDIES[study].foreseen)

    return work


def ranks_of(wildcards):
    return study_of(wildcards).settings["solver"]["ranks"]


def submitted(wildcards):
    """A resource: 1 where a cluster's job runs this Snakemake, 0 where it was called, though in an allocation."""
    return int(workflow.remote_exec)


def launcher_of(wildcards):
    """The program that starts the ranks of a solver; none for one rank."""
    return LAUNCHER if ranks_of(wildcards) > 1 else None


@cache
def demands_of(study):
    from bulkwear.workflows.forecast.forecast import demands  # slow to import, and few jobs ask for it

    return demands(STUDIES[study])


def asked(rule, measure):
    """A resource function: a demand of jobs of a rule, more at every attempt; measure 0 is min, 1 is MB, 2 is core min."""

    def amount(wildcards, attempt):
        words = dict(wildcards.items())
        return attempt * demands_of(words.pop("study"))["_".join([rule, *words.values()])][measure]

    return amount
