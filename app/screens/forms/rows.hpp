// The screens that ask and answer, as one table over the form of a verb.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/screens/forms/form_screen.hpp"

namespace ecs::app {

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
