#include "app/screens/logbook/screen.hpp"

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/ui/widgets.hpp"
#include "app/verbs/registry.hpp"
#include "base/outcome.hpp"
#include "commissioning/logbook_session/controller.hpp"

namespace ecs::app {
namespace {

/// A verb in the thread that asks for it.
Result<std::string> done_again(const std::vector<std::string>& words) {
  std::vector<std::string> with_json = words;
  with_json.emplace_back("--json");
  std::ostringstream out, messages;
  if (run_program(with_json, out, messages) <= kDoesNotHold) return out.str();
  return problem(ProblemKind::refused, out.str() + messages.str());
}

class LogbookScreen final : public Screen {
 public:
  LogbookScreen() : controller_(done_again) { follow(); }

  [[nodiscard]] std::string title() const override { return "LOGBOOK"; }

  void draw(Canvas& canvas, const Area& area) const override {
    if (area.rows < 5 || area.columns < 10) return;
    const Area inside = area.between_margins();
    if (!whole_.empty()) return draw_scrolled(canvas, area, sentences_wrapped(whole_, inside.columns), scroll_);
    const auto& entries = controller_.entries();
    const std::size_t books = controller_.books().size();
    canvas.text(inside, 0, 0,
                entries.empty()
                    ? std::string("logbook")
                    : fmt::format("{}: {} entries{}", controller_.owner(), entries.size(),
                                  books > 1 ? fmt::format(" ({} logbooks, Tab shows the next)", books) : ""),
                Tone::strong);
    canvas.text(inside, 1, 0, controller_.book(), Tone::faint);
    const Area list{area.row + 3, area.column, std::max(1, area.rows - 5), area.columns};
    if (entries.empty()) {
      canvas.paragraph(inside, 3, controller_.absent().empty() ? "It holds no entry." : controller_.absent());
    } else {
      canvas.text(inside, 2, 1, fmt::format("{:>6} {:<16} {:<18} what", "number", "time (UTC)", "kind"), Tone::faint);
      std::vector<ListRow> rows;
      for (const LogbookEntry& entry : entries) rows.push_back({row_of(entry)});
      draw_list(canvas, list, rows, place_);
    }
    const Area bottom{area.row + area.rows - 1, area.column + 1, 1, inside.columns};
    if (controller_.running())
      canvas.text(bottom, 0, 0, controller_.doing() + " ...", Tone::warning);
    else
      canvas.text(bottom, 0, 0, controller_.message().text(), controller_.message().tone());
  }

  [[nodiscard]] Step on_key(const Key& key) override {
    if (!whole_.empty()) {
      if (key.name == Key::Name::escape)
        whole_.clear();
      else
        (void)scroll_.on_key(key);
      return stay();
    }
    const auto count = static_cast<int>(controller_.entries().size());
    if (key.name == Key::Name::escape) return back();
    if (key.name == Key::Name::mouse) {
      if (const auto clicked = place_.clicked(key); clicked && *clicked < count) place_.selected = *clicked;
    } else if (key.name == Key::Name::enter) {
      open_selected();
    } else if (key.name == Key::Name::tab) {
      controller_.open_next();
      follow();
    } else if (is_letter(key, U'v')) {
      controller_.verify();
    } else if (is_letter(key, U'r')) {
      controller_.replay();
    } else {
      (void)place_.on_key(key, count);
    }
    return stay();
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (!whole_.empty()) return {{"Up Down", "scroll"}, {"Esc", "entries"}};
    return {{"Enter", "the entry whole"}, {"v", "verify"}, {"r", "replay"}, {"Tab", "next logbook"}, {"Esc", "back"}};
  }

  [[nodiscard]] std::string help() const override {
    return "What verbs and screens did at a machine, written by themselves: measurements, maps, parameters, transfers, "
           "diagnoses, reports, each with its files and tied by its hash to the entry before. v checks every entry: a "
           "change is found and the first one named. r derives the active map again from the raw readings and compares "
           "it "
           "bit for bit. `ecs log` does the same, compares two years and writes a calibration certificate "
           "(docs/logbook.md). ECS_LOGBOOK=off keeps no logbook.";
  }

  [[nodiscard]] bool advance() override {
    const std::size_t before = controller_.entries().size();
    const bool at_end = place_.selected + 1 >= static_cast<int>(before);
    if (!controller_.advance()) return false;
    if (controller_.entries().size() != before && at_end) follow();
    if (!controller_.answer().empty()) {
      show(controller_.answer());
      controller_.forget_answer();
    }
    return true;
  }

 private:
  static std::string row_of(const LogbookEntry& entry) {
    std::string time = entry.time.substr(0, 16);
    std::replace(time.begin(), time.end(), 'T', ' ');
    return fmt::format("{:>6} {:<16} {:<18} {}", entry.number, time, entry.kind, entry.summary);
  }

  void follow() { place_.selected = std::max(0, static_cast<int>(controller_.entries().size()) - 1); }

  void show(std::vector<std::string> lines) {
    whole_ = std::move(lines);
    scroll_ = {};
  }

  void open_selected() {
    const auto& entries = controller_.entries();
    if (const auto at = static_cast<std::size_t>(place_.selected); at < entries.size())
      show(controller_.lines_of(entries[at].number));
  }

  LogbookController controller_;
  ListPlace place_;
  std::vector<std::string> whole_;  ///< an entry, or what replay found; empty: the list
  ScrollPlace scroll_;
};

}  // namespace

std::unique_ptr<Screen> logbook_screen() { return std::make_unique<LogbookScreen>(); }

}  // namespace ecs::app
