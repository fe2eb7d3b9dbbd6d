"""YAML in which every key and value knows its place, its canonical layout, and `${…}`."""
