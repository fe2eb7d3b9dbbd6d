"""MuJoCo's error messages, turned into diagnostics.

`message` splits one message into text, line, and element; `translation` rewrites it for the author of the element
and adds advice; `location` finds where the value at fault is written; `report` sends the result to the sink.
"""
