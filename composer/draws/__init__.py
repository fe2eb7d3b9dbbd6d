"""Random numbers that are the same bits everywhere: streams by hash, distributions by exact arithmetic. No I/O."""
