"""What a cycle's record says of places that are worn through."""

from bulkwear.meshes.plate import flat_plate
from bulkwear.postproc.wear.thickness import with_thickness
from bulkwear.workflows.engine.accounting import worn_through_words

NEW = with_thickness(flat_plate(0.02, 0.02, 0.005), 0.01)  # m, with all of its thickness left


def test_a_hole_counts_though_remeshing_merged_its_node():
    """The update wore a node through, remeshing took it away: the run still has to end there."""
    assert worn_through_words(1, NEW).startswith("worn through at 1 nodes")
