#include "app/ui/menu_screen.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::app {

namespace {

enum Rank { is_name, begins_name, begins_word, in_name, in_synonyms, in_help };

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::optional<int> rank_of_part(const MenuChoice& choice, const std::string& part) {
  const std::string name = lower(choice.name);
  if (name == part || (!choice.is_verb && has(" " + name + " ", " " + part + " "))) return is_name;
  if (name.starts_with(part)) return begins_name;
  if (has(name, " " + part)) return begins_word;
  if (has(name, part)) return in_name;
  if (has(" " + lower(choice.synonyms), " " + part)) return in_synonyms;
  if (has(lower(choice.help), part)) return in_help;
  return std::nullopt;
}

/// The end of the last whole clause that fits, else of the last word that can end a phrase.
std::size_t end_of_phrase(const std::string& help, int columns) {
  static constexpr std::array<std::string_view, 12> kOpenWords{"of", "the", "a",  "an",  "and",  "or",
                                                               "to", "in",  "by", "for", "with", "one"};
  std::size_t clause = 0, phrase = 0, word = 0;
  int depth = 0;
  for (std::size_t k = 0; k < help.size() && width_of(help.substr(0, k)) <= columns; ++k) {
    depth += (help[k] == '(' ? 1 : 0) - (help[k] == ')' ? 1 : 0);
    const bool ends_clause =
        k + 1 < help.size() && help[k + 1] == ' ' && (help[k] == ',' || help[k] == ';' || help[k] == ':');
    if (depth == 0 && ends_clause) clause = k;
    if (help[k] != ' ') continue;
    const std::string_view last = std::string_view(help).substr(word, k - word);
    if (depth == 0 && std::find(kOpenWords.begin(), kOpenWords.end(), last) == kOpenWords.end()) phrase = k;
    word = k + 1;
  }
  return clause > 0 ? clause : phrase;
}

/// The help without its end, where it is too long for a row: with a mark; the row of the cursor has it whole below.
std::string shortened(const std::string& help, int columns) {
  constexpr std::string_view kMark = " …";
  if (width_of(help) <= columns) return help;
  std::string text = help.substr(0, end_of_phrase(help, columns - width_of(kMark)));
  while (!text.empty() && (text.back() == ',' || text.back() == ';' || text.back() == ':')) text.pop_back();
  return text.append(kMark);
}

}  // namespace

std::optional<int> rank_of(const MenuChoice& choice, const std::string& sought) {
  const std::string whole = lower(trimmed(sought));
  if (whole.empty()) return begins_name;
  if (const auto rank = rank_of_part(choice, whole)) return rank;
  int worst = is_name;
  for (const std::string_view word : split(whole, ' ')) {
    if (word.empty()) continue;
    const auto rank = rank_of_part(choice, std::string(word));
    if (!rank) return std::nullopt;
    worst = std::max(worst, *rank);
  }
  return worst;
}

MenuScreen::MenuScreen(std::string title, std::string help, std::vector<MenuChoice> choices, Kind kind)
    : title_(std::move(title)),
      help_(std::move(help)),
      choices_(std::move(choices)),
      kind_(kind),
      seeking_(kind == Kind::finder) {}

/// While something is sought the best come first.
std::vector<std::size_t> MenuScreen::seen() const {
  std::vector<std::pair<int, std::size_t>> ranked;
  for (std::size_t k = 0; k < choices_.size(); ++k)
    if (seeking_ || !choices_[k].only_sought)
      if (const auto rank = rank_of(choices_[k], sought_.text())) ranked.emplace_back(*rank, k);
  std::sort(ranked.begin(), ranked.end());
  std::vector<std::size_t> seen;
  for (const auto& [rank, k] : ranked) seen.push_back(k);
  return seen;
}

void MenuScreen::draw(Canvas& canvas, const Area& area) const {
  const Area inside = area.between_margins();
  int row = 1;
  if (seeking_) {
    canvas.text(inside, 0, 0, "/", Tone::strong);
    sought_.draw(canvas, inside, 0, 1, 30, true);
  }
  const auto list = seen();
  std::vector<ListRow> rows;
  int names = 0;
  for (const std::size_t k : list) names = std::max(names, std::min(26, width_of(choices_[k].name)));
  for (const std::size_t k : list) {
    const int room = inside.columns - 4 - std::max(names, width_of(choices_[k].name));
    rows.push_back({fmt::format("{:<{}}  {}", choices_[k].name, names, shortened(choices_[k].help, room))});
  }
  if (rows.empty()) canvas.text(inside, row, 2, "no name or description contains this", Tone::warning);
  constexpr int kHelpRows = 3;  // the whole help of the entry under the cursor
  draw_list(canvas, {inside.row + row, inside.column, inside.rows - row - kHelpRows, inside.columns}, rows, place_);
  if (list.empty()) return;
  const auto chosen = std::min(static_cast<std::size_t>(place_.selected), list.size() - 1);
  canvas.paragraph({inside.row + inside.rows - kHelpRows + 1, inside.column, kHelpRows - 1, inside.columns}, 0,
                   choices_[list[chosen]].help, Tone::faint);
}

/// The whole menu again, the entry under the cursor if it is shown there.
void MenuScreen::stop_seeking(std::size_t entry) {
  seeking_ = false;
  sought_.set("");
  const auto list = seen();
  const auto at = std::find(list.begin(), list.end(), entry);
  place_.selected = at == list.end() ? 0 : static_cast<int>(at - list.begin());
}

/// A click chooses, one on what is chosen opens it.
Step MenuScreen::on_click(const Key& key, int count) {
  const auto clicked = place_.clicked(key);
  if (!clicked || *clicked >= count) return stay();
  if (*clicked == place_.selected) return on_key({Key::Name::enter});
  place_.selected = *clicked;
  return stay();
}

Step MenuScreen::on_key(const Key& key) {
  const auto list = seen();
  if (key.name == Key::Name::mouse) return on_click(key, static_cast<int>(list.size()));
  if (key.name == Key::Name::enter || (key.name == Key::Name::right && !seeking_)) {
    if (list.empty()) return stay();
    const auto chosen = list[static_cast<std::size_t>(std::min(place_.selected, static_cast<int>(list.size()) - 1))];
    if (kind_ == Kind::finder) return replaced_by(choices_[chosen].opens());
    stop_seeking(chosen);
    return opened(choices_[chosen].opens());
  }
  if (key.name == Key::Name::escape || (!seeking_ && (is_letter(key, U'q') || key.name == Key::Name::left))) {
    if (!seeking_ || kind_ == Kind::finder) return back();
    stop_seeking(0);
    return stay();
  }
  if (place_.on_key(key, static_cast<int>(list.size()))) return stay();
  if (!seeking_ && key.name == Key::Name::letter) seeking_ = true;
  if (is_letter(key, U'/') && sought_.text().empty()) return stay();
  if (seeking_ && sought_.on_key(key)) place_.selected = 0;
  return stay();
}

std::vector<KeyHelp> MenuScreen::keys() const {
  return {{"Enter", "open"}, {"up/down", "choose"}, {"/", "find by name"}, {"Esc", "back"}};
}

}  // namespace ecs::app
