#include "model/fit/statistics.hpp"

#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;

TEST_CASE("tails agree with printed tables") {
  CHECK(std::exp(ln_chi2_tail(3.841459, 1.0)) == Approx(0.05).epsilon(1e-5));
  CHECK(std::exp(ln_chi2_tail(18.30704, 10.0)) == Approx(0.05).epsilon(1e-5));
  CHECK(std::exp(ln_f_tail(3.325835, 5.0, 10.0)) == Approx(0.05).epsilon(1e-5));
  CHECK(std::exp(ln_f_tail(4.964603, 1.0, 10.0)) == Approx(0.05).epsilon(1e-5));
}

TEST_CASE("beyond the noise replicates the tail goes on falling") {
  std::vector<double> blanks;
  for (int i = 1; i <= 400; ++i) blanks.push_back(-2.0 * std::log(i / 400.5));  // χ² of two degrees
  CHECK(tail_probability(blanks, 6.0) == Approx(std::exp(-3.0)).epsilon(0.2));
  CHECK(tail_probability(blanks, 20.0) < 5e-4);
  CHECK(tail_probability(blanks, 20.0) > 1e-6);
}

TEST_CASE("a bet on rare chances wins by what is never reached and loses by what is reached often") {
  CHECK(wealth_of_bet(0.1, 0, 0) == Approx(1.0));
  CHECK(wealth_of_bet(0.1, 0, 1) == Approx((1.0 - 0.9 * 0.9) / 0.1));  // mean of 2(1 - u) over 0 … 0.1
  CHECK(wealth_of_bet(0.1, 0, 50) == Approx((1.0 - std::pow(0.9, 51)) / 0.1));
  CHECK(wealth_of_bet(0.1, 25, 50) < 1e-6);
}

TEST_CASE("wealth is a fair game: what the next draw may bring is on average what there is") {
  for (const std::size_t reached : {std::size_t{0}, std::size_t{1}, std::size_t{4}}) {
    const std::size_t drawn = 12;
    const double chance_of_one = (static_cast<double>(reached) + 1.0) / (static_cast<double>(drawn) + 2.0);
    const double next = chance_of_one * wealth_of_bet(0.1, reached + 1, drawn + 1) +
                        (1.0 - chance_of_one) * wealth_of_bet(0.1, reached, drawn + 1);
    CHECK(next == Approx(wealth_of_bet(0.1, reached, drawn)));
  }
}

TEST_CASE("values that differ by rounding keep the order that they had, all others are sorted") {
  using Named = std::pair<char, double>;
  for (const double rounding : {-1e-9, 0.0, 1e-9}) {
    std::vector<Named> list{{'a', 700.0}, {'b', 700.0 + rounding}, {'c', 900.0}, {'d', 700.0 - rounding}, {'e', 0.5}};
    sort_greatest_first(list, [](const Named& one) { return one.second; });
    std::string order;
    for (const Named& one : list) order += one.first;
    CHECK(order == "cabde");
  }
}
