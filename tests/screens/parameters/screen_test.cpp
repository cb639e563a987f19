// The parameters screen without a unit: editing in place, undo, findings, comparison, files, drafts; keys in, text out.
#include <algorithm>
#include <cstring>

#include "base/file.hpp"
#include "tests/screens/support/parameters_screen.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

/// A screen that is left with an edited deadband, not saved.
void leave_unsaved(const ParametersCase& one) {
  ParametersScreen screen(no_link());
  open_file(screen, one);
  find(screen, "deadband");
  edit(screen, "7.5");
}

TEST_CASE("the parameters screen first asks for the source of the parameters, and says whether a unit answers") {
  const ParametersCase one;
  ParametersScreen screen(no_link());
  CHECK(shows(screen, "no unit answers now"));
  const std::string text = picture(screen);
  for (const char* line : {"> r  receive from the unit", "o  open a file", "n  new from a machine file"})
    CHECK(reads(text, line));
}

TEST_CASE("the three groups of thesis 5.3 are pages, and the fields of an absent axis are hidden") {
  const ParametersCase one;
  REQUIRE(write_file(one.file(),
                     "[configuration]\nchain = \"XTYZ\"\naxes = \"YZ\"\n[compensation]\nscope = \"planar\"\n"
                     "plane = \"YZ\"\n"));
  ParametersScreen screen(no_link());
  open_file(screen, one);
  std::string text = picture(screen);
  CHECK(reads(text, "[1 Configuration]"));
  CHECK(reads(text, "measurement system"));
  CHECK(reads(text, "axis Y"));
  CHECK_FALSE(reads(text, "axis X"));
  type(screen, "3");
  text = picture(screen);
  CHECK(reads(text, "[3 Datuming]"));
  CHECK(reads(text, "approach speed"));
  find(screen, "configuration.axes");
  edit(screen, "XYZ");
  type(screen, "3");
  CHECK(reads(picture(screen), "axis X"));
}

TEST_CASE("the field under the cursor is explained: range, default, help and its name in the thesis") {
  OpenedParameters opened;
  ParametersScreen& screen = opened.screen;
  find(screen, "deadband");
  const std::string text = picture(screen);
  CHECK(reads(text, "> "));
  CHECK(reads(text, "deadband"));
  CHECK(reads(text, "4 um"));
  CHECK(reads(text, "axis.X.deadband_um"));
  CHECK(reads(text, "Accepts 0 to 10000 um; default 5 um."));
  CHECK(reads(text, "Travel that counts as a move in a new direction"));
  CHECK(reads(text, "minimum distance to qualify as move"));
}

TEST_CASE("a wrong value is refused with the reason, and the typed text stays for correction") {
  OpenedParameters opened;
  ParametersScreen& screen = opened.screen;
  find(screen, "loop_period");
  edit(screen, "50");
  std::string text = picture(screen);
  CHECK(reads(text, "Refused: compensation.loop_period_us: expected 100 to 20000 us, found 50"));
  CHECK(reads(text, "50__"));
  CHECK(screen.typing());
  CHECK(screen.cursor(screen_area(Canvas(24, 80))).row > 2);
  CHECK(screen.unsaved().empty());
  type(screen, "0 us");  // 500 us, with its unit
  (void)press(screen, Key::Name::enter);
  CHECK_FALSE(screen.typing());
  CHECK(screen.controller().set().parameters.loop_period_us == 500.0);
  CHECK(reads(picture(screen), "was 1000"));
  (void)press(screen, Key::Name::enter);
  enter(screen, "abc");
  CHECK(reads(picture(screen), "Refused: "));
  (void)press(screen, Key::Name::escape);
  CHECK(screen.controller().set().parameters.loop_period_us == 500.0);
}

TEST_CASE("choices cycle on Space, left and right, and Enter chooses one among them") {
  OpenedParameters opened;
  ParametersScreen& screen = opened.screen;
  find(screen, "compensation.scope");
  type(screen, " ");
  CHECK(screen.controller().set().parameters.scope == Scope::planar);
  (void)press(screen, Key::Name::left);
  CHECK(screen.controller().set().parameters.scope == Scope::linear);
  (void)press(screen, Key::Name::enter);
  CHECK(reads(picture(screen), "< linear >"));
  (void)press(screen, Key::Name::right);
  (void)press(screen, Key::Name::right);
  CHECK(screen.controller().set().parameters.scope == Scope::linear);
  (void)press(screen, Key::Name::enter);
  CHECK(screen.controller().set().parameters.scope == Scope::volumetric);
  find(screen, "X.datum.switch_polarity");
  type(screen, " ");
  CHECK(screen.controller().set().parameters.axes[0].datum.switch_polarity == -1);
}

TEST_CASE("every edit is undone by u and redone by y, the default by d among them") {
  OpenedParameters opened;
  ParametersScreen& screen = opened.screen;
  const ParameterSet before = screen.controller().set();
  find(screen, "deadband");
  edit(screen, "7.5");
  type(screen, "d");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 5.0);
  type(screen, "u");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  type(screen, "u");
  CHECK(reads(picture(screen), "taken back: X deadband: 4 > 7.5"));
  CHECK(screen.controller().set() == before);
  CHECK(screen.unsaved().empty());
  type(screen, "u");
  CHECK(reads(picture(screen), "nothing more"));
  type(screen, "yy");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 5.0);
}

TEST_CASE("the cross-check follows every edit; a finding leads to its field, and errors keep from sending") {
  OpenedParameters opened;
  auto& [one, screen] = opened;
  type(screen, "4");
  CHECK(reads(picture(screen), "No findings for these parameters"));
  find(screen, "X.deadband");
  edit(screen, "0.5");
  CHECK(reads(picture(screen), "! error: 0.5 um is less than one position count"));
  type(screen, "t");
  std::string text = picture(screen);
  CHECK(reads(text, "[4 Findings 1]"));
  CHECK(reads(text, "not sent: there is an error"));
  CHECK(reads(text, "X deadband"));
  (void)press(screen, Key::Name::enter);
  CHECK(reads(picture(screen), "axis.X.deadband_um"));
  type(screen, "u4");
  CHECK(reads(picture(screen), "No findings for these parameters"));
}

TEST_CASE("a machine file adds what it knows to the cross-check, and m with nothing takes it away") {
  OpenedParameters opened;
  ParametersScreen& screen = opened.screen;
  find(screen, "X.transducer");
  type(screen, " ");
  const std::size_t alone = screen.controller().findings().size();
  type(screen, "m");
  enter(screen, "samples/mill/machine.toml");
  CHECK(screen.controller().findings().size() > alone);
  CHECK(reads(picture(screen), "moving column mill"));
  type(screen, "4");
  CHECK(reads(picture(screen), "differs from the machine file"));
  type(screen, "m");
  clear_line(screen);
  enter(screen, "");
  CHECK(screen.controller().findings().size() == alone);
}

TEST_CASE("new parameters from a machine file fit it") {
  const ParametersCase one;
  ParametersScreen screen(no_link());
  type(screen, "n");
  enter(screen, "samples/mill/machine.toml");
  const auto machine = params::read_machine("samples/mill/machine.toml");
  REQUIRE(machine);
  CHECK(screen.controller().set().parameters == params::default_parameters_for(machine->machine));
  CHECK(screen.controller().set().identity.machine == "moving column mill");
  CHECK(reads(picture(screen), "in no file yet"));
}

TEST_CASE("screen and file are compared; a value is taken from the file by f, undoable") {
  OpenedParameters opened;
  ParametersScreen& screen = opened.screen;
  find(screen, "deadband");
  edit(screen, "7.5");
  find(screen, "identity.machine");
  edit(screen, "lathe");
  type(screen, "5");
  const std::string text = picture(screen);
  CHECK(reads(text, "X deadband"));
  CHECK(reads(text, "7.5"));
  CHECK(screen.controller().compared().size() == 2);
  (void)press(screen, Key::Name::down);
  type(screen, "f");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 4.0);
  CHECK(screen.controller().compared().size() == 1);
  type(screen, "g");
  CHECK(reads(picture(screen), "no unit has given a value"));
  type(screen, "u");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  (void)press(screen, Key::Name::end);
  (void)press(screen, Key::Name::enter);
  CHECK(reads(picture(screen), "axis.X.deadband_um"));
}

TEST_CASE("a file with wrong values is refused with every reason, and the name stays for correction") {
  const ParametersCase one;
  ParametersScreen screen(no_link());
  type(screen, "o");
  enter(screen, "tests/data/params/broken_values.toml");
  const std::string text = picture(screen);
  CHECK(reads(text, "broken_values.toml:"));
  CHECK(reads(text, "tests/data/params/broken_values.toml_"));
  CHECK_FALSE(screen.controller().loaded());
  (void)press(screen, Key::Name::escape);  // what is typed
  (void)press(screen, Key::Name::escape);
  CHECK(reads(picture(screen), "receive from the unit"));
}

TEST_CASE("saving writes what the screen holds, asks before another file, and keeps the file where it cannot") {
  const ParametersCase one;
  REQUIRE(write_file(one.file("other.toml"), "precious"));
  ParametersScreen screen(no_link());
  open_file(screen, one);
  find(screen, "deadband");
  edit(screen, "7.5");
  CHECK_FALSE(screen.unsaved().empty());
  type(screen, "s");
  clear_line(screen);
  enter(screen, one.file("other.toml"));
  CHECK(reads(picture(screen), "exists already"));
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
  CHECK(reads(picture(screen), "saved to"));
}

TEST_CASE("saving asks where another program has changed the file meanwhile") {
  OpenedParameters opened;
  auto& [one, screen] = opened;
  REQUIRE(write_file(one.file(), "[compensation]\nscope = \"planar\"\n"));
  type(screen, "s");
  (void)press(screen, Key::Name::enter);
  CHECK(reads(picture(screen), "Save over it?"));
  CHECK(reads(picture(screen), "another"));
}

TEST_CASE("after a crash a new screen restores the unsaved work and the values it was changed from") {
  const ParametersCase one;
  {
    ParametersScreen screen(no_link());
    open_file(screen, one);
    find(screen, "deadband");
    edit(screen, "7.5");
    type(screen, "m");
    enter(screen, "samples/mill/machine.toml");
    type(screen, "1");
    find(screen, "null_offset");
    edit(screen, "-2.25");
  }  // nothing saved, nobody asked
  ParametersScreen screen(no_link());
  CHECK(reads(picture(screen), "Unsaved work of "));
  (void)press(screen, Key::Name::enter);
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  CHECK(screen.controller().set().parameters.axes[0].datum.null_offset_mm == -2.25);
  CHECK(screen.controller().file() == one.file());
  CHECK(screen.controller().machine() == "moving column mill");
  CHECK(screen.controller().changes() == 2);
  CHECK_FALSE(screen.unsaved().empty());
  find(screen, "deadband");
  CHECK(reads(picture(screen), "was 4"));
  type(screen, "s");
  (void)press(screen, Key::Name::enter);
  ParametersScreen later(no_link());
  CHECK_FALSE(reads(picture(later), "Unsaved work"));
}

TEST_CASE("unsaved work of another time is dropped only after a yes") {
  const ParametersCase one;
  leave_unsaved(one);
  ParametersScreen screen(no_link());
  type(screen, "dn");
  CHECK(draft_of("parameters"));
  type(screen, "dy");
  CHECK_FALSE(draft_of("parameters"));
  CHECK(reads(picture(screen), "receive from the unit"));
}

TEST_CASE("u takes back the work of a draft that was taken up") {
  const ParametersCase one;
  leave_unsaved(one);
  ParametersScreen screen(no_link());
  (void)press(screen, Key::Name::enter);
  type(screen, "u");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 4.0);
  CHECK(reads(picture(screen), "the work of the draft"));
  type(screen, "y");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
}

TEST_CASE("a draft stays while other parameters are begun and edited, and each is offered again") {
  const ParametersCase one;
  for (const char* value : {"7.5", "8.5"}) {
    ParametersScreen screen(no_link());
    if (draft_of("parameters")) type(screen, "b");
    open_file(screen, one);
    find(screen, "deadband");
    edit(screen, value);
  }
  ParametersScreen screen(no_link());
  CHECK(reads(picture(screen), "offers another one: 1 more"));
  type(screen, "o");
  (void)press(screen, Key::Name::enter);
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  CHECK(drafts_aside("parameters") == 1);
  drop_draft(kParametersDraft);
  ParametersScreen last(no_link());
  (void)press(last, Key::Name::enter);
  CHECK(last.controller().set().parameters.axes[0].deadband_um == 8.5);
}

TEST_CASE("leaving, opening and starting anew ask where edits would be lost") {
  OpenedParameters opened;
  ParametersScreen& screen = opened.screen;
  find(screen, "deadband");
  edit(screen, "7.5");
  CHECK(screen.on_key({Key::Name::escape}).kind == Step::Kind::stay);
  CHECK(reads(picture(screen), "neither saved nor sent"));
  type(screen, "n");
  for (const char* key : {"o", "n", "r"}) {
    type(screen, key);
    CHECK(reads(picture(screen), "go on, keep the draft"));
    (void)press(screen, Key::Name::escape);
  }
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  (void)screen.on_key({Key::Name::escape});
  CHECK(letter(screen, 'y').kind == Step::Kind::back);
  CHECK(draft_of("parameters"));
}

TEST_CASE("a field is found by a part of its name or of its help; Esc returns to the former field") {
  OpenedParameters opened;
  ParametersScreen& screen = opened.screen;
  type(screen, "/rapid");
  CHECK(reads(picture(screen), "no parameter has that"));
  (void)press(screen, Key::Name::escape);
  CHECK(reads(picture(screen), "[1 Configuration]"));
  type(screen, "/ball bar");
  CHECK(reads(picture(screen), "compensation.squareness.C0Y_um_per_m"));
  CHECK(reads(picture(screen), "1 of 3"));
  (void)press(screen, Key::Name::down);
  CHECK(reads(picture(screen), "compensation.squareness.B0Z_um_per_m"));
  (void)press(screen, Key::Name::enter);
  CHECK(reads(picture(screen), "[2 Compensation"));
}

TEST_CASE("sending without a link says why and loses nothing") {
  OpenedParameters opened;
  ParametersScreen& screen = opened.screen;
  find(screen, "deadband");
  edit(screen, "7.5");
  type(screen, "t");
  CHECK(shows(screen, "Nothing was changed here"));
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  CHECK_FALSE(screen.unsaved().empty());
  CHECK(draft_of("parameters"));
}

TEST_CASE("every page of the parameters screen fits any size and any terminal, with text that stays inside") {
  const ParametersCase one;
  ParametersScreen screen(no_link());
  const auto sizes = {std::pair{24, 80}, {40, 120}, {12, 40}, {5, 20}, {1, 1}};
  const auto look = [&] {
    for (const auto& [rows, columns] : sizes)
      for (const Glyphs glyphs : {Glyphs::ascii, Glyphs::unicode}) {
        const std::string text = picture(screen, rows, columns, glyphs);
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
  (void)press(screen, Key::Name::enter);
  enter(screen, "x");
  look();
  (void)press(screen, Key::Name::escape);
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
}  // namespace ecs::app
