"""The differences between two compiled models, as data and in words."""
