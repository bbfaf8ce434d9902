"""Figures and tables of a study: each is one declaration, and one rule and one script make them all.

A declaration is a decorated function of a module `figures` of a case (`Case.figure_modules`), or of those modules here
(`SHARED`) whose figures and tables any case may show (`Case.shared_figures`). It says what files the function reads,
what of the study's configuration it is told, and the caption; the function returns the figure and the table beside it.
Modules that are slow to import are imported inside the function: Snakemake reads all declarations before the first job.

    @figure("Wear", "Wear against travel", inputs={"wear": every_run("wear.csv")}, caption="Volumes over travel.")
    def wear_against_travel(job):
        from bulkwear.postproc.plots import curves
        ...
        return curves.wear_against_travel(history, job.remarks), history
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import TYPE_CHECKING, Any

from bulkwear.workflows.engine.case import Case
from bulkwear.workflows.engine.cases import case_module, find_case
from bulkwear.workflows.engine.own_code import code_that_shows
from bulkwear.workflows.engine.project import CONFIG, PACKAGE, current_project
from bulkwear.workflows.engine.provenance import simulating_code
from bulkwear.workflows.engine.state import digest
from bulkwear.workflows.report.simulated import figure_remark, versions_of
from bulkwear.workflows.report.spot_checks import as_new_as, passed, read_checks

if TYPE_CHECKING:
    import pandas as pd

    from bulkwear.postproc.plots.chart import Chart
    from bulkwear.workflows.config.design import Study

# any case may show what is there
SHARED = tuple(f"bulkwear.workflows.report.{name}" for name in ("beds", "surfaces", "laws"))
DOCS = PACKAGE / "docs"  # of the repository, with its spot checks
VECTORS = ("svg", "pdf")
OfStudy = Callable[["Study"], Any]
Source = str | OfStudy  # a path, in which {study} stands for its name, or what gives one path or several


@dataclass(frozen=True)
class Product:
    """A figure, or a job of tables alone, of the studies of a case.

    name: of the function, and of the figure's files
    make: takes a `Job`; a figure's returns (figure, its table) or (figure, its table, {key: further table}), a job of
        tables returns {key: table}, where a text stands for a file that is none. A figure is one of matplotlib, or a
        function that writes the file of a given path
    inputs: {name in `Job.files`: where it comes from}
    told: {name in `Job.told`: what of the study the function needs to know}; a change of it makes the product again
    tables: {key: path below results/<study>} of what is written besides the figure and the table of its name
    when: whether a study has it
    title, category, caption: of a figure; the caption's paragraphs are apart by an empty line
    suffix: png of a figure of matplotlib, which is written as VECTORS too; gif of a film, html of an interactive page
    still: whether the function that writes a film or a page writes a PNG as well, which stands for it in print
    finding: takes the figure's table, which has a row or more, and returns in one sentence what the figure shows, "" if
        its rows do not tell it; the title then stands for it, as with None
    charts: what of its table is interactive on the page, the first of them whose columns the table has; keys of their
        layers' tables are those of `tables` and of `inputs` that are one path
    digits: significant ones of its tables, or of the tables by key; None: all
    """

    name: str
    make: Callable[[Job], Any]
    inputs: Mapping[str, Source]
    told: Mapping[str, OfStudy] = field(default_factory=dict)
    tables: Mapping[str, str] = field(default_factory=dict)
    when: Callable[[Study], bool] = lambda study: True
    title: str = ""
    category: str = ""
    caption: str = ""
    suffix: str = "png"
    still: bool = False
    finding: Callable[[pd.DataFrame], str] | None = None
    charts: tuple[Chart, ...] = ()
    digits: int | Mapping[str, int] | None = None

    @property
    def is_figure(self) -> bool:
        """Return whether it is a figure."""
        return bool(self.title)

    @property
    def rule(self) -> str:
        """Return the name of its rule."""
        return f"{'figure' if self.is_figure else 'tables'}_{self.name}"

    @property
    def file(self) -> str:
        """Return the file name of a figure."""
        return f"{self.name}.{self.suffix}"

    @property
    def vectors(self) -> dict[str, str]:
        """Return {kind: file name} of the forms of a figure that print at any size; none of a film or a page."""
        return {kind: f"{self.name}.{kind}" for kind in VECTORS} if self.is_figure and self.suffix == "png" else {}

    @property
    def stills(self) -> dict[str, str]:
        """Return {"still": file name} of a film or a page that has one."""
        return {"still": f"{self.name}.png"} if self.still else {}

    @property
    def paragraphs(self) -> list[str]:
        """Return the caption's paragraphs."""
        return [" ".join(block.split()) for block in self.caption.strip().split("\n\n")]


@dataclass(frozen=True)
class Job:
    """What the function of a product works on.

    files: paths by the names of `Product.inputs`, lists where there are several
    told: values by the names of `Product.told`
    remarks: what every figure of the study must say
    """

    files: SimpleNamespace
    told: SimpleNamespace
    remarks: list[str]


def figure(category: str, title: str, **declaration: Any) -> Callable[[Callable[[Job], Any]], Callable[[Job], Any]]:
    """Declare a figure, see `Product`; a decorator."""
    return _declare(category=category, title=title, **declaration)


def tables(**declaration: Any) -> Callable[[Callable[[Job], Any]], Callable[[Job], Any]]:
    """Declare a job of tables, see `Product`; a decorator."""
    return _declare(**declaration)


def _declare(**declaration: Any) -> Callable[[Callable[[Job], Any]], Callable[[Job], Any]]:
    def declare(make: Callable[[Job], Any]) -> Callable[[Job], Any]:
        make.product = Product(name=make.__name__, make=make, **declaration)
        return make

    return declare


def every_run(file: str) -> OfStudy:
    """Return a source: a file of the folder of every run of a study."""
    return lambda study: [f"results/{study.name}/{run.name}/{file}" for run in study.runs]


def paths_of(source: Source, study: Study) -> str | list[str]:
    """Return the path, or the paths, of a source for a study; the package's file where its project has none."""
    paths = source.format(study=study.name) if isinstance(source, str) else source(study)
    return looked_up(paths) if isinstance(paths, str) else [looked_up(path) for path in paths]


def looked_up(path: str) -> str:
    """Return the path of a file of the configuration in the project, or the package's where that has none."""
    return current_project().path(path) if path.startswith(f"{CONFIG}/") else path


def products_of(case: Case) -> dict[str, Product]:
    """Return every figure and job of tables of a case by name, in the order in which pages show them."""
    modules = [case_module(case, name) for name in case.figure_modules]
    found = {name: product for module in modules for name, product in _declared(module).items()}
    shared = {name: product for each in SHARED for name, product in _declared(importlib.import_module(each)).items()}
    return found | {name: shared[name] for name in case.shared_figures}


def _declared(module: ModuleType) -> dict[str, Product]:
    return {each.product.name: each.product for each in vars(module).values() if hasattr(each, "product")}


def products_of_study(study: Study) -> dict[str, Product]:
    """Return those of a case that a study has."""
    return {name: product for name, product in products_of(study.case).items() if product.when(study)}


def rules_of(studies: Iterable[Study]) -> dict[str, tuple[list[str], Product]]:
    """Return {rule: (names of the studies that can have it, product)}. Raises ValueError for a name declared twice."""
    found: dict[str, tuple[list[str], Product]] = {}
    for study in studies:
        for product in products_of(study.case).values():
            names, known = found.setdefault(product.rule, ([], product))
            if known.make is not product.make:
                modules = " and ".join(each.make.__module__ for each in (known, product))
                raise ValueError(f"{product.name} is declared in {modules}, allowed is each name once.")
            names.append(study.name)
    return found


def figures_of(study: Study) -> list[Product]:
    """Return a study's figures in the order of its page."""
    return [product for product in products_of_study(study).values() if product.is_figure]


def product_files(study: Study) -> list[str]:
    """Return the paths of all figures and tables of a study."""
    return [path for product in products_of_study(study).values() for path in outputs_of(product, study.name).values()]


def outputs_of(product: Product, study: str = "{study}") -> dict[str, str]:
    """Return {key: path} of all that a product's job writes: `figure`, VECTORS, `still` and `table` of a figure, and
    further tables.
    """
    results = f"results/{study}"
    names = {"figure": product.file, **product.vectors, **product.stills, "table": f"{product.name}.csv"}
    drawn = {key: f"{results}/figures/{name}" for key, name in names.items() if product.is_figure}
    return drawn | {key: f"{results}/{path}" for key, path in product.tables.items()}


def told_to(product: Product, study: Study) -> dict[str, Any]:
    """Return what of a study's configuration a product's job is told."""
    return {name: ask(study) for name, ask in product.told.items()}


def code_of(study: Study, *modules: str) -> str:
    """Return the hash of what tables, figures or a page of a study depend on beside its results and its configuration.

    That is the code of the modules that make them, and what they compare the versions with that simulated: the present
    code, and spot checks of the study.
    """
    checks = [asdict(check) for check in read_checks(DOCS) if check.study == study.name]
    return digest(code_that_shows(*modules), {"now": simulating_code(study.case)["parts"], "checks": checks})


def write_product(product: Product, job: Job, outputs: Mapping[str, str]) -> None:
    """Make a product and write its files; outputs: {key: path}, see `outputs_of`."""
    made = product.make(job)
    if product.is_figure:
        drawn, table, *further = made
        for kind in ("figure", *product.vectors, *product.stills):
            _write_figure(drawn, outputs[kind])
        made = {"table": table} | (further[0] if further else {})
    for key, table in made.items():
        if isinstance(table, str):
            Path(outputs[key]).write_text(table, encoding="utf-8")
        else:
            table.to_csv(outputs[key], index=False, float_format=_float_format(product, key))


def _float_format(product: Product, key: str) -> str | None:
    digits = product.digits.get(key) if isinstance(product.digits, Mapping) else product.digits
    return None if digits is None else f"%.{digits}g"


def _write_figure(drawn: Any, path: str) -> None:
    from bulkwear.postproc.plots.style import save  # slow to import, and Snakemake reads this module first

    if callable(drawn):
        drawn(path)
    else:
        save(drawn, path)


def job_of(files: Mapping[str, Any], told: Mapping[str, Any], remarks: Sequence[str]) -> Job:
    """Return a job from what a rule has."""
    return Job(SimpleNamespace(**files), SimpleNamespace(**told), list(filter(None, remarks)))


def make_product(
    study: str,
    case: str,
    name: str,
    files: Mapping[str, Any],
    told: Mapping[str, Any],
    remarks: Sequence[str],
    runs: Sequence[str],
    outputs: Mapping[str, str],
) -> None:
    """Make a product of a study, both by name, as its rule asks; outputs: as in `write_product`, all else as in `Job`.

    runs: names of those of the study, whose versions are remarked on
    """
    of_case = find_case(case)
    simulated = simulated_remark(of_case, Path("results", study), runs)
    write_product(products_of(of_case)[name], job_of(files, told, [*remarks, simulated]), outputs)


def simulated_remark(case: Case, folder: Path, runs: Sequence[str]) -> str:
    """Return what each figure of a study says of the versions that simulated its runs so far, "" where there are none.

    folder: results/<study>
    """
    try:
        found = versions_of(case.simulation_folders(folder, runs))
    except FileNotFoundError:  # a case that lists its simulations has none yet
        found = []
    checks = read_checks(DOCS)
    checked = [as_new_as(version, passed(version, folder.name, checks)) for version in found]
    return figure_remark(found, simulating_code(case), checked)
