"""One folder or file for each tool on top of a build."""
