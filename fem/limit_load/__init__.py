"""The limit load of a mesh without a path, by second-order cone programming."""
