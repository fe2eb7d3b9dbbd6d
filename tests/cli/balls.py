"""A recipe of several cells and samples, of which some have faults."""

MODEL = '<mujoco><worldbody><body name="b"><freejoint/><geom name="g" size="0.1"/></body></worldbody></mujoco>'
# A size of -1 is no model, one of 2 has a check that does not hold.
RECIPE = """\
recipe: 1
name: ball
base: ./model.xml
params: {size: 1}
edit: [{select: {geom: g}, set: {size: ["${size}"]}}]
matrix: {axes: {size: [1, 2, -1]}}
randomize:
  seed: 7
  samples: 2
  fields: {friction: {select: {geom: g}, attr: friction, uniform: [0.5, 1]}}
check: {light: {expect: {attr: mass, range: [0, 5000]}}}
"""
