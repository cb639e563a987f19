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
    const auto file = params::read_parameters(params_file);
    if (!file) return tl::unexpected(file.error());
    parameters = file->parameters;
  }
  const auto image = laser::image_of(map, parameters);
  if (!image) return tl::unexpected(image.error());
  return laser::content_of(image->bytes);
}

}  // namespace

Result<std::optional<std::uint32_t>> active_check(protocol::UnitClient& client) {
  const auto map = client.active_map();
  if (!map) return tl::unexpected(map.error());
  if (map->active_bank == protocol::Bank::none) return std::optional<std::uint32_t>();
  return std::optional(map->block_check_expected);
}

Result<SentMap> send_map(protocol::UnitClient& client, const PreparedMap& map, const std::string& file,
                         bool other_machine, const BeforeSending& before, const protocol::ProgressCallback& progress) {
  const auto identity = client.identity();
  if (!identity) return tl::unexpected(identity.error());
  if (!other_machine)
    if (auto refused = refused_map(other_unit(map, identity->serial_number), file))
      return tl::unexpected(std::move(*refused));
  const auto check_before = active_check(client);
  if (!check_before) return tl::unexpected(check_before.error());
  if (before) before(*check_before);
  const auto start = std::chrono::steady_clock::now();
  const auto report = send_image_to(client, *identity, map.image.bytes,
                                    other_machine ? Addressee::this_unit : Addressee::as_stated, progress);
  if (!report) return tl::unexpected(report.error());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return SentMap{*report, *identity, report->check, *check_before, seconds};
}

Result<MapVerdict> verdict_on(const FoundMap& found, const std::string& map_file, const std::string& params_file) {
  const auto map = laser::read_map_csv(map_file);
  if (!map) return tl::unexpected(map.error());
  const auto expected = expected_content(*map, params_file, found.parameters.value_or(UnitParameters{}));
  if (!expected) return tl::unexpected(expected.error());
  MapVerdict verdict;
  verdict.differences = differences_between(expected->map, found.map);
  verdict.largest = largest_difference(*map, found.map);
  for (MapDifference& resampled : beyond_resolution(*map, found.map))
    verdict.differences.push_back(std::move(resampled));
  if (found.parameters) verdict.parameters = params::diff(expected->parameters, *found.parameters);
  return verdict;
}

}  // namespace ecs::commissioning
