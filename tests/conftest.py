"""In which order test files run: those that compile, then those that take longest, so that no process waits for one of
them at the end."""

COMPILE = (  # nearly all that numba compiles, each another part; what comes after them need not do it as well
    "wear/test_remesh.py",
    "readers/test_contacts.py",
    "wear/test_update.py",
)
LONGEST_FIRST = (  # measured on two cores: half a minute to minutes each, most of it waiting where a cluster is asked
    "test_slurm.py",
    "workflows/test_project.py",
    "workflows/test_snakemake.py",
    "engine/test_cycles.py",
    "equipment/test_tutorial.py",
    "test_solver_ledger_ranks.py",
    "test_extend.py",
    "test_equipment_motion.py",
    "engine/test_contact_model.py",
    "test_chains.py",
)
FIRST = (*COMPILE, *LONGEST_FIRST)


def pytest_collection_modifyitems(items):
    """Sort files by their place in the lists, all others after them as they come."""

    def place(item):
        path = item.path.as_posix()
        return next((k for k, name in enumerate(FIRST) if path.endswith(name)), len(FIRST))

    items.sort(key=place)
