"""Turn a merged model into a recipe of its parts."""
