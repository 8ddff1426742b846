"""What generated C costs, beside C by hand and peers: programs, measurements and the page."""
