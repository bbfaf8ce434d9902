"""Draw docs/pipeline.svg, the picture of the pipeline: python docs/site/pipeline.py

Boxes stand in rows of equal boxes; each has what it is, the folder that does it, and what it holds.
"""

from pathlib import Path

FILE = Path(__file__).parents[1] / "pipeline.svg"
WIDTH, MARGIN, GAP = 1180, 16, 34  # px
LINE = 18  # px, from one line of text to the next
TITLE = "A design row becomes a surface, a deck and a chain of wear cycles, then tables, figures and a page"
LOOP = "one job per run, which resumes after its last finished cycle"
BACK = "next cycle: the worn surface and the solver's restart file"
BEFORE = (
    ("Study and design row", "config/", "YAML and CSV, with units"),
    ("Settings in SI", "workflows/config/", "defaults, checks, one run per row"),
    ("Surface", "meshes/", "pattern, or CAD and mesh files"),
    ("Deck", "templates/, workflows/cases/", "LIGGGHTS input, runs by hand"),
)
CYCLE = (
    ("Simulation", "solver/, workflows/engine/", "LIGGGHTS with the load ledger"),
    ("Load ledger", "postproc/wear/ledger.py", "work, impulse, impacts per triangle"),
    ("Worn volume", "postproc/wear/laws.py", "Archard, or a law of your own"),
    ("Worn surface", "postproc/wear/", "displacement, caps, remeshing"),
)
AFTER = (
    ("Tables", "postproc/tables/, flow/", "one row per run, per cycle"),
    ("Statistics", "postproc/statistics/", "intervals, regression, verdicts"),
    ("Figures", "plots/ of each case", "each with its CSV"),
    ("Page", "workflows/report/", "report.html, Snakemake's report"),
)
TOP, CYCLE_TOP, AFTER_TOP = 20, 158, 336  # px, of the rows
ROWS = ((BEFORE, TOP, "#dcebf7"), (CYCLE, CYCLE_TOP, "#fde9d9"), (AFTER, AFTER_TOP, "#e3f1e3"))
HEIGHT, BOX = 430, 78  # px
STYLE = (
    ".b{stroke:#46535f;rx:5}.t{font-weight:bold;font-size:15px}.f{fill:#4d5761;font-size:12px}"
    ".w{font-size:13px}.a{stroke:#46535f;stroke-width:1.7;fill:none;marker-end:url(#h)}"
)
HEAD = (
    f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" fill="#1d2329"'
    f' font-family="DejaVu Sans, Verdana, sans-serif">\n<title>{TITLE}</title>\n<style>{STYLE}</style>\n'
    '<defs><marker id="h" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" markerHeight="7" orient="auto">'
    '<path d="M0 0L10 5L0 10z" fill="#46535f"/></marker></defs>\n'
    f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>\n'
)


def place(column: int, boxes: int) -> tuple[float, float]:
    """Return left end and width of a box of a row (px)."""
    width = (WIDTH - 2 * MARGIN - (boxes - 1) * GAP) / boxes
    return MARGIN + column * (width + GAP), width


def row(boxes: tuple[tuple[str, str, str], ...], top: float, colour: str) -> list[str]:
    """Return the elements of a row of boxes and of the arrows between them."""
    parts = []
    for column, words in enumerate(boxes):
        left, width = place(column, len(boxes))
        parts.append(f'<rect class="b" x="{left:g}" y="{top}" width="{width:g}" height="{BOX}" fill="{colour}"/>')
        for number, (kind, text) in enumerate(zip("tfw", words, strict=True)):
            parts.append(
                f'<text class="{kind}" x="{left + 10:g}" y="{top + 24 + number * LINE + number}">{text}</text>'
            )
        if column:
            parts.append(f'<path class="a" d="M{left - GAP:g} {top + BOX / 2:g}H{left - 2:g}"/>')
    return parts


def picture() -> str:
    """Return the picture as SVG."""
    left, width = place(0, len(CYCLE))
    last = place(len(CYCLE) - 1, len(CYCLE))[0] + width / 2
    bottom = CYCLE_TOP + BOX
    frame = f'<rect x="4" y="{CYCLE_TOP - 34}" width="{WIDTH - 8}" height="{BOX + 90}" rx="7" fill="none"'
    parts = [
        f'{frame} stroke="#8a96a1" stroke-dasharray="6 5"/>',
        f'<text class="f" x="{left + width / 2 + 40:g}" y="{CYCLE_TOP - 14}">{LOOP}</text>',
        *(element for boxes, top, colour in ROWS for element in row(boxes, top, colour)),
        f'<path class="a" d="M{last + 40:g} {bottom}V{bottom + 32}H{left + width / 2:g}V{bottom + 2}"/>',
        f'<text class="f" x="{WIDTH / 2:g}" y="{bottom + 25}" text-anchor="middle">{BACK}</text>',
    ]
    # from the last box of a row to the first one of the next
    for top, turn, below in ((TOP, CYCLE_TOP - 44, CYCLE_TOP), (CYCLE_TOP, AFTER_TOP - 30, AFTER_TOP)):
        parts.append(f'<path class="a" d="M{last + 70:g} {top + BOX}V{turn}H{left + 24:g}V{below - 2}"/>')
    return HEAD + "\n".join(parts) + "\n</svg>\n"


if __name__ == "__main__":
    FILE.write_text(picture(), encoding="utf-8")
