"""Tables and diagrams of frames."""
