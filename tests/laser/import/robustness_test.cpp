// Whatever the file holds, reading it ends in a Result: every sample is spoiled at random thousands of times.
#include <random>

#include "base/random.hpp"
#include "base/text.hpp"
#include "laser/analysis/iso230.hpp"
#include "laser/analysis/process.hpp"
#include "laser/import/import.hpp"
#include "tests/support/readings.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

constexpr int kMutationsPerFile = 400;

std::size_t below(std::mt19937& random, std::size_t limit) {
  return limit == 0 ? 0 : one_of(random, static_cast<std::uint32_t>(limit));
}

std::string without_a_line(const std::string& text, std::mt19937& random) {
  const std::size_t at = below(random, text.size());
  const std::size_t begin = text.rfind('\n', at);
  const std::size_t end = text.find('\n', at);
  std::string cut = text;
  const std::size_t from = begin == std::string::npos ? 0 : begin;
  cut.erase(from, (end == std::string::npos ? text.size() : end) - from);
  return cut;
}

std::string spoiled(std::string text, std::mt19937& random) {
  if (text.empty()) return text;
  switch (below(random, 5)) {
    case 0:
      text.resize(below(random, text.size()));
      return text;
    case 1:
      for (std::size_t n = 1 + below(random, 4); n > 0; --n)
        text[below(random, text.size())] = static_cast<char>(below(random, 256));
      return text;
    case 2:
      return without_a_line(text, random);
    case 3:
      text.insert(below(random, text.size()), text.substr(below(random, text.size()), below(random, 60)));
      return text;
    default: {
      constexpr const char* kNasty[] = {
          "1e308", "-1e308", "nan", "99999999999999999999", "-", "\"", ",", "::", "1e-320", "=", "[", "0"};
      text.insert(below(random, text.size()), kNasty[below(random, 12)]);
      return text;
    }
  }
}

std::vector<ImportOptions> ways() {
  ImportOptions plain;
  ImportOptions linear{.axis = Axis::X, .accept_truncated = true};
  ImportOptions angular = linear;
  angular.sense = Sense::EB;
  ImportOptions straight = linear;
  straight.sense = Sense::EY;
  straight.encoding = Encoding::gbk;
  return {plain, linear, angular, straight};
}

/// Everything that can follow reading; results may be refusals, never a crash.
int evaluations(const MeasurementSet& set) {
  int done = 0;
  for (const Group& group : groups_of(set)) {
    done += iso230_of(set, group).has_value() ? 1 : 0;
    const auto curve = averaged(set, group);
    if (!curve) continue;
    Smoothing how;
    how.window_points = 5;
    done += smoothed(*curve, how).has_value() ? 1 : 0;
    done += levelled(*curve, SlopeMethod::least_squares).has_value() ? 1 : 0;
    done += zeroed_at(*curve, 0.0).has_value() ? 1 : 0;
    done += squareness_of(*curve).has_value() ? 1 : 0;
    done += rotation_from(*curve, *curve).has_value() ? 1 : 0;
  }
  return done;
}

bool is_finite(const MeasurementSet& set) {
  return std::all_of(set.readings.begin(), set.readings.end(), [](const Reading& r) {
    return std::isfinite(r.error) && std::isfinite(r.position_mm[0]) && std::isfinite(r.position_mm[1]) &&
           std::isfinite(r.position_mm[2]);
  });
}

}  // namespace

TEST_CASE("corrupted files give a set of finite numbers or a refusal with a message") {
  std::mt19937 random(20240506);
  std::vector<std::filesystem::path> files;
  for (const char* folder : {"samples/laser", "tests/data/laser"})
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (entry.path().extension() != ".md") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  REQUIRE(files.size() > 15);
  int read = 0;
  int refused = 0;
  for (const auto& path : files) {
    const auto whole = must(read_file(path));
    for (int i = 0; i < kMutationsPerFile; ++i) {
      const std::string text = i == 0 ? whole : spoiled(whole, random);
      for (const ImportOptions& options : ways()) {
        const auto result = parse_any(text, path.string(), options);
        if (result) {
          ++read;
          REQUIRE_MESSAGE(is_finite(result->set), path.string());
          REQUIRE(evaluations(result->set) >= 0);
        } else {
          ++refused;
          REQUIRE_FALSE(result.error().message.empty());
          REQUIRE(result.error().also.size() <= 20);
        }
      }
    }
  }
  CHECK(read > 1000);
  CHECK(refused > 1000);
}
