"""How the kinds of check are carried out, one file each."""
