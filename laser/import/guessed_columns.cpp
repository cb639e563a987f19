#include "laser/import/guessed_columns.hpp"

#include <cmath>
#include <utility>

#include "base/text.hpp"
#include "laser/csv_columns.hpp"
#include "laser/import/fields.hpp"

namespace ecs::laser {
namespace {

constexpr std::size_t kLeastTargets = 3;
constexpr std::size_t kRowsATurn = 4;  ///< positions turn back less often than every this many rows
/// Errors [um] vary by less than this part of the travel [mm]: 300 um/m. Coordinates beside a position vary by more.
constexpr double kGreatestSlope_um_per_mm = 0.3;
/// Errors lie round the 0 of a readout; coordinates that hardly change lie far from it.
constexpr double kGreatestOffset = 3.0;
/// Actual positions are as close to their targets as this part of the travel; of a poor encoder, whose positions begin
/// and end with the targets, as this.
constexpr double kClose = 0.001, kLooselyClose = 0.05;
/// An axis at one place for so many rows one after the other rests.
constexpr std::size_t kRowsAtRest = 10;
/// Over a tenth of a run no body of a machine and no air round it warms faster: a spindle at its greatest speed warms
/// by about 1 degC/min at first, and slower from then on.
constexpr double kFastest_degC_per_s = 3.0 / 60.0;
constexpr std::size_t kPartsOfRun = 10;
/// Farther than any axis goes, and what the readers refuse: stamps of time in ticks.
constexpr double kFarthest_mm = 1e6;

using Words = std::initializer_list<std::string_view>;

bool begins_with_one(std::string_view word, Words beginnings) {
  return std::ranges::any_of(beginnings, [&](std::string_view beginning) { return word.starts_with(beginning); });
}
bool has_one(std::string_view text, Words parts) {
  return std::ranges::any_of(parts, [&](std::string_view part) { return text.find(part) != text.npos; });
}

bool names_error(std::string_view word) {
  return has_one(word, {"error", "deviation", "d\xC3\xA9viation", "abweichung", "fehler", "erreur", "\u00E9cart",
                        "\u00C9cart", "ecart"}) ||
         is_one_of(word, {"err", "dev", "abw"});
}
bool names_difference(std::string_view word) {
  return has_one(word, {"differ", "diff\xC3\xA9r", "unterschied", "delta", "\u0394", "\u03B4"}) || word == "diff";
}
bool names_target(std::string_view word) {
  return begins_with_one(word, {"soll", "target", "nomin", "command", "setpoint", "theor", "th\xC3\xA9or", "desired",
                                "cible", "consigne"}) ||
         is_one_of(word, {"nom", "cmd", "ref", "reference"});
}
bool names_actual(std::string_view word) {
  return begins_with_one(word, {"actual", "measur", "gemess", "messw", "istw", "istp", "observed", "mesur"}) ||
         is_one_of(word, {"ist", "act", "meas", "mes", "laser",
                          "r\xC3\xA9"
                          "el"});
}
bool names_correction(std::string_view word) {
  return has_one(word, {"korrektur", "correction", "kompensation", "compensation"}) ||
         is_one_of(word, {"korr", "corr"});
}

/// Words in lower case, with "-" for a minus between them.
std::vector<std::string> words_and_minus(std::string_view heading) {
  std::string text = lower(heading);
  for (const std::string_view dash : {"\u2212", "\u2013"})
    for (std::size_t at = text.find(dash); at != text.npos; at = text.find(dash)) text.replace(at, dash.size(), "-");
  std::vector<std::string> words;
  for (const std::string_view part : split(text, '-')) {
    if (!words.empty()) words.emplace_back("-");
    for (std::string& word : heading_words(part)) words.push_back(word == "minus" ? "-" : std::move(word));
  }
  std::erase(words, "");
  return words;
}

/// Of "Soll-Ist" or "actual position - target position"; a noun behind the first, "Soll-Ist-Abweichung", names the pair
/// and leaves the order open.
std::optional<HeadingSign> sign_of_pair(const std::vector<std::string>& words) {
  constexpr std::size_t kApart = 2;  // "position" and a unit between a word and the minus
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] != "-") continue;
    for (std::size_t left = i; left-- > (i > kApart ? i - kApart : 0);)
      for (std::size_t right = i + 1; right < std::min(words.size(), i + 1 + kApart); ++right) {
        const bool reversed = names_target(words[left]) && names_actual(words[right]);
        if (!reversed && !(names_actual(words[left]) && names_target(words[right]))) continue;
        const bool open =
            reversed && std::any_of(words.begin() + static_cast<std::ptrdiff_t>(right), words.end(), [](const auto& w) {
              return names_error(w) || names_difference(w) || has_one(w, {"vergleich", "compar"});
            });
        return HeadingSign{reversed, false, open};
      }
  }
  return std::nullopt;
}

/// "exx", "eyx", "eax": an error of ISO 230-1.
bool is_component(std::string_view word) {
  return word.size() == 3 && word[0] == 'e' && has_one("xyzabc", {word.substr(1, 1)}) &&
         has_one("xyz", {word.substr(2, 1)});
}

/// By words of English, German and French headings.
Meaning meaning_of(const std::string& heading, const std::optional<Unit>& unit) {
  const std::string text = lower(heading);
  const auto has = [&](Words parts) { return has_one(text, parts); };
  const auto words = heading_words(heading);
  const auto is_word = [&](Words any) {
    return std::ranges::any_of(words, [&](const std::string& word) { return is_one_of(word, any); });
  };
  if (has({"std", "standard", "sigma", "uncertainty", "unsicherheit", "incertitude", "streuung"}))
    return Meaning::other;
  if (unit && unit->kind == UnitKind::temperature) return Meaning::temperature;
  if (unit && unit->kind == UnitKind::pressure) return Meaning::pressure;
  if (has({"feucht", "humid"})) return Meaning::humidity;
  if (has({"approach", "direction", "richtung", "anfahr", "approche"}) || is_word({"dir", "sens"}))
    return Meaning::approach;
  if (sign_in_heading(heading) || has({"reading", "displacement", "geradheit", "straight", "rectitud"}) ||
      is_word({"disp"}) || std::ranges::any_of(words, is_component))
    return Meaning::reading;
  if (unit && unit->kind == UnitKind::time) return Meaning::time;
  if (!unit &&
      (has({"cycle", "zyklus"}) || is_word({"run", "lauf", "messlauf", "durchgang", "nr", "no", "num", "nummer",
                                            "passage", "essai", "serie", "series", "repeat", "wdh", "wiederholung"})))
    return Meaning::run;
  if (!unit && is_word({"index", "count", "sample", "row", "zeile", "point", "punkt", "messpunkt", "n", "i"}))
    return Meaning::counter;
  if (has({"position", "target", "nominal", "soll", "cible", "consigne", "angle", "winkel"}) ||
      is_word({"pos", "x", "y", "z", "a", "b", "c", "weg"}))
    return Meaning::position;
  return Meaning::none;
}

bool are_positions(const TableColumn& column) {
  std::size_t moves = 0, turns = 0;
  double before = 0.0;
  for (std::size_t i = 1; i < column.values.size(); ++i) {
    const double step = column.values[i] - column.values[i - 1];
    if (step == 0.0) continue;
    if (step * before < 0.0) ++turns;
    ++moves;
    before = step;
  }
  return moves + 1 >= kLeastTargets && turns * kRowsATurn <= moves;
}

}  // namespace

SuggestedRows rows_of(const TableShape& shape) {
  return {(shape.is_mixed ? shape.stretch_line : shape.first_row_line) - 1, shape.is_mixed ? shape.stretch_rows : 0};
}

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

std::optional<HeadingSign> sign_in_heading(std::string_view heading) {
  const auto words = words_and_minus(heading);
  if (const auto pair = sign_of_pair(words)) return pair;
  const bool corrects = !has_one(lower(heading), {"fakt", "factor", "facteur", "temp", "ppm"});
  std::optional<HeadingSign> sign;
  bool beside = false;  // "error after correction": the correction is over, or not yet
  for (const std::string& word : words) {
    beside = beside || is_one_of(word, {"after", "with", "without", "before", "no", "nach", "mit", "ohne", "vor",
                                        "apr\xC3\xA8s", "avec", "sans", "avant"});
    if (corrects && names_correction(word) &&
        !beside)  // behind an error, "Error correction", or of one word, "Fehlerkorrektur"
      sign = HeadingSign{true, true, sign.has_value() || names_error(word)};
    else if (names_error(word))
      sign = HeadingSign{false, false, sign && sign->is_correction};
    else if (names_difference(word) && !sign)
      sign = HeadingSign{false, false, true};
  }
  return sign;
}

Columns columns_of(std::string_view text, const TableShape& shape) {
  Columns columns;
  for (std::size_t i = 0; i < shape.columns; ++i) {
    TableColumn column;
    column.number = i + 1;
    if (i < shape.headings.size()) column.heading = shape.headings[i];
    column.unit = unit_in_heading(column.heading);
    column.meaning = meaning_of(column.heading, column.unit);
    if (column.meaning == Meaning::reading) column.sign = sign_in_heading(column.heading);
    columns.push_back(std::move(column));
  }
  const SuggestedRows rows = rows_of(shape);
  const auto lines = lines_of(text);
  const auto last = std::min(lines.size(), static_cast<std::size_t>(shape.last_row_line));
  std::size_t taken = 0;
  for (auto i = static_cast<std::size_t>(rows.skip); i < last && (rows.count == 0 || taken < rows.count); ++i) {
    if (is_comment(lines[i])) continue;
    const auto cells = cells_of(lines[i], shape.delimiter);
    if (cells.size() != shape.columns) continue;
    ++taken;
    for (std::size_t c = 0; c < columns.size(); ++c) columns[c].cells.push_back(cells[c]);
  }
  for (TableColumn& column : columns) {
    for (const std::string_view cell : column.cells)
      if (const auto number = number_or_comma(cell)) column.numbers.push_back(*number);
    if (column.numbers.size() == column.cells.size()) column.values = column.numbers;
    const auto is_flag = [](double value) { return value == 0.0 || value == 1.0; };
    if (column.is_reversed() && !column.unit &&
        std::ranges::all_of(column.numbers, is_flag)) {  // whether it was active
      column.meaning = Meaning::other;
      column.sign.reset();
    }
    const bool whole = std::ranges::all_of(column.numbers, [](double value) { return value == std::floor(value); });
    const bool numbered = column.heading.find_first_of("0123456789") != std::string::npos;
    if (column.meaning == Meaning::run && (numbered || !whole)) column.meaning = Meaning::none;  // readings of a run
  }
  return columns;
}

bool counts_rows(const TableColumn& column) {
  if (column.values.front() != 0.0 && column.values.front() != 1.0) return false;
  for (std::size_t i = 1; i < column.values.size(); ++i)
    if (column.values[i] != column.values[i - 1] + 1.0) return false;
  return true;
}

bool are_runs(const TableColumn& column) {
  return column.is_number() && !counts_rows(column) && std::ranges::all_of(column.values, [](double value) {
           return value == std::floor(value) && std::abs(value) < 1e6;
         });
}

bool is_straightness(const TableColumn& column) {
  return !column.turns() &&
         has_one(lower(column.heading), {"geradheit", "straight", "rectitud", "horizontal", "vertical", "vertikal"});
}

bool are_actual(const TableColumn& column, const TableColumn& targets) {
  double largest = 0.0;
  for (std::size_t i = 0; i < column.values.size(); ++i)
    largest =
        std::max(largest, std::abs(column.values[i] * column.as_target() - targets.values[i] * targets.as_target()));
  return !column.values.empty() && largest > 0.0 && largest <= kClose * targets.span() * targets.as_target();
}

bool are_loosely_actual(const TableColumn& column, const TableColumn& targets) {
  const double allowed = kLooselyClose * targets.span();
  if (column.unit || targets.unit || column.span() == 0.0) return false;
  if (std::abs(column.least() - targets.least()) > allowed || std::abs(column.most() - targets.most()) > allowed)
    return false;
  for (std::size_t i = 0; i < column.values.size(); ++i)
    if (std::abs(column.values[i] - targets.values[i]) > allowed) return false;
  return column.values != targets.values;
}

bool is_one_turn(const TableColumn& targets) {
  constexpr double kTurn = 360.0;
  return !targets.unit && std::abs(targets.span() - kTurn) < kLooselyClose * kTurn;
}

bool rests(const TableColumn& targets) {
  std::size_t same = 1, longest = 1;
  for (std::size_t i = 1; i < targets.values.size(); ++i) {
    same = targets.values[i] == targets.values[i - 1] ? same + 1 : 1;
    longest = std::max(longest, same);
  }
  return longest >= kRowsAtRest;
}

bool are_small(const TableColumn& column, const TableColumn& targets) {
  return std::max(std::abs(column.least()), std::abs(column.most())) * column.as_error() <=
         kGreatestSlope_um_per_mm * targets.span() * targets.as_target();
}

bool are_errors(const TableColumn& column, const TableColumn& targets) {
  const double largest = std::max(std::abs(column.least()), std::abs(column.most()));
  return column.span() > 0.0 &&
         column.span() * column.as_error() <= kGreatestSlope_um_per_mm * targets.span() * targets.as_target() &&
         largest <= kGreatestOffset * column.span();
}

bool could_be_targets(const TableColumn& column, const Columns& columns) {
  if (!column.is_number() || (column.meaning != Meaning::position && column.meaning != Meaning::none)) return false;
  if (column.unit && column.unit->kind != UnitKind::length && column.unit->kind != UnitKind::angle) return false;
  const auto numbers = std::ranges::count_if(columns, [](const auto& one) { return one.is_number(); });
  const bool is_first =
      std::ranges::none_of(columns, [&](const auto& one) { return one.is_number() && one.number < column.number; });
  if (std::max(std::abs(column.least()), std::abs(column.most())) * column.as_target() > kFarthest_mm) return false;
  return are_positions(column) &&
         (column.meaning == Meaning::position || numbers < 3 || !is_first || !counts_rows(column));
}

bool could_be_readings(const TableColumn& column, const Columns& columns) {
  const bool named = std::ranges::any_of(
      columns, [](const TableColumn& one) { return one.is_number() && one.meaning == Meaning::reading; });
  if (!column.is_number()) return false;
  if (column.unit && column.unit->kind != UnitKind::length && column.unit->kind != UnitKind::angle) return false;
  return named ? column.meaning == Meaning::reading
               : (column.meaning == Meaning::none || column.meaning == Meaning::position) && !counts_rows(column);
}

bool go_both_ways(const TableColumn& targets) {
  const auto falls = [](double a, double b) { return b < a; };
  const auto rises = [](double a, double b) { return b > a; };
  return std::ranges::adjacent_find(targets.values, falls) != targets.values.end() &&
         std::ranges::adjacent_find(targets.values, rises) != targets.values.end();
}

bool counts_rows_of_runs(const TableColumn& column) {
  std::size_t begins = 0;
  for (std::size_t i = 0; i < column.values.size(); ++i) {
    const bool goes_on = i > 0 && column.values[i] == column.values[i - 1] + 1.0;
    if (goes_on) continue;
    if (column.values[i] != column.values.front()) return false;
    ++begins;
  }
  return begins > 1 && (column.values.front() == 0.0 || column.values.front() == 1.0);
}

std::string_view interval_of_rows(const TableColumn& counter, const Columns& columns) {
  const double first = counter.values.front();
  double fastest = 0.0;  // degC a row
  for (const TableColumn& column : columns) {
    if (!column.is_number() || column.meaning != Meaning::temperature) continue;
    const double degC = column.unit ? column.unit->factor : 1.0;
    for (std::size_t begin = 0, end = 1; begin < column.values.size(); begin = end++) {
      while (end < column.values.size() && counter.values[end] != first) ++end;
      const std::size_t part = std::max<std::size_t>(1, (end - begin) / kPartsOfRun);
      for (std::size_t i = begin + part; i < end; ++i)
        fastest =
            std::max(fastest, degC * std::abs(column.values[i] - column.values[i - part]) / static_cast<double>(part));
    }
  }
  constexpr double kMinute_s = 60.0;
  if (fastest <= kFastest_degC_per_s) return "s";
  return fastest <= kMinute_s * kFastest_degC_per_s ? "min" : "h";
}

}  // namespace ecs::laser
