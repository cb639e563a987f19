// Hidden cases: what is hidden is what docs/physics.md says, as large as asked for, and stays hidden.
#include <functional>
#include <map>
#include <numbers>
#include <set>

#include <nlohmann/json.hpp>

#include "modules/hidden_cases/tests/hidden_cases.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

/// What the hidden effects change in readings without noise.
std::vector<double> difference_made(const HiddenCase& c) {
  std::vector<DrawnEffect> all = c.base;
  for (const HiddenEffect& hidden : c.hidden) all.push_back(hidden.effect);
  const auto with = exact_errors(c.scene, all, {});
  const auto without = exact_errors(c.scene, c.base, {});
  std::vector<double> change;
  for (std::size_t k = 0; k < with.size(); ++k) change.push_back(with[k] - without[k]);
  return change;
}

/// One reading and the effect hidden in it, in the words of the formulas.
struct At {
  const Scene& scene;
  const DrawnEffect& effect;
  const Stop& stop;
  double operator[](const char* parameter) const { return effect.parameters.at(parameter); }
  [[nodiscard]] double place() const { return stop.position_mm[index_of(*effect.axis)]; }
  [[nodiscard]] double p() const { return place() - scene.machine.axes[index_of(*effect.axis)]->datum_mm; }
  [[nodiscard]] double d() const { return stop.axis == *effect.axis ? stop.approach : 0.0; }
  [[nodiscard]] double degC(const std::string& column, const Stop& at) const {
    for (std::size_t s = 0; s < scene.sensors.size(); ++s)
      if (scene.sensors[s] == column) return at.weather.degC[s];
    return 20.0;
  }
  /// Ciddor's and Edlén's equations agree to 1e-8 near 20 °C; a straight line is enough to 2 %.
  [[nodiscard]] double refraction() const {
    const double t = degC("t_air_degC", stop);
    return 1e-6 * (0.2683 * (stop.weather.pressure_hPa - 1013.25) - 0.93 * (t - 20.0) -
                   0.0087 * (stop.weather.humidity_pct - 50.0) * std::exp(0.06 * (t - 20.0)));
  }
};

using Formula = std::function<double(const At&)>;

/// docs/physics.md section 4, written down once more.
const std::map<std::string_view, Formula>& formulas() {
  using std::numbers::pi;
  static const std::map<std::string_view, Formula> all{
      {"offset", [](const At& a) { return a["um"]; }},
      {"scale", [](const At& a) { return a["um_per_m"] * a.p() * 1e-3; }},
      {"cyclic",
       [](const At& a) {
         if (a.effect.approach != Approach::unknown && a.d() != static_cast<int>(a.effect.approach)) return 0.0;
         return a["amplitude_um"] * std::sin(2 * pi * a.p() / a["period_mm"] + a["phase_rad"]) +
                a["amplitude2_um"] * std::sin(4 * pi * a.p() / a["period_mm"] + a["phase2_rad"]);
       }},
      {"backlash", [](const At& a) { return a["um"] * a.d() / 2; }},
      {"step", [](const At& a) { return a.p() > a["position_mm"] ? a["height_um"] : 0.0; }},
      {"sag",
       [](const At& a) {
         const double e = std::abs(a.p()) * 1e-3;
         return a["k2"] * e * e + a["k3"] * e * e * e;
       }},
      {"thermal_scale",
       [](const At& a) { return a["um_per_m_degC"] * a.p() * 1e-3 * (a.degC("t_material_degC", a.stop) - 20); }},
      {"thermal_drift",
       [](const At& a) {
         return a["um_per_degC"] * (a.degC(a.effect.sensor, a.stop) - a.degC(a.effect.sensor, a.scene.stops[0]));
       }},
      {"warm_up",
       [](const At& a) {
         return (a["c_um"] + a["c_um_per_m"] * a.p() * 1e-3) * (1 - std::exp(-a.stop.time_s / a["tau_s"]));
       }},
      {"time_drift", [](const At& a) { return a["um_per_h"] * a.stop.time_s / 3600; }},
      {"air_refraction", [](const At& a) { return a["factor"] * a.p() * 1e3 * a.refraction(); }},
      {"dead_path", [](const At& a) { return a["length_m"] * 1e6 * a.refraction(); }},
      {"cosine", [](const At& a) { return -a.p() * 1e3 * std::pow(a["angle_mrad"] * 1e-3, 2) / 2; }},
      {"servo_lag", [](const At& a) { return a["um_per_m_min"] * a.stop.feed_mm_min * 1e-3 * a.d(); }},
      {"load", [](const At& a) { return a.stop.load_kg * (a["um_per_kg"] + a["um_per_kg_m"] * a.p() * 1e-3); }},
      {"reversal_spike",
       [](const At& a) { return a["c_um"] * a.d() * std::exp(-a.stop.travel_since_reversal_mm / a["u0_mm"]); }},
  };
  return all;
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// Least squares by the normal equations and Gaussian elimination: what the columns leave of the values.
std::vector<double> left_of(std::vector<double> values, const std::vector<std::vector<double>>& columns) {
  const std::size_t n = columns.size();
  const auto product = [](const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
    return sum;
  };
  std::vector<std::vector<double>> m(n, std::vector<double>(n + 1));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) m[i][j] = product(columns[i], columns[j]);
    m[i][n] = product(columns[i], values);
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t r = 0; r < n; ++r) {
      if (r == i) continue;
      const double factor = m[r][i] / m[i][i];
      for (std::size_t j = i; j <= n; ++j) m[r][j] -= factor * m[i][j];
    }
  for (std::size_t k = 0; k < values.size(); ++k)
    for (std::size_t i = 0; i < n; ++i) values[k] -= m[i][n] / m[i][i] * columns[i][k];
  return values;
}

/// One column for an effect with a single size, by the formulas above.
std::vector<double> column_of(const Scene& scene, DrawnEffect effect, const char* size) {
  effect.parameters[size] = 1.0;
  std::vector<double> column;
  for (const Stop& stop : scene.stops)
    column.push_back(*effect.sense == stop.sense ? formulas().at(effect.kind->id)(At{scene, effect, stop}) : 0.0);
  return column;
}

/// Columns of a base model of offsets, scales, backlashes and drifts; nothing if it holds anything else.
std::optional<std::vector<std::vector<double>>> plain_columns(const HiddenCase& c) {
  const std::map<std::string_view, const char*> sizes{{"offset", "um"},
                                                      {"scale", "um_per_m"},
                                                      {"backlash", "um"},
                                                      {"thermal_scale", "um_per_m_degC"},
                                                      {"time_drift", "um_per_h"}};
  std::vector<std::vector<double>> columns;
  for (const DrawnEffect& effect : c.base) {
    const auto size = sizes.find(effect.kind->id);
    if (size == sizes.end()) return std::nullopt;
    columns.push_back(column_of(c.scene, effect, size->second));
  }
  return columns;
}

std::string written(const HiddenCase& c) {
  std::string all;
  for (const auto& [name, content] : files_of(c)) all += name + "\n" + content;
  return all;
}

}  // namespace

TEST_CASE("the same seed gives the same bytes, another seed others") {
  for (const CaseKind kind : {CaseKind::blank, CaseKind::single, CaseKind::pair, CaseKind::confounded}) {
    const std::string once = written(case_of(request_for(5, kind)));
    CHECK(written(case_of(request_for(5, kind))) == once);
    CHECK(written(case_of(request_for(6, kind))) != once);
  }
}

TEST_CASE("what is hidden adds to the readings what its formula says") {
  for (const auto& [kind, formula] : formulas()) {
    CAPTURE(kind);
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
      CAPTURE(seed);
      const HiddenCase c = case_of(request_for(seed, CaseKind::single, kind));
      const DrawnEffect& effect = only(c.hidden).effect;
      CHECK(effect.kind->id == kind);
      std::vector<double> wrong = difference_made(c);
      const double size = rms(wrong);
      for (std::size_t k = 0; k < wrong.size(); ++k)
        if (c.scene.stops[k].sense == *effect.sense) wrong[k] -= formula(At{c.scene, effect, c.scene.stops[k]});
      const bool air = kind == "air_refraction" || kind == "dead_path";
      CHECK(rms(wrong) < (air ? 0.05 : 1e-3) * size + 1e-3);  // exact matrices bend what is straight by less
      CHECK(c.hidden[0].rms_um == Approx(size).epsilon(1e-3));
    }
  }
}

TEST_CASE("a rotation acts through the levers that the exact matrices give its chain") {
  struct Row {
    const char* chain;
    Component code;
    Sense sense;
    std::size_t lever;
    int sign;
  };
  // docs/physics.md section 2, rows of the table checked by finite differences
  using enum Component;
  const std::vector<Row> rows{
      {"TXYZ", EBX, Sense::EX, 2, 1},  {"TXYZ", EBY, Sense::EX, 2, 1},  {"TXYZ", ECX, Sense::EX, 1, -1},
      {"TXYZ", EAX, Sense::EY, 2, -1}, {"TXYZ", EAY, Sense::EY, 2, -1}, {"TXYZ", EAX, Sense::EZ, 1, 1},
      {"XTYZ", EBX, Sense::EX, 2, 1},  {"XTYZ", EBY, Sense::EX, 2, 1},  {"XTYZ", ECX, Sense::EX, 1, -1},
      {"XTYZ", EAX, Sense::EY, 2, -1}, {"XTYZ", EAY, Sense::EY, 2, -1}, {"XTYZ", EAX, Sense::EZ, 1, 1},
      {"XYTZ", EBX, Sense::EX, 2, 1},  {"XYTZ", EBY, Sense::EX, 2, 1},  {"XYTZ", ECY, Sense::EY, 0, 1},
      {"XYTZ", EAX, Sense::EY, 2, -1}, {"XYTZ", EAY, Sense::EY, 2, -1}, {"XYTZ", EBY, Sense::EZ, 0, -1},
      {"XYZT", ECZ, Sense::EX, 1, -1}, {"XYZT", ECY, Sense::EY, 0, 1},  {"XYZT", ECZ, Sense::EY, 0, 1},
      {"XYZT", EAZ, Sense::EZ, 1, 1},  {"XYZT", EBY, Sense::EZ, 0, -1}, {"XYZT", EBZ, Sense::EZ, 0, -1}};
  std::set<std::string> seen;
  for (std::uint64_t seed = 1; seed <= 250; ++seed) {
    const HiddenCase c = case_of(request_for(seed, CaseKind::single, "angular"));
    for (const Row& row : rows) {
      const DrawnEffect& effect = c.hidden[0].effect;
      const Stop& first = c.scene.stops.front();
      if (c.scene.machine.configuration != row.chain || effect.code != row.code || first.sense != row.sense) continue;
      seen.insert(row.chain);
      const auto change = difference_made(c);
      const auto& line = c.scene.machine.axes[index_of(*effect.axis)]->measurement_line_mm[row.lever];
      for (std::size_t k = 0; k < change.size(); ++k) {
        const Stop& stop = c.scene.stops[k];
        const double lever_m = (stop.position_mm[row.lever] - line.value_or(0.0)) * 1e-3;
        const double angle = value_at(effect.curve, At{c.scene, effect, stop}.p());
        CHECK(change[k] == Approx(row.sign * angle * lever_m).epsilon(5e-3).scale(c.hidden[0].rms_um));
      }
    }
  }
  CHECK(seen.size() >= 2);
}

TEST_CASE("squareness tilts one axis against another with the signs of docs/physics.md") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const HiddenCase c = case_of(request_for(seed, CaseKind::single, "squareness"));
    const DrawnEffect& effect = c.hidden[0].effect;
    const auto change = difference_made(c);
    for (std::size_t k = 0; k < change.size(); ++k) {
      const Stop& stop = c.scene.stops[k];
      double expected = 0.0;
      if (effect.code == Component::C0Y && stop.sense == Sense::EX) expected = -stop.position_mm[1];
      if (effect.code == Component::B0Z && stop.sense == Sense::EX) expected = stop.position_mm[2];
      if (effect.code == Component::A0Z && stop.sense == Sense::EY) expected = -stop.position_mm[2];
      expected *= effect.parameters.at("um_per_m") * 1e-3;
      CHECK(change[k] == Approx(expected).epsilon(1e-3).scale(c.hidden[0].rms_um));
    }
  }
}

TEST_CASE("smooth curves leave mean and slope to other effects") {
  for (const std::string_view kind : {"progressive", "reversal_curve"}) {
    const HiddenCase c = case_of(request_for(4, CaseKind::single, kind));
    const DrawnEffect& effect = c.hidden[0].effect;
    double sum = 0.0, moment = 0.0, size = 0.0;
    for (const Stop& stop : c.scene.stops) {
      if (stop.sense != *effect.sense || (kind == "reversal_curve" && stop.axis != *effect.axis)) continue;
      const double value = value_at(effect.curve, At{c.scene, effect, stop}.p());
      sum += value;
      moment += value * stop.position_mm[index_of(*effect.axis)];
      size += std::abs(value) * (1.0 + std::abs(stop.position_mm[index_of(*effect.axis)]));
    }
    CHECK(std::abs(sum) < 1e-9 * size);
    CHECK(std::abs(moment) < 1e-9 * size);
  }
}

TEST_CASE("a fault of the unit changes the readings by what it makes of the map") {
  const auto in_map = [](const Scene& scene, const UnitTable& wanted, double p_mm, int approach) {
    for (const UnitTable& table : scene.map)
      if (table.axis == wanted.axis && table.sense == wanted.sense &&
          (table.approach == Approach::unknown || static_cast<int>(table.approach) == approach))
        return between_points(table.p_mm, table.value, p_mm);
    return 0.0;
  };
  for (const std::string_view kind : {"map_polarity", "map_gain", "map_shift", "map_direction_swap"}) {
    CAPTURE(kind);
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
      const HiddenCase c = case_of(request_for(seed, CaseKind::single, kind));
      const DrawnEffect& fault = c.hidden[0].effect;
      REQUIRE(!c.scene.map.empty());
      const auto change = difference_made(c);
      for (std::size_t k = 0; k < change.size(); ++k) {
        const Stop& stop = c.scene.stops[k];
        double expected = 0.0;
        for (const UnitTable& table : c.scene.map) {
          if (table.approach == Approach::reverse || table.sense != stop.sense) continue;
          if (fault.axis.value_or(table.axis) != table.axis || fault.sense.value_or(table.sense) != table.sense)
            continue;
          const double p_mm = stop.position_mm[index_of(table.axis)];
          const int way = table.axis == stop.axis ? stop.approach : 1;
          const double map = in_map(c.scene, table, p_mm, way);
          if (kind == "map_polarity") expected -= 2.0 * map;
          if (kind == "map_gain") expected += (fault.parameters.at("gain") - 1.0) * map;
          if (kind == "map_shift")
            expected += in_map(c.scene, table, p_mm + fault.parameters.at("shift_mm"), way) - map;
          if (kind == "map_direction_swap" && table.axis == stop.axis)
            expected += in_map(c.scene, table, p_mm, -way) - map;
        }
        CHECK(change[k] == Approx(expected).epsilon(1e-6).scale(1.0));
      }
    }
  }
}

TEST_CASE("the signal to noise asked for is what an independent least squares finds") {
  int checked = 0;
  for (const std::string_view kind : {"time_drift", "step", "thermal_scale", "cyclic", "backlash", "dead_path"})
    for (std::uint64_t seed = 1; seed <= 15; ++seed) {
      HiddenCaseRequest request = request_for(seed, CaseKind::single, kind);
      request.snr = 2.5;
      const HiddenCase c = case_of(request);
      const auto columns = plain_columns(c);
      if (!columns) continue;
      CAPTURE(seed);
      CAPTURE(kind);
      const double left_um = rms(left_of(difference_made(c), *columns));
      CHECK(left_um / c.noise.sigma_um == Approx(2.5).epsilon(0.005));
      CHECK(left_um * left_um >= 0.04 * c.hidden[0].rms_um * c.hidden[0].rms_um);  // never all but absorbed
      ++checked;
    }
  CHECK(checked >= 15);
}

TEST_CASE("the noise of a reading is what the truth says") {
  int counted = 0;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const HiddenCase c = case_of(request_for(seed, CaseKind::blank));
    if (c.noise.outlier_probability > 0.0) continue;
    std::vector<double> noise = exact_errors(c.scene, c.base, {});
    for (std::size_t k = 0; k < noise.size(); ++k) noise[k] = (noise[k] - c.readings[k]) / c.noise.sigma_um;
    sum += std::pow(rms(noise), 2);
    ++counted;
  }
  CHECK(counted >= 30);
  CHECK(sum / counted == Approx(1.0).epsilon(0.1));
}

TEST_CASE("every law of noise has the size that the truth says, and its own marks") {
  for (const NoiseLaw law : {NoiseLaw::white, NoiseLaw::rounded, NoiseLaw::doubled, NoiseLaw::heavy_tails,
                             NoiseLaw::slow, NoiseLaw::by_run}) {
    CAPTURE(kNoiseLaws.of(law));
    double sum = 0.0;
    constexpr int kCases = 12;
    for (std::uint64_t seed = 1; seed <= kCases; ++seed) {
      HiddenCaseRequest request = request_for(seed, CaseKind::blank);
      request.noise = law;
      const HiddenCase c = case_of(request);
      std::vector<double> noise = exact_errors(c.scene, c.base, {});
      for (std::size_t k = 0; k < noise.size(); ++k) noise[k] = (noise[k] - c.readings[k]) / c.noise.sigma_um;
      sum += std::pow(rms(noise), 2) / kCases;
      if (law == NoiseLaw::slow) CHECK(c.scene.stops.back().run == 1);
      if (law == NoiseLaw::by_run) CHECK(c.scene.stops.back().run >= 5);
      if (law == NoiseLaw::rounded) CHECK(1.0 / c.noise.per_unit > c.noise.sigma_um);
      for (std::size_t k = 0; law == NoiseLaw::doubled && k < c.readings.size(); k += 2)
        CHECK(c.readings[k] == c.readings[k + 1]);
    }
    CHECK(sum == Approx(law == NoiseLaw::rounded ? 1.7 : 1.0).epsilon(0.45));
  }
}

TEST_CASE(
    "a free base model gives no period, place or time constant, and any effect but a fault of the map is in one") {
  std::set<std::string> held;
  for (std::uint64_t seed = 1; seed <= 80; ++seed) {
    HiddenCaseRequest request = request_for(seed, CaseKind::single);
    request.free_base = true;
    const HiddenCase c = case_of(request);
    CHECK(!contains(files_of(c).at("model.toml"), "parameters"));
    for (const DrawnEffect& effect : c.base) held.emplace(effect.kind->id);
  }
  for (const char* id : {"cyclic", "progressive", "warm_up", "reversal_spike", "step", "cosine", "thermal_bend"})
    CHECK_MESSAGE(held.contains(id), id);
  CHECK(held.size() >= 18);
}

TEST_CASE("every effect of the library can be hidden, alone and in company") {
  for (const EffectDefinition& effect : effects()) {
    CAPTURE(effect.id);
    CHECK(case_of(request_for(11, CaseKind::single, effect.id)).hidden.at(0).effect.kind == &effect);
    const HiddenCase pair = case_of(request_for(11, CaseKind::pair, effect.id));
    REQUIRE(pair.hidden.size() == 2);
    CHECK((pair.hidden[0].effect.kind == &effect || pair.hidden[1].effect.kind == &effect));
    CHECK(pair.hidden[0].snr >= pair.hidden[1].snr);
  }
}

TEST_CASE("no base model holds what is hidden") {
  for (std::uint64_t seed = 1; seed <= 40; ++seed)
    for (const CaseKind kind : {CaseKind::single, CaseKind::pair}) {
      const HiddenCase c = case_of(request_for(seed, kind));
      for (const HiddenEffect& hidden : c.hidden)
        for (const DrawnEffect& known : c.base) CHECK(name_of(known) != name_of(hidden.effect));
    }
}

TEST_CASE("of a confounded design the truth names all that do the same") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const HiddenCase c = case_of(request_for(seed, CaseKind::confounded));
    CAPTURE(c.text);
    const std::set<std::string> group(c.group.begin(), c.group.end());
    CHECK(group.size() >= 2);
    CHECK(group.contains(name_of(c.hidden.at(0).effect)));
    const bool one_feed = group.contains("servo_lag:X:EX");
    if (one_feed) CHECK(group == std::set<std::string>{"backlash:X:EX", "servo_lag:X:EX"});
  }
}

TEST_CASE("structure that is in no library says on which columns it depends") {
  std::set<std::string> kinds;
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    const HiddenCase c = case_of(request_for(seed, CaseKind::out_of_library));
    CHECK(c.hidden.empty());
    kinds.insert(c.structure.text);
    REQUIRE(!c.structure.variables.empty());
    const std::string data = files_of(c).at("data.csv");
    for (const std::string& name : c.structure.variables) CHECK_MESSAGE(contains(data, name), name);
  }
  CHECK(kinds.size() >= 6);
  CHECK(structures().size() == 30);
}

TEST_CASE("structure that falls between the stops is drawn again") {
  HiddenCaseRequest request;
  request.seed = 7840065;  // a crane that comes and goes within pauses
  request.kind = CaseKind::out_of_library;
  request.snr = 3.0;
  request.free_base = true;
  const HiddenCase c = case_of(request);
  CHECK(rms(c.structure.value) > 0.0);
  for (const double reading : c.readings) REQUIRE(std::isfinite(reading));
}

TEST_CASE("on an XYTZ machine the yaw of Y does not enter equation (27)") {
  HiddenCaseRequest request;
  request.xytz = true;
  const HiddenCase c = case_of(request);
  CHECK(c.scene.machine.configuration == "XYTZ");
  CHECK(name_of(c.hidden.at(0).effect) == "angular:Y:ECY");
  for (const Stop& stop : c.scene.stops) CHECK(stop.sense == Sense::EY);
}

TEST_CASE("a turned set-up is hidden where asked for, in both senses of its plane") {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    CAPTURE(seed);
    const HiddenCase c = case_of(request_for(seed, CaseKind::single, "set_up_rotation"));
    const DrawnEffect& effect = c.hidden.at(0).effect;
    const Axis about = direction_of(*effect.sense);
    const auto one = static_cast<Axis>((index_of(about) + 1) % kAxes);
    const auto other = static_cast<Axis>((index_of(about) + 2) % kAxes);
    const auto values = contribution(c.scene, effect);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const Stop& stop = c.scene.stops[k];
      const double c_um_per_mm = effect.parameters.at("um_per_m") / 1000.0;
      double expected = 0.0;
      if (stop.sense == static_cast<Sense>(one)) expected = -c_um_per_mm * c.scene.p_mm(stop, other);
      if (stop.sense == static_cast<Sense>(other)) expected = c_um_per_mm * c.scene.p_mm(stop, one);
      REQUIRE(values[k] == Approx(expected));
    }
    const auto truth = nlohmann::json::parse(truth_of(c));
    CHECK(truth["effects"][0]["name"] == name_of(effect));
    CHECK(truth["effects"][0]["code"] == name_of(*effect.sense));
    CHECK(truth["effects"][0]["sense"].is_null());
  }
}

TEST_CASE("a thermal bend is hidden where asked for, as its formula says, and drawn nowhere else") {
  const auto& drawn = drawn_effects();
  CHECK(std::find(drawn.begin(), drawn.end(), effect_named("thermal_bend")) == drawn.end());
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u}) {
    CAPTURE(seed);
    const HiddenCase c = case_of(request_for(seed, CaseKind::single, "thermal_bend"));
    const DrawnEffect& effect = c.hidden.at(0).effect;
    CHECK(effect.sensor != effect.sensor2);
    CHECK(static_cast<std::size_t>(*effect.sense) != index_of(*effect.axis));
    const auto values = contribution(c.scene, effect);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const Stop& stop = c.scene.stops[k];
      const double p_m = c.scene.p_mm(stop, *effect.axis) * 1e-3;
      const double difference_degC =
          stop.weather.degC[*c.scene.sensor(effect.sensor)] - stop.weather.degC[*c.scene.sensor(effect.sensor2)];
      const double expected =
          stop.sense == *effect.sense ? effect.parameters.at("um_per_m2_degC") * p_m * p_m * difference_degC : 0.0;
      REQUIRE(values[k] == Approx(expected));
    }
    const auto truth = nlohmann::json::parse(truth_of(c));
    CHECK(truth["effects"][0]["name"] == name_of(effect));
    CHECK(truth["effects"][0]["sensor2"] == effect.sensor2);
  }
}

TEST_CASE("every effect says how it is hidden, in the order of the list, and what it adds where the machine does not") {
  REQUIRE(hidings().size() == effects().size());
  for (const EffectDefinition& kind : effects()) {
    const Hiding& hiding = hiding_of(kind);
    CAPTURE(kind.id);
    CHECK(hiding.id == kind.id);
    CHECK((kind.value != nullptr || hiding.adds != nullptr) != (hiding.seat == Seat::unit));
    CHECK((hiding.spoil != nullptr) == (hiding.seat == Seat::unit));
    CHECK((hiding.search != nullptr) != hiding.searched.empty());
    CHECK(hiding.range.above < hiding.range.below);
    if (hiding.draw == nullptr) CHECK(kind.parameters.size() <= 1);
    if (!hiding.line.empty()) CHECK(effect_named(hiding.line) != nullptr);
    for (std::string_view name : hiding.sizes)
      CHECK(std::any_of(kind.parameters.begin(), kind.parameters.end(), [&](const auto& p) { return p.name == name; }));
  }
}

TEST_CASE("what spans an effect spans what is drawn of it, and a contribution grows with the effect") {
  for (const EffectDefinition* kind : drawn_effects()) {
    CAPTURE(kind->id);
    const HiddenCase c = case_of(request_for(21, CaseKind::single, kind->id));
    const DrawnEffect& effect = c.hidden.at(0).effect;
    const Ground ground = ground_of(c.scene);
    CHECK(!unit_effects(ground, effect).empty());
    for (const DrawnEffect& unit : unit_effects(ground, effect))
      for (const double value : contribution(c.scene, unit)) REQUIRE(std::isfinite(value));
    if (hiding_of(*kind).seat == Seat::unit) continue;
    const auto once = contribution(c.scene, effect), thrice = contribution(c.scene, scaled(effect, 3.0));
    for (std::size_t k = 0; k < once.size(); ++k) REQUIRE(thrice[k] == Approx(3.0 * once[k]));
  }
}
