"""Generated C, compiled by the system's compiler on first use, that fills columns."""
