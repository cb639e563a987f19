// Screens that ask and answer: a verb as a form, and the table of those that are more than their verb. The options are
// the fields with their help, Enter runs it, the answer scrolls below; one that asks while it runs (VerbEntry::live)
// has a line to type into.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/cli/catalogue.hpp"
#include "app/ui/screen.hpp"
#include "base/file_kind.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "commissioning/plot/figure.hpp"
#include "commissioning/session/message.hpp"

namespace ecs::app {

/// What is typed, by option: {"--machine", "mill/machine.toml"}; of flags "yes".
using FormValues = std::map<std::string, std::string>;

/// What a screen says and does beside its verb. Whatever is empty is as the verb has it.
struct FormRow {
  std::string verb;                   ///< "lengths fit"
  std::string title{};                ///< "LENGTHS"; empty: the name of the verb
  std::string asks{};                 ///< above the fields
  std::string about{};                ///< for ?
  std::vector<std::string> fields{};  ///< in this order before the others
  std::string confirmed{};            ///< the flag that a question answers, such as --yes: it is no field
  FormValues preset{};
  std::map<std::string, std::vector<std::string>> offers{};  ///< values of a field that Tab goes through
  std::vector<std::string> idle{};                           ///< below the fields as long as there is no answer
  /// Fields that take files given to the program; it is opened where one of the first kind is among them.
  std::vector<std::pair<FileKind, std::string>> opens{};
  bool leaves_when_done = false;  ///< Enter goes back once it is done

  /// Asked before it runs; in the thread of a task.
  std::function<Result<Question>(UnitConnection&, JobControl&, const FormValues&)> question{};
  /// An answer without running the verb; nothing: it is run.
  std::function<std::optional<std::string>(const FormValues&)> instead{};
  /// Lines below the answer; in the thread of the task that ran it.
  std::function<std::string(UnitConnection&, JobControl&, int exit_code)> more{};
  /// Once the answer is there.
  std::function<void(UnitConnection&, const FormValues&, int exit_code)> done{};
  /// Drawn in place of the answer on the keys 2, 3, …: titles and panels of the figure.
  std::function<Result<PlotFigure>(const FormValues&)> figure{};
  std::vector<std::pair<std::string, std::size_t>> panels{};
};

/// The connection's link is filled in where the verb takes one; the connection lends the link while it runs.
/// @param values  filled in before  @param at_once  it is run if nothing is lacking
[[nodiscard]] std::unique_ptr<Screen> form_screen(FormRow row, VerbEntry verb,
                                                  std::shared_ptr<UnitConnection> connection,
                                                  const FormValues& values = {}, bool at_once = false);

/// A row of the menus with its screen.
struct FormEntry {
  std::string help;  ///< in the menu; empty: it stands in none
  FormRow row;
};
/// Every screen that is more than the verb's own form, with what is proposed now.
[[nodiscard]] std::vector<FormEntry> form_entries();

/// The screen of that title. @param at_once  its verb is run if nothing is lacking
[[nodiscard]] std::unique_ptr<Screen> form_titled(const std::string& title,
                                                  const std::shared_ptr<UnitConnection>& connection,
                                                  const FormValues& values = {}, bool at_once = false);
/// A verb as a form, under its own name.
[[nodiscard]] std::unique_ptr<Screen> verb_screen(const VerbEntry& verb,
                                                  const std::shared_ptr<UnitConnection>& connection);

/// Asks for the code that the unit shows, and arms it. Null unless the unit has refused something for want of it.
[[nodiscard]] std::unique_ptr<Screen> arm_screen_if_wanted(const std::shared_ptr<UnitConnection>& connection);

}  // namespace ecs::app
