"""From a merged model to a recipe of its parts."""
