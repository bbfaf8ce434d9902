"""Read by Python at its start in every job, see `job.let_jobs_import`: Ctrl-C while a job imports ends it silently.

What follows from Ctrl-C is said once for all jobs, by `terminal`.
"""

import sys


def _silent_about_ctrl_c(kind, fault, trace):
    if not issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, fault, trace)


sys.excepthook = _silent_about_ctrl_c
