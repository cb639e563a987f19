// A small fleet in a folder of its own: healthy machines and some with a periodic error.
#pragma once

#include <map>

#include "base/text.hpp"
#include "modules/fleet/result.hpp"
#include "tests/support/model_workspace.hpp"

namespace ecs::app {

struct FleetFolder {
  Folder folder;
  std::string results = folder / "results.jsonl";

  FleetFolder() {
    static_cast<void>(folder.with("model.toml", kStraightModel));
    static_cast<void>(folder.with("machine.toml", kTestMachine));
    for (unsigned i = 0; i < 4; ++i)
      static_cast<void>(
          folder.with(fmt::format("{}.csv", i), measured_x(i == 2 ? cyclic_x : straight_x, {.seed = i + 7})));
  }
  /// A row for 0.csv … 3.csv under the ids m0 … m3.
  [[nodiscard]] static std::string row(unsigned i, const std::string& batch = "b") {
    return fmt::format("m{},model.toml,{}.csv,machine.toml,mill,{}\n", i, i, batch);
  }
  [[nodiscard]] std::string manifest(const std::string& rows) const {
    return folder.with("fleet.csv", "id,model,data,machine,type,batch\n" + rows);
  }
  [[nodiscard]] Ran diagnose(const std::string& manifest_file, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"fleet", "diagnose", manifest_file, "-o", results, "--blanks", "50", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return ran(words);
  }
  [[nodiscard]] std::vector<std::string> lines() const { return owned_lines_of(content_of(results)); }
  /// By id, without the time they took.
  [[nodiscard]] std::map<std::string, commissioning::FleetResult> answers() const {
    std::map<std::string, commissioning::FleetResult> all;
    for (const std::string& line : lines()) {
      auto result = must(commissioning::result_in(line));
      result.processor_s = 0.0;
      CHECK_MESSAGE(all.emplace(result.id, result).second, "more than one line for ", result.id);
    }
    return all;
  }
};

}  // namespace ecs::app
