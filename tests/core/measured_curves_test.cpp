// The whole way round on machines whose workpiece moves: the exact machine is measured along its lines, the curves
// become a map, the unit compensates, the exact machine shows what is left.
#include <memory>

#include "core/tick.hpp"
#include "tests/core/support/image_of.hpp"
#include "tests/support/exact_machine.hpp"
#include "tests/support/random_values.hpp"

using namespace ecs;
using namespace ecs::test;

namespace {

constexpr Vector3 kLine_mm{-400.0, -300.0, -200.0};  // where the other axes stand while one is measured
constexpr double kTravel_mm = 1000.0;                // of every axis, −1000 … 0

/// Smooth errors of each carriage, zero on the measurement line: 40 um of translation, 100 um/m of rotation.
MachineErrors errors_at(const Vector3& position_mm, double size) {
  MachineErrors errors;
  for (std::size_t c = 0; c < kCurves; ++c) {
    const auto component = static_cast<Component>(c);
    const std::size_t a = index_of(moving_axis(component));
    const double phase = 0.7 * static_cast<double>(c);
    const auto curve = [&](double p_mm) { return std::sin(p_mm / 250.0 + phase) + p_mm / 2000.0; };
    const double largest = is_angular(component) ? 100.0 : 40.0;
    errors.values[c] = size * largest * (curve(position_mm[a]) - curve(kLine_mm[a]));
  }
  errors.lines_mm = {kLine_mm, kLine_mm, kLine_mm};
  return errors;
}

/// What laser and levels show along `axis` with the others on the measurement line, squareness taken out.
ComponentValues measured_at(const std::string& chain, Axis axis, double p_mm, double size) {
  Vector3 pose_mm = kLine_mm;
  pose_mm[index_of(axis)] = p_mm;
  const MachineErrors errors = errors_at(pose_mm, size);
  const Vector3 seen_um = exact_error_um(chain, errors, pose_mm);
  ComponentValues values{};
  for (const Sense s : {Sense::EX, Sense::EY, Sense::EZ})
    values[index_of(curve_of(s, axis))] = seen_um[index_of(direction_of(s))];
  for (const Sense s : {Sense::EA, Sense::EB, Sense::EC})
    values[index_of(curve_of(s, axis))] = errors.values[index_of(curve_of(s, axis))];
  return values;
}

ComponentValues measured_at(const std::string& chain, const Vector3& position_mm, double size) {
  ComponentValues values{};
  for (const Axis a : kAllAxes) {
    const ComponentValues one = measured_at(chain, a, position_mm[index_of(a)], size);
    for (std::size_t s = 0; s < 6; ++s) values[index_of(a) * 6 + s] = one[index_of(a) * 6 + s];
  }
  return values;
}

/// Error of the exact machine less what the model makes of the measured curves: the largest over a grid of poses.
double left_um(const std::string& chain, CurveKind kind, double size) {
  const TermTable terms = *terms_of(*chain_of(chain), Convention::iso, kind);
  double worst_um = 0.0;
  for (double x = -950.0; x < 0.0; x += 300.0)
    for (double y = -950.0; y < 0.0; y += 300.0)
      for (double z = -950.0; z < 0.0; z += 300.0) {
        const Vector3 pose_mm{x, y, z};
        const MachineErrors errors = errors_at(pose_mm, size);
        const Vector3 real = exact_error_um(chain, errors, pose_mm);
        const Vector3 model = tool_error_um(terms, measured_at(chain, pose_mm, size), pose_mm, errors.lines_mm, {});
        for (std::size_t o = 0; o < kAxes; ++o) worst_um = std::max(worst_um, std::abs(real[o] - model[o]));
      }
  return worst_um;
}

}  // namespace

TEST_CASE("compensating with measured curves leaves second order only, on every configuration") {
  for (const std::string chain : {"TXYZ", "XTYZ", "XYTZ", "XYZT"}) {
    CAPTURE(chain);
    const double whole_um = left_um(chain, CurveKind::measured, 1.0);
    const double half_um = left_um(chain, CurveKind::measured, 0.5);
    CHECK(whole_um < 0.5);
    CHECK(half_um < 0.27 * whole_um);
  }
}

TEST_CASE("taking measured curves for the carriage's own compensates twice: tens of um where the workpiece moves") {
  CHECK(left_um("TXYZ", CurveKind::carriage, 1.0) < 0.5);  // the moving-column mill never shows it
  for (const std::string chain : {"XTYZ", "XYTZ", "XYZT"}) {
    CAPTURE(chain);
    CHECK(left_um(chain, CurveKind::carriage, 1.0) > 20.0);
  }
}

TEST_CASE(
    "measured, stored in an image, compiled and put out, the map leaves about one resolution of the machine's error") {
  constexpr double kStep_mm = 10.0;
  constexpr double kResolution = 0.02;
  const Vector3 squareness{30.0, -40.0, 50.0};
  for (const std::string chain : {"TXYZ", "XTYZ", "XYTZ", "XYZT"}) {
    CAPTURE(chain);
    UnitParameters p;
    set_configuration(p, chain);
    p.C0Y_um_per_m = squareness[0];
    p.B0Z_um_per_m = squareness[1];
    p.A0Z_um_per_m = squareness[2];
    p.measurement_lines_mm = {kLine_mm, kLine_mm, kLine_mm};
    std::vector<PlannedTable> tables;
    for (std::size_t c = 0; c < kCurves; ++c) {
      const auto component = static_cast<Component>(c);
      PlannedTable table{component, Approach::unknown, -kTravel_mm, kStep_mm, kResolution, {}};
      for (double p_mm = -kTravel_mm; p_mm <= 0.0; p_mm += kStep_mm) {
        const double error = measured_at(chain, moving_axis(component), p_mm, 1.0)[c];
        table.counts.push_back(static_cast<std::int16_t>(std::lround(-error / kResolution)));
      }
      tables.push_back(table);
    }
    const auto image = image_of(p, tables);
    auto map = std::make_unique<CompiledMap>();
    REQUIRE(compile(ImageView(image), *map).fault == Fault::none);

    double before_um = 0.0;
    double after_um = 0.0;
    for (double along = 0.0; along < 1.0; along += 0.0137) {
      const Vector3 pose_mm{-1000.0 * along, -1000.0 * std::fmod(3.0 * along, 1.0),
                            -1000.0 * std::fmod(7.0 * along, 1.0)};
      MachineErrors errors = errors_at(pose_mm, 1.0);
      errors.values[index_of(Component::C0Y)] = squareness[0];
      errors.values[index_of(Component::B0Z)] = squareness[1];
      errors.values[index_of(Component::A0Z)] = squareness[2];
      const Vector3 error_um = exact_error_um(chain, errors, pose_mm);
      const Vector3 compensation_um = compensation_um_at(*map, pose_mm, {});
      for (std::size_t o = 0; o < kAxes; ++o) {
        before_um = std::max(before_um, std::abs(error_um[o]));
        after_um = std::max(after_um, std::abs(error_um[o] + compensation_um[o]));
      }
    }
    CHECK(before_um > 100.0);
    CHECK(after_um < 0.6);
  }
}
