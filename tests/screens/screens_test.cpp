// The screens as text: keys in, picture out, no terminal.
#include <filesystem>
#include <thread>

#include "app/screens/forms/rows.hpp"
#include "app/screens/model/form.hpp"
#include "app/screens/model/screen.hpp"
#include "app/ui/menu_screen.hpp"
#include "app/ui/screen_program.hpp"
#include "app/verbs/registry.hpp"
#include "base/file.hpp"
#include "commissioning/session/remembered.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/screen_driver.hpp"

using namespace ecs;
using namespace ecs::app;
using namespace ecs::app::screen_test;

namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// Types the keys, then until the work is done; a minute at most.
void finish(Screen& screen, const std::string& keys = "") {
  type(screen, keys);
  for (int k = 0; k < 6000 && screen.advance(); ++k) std::this_thread::sleep_for(10ms);
}

const VerbEntry& entry(const std::vector<MenuEntry>& menus, const std::string& name) {
  for (const MenuEntry& menu : menus)
    for (const VerbEntry& verb : menu.verbs)
      if (verb.name() == name) return verb;
  FAIL("no verb " << name);
  return menus.front().verbs.front();
}

/// A line of X measured three times both ways: a screw error of 8 mm period that the model lacks, and noise.
struct ModelCase : ecs::StateFolder {
  ModelArguments files;
  ModelCase() {
    std::string csv = "axis,x_mm,sense,reading,approach,run\n";
    unsigned seed = 7;
    const auto noise = [&seed] {  // uniform, standard deviation about 0.2
      seed = seed * 1664525u + 1013904223u;
      return (static_cast<double>(seed >> 8) / 16777216.0 - 0.5) * 0.7;
    };
    for (int run = 1; run <= 3; ++run)
      for (const int approach : {1, -1})
        for (int k = 0; k <= 60; ++k) {
          const double x = 3.3 * k;
          const double um = 2.0 * std::sin(2.0 * 3.14159265358979 * x / 8.0) + 0.01 * x + noise();
          csv += "X," + std::to_string(x) + ",EX," + std::to_string(um) + "," + std::to_string(approach) + "," +
                 std::to_string(run) + "\n";
        }
    (void)with("data.csv", csv);
    (void)with("model.toml", "[[effect]]\nid = \"scale\"\naxis = \"X\"\nsense = \"EX\"\n");
    files.model = *this / "model.toml";
    files.data = {*this / "data.csv"};
  }
  [[nodiscard]] ModelScreen screen() const { return ModelScreen(must(ModelController::open(files))); }
};

}  // namespace

TEST_CASE("the first screen shows the menus of thesis figure 5.4 and finds an action by its name") {
  const auto menu = main_menu(no_link());
  CHECK(contains(menu->help(), "`ecs --help` lists the commands."));
  const std::string text = picture(*menu);
  check_holds(text, {"E.C.S. PARAMETERS", "PROCESS LASER DATA", "ECS UTILITY", "MEMORY ACCESS", "MODEL"});
  check_holds(after(*menu, "/datum rec"), {"> RECORD DATUM SEQUENCE", "utility datum record"});
  CHECK(press(*menu, Key::Name::escape).kind == Step::Kind::stay);
  CHECK(press(*menu, Key::Name::escape).kind == Step::Kind::back);
}

TEST_CASE("every verb is in the catalogue with its options, and its form becomes its command line") {
  const auto menus = verb_catalogue(all_verbs());
  const VerbEntry& stats = entry(menus, "laser stats");
  REQUIRE_FALSE(stats.options.empty());
  CHECK(stats.options.front().by_place);
  CHECK(stats.options.front().required);
  std::vector<std::string> values(stats.options.size());
  values.front() = "a.csv 'b c.csv'";
  CHECK(command_line(stats, values) == std::vector<std::string>{"laser", "stats", "a.csv", "b c.csv"});
}

TEST_CASE("a form refuses to run without what is needed, then shows the answer of the verb") {
  const auto form_made = verb_screen(entry(verb_catalogue(all_verbs()), "laser stats"), no_link());
  Screen& form = *form_made;
  CHECK(contains(after(form, "\n"), "is required"));
  finish(form, "samples/laser/x_axis.csv\n");
  const std::string text = picture(form);
  check_holds(text, {"done", "samples/laser/x_axis.csv: EXX"});
}

TEST_CASE("a form shows what went wrong, in words in place of an exit code") {
  const auto form_made = verb_screen(entry(verb_catalogue(all_verbs()), "laser stats"), no_link());
  Screen& form = *form_made;
  finish(form, "no_such_file.csv\n");
  check_holds(picture(form), {"a file cannot be used: see below", "no_such_file.csv"});
}

TEST_CASE("the finder puts a screen before the verb of its name") {
  for (const auto& [sought, screen] : {std::pair{"monitor", "> ON LINE MONITOR"},
                                       {"status", "> DISPLAY ECS STATUS"},
                                       {"volume", "> VOLUME"},
                                       {"memory", "> MEMORY ACCESS"}}) {
    const auto found = finder(no_link());
    type(*found, sought);
    CHECK_MESSAGE(contains(picture(*found), screen), sought);
  }
}

TEST_CASE("an answer that says that something does not hold is no failure of the form") {
  const auto form_made = verb_screen(entry(verb_catalogue(all_verbs()), "params diff"), no_link());
  Screen& form = *form_made;
  type(form, "samples/mill/parameters.toml");
  (void)press(form, Key::Name::down);
  finish(form, "samples/lathe/parameters.toml\n");
  CHECK(contains(picture(form), "a check failed, see below"));
  CHECK_FALSE(contains(picture(form), "code"));
}

TEST_CASE("forms fill themselves from the folder of the model, and typing replaces what they propose") {
  const ModelCase one;
  (void)one.with("machine.toml", ecs::content_of("samples/mill/machine.toml"));
  SUBCASE("the form of the MODEL screen") {
    const auto form_made = model_form(no_link());
    Screen& form = *form_made;
    enter(form, one.files.model);
    check_holds(picture(form, 24, 200), {"data.csv", "machine.toml"});
    SUBCASE("Enter selects them") {
      finish(form, "\n\n");
      CHECK(form.opens_by_itself() != nullptr);
    }
    SUBCASE("the first letter starts again") {
      type(form, "n");
      CHECK_FALSE(contains(picture(form, 24, 200), "data.csv"));
    }
    SUBCASE("another model proposes its own files instead of those that nobody typed") {
      const ecs::Folder other;
      (void)press(form, Key::Name::up);
      clear_line(form);
      type(form, other.with("model.toml", ecs::content_of(one.files.model)));
      const std::string machine = other.with("machine.toml", ecs::content_of("samples/mill/machine.toml"));
      (void)press(form, Key::Name::enter);
      CHECK_FALSE(contains(picture(form, 24, 200), "data.csv"));
      CHECK(contains(picture(form, 24, 200), machine));
    }
  }
  SUBCASE("a model named on the command line") {
    const auto form_made = model_form(no_link(), {one.files.model, "", {}});
    check_holds(picture(*form_made, 24, 200), {"data.csv", "machine.toml"});
  }
  SUBCASE("the form of a verb, which Enter runs only once they were seen") {
    const auto form_made = verb_screen(entry(verb_catalogue(all_verbs()), "model compare"), no_link());
    Screen& form = *form_made;
    enter(form, one.files.model);
    const std::string seen = picture(form, 24, 200);
    check_holds(seen, {"data.csv", "machine.toml", "Filled in from the folder of the model. Press Enter to run it."});
    (void)press(form, Key::Name::enter);
    finish(form);
    CHECK(contains(picture(form), "done"));
  }
}

TEST_CASE("the form of laser table is filled in with what was measured before and after") {
  commissioning::remember_measured_phases({"mill/plan.toml", "mill/before", "mill/after"});
  const auto form_made = verb_screen(entry(verb_catalogue(all_verbs()), "laser table"), no_link());
  check_holds(picture(*form_made), {"mill/plan.toml", "mill/before", "mill/after"});
  commissioning::remember_measured_phases({});
}

TEST_CASE("the model screen finds the missing effect, adds it on one key, and the error visibly falls") {
  const ModelCase one;
  ModelScreen screen = one.screen();
  CHECK(contains(picture(screen), "residual"));
  CHECK(contains(after(screen, "2"), "   DOES NOT FIT\n"));
  CHECK(reads(after(screen, "x"), "press 4 for the page Ladder"));
  type(screen, "nno_such_effect:\n");
  CHECK(screen.typing());  // refused, and open for correction
  (void)press(screen, Key::Name::escape);
  CHECK(contains(after(screen, "d"), "looking for missing effects"));
  finish(screen);
  CHECK(contains(picture(screen), "> cyclic:X:EX"));
  check_reads(after(screen, "\n"), {"pitch of screw, rack, gear or grating", "compare the period with pitches"});
  check_reads(after(screen, "\n"), {"held out", "not rejected"});
  (void)press(screen, Key::Name::escape);
  CHECK(contains(picture(screen), "> cyclic:X:EX"));
  finish(screen, "a");
  const std::string ladder = picture(screen);
  check_holds(ladder, {"+ cyclic:X:EX", "noise of one reading"});
  CHECK_FALSE(screen.unsaved().empty());
  (void)letter(screen, 's');
  CHECK(screen.unsaved().empty());
  CHECK(contains(ecs::read_file(one.files.model).value(), "cyclic"));
  finish(screen, "u");
  CHECK(contains(picture(screen), "undone: cyclic:X:EX"));
}

TEST_CASE("leaving with unsaved work asks once") {
  const ModelCase one;
  ModelScreen screen = one.screen();
  finish(screen, "d");
  finish(screen, "a");
  CHECK(press(screen, Key::Name::escape).kind == Step::Kind::stay);
  CHECK(contains(picture(screen), "Leave without saving the model?"));
  CHECK(press(screen, Key::Name::enter).kind == Step::Kind::stay);
  CHECK(letter(screen, 'y').kind == Step::Kind::back);
}

TEST_CASE("a model that was not saved when the program ended is offered again") {
  const ModelCase one;
  {
    ModelScreen screen = one.screen();
    finish(screen, "d");
    finish(screen, "a");
  }
  {
    ModelScreen later = one.screen();
    CHECK(letter(later, 'n').kind == Step::Kind::back);  // not now: it stays
  }
  ModelScreen again = one.screen();
  CHECK(contains(picture(again), "Unsaved work on this model was found"));
  finish(again, "y");
  CHECK_FALSE(again.unsaved().empty());
  (void)letter(again, 's');
  CHECK(contains(ecs::read_file(one.files.model).value(), "cyclic"));
  CHECK_FALSE(contains(picture(one.screen()), "Unsaved work"));
}

TEST_CASE("a cancelled diagnosis ends soon and leaves nothing behind") {
  const ModelCase one;
  ModelScreen screen = one.screen();
  (void)letter(screen, 'd');
  (void)press(screen, Key::Name::escape);
  finish(screen);
  check_holds(picture(screen), {"cancelled", "Press d"});
}

TEST_CASE("the error left after compensation is given, and one run is shown alone") {
  const ModelCase one;
  ModelScreen screen = one.screen();
  CHECK(contains(after(screen, "r"), "run 1"));
  finish(screen, "w");
  CHECK(contains(picture(screen), "would reduce the rms of the"));
}

TEST_CASE("the model screen fits any size and any terminal") {
  const ModelCase one;
  ModelScreen screen = one.screen();
  for (const auto& [rows, columns] : {std::pair{24, 80}, {40, 120}, {12, 40}, {5, 20}, {1, 1}})
    for (int page = 0; page < 6; ++page) {
      (void)screen.on_key({Key::Name::tab});
      const std::string text = picture_of(screen, "MODEL", {}, Canvas(rows, columns, Glyphs::ascii), true).plain_text();
      CHECK(std::count(text.begin(), text.end(), '\n') == rows);
    }
}

TEST_CASE("the form of the model screen names the kind of a file that is no machine file") {
  const ModelCase one;
  const auto form_made = model_form(no_link(), {one.files.model, "samples/mill/parameters.toml", one.files.data});
  enter(*form_made, "");
  enter(*form_made, "");
  enter(*form_made, "");
  CHECK(contains(picture(*form_made), "parameters.toml is a parameter file, not a machine file."));
}

TEST_CASE("the form of the model screen says what is wrong with a file and keeps what was typed") {
  const ModelCase one;
  const auto form_made = model_form(no_link());
  Screen& form = *form_made;
  type(form, one.files.model);
  finish(form, "\nno_data.csv\n\n");
  check_holds(picture(form), {"no_data.csv", "no such file"});
  CHECK(form.opens_by_itself() == nullptr);
}

TEST_CASE("a model file that does not exist yet is created after a question, and the error falls without any verb") {
  const ModelCase one;
  const std::string fresh = (one.path / "fresh.toml").string();
  const auto form_made = model_form(no_link());
  Screen& form = *form_made;
  enter(form, fresh);
  type(form, one.files.data.front());
  CHECK(contains(after(form, "\n\n"), "Begin a new model?"));
  CHECK_FALSE(fs::exists(fresh));
  finish(form, "y");
  const auto screen = form.opens_by_itself();
  REQUIRE(screen != nullptr);
  CHECK(fs::exists(fresh));
  CHECK(contains(picture(*screen), "with an offset and a slope"));
  finish(*screen, "d");
  CHECK(contains(picture(*screen), "cyclic:X:EX"));
  finish(*screen, "a");
  CHECK(contains(picture(*screen), "added cyclic:X:EX"));
  type(*screen, "s");
  CHECK(contains(ecs::read_file(fresh).value(), "cyclic"));
}

TEST_CASE("without any model file one is proposed beside the measurements, and no asks for another name") {
  const ModelCase one;
  const auto form_made = model_form(no_link());
  Screen& form = *form_made;
  (void)press(form, Key::Name::enter);
  type(form, one.files.data.front());
  CHECK(contains(after(form, "\n\n"), "data.model.toml"));
  CHECK_FALSE(contains(after(form, "n"), "Begin a new model?"));
  CHECK_FALSE(fs::exists(one.path / "data.model.toml"));
  CHECK(form.typing());
}

TEST_CASE("measurements that cannot be read leave no new model file") {
  const ModelCase one;
  const std::string fresh = (one.path / "fresh.toml").string();
  const auto form_made = model_form(no_link());
  Screen& form = *form_made;
  type(form, fresh);
  finish(form, "\nno_data.csv\n\ny");
  CHECK(contains(picture(form), "no_data.csv"));
  CHECK_FALSE(fs::exists(fresh));
}

TEST_CASE("the answer of a verb moves sideways with its headings, and marks where it goes on") {
  const auto form_made = verb_screen(entry(verb_catalogue(all_verbs()), "model effects"), no_link());
  Screen& form = *form_made;
  (void)press(form, Key::Name::enter);
  finish(form);
  const auto at = [&form](int columns) {
    return picture_of(form, form.title(), {}, Canvas(40, columns), false).plain_text();
  };
  const std::string before = at(44);
  check_holds(before, {"PgDn", "→"});
  CHECK_FALSE(contains(before, "←"));
  (void)press(form, Key::Name::page_down);
  CHECK(contains(at(44), "Esc: fields"));
  (void)press(form, Key::Name::home);
  const std::string first = at(44);
  (void)press(form, Key::Name::right);
  const std::string moved = at(44);
  CHECK(contains(moved, "←"));
  const auto column_of = [](const std::string& text, const std::string& word) {
    const std::size_t found = text.find(word);
    REQUIRE(found != std::string::npos);
    const std::size_t begin = text.rfind('\n', found) + 1;
    return width_of(text.substr(begin, found - begin));
  };
  CHECK(column_of(first, "contribution") == 20);
  CHECK(column_of(first, "A sin(2 pi") == 20);
  CHECK(column_of(moved, "contribution") == 12);
  CHECK(column_of(moved, "A sin(2 pi") == 12);
  (void)press(form, Key::Name::home);
  CHECK(at(44) == first);
  CHECK(press(form, Key::Name::escape).kind == Step::Kind::stay);
  CHECK(press(form, Key::Name::escape).kind == Step::Kind::back);
}

TEST_CASE("saving a model for the first time keeps the file as it was beside it") {
  const ModelCase one;
  const std::string by_hand = "# my own note\n" + ecs::read_file(one.files.model).value();
  REQUIRE(ecs::write_file(one.files.model, by_hand));
  ModelScreen screen = one.screen();
  (void)letter(screen, 's');
  CHECK(ecs::read_file(one.files.model + ".before").value() == by_hand);
}

TEST_CASE("paths with blanks are completed in quotes, among several too") {
  const fs::path folder = fs::temp_directory_path() / "ecsblanktest here";
  fs::create_directories(folder);
  REQUIRE(ecs::write_file(folder / "a b.csv", "x"));
  const std::string begun = (fs::temp_directory_path() / "ecsblankt").string();
  const std::string folder_found = completed_paths("first.csv " + begun).completed;
  CHECK(folder_found == "first.csv \"" + folder.string() + "/");
  const std::string file_found = completed_paths(folder_found + "a").completed;
  CHECK(file_found == "first.csv \"" + (folder / "a b.csv").string() + "\"");
  CHECK(split_words(file_found) == std::vector<std::string>{"first.csv", (folder / "a b.csv").string()});
  fs::remove_all(folder);
}

TEST_CASE("a click in a menu chooses, a click on what is chosen opens it, the wheel moves") {
  const auto menu = main_menu(no_link());
  const std::string text = picture(*menu);
  const auto row_of = [&text](const std::string& name) {
    return static_cast<int>(std::count(text.begin(), text.begin() + static_cast<long>(text.find(name)), '\n'));
  };
  const Key click{Key::Name::mouse, 0, 0, row_of("ECS UTILITY"), 10};
  CHECK(menu->on_key(click).kind == Step::Kind::stay);
  CHECK(contains(picture(*menu), "> ECS UTILITY"));
  CHECK(menu->on_key(click).kind == Step::Kind::open);
  (void)menu->on_key({Key::Name::wheel_up, 0, 0, 10, 10});
  CHECK(contains(picture(*menu), "> E.C.S. PARAMETERS"));
}

TEST_CASE("the key that saves a model is on the first line of keys of every page at 80 columns") {
  const ModelCase one;
  ModelScreen screen = one.screen();
  for (const char32_t page : {U'1', U'2', U'3', U'4', U'5', U'6'}) {
    (void)screen.on_key({Key::Name::letter, page});
    CHECK(contains(picture_of(screen, "MODEL", {}, Canvas(24, 80), false).plain_text(), "s save"));
  }
}

TEST_CASE("files measured again are chosen from a list on the model screen, or typed, where the terminal is narrow") {
  const ModelCase one;
  ModelScreen screen = one.screen();
  (void)letter(screen, 'o');
  const Canvas narrow(12, 40);
  CHECK(contains(picture_of(screen, "MODEL", {}, narrow, false).plain_text(), "Files measured again"));
  type(screen, one / "no");
  (void)screen.on_key({Key::Name::enter});
  CHECK(contains(picture_of(screen, "MODEL", {}, narrow, false).plain_text(), "there is no "));
  (void)screen.on_key({Key::Name::escape});
  (void)screen.on_key({Key::Name::escape});
  CHECK(contains(picture_of(screen, "MODEL", {}, narrow, false).plain_text(), "[6 After]"));
}
