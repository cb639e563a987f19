// Tail probabilities, intervals and the constants that robust estimates share. Sources: statistics.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

namespace ecs::model {

/// A median absolute deviation times this is a standard deviation: 1/Φ⁻¹(3/4) of a normal distribution.
inline constexpr double kSigmaPerMad = 1.4826;
/// Median of χ² of one degree of freedom: a median square divided by it is a variance.
inline constexpr double kMedianChi2 = 0.4549;
/// Keeps a quotient finite where the divisor may be 0; far below the square of anything measured.
inline constexpr double kLeastDivisor = 1e-300;
/// Larger than any value met: where the search for a least or greatest value begins. Finite, as are differences of it.
inline constexpr double kBeyondAll = 1e300;

/// ln Γ(x), x > 0; unlike std::lgamma it writes no global sign, so that several threads may diagnose.
[[nodiscard]] double ln_gamma(double x);
/// ln of the chance that a χ² variable of k degrees of freedom exceeds x.
[[nodiscard]] double ln_chi2_tail(double x, double k);
/// ln of the chance that F(k, v) exceeds f.
[[nodiscard]] double ln_f_tail(double f, double k, double v);
/// Whether a sum of squares in units of the noise is within three standard deviations of what noise leaves.
[[nodiscard]] bool is_no_more_than_noise(double chi2, double freedom);

/// Chance, 0 … 1, that noise alone reaches `value`: the share of the replicates that do, and beyond them an exponential
/// tail fitted to the upper fifth of them. 1 without replicates.
[[nodiscard]] double tail_probability(std::vector<double> noise_replicates, double value);

/// Wealth of a bet that noise alone reaches a value with a chance of at most `chance`, from 1 before the first draw,
/// once `reached` of `drawn` replicates have: whatever the moment of stopping, wealth w comes about by luck with a
/// chance of at most 1/w, and wealth w is won back to 1 with a chance of at most w (Fischer and Ramdas 2025).
[[nodiscard]] double wealth_of_bet(double chance, std::size_t reached, std::size_t drawn);

/// Half width over standard uncertainty that holds 95.45 % (of the normal distribution: 2) of Student's t.
/// @param degrees_of_freedom  below 1 taken as 1
[[nodiscard]] double coverage_factor(double degrees_of_freedom);

/// The middle of the ordered values, of an even number the upper of the two. @pre  values are not empty
[[nodiscard]] double upper_median(std::vector<double> values);

/// Values this close, as a share of the larger and at least as much, are equal: the last digits are rounding of a
/// search.
inline constexpr double kEqualShare = 1e-5;

/// Sorts the greatest first. Neighbours in that order that are equal keep the order that they had, so that no rounding
/// ranks them. @param value  of one of the list  @param most  so many of the greatest are kept
template <class List, class Value>
void sort_greatest_first(List& list, const Value& value, std::size_t most = static_cast<std::size_t>(-1)) {
  using Valued = std::pair<double, std::size_t>;
  std::vector<Valued> order;
  for (std::size_t i = 0; i < list.size(); ++i) order.emplace_back(value(list[i]), i);
  const auto is_before = [](const Valued& a, const Valued& b) {
    return a.first > b.first || (a.first == b.first && a.second < b.second);
  };
  const auto are_equal = [](const Valued& greater, const Valued& less) {
    return greater.first - less.first <= kEqualShare * std::max(1.0, std::abs(greater.first));
  };
  most = std::min(most, order.size());
  auto end = order.begin() + static_cast<std::ptrdiff_t>(most);
  for (bool is_whole = false; !is_whole;) {  // equals of the last one kept come along
    std::nth_element(order.begin(), end, order.end(), is_before);
    std::sort(order.begin(), end, is_before);
    is_whole = end == order.begin() || end == order.end() ||
               !are_equal(*std::prev(end), *std::min_element(end, order.end(), is_before));
    if (!is_whole) end += std::min(end - order.begin(), order.end() - end);
  }
  for (auto from = order.begin(); from != end;) {
    auto to = std::next(from);
    while (to != end && are_equal(*std::prev(to), *to)) ++to;
    std::sort(from, to, [](const auto& a, const auto& b) { return a.second < b.second; });
    from = to;
  }
  List sorted;
  sorted.reserve(most);
  for (std::size_t i = 0; i < most; ++i) sorted.push_back(std::move(list[order[i].second]));
  list = std::move(sorted);
}

/// √(mean of squares); 0 for none.
[[nodiscard]] double rms_of(const std::vector<double>& values);

}  // namespace ecs::model
