#include "commissioning/logbook/transfers.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/file_watch.hpp"
#include "base/json.hpp"
#include "commissioning/logbook/place.hpp"
#include "commissioning/logbook/recorder.hpp"
#include "commissioning/logbook/store.hpp"
#include "core/memory_image.hpp"
#include "laser/map/image.hpp"

namespace ecs::commissioning {
namespace {

constexpr const char* kImage = "image_sha256";

struct TransferToUnit {
  LogOwner owner;
  std::span<const std::uint8_t> image;
  std::uint32_t check = 0;          ///< its block check
  protocol::UploadReport report{};  ///< where it did not fail
  std::string problem{};            ///< why it failed; empty: it did not
};

TransferToUnit in_log(const SentImage& one) {
  const laser::StatedIdentity stated = laser::stated_identity(one.image);
  TransferToUnit transfer{{stated.machine.empty() ? one.unit.machine : stated.machine, one.unit.serial_number},
                          one.image,
                          ImageView(one.image).check()};
  if (one.sent)
    transfer.report = *one.sent;
  else
    transfer.problem = to_text(one.sent.error());
  return transfer;
}

/// Hashes of the images that were active, the oldest first.
std::vector<std::string> active_images(const LogOwner& owner) {
  const Unwatched own_files;
  std::vector<std::string> images;
  const auto setting = logbook_setting();
  const auto path = setting ? logbook_of(*setting, owner) : tl::unexpected(setting.error());
  const auto book = path && *path ? Logbook::open_to_read(**path) : problem(ProblemKind::bad_input, "");
  const auto entries = book ? book->activations() : tl::unexpected(book.error());
  if (!entries) return images;
  for (const LogbookEntry& entry : *entries) {
    const Json content = Json::parse(entry.content, nullptr, false);
    if (content.is_object()) images.push_back(content.value(kImage, std::string()));
  }
  return images;
}

bool is_rollback(const LogOwner& owner, const std::string& sha256) {
  const std::vector<std::string> images = active_images(owner);
  return images.size() >= 2 && images.back() != sha256 &&
         std::find(images.begin(), images.end(), sha256) != images.end();
}

LogRecord begun(const TransferToUnit& one, std::string kind, std::string summary, const Json& content) {
  LogRecord record;
  record.kind = std::move(kind);
  record.machine = one.owner.machine;
  record.serial_number = one.owner.serial_number;
  record.summary = std::move(summary);
  record.content = one_line(content);
  return record;
}

}  // namespace

void record_transfer(const SentImage& sent) {
  if (!logbook_is_kept()) return;
  const TransferToUnit one = in_log(sent);
  const std::string bytes(one.image.begin(), one.image.end());
  const std::string sha256 = sha256_hex(bytes);
  const std::string check = fmt::format("{:08X}", one.check);
  Json content{{kImage, sha256}, {"block_check", check}, {"direction", "to the unit"}};
  if (!one.problem.empty()) {
    content["problem"] = one.problem;
    record(begun(one, "transfer", fmt::format("not done: {}", one.problem), content));
    return;
  }
  content["bytes"] = bytes.size();
  content["bytes_sent"] = one.report.bytes_sent;
  content["commit_sequence"] = one.report.commit_sequence;
  if (one.report.already_held) {
    record(begun(one, "transfer", fmt::format("nothing sent: the unit held image {} already", check), content));
    return;
  }
  const bool rollback = is_rollback(one.owner, sha256);
  std::vector<LogRecord> both;
  both.push_back(begun(one, "transfer",
                       fmt::format("{} of {} bytes sent, block check {}", one.report.bytes_sent, bytes.size(), check),
                       content));
  LogRecord active = begun(one, rollback ? "rollback" : "activation",
                           fmt::format("image {} is active, commit {}{}", check, one.report.commit_sequence,
                                       rollback ? ": it was active before" : ""),
                           content);
  active.files.push_back({"image", "image " + check, std::make_shared<const std::string>(bytes)});
  both.push_back(std::move(active));
  record_all(std::move(both));
}

void record_memory_write(const MemoryWritten& one) {
  if (!logbook_is_kept()) return;
  const std::string place = fmt::format("0x{:06X}", one.address);
  Json content{{"direction", "to the unit"}, {"address", place}, {"bytes", one.bytes.size()}};
  if (!one.problem.empty()) content["problem"] = one.problem;
  LogRecord record;
  record.kind = "memory write";
  record.serial_number = one.serial_number;
  record.summary = one.problem.empty()
                       ? fmt::format("{} bytes written from {} on", one.bytes.size(), place)
                       : fmt::format("not confirmed: {} bytes from {} on: {}", one.bytes.size(), place, one.problem);
  record.content = one_line(content);
  record.files.push_back({"memory", place, std::make_shared<const std::string>(one.bytes.begin(), one.bytes.end())});
  commissioning::record(std::move(record));
}

}  // namespace ecs::commissioning
