"""MuJoCo in a child process: compiled models, their arrays and how two of them are compared, meshes, pictures."""
