// The parameters screen without a unit: editing in place, undo, findings, comparison, files, drafts; keys in, text out.
#include <algorithm>
#include <cstring>

#include "tests/support/parameters_screen.hpp"

namespace ecs::app::parameters_case {
namespace {

TEST_CASE("the parameters screen begins with where the parameters shall come from, and says whether a unit answers") {
  const ParametersCase one;
  ParametersScreen screen(no_line());
  CHECK(shows(screen, "no unit answers now"));
  const std::string text = seen(screen);
  for (const char* line : {"> r  receive from the unit", "o  open a file", "n  new from a machine file"})
    CHECK(has(text, line));
}

TEST_CASE("the three groups of thesis 5.3 are pages, and the fields of an absent axis are hidden") {
  const ParametersCase one;
  REQUIRE(write_file(one.file(),
                     "[configuration]\nchain = \"XTYZ\"\naxes = \"YZ\"\n[compensation]\nscope = \"planar\"\n"
                     "plane = \"YZ\"\n"));
  ParametersScreen screen(no_line());
  open_file(screen, one);
  std::string text = seen(screen);
  CHECK(has(text, "[1 Configuration]"));
  CHECK(has(text, "measurement system"));
  CHECK(has(text, "axis Y"));
  CHECK_FALSE(has(text, "axis X"));
  type(screen, "3");
  text = seen(screen);
  CHECK(has(text, "[3 Datuming]"));
  CHECK(has(text, "approach speed"));
  find(screen, "configuration.axes");
  edit(screen, "XYZ");
  type(screen, "3");
  CHECK(has(seen(screen), "axis X"));
}

TEST_CASE("the field under the cursor is explained: range, default, help and its name in the thesis") {
  const ParametersCase one;
  ParametersScreen screen(no_line());
  open_file(screen, one);
  find(screen, "deadband");
  const std::string text = seen(screen);
  CHECK(has(text, "> "));
  CHECK(has(text, "deadband"));
  CHECK(has(text, "4 um"));
  CHECK(has(text, "axis.X.deadband_um"));
  CHECK(has(text, "Accepts 0 to 10000 um; default 5 um."));
  CHECK(has(text, "Travel that counts as a move in a new direction"));
  CHECK(has(text, "minimum distance to qualify as move"));
}

TEST_CASE("a wrong value is refused with the reason, and what was typed stays to be mended") {
  const ParametersCase one;
  ParametersScreen screen(no_line());
  open_file(screen, one);
  find(screen, "loop_period");
  edit(screen, "50");
  std::string text = seen(screen);
  CHECK(has(text, "Refused: compensation.loop_period_us: expected 100 to 20000 us, found 50"));
  CHECK(has(text, "50__"));
  CHECK(screen.typing());
  CHECK(screen.cursor(screen_area(Canvas(24, 80))).row > 2);
  CHECK(screen.unsaved().empty());
  type(screen, "0 us");  // 500 us, with its unit
  press(screen, Key::Name::enter);
  CHECK_FALSE(screen.typing());
  CHECK(screen.controller().set().parameters.loop_period_us == 500.0);
  CHECK(has(seen(screen), "was 1000"));
  press(screen, Key::Name::enter);
  enter(screen, "abc");
  CHECK(has(seen(screen), "Refused: "));
  press(screen, Key::Name::escape);
  CHECK(screen.controller().set().parameters.loop_period_us == 500.0);
}

TEST_CASE("choices cycle on Space, left and right, and Enter chooses one among them") {
  const ParametersCase one;
  ParametersScreen screen(no_line());
  open_file(screen, one);
  find(screen, "compensation.scope");
  type(screen, " ");
  CHECK(screen.controller().set().parameters.scope == Scope::planar);
  press(screen, Key::Name::left);
  CHECK(screen.controller().set().parameters.scope == Scope::linear);
  press(screen, Key::Name::enter);
  CHECK(has(seen(screen), "< linear >"));
  press(screen, Key::Name::right);
  press(screen, Key::Name::right);
  CHECK(screen.controller().set().parameters.scope == Scope::linear);
  press(screen, Key::Name::enter);
  CHECK(screen.controller().set().parameters.scope == Scope::volumetric);
  find(screen, "X.datum.switch_polarity");
  type(screen, " ");
  CHECK(screen.controller().set().parameters.axes[0].datum.switch_polarity == -1);
}

TEST_CASE("every edit is taken back by u and done again by y, the default by d among them") {
  const ParametersCase one;
  ParametersScreen screen(no_line());
  open_file(screen, one);
  const ParameterSet before = screen.controller().set();
  find(screen, "deadband");
  edit(screen, "7.5");
  type(screen, "d");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 5.0);
  type(screen, "u");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  type(screen, "u");
  CHECK(has(seen(screen), "taken back: X deadband: 4 > 7.5"));
  CHECK(screen.controller().set() == before);
  CHECK(screen.unsaved().empty());
  type(screen, "u");
  CHECK(has(seen(screen), "nothing more"));
  type(screen, "yy");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 5.0);
}

TEST_CASE("the cross-check follows every edit; a finding leads to its field, and errors keep from sending") {
  const ParametersCase one;
  ParametersScreen screen(no_line());
  open_file(screen, one);
  type(screen, "4");
  CHECK(has(seen(screen), "Nothing stands against these parameters"));
  find(screen, "X.deadband");
  edit(screen, "0.5");
  CHECK(has(seen(screen), "! error: 0.5 um is less than one position count"));
  type(screen, "t");
  std::string text = seen(screen);
  CHECK(has(text, "[4 Findings 1]"));
  CHECK(has(text, "not sent: an error stands"));
  CHECK(has(text, "X deadband"));
  press(screen, Key::Name::enter);
  CHECK(has(seen(screen), "axis.X.deadband_um"));
  type(screen, "u4");
  CHECK(has(seen(screen), "Nothing stands against these parameters"));
}

TEST_CASE("a machine file adds what it knows to the cross-check, and m with nothing takes it away") {
  const ParametersCase one;
  ParametersScreen screen(no_line());
  open_file(screen, one);
  find(screen, "X.transducer");
  type(screen, " ");
  const std::size_t alone = screen.controller().findings().size();
  type(screen, "m");
  enter(screen, "samples/mill/machine.toml");
  CHECK(screen.controller().findings().size() > alone);
  CHECK(has(seen(screen), "moving column mill"));
  type(screen, "4");
  CHECK(has(seen(screen), "differs from the machine file"));
  type(screen, "m");
  clear_line(screen);
  enter(screen, "");
  CHECK(screen.controller().findings().size() == alone);
}

TEST_CASE("new parameters from a machine file fit it") {
  const ParametersCase one;
  ParametersScreen screen(no_line());
  type(screen, "n");
  enter(screen, "samples/mill/machine.toml");
  const auto machine = params::read_machine("samples/mill/machine.toml");
  REQUIRE(machine);
  CHECK(screen.controller().set().parameters == params::default_parameters_for(machine->machine));
  CHECK(screen.controller().set().identity.machine == "moving column mill");
  CHECK(has(seen(screen), "in no file yet"));
}

TEST_CASE("screen and file are compared; a value is taken from the file by f, undoable") {
  const ParametersCase one;
  ParametersScreen screen(no_line());
  open_file(screen, one);
  find(screen, "deadband");
  edit(screen, "7.5");
  find(screen, "identity.machine");
  edit(screen, "lathe");
  type(screen, "5");
  const std::string text = seen(screen);
  CHECK(has(text, "X deadband"));
  CHECK(has(text, "7.5"));
  CHECK(screen.controller().compared().size() == 2);
  press(screen, Key::Name::down);
  type(screen, "f");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 4.0);
  CHECK(screen.controller().compared().size() == 1);
  type(screen, "g");
  CHECK(has(seen(screen), "no unit has given a value"));
  type(screen, "u");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  press(screen, Key::Name::end);
  press(screen, Key::Name::enter);
  CHECK(has(seen(screen), "axis.X.deadband_um"));
}

TEST_CASE("a file with wrong values is refused with every reason, and the name stays to be mended") {
  const ParametersCase one;
  ParametersScreen screen(no_line());
  type(screen, "o");
  enter(screen, "samples/params/broken_values.toml");
  const std::string text = seen(screen);
  CHECK(has(text, "broken_values.toml:"));
  CHECK(has(text, "samples/params/broken_values.toml_"));
  CHECK_FALSE(screen.controller().loaded());
  press(screen, Key::Name::escape);
  CHECK(has(seen(screen), "receive from the unit"));
}

TEST_CASE("saving writes what the screen holds, asks before another file, and keeps the file where it cannot") {
  const ParametersCase one;
  REQUIRE(write_file(one.file("other.toml"), "precious"));
  ParametersScreen screen(no_line());
  open_file(screen, one);
  find(screen, "deadband");
  edit(screen, "7.5");
  CHECK_FALSE(screen.unsaved().empty());
  type(screen, "s");
  clear_line(screen);
  enter(screen, one.file("other.toml"));
  CHECK(has(seen(screen), "exists already"));
  type(screen, "n");
  CHECK(read_file(one.file("other.toml")).value() == "precious");
  clear_line(screen);
  enter(screen, one.file("no/such/folder.toml"));
  CHECK(screen.typing());
  CHECK_FALSE(screen.unsaved().empty());
  clear_line(screen);
  enter(screen, one.file());
  CHECK(screen.unsaved().empty());
  CHECK_FALSE(draft_of("parameters"));
  const auto written = params::read_parameters(one.file());
  REQUIRE(written);
  CHECK(written->parameters == screen.controller().set().parameters);
  CHECK(written->identity.machine == "moving column mill");
  CHECK(has(seen(screen), "saved to"));
}

TEST_CASE("saving asks where another program has changed the file meanwhile") {
  const ParametersCase one;
  ParametersScreen screen(no_line());
  open_file(screen, one);
  REQUIRE(write_file(one.file(), "[compensation]\nscope = \"planar\"\n"));
  type(screen, "s");
  press(screen, Key::Name::enter);
  CHECK(has(seen(screen), "Save over it?"));
  CHECK(has(seen(screen), "another"));
}

TEST_CASE("after a crash a new screen takes the unsaved work up, with what it was changed from") {
  const ParametersCase one;
  {
    ParametersScreen screen(no_line());
    open_file(screen, one);
    find(screen, "deadband");
    edit(screen, "7.5");
    type(screen, "m");
    enter(screen, "samples/mill/machine.toml");
    type(screen, "1");
    find(screen, "null_offset");
    edit(screen, "-2.25");
  }  // nothing saved, nobody asked
  ParametersScreen screen(no_line());
  CHECK(has(seen(screen), "Unsaved work of "));
  press(screen, Key::Name::enter);
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  CHECK(screen.controller().set().parameters.axes[0].datum.null_offset_mm == -2.25);
  CHECK(screen.controller().file() == one.file());
  CHECK(screen.controller().machine() == "moving column mill");
  CHECK(screen.controller().changes() == 2);
  CHECK_FALSE(screen.unsaved().empty());
  find(screen, "deadband");
  CHECK(has(seen(screen), "was 4"));
  type(screen, "s");
  press(screen, Key::Name::enter);
  ParametersScreen later(no_line());
  CHECK_FALSE(has(seen(later), "Unsaved work"));
}

TEST_CASE("unsaved work of another time is dropped only after a yes") {
  const ParametersCase one;
  {
    ParametersScreen screen(no_line());
    open_file(screen, one);
    find(screen, "deadband");
    edit(screen, "7.5");
  }
  ParametersScreen screen(no_line());
  type(screen, "dn");
  CHECK(draft_of("parameters"));
  type(screen, "dy");
  CHECK_FALSE(draft_of("parameters"));
  CHECK(has(seen(screen), "receive from the unit"));
}

TEST_CASE("leaving, opening and beginning anew ask where edits would be lost") {
  const ParametersCase one;
  ParametersScreen screen(no_line());
  open_file(screen, one);
  find(screen, "deadband");
  edit(screen, "7.5");
  CHECK(screen.on_key({Key::Name::escape}).kind == Step::Kind::stay);
  CHECK(has(seen(screen), "neither saved nor sent"));
  type(screen, "n");
  for (const char* key : {"o", "n", "r"}) {
    type(screen, key);
    CHECK(has(seen(screen), "go on, lose them"));
    press(screen, Key::Name::escape);
  }
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  (void)screen.on_key({Key::Name::escape});
  CHECK(screen.on_key({Key::Name::letter, U'y'}).kind == Step::Kind::back);
  CHECK(draft_of("parameters"));
}

TEST_CASE("a field is found by a part of its name or of its help; Esc goes back to where one was") {
  const ParametersCase one;
  ParametersScreen screen(no_line());
  open_file(screen, one);
  type(screen, "/rapid");
  CHECK(has(seen(screen), "no parameter has that"));
  press(screen, Key::Name::escape);
  CHECK(has(seen(screen), "[1 Configuration]"));
  type(screen, "/ball bar");
  CHECK(has(seen(screen), "compensation.squareness.C0Y_um_per_m"));
  CHECK(has(seen(screen), "1 of 3"));
  press(screen, Key::Name::down);
  CHECK(has(seen(screen), "compensation.squareness.B0Z_um_per_m"));
  press(screen, Key::Name::enter);
  CHECK(has(seen(screen), "[2 Compensation"));
}

TEST_CASE("a send without a line says why and loses nothing") {
  const ParametersCase one;
  ParametersScreen screen(no_line());
  open_file(screen, one);
  find(screen, "deadband");
  edit(screen, "7.5");
  type(screen, "t");
  CHECK(shows(screen, "everything here stays as it is"));
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  CHECK_FALSE(screen.unsaved().empty());
  CHECK(draft_of("parameters"));
}

TEST_CASE("every page of the parameters screen fits any size and any terminal, with text that stays inside") {
  const ParametersCase one;
  ParametersScreen screen(no_line());
  const auto sizes = {std::pair{24, 80}, {40, 120}, {12, 40}, {5, 20}, {1, 1}};
  const auto look = [&] {
    for (const auto& [rows, columns] : sizes)
      for (const Glyphs glyphs : {Glyphs::ascii, Glyphs::unicode}) {
        const std::string text = seen(screen, rows, columns, glyphs);
        CHECK(std::count(text.begin(), text.end(), '\n') == rows);
        if (glyphs == Glyphs::ascii)
          CHECK(std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 128; }));
      }
  };
  look();
  open_file(screen, one);
  find(screen, "deadband");
  edit(screen, "0.5");
  for (const char* page : {"1", "2", "3", "4", "5"}) {
    type(screen, page);
    look();
  }
  find(screen, "deadband");
  press(screen, Key::Name::enter);
  enter(screen, "x");
  look();
  press(screen, Key::Name::escape);
  type(screen, "s");
  look();
}

TEST_CASE("labels are the keys in words, and no two rows of a page's axis are called the same") {
  for (const params::Group group :
       {params::Group::configuration, params::Group::compensation, params::Group::datuming}) {
    std::vector<std::string> labels;
    std::string axis;
    for (const ParameterRow& row : rows_of(group, UnitParameters{})) {
      if (row.key.empty()) axis = row.label;
      CHECK(row.label.find('_') == std::string::npos);
      CHECK(width_of(row.label) <= 26);
      labels.push_back(axis + row.label);
    }
    std::sort(labels.begin(), labels.end());
    CHECK(std::adjacent_find(labels.begin(), labels.end()) == labels.end());
  }
  CHECK(full_label_of("axis.X.datum.approach_speed_mm_min") == "X approach speed");
  CHECK(full_label_of("axis.Y.position_scale_um_per_count") == "Y position scale");
  CHECK(full_label_of("axis.Z.position_loop_gain_per_s") == "Z position loop gain");
  CHECK(full_label_of("compensation.tool_offset_mm.x") == "tool offset X");
  CHECK(full_label_of("compensation.squareness.C0Y_um_per_m") == "squareness C0Y");
}

}  // namespace
}  // namespace ecs::app::parameters_case
