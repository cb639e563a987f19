// docs/parameters.md out of the field table.
#include <fmt/format.h>

#include "params/fields.hpp"

namespace ecs::params {
namespace {

constexpr std::string_view kHead = R"(# Parameters of the unit

What makes a unit fit its machine: the three groups of thesis section 5.3, with our additions (a dash in the last column).
Keys are paths in the TOML file and the names that `ecs params set` takes. Keys of an axis are shown for X; Y and Z have the same.
This page is written by `parameters_markdown()` from the table of fields in params/.

A file may begin with `[identity]`: `machine` and `serial_number`, texts that say whose parameters these are.
Keys that a file leaves out take the default; `params check`, `params send` and `map send` name each of them. The last line is
`# end of parameters`: without it, or without any key of a present axis, the file may have lost its end and is not sent. Squareness
is given as *error*; maps hold compensation.
)";

std::string cell(std::string text) {
  for (std::size_t at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2)) text.insert(at, 1, '\\');
  return text;
}

/// Keys that differ only in the axis are one line: that of X.
bool shown(const Field& field) { return !field.axis || *field.axis == Axis::X; }

std::string line(const Field& field) {
  return fmt::format("| `{}` | {} | {} | `{}` | {} | {} |\n", field.key, name_of(field.type), cell(range_text(field)),
                     default_text(field), cell(field.help), field.thesis_name.empty() ? "–" : cell(field.thesis_name));
}

}  // namespace

std::string parameters_markdown() {
  std::string page(kHead);
  for (const Group group : {Group::configuration, Group::compensation, Group::datuming}) {
    page += fmt::format("\n## {} parameters\n\n", name_of(group));
    page += "| key | type | accepts | default | what it does, how to find it | thesis name |\n";
    page += "|---|---|---|---|---|---|\n";
    for (const Field& field : fields())
      if (field.group == group && shown(field)) page += line(field);
  }
  return page;
}

}  // namespace ecs::params
