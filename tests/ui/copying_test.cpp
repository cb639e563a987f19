// What F4 copies, and what is said of a key that does nothing.
#include <doctest/doctest.h>

#include "app/ui/screen_program.hpp"

namespace ecs::app {
namespace {

class TwoKeys : public Screen {
 public:
  [[nodiscard]] std::string title() const override { return "TWO KEYS"; }
  void draw(Canvas&, const Area&) const override {}
  [[nodiscard]] Step on_key(const Key&) override { return stay(); }
  [[nodiscard]] std::vector<KeyHelp> keys() const override { return {{"d", "diagnose"}, {"+ -", "zoom"}}; }
  [[nodiscard]] std::string help() const override { return {}; }
};

Canvas three_rows() {
  Canvas canvas(5, 20);
  for (int row = 0; row < 3; ++row) canvas.text({1, 0, 3, 20}, row, 2, "row " + std::to_string(row));
  return canvas;
}

TEST_CASE("the selected row is copied without its margins, else the whole picture between header and key line") {
  Canvas canvas = three_rows();
  CHECK(text_to_copy(canvas, {1, 0, 3, 20}) == "row 0\nrow 1\nrow 2");
  canvas.paint({2, 0, 1, 20}, Tone::selected);
  CHECK(text_to_copy(canvas, {1, 0, 3, 20}) == "row 1");
  CHECK(copied_words("row 1") == "copied: row 1");
  CHECK(copied_words("a\nb") == "copied: 2 rows of this screen");
}

TEST_CASE("a key that does nothing says whether it ever does") {
  const TwoKeys screen;
  CHECK(idle_key_words(screen, U'd') == "d (diagnose): there is nothing for it to do now");
  CHECK(idle_key_words(screen, U'-') == "- (zoom): there is nothing for it to do now");
  CHECK(idle_key_words(screen, U'k') == "k does nothing here; ? lists the keys");
}

}  // namespace
}  // namespace ecs::app
