#include "app/screens/forms/rows.hpp"
#include "app/screens/utility/screens.hpp"

namespace ecs::app {

std::vector<MenuChoice> utility_choices(const std::shared_ptr<UnitConnection>& connection) {
  return {
      {"SET AXIS POSITION", "what the unit shows for an axis; nothing moves",
       [connection] { return position_screen(connection); }},
      {"OUTPUT COMPENSATION VALUE", "a value on one axis's D/A converter; the relay",
       [connection] { return output_screen(connection); }},
      {"RECORD DATUM SEQUENCE", "ten seconds of an axis being referenced",
       [connection] { return datum_record_screen(connection); }},
      {"DISPLAY DATUM SEQUENCE", "such a record as a graph; two over each other", [] { return datum_view_screen(); }},
      {"TEST DATUM ROUTINE", "the unit's datum routine, stage by stage",
       [connection] { return datum_test_screen(connection); }},
      {"DISPLAY ECS STATUS", "mode and fault; change the mode, clear, test memory",
       [connection] { return status_screen(connection); }},
      {"RUN USER SOFTWARE", "machine code in the unit's memory",
       [connection] { return form_titled("RUN USER SOFTWARE", connection); }},
  };
}

}  // namespace ecs::app
