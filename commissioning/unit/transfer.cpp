#include "commissioning/unit/transfer.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/address_map.hpp"
#include "core/memory_image.hpp"
#include "laser/map/image.hpp"

namespace ecs::commissioning {
namespace {

struct Stated {
  std::string_view origin;  ///< "the map was made for serial number"
  const std::string& value;
};

void take_difference(std::vector<std::string>& objections, const Stated& ours, const std::string& other,
                     std::string_view where, std::string_view advice = kTakeTheRightOne) {
  if (ours.value.empty() || other.empty() || ours.value == other) return;
  objections.push_back(fmt::format("{} \"{}\", but {} has \"{}\": {}", ours.origin, ours.value, where, other, advice));
}

constexpr std::string_view kWhoseMap =
    "its machine cannot be checked. `ecs map build` writes these lines. If you are sure that the map is for this unit, "
    "--other-machine skips the check";
constexpr std::string_view kMapSerial = "the map was made for serial number";
constexpr std::string_view kOfParameters = "[identity] of the parameters";

std::vector<std::string> two_machines(const laser::MapHeader& header, const params::Identity& identity,
                                      std::string_view advice) {
  std::vector<std::string> objections;
  take_difference(objections, {"the map was made for machine", header.machine}, identity.machine, kOfParameters,
                  advice);
  take_difference(objections, {kMapSerial, header.serial_number}, identity.serial_number, kOfParameters, advice);
  return objections;
}

}  // namespace

std::vector<std::string> objections_to_map(const laser::ErrorMap& map, const UnitParameters& parameters) {
  std::vector<std::string> objections;
  for (const laser::MapFinding& finding : laser::findings_for(map, parameters))
    if (finding.objection) objections.push_back(finding.message);
  if (auto left = laser::squareness_left_behind(map.header, parameters)) objections.push_back(std::move(*left));
  return objections;
}

std::vector<std::string> other_machine(const laser::MapHeader& header, const params::Identity& identity) {
  return two_machines(header, identity, kTakeTheRightOne);
}

std::vector<std::string> made_for_two_machines(const laser::MapHeader& header, const params::Identity& identity) {
  return two_machines(header, identity, "`ecs map send` refuses the map with the present parameters");
}

std::vector<std::string> other_unit(const laser::MapHeader& header, const std::string& serial_number) {
  std::vector<std::string> objections;
  if (header.machine.empty() && header.serial_number.empty())
    objections.push_back(fmt::format("its header states neither machine nor serial number: {}", kWhoseMap));
  if (header.configuration.empty())
    objections.push_back(fmt::format("its header states no configuration: {}", kWhoseMap));
  take_difference(objections, {kMapSerial, header.serial_number}, serial_number, "the unit");
  return objections;
}

std::vector<std::string> other_unit(const params::Identity& identity, const std::string& serial_number) {
  std::vector<std::string> objections;
  take_difference(objections, {"the parameters were made for serial number", identity.serial_number}, serial_number,
                  "the unit");
  return objections;
}

std::vector<std::string> other_unit(const std::string& dumped_from, std::span<const std::uint8_t> image,
                                    const std::string& serial_number) {
  std::vector<std::string> objections;
  take_difference(objections, {"the dump was taken from serial number", dumped_from}, serial_number, "the unit");
  const auto content = laser::content_of(image);
  if (!content) {
    objections.push_back(
        fmt::format("the machine of the map cannot be read: {}; give --other-machine to load it nevertheless",
                    to_text(content.error())));
    return objections;
  }
  for (std::string& differs : other_unit(content->map.header, serial_number)) objections.push_back(std::move(differs));
  return objections;
}

std::vector<std::string> no_room_for(std::span<const std::uint8_t> image, const protocol::Identity& identity) {
  std::vector<std::string> objections;
  const ImageView view(image);
  const auto parameters = view.parameters();
  if (parameters && parameters->memory_modules > identity.memory_modules)
    objections.push_back(
        fmt::format("the parameters require {} axis memory modules, the unit has {}: add modules to its rack, or set "
                    "memory_modules in the parameters to {}",
                    parameters->memory_modules, identity.memory_modules, identity.memory_modules));
  if (view.value_count() > identity.capacity_values)
    objections.push_back(
        fmt::format("the map has {} values, the unit stores at most {}: use a larger increment, or add axis memory "
                    "modules to its rack",
                    view.value_count(), identity.capacity_values));
  const std::size_t room = bank_bytes(static_cast<std::uint8_t>(std::min<int>(identity.memory_modules, kMostModules)));
  if (image.size() > room)
    objections.push_back(fmt::format(
        "the map has {} bytes, a bank of the unit {}: use a larger increment, or add axis memory modules to its rack",
        image.size(), room));
  return objections;
}

std::optional<Problem> refused_map(const std::vector<std::string>& objections, const std::string& file) {
  if (objections.empty()) return std::nullopt;
  std::vector<Problem> problems;
  for (const std::string& objection : objections) problems.push_back({ProblemKind::refused, objection, file, 0, 0, {}});
  return folded(std::move(problems));
}

namespace {

using protocol::Bank;
using Image = std::vector<std::uint8_t>;

Result<void> has_image(const protocol::ActiveMap& active) {
  if (active.active_bank == Bank::none) return {};
  if (active.image_length_bytes >= kPrefixBytes + kParameterBytes && active.image_length_bytes <= kBankBytes) return {};
  return problem(ProblemKind::link, "unit: expected an active image of {} to {} bytes, it reports {}",
                 kPrefixBytes + kParameterBytes, kBankBytes, active.image_length_bytes);
}

/// What of a unit's image is worth keeping beside new parameters.
struct KeptMap {
  std::optional<Image> image;  ///< sound, with tables
  std::vector<std::string> objections;
  bool had_one = false, unreadable = false;
};

KeptMap map_to_keep(const std::optional<Image>& active, const UnitParameters& parameters,
                    const params::Identity& owner) {
  KeptMap kept;
  if (!active) return kept;
  const auto content = laser::content_of(*active);
  if (!content) {
    kept.had_one = kept.unreadable = true;
    kept.objections.push_back("the memory image in the unit is not valid: " + to_text(content.error()));
    return kept;
  }
  if (content->map.tables.empty() && content->map.header.declared_zero.empty()) return kept;
  kept.had_one = true;
  kept.objections = other_machine(content->map.header, owner);
  for (std::string& one : objections_to_map(content->map, parameters)) kept.objections.push_back(std::move(one));
  if (kept.objections.empty()) kept.image = active;
  return kept;
}

tl::unexpected<Problem> refused_for_map(const KeptMap& kept) {
  std::vector<std::string> why{
      kept.unreadable
          ? fmt::format(
                "{}; not sent. Send map and parameters with `ecs map send MAP --params FILE`, or the parameters "
                "alone with `ecs params send FILE --force`",
                kNoValidMap)
          : fmt::format("{}; not sent. Send a map for them with `ecs map send MAP --params FILE`, or delete the map in "
                        "the unit with `ecs params send FILE --force`",
                        kUnfitMap)};
  why.insert(why.end(), kept.objections.begin(), kept.objections.end());
  return tl::unexpected(*refused_map(why, {}));
}

}  // namespace

Result<std::optional<Image>> read_active_image(protocol::UnitClient& client,
                                               const protocol::ProgressCallback& progress) {
  ECS_TRY(before, client.active_map());
  ECS_DO(has_image(before));
  if (before.active_bank == Bank::none) return std::optional<Image>();
  ECS_TRY(image, client.read_memory(address_of(before.active_bank), before.image_length_bytes, progress));
  ECS_TRY(after, client.active_map());
  if (after.commit_sequence != before.commit_sequence || after.digest != before.digest)
    return problem(ProblemKind::refused, "the active map changed while it was read: read again");
  return std::optional<Image>(std::move(image));
}

Result<UnitParameters> receive_parameters(protocol::UnitClient& client) {
  ECS_TRY(status, client.status());
  if (status.active_bank == Bank::none)
    return problem(ProblemKind::refused, "the unit contains no parameters yet: send some with `ecs params send FILE`");
  const Address first = address_of(status.active_bank);
  ECS_TRY(bytes, client.read_memory(first, kPrefixBytes + kParameterBytes));
  const auto parameters = decode_parameters(ByteView(bytes).subspan(kPrefixBytes, kParameterBytes));
  if (load_big<std::uint32_t>(bytes, prefix_at::magic) != kImageMagic || !parameters)
    return problem(ProblemKind::refused,
                   "the parameters in the unit at 0x{:06X} cannot be read: the axis memory is corrupt; "
                   "inspect it with `ecs memory show --unit`, and send parameters and map again",
                   first);
  return *parameters;
}

std::optional<Problem> objections_to(const params::ParametersFile& file, const std::string& name,
                                     Incomplete incomplete) {
  std::vector<Problem> problems;
  const auto object = [&](std::string message) {
    problems.push_back({ProblemKind::refused, std::move(message), name, 0, 0, {}});
  };
  if (!file.has_end && incomplete == Incomplete::refuse)
    object(std::string(params::kNoParametersEnd) + ", or give --accept-incomplete");
  std::vector<params::Finding> findings = params::check_file(file);
  for (params::Finding& finding : params::check(file.parameters)) findings.push_back(std::move(finding));
  for (const params::Finding& finding : findings)
    if (finding.severity == params::Severity::error)
      object((finding.keys.empty() ? std::string() : finding.keys.front() + ": ") + finding.message);
  if (problems.empty()) return std::nullopt;
  return folded(std::move(problems));
}

std::vector<std::string> other_identity(std::span<const std::uint8_t> image, const protocol::Identity& unit) {
  const laser::StatedIdentity stated = laser::stated_identity(image);
  std::vector<std::string> objections;
  const auto object = [&](std::string_view what, std::string_view its, std::string_view unit_has,
                          std::string_view of_unit) {
    objections.push_back(fmt::format("the map is for {} \"{}\", but the unit {} \"{}\": {}", what, its, unit_has,
                                     of_unit, kTakeTheRightOne));
  };
  const auto differs = [](std::string_view its, std::string_view of_unit) {
    return !its.empty() && !of_unit.empty() && its != of_unit;
  };
  if (differs(stated.serial_number, unit.serial_number))
    object("serial number", stated.serial_number, "has", unit.serial_number);
  if (differs(machine_in_identity(stated.machine), unit.machine))
    object("machine", stated.machine, "belongs to", unit.machine);
  const auto parameters = ImageView(image).parameters();
  if (parameters && unit.configuration != 0 && configuration_hash(*parameters) != unit.configuration)
    objections.push_back(fmt::format(
        "the parameters are for the configuration {1} (code {0:08X}), the map in the unit for another (code {2:08X}): "
        "kinematic chain, axes present or convention differ; {3}",
        configuration_hash(*parameters), configuration_of(*parameters), unit.configuration, kTakeTheRightOne));
  return objections;
}

Result<Image> addressed(std::span<const std::uint8_t> image, const protocol::Identity& unit, Addressee addressee) {
  if (const ImageVerdict verdict = check_image(image); verdict.fault != ImageFault::none)
    return problem(ProblemKind::refused, "the memory image {}", text_of(verdict.fault));
  const bool as_stated = addressee == Addressee::as_stated;
  if (as_stated)
    if (auto refused = refused_map(other_identity(image, unit), {})) return tl::unexpected(std::move(*refused));
  const laser::StatedIdentity stated = laser::stated_identity(image);
  const auto parameters = ImageView(image).parameters();
  const std::uint32_t of_image = parameters ? configuration_hash(*parameters) : 0;
  const bool unit_has = unit.configuration != 0;
  return laser::with_identity({image.begin(), image.end()},
                              {unit.serial_number, unit.machine.empty() ? stated.machine : unit.machine,
                               unit_has ? unit.configuration : of_image});
}

namespace {

std::function<void(const SentImage&)>& watcher() {
  static std::function<void(const SentImage&)> watch;
  return watch;
}

/// How the active image differs from the one that was sent; empty: they have the same values, and the unit still had
/// them when all were read, since a restart in between can bring others. A problem where it is not that of the commit
/// any more.
Result<std::string> difference_in_unit(protocol::UnitClient& client, const Image& sent, std::uint32_t commit,
                                       const protocol::ProgressCallback& progress) {
  // What keeps the image from being read, a refused arming too, is no answer about the map.
  const auto not_read = [](Problem why) {
    why.kind = ProblemKind::link;
    return tl::unexpected(std::move(why));
  };
  const auto active = read_active_image(client, progress);
  if (!active && active.error().kind != ProblemKind::refused) return not_read(active.error());
  const auto now = client.active_map();
  if (!now) return not_read(now.error());
  if (now->commit_sequence == commit && now->digest != protocol::digest_of(sent))
    return std::string("its SHA-256 differs: its values have changed since the unit accepted them");
  if (now->commit_sequence != commit)
    return problem(ProblemKind::refused,
                   "the unit accepted the map (commit no. {}), but another map is now active (commit no. {}): "
                   "another host uses the unit; compare before compensating",
                   commit, now->commit_sequence);
  if (!active) return not_read(active.error());
  if (!*active) return std::string("the unit contains none");
  const Image& held = **active;
  if (held.size() != sent.size()) return fmt::format("it has {} bytes instead of {}", held.size(), sent.size());
  const auto [first, its] = std::mismatch(held.begin(), held.end(), sent.begin());
  if (first == held.end()) return std::string();
  std::size_t differ = 0;
  for (std::size_t i = 0; i < sent.size(); ++i)
    if (held[i] != sent[i]) ++differ;
  return fmt::format("{} of {} bytes differ, the first is byte {}", differ, sent.size(), first - held.begin());
}

/// What became of an image that was sent.
struct Upload {
  Result<protocol::UploadReport> sent;    ///< as the unit's checks say
  std::optional<Problem> not_compared{};  ///< why its values could not be read back
};

/// The image is active with the same values. CRC-32 finds what a line spoils and not what somebody has made to agree
/// with it: where only the checks agree, nothing that the unit holds counts, and all of the image is sent.
Upload upload(protocol::UnitClient& client, const Image& image, const protocol::ProgressCallback& progress) {
  std::string differs;
  for (const auto held : {protocol::Held::by_checks, protocol::Held::nothing}) {
    auto sent = client.upload_image(image, progress, held);
    if (!sent && !differs.empty())
      sent.error().message += fmt::format("; the active map in the unit differs from the one sent: {}", differs);
    if (!sent) return {std::move(sent)};
    const auto difference = difference_in_unit(client, image, sent->commit_sequence, progress);
    if (!difference) {
      Problem why = difference.error();
      if (why.kind != ProblemKind::refused)
        why.message = fmt::format(
            "the unit {}, and it is active (commit no. {}). Its values could not be compared: {}. Compare them with "
            "`ecs map verify`",
            sent->already_held ? "contains this map according to its checks" : "has accepted the new map",
            sent->commit_sequence, why.message);
      return {std::move(sent), std::move(why)};
    }
    if (difference->empty()) return {std::move(sent)};
    differs = *difference;
  }
  return {problem(
      ProblemKind::link,

      "the active map in the unit differs, although the whole map was sent and the checks agree: {}. Another host "
      "uses the unit, or its memory is damaged. Do not compensate with it; run the RAM test and send again",
      differs)};
}

}  // namespace

void watch_sent_images(std::function<void(const SentImage&)> watch) { watcher() = std::move(watch); }

Result<SendReport> send_image(protocol::UnitClient& client, std::span<const std::uint8_t> image, Addressee addressee,
                              const protocol::ProgressCallback& progress) {
  ECS_TRY(identity, client.identity());
  return send_image_to(client, identity, image, addressee, progress);
}

Result<SendReport> send_image_to(protocol::UnitClient& client, const protocol::Identity& unit,
                                 std::span<const std::uint8_t> bytes, Addressee addressee,
                                 const protocol::ProgressCallback& progress) {
  if (auto refused = refused_map(no_room_for(bytes, unit), {})) return tl::unexpected(std::move(*refused));
  ECS_TRY(image, addressed(bytes, unit, addressee));
  const auto [sent, not_compared] = upload(client, image, progress);
  if (watcher()) watcher()({unit, image, sent});
  if (!sent) return tl::unexpected(sent.error());
  if (not_compared) return tl::unexpected(*not_compared);
  return SendReport{image.size(),
                    ImageView(image).check(),
                    sent->commit_sequence,
                    sent->bytes_sent,
                    sent->already_held,
                    false,
                    false,
                    {}};
}

std::string tools_beyond_range(protocol::UnitClient& client, const UnitParameters& parameters) {
  const auto lines = client.control_lines();
  if (!lines || lines->tools == 0) return {};  // their table is a long read on a slow line
  const auto record = client.tool_record();
  std::vector<std::uint16_t> beyond;
  for (const Tool& tool : record ? record->table.tools : decltype(ToolTable::tools){})
    if (tool.number != 0 && !in_range(tool.offset_mm, parameters)) beyond.push_back(tool.number);
  if (beyond.empty()) return {};
  std::sort(beyond.begin(), beyond.end());
  const Vector3& range_mm = parameters.tool_range_mm;
  return fmt::format(
      "tool {} of the unit's table {} beyond the new tool range, X {:.10g}, Y {:.10g}, Z {:.10g} mm "
      "(compensation.tool_range_mm): the unit will not use {}",
      fmt::join(beyond, ", "), beyond.size() == 1 ? "is" : "are", range_mm[0], range_mm[1], range_mm[2],
      beyond.size() == 1 ? "it" : "them");
}

Result<SendReport> send_parameters(protocol::UnitClient& client, const UnitParameters& parameters,
                                   const params::Identity& owner, UnfitMap unfit,
                                   const protocol::ProgressCallback& progress) {
  ECS_TRY(active, read_active_image(client, progress));
  KeptMap kept = map_to_keep(active, parameters, owner);
  if (!kept.objections.empty() && unfit == UnfitMap::refuse) return refused_for_map(kept);
  ECS_TRY(image, kept.image ? laser::with_parameters(std::move(*kept.image), parameters) : laser::image_of(parameters));
  auto report = send_image(client, image, Addressee::this_unit, progress);
  if (!report) return report;
  report->map_kept = kept.had_one && kept.objections.empty();
  report->map_dropped = kept.had_one && !report->map_kept;
  report->map_objections = std::move(kept.objections);
  return report;
}

}  // namespace ecs::commissioning
