#include "commissioning/memory/dump.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "base/json.hpp"
#include "commissioning/memory/bytes.hpp"
#include "commissioning/unit/transfer.hpp"
#include "core/memory_image.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::string_view kMagic = "ECSDUMP 1 ";

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

// --- taking
struct DumpPart {
  Region region;
  std::uint32_t size = 0;
};

std::vector<DumpPart> parts_of(const StatusSnapshot& snapshot, DumpScope scope) {
  const auto modules =
      static_cast<std::uint8_t>(std::min<std::uint16_t>(snapshot.identity.memory_modules, kMostModules));
  const std::uint32_t bank = bank_bytes(modules);
  if (scope == DumpScope::all)
    return {{kEprom, kEprom.size},
            {kSystemRam, kSystemRam.size},
            {kCommitRecords, kCommitRecords.size},
            {kThermalRecord, kThermalRecord.size},
            {kToolRecord, kToolRecord.size},
            {kBankA, bank},
            {kBankB, bank}};
  std::vector<DumpPart> wanted{{kCommitRecords, kCommitRecords.size}};
  if (snapshot.status.active_bank != protocol::Bank::none)
    wanted.push_back({snapshot.status.active_bank == protocol::Bank::B ? kBankB : kBankA,
                      std::min(snapshot.status.image_length_bytes, bank)});
  return wanted;
}

std::size_t total_of(const std::vector<DumpPart>& wanted) {
  std::size_t total = 0;
  for (const DumpPart& part : wanted) total += part.size;
  return total;
}

// --- reading
std::optional<std::uint32_t> number_at(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number_unsigned()) return std::nullopt;
  const auto value = found->get<std::uint64_t>();
  if (value > 0xFFFFFFFFu) return std::nullopt;
  return static_cast<std::uint32_t>(value);
}

/// One region as the header announces it; takes its bytes off the front of `content`.
void take_region(const Json& entry, std::string_view& content, MemoryDump& dump) {
  const auto address = number_at(entry, "address");
  const auto size = number_at(entry, "bytes");
  if (!entry.is_object() || !address || !size) {
    dump.damage.push_back("the header lists a region that cannot be read; the data after it may be misplaced");
    return;
  }
  DumpRegion region{text_at(entry, "name"), *address, {}, *size, true};
  const std::string_view piece = content.substr(0, *size);
  content.remove_prefix(piece.size());
  region.bytes.assign(piece.begin(), piece.end());
  if (piece.size() < *size) {
    region.intact = false;
    dump.damage.push_back(fmt::format("{}: the file is cut short: {} of {} bytes", region.name, piece.size(), *size));
  } else if (hexadecimal(text_at(entry, "crc32")) != crc32_of(region.bytes)) {
    region.intact = false;
    dump.damage.push_back(
        fmt::format("{}: its bytes do not agree with their CRC-32, so the file was changed", region.name));
  }
  dump.regions.push_back(std::move(region));
}

void take_status(const Json& header, const std::string& name, MemoryDump& dump) {
  const auto found = header.find("status");
  if (found == header.end() || !found->is_object()) return;
  auto status = parse_snapshot(one_line(*found), name);
  if (status)
    dump.status = std::move(*status);
  else
    dump.damage.push_back("the status in the header cannot be read: " + status.error().message);
}

/// Its own checksum vouches for an image whose region has lost its CRC.
bool is_whole_image(std::string_view piece) {
  return check_image({reinterpret_cast<const std::uint8_t*>(piece.data()), piece.size()}).fault == ImageFault::none;
}

/// Memory images are found by their first word where the header is lost.
void search_images(std::string_view content, MemoryDump& dump) {
  constexpr std::string_view word("ECSI");
  const std::array<Region, 2> banks{kBankA, kBankB};
  std::size_t at = content.find(word);
  for (const Region& bank : banks) {
    if (at == std::string_view::npos) return;
    const std::size_t next = content.find(word, at + 1);
    const std::string_view piece = content.substr(
        at, std::min<std::size_t>(next == std::string_view::npos ? content.size() : next - at, bank.size));
    dump.regions.push_back({std::string(bank.name),
                            bank.first,
                            {piece.begin(), piece.end()},
                            static_cast<std::uint32_t>(piece.size()),
                            is_whole_image(piece)});
    at = next;
  }
}

Result<MemoryDump> bare_image(std::string_view bytes) {
  MemoryDump dump;
  dump.regions.push_back(
      {"memory image", kBankA.first, {bytes.begin(), bytes.end()}, static_cast<std::uint32_t>(bytes.size()), true});
  dump.image_alone = true;
  return dump;
}

Json header_of(const MemoryDump& dump) {
  Json regions = Json::array();
  for (const DumpRegion& region : dump.regions)
    regions.push_back(object_of("name"_is(region.name), "address"_is(region.address), "bytes"_is(region.bytes.size()),
                                "crc32"_is(fmt::format("{:08X}", crc32_of(region.bytes)))));
  Json header = object_of("taken"_is(dump.taken), "link"_is(dump.link), "serial_number"_is(dump.serial_number));
  if (dump.status) header["status"] = json_with_registers(*dump.status);
  header["regions"] = regions;
  return header;
}

}  // namespace

Result<MemoryDump> take_dump(protocol::UnitClient& client, const std::string& link, DumpScope scope,
                             const protocol::ProgressCallback& progress) {
  ECS_TRY(snapshot, take_snapshot(client, link, protocol::kKeptEvents));
  MemoryDump dump{now_utc(), link, snapshot.identity.serial_number, std::nullopt, {}, {}};
  const auto wanted = parts_of(snapshot, scope);
  const std::size_t total = total_of(wanted);
  std::size_t before = 0;
  for (const auto& [region, size] : wanted) {
    ECS_TRY(bytes, client.read_memory(region.first, size, [&](const protocol::Progress& piece) {
      const double whole_left = static_cast<double>(total - before - piece.bytes_done);
      const double piece_left = static_cast<double>(std::max<std::size_t>(1, piece.bytes_total - piece.bytes_done));
      if (progress) progress({before + piece.bytes_done, total, piece.seconds_left * whole_left / piece_left});
    }));
    dump.regions.push_back({std::string(region.name), region.first, std::move(bytes), size, true});
    before += size;
  }
  ECS_TRY(after, client.status());
  if (after.commit_sequence != snapshot.status.commit_sequence)
    return problem(ProblemKind::refused, "another map became active while memory was read: repeat the dump");
  dump.status = std::move(snapshot);
  return dump;
}

std::string to_bytes(const MemoryDump& dump) {
  const std::string header = one_line(header_of(dump));
  std::string out = fmt::format("{}{:08X}\n{}\n", kMagic, crc32_of(bytes_of(header)), header);
  for (const DumpRegion& region : dump.regions) out.append(region.bytes.begin(), region.bytes.end());
  return out;
}

Result<MemoryDump> dump_in(std::string_view bytes, const std::string& name) {
  if (bytes.starts_with("ECSI")) return bare_image(bytes);
  MemoryDump dump;
  const std::size_t first_end = bytes.find('\n');
  const std::size_t header_end = first_end == std::string_view::npos ? first_end : bytes.find('\n', first_end + 1);
  const bool has_lines = bytes.starts_with("ECSDUMP") && header_end != std::string_view::npos;
  const std::string_view header_text =
      has_lines ? bytes.substr(first_end + 1, header_end - first_end - 1) : std::string_view();
  const Json header = Json::parse(header_text, nullptr, false);
  if (!has_lines || !header.is_object() || !header.contains("regions") || !header["regions"].is_array()) {
    search_images(bytes, dump);
    if (dump.regions.empty()) return problem_at(name, 0, 0, "expected a dump of `ecs memory dump` or a memory image");
    dump.damage.push_back("the header of the dump cannot be read; memory images were searched for in its bytes");
    return dump;
  }
  const std::string_view first_line = bytes.substr(0, first_end);
  if (!first_line.starts_with(kMagic) ||
      hexadecimal(first_line.substr(std::min(first_line.size(), kMagic.size()))) != crc32_of(bytes_of(header_text)))
    dump.damage.push_back("the header of the dump does not agree with its CRC-32");
  dump.taken = text_at(header, "taken");
  dump.link = text_at(header, "link");
  dump.serial_number = text_at(header, "serial_number");
  take_status(header, name, dump);
  std::string_view content = bytes.substr(header_end + 1);
  for (const Json& entry : header["regions"]) take_region(entry, content, dump);
  if (!content.empty()) dump.damage.push_back(fmt::format("{} bytes follow the last region", content.size()));
  return dump;
}

Result<MemoryDump> read_dump(const std::filesystem::path& path) {
  ECS_TRY(bytes, read_file_of(FileKind::memory, path));
  return dump_in(bytes, path.string());
}

const DumpRegion* region_at(const MemoryDump& dump, Address address) {
  for (const DumpRegion& region : dump.regions)
    if (region.address == address) return &region;
  return nullptr;
}

}  // namespace ecs::commissioning
