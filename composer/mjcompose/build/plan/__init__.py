"""What a build will do, in order."""
