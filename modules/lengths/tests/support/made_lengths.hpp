// Machines whose components are known, and lengths computed from them by the term table of core/ alone.
#pragma once

#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "base/random.hpp"
#include "core/terms.hpp"
#include "modules/lengths/identify.hpp"
#include "tests/support/test.hpp"

namespace ecs::test {

/// Three short axes, datum at the lower ends.
inline params::Machine length_test_machine(const std::string& configuration) {
  params::Machine machine{.name = "made", .configuration = configuration};
  const Vector3 spans{500.0, 400.0, 300.0};
  for (std::size_t a = 0; a < kAxes; ++a) {
    params::MachineAxis axis{.travel_mm = {0.0, spans[a]}, .datum_mm = 0.0};
    for (std::size_t o = 0; o < kAxes; ++o)
      if (o != a) axis.measurement_line_mm[o] = 0.0;
    machine.axes[a] = axis;
  }
  return machine;
}

/// Curves under the convention of modules/lengths/curves.hpp that cubic splines hold exactly: zero at the datum, a
/// straightness symmetric about the middle, so without slope.
struct MadeComponents {
  explicit MadeComponents(unsigned seed) {
    std::mt19937 generator(seed);
    NormalDraws normal;
    for (auto& one : form)
      for (double& number : one) number = 5.0 * normal(generator);
    for (double& number : square) number = 20.0 * normal(generator);
  }
  std::array<std::array<double, 4>, kCurves> form{};
  std::array<double, 3> square{};
  bool reversal = true;
  /// Of one component, beside its form: a wave, zero at the datum and without slope.
  struct Wave {
    Component of = Component::EXY;
    double um = 0.0, parts = 1.0, phase_rad = 0.0;  ///< amplitude; length as a part of the travel
    [[nodiscard]] double at(double part) const {
      const double per_part = 2.0 * std::numbers::pi / parts;
      const auto wave = [&](double p) { return std::sin(per_part * p + phase_rad); };
      // least squares: 12 ∫ (p − 1/2) wave dp
      const double ends = -0.5 * (std::cos(per_part + phase_rad) + std::cos(phase_rad)) / per_part +
                          (wave(1.0) - wave(0.0)) / (per_part * per_part);
      return um * (wave(part) - wave(0.0) - 12.0 * ends * part);
    }
  };
  std::optional<Wave> wave;

  [[nodiscard]] double value(Component c, double part, int approach) const {
    if (is_squareness(c)) return square[index_of(c) - kCurves];
    const auto& f = form[index_of(c)];
    const double even = is_straightness(c) ? f[0] * part * (1.0 - part) : f[0] * part + f[1] * part * part * part;
    const double fine = wave && wave->of == c ? wave->at(part) : 0.0;
    return even + fine + (reversal ? 0.5 * approach * (0.3 * f[2] + 0.2 * f[3] * (2.0 * part - 1.0)) : 0.0);
  }
  [[nodiscard]] Vector3 error_um(const params::Machine& machine, const Vector3& p, const PerAxis<int>& approach,
                                 const Vector3& tool) const {
    ComponentValues values{};
    for (std::size_t c = 0; c < kComponents; ++c) {
      const auto component = static_cast<Component>(c);
      const std::size_t a = is_squareness(component) ? 0 : index_of(moving_axis(component));
      const auto& travel = machine.axes[a]->travel_mm;
      values[c] = value(component, (p[a] - travel[0]) / (travel[1] - travel[0]), approach[a]);
    }
    return tool_error_um(*terms_of(*params::chain_of(machine), Convention::iso, CurveKind::measured), values, p,
                         params::measurement_lines_of(machine), tool);
  }
};

/// Lines through the volume, there and back, from every set-up with every tool.
struct MadeLengths {
  model::LengthTest test;
  params::Machine machine;

  explicit MadeLengths(const std::string& configuration) : machine(length_test_machine(configuration)) {
    test.source = "made.csv";
    test.configuration = configuration;
    for (auto& knots : test.knots_mm) knots = 200.0;
  }
  void line(std::size_t set_up, std::size_t tool, const Vector3& a, const Vector3& b, int targets, int run = 1) {
    for (const int sense : {1, -1})
      for (int i = 0; i < targets; ++i) {
        model::LengthReading reading{
            .line = static_cast<int>(test.readings.size()) + 10, .set_up = set_up, .tool = tool, .run = run};
        const double part = (sense > 0 ? i : targets - 1 - i) / (targets - 1.0);
        for (std::size_t k = 0; k < kAxes; ++k) {
          reading.position_mm[k] = std::lerp(a[k], b[k], part);
          reading.approach[k] = a[k] == b[k] ? 1 : (b[k] > a[k] ? sense : -sense);
        }
        test.readings.push_back(reading);
      }
  }
  /// Edges and body diagonals.
  void volume(std::size_t set_up, std::size_t tool, int targets, int run = 1) {
    const auto corner = [](int bits) {
      return Vector3{(bits & 1) != 0 ? 500.0 : 0.0, (bits & 2) != 0 ? 400.0 : 0.0, (bits & 4) != 0 ? 300.0 : 0.0};
    };
    for (int axis = 0; axis < 3; ++axis)
      for (int bits = 0; bits < 8; ++bits)
        if ((bits & (1 << axis)) == 0) line(set_up, tool, corner(bits), corner(bits | (1 << axis)), targets, run);
    for (int bits = 0; bits < 4; ++bits) line(set_up, tool, corner(bits), corner(7 - bits), targets, run);
  }
  /// Four stations about the volume, three tools.
  void stations(int targets) {
    test.tools = {{"A", {0, 0, 0}}, {"B", {0, 0, -200}}, {"C", {120, 0, -90}}};
    const std::vector<Vector3> places{{-150, -130, -260}, {640, -120, -240}, {620, 510, -250}, {-140, 520, 150}};
    for (std::size_t s = 0; s < places.size(); ++s) {
      test.set_ups.push_back({"S" + std::to_string(s + 1), model::LengthInstrument::tracker, places[s], 0});
      for (std::size_t t = 0; t < test.tools.size(); ++t) volume(s, t, targets);
    }
  }
  /// What every translation and every angle of a carriage keeps from its last stop, standard deviations.
  double stop_um = 0.0, stop_um_per_m = 0.0;

  /// Fills in the deviations. @param noise_um  white
  void measure(const MadeComponents& made, double noise_um = 0.0, unsigned seed = 1,
               const Vector3& station_off_mm = {0.2, -0.1, 0.15}) {
    std::mt19937 generator(seed);
    NormalDraws normal;
    ComponentValues stop{};
    const model::LengthReading* before = nullptr;
    for (model::LengthReading& r : test.readings) {
      const model::LengthSetUp& set_up = test.set_ups[r.set_up];
      const Vector3& tool = test.tools[r.tool].offset_mm;
      Vector3 error = made.error_um(machine, r.position_mm, r.approach, tool);
      for (std::size_t c = 0; c < kCurves && stop_um + stop_um_per_m > 0.0; ++c) {
        const std::size_t a = index_of(moving_axis(static_cast<Component>(c)));
        const bool parked = before != nullptr && before->set_up == r.set_up && before->tool == r.tool &&
                            before->position_mm[a] == r.position_mm[a] && before->approach[a] == r.approach[a];
        if (!parked) stop[c] = (is_angular(static_cast<Component>(c)) ? stop_um_per_m : stop_um) * normal(generator);
      }
      const Vector3 off = tool_error_um(*terms_of(*params::chain_of(machine), Convention::iso, CurveKind::carriage),
                                        stop, r.position_mm, params::measurement_lines_of(machine), tool);
      for (std::size_t a = 0; a < kAxes; ++a) error[a] += off[a];
      before = &r;
      const Vector3 point = model::point_of(test, r);
      if (set_up.instrument == model::LengthInstrument::interferometer) {
        r.deviation_um = 7.0 + 3.0 * r.run;
        for (std::size_t a = 0; a < kAxes; ++a) r.deviation_um += set_up.place[a] * error[a];
      } else {
        Vector3 nominal{}, actual{};
        for (std::size_t a = 0; a < kAxes; ++a) {
          nominal[a] = point[a] - set_up.place[a];
          actual[a] = nominal[a] + error[a] / 1000.0 - station_off_mm[a];
        }
        r.deviation_um = (test.bar_um ? 0.5 : 30.0) + 1000.0 * (std::hypot(actual[0], actual[1], actual[2]) -
                                                                std::hypot(nominal[0], nominal[1], nominal[2]));
      }
      if (noise_um > 0.0) r.deviation_um += noise_um * normal(generator);
    }
  }
};

inline model::Identification identified(const MadeLengths& made, const model::IdentifySettings& settings) {
  return must(model::identify(made.test, made.machine, settings));
}

/// The largest difference of a determined value from the true one, um or um/m.
inline double farthest_from(const model::Identification& found, const MadeComponents& made,
                            const params::Machine& machine) {
  double most = 0.0;
  for (const model::IdentifiedCurve& curve : found.curves) {
    if (!curve.determined) continue;
    const auto& travel = machine.axes[index_of(moving_axis(curve.component))]->travel_mm;
    for (std::size_t i = 0; i < curve.position_mm.size(); ++i) {
      const double part = (curve.position_mm[i] - travel[0]) / (travel[1] - travel[0]);
      most = std::max(most, std::abs(curve.forward[i] - made.value(curve.component, part, 1)));
      most = std::max(most, std::abs(curve.reverse[i] - made.value(curve.component, part, -1)));
    }
  }
  for (const auto& square : found.squareness)
    if (square.determined) most = std::max(most, std::abs(square.um_per_m - made.value(square.component, 0.0, 0)));
  return most;
}

}  // namespace ecs::test
