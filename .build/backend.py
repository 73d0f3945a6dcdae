"""setuptools' build backend: editable wheels are found from anywhere, sdists hold all they need.

setuptools puts the finder of an editable install behind Python's own, which takes any folder named
``sebody`` in the folder of a script, such as a clone, for a namespace package. Here it comes first.

Packages are all folders with an ``__init__.py`` in those of ``package-dir`` in pyproject.toml. What
an sdist holds besides packages, such as this folder, is in the ``MANIFEST.in`` beside it.
"""

import base64
import hashlib
import tomllib
import zipfile
from pathlib import Path, PurePosixPath

from setuptools import build_meta, setup
from setuptools.command.egg_info import manifest_maker

manifest_maker.template = ".build/MANIFEST.in"

IN_FRONT = ("import sys; sys.meta_path.sort("
            "key=lambda finder: getattr(finder, '__module__', '') != {module!r})\n")


class _Backend(build_meta._BuildMetaBackend):
    """setuptools' hooks, which find packages in several folders, as no setting of its own can."""

    def run_setup(self, setup_script="setup.py"):
        settings = tomllib.loads(Path("pyproject.toml").read_text())["tool"]["setuptools"]
        setup(packages=[".".join([package, *file.parent.relative_to(folder).parts])
                        for package, folder in settings["package-dir"].items()
                        for file in sorted(Path(folder).rglob("__init__.py"))])


_hooks = _Backend()
get_requires_for_build_wheel = _hooks.get_requires_for_build_wheel
get_requires_for_build_sdist = _hooks.get_requires_for_build_sdist
get_requires_for_build_editable = _hooks.get_requires_for_build_editable
prepare_metadata_for_build_wheel = _hooks.prepare_metadata_for_build_wheel
prepare_metadata_for_build_editable = _hooks.prepare_metadata_for_build_editable
build_wheel = _hooks.build_wheel
build_sdist = _hooks.build_sdist


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    """The editable wheel of setuptools, with a line more in its ``.pth`` file (PEP 660)."""
    name = _hooks.build_editable(wheel_directory, config_settings, metadata_directory)
    path = Path(wheel_directory, name)
    with zipfile.ZipFile(path) as wheel:
        files = {entry: wheel.read(entry) for entry in wheel.namelist()}
    finder, = (entry for entry in files if entry.endswith("_finder.py"))
    start, = (entry for entry in files if entry.endswith(".pth"))
    record, = (entry for entry in files if entry.endswith(".dist-info/RECORD"))
    module = PurePosixPath(finder).stem
    files[start] = files[start].rstrip() + b"\n" + IN_FRONT.format(module=module).encode()
    files[record] = "".join(_recorded(entry, content) for entry, content in files.items()
                            if entry != record).encode() + f"{record},,\n".encode()
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as wheel:
        for entry, content in files.items():
            wheel.writestr(entry, content)
    return name


def _recorded(entry: str, content: bytes) -> str:
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    return f"{entry},sha256={digest},{len(content)}\n"
