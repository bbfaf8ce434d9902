"""Pin on disc: contours and volumes of every run, and the figures of the study (Yan 2022, chapter 5)."""

from workflows.cases.pin_on_disc.page import update_remark
from workflows.report.remarks import figure_remarks

PUBLISHED = str(ROOT / "config" / "published" / "pin_on_disc.csv")
PUBLISHED_FITS = str(ROOT / "config" / "published" / "pin_on_disc_volume.csv")
PUBLISHED_NORMALITY = str(ROOT / "config" / "published" / "pin_on_disc_normality.csv")
CONTOURS = of_every_run("results/{study}/{run}/contours.csv")
VOLUMES = of_every_run("results/{study}/{run}/volumes.csv")
WORN_DISCS = of_every_run("results/{study}/{run}/worn_surface.vtu")
DISTRIBUTION_REVOLUTION = 10  # Yan 2022, Fig 5.10 and 5.11


rule track_tables:
    input:
        design="results/{study}/design.csv",
        wear="results/{study}/{run}/wear.csv",
    output:
        contours="results/{study}/{run}/contours.csv",
        volumes="results/{study}/{run}/volumes.csv",
    log:
        "results/{study}/logs/track_tables_{run}.log",
    benchmark:
        "results/{study}/logs/track_tables_{run}.benchmark.tsv"
    message:
        "Contours and volumes of {wildcards.study}, {wildcards.run}"
    script:
        "../../scripts/track_tables.py"


rule disc_setup:
    input:
        design="results/{study}/design.csv",
        published=PUBLISHED,
        surfaces=of_every_run("results/{study}/{run}/surface.vtu"),
    output:
        figure=report(
            "results/{study}/figures/disc_setup.png",
            caption="../../report/disc_setup.rst",
            category="Set-up",
            labels={"figure": "Pin on its disc"},
        ),
        table="results/{study}/figures/disc_setup.csv",
    log:
        "results/{study}/logs/disc_setup.log",
    benchmark:
        "results/{study}/logs/disc_setup.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the set-up of {wildcards.study}"
    script:
        "../../scripts/disc_setup.py"


rule contour_extraction:
    input:
        design="results/{study}/design.csv",
        published=PUBLISHED,
        worn=WORN_DISCS,
    output:
        figure=report(
            "results/{study}/figures/contour_extraction.png",
            caption="../../report/contour_extraction.rst",
            category="Contours",
            labels={"figure": "How contours are taken"},
        ),
        table="results/{study}/figures/contour_extraction.csv",
    log:
        "results/{study}/logs/contour_extraction.log",
    benchmark:
        "results/{study}/logs/contour_extraction.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the contours' extraction of {wildcards.study}"
    script:
        "../../scripts/contour_extraction.py"


rule mesh_series:
    input:
        design="results/{study}/design.csv",
        published=PUBLISHED,
        statistics="results/{study}/figures/run_in.csv",
    output:
        figure=report(
            "results/{study}/figures/mesh_series.png",
            caption="../../report/mesh_series.rst",
            category="Contours",
            labels={"figure": "Depth and width by mesh"},
        ),
        table="results/{study}/figures/mesh_series.csv",
        stability="results/{study}/figures/mesh_stability.csv",
    log:
        "results/{study}/logs/mesh_series.log",
    benchmark:
        "results/{study}/logs/mesh_series.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the mesh series of {wildcards.study}"
    script:
        "../../scripts/mesh_series.py"


rule mesh_contours:
    input:
        design="results/{study}/design.csv",
        published=PUBLISHED,
        series="results/{study}/figures/mesh_series.csv",
        worn=WORN_DISCS,
    output:
        figure=report(
            "results/{study}/figures/mesh_contours.png",
            caption="../../report/mesh_contours.rst",
            category="Contours",
            labels={"figure": "Contours by mesh"},
        ),
        table="results/{study}/figures/mesh_contours.csv",
    log:
        "results/{study}/logs/mesh_contours.log",
    benchmark:
        "results/{study}/logs/mesh_contours.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the contours by mesh of {wildcards.study}"
    script:
        "../../scripts/mesh_contours.py"


rule normal_force:
    input:
        design="results/{study}/design.csv",
        published=PUBLISHED,
        wear=WEAR_TABLES,
    output:
        figure=report(
            "results/{study}/figures/normal_force.png",
            caption="../../report/normal_force.rst",
            category="Forces",
            labels={"figure": "Force of the pin"},
        ),
        table="results/{study}/figures/normal_force.csv",
    log:
        "results/{study}/logs/normal_force.log",
    benchmark:
        "results/{study}/logs/normal_force.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the force of the pin of {wildcards.study}"
    script:
        "../../scripts/normal_force.py"


rule contour_distribution:
    input:
        design="results/{study}/design.csv",
        published=PUBLISHED,
        contours=CONTOURS,
    output:
        figure=report(
            "results/{study}/figures/contour_distribution.png",
            caption="../../report/contour_distribution.rst",
            category="Contours",
            labels={"figure": "Distribution of depth and width"},
        ),
        table="results/{study}/figures/contour_distribution.csv",
    log:
        "results/{study}/logs/contour_distribution.log",
    benchmark:
        "results/{study}/logs/contour_distribution.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
        revolution=DISTRIBUTION_REVOLUTION,
    message:
        "Figure of the distribution of depth and width of {wildcards.study}"
    script:
        "../../scripts/contour_distribution.py"


rule run_in:
    input:
        design="results/{study}/design.csv",
        published=PUBLISHED,
        normality=PUBLISHED_NORMALITY,
        contours=CONTOURS,
    output:
        figure=report(
            "results/{study}/figures/run_in.png",
            caption="../../report/run_in.rst",
            category="Contours",
            labels={"figure": "Run-in"},
        ),
        table="results/{study}/figures/run_in.csv",
    log:
        "results/{study}/logs/run_in.log",
    benchmark:
        "results/{study}/logs/run_in.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the run-in of {wildcards.study}"
    script:
        "../../scripts/run_in.py"


rule contour_examples:
    input:
        design="results/{study}/design.csv",
        published=PUBLISHED,
        contours=CONTOURS,
    output:
        figure=report(
            "results/{study}/figures/contour_examples.png",
            caption="../../report/contour_examples.rst",
            category="Contours",
            labels={"figure": "Examples of contours"},
        ),
        table="results/{study}/figures/contour_examples.csv",
    log:
        "results/{study}/logs/contour_examples.log",
    benchmark:
        "results/{study}/logs/contour_examples.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the examples of contours of {wildcards.study}"
    script:
        "../../scripts/contour_examples.py"


rule wear_volume:
    input:
        design="results/{study}/design.csv",
        fits=PUBLISHED_FITS,
        volumes=VOLUMES,
    output:
        figure=report(
            "results/{study}/figures/wear_volume.png",
            caption="../../report/wear_volume.rst",
            category="Volume",
            labels={"figure": "Volume against revolutions"},
        ),
        table="results/{study}/figures/wear_volume.csv",
        fits="results/{study}/figures/wear_volume_fits.csv",
    log:
        "results/{study}/logs/wear_volume.log",
    benchmark:
        "results/{study}/logs/wear_volume.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the volume against revolutions of {wildcards.study}"
    script:
        "../../scripts/wear_volume.py"


rule force_rise:
    input:
        fits=PUBLISHED_FITS,
        volumes="results/{study}/figures/wear_volume.csv",
    output:
        figure=report(
            "results/{study}/figures/force_rise.png",
            caption="../../report/force_rise.rst",
            category="Forces",
            labels={"figure": "Rise of the summed normal force"},
        ),
        table="results/{study}/figures/force_rise.csv",
    log:
        "results/{study}/logs/force_rise.log",
    benchmark:
        "results/{study}/logs/force_rise.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the rise of the normal force of {wildcards.study}"
    script:
        "../../scripts/force_rise.py"


rule excess_volume:
    input:
        published=PUBLISHED,
        factors="results/{study}/figures/force_rise.csv",
    output:
        figure=report(
            "results/{study}/figures/excess_volume.png",
            caption="../../report/excess_volume.rst",
            category="Volume",
            labels={"figure": "What exceeds Archard's volume"},
        ),
        table="results/{study}/figures/excess_volume.csv",
    log:
        "results/{study}/logs/excess_volume.log",
    benchmark:
        "results/{study}/logs/excess_volume.benchmark.tsv"
    params:
        remarks=lambda wildcards: [update_remark(study_of(wildcards)), *figure_remarks(study_of(wildcards))],
    message:
        "Figure of the excess volume of {wildcards.study}"
    script:
        "../../scripts/excess_volume.py"


rule coefficient_calibration:
    input:
        design="results/{study}/design.csv",
        published=PUBLISHED,
        fits=PUBLISHED_FITS,
        normality=PUBLISHED_NORMALITY,
        statistics="results/{study}/figures/run_in.csv",
        volumes=VOLUMES,
    output:
        figure=report(
            "results/{study}/figures/calibration.png",
            caption="../../report/calibration.rst",
            category="Laboratory",
            labels={"figure": "Calibration of the wear coefficient"},
        ),
        table="results/{study}/figures/calibration.csv",
        limits="results/{study}/figures/scaling_limits.csv",
    log:
        "results/{study}/logs/calibration.log",
    benchmark:
        "results/{study}/logs/calibration.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the calibration of {wildcards.study}"
    script:
        "../../scripts/calibration.py"


rule size_invariance:
    input:
        design="results/{study}/design.csv",
        published=PUBLISHED,
        volumes=VOLUMES,
    output:
        figure=report(
            "results/{study}/figures/size_invariance.png",
            caption="../../report/size_invariance.rst",
            category="Volume",
            labels={"figure": "Size invariance"},
        ),
        table="results/{study}/figures/size_invariance.csv",
    log:
        "results/{study}/logs/size_invariance.log",
    benchmark:
        "results/{study}/logs/size_invariance.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the size invariance of {wildcards.study}"
    script:
        "../../scripts/size_invariance.py"


rule pin_comparison:
    input:
        design="results/{study}/design.csv",
        published=PUBLISHED,
        contours=CONTOURS,
        volumes=VOLUMES,
    output:
        figure=report(
            "results/{study}/figures/pin_comparison.png",
            caption="../../report/pin_comparison.rst",
            category="Laboratory",
            labels={"figure": "Thesis, laboratory and ours"},
        ),
        table="results/{study}/figures/pin_comparison.csv",
    log:
        "results/{study}/logs/pin_comparison.log",
    benchmark:
        "results/{study}/logs/pin_comparison.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the comparison of {wildcards.study}"
    script:
        "../../scripts/pin_comparison.py"


rule laboratory_contour:
    input:
        design="results/{study}/design.csv",
        published=PUBLISHED,
        cases="results/{study}/figures/pin_comparison.csv",
        worn=WORN_DISCS,
    output:
        figure=report(
            "results/{study}/figures/laboratory_contour.png",
            caption="../../report/laboratory_contour.rst",
            category="Laboratory",
            labels={"figure": "Contours beside the laboratory's"},
        ),
        table="results/{study}/figures/laboratory_contour.csv",
    log:
        "results/{study}/logs/laboratory_contour.log",
    benchmark:
        "results/{study}/logs/laboratory_contour.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the contours beside the laboratory's of {wildcards.study}"
    script:
        "../../scripts/laboratory_contour.py"


rule unrolled_track:
    input:
        design="results/{study}/design.csv",
        published=PUBLISHED,
        worn=WORN_DISCS,
    output:
        figure=report(
            "results/{study}/figures/unrolled_track.png",
            caption="../../report/unrolled_track.rst",
            category="Contours",
            labels={"figure": "Unrolled track"},
        ),
        table="results/{study}/figures/unrolled_track.csv",
    log:
        "results/{study}/logs/unrolled_track.log",
    benchmark:
        "results/{study}/logs/unrolled_track.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the unrolled track of {wildcards.study}"
    script:
        "../../scripts/unrolled_track.py"


rule worn_disc:
    input:
        design="results/{study}/design.csv",
        published=PUBLISHED,
        worn=WORN_DISCS,
    output:
        figure=report(
            "results/{study}/figures/worn_disc.png",
            caption="../../report/worn_disc.rst",
            category="Contours",
            labels={"figure": "Worn disc"},
        ),
    log:
        "results/{study}/logs/worn_disc.log",
    benchmark:
        "results/{study}/logs/worn_disc.benchmark.tsv"
    params:
        remarks=lambda wildcards: figure_remarks(study_of(wildcards)),
    message:
        "Figure of the worn disc of {wildcards.study}"
    script:
        "../../scripts/worn_disc.py"
