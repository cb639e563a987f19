#include "ecs_emulator/rig/verb.hpp"

#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "ecs_emulator/command_line/request_verb.hpp"
#include "ecs_emulator/rig/figures.hpp"

namespace ecs::emulator {
namespace {

struct Arguments {
  std::string folder;
  std::uint64_t seed = 7;
  bool json = false;
};

nlohmann::json json_of(const std::vector<RigNumber>& numbers) {
  nlohmann::json list = nlohmann::json::array();
  for (const RigNumber& n : numbers)
    list.push_back({{"figure", n.figure},
                    {"name", n.name},
                    {"unit", n.unit},
                    {"thesis", n.thesis ? nlohmann::json(*n.thesis) : nlohmann::json()},
                    {"here", n.here}});
  return {{"numbers", list}};
}

}  // namespace

void add_rig_verb(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* rig = app.add_subcommand("rig", "the thesis's single-axis rig: figures 3.3, 3.5, 3.9 to 3.12 with numbers");
  rig->add_option("-o,--output", arguments->folder, "folder for data (CSV) and pictures (SVG)")->required();
  rig->add_option("--seed", arguments->seed, "seed of the scatter (7)");
  rig->add_flag("--json", arguments->json, "the numbers as JSON");
  rig->footer("Example: ecs-emulator rig -o rig");
  rig->callback([arguments, &exit_code] {
    const auto numbers = draw_rig_figures(arguments->folder, arguments->seed);
    if (!numbers) {
      exit_code = exit_code_after(numbers.error());
      return;
    }
    fmt::print("{}", arguments->json ? json_of(*numbers).dump(2) + "\n" : table_of(*numbers));
  });
}

}  // namespace ecs::emulator
