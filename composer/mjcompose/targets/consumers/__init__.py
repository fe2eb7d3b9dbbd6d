"""The programs that read models, one file each."""
