"""The program: `hertzscope`, or `python -m hertzscope`."""

import signal
import sys

from . import _hertzscope


def main() -> None:
    """Runs the program on the command line's arguments."""
    # Ctrl-C ends the program as it ends others, where it does not listen for it itself.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_hertzscope.main(["hertzscope", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
