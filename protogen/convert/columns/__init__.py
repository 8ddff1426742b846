"""Tables of captures: which columns there are, and their values."""
