"""The gmsh session is closed again, whatever happens in it."""

import gmsh
import pytest

from meshes.gmsh_session import gmsh_session


def test_session_is_closed_after_an_error():
    """An error inside the session reaches the caller, and gmsh is finalised."""
    with pytest.raises(RuntimeError, match="inside"), gmsh_session() as session:
        assert session.isInitialized()
        raise RuntimeError("inside")
    assert not gmsh.isInitialized()


def test_sessions_do_not_see_each_other():
    """Options and models of one session are gone in the next."""
    with gmsh_session() as session:
        default = session.option.getNumber("Mesh.MeshSizeMax")
        session.option.setNumber("Mesh.MeshSizeMax", 0.125)
        session.model.geo.addPoint(0, 0, 0)
        session.model.geo.synchronize()
    with gmsh_session() as session:
        assert session.option.getNumber("Mesh.MeshSizeMax") == default != 0.125
        assert session.model.getEntities() == []
