#include "app/ui/menu_screen.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::app {

MenuScreen::MenuScreen(std::string title, std::string help, std::vector<MenuChoice> choices)
    : title_(std::move(title)), help_(std::move(help)), choices_(std::move(choices)) {}

std::vector<std::size_t> MenuScreen::seen() const {
  std::vector<std::size_t> seen;
  const std::string sought = lower(sought_.text());
  for (std::size_t k = 0; k < choices_.size(); ++k)
    if ((seeking_ || !choices_[k].only_sought) &&
        (sought.empty() || lower(choices_[k].name + " " + choices_[k].help).find(sought) != std::string::npos))
      seen.push_back(k);
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
  for (const std::size_t k : list)
    rows.push_back({fmt::format("{:<{}}  {}", choices_[k].name, names, choices_[k].help)});
  if (rows.empty()) canvas.text(inside, row, 2, "no entry has that in its name", Tone::warning);
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
    stop_seeking(chosen);
    return opened(choices_[chosen].opens());
  }
  if (key.name == Key::Name::escape || (!seeking_ && (is_letter(key, U'q') || key.name == Key::Name::left))) {
    if (!seeking_) return back();
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
