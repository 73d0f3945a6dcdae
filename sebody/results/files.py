"""Files that are going to be written."""

from pathlib import Path

from sebody.errors import InputError


def check_target(path: str | Path, what: str, suffixes: tuple[str, ...] = ()) -> Path:
    """The path of a file to write, refused before anything is computed for it.

    Parameters
    ----------
    what : str
        What the file is, for the message.
    suffixes : tuple of str
        Endings it may have; any by default.

    Raises
    ------
    InputError
        Another ending, or a folder that does not exist.
    """
    path = Path(path)
    if suffixes and path.suffix not in suffixes:
        raise InputError(f"{what} {path} must end in {', '.join(suffixes)}")
    if not path.parent.is_dir():
        raise InputError(f"folder {path.parent} of the {what} does not exist: make it")
    return path
