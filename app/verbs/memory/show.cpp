// `ecs memory show, compare`: decoding dumps, without a unit.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "commissioning/memory/compare.hpp"
#include "commissioning/memory/view.hpp"

namespace ecs::app {
namespace {

constexpr std::string_view kUnitWord = "unit";

Result<MemoryDump> dump_of_unit(VerbContext& context, DumpScope scope) {
  ECS_TRY(unit, open_unit(context, Access::reads));
  return take_dump(unit.client(), unit.name(), scope, progress_bar(context, "memory"));
}

struct ShowArguments : VerbArguments {
  const std::string& file = text("FILE", "dump or memory image");
  const bool& unit = flag("--unit", "the active image of the unit");
  const bool& bytes = flag("--bytes", "names and meaning beside the bytes");
  const Access access = uses_link();
};

Result<Outcome> show(VerbContext& context, const ShowArguments& arguments) {
  if (arguments.unit == !arguments.file.empty())
    return problem(ProblemKind::usage, "memory show: give either a FILE or --unit");
  ECS_TRY(dump, arguments.unit ? dump_of_unit(context, DumpScope::active) : read_dump(arguments.file));
  return outcome_of(memory_cell(dump, decoded(dump), arguments.bytes));
}

struct CompareArguments : VerbArguments {
  const std::string& a = text("A", "dump, memory image, or `unit`", Need::required);
  const std::string& b = text("B", "dump, memory image, or `unit`", Need::required);
  const Access access = uses_link();
};

Result<MemoryDump> dump_from(VerbContext& context, const std::string& file_or_unit) {
  return file_or_unit == kUnitWord ? dump_of_unit(context, DumpScope::all) : read_dump(file_or_unit);
}

/// What is wrong with one of the two by itself: its file, or the image that its unit would use.
std::vector<std::string> damage_in(const MemoryDump& dump) {
  std::vector<std::string> damage = dump.damage;
  const DecodedMemory memory = decoded(dump);
  for (const DecodedImage& image : memory.images)
    if (&image == memory.main_image() && image.verdict.fault != ImageFault::none)
      damage.push_back(fmt::format("{}: the image {}", image.region, ecs::text_of(image.verdict.fault)));
  return damage;
}

Cell damage_cell(std::string_view side, const std::string& file, const MemoryDump& dump) {
  return lines_cell(damage_in(dump), fmt::format("DAMAGED {} ({}): ", side, file));
}

Result<Outcome> compare(VerbContext& context, const CompareArguments& arguments) {
  ECS_TRY(a, dump_from(context, arguments.a));
  ECS_TRY(b, dump_from(context, arguments.b));
  Cell found = list_cell(differences(a, b), [](const auto& one) {
    const auto& [what, in_a, in_b] = one;
    return record_cell("{what}: A {a} | B {b}\n",
                       {{"what", word_cell(what)}, {"a", word_cell(in_a)}, {"b", word_cell(in_b)}});
  });
  const bool same = found.json.empty();
  if (same) found.text = "no difference\n";
  const Cell damage_a = damage_cell("A", arguments.a, a), damage_b = damage_cell("B", arguments.b, b);
  return outcome_of(
      record_cell("{damaged}{differences}", {{"a", word_cell(arguments.a)},
                                             {"b", word_cell(arguments.b)},
                                             {"same", yes_cell(same, "", "")},
                                             {"damaged", record_cell("{a}{b}", {{"a", damage_a}, {"b", damage_b}})},
                                             {"differences", found}}),
      same && damage_a.json.empty() && damage_b.json.empty() ? kDone : kDoesNotHold);
}

}  // namespace

extern const VerbDefinition kMemoryShow =
    verb<ShowArguments>("memory show", "what a dump holds: parameters, tables, header, checks, faults",
                        "ecs memory show unit.ecsdump --bytes\n  ecs memory show --unit", show);

extern const VerbDefinition kMemoryCompare = verb<CompareArguments>(
    "memory compare", "the fields that differ between two dumps; `unit` means the connected unit",
    "ecs memory compare before.ecsdump after.ecsdump", compare);

}  // namespace ecs::app
