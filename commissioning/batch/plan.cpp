#include "commissioning/batch/plan.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "base/toml_reader.hpp"
#include "commissioning/manifest/manifest.hpp"

namespace ecs::commissioning {
namespace {

namespace fs = std::filesystem;

std::string from_folder(const fs::path& folder, const std::string& path) {
  return path.empty() ? path : (folder / path).lexically_normal().string();
}

std::string link_from_folder(const fs::path& folder, const std::string& link) {
  constexpr std::string_view kEmulator = "emulator:";
  if (!link.starts_with(kEmulator) || link.size() == kEmulator.size()) return link;
  return std::string(kEmulator) + from_folder(folder, link.substr(kEmulator.size()));
}

void take_unit(TomlReader& reader, const toml::table& table, const fs::path& folder, std::vector<PlannedUnit>& units) {
  reader.only(table, {"name", "link", "serial_number", "params", "map", "arm_code"}, "unit");
  const auto link = reader.word(table, "link");
  const auto params = reader.word(table, "params");
  if (!table.contains("link")) reader.complain(table, "unit: expected `link`: a batch has no default link");
  if (!table.contains("params")) reader.complain(table, "unit: expected `params`, the parameter file");
  PlannedUnit unit{reader.word(table, "name").value_or(fmt::format("unit {}", units.size() + 1)),
                   {},
                   reader.word(table, "serial_number").value_or(""),
                   from_folder(folder, params.value_or("")),
                   from_folder(folder, reader.word(table, "map").value_or(""))};
  if (link) {
    auto parsed = parsed_link(link_from_folder(folder, *link), "plan");
    if (parsed) {
      unit.link = std::move(*parsed);
      unit.link.arm_code = reader.word(table, "arm_code").value_or("");
    } else {
      reader.complain(*table.get("link"), parsed.error().message);
    }
  }
  units.push_back(std::move(unit));
}

/// Refuses a unit named twice: its second map would replace the first. Units on one link need different serial numbers.
Result<std::vector<PlannedUnit>> each_once(std::vector<PlannedUnit> units, const std::string& name) {
  std::vector<Problem> problems;
  for (std::size_t i = 0; i < units.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (to_text(units[i].link) == to_text(units[k].link) && units[i].serial_number == units[k].serial_number &&
          !units[i].link.is_emulator()) {
        problems.push_back({ProblemKind::bad_input,
                            fmt::format("{} and {} have the same link, {}, and no different serial numbers: each unit "
                                        "once, or say which is which by `serial_number`",
                                        units[k].name, units[i].name, to_text(units[i].link)),
                            name,
                            0,
                            0,
                            {}});
        break;
      }
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  return units;
}

Problem in_line_order(Problem all) {
  std::vector<Problem> problems = std::move(all.also);
  all.also.clear();
  problems.insert(problems.begin(), std::move(all));
  std::stable_sort(problems.begin(), problems.end(), [](const Problem& a, const Problem& b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
  return folded(std::move(problems));
}

}  // namespace

Result<std::vector<PlannedUnit>> parse_batch_plan(std::string_view text, const std::string& name,
                                                  const fs::path& folder) {
  TomlReader reader(name);
  ECS_TRY(table, reader.parsed(text));
  reader.only(table, {"unit"}, "plan");
  std::vector<PlannedUnit> units;
  for (const toml::table* unit : reader.children(table, "unit")) take_unit(reader, *unit, folder, units);
  if (units.empty() && reader.clean()) reader.complain(1, "expected at least one [[unit]]");
  if (!reader.clean()) return tl::unexpected(in_line_order(reader.all()));
  return each_once(std::move(units), name);
}

Result<std::vector<PlannedUnit>> batch_plan_of(const Manifest& manifest) {
  std::vector<PlannedUnit> units;
  std::vector<Problem> problems;
  for (std::size_t i = 0; i < manifest.size(); ++i) {
    const auto row = manifest.row(i);
    if (!row) {
      problems.push_back(row.error());
      continue;
    }
    const auto complain = [&](std::string message) {
      problems.push_back({ProblemKind::bad_input, std::move(message), manifest.name(), row->line, 1, {}});
    };
    if (const auto first = manifest.doubles_line(i))
      complain(fmt::format("the id {} is that of line {}: give each unit one of its own", row->id(), *first));
    auto link = parsed_link(link_from_folder(manifest.from_folder("."), row->cells[1]), "plan");
    if (!link) {
      complain(link.error().message);
      continue;
    }
    link->arm_code = row->cells[5];
    units.push_back({row->id(), std::move(*link), row->cells[3], manifest.from_folder(row->cells[2]),
                     manifest.from_folder(row->cells[4])});
  }
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  return each_once(std::move(units), manifest.name());
}

Result<std::vector<PlannedUnit>> read_batch_plan(const fs::path& path) {
  if (lower(path.extension().string()) == ".csv") {
    static const ManifestColumns kColumns{{"id", "link", "params"}, {"serial_number", "map", "arm_code"}};
    ECS_TRY(manifest, Manifest::read(path, kColumns));
    return batch_plan_of(manifest);
  }
  ECS_TRY(text, read_file(path));
  return parse_batch_plan(text, path.string(), path.parent_path());
}

}  // namespace ecs::commissioning
