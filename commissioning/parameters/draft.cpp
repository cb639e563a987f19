#include "commissioning/parameters/draft.hpp"

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::string_view kFile = "#@ file ";
constexpr std::string_view kMachine = "#@ machine ";
constexpr std::string_view kBase = "#@ as loaded";
constexpr const char* kName = "draft of the parameters screen";

Result<ParameterSet> set_in(const std::string& text) {
  ECS_TRY(parsed, params::parse_parameters(text, kName));
  return ParameterSet{parsed.parameters, parsed.identity};
}

}  // namespace

std::string draft_text(const ParametersDraft& draft) {
  return fmt::format("{}{}\n{}{}\n{}\n{}\n{}", kFile, draft.file, kMachine, draft.machine,
                     params::parameters_toml(draft.set.parameters, draft.set.identity), kBase,
                     params::parameters_toml(draft.base.parameters, draft.base.identity));
}

Result<ParametersDraft> parsed_draft(const std::string& text) {
  ParametersDraft draft;
  std::string set, base;
  std::string* part = &set;
  for (const std::string_view line : lines_of(text)) {
    if (line.starts_with(kFile)) draft.file = line.substr(kFile.size());
    if (line.starts_with(kMachine)) draft.machine = line.substr(kMachine.size());
    if (line == kBase) part = &base;
    part->append(line).push_back('\n');
  }
  auto edited = set_in(set);
  auto loaded = set_in(base);
  if (!edited) return tl::unexpected(edited.error());
  if (!loaded) return tl::unexpected(loaded.error());
  draft.set = std::move(*edited);
  draft.base = std::move(*loaded);
  return draft;
}

}  // namespace ecs::commissioning
