// What is laid over any screen: its help (?), and whole what the screen shows in part only (F2). It scrolls.
#pragma once

#include <string>
#include <vector>

#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"

namespace ecs::app {

class Overlay {
 public:
  [[nodiscard]] bool shown() const { return !title_.empty(); }
  /// @param seen  the picture of the screen: words of the trade that it shows are explained
  void show_help(const Screen& screen, const std::string& seen = {});
  /// Nothing is laid over where there is no text. What the log does not hold yet goes there as well.
  void show_whole(const std::vector<std::string>& texts);
  void draw(Canvas& canvas) const;
  /// Scrolls; any other key takes it away.
  void on_key(const Key& key);

 private:
  /// A text in lines; those after the first begin below it, behind the key.
  struct Part {
    std::string key;
    std::string text;
  };
  [[nodiscard]] std::vector<std::string> lines(int columns) const;

  std::string title_;  ///< empty: nothing is laid over
  std::vector<Part> parts_;
  ScrollPlace scroll_;
  mutable int page_ = 1;  ///< rows seen
  mutable bool fits_ = true;
  mutable bool end_ = true;  ///< the last row is seen
};

}  // namespace ecs::app
