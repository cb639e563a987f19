// The menus of thesis figure 5.4, and those that came since.
#pragma once

#include <functional>
#include <optional>

#include "app/names/commissioning.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"

namespace ecs::commissioning {
class UnitConnection;
}

namespace ecs::app {

struct MenuChoice {
  std::string name;
  std::string help;
  std::function<std::unique_ptr<Screen>()> opens;
  bool only_sought = false;  ///< shown while a name is sought
  std::string synonyms{};    ///< other words of the trade by which it is found
  bool is_verb = false;      ///< a form; a screen or menu with that word in its name comes before it
};

/// How well an entry fits what is sought: 0 it is the name, of a screen or menu also whole words of it, then the name
/// begins with it, then a word of the name, the name, a synonym, the help; of several words all must be found. Nothing:
/// it does not fit. Upper and lower case are the same.
[[nodiscard]] std::optional<int> rank_of(const MenuChoice& choice, const std::string& sought);

class MenuScreen final : public Screen {
 public:
  enum class Kind {
    menu,
    finder,  ///< begins by seeking; what is chosen takes its place
  };
  MenuScreen(std::string title, std::string help, std::vector<MenuChoice> choices, Kind kind = Kind::menu);

  [[nodiscard]] std::string title() const override { return title_; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override { return help_; }
  /// While a name is sought, letters are text.
  [[nodiscard]] bool typing() const override { return seeking_; }

 private:
  [[nodiscard]] std::vector<std::size_t> seen() const;
  void stop_seeking(std::size_t entry);
  [[nodiscard]] Step on_click(const Key& key, int count);
  std::string title_;
  std::string help_;
  std::vector<MenuChoice> choices_;
  Kind kind_;
  ListPlace place_;
  bool seeking_;
  TextLine sought_;
};

/// The first screen: every menu, every screen, every verb.
[[nodiscard]] std::unique_ptr<Screen> main_menu(const std::shared_ptr<UnitConnection>& connection);
/// The same to be found by name, in front of any screen.
[[nodiscard]] std::unique_ptr<Screen> finder(const std::shared_ptr<UnitConnection>& connection);

}  // namespace ecs::app
