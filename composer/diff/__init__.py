"""What is different between two models, in a roboticist's words, and the line that is the reason."""
