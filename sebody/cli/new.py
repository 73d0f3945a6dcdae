"""``sebody new``: a file with a scene to begin from."""

import argparse
from pathlib import Path
from shlex import quote

from sebody.basics.errors import InputError

NAME = "FILE.py"        # in the text of the scene that is copied


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser("new", help="write a file with a commented scene to begin from")
    parser.add_argument("file", type=Path, metavar="FILE.py", help="file to write")
    return parser


def run(options: argparse.Namespace) -> int:
    """Write the file and say what can be done with it; an older file is left alone."""
    from sebody import scenes
    from sebody.basics.files import check_target, replacing

    path = check_target(options.file, "scene", (".py",))
    if path.exists():
        raise InputError(f"scene {path} exists: give another name, or remove the file first")
    starter = Path(scenes.__file__).with_name("starter.py")
    text = starter.read_text(encoding="utf-8").replace(NAME, path.name)
    with replacing(path, "scene") as file:
        file.write(text.encode())
    print(f"scene: {path}")
    print(f"run it: sebody run {quote(str(path))} --output run.npz --plot run.png; "
          "more in its first lines")
    return 0
