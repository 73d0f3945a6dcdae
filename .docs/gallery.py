"""stub"""
from pathlib import Path
def write(pages: Path) -> str:
    (pages/"gallery").mkdir()
    (pages/"gallery"/"index.md").write_text("# Gallery\n")
    return "gallery/index"
