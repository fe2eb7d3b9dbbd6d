"""The way from a reference to files: kinds of reference, fetching, the store, the lock, licenses."""
