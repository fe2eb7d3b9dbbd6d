"""Pictures of compiled models, by MuJoCo's own renderer. Runs in the engine's child process."""
