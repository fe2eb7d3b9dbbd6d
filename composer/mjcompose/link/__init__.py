"""Units become one flat tree in which each still means what it meant alone."""
