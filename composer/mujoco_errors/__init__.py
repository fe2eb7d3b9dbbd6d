"""Translate MuJoCo's error messages to diagnostics.

`message` splits a message into text, line, and element; `translation` rewrites it for the author of the element and
adds advice; `location` finds where the faulty value is written; `report` sends the result to the sink.
"""
