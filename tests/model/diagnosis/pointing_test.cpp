// Another program's fits as oracle: telescope pointing tests with published models (TPOINT), as user effects.
#include <numbers>
#include <sstream>

#include "base/file.hpp"
#include "base/text.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/real_data.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

/// Numbers of a line up to a comment; empty if it is no line of numbers.
std::vector<double> numbers_of(std::string_view line) {
  std::istringstream words{std::string(line.substr(0, line.find('!')))};
  std::vector<double> numbers;
  std::string word;
  while (words >> word) {
    const auto number = number_in(word);
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

/// EX = ΔA cos E, EY = ΔE in arc seconds; az and alt in degrees as columns of their own.
laser::MeasurementSet pointing(const std::string& text) {
  laser::MeasurementSet set;
  for (const std::string_view line : lines_of(text)) {
    const auto n = numbers_of(line);
    if (n.size() < 4) continue;
    const double turn = std::remainder(n[2] - n[0], 360.0);
    for (const Sense sense : {Sense::EX, Sense::EY}) {
      Reading r{.row = static_cast<int>(set.readings.size()) + 1,
                .sense = sense,
                .error = 3600.0 * (sense == Sense::EX ? turn * std::cos(n[1] * std::numbers::pi / 180.0) : n[3] - n[1]),
                .run = 1,
                .extras = {{"az", n[0]}, {"alt", n[1]}}};
      set.readings.push_back(r);
    }
  }
  return set;
}

EffectInstance term(const std::string& name, const char* ex, const char* ey) {
  EffectInstance one{.id = effects::user, .name = name};
  if (ex != nullptr) one.formulas.push_back({Sense::EX, ex});
  if (ey != nullptr) one.formulas.push_back({Sense::EY, ey});
  one.user = {{name, "arcsec", {}, {}, {}, {}}};
  return one;
}

/// The six terms, with D = mount − desired (the folder's SOURCE.md).
Model six_terms() {
  Model model;
  model.effects = {term("IA", "IA*cos(alt*pi/180)", nullptr),
                   term("IE", nullptr, "-IE"),
                   term("AN", "AN*sin(az*pi/180)*sin(alt*pi/180)", "AN*cos(az*pi/180)"),
                   term("AW", "AW*cos(az*pi/180)*sin(alt*pi/180)", "-AW*sin(az*pi/180)"),
                   term("CA", "CA", nullptr),
                   term("PZZ1", nullptr, "PZZ1*(90-alt)*pi/180")};
  return model;
}

struct Published {
  int observations = 0;
  double rms = 0.0;
  std::map<std::string, double> coefficients;
};
Published published(const std::string& text) {
  Published model;
  for (const std::string_view line : lines_of(text)) {
    std::istringstream words{std::string(line)};
    std::string name;
    double a = 0.0, b = 0.0;
    if (!(words >> name >> a >> b)) continue;
    if (name == "T") {
      model.observations = static_cast<int>(a);
      model.rms = b;
    } else {
      model.coefficients[name] = a;
    }
  }
  return model;
}

}  // namespace

TEST_CASE("six pointing terms come out as another program published them, where it dropped no observation") {
  SKIP_UNLESS(!real_data("tpoint-apo35m").empty(), kNoRealData);
  int compared = 0;
  for (const auto& entry : std::filesystem::directory_iterator(real_data("tpoint-apo35m"))) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("telmod_")) continue;
    const auto text = read_file(entry.path());
    const auto data_text = read_file(real_data("tpoint-apo35m") / ("ptdata_" + name.substr(7)));
    if (!text || !data_text) continue;
    const Published theirs = published(*text);
    const auto set = pointing(*data_text);
    if (static_cast<int>(set.readings.size()) != 2 * theirs.observations) continue;
    const Model model = six_terms();
    const auto ours = must(fit(model, observations_of(set, model, std::nullopt), {true}));
    for (const EffectFit& effect : ours.effects) {
      INFO(name, " ", effect.effect.name);
      REQUIRE(theirs.coefficients.contains(effect.effect.name));
      CHECK(std::abs(effect.parameters[0].value - theirs.coefficients.at(effect.effect.name)) < 0.2);
    }
    CHECK(std::abs(ours.rms_um * std::numbers::sqrt2 - theirs.rms) < 0.01);
    ++compared;
  }
  CHECK(compared >= 1);
  MESSAGE("compared with ", compared, " published models");
}

TEST_CASE("a pointing term that is left out is found among the candidates offered") {
  SKIP_UNLESS(!real_data("tpoint-apo35m").empty(), kNoRealData);
  const auto data_text = must(read_file(real_data("tpoint-apo35m/ptdata_2015-04-03T07-33-39.5.dat")));
  Model model = six_terms();
  model.candidates = {model.effects[2], model.effects[3], model.effects[4]};
  model.effects.erase(model.effects.begin() + 2);
  const auto found = must(diagnose(model, observations_of(pointing(data_text), model, std::nullopt)));
  REQUIRE_FALSE(found.candidates.empty());
  CHECK(to_text(found.candidates.front().effect) == "user:AN");
}
