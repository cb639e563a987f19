// The parameters screen without a unit: editing in place, undo, findings, comparison, files, drafts; keys in, text out.

#include "base/file.hpp"
#include "tests/screens/support/parameters_screen.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

/// A screen that is left with an edited deadband, not saved.
void leave_unsaved(const ParametersCase& one) {
  ParametersScreen screen(no_link());
  open_file(screen, one);
  edit(screen, "deadband", "7.5");
}

TEST_CASE("the parameters screen first asks for the source of the parameters, and says whether a unit answers") {
  const ParametersCase one;
  ParametersScreen screen(no_link());
  CHECK(shows(screen, "no unit answers"));
  const std::string text = picture(screen);
  check_reads(text, {"> r  receive from the unit", "o  open a file", "n  new from a machine file"});
}

TEST_CASE("the three groups of thesis 5.3 are pages, and the fields of an absent axis are hidden") {
  const ParametersCase one;
  REQUIRE(write_file(one.file(),
                     "[configuration]\nchain = \"XTYZ\"\naxes = \"YZ\"\n[compensation]\nscope = \"planar\"\n"
                     "plane = \"YZ\"\n"));
  ParametersScreen screen(no_link());
  open_file(screen, one);
  std::string text = picture(screen);
  check_reads(text, {"[1 Configuration]", "measurement system", "axis Y"});
  CHECK_FALSE(reads(text, "axis X"));
  type(screen, "3");
  text = picture(screen);
  check_reads(text, {"[3 Datuming]", "approach speed"});
  edit(screen, "configuration.axes", "XYZ");
  CHECK(reads(after(screen, "3"), "axis X"));
}

TEST_CASE("the field under the cursor is explained: range, default, help and its name in the thesis") {
  OpenedParameters opened;
  ParametersScreen& screen = opened.screen;
  find(screen, "deadband");
  const std::string text = picture(screen);
  check_reads(text, {"> ", "deadband", "4 um", "axis.X.deadband_um", "Accepts 0 to 10000 um; default 5 um.",
                     "Travel that is regarded as a move in a new direction", "minimum distance to qualify as move"});
}

TEST_CASE("a plan of measurements is not opened as parameters, and the reason comes first") {
  const ParametersCase one;
  ParametersScreen screen(no_link());
  type(screen, "osamples/mill/plan.toml\n");
  CHECK(reads(picture(screen), "this is a plan of measurements, not a parameter file"));
}

TEST_CASE("the first letter typed replaces a value, and any other key keeps it for editing") {
  OpenedParameters opened;
  ParametersScreen& screen = opened.screen;
  find(screen, "deadband");
  type(screen, "\n9\n");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 9.0);
  (void)press(screen, Key::Name::enter);
  (void)press(screen, Key::Name::end);
  type(screen, ".5\n");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 9.5);
}

TEST_CASE("a wrong value is refused with the reason, and the typed text stays for correction") {
  OpenedParameters opened;
  ParametersScreen& screen = opened.screen;
  edit(screen, "loop_period", "50");
  std::string text = picture(screen);
  check_reads(text, {"Refused: compensation.loop_period_us: expected 100 to 20000 us, found 50", "50__"});
  CHECK(screen.typing());
  CHECK(screen.cursor(screen_area(Canvas(24, 80))).row > 2);
  CHECK(screen.unsaved().empty());
  type(screen, "0 us");  // 500 us, with its unit
  (void)press(screen, Key::Name::enter);
  CHECK_FALSE(screen.typing());
  CHECK(screen.controller().set().parameters.loop_period_us == 500.0);
  CHECK(reads(picture(screen), "was 1000"));
  CHECK(reads(after(screen, "\nabc\n"), "Refused: "));
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
  CHECK(reads(after(screen, "\n"), "< linear >"));
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
  edit(screen, "deadband", "7.5");
  type(screen, "d");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 5.0);
  type(screen, "u");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  CHECK(reads(after(screen, "u"), "undone: X deadband is 4 um again (was 7.5 um)"));
  CHECK(screen.controller().set() == before);
  CHECK(screen.unsaved().empty());
  CHECK(reads(after(screen, "u"), "no more changes"));
  type(screen, "yy");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 5.0);
}

TEST_CASE("the cross-check follows every edit; a finding leads to its field, and errors keep from sending") {
  OpenedParameters opened;
  auto& [one, screen] = opened;
  CHECK(reads(after(screen, "4"), "No findings for these parameters"));
  edit(screen, "X.deadband", "0.5");
  CHECK(reads(picture(screen), "! error: 0.5 um is less than one position count"));
  type(screen, "t");
  std::string text = picture(screen);
  check_reads(text, {"[4 Findings 1]", "not sent: there is an error", "X deadband"});
  CHECK(reads(after(screen, "\n"), "axis.X.deadband_um"));
  CHECK(reads(after(screen, "u4"), "No findings for these parameters"));
}

TEST_CASE("a machine file adds what it knows to the cross-check, and m with nothing takes it away") {
  OpenedParameters opened;
  ParametersScreen& screen = opened.screen;
  find(screen, "X.transducer");
  type(screen, " ");
  const std::size_t alone = screen.controller().findings().size();
  type(screen, "msamples/mill/machine.toml\n");
  CHECK(screen.controller().findings().size() > alone);
  CHECK(reads(picture(screen), "moving column mill"));
  CHECK(reads(after(screen, "4"), "the machine file states \"encoder\""));
  type(screen, "m");
  replace_line(screen, "");
  CHECK(screen.controller().findings().size() == alone);
}

TEST_CASE("new parameters from a machine file fit it") {
  const ParametersCase one;
  ParametersScreen screen(no_link());
  type(screen, "nsamples/mill/machine.toml\n");
  const auto machine = must(params::read_machine("samples/mill/machine.toml"));
  CHECK(screen.controller().set().parameters == params::default_parameters_for(machine.machine));
  CHECK(screen.controller().set().identity.machine == "moving column mill");
  CHECK(reads(picture(screen), "not saved in a file"));
}

TEST_CASE("screen and file are compared; a value is taken from the file by f, undoable") {
  OpenedParameters opened;
  ParametersScreen& screen = opened.screen;
  edit(screen, "deadband", "7.5");
  edit(screen, "identity.machine", "lathe");
  const std::string text = after(screen, "5");
  check_reads(text, {"X deadband", "7.5"});
  CHECK(screen.controller().compared().size() == 2);
  (void)press(screen, Key::Name::down);
  type(screen, "f");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 4.0);
  CHECK(screen.controller().compared().size() == 1);
  CHECK(reads(after(screen, "g"), "no value from a unit"));
  type(screen, "u");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  (void)press(screen, Key::Name::end);
  CHECK(reads(after(screen, "\n"), "axis.X.deadband_um"));
}

TEST_CASE("a file with wrong values is refused with every reason, and the name stays for correction") {
  const ParametersCase one;
  ParametersScreen screen(no_link());
  const std::string text = after(screen, "otests/data/params/broken_values.toml\n");
  check_reads(text, {"broken_values.toml:", "tests/data/params/broken_values.toml_"});
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
  edit(screen, "deadband", "7.5");
  CHECK_FALSE(screen.unsaved().empty());
  type(screen, "s");
  replace_line(screen, one.file("other.toml"));
  CHECK(reads(picture(screen), "already exists"));
  type(screen, "n");
  CHECK(read_file(one.file("other.toml")).value() == "precious");
  replace_line(screen, one.file("no/such/folder.toml"));
  CHECK(screen.typing());
  CHECK_FALSE(screen.unsaved().empty());
  replace_line(screen, one.file());
  CHECK(screen.unsaved().empty());
  CHECK_FALSE(draft_of("parameters"));
  const auto written = must(params::read_parameters(one.file()));
  CHECK(written.parameters == screen.controller().set().parameters);
  CHECK(written.identity.machine == "moving column mill");
  CHECK(reads(picture(screen), "saved to"));
}

TEST_CASE("saving asks where another program has changed the file meanwhile") {
  OpenedParameters opened;
  auto& [one, screen] = opened;
  REQUIRE(write_file(one.file(), "[compensation]\nscope = \"planar\"\n"));
  check_reads(after(screen, "s\n"), {"Save over it?", "another"});
}

TEST_CASE("after a crash a new screen restores the unsaved work and the values it was changed from") {
  const ParametersCase one;
  {
    ParametersScreen screen(no_link());
    open_file(screen, one);
    edit(screen, "deadband", "7.5");
    type(screen, "msamples/mill/machine.toml\n1");
    edit(screen, "null_offset", "-2.25");
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
  type(screen, "s\n");
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
  type(screen, "\nu");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 4.0);
  CHECK(reads(picture(screen), "the work of the draft"));
  type(screen, "y");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
}

TEST_CASE("a draft stays while other parameters are started and edited, and each is offered again") {
  const ParametersCase one;
  for (const char* value : {"7.5", "8.5"}) {
    ParametersScreen screen(no_link());
    if (draft_of("parameters")) type(screen, "b");
    open_file(screen, one);
    edit(screen, "deadband", value);
  }
  ParametersScreen screen(no_link());
  CHECK(reads(picture(screen), "another one: 1 more"));
  type(screen, "o\n");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  CHECK(drafts_aside("parameters") == 1);
  drop_draft(kParametersDraft);
  ParametersScreen last(no_link());
  (void)press(last, Key::Name::enter);
  CHECK(last.controller().set().parameters.axes[0].deadband_um == 8.5);
}

TEST_CASE("leaving, opening and starting again ask where edits would be lost") {
  OpenedParameters opened;
  ParametersScreen& screen = opened.screen;
  edit(screen, "deadband", "7.5");
  CHECK(screen.on_key({Key::Name::escape}).kind == Step::Kind::stay);
  CHECK(reads(picture(screen), "neither saved nor sent"));
  type(screen, "n");
  for (const char* key : {"o", "n", "r"}) {
    type(screen, key);
    CHECK(reads(picture(screen), "continue, keep the draft"));
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
  CHECK(reads(after(screen, "/rapid"), "no such parameter"));
  (void)press(screen, Key::Name::escape);
  CHECK(reads(picture(screen), "[1 Configuration]"));
  check_reads(after(screen, "/ball bar"), {"compensation.squareness.C0Y_um_per_m", "1 of 3"});
  (void)press(screen, Key::Name::down);
  CHECK(reads(picture(screen), "compensation.squareness.B0Z_um_per_m"));
  CHECK(reads(after(screen, "\n"), "[2 Compensation"));
}

TEST_CASE("sending without a link says why and loses nothing") {
  OpenedParameters opened;
  ParametersScreen& screen = opened.screen;
  edit(screen, "deadband", "7.5");
  CHECK(shows_after(screen, "t", "The parameters here are unchanged"));
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  CHECK_FALSE(screen.unsaved().empty());
  CHECK(draft_of("parameters"));
}

TEST_CASE("every page of the parameters screen fits any size and any terminal, with text that stays inside") {
  const ParametersCase one;
  ParametersScreen screen(no_link());
  check_fits(screen);
  open_file(screen, one);
  edit(screen, "deadband", "0.5");
  for (const char* page : {"1", "2", "3", "4", "5"}) {
    type(screen, page);
    check_fits(screen);
  }
  find(screen, "deadband");
  type(screen, "\nx\n");
  check_fits(screen);
  (void)press(screen, Key::Name::escape);
  type(screen, "s");
  check_fits(screen);
}

TEST_CASE("labels are the keys in words, and no two rows of a page's axis are called the same") {
  for (const params::Group group :
       {params::Group::configuration, params::Group::compensation, params::Group::datuming}) {
    std::vector<std::string> labels;
    std::string axis;
    for (const ParameterRow& row : rows_of(group, UnitParameters{})) {
      if (row.key.empty()) axis = row.label;
      CHECK(!contains(row.label, '_'));
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
