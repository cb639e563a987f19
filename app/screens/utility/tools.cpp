// TOOLS: the table of tools in the unit, in every mode: select one, set its offset, remove it, send a whole table.
#include "commissioning/unit/tools.hpp"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/screens/utility/parts.hpp"
#include "app/screens/utility/screens.hpp"
#include "base/text.hpp"

namespace ecs::app {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kBetweenLines = std::chrono::seconds(1);
constexpr int kRestPerLines = 3;   ///< a slow link is left to others for this many times as long as a reading took
constexpr int kRestPerTable = 50;  ///< likewise of the table
constexpr int kListRow = 5;        ///< its heading is above
constexpr int kMessageRows = 3;

/// "X,Y,Z" or "NUMBER,X,Y,Z", with commas or blanks between.
std::vector<double> numbers_in(const std::string& typed) {
  std::string plain = typed;
  std::replace(plain.begin(), plain.end(), ',', ' ');
  std::vector<double> numbers;
  for (const std::string_view word : split(plain, ' ')) {
    if (word.empty()) continue;
    const auto number = number_in(word);
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

std::string offset_text(const Vector3& mm) {
  return fmt::format("{},{},{}", shortest(mm[0]), shortest(mm[1]), shortest(mm[2]));
}

class ToolsScreen final : public KeyedScreen {
 public:
  explicit ToolsScreen(std::shared_ptr<UnitConnection> connection)
      : connection_(std::move(connection)), watched_(connection_->snapshot()) {
    const auto any = [this] { return marked() != nullptr; };
    keys_ = {{"Enter", "select", [this] { select(marked()->number); }, any},
             {"0", "no tool", [this] { select(0); }},
             {"e", "offset", [this] { type_offset(); }, any},
             {"n", "new tool", [this] { type_tool(); }},
             {"r", "remove", [this] { ask_to_remove(); }, any},
             {"f", "send a file", [this] { choose_file(); }},
             {"up/down", "tool"},
             {"Esc", "back"}};
  }

  [[nodiscard]] std::string title() const override { return "TOOLS"; }
  [[nodiscard]] std::string help() const override {
    return "The table of tools in the unit: up to 64 numbers with their offsets, from the point where the curves of "
           "the "
           "map were measured to the tool point. The unit compensates for the selected tool; with no tool it uses the "
           "tool offset of its parameters. The control selects a tool over its wires to the unit; Enter selects the "
           "tool "
           "under the cursor. "
           "All of this works in every mode. While the unit compensates, after a tool change its output changes no "
           "faster "
           "than compensation.tool_rate_um_per_s. No offset may exceed compensation.tool_range_mm. Press f to replace "
           "the whole table with a file with the columns number, x_mm, y_mm, z_mm: the old table remains in force "
           "until "
           "the new one is complete.";
  }

 private:
  [[nodiscard]] const Tool* marked() const {
    if (!held_ || held_->tools.empty()) return nullptr;
    const auto last = static_cast<int>(held_->tools.size()) - 1;
    return &held_->tools[static_cast<std::size_t>(std::clamp(place_.selected, 0, last))];
  }

  void draw_inside(Canvas& canvas, const Area& inside) const override {
    draw_state(canvas, inside);
    const Area list{inside.row + kListRow, inside.column - 1, inside.rows - kListRow - kMessageRows,
                    inside.columns + 2};
    if (held_ && held_->tools.empty())
      canvas.paragraph(inside, kListRow, "The table is empty. Press n for a tool, or f to send a file.", Tone::faint);
    if (held_ && !held_->tools.empty()) {
      canvas.text(inside, kListRow - 1, 2, fmt::format("{:>6} {:>12} {:>12} {:>12}", "number", "x mm", "y mm", "z mm"),
                  Tone::faint);
      draw_list(canvas, list, rows(), place_);
    }
    const Area last = last_rows(inside, kMessageRows);
    if (task_.running())
      draw_progress(canvas, last, kMessageRows - 1, task_.label(), task_.part());
    else
      draw_message(canvas, last, message_);
  }

  void draw_state(Canvas& canvas, const Area& inside) const {
    const std::string& lack = !watched_.problem.empty() ? watched_.problem : problem_;
    if (!lack.empty()) return static_cast<void>(canvas.paragraph(inside.top(2), 0, "NO ANSWER: " + lack, Tone::bad));
    if (!held_)
      return static_cast<void>(canvas.text(inside, 0, 0, "The table of tools is being read ...", Tone::warning));
    const bool known = held_->lines.tool_state != protocol::ToolState::unknown && held_->damaged_copies == 0;
    std::string text = acting_text(*held_);
    text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
    canvas.paragraph(inside.top(kListRow - 2), 0, text + ".", known ? Tone::strong : Tone::bad);
    canvas.text(inside, kListRow - 2, 0,
                fmt::format("{} of {} tools. {}", held_->tools.size(), kMostTools,
                            held_->lines.tool_wired ? "The control selects the tool by its wires."
                                                    : "The tool is selected by a host (no wires from the control)."),
                Tone::faint);
    if (read_s() > 2.0)
      canvas.text_right(inside, kListRow - 2, fmt::format("read {:.0f} s ago", read_s()), Tone::warning);
  }

  [[nodiscard]] std::vector<ListRow> rows() const {
    std::vector<ListRow> rows;
    for (const Tool& tool : held_->tools) {
      const bool selected = tool.number == held_->lines.tool;
      rows.push_back({fmt::format("{:>6} {:>12.4f} {:>12.4f} {:>12.4f}  {}", tool.number, tool.offset_mm[0],
                                  tool.offset_mm[1], tool.offset_mm[2], selected ? state_text(held_->lines) : ""),
                      selected ? Tone::good : Tone::plain});
    }
    return rows;
  }

  void on_other_key(const Key& key) override {
    const int count = held_ ? static_cast<int>(held_->tools.size()) : 0;
    if (const auto clicked = key.name == Key::Name::mouse ? place_.clicked(key) : std::nullopt)
      place_.selected = std::min(*clicked, std::max(0, count - 1));
    else
      (void)place_.on_key(key, count);
  }

  [[nodiscard]] Step leave() override {
    if (!task_.running()) return back();
    task_.cancel();
    return stay();
  }

  // --- what is done
  /// @param words  of the command that does the same  @param done  what there is to say then
  void start(const std::string& label, const std::vector<std::string>& words, const std::string& done,
             const std::function<Result<void>(protocol::UnitClient&)>& work) {
    if (task_.running()) return;
    task_.start(
        label,
        [connection = connection_, work](JobControl& control) {
          return connection->with_link(control, [&](UnitLink& link) { return work(link.client()); });
        },
        [this, words, done](const Result<void>& result) {
          at_once_ = true;
          if (!result) return say_failed(message_, result.error(), task_.cancelled());
          note_on_unit(*connection_, words);
          message_.say(done);
        });
  }

  void select(std::uint16_t number) {
    start("selecting", {"utility", "tool", std::to_string(number)},
          number == 0 ? "No tool is selected from the tool table." : fmt::format("Tool {} is selected.", number),
          [number](protocol::UnitClient& client) { return client.select_tool(number); });
  }

  void set(const Tool& tool) {
    const std::string offset = offset_text(tool.offset_mm);
    start("setting the tool", {"utility", "tool", std::to_string(tool.number), "--offset", offset},
          fmt::format("Tool {} has the offset {} mm.", tool.number, offset),
          [tool](protocol::UnitClient& client) { return client.set_tool(tool); });
  }

  void type_offset() {
    const Tool tool = *marked();
    prompt_.ask(fmt::format("Offset of tool {}, X,Y,Z in mm:", tool.number), Prompt::Kind::text,
                offset_text(tool.offset_mm), [this, number = tool.number](const std::string& typed) -> std::string {
                  const auto mm = numbers_in(typed);
                  if (mm.size() != kAxes) return fmt::format("expected X,Y,Z in mm, found \"{}\"", typed);
                  set({number, {mm[0], mm[1], mm[2]}});
                  return {};
                });
  }

  void type_tool() {
    prompt_.ask("New tool, NUMBER,X,Y,Z in mm:", Prompt::Kind::text, "",
                [this](const std::string& typed) -> std::string {
                  const auto given = numbers_in(typed);
                  if (given.size() != 1 + kAxes) return fmt::format("expected NUMBER,X,Y,Z, found \"{}\"", typed);
                  if (!(given[0] >= 1.0 && given[0] <= kGreatestToolNumber && given[0] == std::floor(given[0])))
                    return fmt::format("expected a whole number from 1 to {}, found {}", kGreatestToolNumber,
                                       shortest(given[0]));
                  set({static_cast<std::uint16_t>(given[0]), {given[1], given[2], given[3]}});
                  return {};
                });
  }

  void ask_to_remove() {
    const std::uint16_t number = marked()->number;
    asking_.ask({fmt::format("Remove tool {} from the table?", number),
                 fmt::format("Its offset {} mm will be lost.", offset_text(marked()->offset_mm)), "remove", "keep it"},
                [this, number] {
                  start("removing", {"utility", "tool", std::to_string(number), "--remove"},
                        fmt::format("Tool {} is removed.", number),
                        [number](protocol::UnitClient& client) { return client.remove_tool(number); });
                });
  }

  void choose_file() {
    prompt_.choose("Replace the table with a file: number, x_mm, y_mm, z_mm", {{FileKind::other}},
                   [this](const std::string& path) -> std::string {
                     const auto tools = read_tools(path);
                     if (!tools) return to_text(tools.error());
                     ask_to_send(path, *tools);
                     return {};
                   });
  }

  void ask_to_send(const std::string& path, const std::vector<Tool>& tools) {
    const std::size_t before = held_ ? held_->tools.size() : 0;
    asking_.ask({fmt::format("Replace the table with {} tool{}?", tools.size(), tools.size() == 1 ? "" : "s"),
                 fmt::format("The {} tools in the unit will be replaced in one piece. The old table remains in force "
                             "until the new one is complete.",
                             before),
                 "replace", "keep it"},
                [this, path, tools] {
                  start("sending the table", {"utility", "send-tools", path_word(path)},
                        fmt::format("The unit has the {} tools of {}.", tools.size(), path),
                        [path, tools](protocol::UnitClient& client) {
                          return send_tools(client, path, tools).map([](const SentTools&) {});
                        });
                });
  }

  // --- reading: the lines every second; the table, which is long on a slow line, after every command, else rarely
  [[nodiscard]] double read_s() const { return std::chrono::duration<double>(Clock::now() - read_at_).count(); }

  void start_reading() {
    if (reading_.running() || task_.running()) return;
    const auto rest = std::max<Clock::duration>(kBetweenLines, kRestPerLines * took_);
    if (!at_once_ && Clock::now() - std::max(read_at_, asked_at_) < rest) return;
    asked_at_ = Clock::now();
    const bool is_due = asked_at_ - table_at_ > kRestPerTable * table_took_;
    std::optional<ToolsInUnit> known = std::exchange(at_once_, false) || is_due ? std::nullopt : held_;
    const bool of_table = !known;
    if (of_table) table_at_ = asked_at_;
    const auto work = [connection = connection_, known = std::move(known)](JobControl& control) {
      return connection->with_link(control, [&](UnitLink& link) -> Result<ToolsInUnit> {
        if (!known) return tools_in_unit(link.client());
        ECS_TRY(lines, link.client().control_lines());
        if (lines.tools != known->tools.size()) return tools_in_unit(link.client());
        return ToolsInUnit{lines, known->tools, known->damaged_copies};
      });
    };
    reading_.start("reading", work, [this, of_table](Result<ToolsInUnit> read) {
      took_ = Clock::now() - asked_at_;
      if (of_table) table_took_ = took_;
      problem_ = read ? "" : to_text(read.error());
      if (!read) return;
      held_ = std::move(*read);
      read_at_ = Clock::now();
    });
  }

  [[nodiscard]] bool look() override {
    bool changed = std::exchange(watched_, connection_->snapshot()).problem != watched_.problem;
    start_reading();
    for (TaskRunner* task : {&reading_, &task_}) changed = task->advance() || changed;
    return changed || task_.running();
  }

  std::shared_ptr<UnitConnection> connection_;
  WatchedUnit watched_;
  std::optional<ToolsInUnit> held_;
  std::string problem_;  ///< why the last reading failed
  ListPlace place_;
  Clock::time_point read_at_{};
  Clock::time_point asked_at_{};
  Clock::duration took_{};
  Clock::time_point table_at_{};  ///< when it was asked for last
  Clock::duration table_took_{};
  bool at_once_ = true;  ///< the next reading comes without waiting, and is of the table
  TaskRunner reading_;
  TaskRunner task_;
};

}  // namespace

std::unique_ptr<Screen> tools_screen(std::shared_ptr<UnitConnection> connection) {
  return std::make_unique<ToolsScreen>(std::move(connection));
}

}  // namespace ecs::app
