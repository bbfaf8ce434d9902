"""One process for all figures and tables that a start of Snakemake makes: it imports once what they need.

Importing takes longer than most figures. The process imports when the first figure is asked for, and forks for each, so
that each is a job of its own as before: it has its log, fails alone, and can be asked for by its file. The script of a
job hands its work over by a socket, together with its standard output and error. Where that process is not, as on
another machine, the script does the work itself.
"""

from __future__ import annotations

import atexit
import contextlib
import importlib
import os
import pickle
import pkgutil
import select
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import bulkwear

VARIABLE = "BULKWEAR_FIGURES"  # in the environment of jobs: path of the socket
STREAMS = (1, 2)  # standard output and error
INTERRUPTED = 130  # exit code of a program that Ctrl-C ended
PRELOADED = ("bulkwear.postproc.plots", "bulkwear.postproc.tables", "bulkwear.workflows.report", "matplotlib.backends")
BACKENDS = {"backend_agg", "backend_svg", "backend_pdf"}  # of figures; others need what a machine may not have
LIBRARIES = ("meshio", "pyvista")  # which modules import where they need them: most studies have such figures


def start() -> subprocess.Popen | None:
    """Start the process, which ends with its standard input, so with this one; name its socket in the environment.

    Return None where the folder of temporary files takes no socket: jobs then do their work themselves.
    """
    os.environ.pop(VARIABLE, None)
    folder = tempfile.mkdtemp(prefix="bulkwear_figures_")  # this user's alone: what comes by the socket is run
    path = f"{folder}/socket"
    with socket.socket(socket.AF_UNIX) as waiting:
        try:
            waiting.bind(path)
        except OSError:  # a path of more than a hundred letters
            shutil.rmtree(folder, ignore_errors=True)
            return None
        waiting.listen(os.cpu_count() or 1)
        number = waiting.fileno()
        command = [sys.executable, "-P", "-m", __name__, str(number), folder]  # -P: no module of the working folder
        beside = [str(Path(bulkwear.__file__).parents[1]), *filter(None, [os.environ.get("PYTHONPATH")])]
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(beside)}
        process = subprocess.Popen(command, stdin=subprocess.PIPE, pass_fds=[number], env=environment)
    os.environ[VARIABLE] = path
    atexit.register(process.communicate)  # closes its standard input and waits for its end
    return process


def hand_over(log: str, product: Mapping[str, Any]) -> None:
    """Have a product made by that process, or make it here where there is none; end with the exit code of the work.

    log: path of the job's log; product: what `products.make_product` takes, plain values
    """
    asked = _connected()
    sys.exit(_make(log, product) if asked is None else _asked_for(asked, log, product))


def _connected() -> socket.socket | None:
    asked = socket.socket(socket.AF_UNIX)
    try:
        asked.connect(os.environ[VARIABLE])
    except (KeyError, OSError):
        return None
    return asked


def _asked_for(asked: socket.socket, log: str, product: Mapping[str, Any]) -> int:
    try:
        socket.send_fds(asked, [b"."], STREAMS)
        asked.sendall(pickle.dumps((os.getcwd(), log, product)))
        asked.shutdown(socket.SHUT_WR)
        answer = asked.recv(1)
    except ConnectionError:
        answer = b""
    except KeyboardInterrupt:  # the process that was forked has it too, and writes it into the log
        return INTERRUPTED
    if answer:
        return answer[0]
    print(f"\n{product['name']}: its process was ended by the machine, or by somebody.\n", file=sys.stderr)
    return 1


def serve(waiting: socket.socket) -> None:
    """Fork for whoever asks, until standard input ends: with Snakemake, however that ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # of Ctrl-C the jobs speak
    for ending in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(ending, lambda *_: sys.exit(1))
    while sys.stdin not in select.select([waiting, sys.stdin], [], [])[0]:
        asked, _ = waiting.accept()
        with contextlib.suppress(Exception):  # what fails here fails in the job that needs it, which tells
            _preload()
        if os.fork() == 0:
            try:
                _answer(asked)
            finally:
                os._exit(1)
        asked.close()
    with contextlib.suppress(ChildProcessError):
        while True:
            os.wait()


def _preload() -> None:
    """Import what figures import, and read the code with which each compares that of its runs; the first time."""
    for name in PRELOADED:
        package = importlib.import_module(name)
        for module in pkgutil.iter_modules(package.__path__):
            if name != "matplotlib.backends" or module.name in BACKENDS:
                importlib.import_module(f"{name}.{module.name}")
    for name in LIBRARIES:
        importlib.import_module(name)
    from bulkwear.workflows.engine.code_parts import part_hashes

    part_hashes(())  # keeps what it has read


def _answer(asked: socket.socket) -> None:
    """Do what is asked with the streams of who asks, send the exit code, and end."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    for ending in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(ending, signal.SIG_DFL)
    _, streams, _, _ = socket.recv_fds(asked, 1, len(STREAMS))
    for own, given in zip(STREAMS, streams, strict=True):
        os.dup2(given, own)
    with asked.makefile("rb") as message:
        folder, log, product = pickle.load(message)
    os.chdir(folder)
    code = _make(log, product)
    sys.stdout.flush()
    sys.stderr.flush()
    asked.sendall(bytes([code]))


def _make(log: str, product: Mapping[str, Any]) -> int:
    """Make a product with its log; return the exit code."""
    from bulkwear.workflows.engine.job import project_job  # slow to import, and a script that hands over needs neither
    from bulkwear.workflows.report.products import make_product

    try:
        with project_job(log):
            make_product(**product)
    except SystemExit as end:
        return int(end.code or 0)
    except BaseException:
        traceback.print_exc()
        return 1
    return 0


if __name__ == "__main__":
    try:
        with socket.socket(fileno=int(sys.argv[1])) as given:
            serve(given)
    finally:
        shutil.rmtree(Path(sys.argv[2]), ignore_errors=True)
