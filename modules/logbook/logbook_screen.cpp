// The screen LOGBOOK: what was done at a machine, one entry whole, verified and replayed.
#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/screens/unit/list_screen.hpp"
#include "app/screens/unit/screens.hpp"
#include "app/verbs/registry.hpp"
#include "base/answer_table.hpp"
#include "base/outcome.hpp"
#include "base/text.hpp"
#include "commissioning/session/task_runner.hpp"
#include "modules/logbook/place.hpp"
#include "modules/logbook/recorder.hpp"
#include "modules/logbook/replay.hpp"

namespace ecs::app {
namespace {

std::filesystem::file_time_type time_of(const std::string& path) {
  std::error_code error;
  const auto time = std::filesystem::last_write_time(path, error);
  return error ? std::filesystem::file_time_type{} : time;
}

class LogbookScreen final : public ListScreen {
 public:
  LogbookScreen() {
    keys_ = {{"Enter", "the entry whole", [this] { show_entry(); }},
             {"v", "verify", [this] { run("checking every entry", "verify"); }},
             {"r", "replay", [this] { run("deriving the active map again", "replay"); }},
             {"Tab", "next logbook", [this] { open_next(); }}};
    look();
  }

  [[nodiscard]] std::string title() const override { return "LOGBOOK"; }
  [[nodiscard]] std::string help() const override {
    return "What verbs and screens did at a machine, written by themselves: measurements, maps, parameters, transfers, "
           "diagnoses, reports, each with its files and tied by its hash to the entry before. v checks every entry: a "
           "change is found and the first one named. r derives the active map again from the raw readings and compares "
           "it bit for bit. `ecs log` does the same, compares two years and writes a calibration certificate "
           "(modules/logbook/README.md). ECS_LOGBOOK=off keeps no logbook.";
  }
  [[nodiscard]] bool advance() override {
    const auto words = logbook_words();
    for (const LogbookWord& word : words) say(word.text, word.warning ? Tone::warning : Tone::good);
    if (task_.advance() || !words.empty()) return true;
    if (books_.empty() || task_.running() || time_of(book()) == seen_) return false;
    read();
    return true;
  }

 protected:
  [[nodiscard]] std::vector<ListRow> rows() const override {
    std::vector<ListRow> rows;
    for (const LogbookEntry& entry : entries_) {
      std::string time = entry.time.substr(0, 16);
      std::replace(time.begin(), time.end(), 'T', ' ');
      rows.push_back({fmt::format("{:>6} {:<16} {:<18} {}", entry.number, time, entry.kind, entry.summary)});
    }
    return rows;
  }
  [[nodiscard]] std::string heading() const override {
    if (entries_.empty()) return "logbook";
    return fmt::format("{}: {} entries{}", owner_, entries_.size(),
                       books_.size() > 1 ? fmt::format(" ({} logbooks, Tab shows the next)", books_.size()) : "");
  }
  [[nodiscard]] std::string below_heading() const override { return book(); }
  [[nodiscard]] std::string while_empty() const override { return absent_.empty() ? "It holds no entry." : absent_; }
  [[nodiscard]] std::string whole(std::size_t row) const override {
    const auto open = Logbook::open_to_read(book());
    const auto entry = open ? open->entry(entries_[row].number) : tl::unexpected(open.error());
    return entry ? whole_entry_cell(*entry).text : to_text(entry.error());
  }
  [[nodiscard]] bool shows_whole_below() const override { return false; }

 private:
  struct Ran {
    std::string text;
    int exit_code = 0;
  };
  [[nodiscard]] std::string book() const { return books_.empty() ? "" : books_[at_].string(); }

  void look() {
    const auto setting = logbook_setting();
    if (!setting) {
      absent_ = to_text(setting.error());
      return;
    }
    books_ = logbooks(*setting);
    if (books_.empty())
      absent_ = setting->off ? "No logbook is kept: ECS_LOGBOOK or the setting says off."
                             : "No logbook yet. Verbs and screens begin one when they work on a machine.";
    read();
  }

  void read() {
    entries_.clear();
    owner_.clear();
    if (books_.empty()) return;
    seen_ = time_of(book());
    const auto open = Logbook::open_to_read(book());
    auto entries = open ? open->entries(true) : tl::unexpected(open.error());
    const auto owner = open ? open->owner() : tl::unexpected(open.error());
    absent_ = entries ? "" : to_text(entries.error());
    if (entries) entries_ = std::move(*entries);
    if (owner) owner_ = in_words(*owner);
    follow();
  }

  void open_next() {
    if (books_.size() < 2) return;
    at_ = (at_ + 1) % books_.size();
    following_ = true;
    read();
  }

  void show_entry() {
    if (!entries_.empty()) show(whole(marked()));
  }

  /// `ecs log VERB` on this logbook, beside the screen; more than a line of it is shown as a page.
  void run(const std::string& doing, const std::string& verb) {
    if (task_.running() || books_.empty()) return;
    say(doing + " ...", Tone::warning);
    const auto work = [words = std::vector<std::string>{"log", verb, "--log", book()}](JobControl&) {
      std::ostringstream out, messages;
      const int code = run_program(words, out, messages);
      return Ran{std::string(trimmed(messages.str() + out.str())), code};
    };
    task_.start(doing, work, [this](const Ran& ran) {
      const std::string first = ran.text.substr(0, ran.text.find('\n'));
      say(first, ran.exit_code == kDone ? Tone::good : Tone::bad);
      if (first != ran.text) show(ran.text);
    });
  }

  std::vector<std::filesystem::path> books_;
  std::size_t at_ = 0;
  std::string owner_, absent_;
  std::vector<LogbookEntry> entries_;
  std::filesystem::file_time_type seen_{};
  TaskRunner task_;
};

}  // namespace

std::unique_ptr<Screen> logbook_screen() { return std::make_unique<LogbookScreen>(); }

}  // namespace ecs::app
