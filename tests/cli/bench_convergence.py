#!/usr/bin/env python3
"""`rayuela reference` and `bench convergence` measure what an independent calculation finds. Argument: rayuela."""

import json
import pathlib
import struct
import subprocess
import sys
import xml.etree.ElementTree

rayuela = sys.argv[1]
assets = pathlib.Path(__file__).parents[2] / "assets"
SCENE = """{"rayuela": 1, "film": {"width": 24, "height": 16},
  "camera": {"position": [0, 1, 6], "target": [0, 1, 0], "vfov": 40},
  "environment": {"type": "constant", "radiance": [0.5, 0.6, 0.8]},
  "objects": [{"type": "sphere", "center": [0, 1, 0]}, {"type": "sphere", "center": [0, -100, 0], "radius": 100},
              {"type": "sphere", "center": [2, 3, 1], "radius": 0.5, "material": "lamp"}],
  "materials": {"lamp": {"type": "emitter", "radiance": [8, 8, 8]}}}"""
pathlib.Path("ball.scene.json").write_text(SCENE)


def run(*arguments, status=0):
    done = subprocess.run([rayuela, *map(str, arguments)], capture_output=True, text=True, timeout=100)
    assert done.returncode == status, f"{arguments}: status {done.returncode}\n{done.stderr}"
    return done


def read_pfm(path):
    with open(path, "rb") as file:
        assert file.readline().strip() == b"PF"
        width, height = map(int, file.readline().split())
        assert float(file.readline()) < 0, "little endian"
        return struct.unpack(f"<{3 * width * height}f", file.read())


def test_figures_agree_with_rendering_and_measuring_by_hand():
    run("reference", "ball.scene.json", "-o", "ball_a.pfm,ball_b.pfm", "--spp", 256)
    a, b = read_pfm("ball_a.pfm"), read_pfm("ball_b.pfm")
    assert a != b, "the halves are independent"
    done = run("bench", "convergence", "ball.scene.json", "--references", ".", "--seeds", 3, "--spp", 8,
               "--json", "c.json", "--plot", "c.svg", "--compare", "sampler=sobol,independent")
    for word in ("relMSE", "slope", "s to 1e-3", "sampler=independent"):
        assert word in done.stdout, word
    scene = json.loads(pathlib.Path("c.json").read_text())[0]
    assert scene["scene"] == "ball" and set(scene["variants"]) == {"sampler=sobol", "sampler=independent"}
    variant = scene["variants"]["sampler=sobol"]
    assert [c["spp"] for c in variant["checkpoints"]] == [1, 2, 4, 8]

    relmse = ratio = 0
    for seed in range(3):
        run("render", "ball.scene.json", "-o", "i.pfm", "--spp", 8, "--seed", seed)
        image = read_pfm("i.pfm")
        errors = [(i - x) * (i - y) / (((x + y) / 2) ** 2 + 0.01) for i, x, y in zip(image, a, b)]
        relmse += sum(errors) / len(errors) / 3
        ratio += sum(image) / (sum(a) / 2 + sum(b) / 2) / 3
    last = variant["checkpoints"][-1]
    assert abs(last["relmse"]["value"] - relmse) < 1e-6 * relmse, (last["relmse"], relmse)
    assert abs(last["mean_ratio"]["value"] - ratio) < 1e-6
    assert last["relmse"]["low"] <= last["relmse"]["value"] <= last["relmse"]["high"]
    assert variant["slope"]["value"] < -0.5
    costs = [c["cpu_seconds"] for c in variant["checkpoints"]]
    assert costs == sorted(costs) and costs[0] > 0
    xml.etree.ElementTree.parse("c.svg")


def test_adaptive_beside_fixed():
    run("bench", "convergence", "ball.scene.json", "--references", ".", "--seeds", 2, "--spp", "32,128", "--json", "d.json",
        "--plot", "d.png", "--compare", "target_error=0,0.9")
    width, height = struct.unpack(">II", pathlib.Path("d.png").read_bytes()[16:24])
    assert width > height > 300, (width, height)
    variants = json.loads(pathlib.Path("d.json").read_text())[0]["variants"]
    errors = {name: [c["relmse"]["value"] for c in v["checkpoints"]] for name, v in variants.items()}
    fixed, adaptive = errors["target_error=0"], errors["target_error=0.9"]
    assert adaptive[0] == fixed[0] > fixed[1], "nothing stops before 32 samples"
    assert adaptive[1] == adaptive[0], "so rough a target is reached by then"


def test_an_exact_image_has_a_plot():
    pathlib.Path("sky.scene.json").write_text("""{"rayuela": 1, "film": {"width": 8, "height": 8},
      "environment": {"type": "constant", "radiance": [0.5, 0.5, 0.5]}, "objects": []}""")
    run("reference", "sky.scene.json", "-o", "sky_a.pfm,sky_b.pfm", "--spp", 4)
    for plot in ("sky.svg", "sky.png"):
        run("bench", "convergence", "sky.scene.json", "--references", ".", "--seeds", 2, "--spp", 2, "--json", "sky.json",
            "--plot", plot)
        assert pathlib.Path(plot).stat().st_size > 100, plot
    checkpoints = json.loads(pathlib.Path("sky.json").read_text())[0]["variants"][""]["checkpoints"]
    assert all(c["relmse"]["value"] == 0 for c in checkpoints), checkpoints


def test_brute_force_agrees():
    run("reference", "ball.scene.json", "-o", "x.pfm,y.pfm", "--spp", 64, "--brute-force")
    brute, plain = read_pfm("x.pfm"), read_pfm("ball_a.pfm")
    assert abs(sum(brute) / sum(plain) - 1) < 0.1


def test_mistakes_are_named():
    bench = ("bench", "convergence", "ball.scene.json")
    cases = [
        (bench + ("--references", "nowhere"), 1, "rayuela reference ball.scene.json"),
        (bench + ("--reference", "ball_a.pfm,ball_a.pfm", "--set", "samplr=sobol"), 1, "no setting \"samplr\""),
        (bench + ("--references", ".", "--set", "sampler=sobel"), 1, "sampler cannot be \"sobel\""),
        (bench + ("--references", ".", "--set", "kd_leaf_size=0"), 1, "kd_leaf_size"),
        (bench + ("--references", ".", "--set", "target_error=nan"), 1, "target_error cannot be \"nan\""),
        (bench + ("--references", ".", "--compare", "sampler"), 1, "NAME=VALUE"),
        (bench + ("--references", ".", "--plot", "d.pdf"), 1, "d.pdf: --plot: must end in .svg or .png"),
        (bench + ("--references", ".", "--plot", "no/such/d.svg"), 1, "there is no folder no/such"),
        (bench + ("--references", ".", "--json", "no/such/d.json"), 1, "there is no folder no/such"),
        (bench + ("--references", ".", "--seeds", "0"), 2, "--seeds"),
        (bench + ("--references", ".", "--spp", "0"), 2, "--spp"),
        (("bench",), 2, "subcommand"),
        (("reference", "ball.scene.json", "-o", "one.pfm"), 2, "--output"),
        (("reference", "ball.scene.json", "-o", "a.png,b.png"), 1, "linear"),
    ]
    for arguments, status, words in cases:
        assert words in run(*arguments, status=status).stderr, arguments
    wide = SCENE.replace('"width": 24', '"width": 25')
    pathlib.Path("wide.scene.json").write_text(wide)
    message = run("bench", "convergence", "wide.scene.json", "--reference", "ball_a.pfm,ball_b.pfm", status=1).stderr
    assert "24 x 16" in message and "25 x 16" in message, message
    run("reference", "ball.scene.json", "-o", "less_a.pfm,less_b.pfm", "--size", "12x8", "--spp", 1)
    message = run("bench", "convergence", "ball.scene.json", "--reference", "ball_a.pfm,less_b.pfm", status=1).stderr
    assert "24 x 16" in message and "12 x 8" in message, message


def test_film_takes_the_size_of_the_reference():
    run("reference", "ball.scene.json", "-o", "small_a.pfm,small_b.pfm", "--size", "12x8", "--spp", 256)
    run("bench", "convergence", "ball.scene.json", "--reference", "small_a.pfm,small_b.pfm", "--seeds", 4, "--spp", 16,
        "--json", "s.json")
    scene = json.loads(pathlib.Path("s.json").read_text())[0]
    assert (scene["width"], scene["height"]) == (12, 8), scene
    last = scene["variants"][""]["checkpoints"][-1]
    assert last["relmse"]["value"] < 0.01 and abs(last["mean_ratio"]["value"] - 1) < 0.05, last


def test_examples_have_references():
    names = {path.name.split("_a.")[0] for path in (assets / "references").glob("*_a.exr")}
    scenes = {path.name.split(".")[0] for path in (assets / "scenes").glob("*.scene.json")}
    assert names == scenes, names ^ scenes
    run("bench", "convergence", "--seeds", 2, "--spp", 2, "--json", "e.json")
    scenes = json.loads(pathlib.Path("e.json").read_text())
    assert {scene["scene"] for scene in scenes} == names, names
    for scene in scenes:
        first = scene["variants"][""]["checkpoints"][0]
        assert abs(first["mean_ratio"]["value"] - 1) < 0.2 and 0 < first["relmse"]["value"] < 10, (scene["scene"], first)


for test in [f for name, f in list(globals().items()) if name.startswith("test_")]:
    test()
