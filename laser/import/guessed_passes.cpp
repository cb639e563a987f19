#include "laser/import/guessed_passes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "laser/csv_columns.hpp"
#include "laser/findings.hpp"
#include "laser/import/fields.hpp"

namespace ecs::laser {

char axis_letter(const TableColumn& column, std::string_view letters, char otherwise) {
  for (const std::string& word : heading_words(column.heading))
    if (word.size() == 1 && letters.find(word[0]) != letters.npos) return word[0];
  return otherwise;
}

std::string error_unit(const TableColumn& column, double largest) {
  constexpr double kTooSmall_um = 0.1;
  if (column.unit) return std::string(column.unit->name);
  return largest < kTooSmall_um ? "mm" : "um";
}
double largest_of(const TableColumn& column) { return std::max(std::abs(column.least()), std::abs(column.most())); }

std::string reading_place(const TableColumn& column, const TableColumn& targets, bool actual, double largest) {
  const auto in = [&](std::string_view usual) {
    return fmt::format("{}[{}]", column.number, column.unit ? column.unit->name : usual);
  };
  if (actual) return in(targets.turns() ? "deg" : "mm");
  return in(targets.turns() ? "um/m" : error_unit(column, largest));
}

StatedSense sense_of(const TableColumn& column, char axis, bool is_sure, std::string_view used) {
  const std::string_view across = axis == 'x' ? "yz" : axis == 'y' ? "xz" : "xy";
  if (column.meaning == Meaning::temperature || !is_one_of(std::string_view(&axis, 1), {"x", "y", "z"})) return {};
  const auto named = [](char letter) { return fmt::format("E{}", static_cast<char>(letter - 'a' + 'A')); };
  const bool straight = is_straightness(column);
  for (const std::string& word : heading_words(column.heading)) {
    if (word.size() == 3 && word[0] == 'e' && word[2] == axis && word[1] != axis && sense_named(named(word[1])))
      return {named(word[1])};
    if (word.size() == 1 && across.find(word[0]) != across.npos && !column.turns() && (straight || is_sure))
      return {named(word[0])};
  }
  if (!straight) return {};
  const std::string text = lower(column.heading);
  const bool vertical = text.find("verti") != text.npos;
  if (vertical || text.find("horizontal") != text.npos)
    return {named(across[vertical ? 1 : 0]),
            fmt::format("The heading {} is read as {}{}", in_quotes(column.heading), named(across[vertical ? 1 : 0]),
                        axis == 'z' ? ", which is an assumption" : " on a machine whose Z is vertical")};
  const char free = used.find(named(across[0])) == used.npos ? across[0] : across[1];
  return {named(free),
          fmt::format("The heading {} does not state the direction of the straightness. Assumed is {}, the "
                      "other one is {}",
                      in_quotes(column.heading), named(free), named(free == across[0] ? across[1] : across[0]))};
}

namespace {

/// What a heading says of the pass or run whose readings are below.
struct PassHeading {
  std::string direction{}, number{};
  std::string rest{};  ///< the other words
};

/// "forward" of "Run 1 +" and "+X", "reverse" of "Run 1 -" and "-X".
std::string signed_direction(std::string_view heading) {
  const auto apart = [&](std::size_t at) {
    return at >= heading.size() || std::string_view(" ()[],;").find(heading[at]) != std::string_view::npos;
  };
  const auto letter = [&](std::size_t at) {
    return at < heading.size() && std::string_view("xyzabcXYZABC").find(heading[at]) != std::string_view::npos;
  };
  for (std::size_t i = 0; i < heading.size(); ++i) {
    if (heading[i] != '+' && heading[i] != '-') continue;
    const bool begins =
        i == 0 || apart(i - 1) || std::string_view("0123456789").find(heading[i - 1]) != std::string_view::npos;
    const bool behind_axis = i > 0 && letter(i - 1) && (i == 1 || apart(i - 2)) && apart(i + 1);
    if (behind_axis || (begins && (apart(i + 1) || (letter(i + 1) && apart(i + 2)))))
      return heading[i] == '+' ? "forward" : "reverse";
  }
  return {};
}

PassHeading pass_heading(const std::string& heading) {
  PassHeading pass;
  for (const std::string& word : heading_words(heading)) {
    const std::size_t digits = std::min(word.find_first_of("0123456789"), word.size());
    const std::string letters = word.substr(0, digits);
    const bool numbered = digits < word.size() && integer_in(word.substr(digits));
    if (numbered) pass.number = word.substr(digits);
    const auto approach =
        is_one_of(letters, {"", "pos", "neg"}) ? std::nullopt : approach_named(letters);  // pos: a position
    if (approach)
      pass.direction = *approach == Approach::forward ? "forward" : "reverse";
    else
      pass.rest += (numbered ? letters : word) + " ";
  }
  return pass;
}

bool is_statistic(const TableColumn& column) {
  const std::string text = lower(column.heading);
  const auto words = heading_words(text);
  return text.find("mittel") != text.npos || text.find("umkehr") != text.npos || text.find("spanne") != text.npos ||
         std::ranges::any_of(words, [](const auto& word) {
           return is_one_of(word,
                            {"mean", "avg", "average", "moyenne", "reversal", "hysteresis", "range", "max", "min"});
         });
}

}  // namespace

PassColumns pass_columns(const Columns& columns, const TableColumn& targets, const TableColumn& readings, bool actual,
                         const std::function<bool(const TableColumn&)>& like) {
  std::vector<std::pair<const TableColumn*, PassHeading>> found;
  for (const TableColumn& column : columns) {
    const bool may =
        column.meaning == Meaning::none || column.meaning == Meaning::reading || column.meaning == Meaning::position;
    const bool length = !column.unit || column.unit->kind == UnitKind::length || column.unit->kind == UnitKind::angle;
    if (may && length && (column.is_number() || column.has_gaps()) && &column != &targets && like(column) &&
        column.turns() == targets.turns() && column.is_reversed() == readings.is_reversed() &&
        (actual ? are_actual(column, targets) : are_small(column, targets)))
      found.emplace_back(&column, pass_heading(column.heading));
  }
  if (!std::ranges::all_of(found, [](const auto& one) { return is_statistic(*one.first); }))
    std::erase_if(found, [](const auto& one) { return is_statistic(*one.first); });
  const auto errors = [&](const auto& one) { return actual || are_errors(*one.first, targets); };
  if (std::ranges::none_of(found, errors)) return {};
  const auto count = [&](const std::string& direction) {
    return std::ranges::count_if(found, [&](const auto& one) { return one.second.direction == direction; });
  };
  if (count("") == std::ssize(found)) {
    for (auto& [column, pass] : found) pass.direction = signed_direction(column->heading);
    if (count("forward") == 0 || count("reverse") == 0)
      for (auto& [column, pass] : found) pass.direction.clear();
  }
  PassColumns passes;
  if (count("") + 1 >= std::ssize(found)) {  // runs whose approach is not named: headings that differ in the number
    const PassHeading own = pass_heading(readings.heading);
    std::erase_if(found, [&](const auto& one) { return one.second.number.empty() || one.second.rest != own.rest; });
    passes.by_motion = true;
  } else {
    std::erase_if(found, [](const auto& one) { return one.second.direction.empty(); });
  }
  if (!is_statistic(readings) && std::ranges::none_of(found, [&](const auto& one) { return one.first == &readings; }))
    return {};
  passes.numbered = std::ranges::any_of(found, [](const auto& one) { return !one.second.number.empty(); });
  if (passes.numbered) std::erase_if(found, [](const auto& one) { return one.second.number.empty(); });
  double largest = 0.0;
  for (const auto& one : found) largest = std::max(largest, largest_of(*one.first));
  std::map<std::string, const TableColumn*> fields;
  std::map<std::string, int> repeats;
  const bool repeated = !passes.numbered && (count("forward") > 1 || count("reverse") > 1);
  std::vector<std::string> rules;
  for (auto& [column, pass] : found) {
    const std::string direction = passes.by_motion ? "forward" : pass.direction;
    const std::string first = direction + "1";
    if (repeated && fields.contains(first) && fields[first]->heading != column->heading) return {};
    const std::string field = direction + (repeated ? std::to_string(++repeats[direction]) : pass.number);
    if (!pass_named(field) || !fields.emplace(field, column).second) return {};
    rules.push_back(field + "=" + reading_place(*column, targets, actual, largest));
  }
  if (rules.size() < 2) return {};
  passes.rules = fmt::format("{}{}", fmt::join(rules, ","), passes.by_motion ? ",approach=motion" : "");
  if (repeated) passes.assumed = "Columns with the same heading are assumed to be runs, in their order";
  if (passes.by_motion)
    passes.assumed =
        "The columns of readings are assumed to be runs by the numbers of their headings, and the approach follows "
        "from the order of the targets";
  passes.numbered = passes.numbered || repeated;
  return passes;
}

std::string sense_columns(const Columns& columns, const TableColumn& targets, const TableColumn& readings, char axis,
                          const SenseBy& sense_by, std::vector<std::string>& assumed) {
  const std::string own = fmt::format("E{}", static_cast<char>(axis - 'a' + 'A'));
  std::string used, rules;
  bool across = false;
  for (const TableColumn& column : columns) {
    const bool fits = column.is_number() && &column != &targets && column.is_reversed() == readings.is_reversed() &&
                      (&column == &readings || column.meaning == Meaning::reading);
    if (!fits) continue;
    auto [name, sentence] = sense_by(column, used);
    if (name.empty() && &column != &readings) continue;
    if (name.empty() && column.turns()) return {};
    across = across || !name.empty();
    if (name.empty()) name = own;
    const bool turns = is_rotation(*sense_named(name));
    if (used.find(name) != std::string::npos || (column.unit && turns != column.turns())) continue;
    used += name + " ";
    if (!sentence.empty()) assumed.push_back(std::move(sentence));
    rules += fmt::format("{}{}={}[{}]", rules.empty() ? "" : ",", name, column.number,
                         turns && !column.unit ? "um/m" : error_unit(column, largest_of(column)));
  }
  if (!across) assumed.clear();
  return across ? rules : std::string();
}

}  // namespace ecs::laser
