"""What targets cannot express. Each restriction has one file, which the rows of all targets with it use."""
