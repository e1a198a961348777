#pragma once

#include <string_view>
#include <vector>

namespace rayuela {

/// Sets of SIMD instructions that the kernels are compiled for and this machine has, widest first: avx512, avx2, sse4, neon,
/// scalar. The kernels use the first unless told otherwise.
std::vector<std::string_view> instruction_sets();

/// From now on all kernels use this one of `instruction_sets`. Not while any is running. For tests and measurements: hits and
/// images are the same.
void use_instruction_set(std::string_view name);

}  // namespace rayuela
