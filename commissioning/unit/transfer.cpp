#include "commissioning/unit/transfer.hpp"

#include <fmt/format.h>

#include "commissioning/unit/map_checks.hpp"
#include "core/memory_image.hpp"
#include "laser/map/image.hpp"

namespace ecs::commissioning {
namespace {

using protocol::Bank;
using Image = std::vector<std::uint8_t>;

Result<void> has_image(const protocol::UnitStatus& status) {
  if (status.active_bank == Bank::none) return {};
  if (status.image_length_bytes >= kPrefixBytes + kParameterBytes && status.image_length_bytes <= kBankBytes) return {};
  return problem(ProblemKind::link, fmt::format("unit: expected an active image of {} to {} bytes, it names {}",
                                                kPrefixBytes + kParameterBytes, kBankBytes, status.image_length_bytes));
}

/// What of a unit's image is worth keeping beside new parameters.
struct KeptMap {
  std::optional<Image> image;  ///< sound, with tables
  std::vector<std::string> objections;
  bool had_one = false;
};

KeptMap map_to_keep(const std::optional<Image>& active, const UnitParameters& parameters,
                    const params::Identity& owner) {
  KeptMap kept;
  if (!active) return kept;
  const auto content = laser::content_of(*active);
  if (!content) {
    kept.had_one = true;
    kept.objections.push_back("the map in the unit is not sound: " + to_text(content.error()));
    return kept;
  }
  if (content->map.tables.empty() && content->map.header.declared_zero.empty()) return kept;
  kept.had_one = true;
  kept.objections = objections_to_map(content->map, parameters);
  for (std::string& differs : other_machine(content->map.header, owner)) kept.objections.push_back(std::move(differs));
  if (kept.objections.empty()) kept.image = active;
  return kept;
}

/// The image fits the unit; asked before anything is sent.
Result<void> has_room(protocol::UnitClient& client, std::span<const std::uint8_t> image) {
  const auto identity = client.identity();
  if (!identity) return tl::unexpected(identity.error());
  if (auto refused = refused_map(no_room_for(image, *identity), {})) return tl::unexpected(std::move(*refused));
  return {};
}

/// What goes wrong once the unit has switched must not sound as if it had not.
tl::unexpected<Problem> after_commit(Problem why) {
  why.message = "the unit has taken what was sent, it is active; but looking at it afterwards: " + why.message;
  return tl::unexpected(std::move(why));
}

/// Prefix and parameters alone travel: the unit copies its active bank, and its CRC over the whole must agree.
Result<SendReport> send_head(protocol::UnitClient& client, Image image, const UnitParameters& parameters) {
  const auto changed = laser::with_parameters(std::move(image), parameters);
  if (!changed) return tl::unexpected(changed.error());
  if (const auto room = has_room(client, *changed); !room) return tl::unexpected(room.error());
  if (const auto sent = client.upload_image(*changed, {true, false, kPrefixBytes + kParameterBytes}); !sent)
    return tl::unexpected(sent.error());
  const auto held = receive_parameters(client);
  if (!held) return after_commit(held.error());
  if (*held != parameters)
    return problem(ProblemKind::link,
                   "the parameters read back from the unit are not those sent: another host has changed them, or the "
                   "unit's memory fails (`ecs utility ramtest`); read its status");
  const auto status = client.status();
  if (!status) return after_commit(status.error());
  return SendReport{changed->size(), status->commit_sequence, false, false, {}};
}

tl::unexpected<Problem> refused_for_map(const std::vector<std::string>& objections) {
  std::vector<Problem> problems{
      {ProblemKind::refused,
       "the map in the unit does not fit these parameters; nothing was sent. Send a map for them (`ecs map send MAP "
       "--params FILE` sends both), or give --force to send the parameters and drop the map",
       {},
       0,
       0,
       {}}};
  for (const std::string& objection : objections) problems.push_back({ProblemKind::refused, objection, {}, 0, 0, {}});
  return tl::unexpected(folded(std::move(problems)));
}

}  // namespace

Result<std::optional<Image>> read_active_image(protocol::UnitClient& client,
                                               const protocol::ProgressCallback& progress) {
  const auto before = client.status();
  if (!before) return tl::unexpected(before.error());
  if (const auto sane = has_image(*before); !sane) return tl::unexpected(sane.error());
  if (before->active_bank == Bank::none) return std::optional<Image>();
  auto image = client.read_memory(address_of(before->active_bank), before->image_length_bytes, progress);
  if (!image) return tl::unexpected(image.error());
  const auto after = client.status();
  if (!after) return tl::unexpected(after.error());
  if (after->commit_sequence != before->commit_sequence)
    return problem(ProblemKind::refused, "another map became active while it was read: read again");
  return std::optional<Image>(std::move(*image));
}

Result<UnitParameters> receive_parameters(protocol::UnitClient& client) {
  const auto status = client.status();
  if (!status) return tl::unexpected(status.error());
  if (status->active_bank == Bank::none)
    return problem(ProblemKind::refused, "the unit holds no parameters yet: send some with `ecs params send FILE`");
  const Address first = address_of(status->active_bank);
  const auto bytes = client.read_memory(first, kPrefixBytes + kParameterBytes);
  if (!bytes) return tl::unexpected(bytes.error());
  const auto parameters = decode_parameters(ByteView(*bytes).subspan(kPrefixBytes, kParameterBytes));
  if (load_big<std::uint32_t>(*bytes, prefix_at::magic) != kImageMagic || !parameters)
    return problem(ProblemKind::refused,
                   fmt::format("the parameters in the unit at 0x{:06X} cannot be read: the axis memory is corrupt; "
                               "look at it with `ecs memory show --unit`, and send parameters and map again",
                               first));
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

Result<SendReport> send_image(protocol::UnitClient& client, std::span<const std::uint8_t> image,
                              const protocol::ProgressCallback& progress) {
  if (const auto room = has_room(client, image); !room) return tl::unexpected(room.error());
  if (const auto sent = client.upload_image(image, {false, true}, progress); !sent) return tl::unexpected(sent.error());
  const auto status = client.status();
  if (!status) return after_commit(status.error());
  return SendReport{image.size(), status->commit_sequence, false, false, {}};
}

Result<SendReport> send_parameters(protocol::UnitClient& client, const UnitParameters& parameters,
                                   const params::Identity& owner, UnfitMap unfit,
                                   const protocol::ProgressCallback& progress) {
  const auto active = read_active_image(client, progress);
  if (!active) return tl::unexpected(active.error());
  KeptMap kept = map_to_keep(*active, parameters, owner);
  if (!kept.objections.empty() && unfit == UnfitMap::refuse) return refused_for_map(kept.objections);
  auto report = kept.image ? send_head(client, std::move(*kept.image), parameters)
                           : send_image(client, laser::image_of(parameters), progress);
  if (!report) return report;
  report->map_kept = kept.had_one && kept.objections.empty();
  report->map_dropped = kept.had_one && !report->map_kept;
  report->map_objections = std::move(kept.objections);
  return report;
}

}  // namespace ecs::commissioning
