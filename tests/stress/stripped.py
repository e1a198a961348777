#!/usr/bin/env python3
"""What parts of the program cost: links the program of build/release without them, below build/stripped, and renders with both at
the same time on two cores, which they change after every round. First ./dev build rayuela.

features: what a scene may hold, one after another and at last all that the example "cornell" lacks: scenes without it take at
    most 1.02 times the time of the stripped build, for the same image (catalogue 60). Prints a table. What comes out above
    that is measured a second time with four times the rounds, and only that counts: of fifty medians some are above by chance.
pads: without the pads of planes, the slack of filters and the care with cancellation that keep the kd-tree watertight, as
    Embree without its robust flag: over the examples they cost at most 3%. Decisions stay in double.

Usage: tests/stress/stripped.py features|pads [ROUNDS [FEATURE...]]
       tests/stress/stripped.py build [FEATURE...]               only the programs that `features` compares
       tests/stress/stripped.py measure [ROUNDS [FEATURE...]]    compares them, for when the machine is quiet
       tests/stress/stripped.py count [FEATURE...]               the instructions they execute, by valgrind with AVX2, which
                                                                 do not depend on what else the machine does
       tests/stress/stripped.py check                            only whether what is to be taken out is there
"""

import concurrent.futures
import itertools
import json
import math
import os
import pathlib
import random
import re
import statistics
import subprocess
import sys

from stripped_features import FEATURES

LANES, PACKETS, TRIANGLES = "core/accel/kd_lanes-inl.h", "core/accel/kd_packets-inl.h", "core/accel/triangle_tests-inl.h"
FEW, PAIRS = "core/accel/few_objects-inl.h", "core/accel/pair_tests-inl.h"
BEAMS, BEAM_TRIANGLES = "core/accel/kd_beams-inl.h", "core/accel/triangle_beams-inl.h"
CONVOYS, SPHERES = "core/accel/kd_convoy-inl.h", "core/accel/sphere_tests-inl.h"
PADS = [
    (LANES, "const Floats pad = hn::Mul(hn::Load(d, pad_), hn::Abs(inverse));", ""),
    (LANES, "enter = hn::MulSub(distance, inverse, pad), leave = hn::MulAdd(distance, inverse, pad);",
     "enter = hn::Mul(distance, inverse), leave = enter;"),
    (PACKETS, "enter = middle - overlap, leave = middle + overlap;", "enter = middle, leave = middle;\n(void)overlap;"),
    (BEAMS, "pad_(2 * beam.pad)", "pad_(0 * beam.pad)"),
    (BEAM_TRIANGLES, "const float pad = 2 * beam_.pad;", "const float pad = 0;"),
    (BEAM_TRIANGLES, "hn::MulAdd(rounding, size, hn::MulAdd(slack.slope, extent, slack.offset))",
     "hn::Zero(d) * rounding * size * slack.slope * slack.offset"),
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
# Samples of the examples that are rendered, for about a second: longer runs do not agree better than more rounds.
SAMPLES = {"cornell": 4, "dragon": 1, "fig1a": 8, "fig2": 8, "fig3": 8, "final": 1, "many_lights": 1, "materials": 4, "veach": 4,
           "weekend": 4}
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


def start(program, scene, samples, *options, under=()):
    return subprocess.Popen([*under, program, "render", root / f"assets/scenes/{scene}.scene.json", "-o", image_of(program),
                             "--spp", str(samples), "--threads", "1", *options], stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True)


def finish(process):
    report = process.communicate()[1]
    if process.returncode:
        sys.exit(f"{process.args}: {report}")
    return report


def seconds(programs, scene):
    """CPU seconds of each, the first on the first core and so on, all at the same time, so that what the machine does beside
    wrongs none."""
    stats = [folder / f"{program.name}.json" for program in programs]
    runs = [start(program, scene, SAMPLES[scene], "--stats", file, under=["taskset", "-c", str(core)])
            for core, program, file in zip(itertools.cycle(sorted(os.sched_getaffinity(0))), programs, stats)]
    for run in runs:
        finish(run)
    return [json.loads(file.read_text())["cpu_seconds"] for file in stats]


def instructions(program, scene):
    """Of 4 samples of a small image, without those of start and end."""
    def executed(samples):
        counter = ["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"]
        report = finish(start(program, scene, samples, "--size", "64x48", "--isa", "avx2", under=counter))
        return int(re.search(r"I\s+refs:\s+([\d,]+)", report)[1].replace(",", ""))
    return executed(5) - executed(1)


def interval(ratios):
    generator = random.Random(60)
    medians = sorted(statistics.median(generator.choices(ratios, k=len(ratios))) for _ in range(2000))
    return f"{medians[50]:.3f} to {medians[1949]:.3f}"


def ratios_of_time(without, scene, rounds):
    ratios = []
    for i in range(rounds):
        order = (whole, without) if i % 2 == 0 else (without, whole)
        taken = dict(zip(order, seconds(order, scene)))
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
    print("| without | scene | time | 95% interval |\n|---|---|---|---|", flush=True)
    most = 0
    for name in names:
        without = program_without(name)
        for scene in FEATURES[name][1]:
            for times in (1, 4):
                ratios = ratios_of_time(without, scene, times * rounds)
                median = statistics.median(ratios)
                print(f"| {name} | {scene} | {median:.3f} | {interval(ratios)} |", flush=True)
                if median <= MOST_FOR_FEATURES:
                    break
            images = (image_of(program).read_bytes() for program in (whole, without))
            assert len(set(images)) == 1, f"{scene} without {name}: the images differ"
            most = max(most, median)
    print(f"at most {most:.4f} times the time of a stripped build, {rounds} rounds; required <= {MOST_FOR_FEATURES}")
    return most <= MOST_FOR_FEATURES


def count_features(names):
    print("| without | scene | instructions |\n|---|---|---|", flush=True)
    for name in names:
        for scene in FEATURES[name][1]:
            with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
                ours, theirs = pool.map(lambda program: instructions(program, scene), (whole, program_without(name)))
            print(f"| {name} | {scene} | {ours / theirs:.4f} |", flush=True)


def main():
    task, arguments = (sys.argv[1], sys.argv[2:]) if len(sys.argv) > 1 else ("", [])
    if task == "check":
        replaced(PADS)
        for replacements, _ in FEATURES.values():
            replaced(replacements)
        return
    if task not in ("build", "measure", "count", "features", "pads"):
        sys.exit(__doc__)
    rounds = int(arguments.pop(0)) if task not in ("build", "count") and arguments else 41
    names = arguments or list(FEATURES)
    folder.mkdir(parents=True, exist_ok=True)
    for name in names if task in ("build", "features") else []:
        build(program_without(name).name, FEATURES[name][0])
    if task == "count":
        count_features(names)
    elif task != "build":
        sys.exit(not (measure_pads(rounds) if task == "pads" else measure_features(rounds, names)))


main()
