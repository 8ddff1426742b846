"""What generated C costs on a machine: flash, RAM and stack, as its compiler makes them."""
