"""Build the documentation: ``python .docs [FOLDER]``, by default into ``build/docs``.

Pages stay beside what they describe; here they are collected, a page is made of every scene and of
every module with public names, and Sphinx makes them one site. Warnings are errors. Needs
``pip install -e ".[docs]"``.
"""

import argparse
import shutil
import sys
import time
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parent


def main() -> int:
    """Collect, make and build; the exit code is that of Sphinx."""
    parser = argparse.ArgumentParser(prog="python .docs", description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="?", type=Path, default=ROOT / "build" / "docs")
    parser.add_argument("--without-gallery", action="store_true",
                        help="run no scene: for work on other pages")
    options = parser.parse_args()

    import collect
    import gallery
    import reference
    from sphinx.cmd.build import main as sphinx

    began = time.perf_counter()
    site = options.folder
    pages, extra = (site.with_name(site.name + end) for end in ("-pages", "-extra"))
    for folder in (site, pages, extra):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
    made = [reference.write(pages)]
    if not options.without_gallery:
        made.insert(0, gallery.write(pages, extra))
        print(f"gallery: {time.perf_counter() - began:.0f} s", flush=True)
    collect.write(ROOT, pages, made)
    code = sphinx(["-q", "-W", "--keep-going", "-j", "2", "-c", str(HERE),
                   "-d", str(pages / ".doctrees"), "-D", f"html_extra_path={extra.resolve()}",
                   str(pages), str(site)])
    if code == 0:
        print(f"{site / 'index.html'} in {time.perf_counter() - began:.0f} s")
    return code


if __name__ == "__main__":
    sys.exit(main())
