#include "commissioning/maps/sent.hpp"

#include <chrono>

#include "commissioning/unit/map_checks.hpp"
#include "core/memory_image.hpp"
#include "laser/map/csv.hpp"
#include "laser/map/image.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {
namespace {

/// Map and parameters of the file as a unit would hold them: rounded and resampled as the image does it.
Result<laser::ImageContent> expected_content(const laser::ErrorMap& map, const std::string& params_file,
                                             const UnitParameters& of_unit) {
  UnitParameters parameters = of_unit;
  if (!params_file.empty()) {
    ECS_TRY(file, params::read_parameters(params_file));
    parameters = file.parameters;
  }
  ECS_TRY(image, laser::image_of(map, parameters));
  return laser::content_of(image.bytes);
}

}  // namespace

Result<std::optional<std::uint32_t>> active_check(protocol::UnitClient& client) {
  ECS_TRY(map, client.active_map());
  if (map.active_bank == protocol::Bank::none) return std::optional<std::uint32_t>();
  return std::optional(map.block_check_expected);
}

Result<SentMap> send_map(protocol::UnitClient& client, const PreparedMap& map, const std::string& file,
                         bool other_machine, const BeforeSending& before, const protocol::ProgressCallback& progress) {
  ECS_TRY(identity, client.identity());
  if (!other_machine)
    if (auto refused = refused_map(other_unit(map, identity.serial_number), file))
      return tl::unexpected(std::move(*refused));
  ECS_TRY(check_before, active_check(client));
  if (before) before(check_before);
  const auto start = std::chrono::steady_clock::now();
  ECS_TRY(report, send_image_to(client, identity, map.image.bytes,
                                other_machine ? Addressee::this_unit : Addressee::as_stated, progress));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return SentMap{report, identity, report.check, check_before, seconds};
}

Result<MapVerdict> verdict_on(const FoundMap& found, const std::string& map_file, const std::string& params_file) {
  ECS_TRY(map, laser::read_map_csv(map_file));
  ECS_TRY(expected, expected_content(map, params_file, found.parameters.value_or(UnitParameters{})));
  MapVerdict verdict;
  verdict.differences = differences_between(expected.map, found.map);
  verdict.largest = largest_difference(map, found.map);
  for (MapDifference& resampled : beyond_resolution(map, found.map))
    verdict.differences.push_back(std::move(resampled));
  if (found.parameters) verdict.parameters = params::diff(expected.parameters, *found.parameters);
  return verdict;
}

}  // namespace ecs::commissioning
