"""The code of docs/python.md runs, block after block, in one session."""

import os
import pathlib
import re
import shutil
import sys

import scene

shutil.copytree(scene.STARTERS, "dataset")
page = (scene.SOURCE / "docs/python.md").read_text()
blocks = re.findall(r"^```python\n(.*?)^```", page, re.M | re.S)
session = {"__name__": "__docs__"}
for block in blocks:
    line = page[: page.index(block)].count("\n")
    exec(compile("\n" * line + block, "docs/python.md", "exec"), session)
print(len(blocks), "blocks")
sys.exit(0 if len(blocks) >= 4 else "docs/python.md has lost its code")
