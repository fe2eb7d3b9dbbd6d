"""Join units into one flat tree, in which every unit keeps the meaning that it has alone."""
