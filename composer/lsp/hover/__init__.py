"""What is shown of what stands under the cursor: one file a kind, one row in `table`."""
