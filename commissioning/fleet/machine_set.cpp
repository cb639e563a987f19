#include "commissioning/fleet/machine_set.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "base/file.hpp"
#include "commissioning/models/work.hpp"
#include "model/diagnosis/diagnose.hpp"

namespace ecs::commissioning {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostData = 8u << 20;

/// A FIFO or a device would hold up the others.
Result<std::string> regular_file(const fs::path& path) {
  std::error_code error;
  if (fs::exists(path, error) && !fs::is_regular_file(path, error))
    return tl::unexpected(
        Problem{ProblemKind::bad_input, "expected a file, found a folder or a device", path.string(), 0, 0, {}});
  return read_file(path);
}

void append_part(std::string& all, std::string_view name, std::string_view content) {
  all += fmt::format("{} {}\n", name, content.size());
  all += content;
}

}  // namespace

const ManifestColumns& fleet_columns() {
  static const ManifestColumns columns{{"id", "model", "data"}, {"machine", "type", "batch"}};
  return columns;
}

MachineSet machine_set_of(const Manifest& manifest, const ManifestRow& row) {
  const auto& cells = row.cells;
  return {cells[0],
          manifest.from_folder(cells[1]),
          manifest.from_folder(cells[2]),
          manifest.from_folder(cells[3]),
          cells[4],
          cells[5]};
}

Result<std::string> content_hash(const MachineSet& set, std::size_t noise_replicates) {
  std::error_code error;
  if (const auto bytes = fs::file_size(set.data, error); !error && bytes > kMostData)
    return tl::unexpected(Problem{ProblemKind::bad_input,
                                  fmt::format("expected at most {} MiB of readings, found {}: use `ecs model diagnose`",
                                              kMostData >> 20, bytes >> 20),
                                  set.data,
                                  0,
                                  0,
                                  {}});
  std::string all = fmt::format("noise replicates {}\n", noise_replicates);
  ECS_TRY(model_text, regular_file(set.model));
  append_part(all, "model", model_text);
  ECS_TRY(model, model::read_model(set.model));
  std::vector<std::pair<std::string_view, fs::path>> others{{"data", set.data}};
  if (!set.machine.empty()) others.emplace_back("machine", set.machine);
  if (!model.map_file.empty()) others.emplace_back("map", fs::path(set.model).parent_path() / model.map_file);
  for (const auto& [name, path] : others) {
    ECS_TRY(content, regular_file(path));
    append_part(all, name, content);
  }
  return sha256_hex(all);
}

Result<FleetResult> diagnosed(const MachineSet& set, const std::string& hash, std::size_t noise_replicates,
                              const std::atomic<bool>* cancelled) {
  NoMessages unread;
  ECS_TRY(work, model_work(unread, {set.model, {set.data}, set.machine, {}}));
  model::DiagnoseOptions options;
  options.noise_replicates = noise_replicates;
  options.cancelled = cancelled;
  options.p_values = true;
  const auto names = model::named_causes(work.model, work.data, options);
  if (!names) return tl::unexpected(in_file(names.error(), set.data));
  FleetResult result{set.id, hash,          std::string(name_of(names->verdict)), {}, set.type, set.batch, 0.0, {},
                     false,  names->p_value};
  for (const model::NamedCause& cause : names->causes)
    result.causes.push_back({cause.name, cause.probability, cause.e_value, cause.false_naming, cause.p_value,
                             std::string(name_of(cause.standing))});
  return result;
}

}  // namespace ecs::commissioning
