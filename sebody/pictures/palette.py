"""Colours of moving models, the same in pages and in films."""

BODIES = ("#4c78a8", "#e4873f", "#5a9e6f", "#b65d7c", "#8a6fb0", "#c8a23c", "#4aa3a8", "#9c755f")
WITHOUT_VALUE = "#b9c0cc"       # of bodies that have no value of the quantity that colours others
LINK, SPRING, LOAD, JOINT = "#8d97aa", "#2a7f62", "#7b3fa0", "#39455f"
GROUND, DRIVE, CONTACT = "#5b6478", "#c8452d", "#8a7a4f"
ROPE, SLACK = "#6b4a2f", "#d3c3b3"
AXES = ("#c8452d", "#2a7f62", "#3566b8")        # x, y and z
CURVES = (*AXES, "#d99a2b", "#6a4c93", "#1f2a44", "#8c564b", "#7f7f7f")
# from small to large values
MAP = ("#5b7db8", "#5f9fc6", "#6dbfb8", "#8fd0a0", "#bfd987", "#ecd06f", "#f2a65a", "#e6704a",
       "#c8352d")


def rgb(color: str) -> list[float]:
    """Red, green and blue of a colour, from 0 to 1."""
    return [int(color[k:k + 2], 16) / 255 for k in (1, 3, 5)]
