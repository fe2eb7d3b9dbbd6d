"""What MuJoCo's compiled model, `mjModel`, is. Nothing here imports MuJoCo; a model is an argument.

- What there is: `kinds` (kinds of element, names, the body each stands on), `joints` (types, sizes, units), `enums`.
- Where the numbers of an element are: `rows` (one row an element), `addresses` (all else), `ragged` (that data itself).
- What they refer to: `links`, as kinds and ids. Which element of the XML became which: `order`.
- From MJCF and back: `attributes` (an attribute's array), `affected_arrays` (all that follow from it), `quantities`
  (an array's words, unit, and attributes), `servos` (gains), `units` (of controls and sensors), `index`.
- Two models: `correspondence` (by name and likeness, with `signature` and `mount`), `fields` (how each array is
  compared), `unchanged` (a part alone and composed: `presence`, `references`, `values`, `placing`, `keyframes`,
  `coupling`, `gains`), `options` (settings), `identity` (bit for bit), `difference` (one result).
"""
