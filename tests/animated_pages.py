"""Pages of animations in a browser: what tests set there, and what they see."""

import json

import browser
import numpy as np
import pytest

chromium = pytest.mark.skipif(browser.COMMAND is None, reason="no Chromium is installed")


def go(chrome, part):
    """Stop at a part of the duration, and the picture there."""
    chrome.value(f"(() => {{ const time = document.getElementById('time'); time.value = "
                 f"{100000 * part}; time.dispatchEvent(new Event('input')); }})()")
    chrome.value("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return chrome.picture()


def choose(chrome, control, value):
    """Set a control to a value."""
    chrome.value(f"(() => {{ const one = document.getElementById('{control}'); one.value = "
                 f"{json.dumps(value)}; one.dispatchEvent(new Event('input')); "
                 "one.dispatchEvent(new Event('change')); })()")


def text(chrome, name):
    return chrome.value(f"document.getElementById('{name}').innerText")


def model_of(picture):
    """The part of the picture that shows the model, not the panel, the legend or the plot."""
    return picture[60:300, 290:630]


def changes(one, other):
    return np.mean(np.abs(model_of(one) - model_of(other)).max(axis=2) > 30)
