"""What a model is written as for the programs that read it: `build --target NAME`."""
