"""gmsh is closed again, whatever happens in its model."""

import gmsh
import pytest

from bulkwear.meshes.gmsh_model import gmsh_model


def test_gmsh_is_closed_after_an_error():
    """An error inside the model reaches the caller, and gmsh is finalised."""
    with pytest.raises(RuntimeError, match="inside"), gmsh_model() as model:
        assert model.isInitialized()
        raise RuntimeError("inside")
    assert not gmsh.isInitialized()


def test_models_do_not_see_each_other():
    """Options and geometry of one model are gone in the next."""
    with gmsh_model() as model:
        default = model.option.getNumber("Mesh.MeshSizeMax")
        model.option.setNumber("Mesh.MeshSizeMax", 0.125)
        model.model.geo.addPoint(0, 0, 0)
        model.model.geo.synchronize()
    with gmsh_model() as model:
        assert model.option.getNumber("Mesh.MeshSizeMax") == default != 0.125
        assert model.model.getEntities() == []
