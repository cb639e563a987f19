#include "ecs_emulator/workshop/verbs.hpp"

#include <cctype>
#include <filesystem>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "ecs_emulator/part_programs/verb.hpp"

namespace ecs::emulator {
namespace {

using Json = nlohmann::json;

/// "y=-700,z=0" → {"Y": -700, "Z": 0}
Json coordinates(const std::vector<std::string>& texts) {
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

}  // namespace

void WorkshopVerbs::add_all(CLI::App& app) {
  add(app, "state", "where everything stands");
  jog(add(app, "jog", "move axes: jog --x -100 --y 50 [--feed 2000]"));
  list(add(app, "reference", "run the controller's reference sequence, all axes or --axes X"), "--axes", "axes");
  measure(add(app, "measure", "measure: measure --axis X --sense EX --from 0 --to -4100 --step 50 -o exx.csv"));
  add_run_options(*add(app, "run", "run a part program: run exx.nc --axis X --sense EX -o exx.csv"), request_);
  add_mdi_options(*add(app, "mdi", "one block of a part program: mdi \"G01 X-100 F2000\""), request_);
  capture(add(app, "capture", "the display at a constant rate: capture --axis X --sense EX --seconds 10 -o run.rtx"));
  survey(add(app, "survey", "true volumetric error: corners and grid"));
  word(add(app, "power", "the unit's mains switch: power off | on | cycle"), "state", "state")->required();
  number(add(app, "wait", "let simulated time pass: wait 3600"), "seconds", "seconds")->required();
  whole(add(app, "tick", "run so many periods of the unit's loop: tick 1000"), "count", "count")->required();
  number(add(app, "load", "put a workpiece on the table: load 500"), "kg", "kg")->required();
  fault(add(app, "fault", "provoke a fault by its name: fault ram_stuck --address 0x100000 --bit 3"));
}

void WorkshopVerbs::measure(CLI::App* verb) {
  word(verb, "--axis", "axis")->required();
  word(verb, "--sense", "sense")->required();
  number(verb, "--from", "from");
  number(verb, "--to", "to");
  number(verb, "--step", "step");
  verb->add_option_function<std::vector<double>>("--targets", [this](const auto& v) { request_["targets"] = v; })
      ->delimiter(',');
  whole(verb, "--runs", "runs");
  flag(verb, "--unidirectional", "unidirectional");
  verb->add_option_function<std::vector<std::string>>(
          "--parked", [this](const auto& v) { request_["parked"] = coordinates(v); }, "for example y=-700,z=0")
      ->delimiter(',');
  number(verb, "--feed", "feed");
  number(verb, "--dwell", "dwell");
  number(verb, "--overrun", "overrun");
  flag(verb, "--on-the-fly", "on_the_fly");
  word(verb, "--instrument", "instrument");
  setting(verb);
  whole(verb, "--beam-broken-at", "beam_broken_at")->description("somebody steps into the beam before this reading");
  word(verb, "--date", "date");
  word(verb, "--engineer", "engineer");
  word(verb, "--plan-name", "plan_name");
  outputs(verb, "files: .csv, .rtl, .rta, .rts, .ren, .pos, .dat, .env.pos");
}

void WorkshopVerbs::capture(CLI::App* verb) {
  word(verb, "--axis", "axis")->required();
  word(verb, "--sense", "sense")->required();
  number(verb, "--rate", "rate")->description("Hz (1000)");
  number(verb, "--seconds", "seconds")->description("(10)");
  number(verb, "--to", "to")->description("mm; the axis starts to move there");
  number(verb, "--feed", "feed");
  word(verb, "--instrument", "instrument");
  setting(verb);
  word(verb, "--date", "date");
  word(verb, "--engineer", "engineer");
  outputs(verb, "files: .csv, .rtx");
}

void WorkshopVerbs::survey(CLI::App* verb) {
  number(verb, "--step", "step");
  whole(verb, "--approach", "approach");
  flag(verb, "--with-scatter", "with_scatter");
  verb->add_option_function<std::string>("-o,--output",
                                         [this](const std::string& v) { request_["output"] = absolute(v); });
}

CLI::App* WorkshopVerbs::add(CLI::App& app, const std::string& name, const std::string& help) {
  CLI::App* verb = app.add_subcommand(name, help);
  verb->callback([this, name] { request_["action"] = name; });
  return verb;
}

CLI::Option* WorkshopVerbs::number(CLI::App* verb, const std::string& option, const std::string& key) {
  return verb->add_option_function<double>(option, [this, key](double v) { request_[key] = v; });
}

CLI::Option* WorkshopVerbs::whole(CLI::App* verb, const std::string& option, const std::string& key) {
  return verb->add_option_function<long long>(option, [this, key](long long v) { request_[key] = v; });
}

CLI::Option* WorkshopVerbs::word(CLI::App* verb, const std::string& option, const std::string& key) {
  return verb->add_option_function<std::string>(option, [this, key](const std::string& v) { request_[key] = v; });
}

void WorkshopVerbs::list(CLI::App* verb, const std::string& option, const std::string& key) {
  verb->add_option_function<std::vector<std::string>>(option, [this, key](const auto& v) { request_[key] = v; })
      ->delimiter(',');
}

void WorkshopVerbs::flag(CLI::App* verb, const std::string& option, const std::string& key) {
  verb->add_flag_function(option, [this, key](auto) { request_[key] = true; });
}

void WorkshopVerbs::jog(CLI::App* verb) {
  number(verb, "--x,-x", "X");
  number(verb, "--y,-y", "Y");
  number(verb, "--z,-z", "Z");
  number(verb, "--feed", "feed");
}

void WorkshopVerbs::outputs(CLI::App* verb, const std::string& help) {
  verb->add_option_function<std::vector<std::string>>(
      "-o,--output",
      [this](const auto& v) {
        request_["output"] = Json::array();
        for (const auto& path : v) request_["output"].push_back(absolute(path));
      },
      help);
}

void WorkshopVerbs::setting(CLI::App* verb) {
  word(verb, "--air", "air")->description("off, manual or automatic");
  word(verb, "--material", "material")->description("off, manual or automatic");
  number(verb, "--material-temperature", "material_temperature")->description("entered, degC");
  number(verb, "--dead-path", "dead_path")->description("m");
  number(verb, "--misalignment", "misalignment")->description("between beam and axis, mrad");
  number(verb, "--trigger-latency", "trigger_latency")->description("of readings on the fly, s");
}

void WorkshopVerbs::fault(CLI::App* verb) {
  word(verb, "name", "name")->required();
  whole(verb, "--address", "address");
  whole(verb, "--bit", "bit");
  whole(verb, "--level", "level");
  whole(verb, "--bits", "bits");
  word(verb, "--axis", "axis");
  flag(verb, "--back", "back");
  number(verb, "--us", "us");
  whole(verb, "--count", "count");
  number(verb, "--probability", "probability");
  number(verb, "--slow-ms", "slow_ms");
}

}  // namespace ecs::emulator
