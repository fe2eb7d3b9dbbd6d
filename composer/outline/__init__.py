"""A model at a glance: its parts, bodies and joints, and the places for attaching parts."""
