"""`python -m protogen` is the command line."""

from protogen.cli import main

if __name__ == "__main__":
    main()
