#include "laser/analysis/normalise.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"

namespace ecs::laser {
namespace {

// Names and constants as in the NIST Engineering Metrology Toolbox, documentation appendices A (Ciddor 1996; saturation
// of water vapour: IAPWS) and B (modified Edlén: Birch and Downs, Metrologia 30 (1993) 155 and 31 (1994) 315).

constexpr double kKelvin = 273.15;
constexpr double R = 8.314472;         ///< gas constant used there [J/(mol K)]
constexpr double Mv = 0.018015;        ///< molar mass of water [kg/mol]
constexpr double Za = 0.9995922115;    ///< compressibility of dry air at 15 °C and 101325 Pa
constexpr double rho_vs = 0.00985938;  ///< density of pure water vapour at 20 °C and 1333 Pa [kg/m³]
constexpr double pR1 = 101'325.0;
constexpr double TR1 = 288.15;

double saturation_over_water_Pa(double T) {
  const double omega = T - 2.38555575678e-1 / (T - 6.50175348448e2);
  const double a = (omega + 1.16705214528e3) * omega - 7.24213167032e5;
  const double b = (-1.70738469401e1 * omega + 1.20208247025e4) * omega - 3.23255503223e6;
  const double c = (1.49151086135e1 * omega - 4.82326573616e3) * omega + 4.05113405421e5;
  const double x = -b + std::sqrt(b * b - 4.0 * a * c);
  return 1e6 * std::pow(2.0 * c / x, 4);
}

double saturation_over_ice_Pa(double T) {
  const double theta = T / 273.16;
  const double y = -13.928169 * (1.0 - std::pow(theta, -1.5)) + 34.7078238 * (1.0 - std::pow(theta, -1.25));
  return 611.657 * std::exp(y);
}

double ciddor(const BeamAir& air, double S) {
  const double t = air.temperature_degC;
  const double T = t + kKelvin;
  const double p = air.pressure_hPa * kPaPerHPa;
  const double f = 1.00062 + 3.14e-8 * p + 5.60e-7 * t * t;
  const double xv = air.humidity_pct / 100.0 * f * water_vapour_saturation_Pa(t) / p;
  const double ras = 1e-8 * (5'792'105.0 / (238.0185 - S) + 167'917.0 / (57.362 - S));
  const double raxs = ras * (1.0 + 5.34e-7 * (air.co2_ppm - 450.0));
  const double rvs = 1.022e-8 * (295.235 + S * (2.6422 + S * (-0.03238 + S * 0.004028)));
  const double Ma = 0.0289635 + 1.2011e-8 * (air.co2_ppm - 400.0);
  const double Zm = 1.0 -
                    p / T *
                        (1.58123e-6 - 2.9331e-8 * t + 1.1043e-10 * t * t + (5.707e-6 - 2.051e-8 * t) * xv +
                         (1.9898e-4 - 2.376e-6 * t) * xv * xv) +
                    p / T * (p / T) * (1.83e-11 - 0.765e-8 * xv * xv);
  const double rho_axs = pR1 * Ma / (Za * R * TR1);
  const double rho_v = xv * p * Mv / (Zm * R * T);
  const double rho_a = (1.0 - xv) * p * Ma / (Zm * R * T);
  return 1.0 + rho_a / rho_axs * raxs + rho_v / rho_vs * rvs;
}

double modified_edlen(const BeamAir& air, double S) {
  const double t = air.temperature_degC;
  const double p = air.pressure_hPa * kPaPerHPa;
  const double pv = air.humidity_pct / 100.0 * water_vapour_saturation_Pa(t);
  const double standard = 1e-8 * (8342.54 + 2'406'147.0 / (130.0 - S) + 15'998.0 / (38.9 - S));  // n_s − 1
  const double X = (1.0 + 1e-8 * (0.601 - 0.00972 * t) * p) / (1.0 + 0.0036610 * t);
  const double dry = 1.0 + p * standard * X / 96'095.43;
  return dry - 1e-10 * (292.75 / (t + kKelvin)) * (3.7345 - 0.0401 * S) * pv;
}

/// The ranges for which the equations are stated (NIST Engineering Metrology Toolbox, appendix C).
struct Range {
  std::string_view what, unit;
  double least, most;
};
constexpr Range kWavelength{"vacuum wavelength", "nm", 300.0, 1700.0};
constexpr Range kTemperature{"air temperature", "degC", -40.0, 100.0};
constexpr Range kPressure{"air pressure", "hPa", 100.0, 1400.0};
constexpr Range kHumidity{"relative humidity", "%", 0.0, 100.0};
constexpr Range kCarbonDioxide{"carbon dioxide", "ppm", 0.0, 2000.0};

std::string fault_of(const BeamAir& air, double wavelength_nm) {
  for (const auto& [range, value] : {std::pair{kWavelength, wavelength_nm},
                                     {kTemperature, air.temperature_degC},
                                     {kPressure, air.pressure_hPa},
                                     {kHumidity, air.humidity_pct},
                                     {kCarbonDioxide, air.co2_ppm}})
    if (!(value >= range.least && value <= range.most))
      return fmt::format("{}: expected {} to {} {}, found {}{}", range.what, range.least, range.most, range.unit, value,
                         range.unit == kPressure.unit ? " (1 kPa = 10 hPa)" : "");
  return {};
}

/// S = 1/λ², in 1/µm².
double wavenumber_squared(double vacuum_wavelength_nm) {
  const double wavelength_um = vacuum_wavelength_nm / 1000.0;
  return 1.0 / (wavelength_um * wavelength_um);
}

}  // namespace

double water_vapour_saturation_Pa(double temperature_degC) {
  const double T = temperature_degC + kKelvin;
  return temperature_degC >= 0.0 ? saturation_over_water_Pa(T) : saturation_over_ice_Pa(T);
}

Result<double> refractive_index(const BeamAir& air, double vacuum_wavelength_nm, AirEquation equation) {
  if (const std::string fault = fault_of(air, vacuum_wavelength_nm); !fault.empty())
    return problem(ProblemKind::refused, fault);
  const double S = wavenumber_squared(vacuum_wavelength_nm);
  return equation == AirEquation::ciddor ? ciddor(air, S) : modified_edlen(air, S);
}

double refractive_index_deviation_ppm(BeamAir air, double vacuum_wavelength_nm) {
  const auto within = [](double& value, const Range& range) { value = std::clamp(value, range.least, range.most); };
  within(air.temperature_degC, kTemperature);
  within(air.pressure_hPa, kPressure);
  within(air.humidity_pct, kHumidity);
  within(air.co2_ppm, kCarbonDioxide);
  const double S = wavenumber_squared(vacuum_wavelength_nm);
  return (ciddor(air, S) - ciddor(BeamAir{}, S)) * 1e6;
}

namespace {

constexpr std::string_view kMetadataKey = "normalised";

bool is_positioning(const Reading& reading) {
  return index_of(reading.axis) == static_cast<std::size_t>(reading.sense);
}

bool is_normalised(const MeasurementSet& set) {
  return std::ranges::any_of(set.readings,
                             [](const Reading& reading) { return reading.extras.contains(kBeforeNormalisation); });
}

std::string place_of(const Reading& reading) {
  return reading.line > 0 ? fmt::format("line {}", reading.line) : fmt::format("row {}", reading.row);
}

Result<double> temperature_of(const Reading& reading, const Normalisation& how) {
  std::optional<double> found = how.material_degC;
  if (!found) {
    const auto sensor = reading.sensors_degC.find(how.sensor);
    if (sensor == reading.sensors_degC.end())
      return problem(ProblemKind::refused,
                     "{}: expected the temperature of the material in {}, found "
                     "none: name another column with --material-sensor, or give --material",
                     place_of(reading), how.sensor);
    found = sensor->second;
  }
  if (*found >= -50.0 && *found <= 150.0) return *found;
  return problem(ProblemKind::refused, "{}: expected a material temperature of -50 to 150 degC, found {}",
                 place_of(reading), shortest(*found));
}

/// Largest difference between material sensors of one reading.
double spread_of_sensors_degC(const MeasurementSet& set) {
  double spread = 0.0;
  for (const Reading& reading : set.readings) {
    std::optional<double> least, most;
    for (const auto& [name, value] : reading.sensors_degC) {
      if (name.starts_with("t_air")) continue;
      least = std::min(least.value_or(value), value);
      most = std::max(most.value_or(value), value);
    }
    if (least) spread = std::max(spread, *most - *least);
  }
  return spread;
}

void add_notes(Normalised& done, const Normalisation& how) {
  done.notes.push_back(fmt::format(
      "coefficient {} um/(m degC), applied to {}; material temperature {:.2f} to {:.2f} degC{}; position {} mm is "
      "fixed",
      shortest(how.coefficient_um_per_m_degC),
      done.instrument_um_per_m_degC == 0.0 ? std::string("errors without a correction by the instrument")
                                           : fmt::format("errors from which the {} of the instrument is removed",
                                                         shortest(done.instrument_um_per_m_degC)),
      done.least_degC, done.most_degC, how.material_degC ? " (one value for all readings)" : "",
      shortest(how.fixed_mm)));
  done.notes.push_back(
      fmt::format("a coefficient error of 1 um/(m degC) causes up to {:.3f} um here", done.per_coefficient_um));
  if (how.coefficient_um_per_m_degC != 0.0)
    done.notes.push_back(
        "one coefficient is used for the whole machine: if scale, screw, bed and column differ in material or "
        "temperature, it can be grossly wrong (thesis 6.3.1). For a machine that works at this temperature it may be "
        "better to build the map from readings without normalisation");
  const double spread_degC = spread_of_sensors_degC(done.set);
  if (spread_degC > 0.5)
    done.notes.push_back(fmt::format(
        "material sensors differ by up to {:.2f} degC: the machine is not at one temperature", spread_degC));
}

}  // namespace

std::optional<double> instrument_coefficient(const MeasurementSet& set) {
  for (const MetadataEntry& entry : set.metadata) {
    if (lower(entry.key) != "exp coeff") continue;
    const std::string_view first = std::string_view(entry.value).substr(0, entry.value.find(' '));
    if (const auto value = number_in(first)) return value;
  }
  return std::nullopt;
}

Result<Normalised> normalised(const MeasurementSet& set, const Normalisation& how) {
  if (is_normalised(set))
    return problem(ProblemKind::refused,
                   "the material correction of these readings has been changed already: undo that first with --back");
  Normalised done;
  done.set = set;
  done.instrument_um_per_m_degC =
      how.instrument_um_per_m_degC ? *how.instrument_um_per_m_degC : instrument_coefficient(set).value_or(0.0);
  for (const double coefficient : {how.coefficient_um_per_m_degC, done.instrument_um_per_m_degC})
    if (!(std::abs(coefficient) <= 1000.0))
      return problem(ProblemKind::refused, "coefficient: expected at most 1000 um/(m degC), found {}",
                     shortest(coefficient));
  const double difference = how.coefficient_um_per_m_degC - done.instrument_um_per_m_degC;
  for (Reading& reading : done.set.readings) {
    if (!is_positioning(reading)) continue;
    ECS_TRY(material_degC, temperature_of(reading, how));
    const double per_coefficient_um = (material_degC - kReference_degC) * (target_mm(reading) - how.fixed_mm) / kMmPerM;
    reading.extras.insert_or_assign(std::string(kBeforeNormalisation), reading.error);
    reading.error -= difference * per_coefficient_um;
    done.least_degC = done.changed == 0 ? material_degC : std::min(done.least_degC, material_degC);
    done.most_degC = done.changed == 0 ? material_degC : std::max(done.most_degC, material_degC);
    done.largest_um = std::max(done.largest_um, std::abs(difference * per_coefficient_um));
    done.per_coefficient_um = std::max(done.per_coefficient_um, std::abs(per_coefficient_um));
    ++done.changed;
  }
  if (done.changed == 0)
    return problem(ProblemKind::refused,
                   "expected errors along the moving axis, found none: straightness and angles are not normalised to "
                   "20 degC by a coefficient");
  done.set.metadata.push_back(
      {std::string(kMetadataKey),
       fmt::format("to 20 degC with {} um/(m degC); the instrument had applied {} um/(m degC); temperature {}; fixed "
                   "at {} mm",
                   shortest(how.coefficient_um_per_m_degC), shortest(done.instrument_um_per_m_degC),
                   how.material_degC ? shortest(*how.material_degC) + " degC" : "from " + how.sensor,
                   shortest(how.fixed_mm))});
  add_notes(done, how);
  return done;
}

Result<MeasurementSet> denormalised(const MeasurementSet& set) {
  if (!is_normalised(set))
    return problem(ProblemKind::refused, "expected readings normalised to 20 degC (column {}), found none",
                   kBeforeNormalisation);
  MeasurementSet back = set;
  for (Reading& reading : back.readings) {
    const auto before = reading.extras.find(kBeforeNormalisation);
    if (before == reading.extras.end()) continue;
    reading.error = before->second;
    reading.extras.erase(before);
  }
  std::erase(back.columns, kBeforeNormalisation);
  std::erase_if(back.metadata, [](const MetadataEntry& entry) { return entry.key == kMetadataKey; });
  return back;
}

}  // namespace ecs::laser
