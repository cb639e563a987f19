// What was done by the controllers of the screens, done again by the commands that they noted: the same files.
#include <filesystem>
#include <thread>

#include "commissioning/model_session/controller.hpp"
#include "commissioning/parameters/controller.hpp"
#include "commissioning/session/commands.hpp"
#include "tests/screens/support/laser_screen.hpp"
#include "tests/support/model_workspace.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

namespace fs = std::filesystem;

/// A session in a folder of its own, which is the working folder as long as it lives; then the same in another one.
class Session {
 public:
  /// @param inputs  writes what is there before
  explicit Session(std::function<void(const Folder&)> inputs) : inputs_(std::move(inputs)) {
    inputs_(session_);
    fs::current_path(session_.path);
    forget_commands();
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session() {
    fs::current_path(source_);
    forget_commands();
  }

  /// Every command and file that was noted, in the other folder: it makes the same files.
  void check_replay(std::initializer_list<const char*> files) const {
    inputs_(again_);
    fs::current_path(again_.path);
    const auto noted = noted_commands();
    for (const NotedCommand& command : noted) {
      CAPTURE(command_text(command));
      if (!command.file.empty()) {
        fs::create_directories((again_.path / command.file).parent_path());
        again_.with(command.file, command.text);
      } else if (!command.words.empty() && command.words.front() == "cp") {
        fs::copy_file(command.words[1], command.words[2]);
      } else if (!command.words.empty()) {
        for (std::size_t k = 0; k + 1 < command.words.size(); ++k)
          if (command.words[k] == "-o") fs::create_directories(fs::absolute(command.words[k + 1]).parent_path());
        const Ran r = ran({command.words.begin() + 1, command.words.end()});
        CAPTURE(r.messages);
        CHECK(r.code == command.exit_code);
      }
    }
    fs::current_path(session_.path);
    for (const char* file : files) {
      CAPTURE(file);
      REQUIRE(fs::exists(session_.path / file));
      REQUIRE(fs::exists(again_.path / file));
      CHECK(content_of(session_ / file) == content_of(again_ / file));
    }
  }
  [[nodiscard]] static bool noted(const std::string& part) {
    for (const NotedCommand& command : noted_commands())
      if (contains(command_text(command), part)) return true;
    return false;
  }
  [[nodiscard]] std::string source(const std::string& path) const { return (source_ / path).string(); }

 private:
  StateFolder state_;
  Folder session_, again_;
  fs::path source_ = fs::current_path();
  std::function<void(const Folder&)> inputs_;
};

// --- parameters

void mill_parameters(const Folder& folder) {
  folder.with("mill.toml", content_of((fs::path(ECS_BUILD_FOLDER) / "../../samples/mill/parameters.toml").string()));
  folder.with("machine.toml", content_of((fs::path(ECS_BUILD_FOLDER) / "../../samples/mill/machine.toml").string()));
}

TEST_CASE("parameters changed and saved: one command with what differs, also in place and without a change") {
  Session session(mill_parameters);
  ParametersController controller;
  REQUIRE(controller.open_file("mill.toml"));
  REQUIRE(controller.change("axis.X.deadband_um", "2.5"));
  REQUIRE(controller.change("axis.Y.deadband_um", "3.5"));
  REQUIRE(controller.change("identity.machine", "it's a new one"));
  REQUIRE_FALSE(controller.undo().empty());
  REQUIRE_FALSE(controller.redo().empty());
  REQUIRE(controller.save("out.toml"));
  REQUIRE(controller.change("axis.X.deadband_um", "4"));
  REQUIRE(controller.save("out.toml"));
  REQUIRE(controller.save("copy.toml"));
  CHECK(noted_commands().size() == 3);
  session.check_replay({"out.toml", "copy.toml"});
}

TEST_CASE("parameters started from a machine file") {
  Session session(mill_parameters);
  ParametersController controller;
  REQUIRE(controller.start_from_machine("machine.toml"));
  REQUIRE(controller.change("axis.X.deadband_um", "2.5"));
  REQUIRE(controller.save("new.toml"));
  CHECK(session.noted("ecs params new --machine machine.toml -o new.toml"));
  session.check_replay({"new.toml"});
}

TEST_CASE("parameters of a draft: from the file it belongs to, else as they are") {
  Session session(mill_parameters);
  {
    ParametersController before;
    REQUIRE(before.open_file("mill.toml"));
    REQUIRE(before.change("axis.X.deadband_um", "2.5"));
  }
  {
    ParametersController controller;
    REQUIRE(controller.draft());
    REQUIRE(controller.take_up_draft());
    REQUIRE(controller.save("out.toml"));
  }
  {
    ParametersController before;
    REQUIRE(before.start_from_machine("machine.toml"));
    REQUIRE(before.change("axis.X.deadband_um", "2.5"));
  }
  ParametersController controller;
  REQUIRE(controller.draft());
  REQUIRE(controller.take_up_draft());
  REQUIRE(controller.save("other.toml"));
  session.check_replay({"out.toml", "other.toml"});
}

// --- model

void model_inputs(const Folder& folder) {
  folder.with("model.toml", kStraightModel);
  folder.with("data.csv", measured_x(cyclic_x));
}

void wait_for(ModelController& controller) {
  do {
    (void)controller.advance();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  } while (controller.busy());
}

std::unique_ptr<ModelController> opened_model() {
  return must(ModelController::open({"model.toml", {"data.csv"}, "", {}}));
}

std::size_t place_of(const ModelController& controller, const std::string& id) {
  for (std::size_t i = 0; i < controller.model().effects.size(); ++i)
    if (contains(to_text(controller.model().effects[i]), id)) return i;
  FAIL("no effect ", id);
  return 0;
}

TEST_CASE("effects added, taken back, added by diagnosis and saved") {
  Session session(model_inputs);
  const auto controller = opened_model();
  controller->start_diagnosis();
  wait_for(*controller);
  REQUIRE(controller->diagnosis());
  controller->start_adding(std::size_t{0});
  wait_for(*controller);
  CHECK(controller->start_adding("progressive:X:EX").empty());
  wait_for(*controller);
  controller->undo();
  wait_for(*controller);
  CHECK(noted_commands().size() == 1);  // nothing is written yet
  controller->save();
  CHECK_FALSE(session.noted("progressive"));
  session.check_replay({"model.toml"});
}

TEST_CASE("an effect of the file taken back, one removed, one decided for, saved in between") {
  Session session([](const Folder& folder) {
    model_inputs(folder);
    const std::string model = folder / "model.toml", data = folder / "data.csv";
    REQUIRE(ran({"model", "add", model, "cyclic:X:EX", "--or", "servo_lag:X:EX", "--data", data, "-o", model}).code ==
            0);
    // its ladder names the file as the session does
    std::string text = content_of(model);
    for (std::size_t at = text.find(data); at != std::string::npos; at = text.find(data))
      text.replace(at, data.size(), "data.csv");
    folder.with("model.toml", text);
  });
  const auto controller = opened_model();
  controller->decide(place_of(*controller, "cyclic"));
  controller->save();
  CHECK(session.noted("ecs model decide cyclic:X:EX model.toml"));
  CHECK(controller->start_adding("progressive:X:EX").empty());
  wait_for(*controller);
  controller->save();
  controller->start_removing(place_of(*controller, "cyclic"));
  wait_for(*controller);
  controller->save();
  CHECK(session.noted("ecs model remove cyclic:X:EX model.toml data.csv"));
  session.check_replay({"model.toml"});
}

TEST_CASE("what no command does to a model is carried as it is") {
  Session session(model_inputs);
  const auto controller = opened_model();
  CHECK(controller->start_adding("cyclic:X:EX").empty());
  wait_for(*controller);
  controller->save();
  controller->start_removing(place_of(*controller, "cyclic"));
  wait_for(*controller);
  controller->save();
  controller->undo();  // the removal, which is in the file
  wait_for(*controller);
  controller->save();
  CHECK(noted_commands().back().file == "model.toml");
  session.check_replay({"model.toml"});
}

// --- laser data

void lathe_lines(const Folder& folder) {
  mill_parameters(folder);
  const auto curve = [](double p) { return 10.0 * std::sin(p / 300.0); };
  folder.with("EXX.csv", measured_csv(kPositioning, curve));
  folder.with("more.csv", measured_csv(kPositioning, curve));
  folder.with("EYY.csv", measured_csv({'Y', "EY", -1400, 0, 100, {0, 0, 0}}, curve));
  folder.with("EZZ.csv", measured_csv({'Z', "EZ", 0, -1000, 100, {0, -700, 0}}, curve));
}

TEST_CASE("a map of joined, corrected and thinned lines, with a scope and a remark") {
  Session session(lathe_lines);
  LaserScreenDriver driver;
  driver.controller().change("all", [](LaserChoices& c) {
    for (const char* file : {"EXX.csv", "more.csv", "EYY.csv", "EZZ.csv"}) c.files.push_back({file, {}});
    c.files.back().places["EZ along Z at X 0, Y -700"] = "x=0,y=-1400";
    c.lines[kExx].runs[2] = "it's cold";
    c.lines[kExx].readings[5] = "";
    c.lines["EY along Y at X 0, Z 0"].runs[1] = "warming up";
    laser::settings_in(c.recipe, Component::EXX).smoothing_mm = 300.0;
    laser::settings_in(c.recipe, Component::EYY).increment_mm = 50.0;
    c.params_file = "mill.toml";
    c.scope = "linear";
    c.recipe.engineer = "S. R. Postlethwaite";
    c.recipe.remark = "for training";
    c.map_file = "out/map.csv";
  });
  REQUIRE(driver.settled());
  CAPTURE(driver.seen());
  REQUIRE(driver.controller().work().map.complete());
  driver.controller().save();
  REQUIRE(driver.settled());
  CHECK(session.noted("ecs laser prepare EXX.csv more.csv --line '" + kExx + "' --leave-out-run '2=it'\\''s cold'"));
  CHECK(session.noted("--place x=0,y=-1400"));
  CHECK(contains(content_of("out/map.csv"), "remark: for training"));
  session.check_replay({"out/map.csv", "out/map-parameters.toml"});

  SUBCASE("and saved again after a change: the script overwrites its own file") {
    driver.controller().change("another engineer", [](LaserChoices& c) { c.recipe.engineer = "Jo Fitter"; });
    REQUIRE(driver.settled());
    driver.controller().save();
    REQUIRE(driver.settled());
    CHECK(session.noted("--params-out out/map-parameters.toml --force"));
  }
}

TEST_CASE("a map that was opened, with a component declared zero since") {
  Session session([](const Folder& folder) {
    lathe_lines(folder);
    const fs::path here = fs::current_path();
    fs::current_path(folder.path);
    REQUIRE(ran({"params", "set", "mill.toml", "compensation.scope=linear", "-o", "linear.toml"}).code == 0);
    REQUIRE(ran({"map", "build", "EXX.csv", "EYY.csv", "--params", "linear.toml", "-o", "two.csv"}).code == 0);
    fs::current_path(here);
  });
  LaserScreenDriver driver;
  driver.controller().open_map("two.csv");
  driver.controller().change("the rest", [](LaserChoices& c) {
    c.params_file = "linear.toml";
    laser::declare_zero(c.recipe, Component::EZZ, "not measured");
    c.map_file = "three.csv";
  });
  REQUIRE(driver.settled());
  driver.controller().save();
  REQUIRE(driver.settled());
  session.check_replay({"three.csv", "three-parameters.toml"});
}

}  // namespace
}  // namespace ecs::app
