# Front door. `make` alone lists the targets. Everything runs in .venv, which `make setup` builds from requirements.txt.

SHELL := /bin/bash
.DEFAULT_GOAL := help
CORES ?= $(shell nproc)
STUDY ?= demo
# The environment's programs come first, so that rules which call `python` get its interpreter.
export PATH := $(CURDIR)/.venv/bin:$(PATH)
# Without compiled modules every start of Python would compile those of the whole environment anew: half of its time.
unexport PYTHONDONTWRITEBYTECODE
# Snakemake keeps a cache; a user whose home cannot be written gets one in the temporary folder.
CACHE_WORKS := $(shell cache="$${XDG_CACHE_HOME:-$$HOME/.cache}"; mkdir -p "$$cache" 2>/dev/null && test -w "$$cache" && echo yes)
ifeq ($(CACHE_WORKS),)
export XDG_CACHE_HOME := $(shell mktemp -d)
endif
# Pictures come from the software renderer everywhere: the same on every machine, and without X.
export VTK_DEFAULT_OPENGL_WINDOW ?= vtkOSOpenGLRenderWindow

ifneq ($(shell [[ "$(CORES)" =~ ^[1-9][0-9]*$$ ]] && echo yes),yes)
$(error CORES is $(CORES), allowed is a whole number above 0)
endif

PROFILE := workflows/profiles/default
SNAKEMAKE := .venv/bin/snakemake --workflow-profile $(PROFILE) --cores $(CORES)
# one file's tests stay on one process (some folders': tests/conftest.py), so that what they share is made once
PYTEST := .venv/bin/pytest --numprocesses $(CORES) --maxprocesses 8 --dist loadfile --no-loadscope-reorder
SMK_FILES = Snakefile $(shell find workflows -name "*.smk")
# doctor must also work where set-up failed
DOCTOR_PYTHON = $(or $(wildcard .venv/bin/python),python3)

.PHONY: named help setup doctor demo study forecast project rates test verify chaos screening report decks results docs lint format lock clean

help: ## List the targets
	@echo "make <target> [CORES=$(CORES)] [STUDY=$(STUDY)]"
	@sed -n 's/^\([a-z]*\):[^#]*## \(.*\)/\1|\2/p' Makefile | while IFS='|' read -r name text; do printf '  %-10s %s\n' "$$name" "$$text"; done

setup: ## Install what is missing: Debian packages, the ledger's solver, .venv from the lock (nothing to do: under a second)
	@workflows/environment/setup.sh

doctor: ## Check this machine: solver, MPI, rendering, packages, disk; says what to do
	@$(DOCTOR_PYTHON) workflows/environment/doctor.py

demo: setup ## Run the demonstration study, from mesh to report
	$(SNAKEMAKE) demo

# A study is a file of that name: no word, or another one, ends here and not as targets of Snakemake or words of a shell.
study forecast decks report: named
named:
	@: $(or $(wildcard config/studies/$(STUDY:_confirmation=).yaml),$(error STUDY is '$(STUDY)', allowed is the name of a file in config/studies))

study: setup ## Run a whole study: make study STUDY=<name of a file in config/studies>
	$(SNAKEMAKE) $(STUDY)

forecast: setup ## What a study will cost: core hours, wall time, memory, disk of each run (STUDY=demo)
	$(SNAKEMAKE) $(STUDY)_forecast

project: setup ## Make a project of your own, a folder outside this clone: make project DIR=<folder>
	@.venv/bin/python -m bulkwear project "$(or $(DIR),$(error make project DIR=<folder>: DIR is missing, allowed is a new folder))"

rates: setup ## Measure what the solver's work costs on this machine, for forecasts; a minute or two, best with nothing beside it
	$(SNAKEMAKE) cost_rates --force

screening: setup ## Run the screening study
	$(SNAKEMAKE) screening

decks: setup ## Render every deck of a study without running the solver (STUDY=demo)
	$(SNAKEMAKE) $(STUDY)_decks

report: setup ## Build results/<STUDY>/report.html, the same as report.pdf, and Snakemake's own snakemake_report.html
	$(SNAKEMAKE) results/$(STUDY)/report.html
	$(SNAKEMAKE) $(STUDY) --report results/$(STUDY)/snakemake_report.html
	$(SNAKEMAKE) results/$(STUDY)/report.pdf

results: setup ## Remake every page of results in docs from its runs, or say which are stale and what redoing costs (RUN=1: do it, CHECK=1: redo a row, PAGE=one)
	@status=0; \
	$(if $(CHECK),.venv/bin/python -m benchmarks.spot_check $(if $(PAGE),--page $(PAGE)) || status=1;) \
	.venv/bin/python -m bulkwear.workflows.results.remake --cores $(CORES) $(if $(RUN),--run) $(if $(PAGE),--page $(PAGE)) && exit $$status

docs: setup ## Build the documentation as a site, docs/site/build/index.html
	.venv/bin/sphinx-build -q -W --keep-going -b html -c docs/site -d docs/site/build/.doctrees . docs/site/build

test: setup ## Run the tests and every check a submission must pass
	$(PYTEST)
	@$(MAKE) --no-print-directory lint

verify: setup ## Run the long physics tests (pytest -m verify)
	$(PYTEST) -m verify

chaos: setup ## What runs, files and configurations survive: kills, full disks, flipped bits, hostile files; hours (SEED=27)
	.venv/bin/python -m benchmarks.chaos --seed $(or $(SEED),27)

lint: setup ## Check style: ruff, snakemake --lint, snakefmt
	.venv/bin/ruff check .
	.venv/bin/ruff format --check .
	.venv/bin/python workflows/environment/snakemake_lint.py
	.venv/bin/snakefmt --check $(SMK_FILES)

format: setup ## Rewrite Python and Snakemake files in the house format
	.venv/bin/ruff check --fix .
	.venv/bin/ruff format .
	.venv/bin/snakefmt $(SMK_FILES)

lock: setup ## Resolve the dependencies of pyproject.toml again into requirements.txt (exact versions and hashes)
	.venv/bin/uv pip compile --quiet pyproject.toml --all-extras --output-file requirements.txt --upgrade --python-version 3.11 \
	    --generate-hashes --no-header --no-annotate --no-emit-index-url
	awk '/^[^ ]/ {keep = /^uv==/} keep' requirements.txt >requirements-bootstrap.txt

clean: ## Remove caches (never results)
	rm -rf .pytest_cache .ruff_cache .hypothesis .numba_cache docs/site/build
	find . -name __pycache__ -not -path './.venv/*' -prune -exec rm -rf {} +
