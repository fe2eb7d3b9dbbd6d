"""From a merged model and the parts that it was made of to the recipe that makes it: `mjcompose import`."""
