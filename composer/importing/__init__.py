"""Recover the recipe that makes a merged model from its parts: `mjcompose import`."""
