// `ecs memory read, write, dump, load`: bytes between unit and file.
#include "commissioning/unit/transfer.hpp"

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/numbers.hpp"
#include "base/text.hpp"
#include "commissioning/memory/decode.hpp"
#include "commissioning/memory/fields.hpp"
#include "commissioning/memory/space.hpp"
#include "commissioning/memory/write.hpp"
#include "commissioning/session/shell_word.hpp"
#include "commissioning/unit/map_checks.hpp"

namespace ecs::app {
namespace {

// --- read
struct ReadArguments : VerbArguments {
  const std::string& address = text("ADDRESS", "first address, decimal or 0x…", Need::required);
  const std::string& length = text("LENGTH", "bytes, decimal or 0x…", Need::required);
  const std::string& output = output_file("-o,--output", "file for the bytes as they are");
  const bool& hex = flag("--hex", "hexadecimal digits only");
  const Access access = uses_link();
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

std::string plain_hex(ByteView bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) text += fmt::format("{:02X}", byte);
  return text;
}

Result<Outcome> read_bytes(VerbContext& context, const ReadArguments& arguments) {
  ECS_TRY(address, whole_number(arguments.address, "ADDRESS"));
  ECS_TRY(length, whole_number(arguments.length, "LENGTH"));
  ECS_DO(within_space(address, length));
  ECS_DO(memory_there(address, length));
  ECS_TRY(unit, open_unit(context, arguments.access));
  ECS_TRY(identity, unit.client().identity());
  ECS_DO(memory_there(address, length, identity.memory_modules));
  ECS_TRY(bytes, unit.client().read_memory(address, length, progress_bar(context, "memory")));
  const bool to_stdout = arguments.output.empty();
  if (!to_stdout) ECS_DO(write_file(arguments.output, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
  const std::string digits = plain_hex(bytes);
  return outcome_of(record_cell(
      to_stdout ? "{bytes}" : "{length} bytes written to {file}",
      {{"address", word_cell(hex_address(address))},
       {"length", integer_cell(length)},
       {"file", text_cell(arguments.output)},
       {"bytes", to_stdout ? Cell{digits, arguments.hex ? digits : listing(address, bytes)} : shown_cell({})}}));
}

// --- write
struct WriteArguments : VerbArguments {
  const std::string& address = text("ADDRESS", "first address, decimal or 0x…", Need::required);
  const std::vector<std::string>& words = texts("BYTES", "hexadecimal digits, two a byte");
  const std::string& file = text("--file", "write the bytes of this file");
  const bool& yes = flag("--yes", "overwrite");
  const Access access = writes_to_unit();
};

Result<std::vector<std::uint8_t>> bytes_to_write(const WriteArguments& arguments) {
  if (arguments.words.empty() == arguments.file.empty())
    return problem(ProblemKind::usage, "memory write: give either bytes or --file");
  if (arguments.file.empty()) return hex_bytes(arguments.words);
  ECS_TRY(content, read_file(arguments.file));
  return std::vector<std::uint8_t>(content.begin(), content.end());
}

Result<Outcome> write_bytes(VerbContext& context, const WriteArguments& arguments) {
  ECS_TRY(address, whole_number(arguments.address, "ADDRESS"));
  ECS_TRY(bytes, bytes_to_write(arguments));
  ECS_DO(within_space(address, bytes.size()));
  ECS_DO(memory_there(address, bytes.size()));
  ECS_DO(may_write(MemoryBytes::of_unit(kMostModules), address, bytes.size()));
  ECS_DO(
      confirmed(arguments.yes, fmt::format("{} bytes from {} on are overwritten", bytes.size(), hex_address(address))));
  ECS_TRY(unit, open_unit(context, arguments.access));
  ECS_TRY(identity, unit.client().identity());
  if (auto written =
          write_logged(unit.client(), identity.serial_number, address, bytes, progress_bar(context, "memory"));
      !written)
    return tl::unexpected(written.error());
  return outcome_of(record_cell("{length} bytes written from {address} on",
                                {{"address", word_cell(hex_address(address))}, {"length", count_cell(bytes.size())}}));
}

// --- dump
struct DumpArguments : VerbArguments {
  const std::string& output = output_file("-o,--output", "file to write", Need::required);
  const bool& active = flag("--active", "only the commit records and the active image");
  const Access access = uses_link();
};

Result<Outcome> dump_memory(VerbContext& context, const DumpArguments& arguments) {
  ECS_TRY(unit, open_unit(context, arguments.access));
  ECS_TRY(dump, take_dump(unit.client(), unit.name(), arguments.active ? DumpScope::active : DumpScope::all,
                          progress_bar(context, "memory")));
  ECS_DO(write_file(arguments.output, to_bytes(dump)));
  std::size_t bytes = 0;
  for (const DumpRegion& region : dump.regions) bytes += region.bytes.size();
  return outcome_of(record_cell("{bytes} bytes of unit {unit} written to {file}; `{show}` decodes it",
                                {{"file", word_cell(arguments.output)},
                                 {"show", shown_cell(shell_command({"ecs", "memory", "show", arguments.output}))},
                                 {"unit", shown_cell(dump.serial_number)},
                                 {"bytes", count_cell(bytes)},
                                 {"regions", list_cell(dump.regions, [](const DumpRegion& region) {
                                    return record_cell({}, {{"name", word_cell(region.name)},
                                                            {"address", word_cell(hex_address(region.address))},
                                                            {"bytes", count_cell(region.bytes.size())}});
                                  })}}));
}

// --- load
struct LoadArguments : VerbArguments {
  const std::string& file = text("FILE", "dump or memory image", Need::required);
  const bool& yes = flag("--yes", "replace what the unit holds");
  const bool& other_machine = flag("--other-machine", "load although dump or map name another unit");
  const Access access = writes_to_unit();
};

/// The bytes of the dump's main image, if it is one that a unit may have.
Result<std::vector<std::uint8_t>> sound_image(const MemoryDump& dump, const std::string& file) {
  const DecodedMemory memory = decoded(dump);
  const DecodedImage* image = memory.main_image();
  if (image == nullptr) return problem_at(file, 0, 0, "it holds no active memory image; nothing was sent");
  if (image->verdict.fault != ImageFault::none)
    return problem_at(file, 0, 0,
                      fmt::format("its memory image {}; nothing was sent", ecs::text_of(image->verdict.fault)));
  const DumpRegion* region = region_at(dump, image->address);
  return std::vector<std::uint8_t>(region->bytes.begin(), region->bytes.begin() + image->bytes);
}

Result<Outcome> load(VerbContext& context, const LoadArguments& arguments) {
  ECS_TRY(dump, read_dump(arguments.file));
  for (const std::string& damage : dump.damage) context.console.warn(damage);
  ECS_TRY(image, sound_image(dump, arguments.file));
  ECS_DO(confirmed(arguments.yes, "parameters and map of the unit are replaced by those of the dump"));
  ECS_TRY(unit, open_unit(context, arguments.access));
  ECS_TRY(identity, unit.client().identity());
  if (!arguments.other_machine)
    if (auto refused = refused_map(other_unit(dump.serial_number, image, identity.serial_number), arguments.file))
      return tl::unexpected(std::move(*refused));
  const auto report =
      send_image(unit.client(), image, arguments.other_machine ? Addressee::this_unit : Addressee::as_stated,
                 progress_bar(context, "image"));
  if (!report) return tl::unexpected(report.error());
  return finished_outcome_of(
      record_cell("parameters and map of {file} sent and verified: {bytes} bytes, commit {commit_sequence}",
                  {{"file", word_cell(arguments.file)},
                   {"bytes", count_cell(report->bytes)},
                   {"commit_sequence", count_cell(report->commit_sequence)},
                   {"verified", yes_cell(true, "", "")}}));
}

}  // namespace

extern const VerbDefinition kMemoryRead = verb<ReadArguments>("memory read", "show or store bytes of the unit's memory",
                                                              "ecs memory read 0x100000 64", read_bytes);

extern const VerbDefinition kMemoryWrite =
    verb<WriteArguments>("memory write", "write bytes into the unit's memory (needs --yes)",
                         "ecs memory write 0x048000 4E75 --yes", write_bytes);

extern const VerbDefinition kMemoryDump =
    verb<DumpArguments>("memory dump", "all memory of the unit with its status, as one file",
                        "ecs memory dump -o unit.ecsdump", dump_memory);

extern const VerbDefinition kMemoryLoad =
    verb<LoadArguments>("memory load", "restore parameters and map of a dump into the unit (needs --yes)",
                        "ecs memory load unit.ecsdump --yes", load);

}  // namespace ecs::app
