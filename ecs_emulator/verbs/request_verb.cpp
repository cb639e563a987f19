#include "ecs_emulator/verbs/request_verb.hpp"

#include <cctype>
#include <cstdio>
#include <filesystem>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "base/outcome.hpp"
#include "base/overwriting.hpp"

namespace ecs::emulator {
namespace {

using Json = nlohmann::json;
constexpr const char* kForce = "force";

Json coordinates_in(const std::vector<std::string>& texts) {
  Json place = Json::object();
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    std::string name = text.substr(0, equals);
    for (char& letter : name) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
    const Json value = equals == std::string::npos ? Json() : Json::parse(text.substr(equals + 1), nullptr, false);
    place[name] = value.is_discarded() ? Json(text.substr(equals + 1)) : value;
  }
  return place;
}

std::string absolute(const std::string& path) { return std::filesystem::absolute(path).string(); }

/// Of the instrument.
void add_settings(RequestVerb& verb) {
  verb.word("--air", "air", "off, manual or automatic");
  verb.word("--material", "material", "off, manual or automatic");
  verb.number("--material-temperature", "material_temperature", "entered, degC");
  verb.number("--dead-path", "dead_path", "m");
  verb.number("--misalignment", "misalignment", "between beam and axis, mrad");
  verb.number("--trigger-latency", "trigger_latency", "of readings on the fly, s");
}

void add_reversed(RequestVerb& verb) {
  verb.integer("--reversed", "reversed", "square or straight edge: 1 turned over, 0 as it was; writes the column");
}

/// The kind of problem that ends the program with this code.
ProblemKind kind_of(int exit_code) {
  for (const ProblemKind kind : {ProblemKind::refused, ProblemKind::usage, ProblemKind::bad_input, ProblemKind::link})
    if (exit_code_of(kind) == exit_code) return kind;
  return ProblemKind::output;
}

}  // namespace

void RequestVerb::number(const std::string& option, const std::string& key, const std::string& help, Need need) {
  arguments_.push_back({option, cli::OnNumber([&request = request_, key](double v) { request[key] = v; }), help, need});
}

void RequestVerb::integer(const std::string& option, const std::string& key, const std::string& help, Need need) {
  arguments_.push_back(
      {option, cli::OnInteger([&request = request_, key](long long v) { request[key] = v; }), help, need});
}

void RequestVerb::word(const std::string& option, const std::string& key, const std::string& help, Need need) {
  arguments_.push_back(
      {option, cli::OnText([&request = request_, key](const auto& v) { request[key] = v; }), help, need});
}

void RequestVerb::flag(const std::string& option, const std::string& key, const std::string& help) {
  arguments_.push_back({option, cli::OnFlag([&request = request_, key] { request[key] = true; }), help});
}

void RequestVerb::numbers(const std::string& option, const std::string& key, const std::string& help) {
  cli::Argument numbers{option, cli::OnNumbers([&request = request_, key](const auto& v) { request[key] = v; }), help};
  numbers.by_commas = true;
  arguments_.push_back(numbers);
}

void RequestVerb::words(const std::string& option, const std::string& key, const std::string& help) {
  cli::Argument words{option, cli::OnTexts([&request = request_, key](const auto& v) { request[key] = v; }), help};
  words.by_commas = true;
  arguments_.push_back(words);
}

void RequestVerb::coordinates(const std::string& option, const std::string& key, const std::string& help) {
  cli::Argument places{
      option, cli::OnTexts([&request = request_, key](const auto& v) { request[key] = coordinates_in(v); }), help};
  places.by_commas = true;
  arguments_.push_back(places);
}

void RequestVerb::path(const std::string& option, const std::string& key, const std::string& help, Need need) {
  arguments_.push_back(
      {option, cli::OnText([&request = request_, key](const auto& v) { request[key] = absolute(v); }), help, need});
}

void RequestVerb::paths(const std::string& option, const std::string& key, const std::string& help) {
  const auto take = [&request = request_, key](const std::vector<std::string>& paths) {
    request[key] = Json::array();
    for (const std::string& path : paths) request[key].push_back(absolute(path));
  };
  arguments_.push_back({option, cli::OnTexts(take), help});
}

void RequestVerb::force() { flag("--force", kForce, "overwrites output files that are there"); }

bool force_in(Json& request) { return request.erase(kForce) > 0; }

Result<void> spared_by(const Json& request, bool force) {
  std::vector<std::string> files;
  for (const char* key : {"output", "trace"}) {
    if (!request.contains(key)) continue;
    if (request[key].is_string()) files.push_back(request[key]);
    if (request[key].is_array())
      for (const Json& file : request[key]) files.push_back(file);
  }
  return spared(files, force);
}

void add_measure_options(RequestVerb verb) {
  verb.word("--axis", "axis", "", Need::required);
  verb.word("--sense", "sense", "", Need::required);
  verb.number("--from", "from");
  verb.number("--to", "to");
  verb.number("--step", "step");
  verb.numbers("--targets", "targets");
  verb.flag("--moved", "moved", "targets off equal steps, as ISO 230-2 asks");
  verb.integer("--runs", "runs");
  verb.flag("--unidirectional", "unidirectional");
  verb.coordinates("--parked", "parked", "for example y=-700,z=0");
  verb.number("--feed", "feed");
  verb.number("--dwell", "dwell");
  verb.number("--overrun", "overrun");
  verb.flag("--on-the-fly", "on_the_fly");
  verb.word("--instrument", "instrument");
  add_settings(verb);
  add_reversed(verb);
  verb.integer("--beam-broken-at", "beam_broken_at", "somebody steps into the beam before this reading");
  verb.word("--date", "date");
  verb.word("--engineer", "engineer");
  verb.word("--plan-name", "plan_name");
  verb.paths("-o,--output", "output", "files: .csv, .rtl, .rta, .rts, .ren, .pos, .dat, .env.pos");
  verb.force();
}

void add_capture_options(RequestVerb verb) {
  verb.word("--axis", "axis", "", Need::required);
  verb.word("--sense", "sense", "", Need::required);
  verb.number("--rate", "rate", "Hz (1000)");
  verb.number("--seconds", "seconds", "(10)");
  verb.number("--to", "to", "mm; the axis starts to move there");
  verb.number("--feed", "feed");
  verb.word("--instrument", "instrument");
  add_settings(verb);
  verb.word("--date", "date");
  verb.word("--engineer", "engineer");
  verb.paths("-o,--output", "output", "files: .csv, .rtx");
  verb.force();
}

void add_survey_options(RequestVerb verb) {
  verb.number("--step", "step");
  verb.integer("--approach", "approach");
  verb.flag("--with-scatter", "with_scatter");
  verb.path("-o,--output", "output");
  verb.force();
}

void add_components_options(RequestVerb verb) {
  for (const char* axis : {"x", "y", "z"})
    verb.numbers(std::string("--") + axis, axis, "coordinates, separated by commas, mm");
  for (const char* axis : {"a", "b", "c"})
    verb.numbers(std::string("--") + axis, axis, "angles, separated by commas, deg");
}

void add_ball_options(RequestVerb verb) {
  verb.numbers("--ball", "ball", "X,Y,Z at which the linear axes touch the ball, all rotary axes at 0 [mm]");
  verb.words("--sweep", "sweep", "C=0:330:30/A=-60: the axis that turns, from:to:step, and where another stands");
  verb.numbers("--tool-offset", "tool_offset", "X,Y,Z from the point at which errors count to the ball in the spindle");
  verb.numbers("--off", "off", "X,Y,Z by which the ball is off its place on the table [um]");
  verb.numbers("--tool-off", "tool_off", "X,Y,Z by which that in the spindle is off [um]");
  verb.flag("--on-workpiece", "on_workpiece", "sensors turn with the table");
  verb.integer("--runs", "runs", "each there and back, 2");
  verb.number("--noise", "noise", "of a reading, standard deviation [um], 0.3");
  verb.number("--seconds", "seconds", "from one pose to the next, 5");
  verb.path("-o,--output", "output", "measurement set (.csv); else it comes back as csv");
  verb.force();
}

void add_turn_options(RequestVerb verb) {
  verb.word("--sweep", "sweep", "C=0:330:30: the axis that turns, from:to:step [deg]", Need::required);
  verb.word("--sense", "sense", "EX, EY, EZ (um), EA, EB, EC (um/m)", Need::required);
  verb.integer("--runs", "runs", "each there and back, 3");
  verb.number("--noise", "noise", "of a reading, standard deviation [um, um/m], 0.3");
  verb.number("--seconds", "seconds", "from one target to the next, 5");
  verb.path("-o,--output", "output", "measurement set (.csv); else it comes back as csv");
  verb.force();
}

void add_circle_options(RequestVerb verb) {
  verb.word("--plane", "plane",
            "XY, YZ, ZX, or the axes in the other order; the angle rises from the first to the second", Need::required);
  verb.coordinates("--centre", "centre", "x=200,y=300; the middle of the travel where nothing is said");
  verb.number("--radius", "radius", "[mm], 100");
  verb.number("--feed", "feed", "[mm/min], 1000");
  verb.number("--start", "start", "[deg], 0");
  verb.number("--overlap", "overlap", "before and after each turn [deg], 45");
  verb.number("--step", "step", "between readings [deg], 1");
  verb.integer("--runs", "runs", "each of one turn both ways, 2");
  verb.number("--noise", "noise", "standard deviation of the ball bar [um], 0.1");
  verb.path("-o,--output", "output", "circle file (modules/standards/README.md)");
  verb.force();
}

void add_lengths_options(RequestVerb verb) {
  verb.path("PLAN", "plan", "plan of lengths (.csv, modules/lengths/README.md)", Need::required);
  verb.number("--noise", "noise", "of a reading, standard deviation [um], 0.2");
  verb.number("--scale", "scale", "of each set-up, standard deviation [um/m], 0.1");
  verb.number("--station", "station", "of each coordinate of a station, standard deviation [mm], 0.2");
  verb.number("--tool", "tool", "of each coordinate of a tool, standard deviation [mm], 0.05");
  verb.number("--zero", "zero", "of each run, standard deviation [um], 100");
  verb.number("--bar", "bar", "of a ball bar's length where the plan says bar_um, standard deviation [um], 1");
  verb.flag("--no-scatter", "no_scatter", "without what does not repeat of the machine");
  verb.path("-o,--output", "output", "the plan with its readings (.csv)");
  verb.force();
}

void add_run_options(RequestVerb verb) {
  verb.path("PROGRAM", "program", "part program (docs/unit.md)", Need::required);
  verb.word("--axis", "axis", "axis whose component every M08 reads");
  verb.word("--sense", "sense", "EX, EY, EZ, EA, EB or EC");
  verb.word("--instrument", "instrument", "linear, straightness, angular, level or square");
  add_reversed(verb);
  verb.paths("-o,--output", "output", "readings; the form follows the name, as with measure");
  verb.path("--trace", "trace", "the track, sample by sample (.csv)");
  verb.number("--trace-period", "trace_period", "between samples, s (0.001); 0: every tick");
  verb.word("--date", "date", "into the metadata");
  verb.word("--engineer", "engineer", "into the metadata");
  verb.force();
}

Result<Outcome> printed(const std::string& answer) {
  const Json parsed = Json::parse(answer, nullptr, false);
  if (parsed.is_object() && parsed.value("ok", false)) {
    fmt::print("{}\n", answer);
    return Outcome{};
  }
  if (!parsed.is_object() || !parsed.contains("error"))
    return problem(ProblemKind::link, fmt::format("expected one JSON object from the workshop, got {}", answer));
  return problem(kind_of(parsed.value("exit", 5)), parsed["error"].value("message", answer));
}

void show_progress(const std::string& line) {
  if (isatty(STDERR_FILENO) == 0) return;
  const Json parsed = Json::parse(line, nullptr, false);
  const double part = parsed.is_object() ? parsed.value("progress", 0.0) : 0.0;
  const int at = parsed.is_object() ? parsed.value("line", 0) : 0;
  fmt::print(stderr, "\r{:3.0f} %{}{}", part * 100.0, at > 0 ? fmt::format("  line {:<8}", at) : "",
             part >= 1.0 ? "\n" : "");
}

}  // namespace ecs::emulator
