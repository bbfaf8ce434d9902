"""The page of a study that runs, results/<study>/live.html: what `status` tells, and pictures of the last cycles.

It is written again every PERIOD seconds and loads itself anew as often; report.html stands at its end.
"""

from __future__ import annotations

import io
import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from bulkwear.postproc.readers.cycle_folders import FINISHED, cycle_folders
from bulkwear.workflows.engine.chain import SURFACE
from bulkwear.workflows.forecast.status import HEADS, PAGE, Status, faults_of, heading, last_line, rows_of, watch
from bulkwear.workflows.report.page import environment
from bulkwear.workflows.report.text import data_uri

LIVE = "live.html"
PERIOD = 30.0  # s; a look costs some hundredths of a second, a picture a few
MOST_PICTURES = 4  # runs, those whose cycles ended last


def write_until_over(study: str, cores: int | None = None) -> str:
    """Write the live page until a study has run, or Ctrl-C is pressed; return its last line. Raises StatusError."""
    pictures = LastPictures()
    told = False

    def show(status: Status, goes_on: bool) -> None:
        nonlocal told
        write_live_page(status, pictures.of(status), goes_on)
        if not told:
            print(f"{status.folder / LIVE} is written every {PERIOD:g} s, Ctrl-C ends it", file=sys.stderr, flush=True)
        told = True

    try:
        return watch(study, cores, show, lambda: time.sleep(PERIOD))
    except KeyboardInterrupt:
        return f"{study}: its live page is written no more, the study goes on"


def write_live_page(status: Status, picture: str, goes_on: bool) -> None:
    """Write results/<study>/live.html.

    picture: address of an image, "" for none; goes_on: whether another page follows, for which this one loads itself
    """
    page = status.folder / PAGE
    text = (
        environment()
        .get_template("live.html.j2")
        .render(
            study={"title": status.study},
            heading=heading(status),
            heads=HEADS,
            rows=rows_of(status),
            faults=faults_of(status),
            last=last_line(status),
            page=page.name if page.is_file() and status.is_over else "",
            picture=picture,
            milliseconds=round(1000.0 * PERIOD) if goes_on else 0,
        )
    )
    part = status.folder / f"{LIVE}.part"
    part.write_text(text, encoding="utf-8")
    os.replace(part, status.folder / LIVE)


class LastPictures:
    """One picture of the surfaces that the last cycles left, drawn anew when there are others."""

    def __init__(self) -> None:
        self.shown: Sequence[Path] = ()
        self.picture = ""

    def of(self, status: Status) -> str:
        """Return the picture's address, "" before the first wear cycle, and where a surface was just moved."""
        found = last_surfaces(status)
        if found != self.shown:
            try:
                self.picture, self.shown = (drawn(found) if found else ""), found
            except OSError:  # a run whose settings changed has moved its cycles; the next look finds others
                self.picture, self.shown = "", ()
        return self.picture


def last_surfaces(status: Status) -> list[Path]:
    """Return the surfaces that the last wear cycles of runs left, of the last MOST_PICTURES runs, in their order."""
    runs = [status.folder / job.name for job in status.jobs if job.cycles]
    last = [folders[-1] / SURFACE for run in runs if (folders := cycle_folders(run))]
    there = [path for path in last if path.is_file()]
    newest = sorted(there, key=lambda path: path.stat().st_mtime)[-MOST_PICTURES:]
    return [path for path in there if path in newest]


def drawn(surfaces: Sequence[Path]) -> str:
    """Return the address of a picture of surfaces side by side, on one scale of depth."""
    from bulkwear.postproc.mesh import read_surface  # slow to import, and a status alone draws nothing
    from bulkwear.postproc.plots.pictures import surface_views
    from bulkwear.postproc.tables.depths import depth_quantity, depth_table
    from bulkwear.postproc.tables.film import without_skirt
    from bulkwear.postproc.wear.fields import REMOVED_THICKNESS

    names = [f"{path.parts[-3]}, cycle {int(FINISHED.fullmatch(path.parts[-2])[1])}" for path in surfaces]
    meshes = {name: without_skirt(read_surface(path)) for name, path in zip(names, surfaces, strict=True)}
    deformed = all(REMOVED_THICKNESS in mesh.point_data for mesh in meshes.values())
    figure = surface_views(meshes, deformed, depth_table(meshes, deformed), depth_quantity(deformed), [])
    stream = io.BytesIO()
    figure.savefig(stream, format="png")
    return data_uri(stream.getvalue(), "image/png")
