#!/usr/bin/env python3
"""Run time against error, Rayuela beside Mitsuba 3 in the same run, one thread each and in turns.

    python3 -m venv venv && venv/bin/pip install mitsuba numpy        # llvm_ad_rgb also wants libLLVM
    venv/bin/python tests/compare/against_mitsuba.py RAYUELA SCENE [REFERENCE_A REFERENCE_B] [--spp N] [--mitsuba-spp N]
        [--rounds N] [--error E] [--variant V]

The references are two .exr or .pfm images of the scene made by `rayuela reference` or anybody else, and both render at their
size; without them they are those of assets/references. CPU seconds are those of loading and rendering; Mitsuba's are given
for its second render too, when its kernels are compiled. Seconds to the error E count as if errors fell as 1/N from what was
rendered; choose for each the samples with which it comes close to E. Intervals are of 95%, by bootstrap over the rounds.
"""

import argparse
import json
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile
import time

import mitsuba as mi
import numpy as np

KEPT = pathlib.Path(__file__).resolve().parents[2] / "assets" / "references"


def read_reference(path):
    if pathlib.Path(path).suffix == ".exr":
        return np.array(mi.Bitmap(str(path)))[:, :, :3].astype(np.float64)
    return read_pfm(path)


def read_pfm(path):
    with open(path, "rb") as file:
        kind, size, scale = (file.readline().split() for _ in range(3))
        if kind[0] != b"PF":
            sys.exit(f"{path}: not a PFM image of three channels")
        width, height = int(size[0]), int(size[1])
        pixels = np.frombuffer(file.read(), dtype="<f4" if float(scale[0]) < 0 else ">f4")
    return pixels.reshape(height, width, 3)[::-1].astype(np.float64)


def rel_mse(image, a, b):
    """Against two independent halves of a reference, whose own noise so drops out."""
    mean = (a + b) / 2
    return float(np.mean((image - a) * (image - b) / (mean ** 2 + 0.01)))


def render_mitsuba(arguments):
    """In a process of its own: prints the seconds of a first and a second render, and writes the second as .npy."""
    import drjit as dr
    mi.set_variant(arguments.variant)
    if "llvm" in arguments.variant:
        dr.set_thread_count(1)
    import mitsuba_scene
    with tempfile.TemporaryDirectory() as scratch:
        try:
            description = mitsuba_scene.convert(arguments.scene, pathlib.Path(scratch))
        except mitsuba_scene.Unsupported as problem:
            sys.exit(f"{arguments.scene}: {problem}")
        width, height = arguments.size.split("x")
        description["sensor"]["film"] |= {"width": int(width), "height": int(height)}
        seconds = []
        start = time.process_time()
        scene = mi.load_dict(description)
        load = time.process_time() - start
        for seed in (2 * arguments.seed, 2 * arguments.seed + 1):
            start = time.process_time()
            image = np.array(mi.render(scene, spp=arguments.spp, seed=seed))
            seconds.append(load + time.process_time() - start)
    np.save(arguments.output, image[:, :, :3])
    print("seconds", json.dumps(seconds))


def run_mitsuba(arguments, seed, folder):
    output = folder / "mitsuba.npy"
    command = [sys.executable, __file__, arguments.rayuela, arguments.scene, *arguments.references, "--spp",
               str(arguments.mitsuba_spp or arguments.spp), "--size", arguments.size, "--variant", arguments.variant, "--seed",
               str(seed), "--output", str(output)]
    done = subprocess.run(["taskset", "-c", "0", *command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr.strip())
    # Mitsuba prints warnings too.
    return json.loads(done.stdout.rpartition("seconds ")[2]), np.load(output).astype(np.float64)


def run_rayuela(arguments, seed, folder):
    image, stats = folder / "rayuela.pfm", folder / "stats.json"
    subprocess.run(["taskset", "-c", "0", arguments.rayuela, "render", arguments.scene, "-o", image, "--spp",
                    str(arguments.spp), "--size", arguments.size, "--threads", "1", "--seed", str(seed), "--stats",
                    stats], check=True, capture_output=True)
    return json.loads(stats.read_text())["cpu_seconds"], read_pfm(image)


def seconds_to(error, runs):
    return statistics.median(run[0] for run in runs) * statistics.fmean(run[1] for run in runs) / error


def interval(error, theirs, ours):
    """Of how many times the seconds of ours theirs take; rounds are drawn for both, because they ran side by side."""
    generator = random.Random(4)
    ratios = []
    for _ in range(2000):
        rounds = generator.choices(range(len(ours)), k=len(ours))
        ratios.append(seconds_to(error, [theirs[i] for i in rounds]) / seconds_to(error, [ours[i] for i in rounds]))
    return sorted(ratios)[50], sorted(ratios)[1949]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rayuela")
    parser.add_argument("scene")
    parser.add_argument("references", nargs="*")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--mitsuba-spp", type=int, help="samples of Mitsuba, if not as many")
    parser.add_argument("--error", type=float, default=1e-3)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--variant", default="llvm_ad_rgb")
    parser.add_argument("--seed", type=int, default=0, help=argparse.SUPPRESS)
    parser.add_argument("--output", help=argparse.SUPPRESS)
    parser.add_argument("--size", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if not arguments.references:
        name = pathlib.Path(arguments.scene).name.split(".")[0]
        arguments.references = [str(KEPT / f"{name}_{half}.exr") for half in "ab"]
    if len(arguments.references) != 2 or not all(pathlib.Path(path).exists() for path in arguments.references):
        parser.error(f"needs two references: {arguments.references}")
    if arguments.output:
        render_mitsuba(arguments)
        return
    halves = [read_reference(path) for path in arguments.references]
    height, width = halves[0].shape[:2]
    arguments.size = f"{width}x{height}"
    mean = (halves[0].mean() + halves[1].mean()) / 2
    rows = {"rayuela": [], f"mitsuba {arguments.variant}": [], "  its second render": []}
    names = list(rows)
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        for seed in range(arguments.rounds):
            seconds, image = run_rayuela(arguments, seed, folder)
            rows[names[0]].append((seconds, rel_mse(image, *halves), image.mean() / mean))
            times, image = run_mitsuba(arguments, seed, folder)
            error = rel_mse(image, *halves), image.mean() / mean
            rows[names[1]].append((times[0], *error))
            rows[names[2]].append((times[1], *error))
    ours = rows["rayuela"]
    print(f"{'':24}{'CPU s':>8}{'relMSE':>11}{'mean ratio':>12}{f's to {arguments.error}':>12}{'times':>7}{'95%':>14}")
    for name, runs in rows.items():
        seconds = statistics.median(run[0] for run in runs)
        error, mean = (statistics.fmean(run[k] for run in runs) for k in (1, 2))
        to_error = seconds_to(arguments.error, runs)
        times, (low, high) = to_error / seconds_to(arguments.error, ours), interval(arguments.error, runs, ours)
        print(f"{name:24}{seconds:8.2f}{error:11.6f}{mean:12.5f}{to_error:12.2f}{times:7.2f}{f'{low:.2f} - {high:.2f}':>14}")


main()
