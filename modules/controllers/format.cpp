#include "modules/controllers/format.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::controllers {
namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/// Of a letter that stands apart at the end of the name: a capital after a small letter, or after no letter.
std::optional<Axis> axis_in_name(const std::string& file) {
  const std::string stem = std::filesystem::path(file).stem().string();
  if (stem.empty()) return std::nullopt;
  const char last = stem.back();
  const bool capital = last >= 'A' && last <= 'Z';
  const bool apart = stem.size() == 1 || !is_letter(stem[stem.size() - 2]) ||
                     (capital && stem[stem.size() - 2] >= 'a' && stem[stem.size() - 2] <= 'z');
  return apart ? axis_of(capital ? last : static_cast<char>(last - 'a' + 'A')) : std::nullopt;
}

}  // namespace

OptionValues::OptionValues(const std::vector<FormatOption>& options) {
  for (const FormatOption& option : options) set(option.name, std::string(option.fallback));
}

std::string_view OptionValues::text(std::string_view name) const {
  const auto at = values_.find(std::string(name));
  return at == values_.end() ? std::string_view() : at->second;
}

int OptionValues::integer(std::string_view name) const { return static_cast<int>(integer_in(text(name)).value_or(0)); }

std::vector<std::pair<std::optional<Axis>, std::string_view>> axis_pairs(std::string_view text) {
  std::vector<std::pair<std::optional<Axis>, std::string_view>> pairs;
  if (text.empty()) return pairs;
  for (const std::string_view word : split(text, ',')) {
    const std::string_view pair = trimmed(word);
    if (pair.size() > 2 && pair[1] == '=')
      pairs.emplace_back(axis_of(static_cast<char>(pair[0] & ~0x20)), pair.substr(2));
    else
      pairs.emplace_back(std::nullopt, pair);
  }
  return pairs;
}

Result<std::optional<Axis>> axis_option(const ReadRequest& request) {
  const std::string_view given = request.options.text("axis");
  if (given.empty()) return std::nullopt;
  if (!request.only_file)
    return problem(
        ProblemKind::usage,
        "--axis sets the axis of a single file; the axes of several files are read from their names or contents");
  for (const Axis axis : kAllAxes)
    if (lower(given) == lower(std::string(1, letter_of(axis)))) return axis;
  return problem(ProblemKind::usage, "expected an axis X, Y or Z, got \"{}\"", given);
}

Result<Axis> axis_of_file(const ReadRequest& request) {
  ECS_TRY(given, axis_option(request));
  if (const auto axis = given ? given : axis_in_name(request.file_name)) return *axis;
  return problem(ProblemKind::usage,
                 "{}: expected a name that ends in an axis letter of its own, as in y.comp, mill_y.comp or millY.comp: "
                 "give --axis",
                 request.file_name);
}

std::vector<const ControllerFormat*> formats_there();  // written by registry.cmake

std::span<const ControllerFormat* const> controller_formats() {
  static const std::vector<const ControllerFormat*> kFormats = [] {
    auto formats = formats_there();
    std::ranges::sort(formats, {}, &ControllerFormat::place);
    return formats;
  }();
  return kFormats;
}

const ControllerFormat* controller_format(std::string_view id) {
  const auto formats = controller_formats();
  const auto at = std::ranges::find_if(formats, [&](const auto* format) { return format->id == id; });
  return at == formats.end() ? nullptr : *at;
}

const ControllerFormat* recognised_format(std::string_view text) {
  const auto formats = controller_formats();
  const auto at = std::ranges::find_if(formats, [&](const auto* format) { return format->recognises(text); });
  return at == formats.end() ? nullptr : *at;
}

std::string holds_row(const ControllerFormat& format) {
  const Holds& holds = format.holds;
  return fmt::format("| {} | {} | {} | {} | {} | {} | {} |", format.name, holds.positioning, holds.reversal,
                     holds.straightness, holds.squareness, holds.rotations, holds.points);
}

}  // namespace ecs::controllers
