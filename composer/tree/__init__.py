"""MJCF as bare lxml trees: units, and what must be known of them."""
