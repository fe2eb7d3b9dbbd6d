"""MuJoCo in a child process: compiled models, their arrays and their comparison; meshes and pictures."""
