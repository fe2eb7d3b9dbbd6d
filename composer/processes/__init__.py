"""Child processes that end with this process, however it ends."""
