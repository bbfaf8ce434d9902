"""In which order test files run: those that take longest first, so that no process waits for one of them at the end."""

LONGEST_FIRST = (  # measured on two cores: minutes each, most of it waiting where a cluster is asked
    "test_slurm.py",
    "workflows/test_project.py",
    "test_extend.py",
    "equipment/test_tutorial.py",
    "engine/test_cycles.py",
    "workflows/test_snakemake.py",
    "test_chains.py",
    "config/test_design.py",
    "engine/test_contact_model.py",
    "engine/test_decks.py",
)


def pytest_collection_modifyitems(items):
    """Sort files by their place in the list, all others after them as they come."""

    def place(item):
        path = item.path.as_posix()
        return next((k for k, name in enumerate(LONGEST_FIRST) if path.endswith(name)), len(LONGEST_FIRST))

    items.sort(key=place)
