"""``python -m octomarch``: the same as the command ``octomarch``."""

import sys

from octomarch.cli import main

if __name__ == "__main__":
    sys.exit(main())
