// An investigation with the bundled emulator, whose port this program itself has open. A person brings files: right
// ones, wrong ones, and stops in between.
#include "modules/investigation/workshops.hpp"

#include <chrono>
#include <filesystem>
#include <thread>

#include <fmt/format.h>

#include "base/file.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "laser/writers/writers.hpp"
#include "modules/investigation/tests/made_workshop.hpp"
#include "tests/support/emulator.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/test.hpp"

namespace ecs::commissioning {
namespace {

/// The link that this program has open.
OpenUnit open_unit_of(UnitConnection& unit, JobControl& control) {
  const WatchedUnit seen = unit.snapshot();
  return {seen.where, seen.workshop, [&](const auto& work) {
            return unit.with_link(control, [&](UnitLink& link) { return work(link.client()); });
          }};
}

TEST_CASE("the map goes to the unit over the link that is open; its port cannot be opened a second time") {
  const StateFolder folder;
  const std::string machine_file = folder / "machine.toml";
  for (const char* name : {"machine.toml", "errors.toml"})
    std::filesystem::copy_file(std::string("samples/investigation/") + name, folder / name);
  const auto unit = std::make_shared<UnitConnection>("emulator:" + machine_file);
  for (int k = 0; k < 3000 && !unit->newest(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  REQUIRE_MESSAGE(unit->newest(), unit->snapshot().problem);
  const WatchedUnit seen = unit->snapshot();
  REQUIRE_FALSE(seen.workshop.empty());
  const auto machine = must(params::read_machine(machine_file));
  const auto model = must(
      model::parse_model("[[effect]]\nid = \"scale\"\naxis = \"X\"\nsense = \"EX\"\nparameters = { um_per_m = 20.0 }\n",
                         "model.toml", folder.path));
  JobControl control;
  NoMessages messages;
  SocketWorkshopOptions options;
  options.socket = seen.workshop;
  options.sources.machine = machine_file;
  options.machine = machine.machine;
  SUBCASE("opened on its own it is refused") {
    const auto workshop = must(SocketWorkshop::open(messages, options, control.cancelled));
    CHECK(contains(must_fail(workshop->activate(model)).message, "in use by"));
  }
  SUBCASE("over the open link the unit is compensating afterwards") {
    options.open_unit = open_unit_of(*unit, control);
    SUBCASE("known by the socket") {}
    SUBCASE("known by the port") { options.open_unit.workshop.clear(); }
    const auto workshop = must(SocketWorkshop::open(messages, options, control.cancelled));
    (void)must(workshop->activate(model));
    const auto status = must(unit->with_link(control, [](UnitLink& link) { return link.client().status(); }));
    CHECK(status.mode == UnitMode::compensating);
  }
}

/// A head B on a head C over X, Y, Z; B turns too far by 0.6 um/m for each degree, and the head bends along its X.
std::string head_machine(const StateFolder& folder) {
  std::string machine = "name = \"head\"\nconfiguration = \"TXYZCB\"\n[emulator]\nseed = 3\nerrors = \"errors.toml\"\n";
  for (const char* axis : {"X", "Y", "Z"})
    machine += fmt::format("[axis.{0}]\ntravel_mm = [-1000.0, 1000.0]\n[emulator.axis.{0}]\ndrive = \"ideal\"\n", axis);
  machine +=
      "[axis.B]\ntravel_deg = [-95.0, 95.0]\npivot_mm = [0.0, 0.0, 250.0]\n"
      "[axis.C]\ntravel_deg = [0.0, 360.0]\npivot_mm = [0.0, 0.0, 500.0]\n";
  must(write_file(folder / "machine.toml", machine));
  must(write_file(folder / "errors.toml",
                  "[location]\nXOB = 12.0\nAOC = 30.0\n"
                  "[[contribution]]\ncomponent = \"EBB\"\nformula = \"0.6*p\"\n"
                  "[[contribution]]\ncomponent = \"EXB\"\nformula = \"15*sin(p*pi/180)\"\n"));
  return folder / "machine.toml";
}

TEST_CASE("an investigation of a machine with a head measures a ball too, and names what is hidden in the head") {
  const StateFolder folder;
  const std::string machine_file = head_machine(folder);
  const auto unit = std::make_shared<UnitConnection>("emulator:" + machine_file);
  for (int k = 0; k < 3000 && !unit->newest(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  REQUIRE_MESSAGE(unit->newest(), unit->snapshot().problem);
  const auto machine = must(params::read_machine(machine_file));
  JobControl control;
  NoMessages messages;
  SocketWorkshopOptions options;
  options.socket = unit->snapshot().workshop;
  options.sources.machine = machine_file;
  options.machine = machine.machine;
  options.open_unit = open_unit_of(*unit, control);
  const auto workshop = must(SocketWorkshop::open(messages, options, control.cancelled));
  const Investigation found =
      must(investigate(usual_model(), machine.machine, *workshop, {.minutes = 300.0, .times = workshop_times()}));
  INFO(summary_text(found));
  double of_ball_min = 0.0, all_min = 0.0;
  std::size_t sets = 0;
  for (const InvestigationStep& step : found.steps) {
    all_min += step.minutes;
    if (!step.measured.starts_with("ball ")) continue;
    ++sets;
    of_ball_min += step.minutes;
  }
  CHECK(sets >= 2);  // the first shows bending of the head or of the tool, another length of the tool which
  CHECK(of_ball_min > 30.0);
  CHECK(found.minutes == Approx(all_min));
  CHECK(found.minutes <= 300.0);
  const auto cause = [&](std::string_view name) {
    const auto at = std::ranges::find(found.causes, name, &InvestigatedCause::name);
    REQUIRE_MESSAGE(at != found.causes.end(), name);
    return *at;
  };
  CHECK(cause("tilt_scale:B:EB").parameters.front().value == Approx(0.6).epsilon(0.05));
  CHECK(cause("head_bending").rms_um > 4.0);
  CHECK(found.causes.size() == 2);
  CHECK(found.verdict == model::Verdict::missing_effect);
  REQUIRE(found.ball_model);
  for (const model::EffectInstance& effect : found.model.effects) CHECK(to_text(effect) != "tilt_scale:B:EB");
}

class KeptMessages final : public MessageSink {
 public:
  void note(std::string_view text) override { all += std::string(text) + "\n"; }
  void warn(std::string_view text) override { all += "warning: " + std::string(text) + "\n"; }
  [[nodiscard]] bool say(const std::string& words) const { return contains(all, words); }
  std::string all;
};

double error_of_x(double x_mm, int approach) { return 0.01 * x_mm + approach; }

/// A folder under watch; `deeds` are done one at a time, while it waits.
struct Watch {
  Folder folder;
  KeptMessages messages;
  std::atomic<bool> cancelled{false};
  std::string model = folder.with("model.toml", "[[effect]]\nid = \"offset\"\naxis = \"X\"\nsense = \"EX\"\n");
  std::vector<std::function<void()>> deeds;
  std::size_t done = 0;
  int idle = 0;

  [[nodiscard]] std::unique_ptr<WatchedFolder> opened() {
    WatchedFolderOptions options{.folder = folder.path / "readings", .model = model, .machine = one_axis_machine()};
    options.pause = [this](std::chrono::milliseconds) {
      constexpr int kLooks = 3;  // between two deeds: a file is taken when two looks find it the same
      if (++idle % kLooks != 0) return true;
      if (done == deeds.size()) return false;
      deeds[done++]();
      return true;
    };
    return must(WatchedFolder::open(messages, options, cancelled));
  }
  void put(const std::string& name, const std::string& text) const { (void)folder.with("readings/" + name, text); }
};

RequestedRun run_of_x(int number = 1) {
  return {.number = number, .proposal = first_look({Axis::X, Sense::EX}, one_axis_machine(), workshop_times())};
}

std::string right_file(unsigned seed = 1) {
  return laser::to_csv(made_readings(run_of_x().proposal, error_of_x, 0.2, seed, 0.0));
}

TEST_CASE("a run is asked for in words, with its part program and its targets, and its file is taken") {
  Watch watch;
  watch.deeds = {[&] { watch.put("x.csv", right_file()); }};
  CHECK(must(watch.opened()->measure(run_of_x())).set.readings.size() == 2 * 2 * run_of_x().proposal.targets_mm.size());
  CHECK(watch.messages.say("Measure EX along X, first look: "));
  CHECK(contains(content_of(watch.folder / "readings/asked/run_01.nc"), "M08"));
  CHECK(std::filesystem::exists(watch.folder / "readings/asked/run_01_targets.csv"));
}

TEST_CASE("a file that is half written is named, stays, and is taken once it is whole") {
  Watch watch;
  const std::string whole = right_file();
  watch.deeds = {[&] { watch.put("x.csv", whole.substr(0, whole.size() / 2)); }, [&] { watch.put("x.csv", whole); }};
  (void)must(watch.opened()->measure(run_of_x()));
  CHECK(watch.messages.say("x.csv is not accepted and not moved"));
  CHECK(content_of(watch.folder / "readings/x.csv") == whole);
}

TEST_CASE("a file that grows between two looks is not touched") {
  Watch watch;
  const std::string whole = right_file();
  const std::size_t line_end = whole.find('\n', whole.size() / 2) + 1;  // whole lines, but not all of them
  auto opened = watch.opened();
  watch.deeds = {[&] { watch.put("x.csv", whole.substr(0, line_end)); }};
  watch.put("x.csv", whole.substr(0, line_end / 2));
  watch.idle = 2;  // the first look finds half, the second another size
  watch.deeds.emplace_back([&] { watch.put("x.csv", whole); });
  CHECK(opened->measure(run_of_x()).has_value());
}

TEST_CASE("a file that ends between two lines is named, until it is whole or said to be complete") {
  Watch watch;
  const std::string whole = right_file();
  const std::string lines = whole.substr(0, whole.rfind('\n', whole.size() - 2) + 1);  // the last reading is missing
  watch.deeds = {[&] { watch.put("x.csv", lines); }};
  SUBCASE("whole") {
    watch.deeds.emplace_back([&] { watch.put("x.csv", whole); });
  }
  SUBCASE("complete") {
    watch.deeds.emplace_back([&] { watch.put("x.csv.complete", ""); });
  }
  CHECK(watch.opened()->measure(run_of_x()).has_value());
  CHECK(watch.messages.say("it contains 51 of the 52 requested readings"));
}

TEST_CASE("readings of another axis, sense, line or approach are named and asked for again") {
  Watch watch;
  model::MeasurementProposal other = run_of_x().proposal;
  std::string words;
  SUBCASE("axis") {
    other.axis = Axis::Y;
    other.sense = Sense::EY;
    words = "it contains EY along Y; EX along X";
  }
  SUBCASE("sense") {
    other.sense = Sense::EZ;
    words = "it contains EZ along X; EX along X";
  }
  SUBCASE("line") {
    other.parked_mm[1] = 250.0;
    words = "it was measured at Y 250 mm; Y 0 mm";
  }
  SUBCASE("approach") {
    other.bidirectional = false;
    words = "it has no readings of reverse approach";
  }
  const std::string wrong = laser::to_csv(made_readings(other, error_of_x, 0.2, 1, 0.0));
  watch.deeds = {[&] { watch.put("a.csv", wrong); }, [&] { watch.put("b.csv", right_file()); }};
  CHECK(watch.opened()->measure(run_of_x()).has_value());
  CHECK(watch.messages.say(words));
  CHECK(watch.messages.say("Run 1 is still needed"));
  CHECK(content_of(watch.folder / "readings/a.csv") == wrong);
}

TEST_CASE("the same readings given twice, under whatever name, are named") {
  Watch watch;
  auto opened = watch.opened();
  watch.deeds = {[&] { watch.put("x.csv", right_file(1)); }, [&] { watch.put("again.csv", right_file(1)); },
                 [&] { watch.put("second.csv", right_file(2)); }};
  REQUIRE(opened->measure(run_of_x(1)).has_value());
  REQUIRE(opened->measure(run_of_x(2)).has_value());
  CHECK(watch.messages.say("again.csv is not accepted and not moved: the same readings were provided as x.csv"));
}

TEST_CASE("while the model is another one no file is taken") {
  Watch watch;
  const std::string before = content_of(watch.model);
  auto opened = watch.opened();
  watch.deeds = {[&] { (void)watch.folder.with("model.toml", before + "\n"); },
                 [&] { watch.put("x.csv", right_file()); },
                 [&] {
                   CHECK(watch.messages.say("is not the model of this investigation"));
                   CHECK_FALSE(watch.messages.say("x.csv is taken"));
                   (void)watch.folder.with("model.toml", before);
                 }};
  CHECK(opened->measure(run_of_x()).has_value());
}

TEST_CASE("a stop keeps the ledger, and the next start goes on after the runs that were given") {
  Watch watch;
  watch.deeds = {[&] { watch.put("x.csv", right_file(1)); }};
  {
    auto opened = watch.opened();
    REQUIRE(opened->measure(run_of_x(1)).has_value());
    CHECK(contains(must_fail(opened->measure(run_of_x(2))).message, "ledger.json"));
  }
  watch.deeds.emplace_back([&] { watch.put("second.csv", right_file(2)); });
  auto opened = watch.opened();
  CHECK(watch.messages.say("1 run was already provided"));
  CHECK(opened->measure(run_of_x(1)).has_value());
  CHECK(watch.done == 1);  // nothing was waited for
  CHECK(opened->measure(run_of_x(2)).has_value());
}

TEST_CASE("a stop before any readings were accepted names no ledger") {
  Watch watch;
  const std::string stopped = must_fail(watch.opened()->measure(run_of_x())).message;
  CHECK(contains(stopped, "No readings have been accepted"));
  CHECK_FALSE(contains(stopped, "ledger.json"));
}

TEST_CASE("a file of the ledger that was changed since is asked for again") {
  Watch watch;
  watch.deeds = {[&] { watch.put("x.csv", right_file(1)); }};
  REQUIRE(watch.opened()->measure(run_of_x(1)).has_value());
  watch.put("x.csv", right_file(3));
  const auto readings = watch.opened()->measure(run_of_x(1));
  CHECK(readings.has_value());
  CHECK(watch.messages.say("x.csv, provided for run 1: the file was changed since"));
}

}  // namespace
}  // namespace ecs::commissioning
