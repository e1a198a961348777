#!/usr/bin/env python3
"""`rayuela bench first-image` times both ways of opening a scene, and leaves nothing behind. Argument: rayuela."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

rayuela = os.path.abspath(sys.argv[1])
MESH = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


def run(*arguments, folder, status=0):
    done = subprocess.run([rayuela, "bench", "first-image", *map(str, arguments)], capture_output=True, text=True,
                          timeout=120, cwd=folder, env={**os.environ, "TMPDIR": str(folder)})
    assert done.returncode == status, done.stderr
    return done.stdout + done.stderr


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    (folder / "tent.obj").write_text(MESH)
    run("--sizes", "2k,300k", "--threads", "1,2", "--repetitions", 1, "--json", "land.json", folder=folder)
    run("tent.obj", "--threads", 1, "--repetitions", 2, "--json", "tent.json", folder=folder)
    assert {file.name for file in folder.iterdir()} == {"tent.obj", "land.json", "tent.json"}
    figures = json.loads((folder / "land.json").read_text())
    assert [(one["scene"], one["threads"], one["draft"]) for one in figures] == [
        (scene, threads, draft) for scene in ("land 2k", "land 300k") for threads in (1, 2) for draft in (False, True)]
    for one in figures + json.loads((folder / "tent.json").read_text()):
        seconds = one["seconds"]
        assert 0 < seconds["loaded"] <= seconds["trees"] <= seconds["first image"] <= seconds["whole image"], one
        assert seconds["CPU"] > 0 and ("sooner" in one) == one["draft"], one
    assert "no count" in run("--sizes", "many", folder=folder, status=2)
    assert "nowhere.ply" in run("nowhere.ply", folder=folder, status=2)
