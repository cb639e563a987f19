// The verb `hide`, which the module brings to the emulator: hidden cases written as folders, whole or not at all.

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "base/file.hpp"
#include "base/sealed.hpp"
#include "base/text.hpp"
#include "ecs_emulator/verbs/module.hpp"
#include "ecs_emulator/verbs/verb.hpp"
#include "laser/writers/writers.hpp"
#include "modules/hidden_cases/case.hpp"
#include "modules/hidden_cases/hiding.hpp"

namespace ecs::emulator {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kHeading = "What is hidden in these data. Diagnose first; then: ecs model reveal DIR";

std::string_view word_for(Approach approach) {
  return approach == Approach::forward ? "forward" : approach == Approach::reverse ? "reverse" : "both";
}

std::string list_of(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "[" : ", ") + shortest(value);
  return text + "]";
}

std::string machine_file(const params::Machine& machine) {
  std::string text = fmt::format("name = \"{}\"\nconfiguration = \"{}\"\n", machine.name, machine.configuration);
  for (const Axis a : kAllAxes) {
    const auto& axis = machine.axes[index_of(a)];
    if (!axis) continue;
    text +=
        fmt::format("\n[axis.{}]\ntravel_mm = [{}, {}]\ndatum_mm = {}\ntransducer = \"{}\"\nresolution_um = {}\n",
                    letter_of(a), shortest(axis->travel_mm[0]), shortest(axis->travel_mm[1]), shortest(axis->datum_mm),
                    axis->transducer == Transducer::encoder ? "encoder" : "resolver", shortest(axis->resolution_um));
    const auto fact = [&](const char* name, const std::optional<double>& value) {
      if (value) text += fmt::format("{} = {}\n", name, shortest(*value));
    };
    fact("screw_pitch_mm", axis->screw_pitch_mm);
    fact("scale_pitch_mm", axis->scale_pitch_mm);
    fact("expansion_um_per_m_degC", axis->expansion_um_per_m_degC);
    std::string line;
    for (const Axis other : kAllAxes)
      if (const auto& at = axis->measurement_line_mm[index_of(other)])
        line += fmt::format("{}{} = {}", line.empty() ? "" : ", ", small_letter_of(other), shortest(*at));
    if (!line.empty()) text += "measurement_line_mm = { " + line + " }\n";
  }
  return text;
}

/// The sense of a set-up is its rotation, which files name by its code.
std::string_view sense_key(const DrawnEffect& effect) {
  return effect.kind->placed_by == PlacedBy::code_of_set_up ? "code" : "sense";
}

std::string model_file(const HiddenCase& c) {
  std::string text = "# What the engineer believes of this machine so far; sizes are fitted from the data.\n";
  if (!c.scene.map.empty()) text += "\n[map]\nfile = \"map.csv\"\n";
  for (const DrawnEffect& effect : c.base) {
    text += fmt::format("\n[[effect]]\nid = \"{}\"\n", effect.kind->id);
    if (effect.axis) text += fmt::format("axis = \"{}\"\n", letter_of(*effect.axis));
    if (effect.sense) text += fmt::format("{} = \"{}\"\n", sense_key(effect), name_of(*effect.sense));
    if (effect.code) text += fmt::format("code = \"{}\"\n", name_of(*effect.code));
    if (effect.approach != Approach::unknown) text += fmt::format("approach = \"{}\"\n", word_for(effect.approach));
    if (!effect.sensor.empty()) text += fmt::format("sensor = \"{}\"\n", effect.sensor);
    if (!effect.sensor2.empty()) text += fmt::format("sensor2 = \"{}\"\n", effect.sensor2);
    if (const auto given = hiding_of(effect).searched; !given.empty() && !c.free_base)  // no fit looks for it
      text += fmt::format("parameters = {{ {} = {} }}\n", given, shortest(effect.parameter(given)));
  }
  for (const KnownCurve& known : c.scene.known)
    text += fmt::format("\n[[known]]\ncode = \"{}\"\np_mm = {}\nvalue = {}\n", name_of(known.code), list_of(known.p_mm),
                        list_of(known.value));
  return text;
}

std::string map_file(const UnitMap& map) {
  std::string text = "axis,sense,approach,p_mm,value_um\n";
  for (const UnitTable& table : map)
    for (std::size_t k = 0; k < table.p_mm.size(); ++k)
      text += fmt::format("{},{},{},{},{}\n", letter_of(table.axis), name_of(table.sense),
                          static_cast<int>(table.approach), shortest(table.p_mm[k]), shortest(table.value[k]));
  return text;
}

laser::Reading reading_of(const HiddenCase& c, std::size_t k) {
  const Stop& stop = c.recorded.stops[k];
  const Shown& shown = c.scene.shown;
  laser::Reading reading;
  reading.axis = stop.axis;
  reading.position_mm = stop.position_mm;
  reading.sense = stop.sense;
  reading.error = c.readings[k];
  if (shown.approach) reading.approach = stop.approach > 0 ? Approach::forward : Approach::reverse;
  reading.run = stop.run;
  if (shown.time) reading.time_s = std::round((stop.time_s + shown.first_time_s) * 10.0) / 10.0;
  if (shown.feed) reading.feed_mm_min = stop.feed_mm_min;
  if (shown.load) reading.load_kg = stop.load_kg;
  if (shown.travel) reading.travel_since_reversal_mm = stop.travel_since_reversal_mm;
  if (shown.air) {
    reading.pressure_hPa = stop.weather.pressure_hPa;
    reading.humidity_pct = stop.weather.humidity_pct;
  }
  if (shown.compensated) reading.compensated = true;
  for (std::size_t s = 0; s < c.scene.sensors.size(); ++s)
    reading.sensors_degC.emplace(c.scene.sensors[s], stop.weather.degC[s]);
  return reading;
}

std::string data_file(const HiddenCase& c) {
  laser::MeasurementSet set;
  set.metadata = {{"machine", c.scene.machine.name}, {"instrument", "virtual laser"}, {"readings", "at standstill"}};
  set.columns = {"axis", "sense"};
  for (const Axis a : kAllAxes)
    if (c.scene.chain.has(a)) set.columns.push_back(fmt::format("{}_mm", small_letter_of(a)));
  set.columns.emplace_back("reading");
  if (c.scene.shown.approach) set.columns.emplace_back("approach");
  if (c.scene.shown.run) set.columns.emplace_back("run");
  for (std::size_t k = 0; k < c.readings.size(); ++k) {
    set.readings.push_back(reading_of(c, k));
    if (!c.scene.shown.run) set.readings.back().run = 1;
  }
  return laser::to_csv(set);
}

nlohmann::ordered_json json_of(const HiddenEffect& hidden) {
  const DrawnEffect& e = hidden.effect;
  nlohmann::ordered_json json;
  json["effect"] = e.kind->id;
  json["axis"] = e.axis ? nlohmann::ordered_json(std::string(1, letter_of(*e.axis))) : nlohmann::ordered_json();
  json["sense"] = nullptr;
  json["code"] = e.code ? nlohmann::ordered_json(name_of(*e.code)) : nlohmann::ordered_json();
  if (e.sense) json[std::string(sense_key(e))] = name_of(*e.sense);
  json["approach"] = word_for(e.approach);
  json["sensor"] = e.sensor;
  if (!e.sensor2.empty()) json["sensor2"] = e.sensor2;
  json["name"] = name_of(e);
  json["parameters"] = nlohmann::ordered_json::object();
  for (const auto& [name, value] : e.parameters) json["parameters"][name] = value;
  json["rms_um"] = hidden.rms_um;
  json["snr"] = hidden.snr;
  return json;
}

/// "300 readings of EX along X; 3 runs; configuration TXYZ": what anybody sees who opens the files.
std::string line_about(const HiddenCase& c) {
  std::string lines;
  int runs = 1;
  for (const Stop& stop : c.scene.stops) {
    runs = std::max(runs, stop.run);
    const std::string line = fmt::format("{} along {}", name_of(stop.sense), letter_of(stop.axis));
    if (lines.find(line) == std::string::npos) lines += (lines.empty() ? "" : ", ") + line;
  }
  return fmt::format("{} readings of {}; {} run{}; configuration {}{}; the truth is in truth.sealed", c.readings.size(),
                     lines, runs, runs == 1 ? "" : "s", c.scene.machine.configuration,
                     c.scene.map.empty() ? "" : "; an error map was active");
}

/// A folder that is made under another name and becomes the real one in a single step, or vanishes.
class Workbench {
 public:
  explicit Workbench(const fs::path& folder)
      : folder_(folder), beside_(folder.string() + fmt::format(".{}.part", getpid())) {}
  Workbench(const Workbench&) = delete;
  Workbench& operator=(const Workbench&) = delete;
  ~Workbench() { disc::remove_all(beside_); }
  [[nodiscard]] const fs::path& path() const { return beside_; }
  Result<void> become_real() {
    std::error_code error;
    fs::remove(folder_, error);  // an empty folder makes room
    fs::rename(beside_, folder_, error);
    if (error) return problem(ProblemKind::output, "{}: cannot create it: {}", folder_.string(), error.message());
    return {};
  }

 private:
  fs::path folder_;
  fs::path beside_;
};

Result<void> write_case(const HiddenCase& c, const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return problem(ProblemKind::output, "{}: cannot create it: {}", folder.string(), error.message());
  for (const auto& [name, content] : files_of(c)) ECS_DO(write_file(folder / name, content));
  return {};
}

}  // namespace

std::string truth_of(const HiddenCase& c) {
  nlohmann::ordered_json json;
  json["seed"] = c.seed;
  json["kind"] = kCaseKinds.of(c.kind);
  json["noise_um"] = c.noise.sigma_um;
  if (c.noise.law != NoiseLaw::usual) json["noise_law"] = kNoiseLaws.of(c.noise.law);
  json["effects"] = nlohmann::ordered_json::array();
  for (const HiddenEffect& hidden : c.hidden) json["effects"].push_back(json_of(hidden));
  json["group"] = c.group;
  json["variables"] = c.structure.variables;
  if (!c.structure.value.empty()) json["structure_snr"] = c.structure_snr;
  json["true_model_rms_um"] = c.true_model_rms_um;
  json["text"] = c.text;
  return json.dump(1) + "\n";
}

std::map<std::string, std::string> files_of(const HiddenCase& c) {
  std::map<std::string, std::string> files{{"machine.toml", machine_file(c.scene.machine)},
                                           {"model.toml", model_file(c)},
                                           {"data.csv", data_file(c)},
                                           {"truth.sealed", sealed(truth_of(c), kHeading)}};
  if (!c.scene.map.empty()) files["map.csv"] = map_file(c.scene.map);
  return files;
}

Result<std::vector<std::string>> write_hidden_cases(const HiddenCaseRequest& request, int count,
                                                    const fs::path& folder) {
  const fs::path place = fs::absolute(folder).lexically_normal();
  const fs::path target = place.has_filename() ? place : place.parent_path();
  std::error_code error;
  if (fs::exists(target, error) && !(fs::is_directory(target, error) && fs::is_empty(target, error)))
    return problem(ProblemKind::usage, "{}: expected a folder that does not exist or is empty", folder.string());
  Workbench bench(target);
  std::vector<std::string> lines;
  for (int k = 0; k < count; ++k) {
    HiddenCaseRequest one = request;
    one.seed += static_cast<std::uint64_t>(k);
    ECS_TRY(made, draw_hidden_case(one));
    const std::string name = count == 1 ? "" : fmt::format("{:04}", k + 1);
    ECS_DO(write_case(made, bench.path() / name));
    lines.push_back(fmt::format("{}: {}", (folder / name).string(), line_about(made)));
  }
  ECS_DO(bench.become_real());
  return lines;
}

namespace {

struct HideRequest {
  std::string folder, kind, effect, noise, printed_case;
  bool free_base = false;
  std::optional<std::uint64_t> seed;
  std::optional<double> snr;
  std::optional<std::size_t> readings;
  int count = 1;
  static Fields<HideRequest> fields() {
    using R = HideRequest;
    const auto readings = [](R& r) -> cli::Argument::Target {
      return cli::OnInteger([&r](long long n) { r.readings = static_cast<std::size_t>(n); });
    };
    return {{"--seed", &R::seed, "seed of the random case; the same seed gives the same files (1)"},
            {"-o,--output", &R::folder, "folder for the case; must be new or empty", Need::required},
            {"--kind", &R::kind, "kind of hidden error; random if not given",
             Words{"blank", "single", "pair", "out-of-library", "confounded"}},
            {"--effect", &R::effect, "effect to hide (id in docs/physics.md); for a pair, one of the two"},
            {"--snr", &R::snr,
             "rms of the hidden effect after a fit of the base model, divided by the sigma of one reading"},
            {{"--readings", {}, "approximate number of readings, 100 to 20000"}, readings},
            {"--count", &R::count, "number of cases, with consecutive seeds, in DIR/0001 …", cli::Range{1, 9999}},
            {"--free-base", &R::free_base,
             "allow any effect in the base model, without giving its periods, positions and time constants"},
            {"--noise", &R::noise, "distribution of the noise for --kind blank (usual)",
             Words{kNoiseLaws.words.begin(), kNoiseLaws.words.end()}},
            {"--case", &R::printed_case,
             "predefined case; xytz: the XYTZ machine with equation (27) as printed in the thesis", Words{"xytz"}}};
  }
};

/// `out-of-library` is understood too.
std::optional<CaseKind> case_kind_named(std::string_view name) {
  std::string word(name);
  std::replace(word.begin(), word.end(), '-', '_');
  return kCaseKinds.value_of(word);
}

Result<Outcome> hide(VerbContext& /*context*/, const HideRequest& arguments) {
  const HiddenCaseRequest request{.seed = arguments.seed.value_or(1),
                                  .kind = case_kind_named(arguments.kind),
                                  .effect = effect_named(arguments.effect),
                                  .snr = arguments.snr,
                                  .readings = arguments.readings,
                                  .free_base = arguments.free_base,
                                  .noise = kNoiseLaws.value_of(arguments.noise).value_or(NoiseLaw::usual),
                                  .xytz = !arguments.printed_case.empty()};
  if (!arguments.effect.empty() && request.effect == nullptr)
    return problem(ProblemKind::usage, "--effect: expected one of the {} effects of docs/physics.md, got {}",
                   effects().size(), arguments.effect);
  ECS_TRY(lines, write_hidden_cases(request, arguments.count, arguments.folder));
  return Outcome{fmt::format("{}", fmt::join(lines, "\n")), {}};
}

const std::vector<Action> kHide{
    action("hide", "make a practice case: measurements of a machine with an effect that its model lacks",
           "ecs-emulator hide --seed 7 -o case\n"
           "  ecs-emulator hide --seed 1 --kind single --effect cyclic --snr 3 -o cyclic\n"
           "  ecs-emulator hide --seed 1000 --count 300 --kind blank -o blanks\n"
           "  ecs-emulator hide --case xytz -o xytz\n"
           "Then diagnose DIR/data.csv, and: ecs model reveal DIR",
           hide)};

}  // namespace

const Module& hidden_cases_emulator_module() {
  static const Module module{{"program", &kHide}};
  return module;
}

}  // namespace ecs::emulator
