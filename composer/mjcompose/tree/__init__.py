"""MJCF as a tree: the grammar, units, names, classes, selection and edits."""
