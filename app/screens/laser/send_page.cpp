// Steps 8 and 9: the map saved, checked, sent; read back, and what comes next.
#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/screens/laser/screen.hpp"
#include "base/text.hpp"
#include "commissioning/maps/findings.hpp"
#include "params/fields.hpp"

namespace ecs::app {
namespace {

std::string check_text(const std::optional<std::uint32_t>& check) {
  return check ? fmt::format("checksum {:08X}", *check) : std::string("none");
}

/// Lines of "name   text", wrapped under the text.
class LineWriter {
 public:
  LineWriter(Canvas& canvas, const Area& area) : canvas_(&canvas), area_(area) {}
  void say(const std::string& name, const std::string& text, Tone tone = Tone::plain) {
    constexpr int kNameColumns = 12;
    canvas_->text(area_, row_, 1, name, Tone::faint);
    const Area right{area_.row, area_.column + kNameColumns, area_.rows, std::max(1, area_.columns - kNameColumns - 1)};
    row_ += std::max(1, canvas_->paragraph(right, row_, text, tone));
  }
  void skip() { ++row_; }
  [[nodiscard]] Area rest() const { return area_.below(std::min(row_, area_.rows)); }

 private:
  Canvas* canvas_;
  Area area_;
  int row_ = 0;
};

class SendPage final : public LaserPage {
 public:
  explicit SendPage(LaserHost& host) : LaserPage(host) {
    rows_ = {{"Enter", "check and send", [this] { check_and_send(); }},
             {"s", "save without sending"},
             {"f", "file", [this] { ask_file(); }},
             {"u", "undo"}};
  }

  void draw(Canvas& canvas, const Area& area) const override {
    const LaserController& d = controller();
    const LaserMapWork& map = d.work().map;
    LineWriter lines(canvas, area);
    const MapFiles files = files_of_map(d.choices().map_file);
    lines.say("map file", d.choices().map_file, Tone::strong);
    lines.say("unit", unit_text(d.unit().snapshot()), d.unit().snapshot().open ? Tone::plain : Tone::bad);
    lines.skip();
    lines.say("map", map_text(map), map.complete() && map.findings().empty() ? Tone::good : Tone::warning);
    if (map.complete())
      for (const std::string& remark : remarks_shown(map))
        lines.say("remark", finding_on_screen(remark), Tone::warning);
    const char* not_saved = map.made ? "no, or changed since: press s to save, Enter to save and send" : "no";
    lines.say("saved", d.saved() ? "yes, in its present state" : not_saved, d.saved() ? Tone::good : Tone::plain);
    lines.say("sent", sent_text(), d.sent_is_current() ? Tone::good : Tone::plain);
    if (!d.after_failure().empty()) lines.say("after that", d.after_failure(), Tone::warning);
    if (d.ready()) lines.say("checked", checked_text(*d.ready()));
    lines.skip();
    if (!map.complete() && map.parameters) lines.say("missing", missing_in(map), Tone::warning);
    if (d.sent_is_current() && !d.busy()) lines.say("next", "step 9 reads it back and compares it.");
    if (map.parameters && (!map.complete() || d.sent_is_current())) lines.skip();
    lines.say("files",
              d.choices().opened_map.empty()
                  ? fmt::format("The keys Enter and s also write {} (parameters) and {} (`ecs map build` makes the "
                                "same map from it).",
                                files.parameters, files.recipe)
                  : fmt::format("The keys Enter and s also write {} (parameters).", files.parameters),
              Tone::faint);
  }

  bool advance() override {
    if (!controller().ready() || controller().busy()) asked_ = false;
    if (!controller().ready() || controller().busy() || asked_) return false;
    asked_ = true;
    host().ask(question_before_sending(*controller().ready(), controller().unit().snapshot(),
                                       remarks_in(controller().work().map.findings())),
               [this] { controller().send(); });
    return true;
  }

 private:
  void ask_file() {
    host().fill(LaserForm("file for the map",
                          {{"file",
                            "the map as CSV; parameters and recipe are saved in the same folder",
                            controller().choices().map_file,
                            {},
                            true}},
                          [this](const std::vector<std::string>& v) {
                            if (v[0].empty()) return std::string("enter a file name for the map");
                            controller().change("the map's file", [&](LaserChoices& c) { c.map_file = v[0]; });
                            return std::string();
                          }));
  }

  void check_and_send() {
    if (!controller().work().map.parameters)
      return controller().message().say("the map needs parameters: choose them in step 6", Tone::bad);
    if (!controller().work().map.complete())
      return controller().message().say(
          "the map is incomplete, and the unit refuses incomplete maps: step 6 lists the missing components",
          Tone::bad);
    host().unless_there([this] { controller().prepare(); });
  }

  [[nodiscard]] std::string map_text(const LaserMapWork& map) const {
    if (!map.parameters) return "none yet: it needs parameters, which step 6 chooses";
    if (!map.made) return "cannot be built: see step 6";
    const laser::ErrorMap& made = map.made->map.map;
    std::set<Component> curves;
    for (const laser::MapTable& table : made.tables) curves.insert(table.component);
    return fmt::format("{} component{} {}{}, {} declared zero, {}", curves.size(), curves.size() == 1 ? "" : "s",
                       controller().choices().opened_map.empty() ? "measured" : "in the file",
                       made.tables.size() == 2 * curves.size() ? " (forward and reverse table)" : "",
                       made.header.declared_zero.size(), completeness(map.findings()));
  }
  static std::string missing_in(const LaserMapWork& map) {
    std::vector<std::string> names;
    for (const LaserComponent& one : map.components)
      if (one.state == ComponentState::missing || one.state == ComponentState::refused)
        names.emplace_back(name_of(one.component));
    return names.empty() ? "see the findings of step 6" : fmt::format("{} (step 6)", fmt::join(names, ", "));
  }
  /// As many as leave room for the rest of the page.
  static std::vector<std::string> remarks_shown(const LaserMapWork& map) {
    constexpr std::size_t kMost = 3;
    std::vector<std::string> remarks = remarks_in(map.findings());
    if (remarks.size() <= kMost) return remarks;
    const std::size_t more = remarks.size() - (kMost - 1);
    remarks.resize(kMost - 1);
    remarks.push_back(fmt::format("and {} more: step 6", more));
    return remarks;
  }
  static std::string checked_text(const ReadyMap& ready) {
    std::string text = "the unit has enough memory and matches the map";
    for (const std::string& note : ready.map->image.notes) text += "; " + note;
    return text;
  }
  std::string sent_text() const {
    const auto& sent = controller().sent();
    if (!sent && !controller().after_failure().empty()) return "not confirmed: sending was interrupted";
    if (!sent && controller().saved() && !controller().sent_earlier().empty())
      return fmt::format("to unit {}, before this work was continued: step 9 compares it", controller().sent_earlier());
    if (!sent) return "no";
    return fmt::format("{}unit {}, {} of {} bytes in {:.1f} s, {}, commit no. {}",
                       controller().sent_is_current() ? "" : "changed since it was sent: ",
                       sent->identity.serial_number, sent->report.bytes_sent, sent->report.bytes, sent->seconds,
                       check_text(sent->check), sent->report.commit_sequence);
  }

  bool asked_ = false;  ///< about the map that is ready
};

class VerifyPage final : public LaserPage {
 public:
  explicit VerifyPage(LaserHost& host) : LaserPage(host) {
    const auto compensate = [this] {
      if (controller().may_compensate())
        this->host().ask({"Switch the unit to compensation?",
                          "The program first checks that the unit still contains the compared or sent map. The unit "
                          "then tests its memory, closes the relays once every axis is referenced, and from then on "
                          "moves the axes by the values of that map.",
                          "switch", "not now"},
                         [this] { controller().compensate(); });
    };
    const auto comparable = [this] { return controller().has_saved(); };
    rows_ = {{"Enter", "read back and compare", [this] { controller().verify(); }, comparable, true},
             {"c", "compensation", compensate},
             {"up/down", "differences"}};
  }

  void draw(Canvas& canvas, const Area& area) const override {
    const LaserController& d = controller();
    LineWriter lines(canvas, area);
    lines.say("unit", unit_text(d.unit().snapshot()), d.unit().snapshot().open ? Tone::plain : Tone::bad);
    if (!d.verdict()) {
      lines.skip();
      lines.say("compare", d.sent() ? "Press Enter to read the unit's map back and compare it with the file."
                           : d.has_saved()
                               ? "No map sent yet: see step 8. Press Enter to compare the unit with the last saved map."
                               : "No map saved or sent yet: see step 8.");
      return;
    }
    const MapVerdict& verdict = *d.verdict();
    const std::string& stale = d.stale();
    if (!stale.empty())
      lines.say("compared", "the unit has changed since then: verify again (Enter). Reason: " + stale, Tone::bad);
    lines.say(stale.empty() ? "compared" : "then",
              verdict.same() ? "the unit contains this map and its parameters, value by value"
                             : fmt::format("{} differences in the map, {} in the parameters",
                                           verdict.differences.size(), verdict.parameters.size()),
              !stale.empty() ? Tone::faint : (verdict.same() ? Tone::good : Tone::bad));
    lines.say("its map", fmt::format("{}, commit no. {}", check_text(d.compared().check), d.compared().activations));
    if (verdict.same() && stale.empty() && !d.verified())
      lines.say("", "The choices have changed since then: step 8 sends the present map.", Tone::warning);
    lines.skip();
    if (verdict.same() && stale.empty()) {
      lines.say("next",
                "1. the first time: check polarity and scale of every axis (ECS UTILITY, OUTPUT COMPENSATION VALUE)");
      lines.say("", d.unit().snapshot().emulator
                        ? "2. press c to switch to compensation; g in DISPLAY ECS STATUS (F3) references the machine"
                        : "2. press c to switch to compensation; reference every axis at the control");
      const bool emulated = d.unit().snapshot().emulator;
      lines.say("", std::string("3. measure the same lines again, compensated, into another folder") +
                        (emulated ? ": e in step 1, phase after" : ""));
      lines.say("", "4. compare before and after: F3, laser table, or the report");
      return;
    }
    const Area rest = lines.rest();
    draw_scrolled(canvas, {rest.row, rest.column + 1, rest.rows, rest.columns - 2}, differences_of(verdict), scroll_);
  }

  bool advance() override {
    controller().watch_verdict();
    return false;
  }

  bool on_key(const Key& key) override { return act_on(rows_, key) || scroll_.on_key(key); }

 private:
  static std::vector<std::string> differences_of(const MapVerdict& verdict) {
    std::vector<std::string> lines;
    for (const MapDifference& one : verdict.differences) lines.push_back(one.message);
    for (const std::string_view line : lines_of(params::to_text(verdict.parameters, "file", "unit")))
      lines.emplace_back(line);
    return lines;
  }
  ScrollPlace scroll_;
};

}  // namespace

std::unique_ptr<LaserPage> laser_send_page(LaserHost& host) { return std::make_unique<SendPage>(host); }
std::unique_ptr<LaserPage> laser_verify_page(LaserHost& host) { return std::make_unique<VerifyPage>(host); }

}  // namespace ecs::app
