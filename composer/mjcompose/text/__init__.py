"""Located YAML (every key and value has its place), its canonical layout, and `${…}`."""
