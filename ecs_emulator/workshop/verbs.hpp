// The workshop's verbs as options of the command line, written into one request (docs/emulator.md).
// Does not live here: what a request does (workshop.hpp).
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace CLI {
class App;
}

namespace ecs::emulator {

/// Every verb of a running workshop. `request` must live as long as the parsing, here and below.
void add_workshop_verbs(CLI::App& app, nlohmann::json& request);
void add_measure_options(CLI::App& verb, nlohmann::json& request);
void add_capture_options(CLI::App& verb, nlohmann::json& request);
void add_survey_options(CLI::App& verb, nlohmann::json& request);

}  // namespace ecs::emulator
