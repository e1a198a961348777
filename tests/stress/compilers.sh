#!/usr/bin/env bash
# Catalogue 8 and 58: whatever the compiler and its level of optimisation, closed meshes keep every ray and a film has the
# same bytes. Usage: tests/stress/compilers.sh [SCALE]; builds below build/compilers.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
scale=${1-0.01}
films=()
mkdir -p "$root/build/compilers"
for compiler in g++ clang++; do
    if ! command -v "$compiler" >/dev/null; then
        echo "$compiler is not here: skipped"
        continue
    fi
    for level in O0 O2 O3; do
        folder=$root/build/compilers/$compiler-$level
        cmake -S "$root" -B "$folder" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Release \
            -DCMAKE_CXX_FLAGS_RELEASE="-$level -DNDEBUG" >"$folder.log" 2>&1 || { cat "$folder.log"; exit 1; }
        cmake --build "$folder" --target rayuela_stress >>"$folder.log" 2>&1 || { tail -n 20 "$folder.log"; exit 1; }
        echo "$compiler -$level"
        "$folder/tests/rayuela_stress" --scale "$scale" --json "$folder.json" 7-9 11 58 | tee "$folder.txt"
        films+=("$(sed -n 's/.*film of/film of/p' "$folder.txt")")
    done
done
if [[ $(printf '%s\n' "${films[@]}" | sort -u | wc -l) -ne 1 ]]; then
    echo "The films differ:"
    printf '%s\n' "${films[@]}"
    exit 1
fi
