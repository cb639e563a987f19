// `ecs memory read, write, dump, load`: bytes between unit and file. `show, compare`: decoding dumps, without a unit.

#include <algorithm>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/memory/bytes.hpp"
#include "commissioning/memory/compare.hpp"
#include "commissioning/memory/decode.hpp"
#include "commissioning/memory/names.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/unit/transfer.hpp"

namespace ecs::app {
namespace {

// --- read
struct ReadRequest {
  std::string address, length, output;
  bool hex = false;
  static Fields<ReadRequest> fields() {
    using R = ReadRequest;
    return {{"ADDRESS", &R::address, "first address, decimal or 0x…", Need::required},
            {"LENGTH", &R::length, "number of bytes, decimal or 0x…", Need::required},
            {"-o,--output", &R::output, "file for the raw bytes", Is::output},
            {"--hex", &R::hex, "print hexadecimal digits only"}};
  }
};

/// 16 bytes a line with address and characters.
std::string listing(Address first, ByteView bytes) {
  std::string text;
  for (std::size_t at = 0; at < bytes.size(); at += 16) {
    const ByteView row = bytes.subspan(at, std::min<std::size_t>(16, bytes.size() - at));
    std::string characters;
    for (const std::uint8_t byte : row) characters += byte >= 0x20 && byte < 0x7F ? static_cast<char>(byte) : '.';
    text += fmt::format("{}  {:<47}  {}\n", hex_address(first + static_cast<Address>(at)), hex_of(row), characters);
  }
  return text;
}

Result<Outcome> read_bytes(VerbContext& context, const ReadRequest& request) {
  ECS_TRY(address, whole_number(request.address, "ADDRESS"));
  ECS_TRY(length, whole_number(request.length, "LENGTH"));
  ECS_DO(within_space(address, length));
  ECS_DO(memory_there(address, length));
  ECS_TRY(unit, open_unit(context));
  ECS_TRY(identity, unit.client().identity());
  ECS_DO(memory_there(address, length, identity.memory_modules));
  ECS_TRY(bytes, unit.client().read_memory(address, length, progress_bar(context, "memory")));
  const bool to_stdout = request.output.empty();
  if (!to_stdout) ECS_DO(write_file(request.output, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
  const std::string digits = hex_of(bytes, "");
  return outcome_of(
      record_cell(to_stdout ? "{bytes}" : "{length} bytes written to {file}", "address"_is(hex_address(address)),
                  "length"_is(length), "file"_is(text_cell(request.output)),
                  "bytes"_is(to_stdout ? Cell{digits, request.hex ? digits : listing(address, bytes)} : shown_cell())));
}

// --- write
struct WriteRequest {
  std::string address, file;
  std::vector<std::string> words;
  bool yes = false;
  static Fields<WriteRequest> fields() {
    using R = WriteRequest;
    return {{"ADDRESS", &R::address, "first address, decimal or 0x…", Need::required},
            {"BYTES", &R::words, "bytes as hexadecimal digits, two per byte"},
            {"--file", &R::file, "write the bytes of this file"},
            {"--yes", &R::yes, "confirm that the bytes at ADDRESS are overwritten"}};
  }
};

Result<std::vector<std::uint8_t>> bytes_to_write(const WriteRequest& request) {
  if (request.words.empty() == request.file.empty())
    return problem(ProblemKind::usage, "memory write: give either bytes or --file");
  if (request.file.empty()) return hex_bytes(request.words);
  ECS_TRY(content, read_file(request.file));
  return std::vector<std::uint8_t>(content.begin(), content.end());
}

Result<Outcome> write_bytes(VerbContext& context, const WriteRequest& request) {
  ECS_TRY(address, whole_number(request.address, "ADDRESS"));
  ECS_TRY(bytes, bytes_to_write(request));
  ECS_DO(within_space(address, bytes.size()));
  ECS_DO(memory_there(address, bytes.size()));
  ECS_DO(may_write(MemoryBytes::of_unit(kMostModules), address, bytes.size()));
  ECS_DO(confirmed(request.yes,
                   fmt::format("{} bytes beginning at {} will be overwritten", bytes.size(), hex_address(address))));
  ECS_TRY(unit, open_unit(context));
  ECS_TRY(identity, unit.client().identity());
  ECS_DO(write_logged(unit.client(), identity.serial_number, address, bytes, progress_bar(context, "memory")));
  return outcome_of(record_cell("{length} bytes written, beginning at {address}", "address"_is(hex_address(address)),
                                "length"_is(bytes.size())));
}

// --- dump
struct DumpRequest {
  std::string output;
  bool active = false;
  static Fields<DumpRequest> fields() {
    using R = DumpRequest;
    return {{"-o,--output", &R::output, "file to write", Is::output, Need::required},
            {"--active", &R::active, "dump only the commit records and the active image"}};
  }
};

Result<Outcome> dump_memory(VerbContext& context, const DumpRequest& request) {
  ECS_TRY(unit, open_unit(context));
  ECS_TRY(dump, take_dump(unit.client(), unit.name(), request.active ? DumpScope::active : DumpScope::all,
                          progress_bar(context, "memory")));
  ECS_DO(write_file(request.output, to_bytes(dump)));
  std::size_t bytes = 0;
  for (const DumpRegion& region : dump.regions) bytes += region.bytes.size();
  return outcome_of(record_cell(
      "{bytes} bytes of unit {unit} written to {file}; `{show}` decodes it", "file"_is(request.output),
      "show"_shown(shell_command({"ecs", "memory", "show", request.output})), "unit"_shown(dump.serial_number),
      "bytes"_is(bytes), "regions"_is(list_cell(dump.regions, [](const DumpRegion& region) {
        return record_cell({}, "name"_is(region.name), "address"_is(hex_address(region.address)),
                           "bytes"_is(region.bytes.size()));
      }))));
}

// --- load
struct LoadRequest {
  std::string file;
  bool yes = false, other_machine = false;
  static Fields<LoadRequest> fields() {
    using R = LoadRequest;
    return {{"FILE", &R::file, "dump or memory image", Need::required},
            {"--yes", &R::yes, "overwrite the parameters and map in the unit"},
            {"--other-machine", &R::other_machine, "load even if dump or map name another unit"}};
  }
};

/// The bytes of the dump's main image, if it is one that a unit may have.
Result<std::vector<std::uint8_t>> sound_image(const MemoryDump& dump, const std::string& file) {
  const DecodedMemory memory = decoded(dump);
  const DecodedImage* image = memory.main_image();
  if (image == nullptr) return problem_at(file, 0, 0, "it contains no active memory image; not sent");
  if (image->verdict.fault != ImageFault::none)
    return problem_at(file, 0, 0, "its memory image {}; not sent", ecs::text_of(image->verdict.fault));
  const DumpRegion* region = region_at(dump, image->address);
  return std::vector<std::uint8_t>(region->bytes.begin(), region->bytes.begin() + image->bytes);
}

Result<Outcome> load(VerbContext& context, const LoadRequest& request) {
  ECS_TRY(dump, read_dump(request.file));
  for (const std::string& damage : dump.damage) context.console.warn(damage);
  ECS_TRY(image, sound_image(dump, request.file));
  ECS_DO(confirmed(request.yes, "parameters and map of the unit will be replaced by those of the dump"));
  ECS_TRY(unit, open_unit(context));
  ECS_TRY(identity, unit.client().identity());
  if (!request.other_machine)
    if (auto refused = refused_map(other_unit(dump.serial_number, image, identity.serial_number), request.file))
      return tl::unexpected(std::move(*refused));
  ECS_TRY(report, send_image(unit.client(), image, request.other_machine ? Addressee::this_unit : Addressee::as_stated,
                             progress_bar(context, "image")));
  return finished_outcome_of(record_cell(
      report.already_held
          ? "the unit already has the parameters and the map of {file}, commit no. {commit_sequence}: not sent again"
      : report.was_in_other_bank()
          ? "the unit already contained parameters and map of {file} in its inactive bank: nothing sent, made active, "
            "commit no. {commit_sequence}"
          : "parameters and map of {file} sent and verified: {bytes} bytes, commit no. {commit_sequence}",
      "file"_is(request.file), "bytes"_is(report.bytes), "commit_sequence"_is(report.commit_sequence),
      "verified"_is(true)));
}

constexpr std::string_view kUnitWord = "unit";

Result<MemoryDump> dump_of_unit(VerbContext& context, DumpScope scope) {
  ECS_TRY(unit, open_unit(context));
  return take_dump(unit.client(), unit.name(), scope, progress_bar(context, "memory"));
}

struct ShowRequest {
  std::string file;
  bool unit = false, bytes = false;
  static Fields<ShowRequest> fields() {
    using R = ShowRequest;
    return {{"FILE", &R::file, "dump or memory image"},
            {"--unit", &R::unit, "show the active image of the unit"},
            {"--bytes", &R::bytes, "show the name and meaning of the bytes"}};
  }
};

Result<Outcome> show(VerbContext& context, const ShowRequest& request) {
  if (request.unit == !request.file.empty())
    return problem(ProblemKind::usage, "memory show: give either a FILE or --unit");
  ECS_TRY(dump, request.unit ? dump_of_unit(context, DumpScope::active) : read_dump(request.file));
  return outcome_of(memory_cell(dump, decoded(dump), request.bytes));
}

struct CompareRequest {
  std::string a, b;
  static Fields<CompareRequest> fields() {
    using R = CompareRequest;
    return {{"FIRST", &R::a, "dump, memory image, or `unit`", Need::required},
            {"SECOND", &R::b, "dump, memory image, or `unit`", Need::required}};
  }
};

Result<MemoryDump> dump_from(VerbContext& context, const std::string& file_or_unit) {
  return file_or_unit == kUnitWord ? dump_of_unit(context, DumpScope::all) : read_dump(file_or_unit);
}

/// What is wrong with one of the two on its own: its file, or the image that its unit would use. Damaged bytes of a
/// file also spoil the checksum of the image; that is reported once.
std::vector<std::string> damage_in(const MemoryDump& dump) {
  std::vector<std::string> damage = dump.damage;
  const DecodedMemory memory = decoded(dump);
  const auto is_told = [&](const DecodedImage& image) {
    return image.verdict.fault == ImageFault::block_check &&
           std::ranges::any_of(dump.regions, [&](const DumpRegion& region) {
             return region.address == image.address && !region.intact;
           });
  };
  for (const DecodedImage& image : memory.images)
    if (&image == memory.main_image() && image.verdict.fault != ImageFault::none && !is_told(image))
      damage.push_back(fmt::format("{}: the image {}", image.region, ecs::text_of(image.verdict.fault)));
  return damage;
}

Cell damage_cell(std::string_view side, const std::string& file, const MemoryDump& dump) {
  return lines_cell(damage_in(dump), fmt::format("the {} dump ({}) is DAMAGED: ", side, file));
}

Result<Outcome> compare(VerbContext& context, const CompareRequest& request) {
  ECS_TRY(a, dump_from(context, request.a));
  ECS_TRY(b, dump_from(context, request.b));
  Cell found = list_cell(differences(a, b), [](const auto& one) {
    const auto& [what, in_a, in_b] = one;
    const bool is_unreadable = shown(in_a) != in_a || shown(in_b) != in_b;
    return record_cell(is_unreadable ? "{what}: in the first: {a} | in the second: {b} (?: unreadable character)\n"
                                     : "{what}: in the first: {a} | in the second: {b}\n",
                       "what"_is(what), "a"_is(in_a), "b"_is(in_b));
  });
  const bool same = found.json.empty();
  if (same) found.text = "no difference\n";
  const Cell damage_a = damage_cell("first", request.a, a), damage_b = damage_cell("second", request.b, b);
  return outcome_of(
      record_cell("{damaged}{differences}", "a"_is(request.a), "b"_is(request.b), "same"_is(same),
                  "damaged"_is(record_cell("{a}{b}", "a"_is(damage_a), "b"_is(damage_b))), "differences"_is(found)),
      same && damage_a.json.empty() && damage_b.json.empty() ? kDone : kDoesNotHold);
}

}  // namespace

extern const std::vector<Action> kMemory{
    action("memory read", "show bytes of the unit's memory or save them in a file", "ecs memory read 0x100000 64",
           read_bytes, {.link = Link::reads}),
    action("memory write", "write bytes into the unit's memory (needs --yes)", "ecs memory write 0x048000 4E75 --yes",
           write_bytes, {.link = Link::writes}),
    action("memory dump", "save all memory of the unit and its status in one file", "ecs memory dump -o unit.ecsdump",
           dump_memory, {.link = Link::reads, .logged = Logged::when_written, .kind = "transfer"}),
    action("memory load", "restore parameters and map of a dump into the unit (needs --yes)",
           "ecs memory load unit.ecsdump --yes", load, {.link = Link::writes}),
    action("memory show", "show the contents of a dump: parameters, tables, header, checks, faults",
           "ecs memory show unit.ecsdump --bytes\n  ecs memory show --unit", show, {.link = Link::reads}),
    action("memory compare", "list the fields that differ between two dumps; `unit` means the connected unit",
           "ecs memory compare before.ecsdump after.ecsdump", compare, {.link = Link::reads})};

}  // namespace ecs::app
