// ARM THE UNIT: the code that the unit shows is typed, and for half an hour it takes writes and commands.
#include <fmt/format.h>

#include "app/screens/unit/screens.hpp"
#include "app/ui/talk.hpp"
#include "app/ui/widgets.hpp"
#include "base/text.hpp"
#include "commissioning/link/unit_commands.hpp"
#include "commissioning/session/task_runner.hpp"

namespace ecs::app {
namespace {

constexpr int kArmCodeRow = 5;
constexpr const char* kArmExplained =
    "The unit is read-only for this host: it takes nothing that writes, moves an axis, closes a relay or runs code. "
    "Type "
    "the code that it shows, then do again what was refused. What stops and switches off needs no code.";

class ArmScreen final : public Screen {
 public:
  explicit ArmScreen(std::shared_ptr<UnitConnection> connection) : connection_(std::move(connection)) {}

  [[nodiscard]] std::string title() const override { return "ARM THE UNIT"; }
  void draw(Canvas& canvas, const Area& area) const override {
    canvas.paragraph(area, 1, kArmExplained);
    canvas.text(area, kArmCodeRow, 0, kPrompt);
    code_.draw(canvas, area, kArmCodeRow, kCodeColumn, std::max(1, area.columns - kCodeColumn), !task_.running());
    draw_message(canvas, {area.row + kArmCodeRow + 2, area.column, 3, area.columns}, message_);
  }
  [[nodiscard]] Step on_key(const Key& key) override {
    if (key.name == Key::Name::escape) {
      task_.cancel();
      return back();
    }
    if (task_.running()) return stay();
    if (key.name == Key::Name::enter)
      arm();
    else
      static_cast<void>(code_.on_key(key));
    return armed_ ? back() : stay();
  }
  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (armed_) return {{"Enter", "back"}};
    return {{"Enter", "arm the unit"}, {"Esc", "leave it read-only"}};
  }
  [[nodiscard]] std::string help() const override {
    return std::string(kArmExplained) +
           " The emulator shows its code at its start, and by `ecs-emulator workshop SOCKET arm-code`. After a wrong "
           "code "
           "the unit waits before it looks at another one.";
  }
  [[nodiscard]] bool advance() override { return task_.advance(); }
  [[nodiscard]] bool typing() const override { return !armed_; }
  [[nodiscard]] CellPosition cursor(const Area& area) const override {
    const int columns = std::max(1, area.columns - kCodeColumn);
    return {area.row + kArmCodeRow, area.column + kCodeColumn + code_.cursor_column(columns)};
  }

 private:
  static constexpr const char* kPrompt = "code:";
  static constexpr int kCodeColumn = 6;

  void arm() {
    const std::string code(trimmed(code_.text()));
    if (armed_ || code.empty()) return;
    const auto work = [connection = connection_, code](JobControl& control) {
      return connection->with_link(control, [&](UnitLink& link) -> Result<std::string> {
        ECS_DO(link.client().arm(code));
        link.client().know_code(code);
        return code;
      });
    };
    task_.start("arming", work, [this](const Result<std::string>& armed) {
      if (!armed) return message_.say(armed.error());
      connection_->know_code(*armed);
      armed_ = true;
      note_on_unit(*connection_, {"unit", "arm", "--minutes", fmt::format("{}", protocol::kUsualArmed_min)});
      message_.say(fmt::format("The unit takes writes and commands of this host for {} minutes. Enter goes back.",
                               protocol::kUsualArmed_min));
    });
  }

  std::shared_ptr<UnitConnection> connection_;
  TextLine code_;
  bool armed_ = false;
  Message message_;
  TaskRunner task_;
};

}  // namespace

std::unique_ptr<Screen> arm_screen_if_wanted(const std::shared_ptr<UnitConnection>& connection) {
  if (!connection->snapshot().wants_code) return nullptr;
  connection->know_code({});
  return std::make_unique<ArmScreen>(connection);
}

}  // namespace ecs::app
