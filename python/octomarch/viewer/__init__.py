"""The viewer of notebooks: scenes that follow the hand.

`pictures` and `pace` (what to render, and how finely), `truths` (how wrong it is), `picking` and `navigation`
→ `painting` (one picture after the other) and `turns` (on a thread of its own, the latest wins)
→ `engine`, which talks in `messages` → `widget` in a notebook, `server` in a browser, both with `viewer.js`.
"""

from octomarch.viewer.picking import Pick
from octomarch.viewer.widget import Viewer, view

__all__ = ["Pick", "Viewer", "view"]
