"""What the kinds of check accept, one file each."""
