// A few fields to fill in, in a box over the screen: typed in place, chosen words on Space, the help of the field under
// the cursor below.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/screens/files/prompt.hpp"
#include "app/ui/cells.hpp"
#include "app/ui/keys.hpp"
#include "app/ui/widgets.hpp"

namespace ecs::app {

struct LaserField {
  std::string name;
  std::string help;
  std::string value;
  std::vector<std::string> choices{};  ///< words that are allowed; empty: any text
  bool path = false;                   ///< Tab completes it; where it is empty a file is chosen
  FileWish wish{};                     ///< of a path
};

class LaserForm {
 public:
  /// @param take  the values in the order of the fields; its answer says why they are refused; empty: taken
  using Take = std::function<std::string(const std::vector<std::string>&)>;
  LaserForm(std::string title, std::vector<LaserField> fields, Take take);

  /// Begins at this field rather than at the first.
  void go_to(const std::string& field);

  /// A box in the middle of `area`.
  void draw(Canvas& canvas, const Area& area) const;
  [[nodiscard]] CellPosition cursor(const Area& area) const;
  /// @return false: the form is done, taken or given up
  [[nodiscard]] bool on_key(const Key& key);
  [[nodiscard]] bool advance() { return files_.advance(); }

 private:
  struct Layout {
    Area box, inside;
    int names = 0, values = 0, fields = 0;
  };
  [[nodiscard]] Layout layout(const Area& area) const;
  void type(const Key& key);
  void next_choice(int by);
  void next_choice_with(char32_t letter);

  std::string title_;
  std::vector<LaserField> fields_;
  std::vector<TextLine> lines_;
  ListPlace place_;
  Take take_;
  Prompt files_;
  std::string hint_;
  bool refused_ = false;
};

}  // namespace ecs::app
