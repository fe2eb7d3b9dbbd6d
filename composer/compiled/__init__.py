"""What MuJoCo's compiled model is: its arrays, what they refer to, and how two of them correspond."""
