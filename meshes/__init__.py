"""The ground: a layered section, and the quadrilateral meshes made from it."""
