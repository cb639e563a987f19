// RUN USER SOFTWARE: start address, argument and time limit, the regions to choose from, the result with the registers.

#include <fmt/format.h>

#include "app/screens/utility/parts.hpp"
#include "app/screens/utility/screens.hpp"
#include "base/text.hpp"
#include "commissioning/utility/run_controller.hpp"

namespace ecs::app {
namespace {

constexpr int kFieldRow = 2;
constexpr int kFieldColumn = 16;
constexpr int kFieldColumns = 12;
constexpr int kRegionRow = 6;
constexpr const char* kFieldNames[] = {"start address", "argument", "time limit, s"};
constexpr const char* kHelps[] = {"even, from 0x041000 to 0x04FFFE", "a number for the program, in D0: 7 or 0x043000",
                                  "the program is stopped then"};

class RunScreen final : public UtilityScreen<RunController> {
 public:
  explicit RunScreen(std::shared_ptr<UnitConnection> connection) : UtilityScreen(std::move(connection)) {
    fields_[0].set(fmt::format("0x{:06X}", kUserPrograms));
    fields_[1].set("0");
    fields_[2].set("60");
  }

  [[nodiscard]] std::string title() const override { return "RUN USER SOFTWARE"; }
  void draw_inside(Canvas& canvas, const Area& inside) const override {
    draw_unit_row(canvas, inside, 0, controller_.unit());
    draw_fields(canvas, inside.below(kFieldRow));
    draw_regions(canvas, inside.below(kRegionRow));
    const int result_row = kRegionRow + static_cast<int>(regions_.size()) + 1;
    draw_result(canvas, inside.below(result_row));
    draw_message(canvas, {inside.row + inside.rows - 2, inside.column, 2, inside.columns}, controller_.message());
  }

  [[nodiscard]] bool leaves_on(const Key& key) const override { return key.name == Key::Name::escape; }

  void on_command(const Key& key) override {
    if (controller_.busy()) return;
    const int places = kFields + static_cast<int>(regions_.size());
    if (key.name == Key::Name::down || key.name == Key::Name::tab) {
      place_ = (place_ + 1) % places;
    } else if (key.name == Key::Name::up || key.name == Key::Name::back_tab) {
      place_ = (place_ + places - 1) % places;
    } else if (key.name == Key::Name::enter) {
      enter();
    } else if (in_field()) {
      (void)fields_[static_cast<std::size_t>(place_)].on_key(key);
    }
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (asking_.active()) return {{"y", "run it"}, {"n", "leave it"}};
    if (controller_.busy()) return {{"Esc", "stop it"}};
    if (!in_field()) return {{"Enter", "take its address"}, {"up/down", "choose"}, {"Esc", "back"}};
    return {{"Enter", "run"}, {"up/down", "field, region"}, {"Esc", "back"}};
  }

  [[nodiscard]] std::string help() const override {
    return "Runs 68000 machine code that lies in the unit's system RAM. D0 holds the argument; RTS ends the program "
           "and D0 is its result; the registers it left are shown. An access where nothing is, an illegal instruction "
           "or the end of the time limit ends it, and the unit keeps the fault user_software. Down moves on to the "
           "regions: Enter there takes an address.";
  }

  [[nodiscard]] bool advance() override {
    const bool changed = controller_.advance();
    if (auto question = controller_.take_question()) asking_.ask(std::move(*question), [this] { controller_.run(); });
    return changed;
  }

  [[nodiscard]] bool typing() const override { return in_field() && !asking_.active() && !controller_.busy(); }
  [[nodiscard]] CellPosition cursor(const Area& area) const override {
    if (!typing()) return {-1, -1};
    return {area.row + kFieldRow + place_,
            area.column + 1 + kFieldColumn + fields_[static_cast<std::size_t>(place_)].cursor_column(kFieldColumns)};
  }

 private:
  static constexpr int kFields = 3;
  [[nodiscard]] bool in_field() const { return place_ < kFields; }
  void draw_fields(Canvas& canvas, const Area& area) const {
    for (int k = 0; k < kFields; ++k) {
      canvas.text(area, k, 0, fmt::format("{} {}", k == place_ ? ">" : " ", kFieldNames[k]),
                  k == place_ ? Tone::strong : Tone::plain);
      fields_[static_cast<std::size_t>(k)].draw(canvas, area, k, kFieldColumn, kFieldColumns, k == place_);
      canvas.text(area, k, kFieldColumn + kFieldColumns + 2, kHelps[k], Tone::faint);
    }
  }

  void draw_regions(Canvas& canvas, const Area& area) const {
    canvas.text(area, 0, 0, fmt::format("  {:<10}{:<10}{:<20}{}", "from", "to", "memory", "what a program finds there"),
                Tone::faint);
    for (std::size_t k = 0; k < regions_.size(); ++k) {
      const ProgramRegion& r = regions_[k];
      const bool here = place_ == kFields + static_cast<int>(k);
      const int row = static_cast<int>(k) + 1;
      if (here) canvas.fill({area.row + row, area.column, 1, area.columns}, U' ', Tone::selected);
      canvas.text(area, row, 0,
                  fmt::format("{} 0x{:06X}  0x{:06X}  {:<20}{}", here ? ">" : " ", r.region.first,
                              r.region.first + r.region.size - 1, r.region.name, r.what),
                  here ? Tone::selected : (r.runs ? Tone::strong : Tone::plain));
    }
  }

  void draw_result(Canvas& canvas, const Area& area) const {
    if (controller_.running()) {
      const double limit_s = controller_.program().wait_s;
      draw_progress(canvas, area, 0, fmt::format("running 0x{:06X}", controller_.program().address),
                    controller_.running_s() / limit_s, limit_s - controller_.running_s());
      return;
    }
    const auto& ended = controller_.ended();
    if (!ended) {
      canvas.paragraph(
          area, 0,
          "A program ends with RTS and returns D0. MEMORY ACCESS writes programs and their data into system RAM; "
          "samples with an assembler are in samples/user_software. System RAM forgets without power.",
          Tone::faint);
      return;
    }
    if (ended->returned)
      canvas.text(area, 0, 0,
                  fmt::format("0x{:06X} returned {} (0x{:08X}, signed {})", ended->program.address, *ended->returned,
                              *ended->returned, static_cast<std::int32_t>(*ended->returned)),
                  Tone::good);
    else
      canvas.text(area, 0, 0,
                  fmt::format("0x{:06X} returned nothing; its registers where it ended:", ended->program.address),
                  Tone::bad);
    int row = 1;
    const std::string registers = registers_text(ended->registers);
    for (const std::string_view line : lines_of(registers)) canvas.text(area, row++, 2, line);
  }

  void enter() {
    if (!in_field()) {
      const ProgramRegion& chosen = regions_[static_cast<std::size_t>(place_ - kFields)];
      fields_[chosen.runs ? 0 : 1].set(fmt::format("0x{:06X}", chosen.region.first));
      controller_.message().say(chosen.runs ? "Its first address is the start address now."
                                            : "No program runs there; its first address is the argument now.");
      place_ = chosen.runs ? 0 : 1;
      return;
    }
    const auto program = program_in(fields_[0].text(), fields_[1].text(), fields_[2].text());
    if (!program)
      controller_.message().say(program.error());
    else if (unit_integrates())
      controller_.prepare(*program);
  }

  std::vector<ProgramRegion> regions_ = program_regions();
  std::array<TextLine, kFields> fields_;
  int place_ = 0;  ///< a field, then a region
};

}  // namespace

std::unique_ptr<Screen> run_screen(std::shared_ptr<UnitConnection> connection) {
  return std::make_unique<RunScreen>(std::move(connection));
}

}  // namespace ecs::app
