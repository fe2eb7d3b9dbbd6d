"""A model at a glance: its parts, bodies and joints, and the places that a part may be attached to."""
