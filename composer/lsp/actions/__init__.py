"""Code actions: changes that an editor offers. Each kind has one file and one row in `table`."""
