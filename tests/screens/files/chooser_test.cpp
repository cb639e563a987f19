// Choosing files, and opening what is given.
#include "app/screens/files/prompt.hpp"
#include "app/screens/start.hpp"
#include "commissioning/session/remembered.hpp"
#include "tests/screens/support/unit_screen.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

constexpr const char* kModel = "[[effect]]\nid = \"scale\"\naxis = \"X\"\nsense = \"EX\"\n";

std::string seen(const FileChooser& chooser) {
  Canvas canvas(20, 80);
  chooser.draw(canvas, canvas.whole());
  return canvas.plain_text();
}

void settle(FileChooser& chooser) {
  for (int k = 0; k < 200 && contains(seen(chooser), " ..."); ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    (void)chooser.advance();
  }
}

std::string title_for(const std::vector<std::string>& files) {
  const auto screen = screen_for_files(files, no_link());
  return screen ? screen->title() : "";
}

TEST_CASE("the first letter typed replaces a proposed name, any other key keeps it for editing") {
  std::string taken;
  const auto asked = [&] {
    Prompt prompt;
    prompt.ask("save as:", Prompt::Kind::path, "old.toml", [&](const std::string& name) { taken = name; });
    return prompt;
  };
  const auto given = [&](std::initializer_list<Key> keys) {
    Prompt prompt = asked();
    for (const Key& key : keys) CHECK(prompt.on_key(key));
    CHECK(prompt.on_key({Key::Name::enter}));
    return taken;
  };
  CHECK(given({}) == "old.toml");
  CHECK(given({{Key::Name::letter, U'n'}, {Key::Name::letter, U'1'}}) == "n1");
  CHECK(given({{Key::Name::home}, {Key::Name::letter, U'n'}}) == "nold.toml");
  CHECK(given({{Key::Name::backspace}}) == "old.tom");
}

TEST_CASE("files of the kind that is asked for come first, with the cursor on the first of them") {
  const StateFolder folder;
  (void)folder.with("work/a_note.txt", "nothing");
  (void)folder.with("work/mill.toml", content_of("samples/mill/machine.toml"));
  (void)folder.with("work/z_model.toml", kModel);
  FileChooser chooser(folder.path / "work", {{FileKind::model}});
  settle(chooser);
  const std::string text = seen(chooser);
  CAPTURE(text);
  check_holds(text, {">     z_model.toml", "machine"});
  CHECK(chooser.on_key({Key::Name::enter}) == FileChooser::Answer::chosen);
  CHECK(chooser.taken() == std::vector<std::string>{(folder.path / "work/z_model.toml").string()});
}

TEST_CASE("files used last are offered in every folder, if they are of the kind that is asked for") {
  const StateFolder folder;
  (void)folder.with("before/model.toml", kModel);
  (void)folder.with("before/mill.toml", content_of("samples/mill/machine.toml"));
  (void)folder.with("now/note.txt", "nothing");
  remember_file((folder.path / "before/mill.toml").string());
  remember_file((folder.path / "before/model.toml").string());
  FileChooser chooser(folder.path / "now", {{FileKind::model}});
  settle(chooser);
  for (int k = 0; k < 200 && !contains(seen(chooser), "used last"); ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    (void)chooser.advance();
  }
  CHECK(contains(seen(chooser), "before/model.toml"));
  CHECK_FALSE(contains(seen(chooser), "before/mill.toml"));
}

TEST_CASE("several files used last are marked and taken together") {
  const StateFolder folder;
  const std::string a = folder.with("before/a.csv", content_of("samples/laser/x_axis.csv"));
  const std::string b = folder.with("before/b.csv", content_of("samples/laser/x_axis.csv"));
  (void)folder.with("now/note.txt", "nothing");
  for (const std::string& file : {a, b}) remember_file(file);
  FileChooser chooser(folder.path / "now", {{FileKind::measurements}, true});
  for (int k = 0; k < 200 && !contains(seen(chooser), "used last"); ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    (void)chooser.advance();
  }
  CHECK(contains(seen(chooser), "[ ] before/b.csv"));
  (void)chooser.on_key({Key::Name::down});
  (void)chooser.on_key({Key::Name::letter, U' '});
  (void)chooser.on_key({Key::Name::letter, U' '});
  CHECK(contains(seen(chooser), "[x] before/a.csv"));
  CHECK(chooser.on_key({Key::Name::enter}) == FileChooser::Answer::chosen);
  CHECK(chooser.taken() == std::vector<std::string>{b, a});
}

TEST_CASE("a refused file is not marked, and the next one is taken alone") {
  const StateFolder folder;
  (void)folder.with("a.txt", "nothing");
  (void)folder.with("b.txt", "nothing");
  for (const bool many : {false, true}) {
    FileChooser chooser(folder.path, {{FileKind::model}, many});
    settle(chooser);
    for (int k = 0; k < 9 && !contains(seen(chooser), many ? "> [ ] a.txt" : ">     a.txt"); ++k)
      (void)chooser.on_key({Key::Name::down});
    CHECK(chooser.on_key({Key::Name::enter}) == FileChooser::Answer::chosen);
    chooser.refuse("a.txt is not a model");
    CHECK_FALSE(contains(seen(chooser), "[x]"));
    (void)chooser.on_key({Key::Name::down});
    CHECK(chooser.on_key({Key::Name::enter}) == FileChooser::Answer::chosen);
    CHECK(chooser.taken() == std::vector<std::string>{(folder.path / "b.txt").string()});
  }
}

TEST_CASE("plans, recipes and the errors of an emulated machine are named for what they are") {
  CHECK(looked_at("samples/mill/plan.toml").what == "measurement plan");
  CHECK(looked_at("samples/mill/recipe.toml").what == "recipe");
  for (const char* errors :
       {"samples/mill/errors.toml", "samples/warm_mill/errors.toml", "samples/five_axes/errors.toml"})
    CHECK(looked_at(errors).what == "true errors (emulator)");
}

TEST_CASE("a path that does not exist is refused and stays for correction") {
  const StateFolder folder;
  FileChooser chooser(folder.path, {});
  for (const char32_t letter : std::u32string(U"no/such.csv")) (void)chooser.on_key({Key::Name::letter, letter});
  CHECK(chooser.on_key({Key::Name::enter}) == FileChooser::Answer::open);
  CHECK(contains(seen(chooser), "there is no "));
  CHECK(contains(seen(chooser), "no/such.csv"));
}

TEST_CASE("files on the command line open in the screen that works with them") {
  const StateFolder folder;
  const std::string model = folder.with("model.toml", kModel);
  CHECK(title_for({"samples/mill/parameters.toml"}) == "parameters");
  CHECK(title_for({"samples/mill/machine.toml"}) == "parameters");
  CHECK(title_for({"samples/laser/x_axis.csv"}) == "FROM FILES TO THE MAP");
  CHECK(title_for({model, "samples/laser/x_axis.csv"}) == "open");
  CHECK(title_for({folder.with("note.txt", "nothing to read")}).empty());
}

TEST_CASE("a draft is kept when a file of the command line is opened") {
  const StateFolder folder;
  (void)keep_draft("parameters", "#@ as loaded\n");
  (void)title_for({"samples/mill/parameters.toml"});
  CHECK_FALSE(draft_of("parameters"));
  CHECK(drafts_aside("parameters") == 1);
}

}  // namespace
}  // namespace ecs::app
