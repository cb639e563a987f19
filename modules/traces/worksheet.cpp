// `ecs model drive`: the constants of a servo drive from what is measured and read at the machine (thesis appendix A):
// data sheets, voltages at constant speed, a spring balance, masses and dimensions from drawings. Every sum is shown
// with its formula, its numbers and its units; constants that contradict each other or a stated value are named.
// Does not live here: the constants and the [drive] table (simulation.hpp).
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/toml_reader.hpp"
#include "base/units.hpp"
#include "commissioning/measurements/files.hpp"
#include "modules/traces/simulation.hpp"

namespace ecs::app {
namespace {

using model::DriveConstant;
using enum model::DriveConstant;

constexpr double kSecondsPerMinute = 60.0, kMsPerS = 1000.0;
constexpr double kSame = 0.0005;       ///< relative; the thesis prints four digits or more
constexpr double kSameReading = 0.02;  ///< two voltages read from instruments
constexpr double kSpeedReserve = 1.2;  ///< the emulated machine: 10 V are this many times its rapid speed
constexpr double kMm3PerM3 = 1e9;

/// One sum of the worksheet; without a formula a value as it was given.
struct Step {
  std::string symbol, formula, numbers;
  double value = 0.0;
  std::string unit, remark;
};

struct Worksheet {
  std::string name;
  std::vector<Step> steps;
  std::array<std::optional<double>, model::kDriveConstants> constants{};
  std::vector<std::string> findings, missing;
  std::optional<double> kv_per_s, fastest_mm_min, resolution_um;
};

class WorksheetReader {
 public:
  explicit WorksheetReader(const std::string& file) : reader_(file) {}

  Result<Worksheet> worksheet(std::string_view text) {
    ECS_TRY(root, reader_.parsed(text));
    reader_.only(root,
                 {"name", "screw", "encoder", "controller", "tacho", "friction", "sliding", "rotating", "motor",
                  "amplifier", "stated"},
                 "worksheet");
    sheet_.name = reader_.word(root, "name").value_or("");
    screw(root);
    encoder(root);
    controller(root);
    data_sheets(root);
    tacho(root);
    friction(root);
    inertia(root);
    if (!reader_.clean()) return tl::unexpected(reader_.all());
    derived();
    compare_voltages();
    stated(root);
    if (!reader_.clean()) return tl::unexpected(reader_.all());
    return std::move(sheet_);
  }

 private:
  /// A number above 0; complains about another. Absent: nothing, or a complaint where it is required.
  std::optional<double> positive(const toml::table& table, std::string_view of, std::string_view key,
                                 bool required = true) {
    const auto value = reader_.number(table, key);
    if (value && std::isfinite(*value) && *value > 0.0) return value;
    if (value)
      reader_.complain(*table.get(key), "{}.{}: expected a number above 0, found {}", of, key, *value);
    else if (required && table.get(key) == nullptr)
      reader_.complain(table, "{}: expected {}, found none", of, key);
    return std::nullopt;
  }
  const toml::table* table_of(const toml::table& root, std::string_view name, std::vector<std::string> keys,
                              std::string_view for_what) {
    const toml::table* table = reader_.child(root, name);
    if (table != nullptr)
      reader_.only(*table, keys, name);
    else if (root.get(name) == nullptr)
      sheet_.missing.push_back(fmt::format("{}: add a table [{}] with {}", for_what, name, fmt::join(keys, ", ")));
    return table;
  }
  void step(std::string symbol, std::string formula, std::string numbers, double value, std::string unit,
            std::string remark = {}) {
    sheet_.steps.push_back(
        {std::move(symbol), std::move(formula), std::move(numbers), value, std::move(unit), std::move(remark)});
  }
  void constant(DriveConstant id, std::string formula, std::string numbers, double value) {
    const auto& info = model::info_of(id);
    sheet_.constants[model::index_of(id)] = value;
    step(std::string(info.name), std::move(formula), std::move(numbers), value, std::string(info.unit),
         std::string(info.meaning));
  }
  [[nodiscard]] std::optional<double> known(DriveConstant id) const { return sheet_.constants[model::index_of(id)]; }

  void screw(const toml::table& root) {
    const toml::table* table = table_of(root, "screw", {"pitch_mm", "gear", "efficiency"}, "Ks, pitch");
    if (table == nullptr) return reader_.complain(1, "expected a table [screw] with pitch_mm, found none");
    const auto pitch_mm = positive(*table, "screw", "pitch_mm");
    gear_ = positive(*table, "screw", "gear", false).value_or(1.0);
    efficiency_ = positive(*table, "screw", "efficiency", false).value_or(1.0);
    if (efficiency_ > 1.0) reader_.complain(*table->get("efficiency"), "screw.efficiency: expected at most 1");
    if (!pitch_mm) return;
    pitch_mm_ = *pitch_mm;
    constant(pitch, "screw pitch / gear (turns of the motor per turn of the screw)",
             fmt::format("{:g} mm / {:g}", pitch_mm_, gear_), pitch_mm_ / gear_);
    constant(Ks, "screw pitch / (2 pi * gear)", fmt::format("{:g} mm / ({:.6f} * {:g})", pitch_mm_, kTurn, gear_),
             pitch_mm_ / (kTurn * gear_));
  }

  void encoder(const toml::table& root) {
    const toml::table* table = table_of(root, "encoder", {"pulses_per_turn"}, "Ke");
    if (table == nullptr) return;
    if (const auto pulses = positive(*table, "encoder", "pulses_per_turn"))
      constant(Ke, "pulses per turn of the motor / 2 pi", fmt::format("{:g} / {:.6f}", *pulses, kTurn),
               *pulses / kTurn);
  }

  /// Speed of the motor at a feed [rad/s].
  double speed_at(double feed_mm_min, const std::string& symbol) {
    const double speed = kTurn * gear_ * feed_mm_min / (kSecondsPerMinute * pitch_mm_);
    step(symbol, "2 pi * gear * feed / (60 * screw pitch)",
         fmt::format("{:.6f} * {:g} * {:g} mm/min / (60 * {:g} mm)", kTurn, gear_, feed_mm_min, pitch_mm_), speed,
         "rad/s", "speed of the motor");
    return speed;
  }

  void controller(const toml::table& root) {
    const toml::table* table =
        table_of(root, "controller", {"feed_mm_min", "dac_V", "following_error_pulses", "dac_limit_V"}, "Kd");
    if (table == nullptr) return;
    const auto volts = positive(*table, "controller", "dac_V"),
               pulses = positive(*table, "controller", "following_error_pulses");
    dac_feed_mm_min_ = positive(*table, "controller", "feed_mm_min", false);
    if (volts && pulses)
      constant(Kd, "D/A voltage / following error", fmt::format("{:g} V / {:g} pulses", *volts, *pulses),
               *volts / *pulses);
    dac_V_ = volts;
    if (const auto limit = positive(*table, "controller", "dac_limit_V", false)) constant(dac_limit, "", "", *limit);
  }

  void data_sheets(const toml::table& root) {
    const auto given = [&](const toml::table* table, std::string_view of, std::initializer_list<DriveConstant> ids) {
      if (table == nullptr) return;
      for (const DriveConstant id : ids) {
        const auto& info = model::info_of(id);
        if (const auto value = positive(*table, of, info.key, false)) constant(id, "", "", *value);
      }
    };
    given(table_of(root, "motor", {"Kt_Nm_per_A", "Jm_kgm2"}, "Kt, Jm"), "motor", {Kt, Jm});
    given(table_of(root, "amplifier", {"K", "Ka_A_per_V", "Ti_s", "Tc_s"}, "K, Ka, Ti, Tc"), "amplifier",
          {K, Ka, Ti, Tc});
  }

  void tacho(const toml::table& root) {
    const toml::table* table = table_of(root, "tacho", {"feed_mm_min", "tacho_V"}, "Kw");
    if (table == nullptr) return;
    const auto feed = positive(*table, "tacho", "feed_mm_min"), volts = positive(*table, "tacho", "tacho_V");
    if (!feed || !volts || pitch_mm_ <= 0.0) return;
    tacho_feed_mm_min_ = *feed;
    const double speed = speed_at(*feed, "w");
    constant(Kw, "tacho voltage / speed of the motor", fmt::format("{:g} V / {:.6g} rad/s", *volts, speed),
             *volts / speed);
  }

  /// Readings of a spring balance: one number or a list.
  std::vector<double> readings_of(const toml::table& table) {
    std::vector<double> out;
    const toml::node* node = table.get("spring_balance_N");
    if (node == nullptr) {
      reader_.complain(table, "friction: expected spring_balance_N, found none");
      return out;
    }
    const auto take = [&](const toml::node& one) {
      const auto value = one.value<double>();
      if (value && std::isfinite(*value) && *value > 0.0)
        out.push_back(*value);
      else
        reader_.complain(one, "friction.spring_balance_N: expected readings above 0 in newtons");
    };
    if (const toml::array* list = node->as_array())
      for (const toml::node& one : *list) take(one);
    else
      take(*node);
    if (out.empty() && reader_.clean())
      reader_.complain(*node, "friction.spring_balance_N: expected one reading or more, found none");
    return out;
  }

  void friction(const toml::table& root) {
    const toml::table* table = table_of(root, "friction", {"spring_balance_N"}, "T1");
    if (table == nullptr) return;
    const std::vector<double> readings = readings_of(*table);
    if (readings.empty() || pitch_mm_ <= 0.0) return;
    const auto n = static_cast<double>(readings.size());
    const double mean = std::accumulate(readings.begin(), readings.end(), 0.0) / n;
    double squares = 0.0;
    for (const double one : readings) squares += (one - mean) * (one - mean);
    step("F", "mean of the readings of the spring balance", fmt::format("{} N", fmt::join(readings, ", ")), mean, "N",
         readings.size() < 2 ? std::string("one reading")
                             : fmt::format("standard uncertainty {:.3g} N", std::sqrt(squares / (n - 1.0) / n)));
    constant(
        T1, "F * screw pitch / (2 pi * gear * efficiency)",
        fmt::format("{:.6g} N * {:g} m / ({:.6f} * {:g} * {:g})", mean, pitch_mm_ / kMmPerM, kTurn, gear_, efficiency_),
        mean * pitch_mm_ / kMmPerM / (kTurn * gear_ * efficiency_));
  }

  /// As weighed, or from density and volume. 0 where it cannot be told; the reader complains then.
  double mass_of(const toml::table& part, std::string_view of, const std::string& name, double volume_mm3) {
    const auto mass_kg = positive(part, of, "mass_kg", false), density = positive(part, of, "density_kg_m3", false);
    if (mass_kg) return *mass_kg;
    if (!density || volume_mm3 <= 0.0) {
      reader_.complain(part, "{}: expected mass_kg, or density_kg_m3 with the dimensions", of);
      return 0.0;
    }
    const double mass = *density * volume_mm3 / kMm3PerM3;
    step("m", "density * volume", fmt::format("{:g} kg/m3 * {:.6g} m3", *density, volume_mm3 / kMm3PerM3), mass, "kg",
         name);
    return mass;
  }

  double sliding(const toml::table& root) {
    double mass = 0.0;
    for (const toml::table* part : reader_.children(root, "sliding")) {
      reader_.only(*part, {"name", "mass_kg", "density_kg_m3", "length_mm", "width_mm", "height_mm"}, "sliding");
      double volume_mm3 = 1.0;
      for (const char* key : {"length_mm", "width_mm", "height_mm"})
        volume_mm3 *= positive(*part, "sliding", key, false).value_or(0.0);
      mass += mass_of(*part, "sliding", reader_.word(*part, "name").value_or("sliding part"), volume_mm3);
    }
    if (mass <= 0.0 || pitch_mm_ <= 0.0) return 0.0;
    const double pitch_m = pitch_mm_ / kMmPerM;
    const double inertia = mass * pitch_m * pitch_m / (efficiency_ * kTurn * kTurn * gear_ * gear_);
    step("Js", "sliding mass * screw pitch^2 / (efficiency * 4 pi^2 * gear^2)",
         fmt::format("{:.6g} kg * ({:g} m)^2 / ({:g} * {:.4f} * {:g}^2)", mass, pitch_m, efficiency_, kTurn * kTurn,
                     gear_),
         inertia, "kg m2", "the sliding mass, at the motor");
    return inertia;
  }

  double rotating(const toml::table& root) {
    double sum = 0.0;
    for (const toml::table* part : reader_.children(root, "rotating")) {
      reader_.only(*part, {"name", "mass_kg", "density_kg_m3", "length_mm", "radius_mm", "gyration_mm", "on"},
                   "rotating");
      const std::string name = reader_.word(*part, "name").value_or("rotating part");
      const std::string on = reader_.word(*part, "on").value_or("screw");
      if (on != "screw" && on != "motor")
        reader_.complain(*part, "rotating.on: expected \"screw\" or \"motor\", found \"{}\"", on);
      const auto radius = positive(*part, "rotating", "radius_mm", false),
                 gyration = positive(*part, "rotating", "gyration_mm", false),
                 length = positive(*part, "rotating", "length_mm", false);
      if (radius.has_value() == gyration.has_value()) {
        reader_.complain(*part, "rotating: expected radius_mm of a solid cylinder, or gyration_mm, and not both");
        continue;
      }
      const double volume_mm3 = radius && length ? std::numbers::pi * *radius * *radius * *length : 0.0;
      const double mass = mass_of(*part, "rotating", name, volume_mm3);
      const double r_m = (radius ? *radius : *gyration) / kMmPerM, half = radius ? 0.5 : 1.0;
      const double ratio = on == "motor" ? 1.0 : gear_;
      const double inertia = half * mass * r_m * r_m / (ratio * ratio);
      step("Jr",
           fmt::format("{}{}", radius ? "mass * radius^2 / 2" : "mass * radius_of_gyration^2",
                       ratio == 1.0 ? "" : " / gear^2"),
           fmt::format("{:.6g} kg * ({:g} m)^2{}{}", mass, r_m, radius ? " / 2" : "",
                       ratio == 1.0 ? "" : fmt::format(" / {:g}^2", ratio)),
           inertia, "kg m2", name);
      sum += inertia;
    }
    return sum;
  }

  void inertia(const toml::table& root) {
    const double slides = sliding(root), turns = rotating(root);
    if (slides + turns > 0.0)
      constant(J1, "Js + sum of Jr", fmt::format("{:.6g} kg m2 + {:.6g} kg m2", slides, turns), slides + turns);
    else
      sheet_.missing.emplace_back("J1: add tables [[sliding]] and [[rotating]] with mass_kg or density and dimensions");
  }

  /// What follows for the axis.
  void derived() {
    const auto k = known(K), kd = known(Kd), ke = known(Ke), kw = known(Kw), ks = known(Ks);
    if (k && kd && ke && kw) {
      sheet_.kv_per_s = *k * *kd * *ke / *kw;
      step("Kv", "K * Kd * Ke / Kw", fmt::format("{:.6g} * {:.6g} * {:.6g} / {:.6g}", *k, *kd, *ke, *kw),
           *sheet_.kv_per_s, "1/s", "gain of the position loop");
    }
    if (k && kw && ks && known(dac_limit)) {
      sheet_.fastest_mm_min = *k * *known(dac_limit) / *kw * *ks * kSecondsPerMinute;
      step("v", "60 * K * dac_limit * Ks / Kw",
           fmt::format("60 * {:.6g} * {:g} V * {:.6g} / {:.6g}", *k, *known(dac_limit), *ks, *kw),
           *sheet_.fastest_mm_min, "mm/min", "fastest speed, at the limit of the D/A converter");
    }
    if (ke && ks) sheet_.resolution_um = *ks / *ke * kUmPerMm;
    if (known(T1) && known(Kt))
      step("If", "T1 / Kt", fmt::format("{:.6g} Nm / {:g} Nm/A", *known(T1), *known(Kt)), *known(T1) / *known(Kt), "A",
           "current that overcomes friction");
    if (!known(Jm) || !known(J1)) return;
    const double inertia = *known(Jm) + *known(J1);
    step("J", "Jm + J1", fmt::format("{:g} kg m2 + {:.6g} kg m2", *known(Jm), *known(J1)), inertia, "kg m2",
         "all that the motor turns");
    if (known(Ka) && kw && known(Kt))
      step("tw", "J / (Ka * Kw * Kt)",
           fmt::format("{:.6g} / ({:g} * {:.6g} * {:g})", inertia, *known(Ka), *kw, *known(Kt)),
           kMsPerS * inertia / (*known(Ka) * *kw * *known(Kt)), "ms", "time constant of the velocity loop");
  }

  /// "10 times too large", "0.32 % too large"
  static std::string deviation(double ratio) {
    const char* way = ratio > 1.0 ? "too large" : "too small";
    const double times = std::max(ratio, 1.0 / ratio);
    if (times < 1.5) return fmt::format("{:.2g} % {}", 100.0 * std::abs(ratio - 1.0), way);
    const double decades = std::log10(times);
    const bool decimal_point = std::abs(decades - std::round(decades)) < std::log10(1.0 + kSameReading);
    return fmt::format("{:.3g} times {}{}", times, way,
                       decimal_point ? ": is the decimal point in the right place?" : "");
  }

  /// At a constant speed the integral action holds K u = Kw w, so two voltages check each other.
  void compare_voltages() {
    const auto k = known(K), kw = known(Kw);
    if (k && kw && dac_V_ && dac_feed_mm_min_ && pitch_mm_ > 0.0) {
      const double speed = kTurn * gear_ * *dac_feed_mm_min_ / (kSecondsPerMinute * pitch_mm_);
      const double by_dac = *k * *dac_V_ / speed;
      step("Kw'", "K * D/A voltage / speed of the motor at that voltage",
           fmt::format("{:.6g} * {:g} V / {:.6g} rad/s", *k, *dac_V_, speed), by_dac, "V s/rad",
           fmt::format("check: should be Kw = {:.6g} V s/rad; differs by {:.2g} %", *kw,
                       100.0 * std::abs(by_dac / *kw - 1.0)));
      if (std::abs(*kw / by_dac - 1.0) > kSameReading)
        sheet_.findings.push_back(
            fmt::format("Kw = {:.6g} V s/rad contradicts the D/A voltage, from which {:.6g} V s/rad follows: it is {}",
                        *kw, by_dac, deviation(*kw / by_dac)));
    }
    const double measured_at = std::max(tacho_feed_mm_min_, dac_feed_mm_min_.value_or(0.0));
    if (sheet_.fastest_mm_min && *sheet_.fastest_mm_min < measured_at)
      sheet_.findings.push_back(fmt::format(
          "with these constants the axis reaches {:.0f} mm/min at the limit of the D/A converter, but the voltages "
          "were read at {:g} mm/min: Kw is too large, or K too small",
          *sheet_.fastest_mm_min, measured_at));
  }

  /// Values stated elsewhere, against those computed here.
  void stated(const toml::table& root) {
    const toml::table* table = reader_.child(root, "stated");
    if (table == nullptr) return;
    std::vector<std::string> keys;
    for (const auto& info : model::drive_constants()) keys.emplace_back(info.key);
    reader_.only(*table, keys, "stated");
    for (const auto& info : model::drive_constants()) {
      const auto value = positive(*table, "stated", info.key, false), computed = known(info.id);
      if (!value || !computed || std::abs(*value / *computed - 1.0) <= kSame) continue;
      sheet_.findings.push_back(fmt::format("{} is stated as {:.7g} {}, and computed as {:.7g}: the stated value is {}",
                                            info.name, *value, info.unit, *computed, deviation(*value / *computed)));
    }
  }

  TomlReader reader_;
  Worksheet sheet_;
  double pitch_mm_ = 0.0, gear_ = 1.0, efficiency_ = 1.0, tacho_feed_mm_min_ = 0.0;
  std::optional<double> dac_V_, dac_feed_mm_min_;
};

/// As `ecs model compare` reads it. What is not known here keeps the value of appendix A.
std::string drive_table(const Worksheet& sheet) {
  std::string text = "[drive]\n";
  for (const auto& info : model::drive_constants())
    if (const auto value = sheet.constants[model::index_of(info.id)])
      text += fmt::format("{} = {:.9g}\n", info.key, *value);
  return text;
}

/// The same drive for an axis of the emulated machine, which scales the drive of appendix A to its axis.
std::string emulator_table(const Worksheet& sheet, const std::string& axis) {
  const auto known = [&](DriveConstant id) { return sheet.constants[model::index_of(id)]; };
  std::string text = fmt::format("[axis.{}]\n", axis);
  if (known(pitch)) text += fmt::format("screw_pitch_mm = {:.9g}\n", *known(pitch));
  if (sheet.resolution_um) text += fmt::format("resolution_um = {:.9g}\n", *sheet.resolution_um);
  text += fmt::format("[emulator.axis.{}]\ndrive = \"servo\"\nfeedback = \"motor\"\n", axis);
  if (sheet.kv_per_s) text += fmt::format("kv_per_s = {:.9g}\n", *sheet.kv_per_s);
  if (sheet.fastest_mm_min)
    text +=
        fmt::format("rapid_mm_min = {0:.9g}  # {1:.6g} / {2:g}: in the emulator, 10 V gives {2:g} times this speed\n",
                    *sheet.fastest_mm_min / kSpeedReserve, *sheet.fastest_mm_min, kSpeedReserve);
  if (known(T1)) text += fmt::format("friction_Nm = {:.9g}\n", *known(T1));
  return text;
}

struct DriveRequest {
  std::string file, output;
  std::string axis = "X";
  static Fields<DriveRequest> fields() {
    using R = DriveRequest;
    return {{"FILE", &R::file, "readings, drawings and data sheets (.toml, modules/traces/README.md)", Need::required},
            {"--axis", &R::axis, "axis of the machine file", Words{"X", "Y", "Z"}},
            {"-o,--output", &R::output, "model file to write, with the table [drive] (.toml)", Is::output}};
  }
};

Cell step_cell(const Step& step) {
  const std::string sum = step.formula.empty()
                              ? std::string()
                              : fmt::format("{}\n{:>14}{}\n{:>14}", step.formula, "= ", step.numbers, "= ");
  return record_cell("  {symbol:<9} = {sum}{value}{in}{of}\n", "symbol"_is(step.symbol), "formula"_is(step.formula),
                     "numbers"_is(step.numbers), "sum"_shown(sum),
                     "value"_is(step.value, fmt::format("{:.7g}", step.value)), "unit"_is(step.unit),
                     "in"_shown(step.unit.empty() ? step.unit : " " + step.unit), "remark"_is(text_cell(step.remark)),
                     "of"_shown(step.remark.empty() ? step.remark : fmt::format("   ({})", step.remark)));
}

Result<Outcome> drive(VerbContext&, const DriveRequest& request) {
  ECS_DO(check_output_not_input(request.output, {request.file}));
  ECS_TRY(text, read_file(request.file));
  ECS_TRY(sheet, WorksheetReader(request.file).worksheet(text));
  const std::string table = drive_table(sheet), axis = emulator_table(sheet, request.axis);
  if (!request.output.empty())
    ECS_DO(write_file(request.output, fmt::format("name = {}\n\n{}", Json(sheet.name).dump(), table)));
  Json constants = Json::object();
  for (const auto& info : model::drive_constants())
    constants[std::string(info.key)] = number_or_null(sheet.constants[model::index_of(info.id)]);
  const Cell answer = record_cell(
      "{file}{title}\n{steps}{findings}{missing}\nfor `ecs model compare`:\n{drive}\nfor the machine file of the "
      "emulator:\n{machine}{output}",
      "file"_is(request.file), "name"_is(text_cell(sheet.name)),
      "title"_shown(sheet.name.empty() ? sheet.name : ": " + sheet.name), "steps"_is(list_cell(sheet.steps, step_cell)),
      "constants"_is(std::move(constants)), "kv_per_s"_is(sheet.kv_per_s), "fastest_mm_min"_is(sheet.fastest_mm_min),
      "findings"_is(paragraphs_cell(sheet.findings, "finding: ")),
      "missing"_is(paragraphs_cell(sheet.missing, "not computed: ")), "drive"_is(table), "machine"_is(axis),
      "output"_is(written_cell("model", request.output, "")));
  return outcome_of(answer, sheet.findings.empty() ? kDone : kDoesNotHold);
}

}  // namespace

extern const std::vector<Action> kDriveWorksheet{
    action("model drive", "compute the constants of a servo drive from readings, drawings and data sheets",
           "ecs model drive samples/rig/worksheet.toml -o drive.toml", drive)};

}  // namespace ecs::app
