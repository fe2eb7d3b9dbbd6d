"""MuJoCo's compiled model, `mjModel`. Nothing here imports MuJoCo; a model is an argument.

- Contents: `kinds` (kinds of element, names, the body of each), `joints` (types, sizes, units), `enums`.
- Addresses of an element's numbers: `rows` (one row for each element), `addresses` (all others), `ragged` (that data).
- References: `links`, as kinds and ids. The compiled element for each XML element: `order`.
- From MJCF and back: `attributes` (an attribute's array), `affected_arrays` (all that follow from it), `quantities`
  (an array's words, unit, and attributes), `servos` (gains), `units` (of controls and sensors), `index`.
- Two models: `correspondence` (by name and similarity, with `signature` and `mount`), `fields` (how each array is
  compared), `unchanged` (a part alone and composed: `presence`, `references`, `values`, `placing`, `keyframes`,
  `coupling`, `gains`), `options` (settings), `identity` (bit for bit), `difference` (one result).
"""
