// Regressors of the effect library over readings (physics.md 4), terms of the rigid-body model (physics.md 2).
#include "bench/foreign/effects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace foreign {
namespace {

bool is(const Term& term, std::initializer_list<const char*> ids) {
  return std::any_of(ids.begin(), ids.end(), [&](const char* id) { return term.id == id; });
}

double p_mm(const Setup& setup, const Reading& reading, char axis) {
  return reading.at_mm[index_of(axis)] - setup.machine.axes[index_of(axis)].datum_mm;
}

double sensor_degC(const Setup& setup, const Reading& reading, const std::string& name) {
  const auto at = std::find(setup.sensors.begin(), setup.sensors.end(), name);
  return at == setup.sensors.end() ? 0.0 : reading.sensors_degC[static_cast<std::size_t>(at - setup.sensors.begin())];
}

double legendre(int degree, double x) {
  double before = 1.0;
  double now = x;
  if (degree == 0) return before;
  for (int k = 1; k < degree; ++k) {
    const double next = ((2.0 * k + 1.0) * x * now - k * before) / (k + 1.0);
    before = now;
    now = next;
  }
  return now;
}

// s(p): Legendre polynomials less mean and slope over the positions of the rows that the effect acts on.
std::vector<Column> smooth_columns(const Setup& setup, const Term& term, bool reversal, int count) {
  const auto [low, high] = span_of(setup, term.axis);
  std::vector<Column> columns(static_cast<std::size_t>(count), Column(setup.readings.size(), 0.0));
  if (!(high > low)) return columns;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < setup.readings.size(); ++i) {
    const Reading& reading = setup.readings[i];
    if (reading.sense == term.sense && (!reversal || reading.axis == term.axis)) rows.push_back(i);
  }
  const auto at = [&, low = low, high = high](std::size_t row) {
    return 2.0 * (setup.readings[row].at_mm[index_of(term.axis)] - low) / (high - low) - 1.0;
  };
  Basis line;
  Column ones(rows.size(), 1.0);
  Column slope(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) slope[k] = at(rows[k]);
  line.add(ones);
  line.add(slope);
  for (int degree = 0; degree < count; ++degree) {
    Column values(rows.size());
    for (std::size_t k = 0; k < rows.size(); ++k) values[k] = legendre(degree + 2, at(rows[k]));
    values = line.residual(values);
    for (std::size_t k = 0; k < rows.size(); ++k)
      columns[static_cast<std::size_t>(degree)][rows[k]] =
          values[k] * (reversal ? 0.5 * setup.readings[rows[k]].approach : 1.0);
  }
  return columns;
}

struct AngularTerm {
  char lever;
  double sign;
};

// (ε × L) in one direction: which coordinate of the lever acts, with which sign.
std::optional<AngularTerm> cross_product(char rotation, char sense) {
  const std::string cycle = "XYZXY";
  const std::size_t r = cycle.find(rotation);
  if (cycle[r + 1] == sense) return AngularTerm{cycle[r + 2], -1.0};  // B × Z gives +X; C gives −Y in X
  if (cycle[r + 2] == sense) return AngularTerm{cycle[r + 1], 1.0};
  return std::nullopt;
}

// Whether the lever of an axis's angular error holds this coordinate (physics.md 2).
bool lever_counts(const std::string& configuration, char axis, char lever) {
  const std::size_t tool = configuration.find('T');
  const std::size_t of_axis = configuration.find(axis);
  const std::size_t of_lever = configuration.find(lever);
  if (of_axis > tool) return of_lever > of_axis;
  return of_lever > tool || of_lever <= of_axis;
}

// Sensed directly in its own angular sense, or through a lever; empty where the code shows nothing.
double lever_m(const Setup& setup, const Term& term, const Reading& reading) {
  if (reading.sense == term.code.substr(0, 2)) return 1.0;
  if (reading.sense[1] < 'X') return 0.0;
  const auto rotation = static_cast<char>('X' + (term.code[1] - 'A'));
  const std::optional<AngularTerm> found = cross_product(rotation, reading.sense[1]);
  if (!found || !lever_counts(setup.machine.configuration, term.axis, found->lever)) return 0.0;
  double at = reading.at_mm[index_of(found->lever)];
  const AxisFacts& axis = setup.machine.axes[index_of(term.axis)];
  if (axis.measurement_line_mm && found->lever != term.axis) at -= (*axis.measurement_line_mm)[index_of(found->lever)];
  return found->sign * at / 1000.0;
}

std::vector<Column> angular_columns(const Setup& setup, const Term& term) {
  const auto [low, high] = span_of(setup, term.axis);
  std::vector<Column> columns(kCurveColumns + 2, Column(setup.readings.size(), 0.0));
  for (std::size_t i = 0; i < setup.readings.size(); ++i) {
    const Reading& reading = setup.readings[i];
    const double lever = lever_m(setup, term, reading);
    const double at = high > low ? 2.0 * (reading.at_mm[index_of(term.axis)] - low) / (high - low) - 1.0 : 0.0;
    for (int degree = 0; degree < kCurveColumns + 2; ++degree)
      columns[static_cast<std::size_t>(degree)][i] = lever * legendre(degree, at);
  }
  return columns;
}

double map_at(const Setup& setup, const Reading& reading, int approach, double shift_mm) {
  for (const MapTable& table : setup.map)
    if (table.axis == reading.axis && table.sense == reading.sense &&
        (table.approach == 0 || table.approach == approach))
      return interpolated(table.p_mm, table.value_um, reading.at_mm[index_of(reading.axis)] + shift_mm);
  return 0.0;
}

double excess_refraction_at(const Setup& setup, const Reading& reading) {
  return excess_refraction(sensor_degC(setup, reading, "t_air_degC"), reading.pressure_hPa, reading.humidity_pct);
}

// Rotation vector times place, in the sense of the reading [m].
double rotation_m(const Setup& setup, const Term& term, const Reading& reading) {
  const auto rotation = static_cast<char>('X' + (term.code[1] - 'A'));
  const std::optional<AngularTerm> found = cross_product(rotation, reading.sense[1]);
  return found ? found->sign * p_mm(setup, reading, found->lever) / 1000.0 : 0.0;
}

double squareness_m(const Setup& setup, const Term& term, const Reading& reading) {
  if (term.code == "C0Y" && reading.sense == "EX") return -p_mm(setup, reading, 'Y') / 1000.0;
  if (term.code == "B0Z" && reading.sense == "EX") return p_mm(setup, reading, 'Z') / 1000.0;
  if (term.code == "A0Z" && reading.sense == "EY") return -p_mm(setup, reading, 'Z') / 1000.0;
  return 0.0;
}

// Effects with a few columns, one reading at a time. `p` in mm, `d` the approach.
std::vector<double> row_of(const Setup& setup, const Term& term, const Reading& reading) {
  const double p = p_mm(setup, reading, term.axis);
  const double d = reading.axis == term.axis ? reading.approach : 0.0;
  if (term.id == "offset") return {1.0};
  if (term.id == "scale") return {p / 1000.0};
  if (term.id == "cyclic") {
    const double turn = 2.0 * std::numbers::pi * p / term.nonlinear;
    const bool acts = term.approach == 0 || (reading.axis == term.axis && term.approach == reading.approach);
    const double on = acts ? 1.0 : 0.0;
    return {on * std::sin(turn), on * std::cos(turn), on * std::sin(2.0 * turn), on * std::cos(2.0 * turn)};
  }
  if (term.id == "backlash") return {0.5 * d};
  if (term.id == "step") return {reading.at_mm[index_of(term.axis)] > term.nonlinear ? 1.0 : 0.0};
  if (term.id == "sag") return {std::pow(p / 1000.0, 2), std::pow(std::abs(p) / 1000.0, 3)};
  if (term.id == "squareness") return {squareness_m(setup, term, reading)};
  if (term.id == "measurement_line") {
    if (!setup.known) return {0.0};
    return {interpolated(setup.known->p_mm, setup.known->value, reading.at_mm[index_of(term.axis)]) / 1000.0};
  }
  if (term.id == "thermal_scale") return {p / 1000.0 * (sensor_degC(setup, reading, "t_material_degC") - 20.0)};
  if (term.id == "thermal_drift") {
    const double start = sensor_degC(setup, setup.readings.front(), term.sensor);
    return {sensor_degC(setup, reading, term.sensor) - start};
  }
  if (term.id == "warm_up") {
    const double warm = 1.0 - std::exp(-(reading.time_s - setup.readings.front().time_s) / term.nonlinear);
    return {warm, warm * p / 1000.0};
  }
  if (term.id == "thermal_bend")
    return {std::pow(p / 1000.0, 2) *
            (sensor_degC(setup, reading, term.sensor) - sensor_degC(setup, reading, term.sensor2))};
  if (term.id == "set_up_rotation") return {rotation_m(setup, term, reading)};
  if (term.id == "time_drift") return {(reading.time_s - setup.readings.front().time_s) / 3600.0};
  if (term.id == "air_refraction") return {p * 1000.0 * excess_refraction_at(setup, reading)};
  if (term.id == "dead_path") return {1e6 * excess_refraction_at(setup, reading)};
  if (term.id == "cosine") return {-p / 2000.0};
  if (term.id == "servo_lag") return {reading.feed_mm_min / 1000.0 * d};
  if (term.id == "load") return {reading.load_kg, reading.load_kg * p / 1000.0};
  if (term.id == "reversal_spike") return {d * std::exp(-reading.travel_mm / term.nonlinear)};
  const double map = map_at(setup, reading, reading.approach, 0.0);
  if (term.id == "map_polarity") return {-2.0 * map};
  if (term.id == "map_gain") return {map};
  if (term.id == "map_shift") return {map_at(setup, reading, reading.approach, term.nonlinear) - map};
  if (term.id == "map_direction_swap") return {map_at(setup, reading, -reading.approach, 0.0) - map};
  return {};
}

bool acts_on(const Term& term, const Reading& reading) {
  if (!term.sense.empty() && reading.sense != term.sense) return false;
  if (is(term, {"backlash", "servo_lag", "reversal_spike"})) return reading.axis == term.axis;
  return true;
}

}  // namespace

std::pair<double, double> span_of(const Setup& setup, char axis) {
  constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  double low = kUnlimited;
  double high = -kUnlimited;
  for (const Reading& reading : setup.readings) {
    low = std::min(low, reading.at_mm[index_of(axis)]);
    high = std::max(high, reading.at_mm[index_of(axis)]);
  }
  return {low, high};
}

std::string name_of(const Term& term) {
  const bool by_code = is(term, {"angular", "squareness", "set_up_rotation"});
  return term.id + ":" + term.axis + ":" + (by_code ? term.code : term.sense);
}

bool has_nonlinear(const std::string& id) {
  return id == "cyclic" || id == "step" || id == "warm_up" || id == "reversal_spike" || id == "map_shift";
}

bool has_fixed_size(const std::string& id) {
  return id == "map_polarity" || id == "map_gain" || id == "map_shift" || id == "map_direction_swap";
}

std::vector<Column> columns_of(const Setup& setup, const Term& term) {
  if (term.id == "progressive") return smooth_columns(setup, term, false, kCurveColumns);
  if (term.id == "reversal_curve") return smooth_columns(setup, term, true, kCurveColumns);
  if (term.id == "angular") return angular_columns(setup, term);
  std::vector<Column> columns(row_of(setup, term, setup.readings.front()).size(), Column(setup.readings.size(), 0.0));
  for (std::size_t i = 0; i < setup.readings.size(); ++i) {
    if (!acts_on(term, setup.readings[i])) continue;
    const std::vector<double> row = row_of(setup, term, setup.readings[i]);
    for (std::size_t k = 0; k < row.size(); ++k) columns[k][i] = row[k];
  }
  return columns;
}

std::vector<Column> free_columns_of(const Setup& setup, const Term& term) {
  if (term.id == "progressive") return smooth_columns(setup, term, false, kFreeCurveColumns);
  std::vector<Column> columns = columns_of(setup, term);
  if (has_nonlinear(term.id)) columns.push_back(nonlinear_derivative(setup, term));
  return columns;
}

Column contribution(const Setup& setup, const Term& term) {
  Column sum(setup.readings.size(), 0.0);
  const std::vector<Column> columns = columns_of(setup, term);
  for (std::size_t k = 0; k < columns.size(); ++k) add_scaled(sum, columns[k], term.coefficients[k]);
  return sum;
}

Column nonlinear_derivative(const Setup& setup, const Term& term) {
  Column derivative(setup.readings.size(), 0.0);
  if (!has_nonlinear(term.id) || term.id == "step") return derivative;
  const double step = 1e-5 * std::max(1e-3, std::abs(term.nonlinear));
  Term moved = term;
  moved.nonlinear = term.nonlinear + step;
  derivative = contribution(setup, moved);
  moved.nonlinear = term.nonlinear - step;
  add_scaled(derivative, contribution(setup, moved), -1.0);
  for (double& value : derivative) value /= 2.0 * step;
  return derivative;
}

std::map<std::string, double> parameters_of(const Setup& setup, const Term& term) {
  const std::vector<double>& c = term.coefficients;
  if (term.id == "offset" || term.id == "backlash") return {{"um", c[0]}};
  if (is(term, {"scale", "squareness", "set_up_rotation"})) return {{"um_per_m", c[0]}};
  if (term.id == "cyclic")
    return {{"period_mm", term.nonlinear},
            {"amplitude_um", std::hypot(c[0], c[1])},
            {"phase_rad", std::atan2(c[1], c[0])},
            {"amplitude2_um", std::hypot(c[2], c[3])},
            {"phase2_rad", std::atan2(c[3], c[2])}};
  if (term.id == "step")
    return {{"position_mm", term.nonlinear - setup.machine.axes[index_of(term.axis)].datum_mm}, {"height_um", c[0]}};
  if (term.id == "sag") return {{"k2", c[0]}, {"k3", c[1]}};
  if (term.id == "measurement_line") return {{"lever_mm", c[0]}};
  if (term.id == "thermal_scale") return {{"um_per_m_degC", c[0]}};
  if (term.id == "thermal_drift") return {{"um_per_degC", c[0]}};
  if (term.id == "thermal_bend") return {{"um_per_m2_degC", c[0]}};
  if (term.id == "warm_up") return {{"tau_s", term.nonlinear}, {"c_um", c[0]}, {"c_um_per_m", c[1]}};
  if (term.id == "time_drift") return {{"um_per_h", c[0]}};
  if (term.id == "air_refraction") return {{"factor", c[0]}};
  if (term.id == "dead_path") return {{"length_m", c[0]}};
  if (term.id == "cosine") return {{"angle_mrad", std::sqrt(std::max(0.0, c[0]))}};
  if (term.id == "servo_lag") return {{"um_per_m_min", c[0]}};
  if (term.id == "load") return {{"um_per_kg", c[0]}, {"um_per_kg_m", c[1]}};
  if (term.id == "reversal_spike") return {{"u0_mm", term.nonlinear}, {"c_um", c[0]}};
  if (term.id == "map_polarity") return {{"fraction", c[0]}};
  if (term.id == "map_gain") return {{"gain", 1.0 + c[0]}};
  if (term.id == "map_shift") return {{"shift_mm", term.nonlinear}};
  return {};
}

}  // namespace foreign
