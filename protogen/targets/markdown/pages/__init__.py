"""Pages and their sections."""
