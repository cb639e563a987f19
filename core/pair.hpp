// Two numbers that the processor works on at once (SSE2, Neon): where the compiler does not find the pairs of a sum by
// itself. The same bits as one by one.
#pragma once

namespace ecs {

using Pair __attribute__((vector_size(16))) = double;

/// @pre at is a multiple of 16 bytes
[[nodiscard]] inline Pair pair_at(const double* at) noexcept { return *reinterpret_cast<const Pair*>(at); }
[[nodiscard]] inline Pair twice(double v) noexcept { return Pair{v, v}; }
[[nodiscard]] inline Pair lows(Pair a, Pair b) noexcept { return __builtin_shufflevector(a, b, 0, 2); }
[[nodiscard]] inline Pair highs(Pair a, Pair b) noexcept { return __builtin_shufflevector(a, b, 1, 3); }

}  // namespace ecs
