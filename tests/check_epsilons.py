#!/usr/bin/env python3
"""No absolute epsilon in the arithmetic of rays: offsets and tolerances follow from error bounds, so that no scene has the
wrong size. Every small literal of the core must be one of those below. Usage: check_epsilons.py [REPOSITORY]"""

import pathlib
import re
import sys

FOLDERS = ["math", "shapes", "accel", "materials", "lights", "render"]

# Each is relative to the numbers around it, or without a unit.
RELATIVE = {
    "core/math/float_error.h": ["kUnitRoundoff"],
    "core/math/sampler.h": ["to_unit_float", "bits >> 8"],
    "core/math/sampler_lanes-inl.h": ["ConvertTo"],
    "core/math/sampling.h": ["kSinOctant", "kCosOctant", "kLowestHemisphereZ2"],
    "core/shapes/intersect_triangle.h": ["std::fabs(ad) + std::fabs(bc)"],
    "core/shapes/intersect_box.h": ["kRounding"],
    "core/shapes/intersect_sphere.h": ["kSphereCancels"],
    "core/accel/surface_rounding.h": ["kSurfaceDoubleError", "kSurfaceSmallestError"],
    "core/accel/traced_object.cpp": ["kTolerance"],
    "core/accel/few_objects-inl.h": ["longest", "direction[axis]"],
    "core/accel/kd_beams-inl.h": ["kLeastPad"],
    "core/accel/ray_block-inl.h": ["longest", "length >", "direction[axis]", "kBoundsTolerance", "kLeastDepthPad"],
    "core/accel/triangle_tests-inl.h": ["difference"],
    "core/lights/area_light.cpp": ["kRightAngle"],
    "core/lights/rectangle_view.h": ["kAtan"],
    "core/materials/microfacet.h": ["kSmoothAlpha"],
    "core/render/camera_rays.cpp": ["kParallel"],
    "core/render/image_error.cpp": ["kTrimmedShare"],
    "core/render/reference_trace.cpp": ["kEdge"],
    "core/render/schedule.cpp": ["kGuessedPathSeconds"],
}

SMALL = re.compile(r"(?<![\w.])(?:\d+\.?\d*e-\d+|0?\.000\d*|0x1p-(?:[1-9]\d+)|\w*[eE]psilon)f?\b")


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    problems = []
    for folder in FOLDERS:
        for path in sorted((root / "core" / folder).glob("*")):
            if path.suffix not in (".h", ".cpp"):
                continue
            name = path.relative_to(root).as_posix()
            for number, line in enumerate(path.read_text().splitlines(), 1):
                found = SMALL.search(line.split("//")[0])
                if found and not any(known in line for known in RELATIVE.get(name, [])):
                    problems.append(f"{name}:{number}: {found.group()} looks like an absolute epsilon. Derive it from an "
                                    "error bound; if it is relative, say so in tests/check_epsilons.py")
    print("\n".join(problems) or "no epsilon")
    return 1 if problems else 0


sys.exit(main())
