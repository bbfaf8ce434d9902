"""Contents page: a study's name makes its report, <study>_decks renders its decks without running the solver.

    snakemake                       the demo
    snakemake screening --config fidelity=standard
    snakemake demo_decks

Snakemake finds the choices for one machine by itself: profiles/default, which links into workflows/.
"""


include: "workflows/common.smk"
include: "workflows/mesh.smk"
include: "workflows/solve.smk"
include: "workflows/analyse.smk"
include: "workflows/report.smk"
include: "workflows/screening.smk"
include: "workflows/pin_on_disc.smk"
include: "workflows/calibration.smk"


for STUDY in STUDIES:

    rule:
        name:
            STUDY
        default_target: STUDY == "demo"
        input:
            f"results/{STUDY}/report.html",
            f"results/{STUDY}/summary.csv",
        message:
            "Report of the study"

    rule:
        name:
            f"{STUDY}_decks"
        input:
            study_decks(STUDY),
        message:
            "Decks of the study, rendered without running the solver"
