#!/usr/bin/env python3
"""What parts of the program cost: links the program of build/release without them, below build/stripped, and renders with both in
turn. First ./dev build rayuela.

features: what a scene may hold, one after another and at last all that the example "cornell" lacks: scenes without it take at
    most 1.02 times the time of the stripped build, for the same image (catalogue 60). Prints a table; where valgrind is
    there, with the instructions executed by AVX2, which do not depend on what else the machine does.
pads: without the pads of planes, the slack of filters and the care with cancellation that keep the kd-tree watertight, as
    Embree without its robust flag: over the examples they cost at most 3%. Decisions stay in double.

Usage: tests/stress/stripped.py features|pads [ROUNDS [FEATURE...]]
       tests/stress/stripped.py build [FEATURE...]               only the programs that `features` compares
       tests/stress/stripped.py measure [ROUNDS [FEATURE...]]    compares them, for when the machine is quiet
       tests/stress/stripped.py check                            only whether what is to be taken out is there
"""

import concurrent.futures
import json
import math
import os
import pathlib
import random
import re
import shutil
import statistics
import subprocess
import sys

from stripped_features import FEATURES

LANES, PACKETS, TRIANGLES = "core/accel/kd_lanes-inl.h", "core/accel/kd_packets-inl.h", "core/accel/triangle_tests-inl.h"
FEW, PAIRS = "core/accel/few_objects-inl.h", "core/accel/pair_tests-inl.h"
CONVOYS, SPHERES = "core/accel/kd_convoy-inl.h", "core/accel/sphere_tests-inl.h"
PADS = [
    (LANES, "const Floats pad = hn::Mul(hn::Load(d, pad_), hn::Abs(inverse));", ""),
    (LANES, "enter = hn::MulSub(distance, inverse, pad), leave = hn::MulAdd(distance, inverse, pad);",
     "enter = hn::Mul(distance, inverse), leave = enter;"),
    (PACKETS, "enter = middle - overlap, leave = middle + overlap;", "enter = middle, leave = middle;\n(void)overlap;"),
    (CONVOYS, "enter = hn::MulSub(distance, inverse, overlap), leave = hn::MulAdd(distance, inverse, overlap);",
     "enter = hn::Mul(distance, inverse), leave = enter;\n(void)overlap;"),
    (TRIANGLES, "const Floats slack = hn::MulAdd(ray.slack.slope, extent, ray.slack.offset);",
     "const Floats slack = hn::Zero(FloatTag());"),
    (TRIANGLES, "z_begin -= depth_pad + kRounding * std::fabs(z_begin);", "(void)depth_pad, (void)kRounding;"),
    (TRIANGLES, "z_end += depth_pad + kRounding * std::fabs(z_end);", ""),
    (TRIANGLES, "if (HWY_LIKELY(hn::AllTrue(dd, hn::And(plain(u, cx_by), hn::And(plain(v, ax_cy), plain(w, bx_ay))))))",
     "(void)dd, (void)plain;\n    if (true)"),
    (TRIANGLES, "return {begin - (depth_pad + rounding * hn::Abs(begin)), end + (depth_pad + rounding * hn::Abs(end))};",
     "return (void)depth_pad, (void)rounding, DepthRange{begin, end};"),
    (PAIRS, "const Floats slack = hn::MulAdd(rays_.slack.slope, hn::Set(d, pair.extent), rays_.slack.offset);",
     "const Floats slack = hn::Zero(d);"),
    (FEW, "hn::Min(lo, hi) - overlap[axis]", "hn::Min(lo, hi)"),
    (FEW, "hn::Max(lo, hi) + overlap[axis]", "hn::Max(lo, hi)"),
    (SPHERES, "const Floats reach = sphere.radius + hn::Set(d, 8) * ray.pad;", "const Floats reach = sphere.radius;"),
]
# Samples of the examples that are rendered.
SAMPLES = {"cornell": 16, "dragon": 8, "fig1a": 16, "fig2": 16, "fig3": 16, "final": 4, "many_lights": 2, "materials": 8,
           "veach": 8, "weekend": 8}
PADS_SCENES = ["cornell", "weekend", "veach", "many_lights", "final", "materials"]
MOST_FOR_FEATURES, MOST_FOR_PADS = 1.02, 1.03
# Instructions that nothing is measured with, but for old machines.
UNUSED = "HWY_SSE4"

root = pathlib.Path(__file__).resolve().parents[2]
release, folder = root / "build" / "release", root / "build" / "stripped"
whole = release / "rayuela"


def replaced(replacements):
    """The text of each file that may change, with each old replaced by the new."""
    everything = PADS + [change for changes, _ in FEATURES.values() for change in changes]
    texts = {file: (root / file).read_text() for file, _, _ in everything}
    for file, old, new in replacements:
        if texts[file].count(old) != 1:
            sys.exit(f"{file}: '{old}' is there {texts[file].count(old)} times; mend {__file__}")
        texts[file] = texts[file].replace(old, new)
    return texts


def ninja(*arguments):
    return subprocess.run(["ninja", *arguments], cwd=release, check=True, capture_output=True, text=True).stdout.splitlines()


def objects_made_of(files):
    """Object files of core for which any of these is read."""
    names, found, current = {str(root / file) for file in files}, [], ""
    for line in ninja("-t", "deps"):
        if line and line[0] != " ":
            current = line.split(":")[0]
        elif "/core/" in current and current not in found and os.path.normpath(release / line.strip()) in names:
            found.append(current)
    return found


def build(name, replacements):
    """The whole program with each old replaced by the new: only what that touches in core is compiled, and linked before the rest,
    which does not look into it."""
    there = {file: text for file, text in replaced(replacements).items() if text != (root / file).read_text()}
    here = folder / f"{name}.sources"
    for file, text in there.items():
        (here / file).parent.mkdir(parents=True, exist_ok=True)
        (here / file).write_text(text)
    commands = ninja("-t", "commands", "rayuela")
    objects = {old: str(here / old.replace("/", "_")) for old in objects_made_of(there)}

    def compile_again(old):
        command = next(command for command in commands if f" -o {old} " in command).replace(old, objects[old])
        for file in there:
            command = command.replace(f" -c {root / file}", f" -c {here / file}")
        run(command.replace(f" -I{root} ", f" -I{here} -I{root} ", 1).replace(" -Werror", f" -w -DHWY_BROKEN_TARGETS='{UNUSED}'"))

    with open(folder / f"{name}.log", "w") as log:
        def run(command):
            if subprocess.run(command, shell=True, stdout=log, stderr=log, cwd=release).returncode:
                sys.exit(f"the build failed: {log.name}")

        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(compile_again, objects))
        run(commands[-1].replace(" -o rayuela ", f" -o {folder / name} {' '.join(objects.values())} "))
    return folder / name


def program_without(feature):
    return folder / feature.replace(" ", "_")


def image_of(program):
    return folder / f"{program.name}.pfm"


def render(command, program, scene, samples, *options):
    return subprocess.run([*command, program, "render", root / f"assets/scenes/{scene}.scene.json", "-o", image_of(program),
                           "--spp", str(samples), "--threads", "1", *options], check=True, capture_output=True, text=True)


def seconds(program, scene):
    stats = folder / "stats.json"
    render([], program, scene, SAMPLES[scene], "--stats", stats)
    return json.loads(stats.read_text())["cpu_seconds"]


def instructions(program, scene):
    """Of 4 samples of a small image, without those of start and end."""
    def executed(samples):
        counter = ["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"]
        report = render(counter, program, scene, samples, "--size", "64x48", "--isa", "avx2").stderr
        return int(re.search(r"I\s+refs:\s+([\d,]+)", report)[1].replace(",", ""))
    return executed(5) - executed(1)


def interval(ratios):
    generator = random.Random(60)
    medians = sorted(statistics.median(generator.choices(ratios, k=len(ratios))) for _ in range(2000))
    return f"{medians[50]:.3f} to {medians[1949]:.3f}"


def ratios_of_time(without, scene, rounds):
    ratios = []
    for i in range(rounds):
        # In turn, so that what the machine does beside wrongs neither.
        taken = {program: seconds(program, scene) for program in ((whole, without), (without, whole))[i % 2]}
        ratios.append(taken[whole] / taken[without])
    return ratios


def measure_pads(rounds):
    without = build("without", PADS)
    medians = []
    for scene in PADS_SCENES:
        ratios = ratios_of_time(without, scene, rounds)
        print(f"{scene}: {statistics.median(ratios):.4f}, 95% interval {interval(ratios)}, {rounds} rounds", flush=True)
        medians.append(statistics.median(ratios))
    mean = math.exp(statistics.fmean(map(math.log, medians)))
    print(f"{mean:.4f} times the time of the stripped build; required <= {MOST_FOR_PADS}")
    return mean <= MOST_FOR_PADS


def measure_features(rounds, names):
    print("| without | scene | time | 95% interval | instructions |\n|---|---|---|---|---|", flush=True)
    most = 0
    for name in names:
        without = program_without(name)
        for scene in FEATURES[name][1]:
            ratios = ratios_of_time(without, scene, rounds)
            images = (image_of(program).read_bytes() for program in (whole, without))
            assert len(set(images)) == 1, f"{scene} without {name}: the images differ"
            counts = [instructions(program, scene) for program in (whole, without)] if shutil.which("valgrind") else []
            counted = f"{counts[0] / counts[1]:.4f}" if counts else "-"
            print(f"| {name} | {scene} | {statistics.median(ratios):.3f} | {interval(ratios)} | {counted} |", flush=True)
            most = max(most, statistics.median(ratios))
    print(f"at most {most:.4f} times the time of a stripped build, {rounds} rounds; required <= {MOST_FOR_FEATURES}")
    return most <= MOST_FOR_FEATURES


def main():
    task, arguments = (sys.argv[1], sys.argv[2:]) if len(sys.argv) > 1 else ("", [])
    if task == "check":
        replaced(PADS)
        for replacements, _ in FEATURES.values():
            replaced(replacements)
        return
    if task not in ("build", "measure", "features", "pads"):
        sys.exit(__doc__)
    rounds = int(arguments.pop(0)) if task != "build" and arguments else 21
    names = arguments or list(FEATURES)
    folder.mkdir(parents=True, exist_ok=True)
    for name in names if task in ("build", "features") else []:
        build(program_without(name).name, FEATURES[name][0])
    if task != "build":
        sys.exit(not (measure_pads(rounds) if task == "pads" else measure_features(rounds, names)))


main()
