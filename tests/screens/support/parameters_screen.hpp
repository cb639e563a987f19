// What the tests of the parameters screen share: a folder with files and a state of its own.
#pragma once

#include "app/screens/parameters/screen.hpp"
#include "tests/support/screen_driver.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app::screen_test {

struct ParametersCase : StateFolder {
  ParametersCase() {
    (void)with("p.toml",
               "[identity]\nmachine = \"moving column mill\"\n[compensation]\nscope = \"linear\"\n"
               "[axis.X]\ndeadband_um = 4.0\n[axis.Y.datum]\napproach_direction = \"reverse\"\n"
               "[axis.Z]\ntransducer = \"encoder\"\n# end of parameters\n");
  }
  [[nodiscard]] std::string file(const std::string& name = "p.toml") const { return *this / name; }
};

/// The cursor on the field that has that in its key.
inline void find(Screen& screen, const std::string& part) { enter(screen, "/" + part); }
/// Edits the field under the cursor.
inline void edit(Screen& screen, const std::string& value) {
  (void)press(screen, Key::Name::enter);
  replace_line(screen, value);
}

/// Edits the field that has that in its key.
inline void edit(Screen& screen, const std::string& part, const std::string& value) {
  find(screen, part);
  edit(screen, value);
}

/// With the file of the case open.
inline void open_file(Screen& screen, const ParametersCase& one) {
  type(screen, "o");
  replace_line(screen, one.file());
}

/// The screen with the file of the case open, without a unit.
struct OpenedParameters {
  OpenedParameters() { open_file(screen, one); }
  ParametersCase one;
  ParametersScreen screen{no_link()};
};

}  // namespace ecs::app::screen_test
