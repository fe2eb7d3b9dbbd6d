"""Work on meshes, in the child process: hulls, fitted shapes, pieces, simpler meshes, and how far these are off."""
