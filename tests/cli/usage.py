#!/usr/bin/env python3
"""Every mistake on the command line gets status 2 (usage) or 1 (failed) and a message that names it. Argument: rayuela."""

import pathlib
import subprocess
import sys

rayuela = sys.argv[1]
here = pathlib.Path.cwd()

SPHERE = '{"rayuela": 1, "film": {"width": 8, "height": 8}, "objects": [{"type": "sphere", "center": [0, 1, 0]}]}'
files = {
    "good.scene.json": SPHERE,
    "radius.scene.json": SPHERE.replace('"type"', '"radius": -1, "type"'),
    "two.scene.json": SPHERE.replace('"type"', '"radius": -1, "colour": 3, "type"'),
    "material.scene.json": SPHERE.replace('"type"', '"material": "nope", "type"'),
    "mesh.scene.json": SPHERE.replace('"sphere", "center": [0, 1, 0]', '"mesh", "file": "gone.obj"'),
    "syntax.scene.json": '{"rayuela": 1,\n "film": }',
    "version.scene.json": '{"rayuela": 99}',
    "empty.scene.json": "",
    "bad.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
    "bad.glb": "glTF????",
    "text.txt": "hello",
}
for name, text in files.items():
    (here / name).write_text(text)

RENDER = ["render", "good.scene.json", "-o", "out.png"]
# Arguments, status, what standard error must say.
CASES = [
    (["render"], 2, ["scene", "required"]),
    (["render", "good.scene.json"], 2, ["--output", "required"]),
    (RENDER + ["--spp", "0"], 2, ["--spp"]),
    (RENDER + ["--spp", "many"], 2, ["--spp", "many"]),
    (RENDER + ["--time", "-1"], 2, ["--time"]),
    (RENDER + ["--time", "nan"], 2, ["--time"]),
    (RENDER + ["--size", "640"], 2, ["--size", "640"]),
    (RENDER + ["--size", "0x10"], 2, ["--size", "0x10"]),
    (RENDER + ["--size", "10x99999"], 2, ["--size", "16384"]),
    (RENDER + ["--size", "10x10x"], 2, ["--size", "10x10x"]),
    (RENDER + ["--seed", "-3"], 2, ["--seed"]),
    (RENDER + ["--threads", "-1"], 2, ["--threads"]),
    (RENDER + ["--accelerator", "bvh"], 2, ["--accelerator", "bvh", "list", "kd"]),
    (RENDER + ["--kd-leaf-size", "0"], 2, ["--kd-leaf-size"]),
    (RENDER + ["--kd-split", "middle"], 2, ["--kd-split", "middle", "median", "sah"]),
    (RENDER + ["--max-bounces", "-1"], 2, ["--max-bounces"]),
    (RENDER + ["--frobnicate"], 2, ["--frobnicate"]),
    (["screenshot", "good.scene.json"], 2, ["--output"]),
    (["info"], 2, ["scene"]),
    (["render", "gone.scene.json", "-o", "out.png"], 1, ["gone.scene.json"]),
    (["render", "good.scene.json", "-o", "out.xyz"], 1, ["out.xyz", ".png", ".exr", ".pfm"]),
    (["render", "good.scene.json", "-o", "no/such/folder/out.png"], 1, ["out.png", "no/such/folder"]),
    (RENDER + ["--spp", "1", "--stats", "no/such/stats.json"], 1, ["stats.json"]),
    (["render", "radius.scene.json", "-o", "out.png"], 1, ["radius.scene.json", "objects[0].radius", "must be > 0", "-1"]),
    (["render", "two.scene.json", "-o", "out.png"], 1, ["objects[0].radius", "objects[0].colour"]),
    (["render", "material.scene.json", "-o", "out.png"], 1, ["objects[0].material", "nope"]),
    (["render", "mesh.scene.json", "-o", "out.png"], 1, ["gone.obj"]),
    (["render", "syntax.scene.json", "-o", "out.png"], 1, ["syntax.scene.json", "line 2"]),
    (["render", "version.scene.json", "-o", "out.png"], 1, ["version.scene.json", "99"]),
    (["render", "empty.scene.json", "-o", "out.png"], 1, ["empty.scene.json"]),
    (["render", "text.txt", "-o", "out.png"], 1, ["text.txt"]),
    (["render", ".", "-o", "out.png"], 1, ["."]),
    (["info", "bad.obj"], 1, ["bad.obj", "4"]),
    (["info", "bad.glb"], 1, ["bad.glb"]),
    (["screenshot", "gone.scene.json", "-o", "ui.png"], 1, ["gone.scene.json"]),
    (["screenshot", "radius.scene.json", "-o", "ui.png"], 1, ["objects[0].radius"]),
]

failures = []
for arguments, status, words in CASES:
    run = subprocess.run([rayuela, *arguments], capture_output=True, text=True, timeout=60)
    missing = [word for word in words if word not in run.stderr]
    if run.returncode != status or missing:
        failures.append(f"{' '.join(arguments)}\n  status {run.returncode}, expected {status}; stderr lacks {missing}:\n"
                        + "\n".join("    " + line for line in run.stderr.splitlines()))

for arguments in (["--help"], ["render", "--help"], ["--version"]):
    run = subprocess.run([rayuela, *arguments], capture_output=True, text=True, timeout=60)
    if run.returncode != 0 or not run.stdout:
        failures.append(f"{' '.join(arguments)}: status {run.returncode}, prints {run.stdout!r}")

print(f"{len(CASES) + 3 - len(failures)} passed, {len(failures)} failed")
sys.exit("\n".join(failures) if failures else 0)
