"""From one version of MuJoCo to another."""
