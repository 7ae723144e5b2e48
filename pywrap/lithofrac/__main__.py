"""`python -m lithofrac` is the command line."""

import sys

from lithofrac.cli import main

sys.exit(main())
