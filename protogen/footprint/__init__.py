"""Cost of generated C on a machine: flash, RAM and stack, as its compiler makes them."""
