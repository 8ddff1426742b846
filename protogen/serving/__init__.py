"""What is on a line, served to programs that show it."""
