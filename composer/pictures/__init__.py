"""Pictures of compiled models, with MuJoCo's own renderer. Runs in the engine's child process."""
