"""``python -m sebody``: the command line."""

import sys

from sebody.cli.entry import main

sys.exit(main())
